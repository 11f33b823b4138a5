//! Nodes against walls.

use crate::SoftSphere;
use lbm_ibm_coupling::{Boundary, ForceField, Loads, StateError, StateReader, StateWriter, Vec3, View};
use std::sync::Arc;

/// Soft-sphere repulsion between every node and the walls; the walls feel the opposite force, part by part.
///
/// Against a wall that stays in place each node remembers how far it was when last probed, and is not probed again
/// until it could have come within reach: the distance of a [`Boundary`] never exceeds the true one.
pub struct WallRepulsion {
    walls: Arc<dyn Boundary>,
    law: SoftSphere,
    except: Vec<String>,
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
            except: Vec::new(),
            seen: Vec::new(),
            least: f64::INFINITY,
        }
    }

    /// Bodies of this kind are left out: beads, say, that [`BeadRepulsion`](crate::BeadRepulsion) takes care of.
    pub fn except(mut self, kind: impl Into<String>) -> Self {
        self.except.push(kind.into());
        self
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
        let except = &self.except;
        let touched = view.bodies.iter().filter(|b| !except.contains(&b.kind));
        for i in touched.flat_map(|b| b.range.clone()) {
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

    fn save(&self, to: &mut StateWriter) {
        to.number(self.least);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        // Where nodes have been seen is found anew.
        self.seen.clear();
        self.least = from.number()?;
        Ok(())
    }

    fn energy(&mut self, view: &View<'_>) -> Option<f64> {
        let distance = |i| self.walls.probe(view.domain.wrap(view.x.get(i)), view.time).distance;
        let touched = view.bodies.iter().filter(|b| !self.except.contains(&b.kind));
        Some(
            touched
                .flat_map(|b| b.range.clone())
                .map(|i| self.law.energy(distance(i)))
                .sum(),
        )
    }

    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        Some(self.law.stiffness())
    }

    fn stiffness_on(&self, view: &View<'_>, body: usize) -> Option<f64> {
        let touched = !self.except.contains(&view.bodies[body].kind);
        touched.then(|| self.law.stiffness())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::{BodyInfo, Domain, Motion, Plane, Soa3};

    fn view<'a>(x: &'a Soa3, domain: &'a Domain, bodies: &'a [BodyInfo]) -> View<'a> {
        View {
            x: x.view(),
            v: x.view(),
            bodies,
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
        let mut field = WallRepulsion::new(floor, law).except("bead");
        let body = |kind: &str, range| BodyInfo {
            id: 0,
            kind: kind.into(),
            range,
            triangles: [].into(),
            motion: Motion::Advected,
        };
        let bodies = [body("cell", 0..1), body("bead", 1..2)];
        for height in [0.06e-6, 5e-6, 4e-6, 0.06e-6] {
            let mut x = Soa3::default();
            x.push(Vec3::new(1e-6, height, 0.0));
            x.push(Vec3::new(1e-6, 0.05e-6, 0.0));
            let mut loads = Loads::new(2, 2);
            field.add_loads(&view(&x, &domain, &bodies), &mut loads);
            assert_eq!(loads.node.y[1], 0.0);
            let expected = law.force(height);
            assert_relative_eq!(loads.node.y[0], expected, max_relative = 1e-12);
            if expected > 0.0 {
                assert_relative_eq!(loads.wall[2].y, -expected, max_relative = 1e-12);
            }
        }
        assert_relative_eq!(field.least_distance(), 0.06e-6);
    }
}
