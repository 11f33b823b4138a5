//! Markers on a surface parallel to that of the nodes.

use lbm_ibm_coupling::{ExchangeError, Soa3, Soa3Mut, Soa3Ref, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A body with a parallel surface.
#[derive(Clone, Debug)]
struct Body {
    id: u32,
    range: Range<usize>,
    triangles: Arc<[[u32; 3]]>,
    /// Below the nodes, m.
    depth: f64,
}

/// The parallel surfaces of bodies whose markers are not at their nodes.
///
/// Their nodes are at `y = x - d n`, with `n` the normals of the nodes. What the fluid does at `x` is what it does at `y` and `d` times its change
/// along the normal without shear stress, `-(grad_s u).n - n div_s u`: the surface turns, and where it is stretched the layer between
/// grows thinner. Both follow from the velocities of the parallel surface alone. On a triangle with corners `y_a`, opposite edges `e_a`, normal `N`
/// and area `A` it is `-sum_a ((u_a.N) g_a + (u_a.g_a) N)`, `g_a = N x e_a/(2 A)`; a node has the mean by area over its triangles. Forces take the
/// transposed path, so that power and net force are kept exactly.
#[derive(Clone, Debug, Default)]
pub(super) struct Parallel {
    bodies: Vec<Body>,
    /// Nodes of the parallel surfaces, m; those of the other bodies are where they are.
    y: Soa3,
    /// Vector areas of the nodes, of the parallel surfaces too, m2.
    area: Vec<Vec3>,
    below: Vec<Vec3>,
    /// One over the areas of the nodes of the parallel surfaces, 1/m2.
    per_area: Vec<f64>,
    force: Soa3,
    velocity: Soa3,
}

impl Parallel {
    /// Adds a body whose markers are `depth` (m) below its nodes.
    pub fn add(&mut self, id: u32, range: Range<usize>, triangles: Arc<[[u32; 3]]>, depth: f64) {
        self.bodies.push(Body {
            id,
            range,
            triangles,
            depth,
        });
    }

    /// Makes room for the nodes of all bodies, where there is one of these.
    pub fn resize(&mut self, nodes: usize) {
        let nodes = if self.bodies.is_empty() { 0 } else { nodes };
        self.area.resize(nodes, Vec3::zeros());
        self.below.resize(nodes, Vec3::zeros());
        self.per_area.resize(nodes, 0.0);
        for soa in [&mut self.y, &mut self.force, &mut self.velocity] {
            soa.resize(nodes);
        }
    }

    /// Takes node positions `x` (m) and returns those where markers are.
    ///
    /// # Errors
    /// [`ExchangeError::Fold`].
    pub fn place<'a>(&'a mut self, x: Soa3Ref<'a>) -> Result<Soa3Ref<'a>, ExchangeError> {
        if self.bodies.is_empty() {
            return Ok(x);
        }
        for i in 0..x.len() {
            self.y.set(i, x.get(i));
        }
        for body in &self.bodies {
            super::areas(x, &body.triangles, body.range.start, &mut self.area);
            for i in body.range.clone() {
                let normal = self.area[i].try_normalize(0.0).unwrap_or_else(Vec3::zeros);
                self.y.add(i, normal * -body.depth);
            }
            let y = self.y.view();
            super::areas(y, &body.triangles, body.range.start, &mut self.below);
            if let Some(i) = body.range.clone().find(|&i| self.below[i].dot(&self.area[i]) <= 0.0) {
                return Err(ExchangeError::Fold {
                    body: body.id,
                    position: x.get(i).into(),
                    depth: body.depth,
                });
            }
            self.per_area[body.range.clone()].fill(0.0);
            for t in body.faces(y) {
                t.nodes.iter().for_each(|&i| self.per_area[i] += t.area / 3.0);
            }
            self.per_area[body.range.clone()].iter_mut().for_each(|a| *a = 1.0 / *a);
        }
        Ok(self.y.view())
    }

    /// Makes velocities (m/s) of the nodes of those of the parallel surfaces.
    pub fn carry(&mut self, velocity: &mut Soa3Mut<'_>) {
        for body in &self.bodies {
            for i in body.range.clone() {
                self.velocity.set(i, Vec3::zeros());
            }
            for t in body.faces(self.y.view()) {
                let mut change = Vec3::zeros();
                for (i, g) in t.nodes.into_iter().zip(t.gradients) {
                    let u = Vec3::new(velocity.x[i], velocity.y[i], velocity.z[i]);
                    change -= g * u.dot(&t.normal) + t.normal * u.dot(&g);
                }
                for i in t.nodes {
                    self.velocity.add(i, change * (t.area / 3.0 * self.per_area[i]));
                }
            }
            for i in body.range.clone() {
                velocity.add(i, self.velocity.get(i) * body.depth);
            }
        }
    }

    /// Forces on the parallel surfaces (N) of those on the nodes.
    pub fn spread<'a>(&'a mut self, force: Soa3Ref<'a>) -> Soa3Ref<'a> {
        if self.bodies.is_empty() {
            return force;
        }
        for i in 0..force.len() {
            self.force.set(i, force.get(i));
        }
        for body in &self.bodies {
            for t in body.faces(self.y.view()) {
                let mean: Vec3 = t.nodes.iter().map(|&i| force.get(i) * self.per_area[i]).sum();
                let mean = mean * (t.area / 3.0 * body.depth);
                for (i, g) in t.nodes.into_iter().zip(t.gradients) {
                    self.force.add(i, -(t.normal * mean.dot(&g) + g * mean.dot(&t.normal)));
                }
            }
        }
        self.force.view()
    }
}

/// A triangle of a surface.
struct Face {
    /// Its corners, in the arrays of all bodies.
    nodes: [usize; 3],
    normal: Vec3,
    /// m2.
    area: f64,
    /// Gradients of the linear functions that are 1 at a corner and 0 at the others, 1/m.
    gradients: [Vec3; 3],
}

impl Body {
    /// Its triangles with nodes at `y` (m), but for those without area.
    fn faces<'a>(&'a self, y: Soa3Ref<'a>) -> impl Iterator<Item = Face> + 'a {
        self.triangles.iter().filter_map(move |t| {
            let nodes = t.map(|n| self.range.start + n as usize);
            let [a, b, c] = nodes.map(|n| y.get(n));
            let cross = (b - a).cross(&(c - a));
            let twice = cross.norm();
            (twice > 0.0).then(|| {
                let normal = cross / twice;
                Face {
                    nodes,
                    normal,
                    area: 0.5 * twice,
                    gradients: [c - b, a - c, b - a].map(|e| normal.cross(&e) / twice),
                }
            })
        })
    }
}
