//! Spherical beads against each other, against walls and against the nodes of cells.

use crate::{ContactError, SoftSphere};
use lbm_ibm_coupling::{Boundary, CellList, ForceField, Loads, Soa3, StateError, StateReader, StateWriter, Vec3, View};
use std::sync::Arc;

/// Soft-sphere repulsion of beads by the gap between surfaces: bead and bead, bead and wall, bead and the nodes of all other
/// bodies, over the nearest periodic image. Frictionless, so that beads get forces and no torque.
///
/// A body is a bead if its kind has been named; its centre is the mean of its nodes.
pub struct BeadRepulsion {
    law: SoftSphere,
    node_law: SoftSphere,
    walls: Option<Arc<dyn Boundary>>,
    kinds: Vec<(String, f64)>,
    beads: Vec<Bead>,
    /// Bead centres, then the nodes of all other bodies.
    points: Soa3,
    /// The node that each point after the beads is.
    nodes: Vec<usize>,
    list: CellList,
    least: f64,
}

struct Bead {
    body: usize,
    radius: f64,
}

/// What a bead touches.
enum Touch {
    Bead(usize),
    Node(usize),
    Wall(u32),
}

impl BeadRepulsion {
    /// `law` over the gap between surfaces; no body is a bead yet.
    pub fn new(law: SoftSphere) -> Self {
        Self {
            law,
            node_law: law,
            walls: None,
            kinds: Vec::new(),
            beads: Vec::new(),
            points: Soa3::default(),
            nodes: Vec::new(),
            list: CellList::new(),
            least: f64::INFINITY,
        }
    }

    /// Another law between beads and the nodes of other bodies: those of a cell bear less than a bead.
    pub fn with_node_law(mut self, law: SoftSphere) -> Self {
        self.node_law = law;
        self
    }

    /// Bodies of this kind are beads of `radius`, m.
    ///
    /// # Errors
    /// [`ContactError::NotPositive`].
    pub fn with_kind(mut self, kind: impl Into<String>, radius: f64) -> Result<Self, ContactError> {
        if !(radius.is_finite() && radius > 0.0) {
            return Err(ContactError::NotPositive {
                what: "the radius of a bead (m)",
                value: radius,
            });
        }
        self.kinds.push((kind.into(), radius));
        Ok(self)
    }

    /// Beads are kept off these walls, too.
    pub fn with_walls(mut self, walls: Arc<dyn Boundary>) -> Self {
        self.walls = Some(walls);
        self
    }

    /// Least gap (m) between the surface of a bead and anything within reach in the last step; infinite when none was.
    pub fn least_gap(&self) -> f64 {
        self.least
    }

    fn law(&self, what: &Touch) -> &SoftSphere {
        match what {
            Touch::Node(_) => &self.node_law,
            Touch::Bead(_) | Touch::Wall(_) => &self.law,
        }
    }

    fn find(&mut self, view: &View<'_>) {
        self.beads.clear();
        self.points.resize(0);
        self.nodes.clear();
        for (body, info) in view.bodies.iter().enumerate() {
            let named = self.kinds.iter().find(|(kind, _)| *kind == info.kind);
            match named {
                Some(&(_, radius)) => {
                    let sum: Vec3 = info.range.clone().map(|i| view.x.get(i)).sum();
                    self.points.push(sum / info.range.len().max(1) as f64);
                    self.beads.push(Bead { body, radius });
                }
                None => self.nodes.extend(info.range.clone()),
            }
        }
        for i in &self.nodes {
            self.points.push(view.x.get(*i));
        }
        let largest = self.beads.iter().map(|b| b.radius).fold(0.0, f64::max);
        self.list
            .build(self.points.view(), view.domain, 2.0 * largest + self.law.cutoff());
    }

    /// Calls `touch(bead, what, direction to the bead, gap)` for every contact within reach, bead pairs once.
    fn for_each_contact(&self, view: &View<'_>, mut touch: impl FnMut(usize, Touch, Vec3, f64)) {
        let (reach, beads) = (self.law.cutoff(), self.beads.len());
        let node_reach = self.node_law.cutoff();
        self.list.for_each_pair(|i, j| {
            let (i, j) = (i.min(j), i.max(j));
            if i >= beads {
                return;
            }
            let d = view.domain.shortest(self.points.get(i) - self.points.get(j));
            let other = if j < beads { self.beads[j].radius } else { 0.0 };
            let r = d.norm();
            let gap = r - self.beads[i].radius - other;
            if gap < (if j < beads { reach } else { node_reach }) && r > 0.0 {
                let what = if j < beads {
                    Touch::Bead(j)
                } else {
                    Touch::Node(self.nodes[j - beads])
                };
                touch(i, what, d / r, gap);
            }
        });
        let Some(walls) = &self.walls else { return };
        for (i, bead) in self.beads.iter().enumerate() {
            let probe = walls.probe(view.domain.wrap(self.points.get(i)), view.time);
            let gap = probe.distance - bead.radius;
            if gap < reach {
                touch(i, Touch::Wall(probe.part), probe.normal, gap);
            }
        }
    }
}

