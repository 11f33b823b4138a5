//! Nodes of different cells against each other.

use crate::SoftSphere;
use lbm_ibm_coupling::{BodyInfo, CellList, ForceField, Loads, Vec3, View};

/// Soft-sphere repulsion between nodes of different bodies, over the nearest periodic image.
pub struct CellRepulsion {
    law: SoftSphere,
    except: Vec<String>,
    list: CellList,
    body_of: Vec<u32>,
    /// Centre and radius (m) of a ball around each body that counts.
    balls: Vec<(Vec3, f64)>,
}

/// The body of a node that is left out.
const NOBODY: u32 = u32::MAX;

impl CellRepulsion {
    /// `law` between nodes of different bodies.
    pub fn new(law: SoftSphere) -> Self {
        Self {
            law,
            except: Vec::new(),
            list: CellList::new(),
            body_of: Vec::new(),
            balls: Vec::new(),
        }
    }

    /// Bodies of this kind are left out: beads, say, that [`BeadRepulsion`](crate::BeadRepulsion) takes care of.
    pub fn except(mut self, kind: impl Into<String>) -> Self {
        self.except.push(kind.into());
        self
    }

    fn find(&mut self, view: &View<'_>) {
        self.body_of.resize(view.x.len(), 0);
        for (b, body) in view.bodies.iter().enumerate() {
            let owner = if self.except.contains(&body.kind) {
                NOBODY
            } else {
                b as u32
            };
            self.body_of[body.range.clone()].fill(owner);
        }
        self.list.build(view.x, view.domain, self.law.cutoff());
    }

    /// Whether any two bodies could touch: balls about their nodes come within the cut-off. Many bodies are crowded, and the
    /// search by cells is the faster one.
    fn any_near(&mut self, view: &View<'_>) -> bool {
        const FEW: usize = 32;
        if view.bodies.len() > FEW {
            return true;
        }
        self.balls.clear();
        for body in view.bodies.iter().filter(|b| !self.except.contains(&b.kind)) {
            let nodes = || body.range.clone().map(|i| view.x.get(i));
            let centre = nodes().sum::<Vec3>() / body.range.len().max(1) as f64;
            let square = nodes().map(|x| (x - centre).norm_squared()).fold(0.0, f64::max);
            self.balls.push((centre, square.sqrt()));
        }
        let reach = self.law.cutoff();
        let apart = |(a, ra): &(Vec3, f64), (b, rb): &(Vec3, f64)| view.domain.shortest(a - b).norm() > ra + rb + reach;
        let balls = &self.balls;
        (0..balls.len()).any(|k| balls[..k].iter().any(|other| !apart(&balls[k], other)))
    }

    /// Calls `touch(i, j, direction from j to i, distance)` for every pair within reach.
    fn for_each_contact(&self, view: &View<'_>, mut touch: impl FnMut(usize, usize, Vec3, f64)) {
        self.list.for_each_pair(|i, j| {
            let owners = [self.body_of[i], self.body_of[j]];
            if owners[0] == owners[1] || owners.contains(&NOBODY) {
                return;
            }
            let d = view.domain.shortest(view.x.get(i) - view.x.get(j));
            let r = d.norm();
            if r < self.law.cutoff() && r > 0.0 {
                touch(i, j, d / r, r);
            }
        });
    }
}

impl ForceField for CellRepulsion {
    fn name(&self) -> &str {
        "soft-sphere repulsion between cells"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        if view.bodies.len() < 2 || !self.any_near(view) {
            return;
        }
        self.find(view);
        self.for_each_contact(view, |i, j, direction, r| {
            let force = direction * self.law.force(r);
            loads.node.add(i, force);
            loads.node.add(j, -force);
        });
    }

    fn energy(&mut self, view: &View<'_>) -> Option<f64> {
        if view.bodies.len() < 2 || !self.any_near(view) {
            return Some(0.0);
        }
        self.find(view);
        let mut sum = 0.0;
        self.for_each_contact(view, |_, _, _, r| sum += self.law.energy(r));
        Some(sum)
    }

    fn stiffness(&self, view: &View<'_>) -> Option<f64> {
        (view.bodies.len() > 1).then(|| self.law.stiffness())
    }

    fn stiffness_on(&self, view: &View<'_>, body: usize) -> Option<f64> {
        let counts = |b: &BodyInfo| !self.except.contains(&b.kind);
        let others = view.bodies.iter().filter(|b| counts(b)).count() > 1;
        (others && counts(&view.bodies[body])).then(|| self.law.stiffness())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::{Domain, Motion, Soa3};

    fn body(id: u32, range: std::ops::Range<usize>) -> BodyInfo {
        BodyInfo {
            id,
            kind: "cell".into(),
            range,
            triangles: [].into(),
            motion: Motion::Advected,
        }
    }

    #[test]
    fn only_different_cells_repel_and_they_do_it_over_the_period() {
        let um = 1e-6;
        let domain = Domain {
            origin: Vec3::zeros(),
            size: Vec3::repeat(10.0 * um),
            periodic: [true; 3],
        };
        let x: Soa3 = [[0.05, 5.0, 5.0], [0.15, 5.0, 5.0], [9.9, 5.0, 5.0]]
            .map(|p| Vec3::from(p) * um)
            .into_iter()
            .collect();
        let bodies = [body(0, 0..2), body(1, 2..3)];
        let view = View {
            x: x.view(),
            v: x.view(),
            bodies: &bodies,
            domain: &domain,
            time: 0.0,
            time_step: 1e-7,
            step: 0,
        };
        let law = SoftSphere::paper_cell();
        let mut loads = Loads::new(3, 2);
        CellRepulsion::new(law).add_loads(&view, &mut loads);
        let (near, far) = (law.force(0.15 * um), law.force(0.25 * um));
        assert_relative_eq!(loads.node.x[0], near, max_relative = 1e-9);
        assert_relative_eq!(loads.node.x[1], far, max_relative = 1e-9);
        assert_relative_eq!(loads.node.x[2], -near - far, max_relative = 1e-9);
        let mut none = Loads::new(3, 2);
        CellRepulsion::new(law).except("cell").add_loads(&view, &mut none);
        assert_eq!(none.node.x, [0.0; 3]);
    }
}
