//! Beads without inertia: velocity is mobility times force, on top of the fluid's.

mod step;

use super::drag::PairMobility;
use crate::bead::Bead;
use crate::error::{MagneticsError, positive};
use crate::model::{Model, Problem, Solution};
use crate::source::FieldSource;
use lbm_ibm_coupling::{Boundary, Soa3, Soa3Ref, Vec3};
use std::sync::Arc;

type Flow = Box<dyn Fn(Vec3, f64) -> Vec3 + Send + Sync>;

/// A force that keeps beads apart: strength exp(-gap/range), between beads and from walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion {
    /// Force at contact, N.
    pub strength: f64,
    /// Gap over which it falls by e, m.
    pub range: f64,
}

/// How fast the beads have been: overdamped motion needs both numbers small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Regime {
    /// Greatest Reynolds number of a bead so far, rho |v - u| a/eta.
    pub reynolds: f64,
    /// Greatest Stokes number of a bead so far, 2/9 rho_bead |v - u| a/eta.
    pub stokes: f64,
}

impl Regime {
    /// Whether inertia is nothing: both numbers at most 0.1.
    pub fn is_overdamped(&self) -> bool {
        self.reynolds <= 0.1 && self.stokes <= 0.1
    }
}

/// Overdamped beads: dx/dt = u(x, t) + mobility (magnetic force + weight + repulsion).
///
/// Steps are those of Bogacki and Shampine (third order, embedded second), as long as the tolerance on positions allows.
pub struct Overdamped {
    beads: Vec<Bead>,
    frozen: Vec<bool>,
    x: Soa3,
    velocity: Soa3,
    time: f64,
    step: f64,
    longest: f64,
    tolerance: f64,
    viscosity: f64,
    density: f64,
    gravity: Vec3,
    source: Arc<dyn FieldSource>,
    model: Box<dyn Model>,
    flow: Option<Flow>,
    walls: Option<Arc<dyn Boundary>>,
    repulsion: Option<Repulsion>,
    mobility: PairMobility,
    roughness: f64,
    solution: Solution,
    regime: Regime,
    fresh: bool,
}

impl Overdamped {
    /// Beads at `x` (m) in the field of `source` in a fluid of `viscosity` (Pa s) at rest, without walls and weight.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the viscosity, [`MagneticsError::Count`], [`MagneticsError::NotFinite`],
    /// [`MagneticsError::Overlap`] for beads that overlap at the start.
    pub fn new(
        beads: Vec<Bead>,
        x: Soa3,
        source: impl FieldSource + 'static,
        model: impl Model + 'static,
        viscosity: f64,
    ) -> Result<Self, MagneticsError> {
        positive("viscosity (Pa s)", viscosity)?;
        let smallest = beads.iter().map(Bead::radius).fold(f64::INFINITY, f64::min);
        Problem::new(&beads, x.view(), &source, 0.0)?.check_overlap(1e-9 * smallest)?;
        let n = beads.len();
        Ok(Self {
            beads,
            frozen: vec![false; n],
            velocity: Soa3::zeros(n),
            x,
            time: 0.0,
            step: 1e-9,
            longest: f64::INFINITY,
            tolerance: 1e-5,
            viscosity,
            density: 1000.0,
            gravity: Vec3::zeros(),
            source: Arc::new(source),
            model: Box::new(model),
            flow: None,
            walls: None,
            repulsion: None,
            mobility: PairMobility::None,
            roughness: 1e-3,
            solution: Solution::new(),
            regime: Regime::default(),
            fresh: false,
        })
    }

    /// A flow u(x, t) (m, s, m/s) that carries the beads.
    pub fn with_flow(mut self, flow: impl Fn(Vec3, f64) -> Vec3 + Send + Sync + 'static) -> Self {
        self.flow = Some(Box::new(flow));
        self
    }

    /// Walls, for drag and repulsion.
    pub fn with_walls(mut self, walls: Arc<dyn Boundary>) -> Self {
        self.walls = Some(walls);
        self
    }

    /// Gravity (m/s2) in a fluid of `density` (kg/m3): weight less buoyancy.
    pub fn with_gravity(mut self, gravity: Vec3, density: f64) -> Self {
        (self.gravity, self.density) = (gravity, density);
        self
    }

    /// Keeps beads apart.
    pub fn with_repulsion(mut self, repulsion: Repulsion) -> Self {
        self.repulsion = Some(repulsion);
        self
    }

    /// Lets beads drag each other along.
    pub fn with_pair_mobility(mut self, mobility: PairMobility) -> Self {
        self.mobility = mobility;
        self
    }

    /// Error of positions allowed in a step, in radii (default 1e-5), and the longest step (s).
    pub fn with_steps(mut self, tolerance: f64, longest: f64) -> Self {
        (self.tolerance, self.longest) = (tolerance, longest);
        self
    }

    /// Gap to a wall, in radii, below which drag grows no more (default 1e-3).
    pub fn with_roughness(mut self, roughness: f64) -> Self {
        self.roughness = roughness;
        self
    }

    /// Holds bead `bead` where it is: a soft-magnetic pillar, the foot of a chain.
    pub fn freeze(&mut self, bead: usize) {
        self.frozen[bead] = true;
        self.fresh = false;
    }

    /// Centres, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.x.view()
    }

    /// Velocities at the end of the last step, m/s.
    pub fn velocities(&self) -> Soa3Ref<'_> {
        self.velocity.view()
    }

    /// Moments and magnetic forces at the end of the last step.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// The beads.
    pub fn beads(&self) -> &[Bead] {
        &self.beads
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// How fast the beads have been.
    pub fn regime(&self) -> Regime {
        self.regime
    }
}