impl ForceField for BeadRepulsion {
    fn name(&self) -> &str {
        "soft-sphere repulsion of beads"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        self.find(view);
        let mut least = f64::INFINITY;
        self.for_each_contact(view, |i, what, direction, gap| {
            least = least.min(gap);
            let force = direction * self.law(&what).force(gap);
            loads.body[self.beads[i].body].force += force;
            match what {
                Touch::Bead(j) => loads.body[self.beads[j].body].force -= force,
                Touch::Node(node) => loads.node.add(node, -force),
                Touch::Wall(part) => loads.add_wall(part, -force),
            }
        });
        self.least = least;
    }

    fn save(&self, to: &mut StateWriter) {
        to.number(self.least);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.least = from.number()?;
        Ok(())
    }

    fn energy(&mut self, view: &View<'_>) -> Option<f64> {
        self.find(view);
        let mut sum = 0.0;
        self.for_each_contact(view, |_, what, _, gap| sum += self.law(&what).energy(gap));
        Some(sum)
    }

    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        Some(self.law.stiffness().max(self.node_law.stiffness()))
    }

    fn stiffness_on(&self, view: &View<'_>, body: usize) -> Option<f64> {
        let is_bead = self.kinds.iter().any(|(kind, _)| *kind == view.bodies[body].kind);
        Some(if is_bead {
            self.law.stiffness()
        } else {
            self.node_law.stiffness()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::{BodyInfo, Domain, Motion, Plane};

    const UM: f64 = 1e-6;

    fn body(id: u32, kind: &str, range: std::ops::Range<usize>) -> BodyInfo {
        BodyInfo {
            id,
            kind: kind.into(),
            range,
            triangles: [].into(),
            motion: Motion::Frozen,
        }
    }

    #[test]
    fn a_bead_is_kept_off_bead_node_and_wall_and_forces_balance() {
        // A bead of two nodes on the floor, a bead over the period beside it, a node of a cell above it.
        let x: Soa3 = [[1.0, 1.0, 1.05], [1.0, 3.0, 1.05], [9.05, 2.0, 1.05], [1.0, 2.0, 2.08]]
            .map(|p| Vec3::from(p) * UM)
            .into_iter()
            .collect();
        let domain = Domain {
            origin: Vec3::zeros(),
            size: Vec3::repeat(10.0 * UM),
            periodic: [true, true, false],
        };
        let bodies = [body(0, "bead", 0..2), body(1, "bead", 2..3), body(2, "cell", 3..4)];
        let view = View {
            x: x.view(),
            v: x.view(),
            bodies: &bodies,
            domain: &domain,
            time: 0.0,
            time_step: 1e-7,
            step: 0,
        };
        let law = SoftSphere::paper_wall();
        let floor = Arc::new(Plane::new(Vec3::zeros(), Vec3::z()));
        let mut field = BeadRepulsion::new(law)
            .with_kind("bead", 1.0 * UM)
            .unwrap()
            .with_walls(floor);
        let mut loads = Loads::new(4, 3);
        field.add_loads(&view, &mut loads);
        let (floor, node) = (law.force(0.05 * UM), law.force(0.03 * UM));
        assert_relative_eq!(loads.body[0].force.z, floor - node, max_relative = 1e-6);
        assert_relative_eq!(loads.node.z[3], node, max_relative = 1e-6);
        // 1.95 um between centres over the period: an overlap of 0.05 um, which the law takes on in a straight line.
        assert_relative_eq!(loads.body[0].force.x, law.force(-0.05 * UM), max_relative = 1e-6);
        let all = loads.body.iter().map(|w| w.force).sum::<Vec3>() + loads.node.iter().sum::<Vec3>() + loads.wall[0];
        assert!(all.norm() < 1e-12 * floor);
        assert_relative_eq!(field.least_gap(), -0.05 * UM, max_relative = 1e-6);
        assert!(field.energy(&view).unwrap() > 0.0);
    }

    #[test]
    fn a_bead_without_radius_is_refused() {
        let law = SoftSphere::paper_wall();
        assert!(BeadRepulsion::new(law).with_kind("bead", 0.0).is_err());
    }
}
