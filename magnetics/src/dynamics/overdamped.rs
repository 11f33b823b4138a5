//! Beads without inertia: velocity is mobility times force, on top of the fluid's.

mod step;

use super::contact::{BeadContact, ContactLaw, Site};
use super::drag::WallDrag;
use super::flow::Flow;
use super::mobility::PairMobility;
use super::regime::Regime;
use super::system::{BeadSystem, Stage};
use crate::bead::Bead;
use crate::error::MagneticsError;
use crate::model::{Model, Solution};
use crate::source::FieldSource;
use lbm_ibm_coupling::{Boundary, Soa3, Soa3Ref, Vec3};
use std::sync::Arc;

/// Overdamped beads: dx/dt = u(x, t) + mobility (magnetic force + weight + contact).
///
/// Steps are those of Bogacki and Shampine (third order, embedded second), as long as the tolerances on positions allow. With
/// contact as a constraint, each stage's velocities obey the contacts of the positions that they lead to: the pair distance is a
/// convex function of positions, so beads never enter each other; what curved walls leave is bounded and reported.
pub struct Overdamped {
    system: BeadSystem,
    velocity: Soa3,
    time: f64,
    step: f64,
    longest: f64,
    tolerance: f64,
    farthest: f64,
    regime: Regime,
    stage: Option<Stage>,
    steps: usize,
}

impl Overdamped {
    /// Beads at `x` (m) in the field of `source` in a fluid of `viscosity` (Pa s) at rest, without walls and weight.
    ///
    /// # Errors
    /// As [`BeadSystem::new`].
    pub fn new(
        beads: Vec<Bead>,
        x: Soa3,
        source: impl FieldSource + 'static,
        model: impl Model + 'static,
        viscosity: f64,
    ) -> Result<Self, MagneticsError> {
        Ok(Self::from(BeadSystem::new(beads, x, source, model, viscosity)?))
    }

    /// A flow u(x, t) (m, s, m/s) that carries the beads.
    pub fn with_flow(self, flow: impl Fn(Vec3, f64) -> Vec3 + Send + Sync + 'static) -> Self {
        self.in_flow(Flow::new(flow))
    }

    /// A flow that carries the beads.
    pub fn in_flow(self, flow: Flow) -> Self {
        self.map(|s| s.with_flow(flow))
    }

    /// Walls, for drag and contact.
    pub fn with_walls(self, walls: Arc<dyn Boundary>) -> Self {
        self.map(|s| s.with_walls(walls))
    }

    /// Gravity (m/s2) in a fluid of `density` (kg/m3): weight less buoyancy.
    pub fn with_gravity(self, gravity: Vec3, density: f64) -> Self {
        self.map(|s| s.with_gravity(gravity, density))
    }

    /// What keeps beads apart: a [`Constraint`](crate::Constraint), a [`Repulsion`](crate::Repulsion) or a [`ContactLaw`].
    pub fn with_contact(self, contact: impl Into<ContactLaw>) -> Self {
        self.map(|s| s.with_contact(contact))
    }

    /// Lets beads drag each other along.
    pub fn with_pair_mobility(self, mobility: PairMobility) -> Self {
        self.map(|s| s.with_pair_mobility(mobility))
    }

    /// Which drag beads have towards a wall (default [`WallDrag::Brenner`]).
    pub fn with_wall_drag(self, drag: WallDrag) -> Self {
        self.map(|s| s.with_wall_drag(drag))
    }

    /// Gap to a wall or to another bead, in radii, below which drag grows no more (default 1e-3).
    pub fn with_roughness(self, roughness: f64) -> Self {
        self.map(|s| s.with_roughness(roughness))
    }

    fn map(mut self, change: impl FnOnce(BeadSystem) -> BeadSystem) -> Self {
        self.system = change(self.system);
        self.stage = None;
        self
    }

    /// Error of positions allowed in a step, in radii (default 1e-4), and the longest step (s). Beads in contact are allowed
    /// ten times that, beads whose contacts open or close in the step a hundred times: their velocities jump.
    pub fn with_steps(mut self, tolerance: f64, longest: f64) -> Self {
        (self.tolerance, self.longest) = (tolerance, longest);
        self
    }

    /// Farthest that a bead may go in a step, in its radii (default 0.1).
    pub fn with_farthest(mut self, radii: f64) -> Self {
        self.farthest = radii;
        self
    }

    /// Holds bead `bead` where it is: a soft-magnetic pillar, the foot of a chain.
    pub fn freeze(&mut self, bead: usize) {
        self.system.freeze(bead);
        self.stage = None;
    }

    /// Another flow from now on.
    pub fn set_flow(&mut self, flow: Flow) {
        self.system.flow = flow;
        self.stage = None;
    }

    /// Tells that a live flow or the source has changed: forces and velocities are found anew in the next step.
    pub fn refresh(&mut self) {
        self.stage = None;
    }

    /// Centres, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.system.positions()
    }

    /// Velocities at the end of the last step, m/s.
    pub fn velocities(&self) -> Soa3Ref<'_> {
        self.velocity.view()
    }

    /// Forces on the beads but those of contact, at the end of the last step, N; none before the first step.
    pub fn forces(&self) -> Option<Soa3Ref<'_>> {
        self.stage.as_ref().map(|s| s.force.view())
    }

    /// Closed contacts at the end of the last step, with their forces.
    pub fn contacts(&self) -> &[BeadContact] {
        &self.system.contacts.reported
    }

    /// Deepest overlap of beads or with walls at the end of the last step, m; zero if nothing overlaps.
    pub fn overlap(&self) -> f64 {
        self.system.contacts.overlap
    }

    /// Moments and magnetic forces at the end of the last step.
    pub fn solution(&self) -> &Solution {
        &self.system.solution
    }

    /// The beads.
    pub fn beads(&self) -> &[Bead] {
        self.system.beads()
    }

    /// The beads and what is around them.
    pub fn system(&self) -> &BeadSystem {
        &self.system
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps made.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// How fast the beads have been.
    pub fn regime(&self) -> Regime {
        self.regime
    }

    /// Puts the beads at `x` (m) with these contacts.
    pub(super) fn rest_at(&mut self, x: Soa3, sites: Vec<Site>) -> Result<(), MagneticsError> {
        let stage = self.system.stage(x, self.time)?;
        self.system.x.clone_from(&stage.x);
        self.velocity = Soa3::zeros(stage.x.len());
        let overlap = sites.iter().map(|s| -s.gap).fold(0.0, f64::max);
        let time = self.time;
        self.system.contacts.accept(sites, overlap, |_| true, |_| time);
        self.stage = Some(stage);
        Ok(())
    }

    pub(super) fn system_mut(&mut self) -> &mut BeadSystem {
        &mut self.system
    }
}

impl From<BeadSystem> for Overdamped {
    fn from(system: BeadSystem) -> Self {
        Self {
            velocity: Soa3::zeros(system.beads.len()),
            system,
            time: 0.0,
            step: 1e-9,
            longest: f64::INFINITY,
            tolerance: 1e-4,
            farthest: 0.1,
            regime: Regime::default(),
            stage: None,
            steps: 0,
        }
    }
}
