//! Rigid bodies in a step.

use super::{Fluid, Scene};
use crate::{Exchange, Loads, RigidDrive, RigidState, SceneError, Soa3, Vec3, Wrench};
use nalgebra::{Isometry3, Point3};
use std::any::Any;

impl Fluid {
    /// Adds to the bricks the forces that make rigid bodies move as such, and finds their velocities.
    pub(super) fn hold_rigid(
        &mut self,
        bodies: &mut [RigidState],
        x: &Soa3,
        loads: &Loads,
        infos: &[crate::BodyInfo],
    ) -> Result<(), SceneError> {
        let (dt, density) = (self.lattice.time_step(), self.lattice.density());
        for state in bodies.iter_mut() {
            let load = wrench_of_nodes(state, x, loads, infos[state.body].range.clone());
            state.begin(load, density, dt);
        }
        // What the fluid does without them: under all other forces.
        self.lattice.read_velocity(&mut self.bricks);
        let viscosity = self.lattice.viscosity();
        self.exchange
            .hold_rigid(bodies, density, viscosity, dt, &mut self.bricks)?;
        Ok(())
    }
}

/// The sum of the loads on the nodes of a rigid body, about its centre of mass.
fn wrench_of_nodes(state: &RigidState, x: &Soa3, loads: &Loads, range: std::ops::Range<usize>) -> Wrench {
    let centre = state.pose.translation.vector;
    let mut sum = Wrench::zero();
    for i in range {
        let force = loads.node.get(i);
        sum.force += force;
        sum.torque += (x.get(i) - centre).cross(&force);
    }
    sum
}

/// Moves rigid bodies by one step of `dt` (s), and their nodes with them.
pub(super) fn advance(scene: &mut Scene) {
    for state in &mut scene.rigid {
        let range = scene.infos[state.body].range.clone();
        for i in range.clone() {
            let velocity = state.velocity_at(scene.x.get(i));
            scene.v.set(i, velocity);
            scene.fluid_velocity.set(i, velocity);
        }
        state.finish(scene.time_step);
        let reference = scene.bodies[state.body].body.reference();
        for (i, p) in range.zip(reference.iter()) {
            scene.x.set(i, (state.pose * Point3::from(p)).coords);
        }
    }
}

impl Scene {
    /// The exchange as the type that it is.
    pub fn exchange_as<T: Exchange>(&self) -> Option<&T> {
        let exchange: &dyn Any = self.fluid.as_ref()?.exchange.as_ref();
        exchange.downcast_ref()
    }

    /// The rigid bodies, in the order of [`Scene::bodies`].
    pub fn rigid_bodies(&self) -> &[RigidState] {
        &self.rigid
    }

    fn rigid_index(&self, id: u32) -> Result<usize, SceneError> {
        let info = &self.infos[self.index(id)?];
        let found = self.rigid.iter().position(|r| r.id == id);
        found.ok_or_else(|| SceneError::NotRigid {
            body: id,
            kind: info.kind.clone(),
        })
    }

    /// A rigid body's state: pose, velocity, angular velocity.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::NotRigid`].
    pub fn rigid_body(&self, id: u32) -> Result<&RigidState, SceneError> {
        Ok(&self.rigid[self.rigid_index(id)?])
    }

    /// Place (m, not wrapped) and rotation of a rigid body.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::NotRigid`].
    pub fn pose(&self, id: u32) -> Result<Isometry3<f64>, SceneError> {
        Ok(self.rigid_body(id)?.pose)
    }

    /// Force (N) and torque (N m) about its centre of the fluid on a rigid body in the last step.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::NotRigid`].
    pub fn wrench_on(&self, id: u32) -> Result<Wrench, SceneError> {
        Ok(self.rigid_body(id)?.from_fluid())
    }

    /// Changes what drives a rigid body; one that is set free starts with the velocity it had.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::NotRigid`]; [`SceneError::NotFiniteMotion`].
    pub fn set_drive(&mut self, id: u32, drive: RigidDrive) -> Result<(), SceneError> {
        let at = self.rigid_index(id)?;
        if let RigidDrive::Given {
            velocity,
            angular_velocity,
        } = drive
            && !(velocity + angular_velocity).iter().all(|c: &f64| c.is_finite())
        {
            return Err(SceneError::NotFiniteMotion { body: id });
        }
        self.rigid[at].drive(drive);
        Ok(())
    }

    /// Puts a rigid body elsewhere; its velocity stays.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::NotRigid`].
    pub fn set_pose(&mut self, id: u32, pose: &Isometry3<f64>) -> Result<(), SceneError> {
        let at = self.rigid_index(id)?;
        let state = &mut self.rigid[at];
        state.pose = *pose;
        let reference = self.bodies[state.body].body.reference();
        for (i, p) in self.infos[state.body].range.clone().zip(reference.iter()) {
            self.x.set(i, (pose * Point3::from(p)).coords);
        }
        Ok(())
    }

    /// Time step (s) over which forces of `stiffness` (N/m) between rigid bodies make them jump past each other:
    /// `sqrt(m / 2k)`, `m` the least mass that a step accelerates, that is a body's excess over the fluid's and the layer
    /// of fluid about its surface. In a line of bodies each is held from both sides, and the stiffest motion, neighbours
    /// against each other, has `4k`; half of the limit of an oscillator leaves the layer's friction out of account.
    pub(super) fn rigid_step_limit(&self, id: u32, stiffness: f64) -> Option<f64> {
        let fluid = self.fluid.as_ref()?;
        let state = self.rigid.iter().find(|r| r.id == id)?;
        if state.rigid.drive != RigidDrive::Free {
            return None;
        }
        let density = fluid.lattice.density();
        let mass = state.excess_mass(density).max(0.0) + fluid.exchange.rigid_layer(id, density);
        Some((mass / (2.0 * stiffness)).sqrt())
    }

    /// The scene's rigid bodies anew after bodies have come or gone.
    pub(super) fn number_rigid(&mut self) {
        for state in &mut self.rigid {
            // Every state belongs to a body of the scene.
            state.body = self.infos.iter().position(|b| b.id == state.id).unwrap_or_default();
        }
    }

    /// Tells the exchange of the rigid bodies.
    pub(super) fn tell_rigid(&mut self) -> Result<(), SceneError> {
        let Some(fluid) = &mut self.fluid else {
            return Ok(());
        };
        if self.rigid.is_empty() && !self.had_rigid {
            return Ok(());
        }
        self.had_rigid = true;
        let bodies: Vec<_> = self
            .rigid
            .iter()
            .map(|r| (r.id, self.bodies[r.body].body.as_ref()))
            .collect();
        fluid.exchange.set_rigid(&bodies, fluid.lattice.grid())?;
        Ok(())
    }
}

/// Where the nodes of a body go under `pose`.
pub(super) fn placed(reference: crate::Soa3Ref<'_>, pose: &Isometry3<f64>) -> Soa3 {
    let at = |p: Vec3| (pose * Point3::from(p)).coords;
    reference.iter().map(at).collect()
}
