//! Nodes against walls.

use crate::SoftSphere;
use lbm_ibm_coupling::{Boundary, ForceField, Loads, Vec3, View};
use std::sync::Arc;

/// Soft-sphere repulsion between every node and the walls; the walls feel the opposite force, part by part.
///
/// Against a wall that stays in place each node remembers how far it was when last probed, and is not probed again
/// until it could have come within reach: the distance of a [`Boundary`] never exceeds the true one.
pub struct WallRepulsion {
    walls: Arc<dyn Boundary>,
    law: SoftSphere,
    seen: Vec<Seen>,
    least: f64,
}

#[derive(Clone, Copy)]
struct Seen {
    at: Vec3,
    distance: f64,
}

const NEVER: Seen = Seen {
    at: Vec3::new(f64::NAN, f64::NAN, f64::NAN),
    distance: 0.0,
};

impl WallRepulsion {
    /// `law` between nodes and `walls`.
    pub fn new(walls: Arc<dyn Boundary>, law: SoftSphere) -> Self {
        Self {
            walls,
            law,
            seen: Vec::new(),
            least: f64::INFINITY,
        }
    }

    /// Least distance (m) of a node within reach since the start or the last [`WallRepulsion::forget_least`];
    /// infinite when none came within reach.
    pub fn least_distance(&self) -> f64 {
        self.least
    }

    /// Begins the search for the least distance anew.
    pub fn forget_least(&mut self) {
        self.least = f64::INFINITY;
    }
}

impl ForceField for WallRepulsion {
    fn name(&self) -> &str {
        "soft-sphere repulsion from walls"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        self.seen.resize(view.x.len(), NEVER);
        let fixed = self.walls.is_static();
        let reach = self.law.cutoff();
        for i in 0..view.x.len() {
            let x = view.x.get(i);
            let seen = &mut self.seen[i];
            // A NaN position that was never seen compares false and is probed.
            if fixed && (x - seen.at).norm() < seen.distance - reach {
                continue;
            }
            let probe = self.walls.probe(view.domain.wrap(x), view.time);
            *seen = Seen {
                at: x,
                distance: probe.distance,
            };
            if probe.distance < reach {
                self.least = self.least.min(probe.distance);
                let force = probe.normal * self.law.force(probe.distance);
                loads.node.add(i, force);
                loads.add_wall(probe.part, -force);
            }
        }
    }

    fn energy(&mut self, view: &View<'_>) -> Option<f64> {
        let distance = |x| self.walls.probe(view.domain.wrap(x), view.time).distance;
        Some(view.x.iter().map(|x| self.law.energy(distance(x))).sum())
    }

    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        Some(self.law.stiffness())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::{Domain, Plane, Soa3};

    fn view<'a>(x: &'a Soa3, domain: &'a Domain) -> View<'a> {
        View {
            x: x.view(),
            v: x.view(),
            bodies: &[],
            domain,
            time: 0.0,
            time_step: 1e-7,
            step: 0,
        }
    }

    #[test]
    fn wall_and_node_feel_opposite_forces_and_a_node_that_returns_is_seen() {
        let domain = Domain::unbounded();
        let floor = Arc::new(Plane::new(Vec3::zeros(), Vec3::y()).with_part(2));
        let law = SoftSphere::paper_wall();
        let mut field = WallRepulsion::new(floor, law);
        for height in [0.06e-6, 5e-6, 4e-6, 0.06e-6] {
            let mut x = Soa3::default();
            x.push(Vec3::new(1e-6, height, 0.0));
            let mut loads = Loads::new(1, 0);
            field.add_loads(&view(&x, &domain), &mut loads);
            let expected = law.force(height);
            assert_relative_eq!(loads.node.y[0], expected, max_relative = 1e-12);
            if expected > 0.0 {
                assert_relative_eq!(loads.wall[2].y, -expected, max_relative = 1e-12);
            }
        }
        assert_relative_eq!(field.least_distance(), 0.06e-6);
    }
}
