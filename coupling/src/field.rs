//! What pushes bodies.

use crate::{BodyInfo, Domain, Soa3, Soa3Ref, StateError, StateReader, StateWriter, Vec3};
use nalgebra::Matrix3;
use std::any::Any;

/// What a [`ForceField`] sees of a scene.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Node positions, m, not wrapped into the periodic box.
    pub x: Soa3Ref<'a>,
    /// Node velocities, m/s.
    pub v: Soa3Ref<'a>,
    /// The bodies and their ranges of nodes.
    pub bodies: &'a [BodyInfo],
    /// The box and its periods.
    pub domain: &'a Domain,
    /// Time, s.
    pub time: f64,
    /// Time step, s.
    pub time_step: f64,
    /// Steps taken.
    pub step: u64,
}

/// A force (N) and a torque (N m) about the centroid of a body's nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force: Vec3,
    /// Torque, N m.
    pub torque: Vec3,
}

impl Wrench {
    /// Neither force nor torque.
    pub fn zero() -> Self {
        Self {
            force: Vec3::zeros(),
            torque: Vec3::zeros(),
        }
    }
}

/// Where forces are gathered in a step.
#[derive(Clone, Debug, Default)]
pub struct Loads {
    /// Force on each node, N.
    pub node: Soa3,
    /// Force and torque on each body as a whole, in the order of [`View::bodies`].
    pub body: Vec<Wrench>,
    /// Force on each wall part, N: what walls feel of the bodies.
    pub wall: Vec<Vec3>,
}

impl Loads {
    /// No load on `nodes` nodes and `bodies` bodies.
    pub fn new(nodes: usize, bodies: usize) -> Self {
        Self {
            node: Soa3::zeros(nodes),
            body: vec![Wrench::zero(); bodies],
            wall: Vec::new(),
        }
    }

    /// Makes room for more nodes and bodies, without loads.
    pub(crate) fn resize(&mut self, nodes: usize, bodies: usize) {
        self.node.resize(nodes);
        self.body.resize(bodies, Wrench::zero());
    }

    /// Back to zero, sizes kept.
    pub fn clear(&mut self) {
        self.node.fill(0.0);
        self.clear_sums();
    }

    /// The same for all but the nodes.
    pub(crate) fn clear_sums(&mut self) {
        self.body.fill(Wrench::zero());
        self.wall.fill(Vec3::zeros());
    }

    /// Adds the force (N) that a wall part feels.
    pub fn add_wall(&mut self, part: u32, force: Vec3) {
        let part = part as usize;
        if part >= self.wall.len() {
            self.wall.resize(part + 1, Vec3::zeros());
        }
        self.wall[part] += force;
    }

    /// Hands the load on each whole body to its nodes: the force in equal shares, the torque as the forces of least
    /// norm that have it (those of a rigid turn about the centroid).
    pub fn share_among_nodes(&mut self, view: &View<'_>) {
        for (body, wrench) in view.bodies.iter().zip(&self.body) {
            if *wrench == Wrench::zero() {
                continue;
            }
            let centre = view
                .x
                .iter()
                .skip(body.range.start)
                .take(body.range.len())
                .sum::<Vec3>()
                / body.range.len() as f64;
            let share = wrench.force / body.range.len() as f64;
            let mut inertia = Matrix3::zeros();
            for i in body.range.clone() {
                let r = view.x.get(i) - centre;
                inertia += Matrix3::identity() * r.norm_squared() - r * r.transpose();
            }
            let turn = inertia.try_inverse().map_or(Vec3::zeros(), |inv| inv * wrench.torque);
            for i in body.range.clone() {
                let r = view.x.get(i) - centre;
                self.node.add(i, share + turn.cross(&r));
            }
        }
    }
}

/// What pushes bodies: contact, bonds, tweezers, gravity, magnetic dipoles, a user's own.
///
/// ```
/// use lbm_ibm_coupling::{ForceField, Loads, Vec3, View};
///
/// /// A uniform weight on every body.
/// struct Weight(Vec3);
///
/// impl ForceField for Weight {
///     fn name(&self) -> &str {
///         "weight"
///     }
///     fn add_loads(&mut self, view: &View, loads: &mut Loads) {
///         for body in 0..view.bodies.len() {
///             loads.body[body].force += self.0;
///         }
///     }
/// }
/// ```
pub trait ForceField: Any + Send {
    /// What it is, for reports and errors.
    fn name(&self) -> &str;

    /// Adds its forces to `loads`. Called once a step.
    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads);

    /// Potential energy, J, where it has one.
    fn energy(&mut self, _view: &View<'_>) -> Option<f64> {
        None
    }

    /// Writes what it remembers from step to step, for [`crate::Scene::save`]. By default that is nothing.
    fn save(&self, _to: &mut StateWriter) {}

    /// Takes what [`ForceField::save`] has written.
    ///
    /// # Errors
    /// [`StateError`].
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Ok(())
    }

    /// Greatest stiffness (N/m) it expects to put on a single node; the time step is checked against it.
    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        None
    }

    /// The same on body number `body` of [`View::bodies`] alone; by default that of [`ForceField::stiffness`].
    fn stiffness_on(&self, view: &View<'_>, _body: usize) -> Option<f64> {
        self.stiffness(view)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Motion;
    use approx::assert_relative_eq;

    #[test]
    fn a_shared_wrench_keeps_force_and_torque() {
        let x: Soa3 = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.3], [-1.0, 0.2, 0.0], [0.4, -1.0, 1.0]]
            .map(Vec3::from)
            .into_iter()
            .collect();
        let bodies = [BodyInfo {
            id: 0,
            kind: "four nodes".into(),
            range: 0..4,
            triangles: [].into(),
            motion: Motion::Advected,
        }];
        let view = View {
            x: x.view(),
            v: x.view(),
            bodies: &bodies,
            domain: &Domain::unbounded(),
            time: 0.0,
            time_step: 1.0,
            step: 0,
        };
        let mut loads = Loads::new(4, 1);
        let wrench = Wrench {
            force: Vec3::new(1.0, -2.0, 0.5),
            torque: Vec3::new(0.3, 0.1, -0.7),
        };
        loads.body[0] = wrench;
        loads.share_among_nodes(&view);
        let centre = x.view().mean();
        let force: Vec3 = loads.node.iter().sum();
        let torque: Vec3 = loads
            .node
            .iter()
            .zip(x.iter())
            .map(|(f, x)| (x - centre).cross(&f))
            .sum();
        assert_relative_eq!(force, wrench.force, epsilon = 1e-14);
        assert_relative_eq!(torque, wrench.torque, epsilon = 1e-14);
    }
}
