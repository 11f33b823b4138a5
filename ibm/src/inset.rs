//! Markers inside an elastic surface, so that the body acts as large as it is.
//!
//! The fluid meets a body of nodes `x` at the parallel surface `y = x - d n`, with `n` the unit normals of the nodes (of the
//! area vectors of the triangles around them) and `d` the depth. Nodes move with the parallel surface and turn with it as a
//! whole: `dx/dt = dy/dt + W x d n`, with `W` the angular velocity of least squares of the body's `dy/dt`. Without that a
//! body in a fluid that turns would lag behind by `d/R`. Forces take the transposed path: those of the nodes, and the rigid
//! turn that has the torque `sum d n x F`. So power, net force and torque are kept exactly.

use crate::surface::Surface;
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{ExchangeError, Soa3, Soa3Mut, Soa3Ref, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A body with a parallel surface.
#[derive(Clone, Debug)]
struct Body {
    id: u32,
    range: Range<usize>,
    triangles: Arc<[[u32; 3]]>,
    centre: Vec3,
    /// Inverse of the sum of `r^2 - r r` over its nodes, about the centre, 1/m2.
    inverse: Matrix3<f64>,
}

/// The parallel surfaces of all bodies with triangles; nodes of the others stay where they are.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inset {
    depth: f64,
    bodies: Vec<Body>,
    /// Nodes of the parallel surfaces, m.
    y: Soa3,
    /// Normals of the nodes, and of those of the parallel surfaces.
    normal: Vec<Vec3>,
    below: Vec<Vec3>,
    force: Soa3,
}

impl Inset {
    /// Takes the bodies, whose surfaces are to lie `depth` (m) deeper.
    pub fn set_bodies(&mut self, surfaces: &[Surface], nodes: usize, depth: f64) {
        self.depth = depth;
        let bodies = surfaces.iter().filter(|s| !s.edges.is_empty());
        self.bodies = bodies
            .map(|s| Body {
                id: s.id,
                range: s.range.clone(),
                triangles: s.triangles.clone(),
                centre: Vec3::zeros(),
                inverse: Matrix3::zeros(),
            })
            .collect();
        self.normal.resize(nodes, Vec3::zeros());
        self.below.resize(nodes, Vec3::zeros());
        self.y.resize(nodes);
        self.force.resize(nodes);
    }

    /// Moves the parallel surfaces with nodes at `x` (m) and returns their nodes (m).
    ///
    /// # Errors
    /// [`ExchangeError::Fold`].
    pub fn place(&mut self, x: Soa3Ref<'_>) -> Result<Soa3Ref<'_>, ExchangeError> {
        for i in 0..x.len() {
            self.y.set(i, x.get(i));
        }
        for body in &mut self.bodies {
            let (start, n) = (body.range.start, body.range.len());
            normals(x, body, &mut self.normal);
            for i in body.range.clone() {
                self.y.add(i, -self.depth * self.normal[i]);
            }
            normals(self.y.view(), body, &mut self.below);
            if let Some(node) = body.range.clone().find(|&i| self.below[i].dot(&self.normal[i]) <= 0.0) {
                return Err(ExchangeError::Fold {
                    body: body.id,
                    position: x.get(node).into(),
                    depth: self.depth,
                });
            }
            let y = self.y.slice(start..start + n);
            body.centre = y.mean();
            let inertia: Matrix3<f64> = y
                .iter()
                .map(|y| {
                    let r = y - body.centre;
                    Matrix3::identity() * r.norm_squared() - r * r.transpose()
                })
                .sum();
            body.inverse = inertia.try_inverse().unwrap_or_else(Matrix3::zeros);
        }
        Ok(self.y.view())
    }

    /// Velocities of the nodes (m/s) of those of the parallel surfaces.
    pub fn carry(&self, mut velocity: Soa3Mut<'_>) {
        for body in &self.bodies {
            let spin = |i: usize| (self.y.get(i) - body.centre).cross(&velocity.get(i));
            let turn = body.inverse * body.range.clone().map(spin).sum::<Vec3>();
            for i in body.range.clone() {
                velocity.set(i, velocity.get(i) + turn.cross(&self.normal[i]) * self.depth);
            }
        }
    }

    /// Forces on the parallel surfaces (N) of those on the nodes.
    pub fn spread(&mut self, force: Soa3Ref<'_>) -> Soa3Ref<'_> {
        for i in 0..force.len() {
            self.force.set(i, force.get(i));
        }
        for body in &self.bodies {
            let arm = |i: usize| self.normal[i].cross(&force.get(i));
            let turn = body.inverse * (body.range.clone().map(arm).sum::<Vec3>() * self.depth);
            for i in body.range.clone() {
                self.force.add(i, turn.cross(&(self.y.get(i) - body.centre)));
            }
        }
        self.force.view()
    }
}

/// Unit normals of the nodes of a body at `x` (m).
fn normals(x: Soa3Ref<'_>, body: &Body, out: &mut [Vec3]) {
    out[body.range.clone()].fill(Vec3::zeros());
    for t in body.triangles.iter() {
        let t = t.map(|n| body.range.start + n as usize);
        let [a, b, c] = [x.get(t[0]), x.get(t[1]), x.get(t[2])];
        let area = (b - a).cross(&(c - a));
        t.iter().for_each(|&n| out[n] += area);
    }
    for n in &mut out[body.range.clone()] {
        *n = n.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    }
}
