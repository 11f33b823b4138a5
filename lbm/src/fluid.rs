//! The fluid: its parameters, in SI units.

use crate::drive::{Balance, Drive};
use crate::element::Precision;
use crate::error::LbmError;
use crate::faces::Faces;
use crate::inner::Inner;
use crate::interpolate::Exchanged;
use crate::isa::InstructionSet;
use crate::kernel::Kernel;
use crate::links::Links;
use crate::mask::{Mask, NarrowGaps};
use crate::relaxation::{Collision, VelocitySet};
use crate::rule::{LinkRule, WallRule};
use crate::state::pays_to_pack;
use crate::storage::Storage;
use crate::thermal::Thermal;
use lbm_ibm_coupling::{Boundary, Grid, Lattice, Vec3};
use std::sync::Arc;

/// Least relaxation time that is accepted: below it no velocity worth computing is stable.
pub const LEAST_TAU: f64 = 0.5005;

/// What sets the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Pace {
    /// The time step, s.
    TimeStep(f64),
    /// The relaxation time, in time steps: `dt = (tau - 1/2)/3 dx^2 rho/mu`.
    Tau(f64),
}

/// A viscous fluid on a grid by the lattice-Boltzmann method, in place, walls by a [`WallRule`].
///
/// ```
/// use lbm_ibm_coupling::{Bricks, Grid, Lattice};
/// use lbm_ibm_lbm::{Drive, Fluid, Pace};
///
/// // Water between two plates 8 um apart, at a mean velocity of 1 mm/s.
/// let grid = Grid::new([4, 8, 4], 1e-6, [true, false, true]);
/// let bricks = Bricks::new(&grid);
/// let mut water = Fluid::new(grid, 1e3, 1e-3, Pace::Tau(1.5))?.with_drive(Drive::flux(0, 1e-3))?;
/// for _ in 0..400 {
///     water.advance(&bricks)?;
/// }
/// let exact = 12.0 * 1e-3 * 1e-3 / 8e-6_f64.powi(2); // 12 mu U / h^2
/// assert!((water.body_force().x / exact - 1.0).abs() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A Reynolds number is scaled by passing a larger density: the time step at a given tau grows with it.
pub struct Fluid {
    pub(crate) grid: Grid,
    pub(crate) density: f64,
    pub(crate) viscosity: f64,
    pub(crate) time_step: f64,
    pub(crate) tau: f64,
    /// None where the model is the user's.
    pub(crate) collision: Option<Collision>,
    pub(crate) velocity_set: VelocitySet,
    pub(crate) inertia: bool,
    pub(crate) narrow: NarrowGaps,
    pub(crate) wall_rule: Arc<dyn LinkRule>,
    pub(crate) mach_limit: f64,
    pub(crate) thermal: Option<Thermal>,
    pub(crate) drive: Drive,
    pub(crate) isa: InstructionSet,
    pub(crate) kernel: Box<dyn Kernel>,
    pub(crate) inner: Inner,
    pub(crate) storage: Storage,
    /// The walls, and the time at which they were taken.
    pub(crate) walls: (Option<Arc<dyn Boundary>>, f64),
    pub(crate) mask: Mask,
    pub(crate) faces: Faces,
    pub(crate) links: Links,
    pub(crate) balances: Vec<Balance>,
    /// What thin walls have sent and got in the last step.
    pub(crate) exchanged: Vec<Exchanged>,
    /// What interpolation has added to the marked links of packed nodes in the last step, where that is kept.
    pub(crate) more: Vec<f64>,
    /// Packed nodes that are collided before links are seen to.
    pub(crate) slab: usize,
    /// Velocity, lattice units, by which interpolated walls gave way in the last step.
    pub(crate) shrink: f64,
    /// Mass that interpolated links have gained and not given back, after the last step and the one before, lattice units.
    pub(crate) owed: [f64; 2],
    pub(crate) odd: bool,
    pub(crate) at_rest: bool,
    pub(crate) steps: u64,
    /// Uniform force of the last step and of the next, lattice units.
    pub(crate) force: [[f64; 2]; 3],
    /// Sum of the bodies' forces in the last step, lattice units.
    pub(crate) bodies: [f64; 3],
    /// Superficial velocity after the last step, lattice units, where the drive has needed it.
    pub(crate) flow: Option<[f64; 3]>,
    pub(crate) slots: Vec<([usize; 3], u64)>,
}

impl Fluid {
    /// A fluid at rest of `density` (kg/m3) and dynamic `viscosity` (Pa s), without walls but for the faces of the grid
    /// that are not periodic. Collision is TRT with magic number 3/16; nothing drives it.
    ///
    /// # Errors
    /// [`LbmError::NotPositive`], [`LbmError::EmptyGrid`], [`LbmError::GridTooLarge`],
    /// [`LbmError::RelaxationTime`], [`LbmError::Walls`].
    pub fn new(grid: Grid, density: f64, viscosity: f64, pace: Pace) -> Result<Self, LbmError> {
        let spacing = grid.spacing;
        for (name, value) in [
            ("grid spacing", spacing),
            ("density", density),
            ("viscosity", viscosity),
        ] {
            positive(name, value)?;
        }
        if grid.is_empty() {
            return Err(LbmError::EmptyGrid { shape: grid.shape });
        }
        let diffusive = spacing * spacing * density / viscosity;
        let step_at = |tau: f64| (tau - 0.5) / 3.0 * diffusive;
        let (tau, time_step) = match pace {
            Pace::TimeStep(dt) => (0.5 + 3.0 * positive("time step", dt)? / diffusive, dt),
            Pace::Tau(tau) => (positive("relaxation time", tau)?, step_at(tau)),
        };
        if tau < LEAST_TAU {
            return Err(LbmError::RelaxationTime {
                tau,
                least: LEAST_TAU,
                time_step: step_at(LEAST_TAU),
            });
        }
        let (isa, collision, precision) = (InstructionSet::best(), Collision::default(), Precision::default());
        let kernel = collision.kernel(VelocitySet::default(), tau, true, isa, precision);
        if !Storage::fits(grid.shape, kernel.velocities()) {
            return Err(LbmError::GridTooLarge { shape: grid.shape });
        }
        let mask = Mask::new(&grid, None, 0.0)?;
        mask.narrowest(&grid, None, 0.0, NarrowGaps::default())?;
        let packed = pays_to_pack(&mask, kernel.velocities());
        let storage = Storage::new(&grid, &mask, kernel.velocities(), precision, packed);
        let mut fluid = Self {
            density,
            viscosity,
            time_step,
            tau,
            collision: Some(collision),
            velocity_set: VelocitySet::default(),
            inertia: true,
            narrow: NarrowGaps::default(),
            wall_rule: Arc::new(WallRule::default()),
            mach_limit: 0.5,
            thermal: None,
            drive: Drive::default(),
            isa,
            kernel,
            inner: Inner::default(),
            walls: (None, 0.0),
            faces: Faces::default(),
            links: Links::default(),
            balances: Vec::new(),
            exchanged: Vec::new(),
            more: Vec::new(),
            slab: 0,
            shrink: 0.0,
            owed: [0.0; 2],
            odd: false,
            at_rest: true,
            steps: 0,
            force: [[0.0; 2]; 3],
            bodies: [0.0; 3],
            flow: None,
            slots: Vec::new(),
            grid,
            storage,
            mask,
        };
        fluid.link();
        Ok(fluid)
    }

    /// Without inertia the terms of second order in the velocity are left out: Stokes flow, but still in time.
    pub fn with_inertia(mut self, inertia: bool) -> Self {
        self.inertia = inertia;
        self.rebuild();
        self
    }

    /// Gaps between walls too narrow to carry a flow (under two nodes) are made solid, and counted in
    /// [`WallReport::filled_nodes`](lbm_ibm_coupling::WallReport::filled_nodes), instead of being refused: for spheres that
    /// touch. Contact still has the true walls. Call it before the walls are set.
    pub fn with_narrow_gaps_filled(mut self) -> Self {
        self.narrow = NarrowGaps::Filled;
        self
    }

    /// Gaps between walls that are a single node wide stay fluid instead of being refused. Their walls are half way between
    /// nodes whatever the rule, so such a gap is one spacing wide, whatever its true width, and
    /// [`WallReport::narrowest`](lbm_ibm_coupling::WallReport::narrowest) tells of it. For surfaces that touch, where the wedge about the contact
    /// passes through every width: a cubic array of touching spheres of 8 spacings' radius has a drag within 0.5 %, with these nodes
    /// filled 5.5 % too high (`validate sphere_array_drag`). A channel that is as narrow everywhere should have a finer grid.
    /// Call it before the walls are set.
    pub fn with_narrow_gaps_kept(mut self) -> Self {
        self.narrow = NarrowGaps::Kept;
        self
    }

    /// Where walls are taken to be, [`WallRule::Cli`] by default: one of [`WallRule`], or a rule of one's own. It holds for
    /// walls that are set from then on.
    pub fn with_wall_rule(mut self, rule: impl LinkRule + 'static) -> Self {
        self.wall_rule = Arc::new(rule);
        self
    }

    /// What drives the flow; see [`Fluid::set_drive`].
    ///
    /// # Errors
    /// As for [`Fluid::set_drive`].
    pub fn with_drive(mut self, drive: Drive) -> Result<Self, LbmError> {
        self.set_drive(drive)?;
        Ok(self)
    }

    /// Mach number (by the lattice's speed of sound) beyond which [`Lattice::check`] fails; 0.5 by default.
    ///
    /// # Errors
    /// [`LbmError::NotPositive`].
    pub fn with_mach_limit(mut self, limit: f64) -> Result<Self, LbmError> {
        self.mach_limit = positive("Mach limit", limit)?;
        Ok(self)
    }

    /// Another instruction set than the widest of this processor: for the same bits on every machine.
    ///
    /// # Errors
    /// [`LbmError::Unsupported`].
    pub fn with_instruction_set(mut self, isa: InstructionSet) -> Result<Self, LbmError> {
        if !isa.is_available() {
            return Err(LbmError::Unsupported {
                wanted: format!("{isa:?}"),
            });
        }
        self.isa = isa;
        self.kernel = self.kernel.rebuilt(isa, self.storage.precision());
        self.forget_inside();
        Ok(self)
    }

    /// Changes what drives the flow, at any time. Flux control starts from the force that acted before.
    ///
    /// # Errors
    /// [`LbmError::NotFinite`]; [`LbmError::ClosedAxis`] for a flux along an axis that is not periodic;
    /// [`LbmError::Unstable`] for a flux faster than [`Fluid::stable_speed`].
    pub fn set_drive(&mut self, drive: Drive) -> Result<(), LbmError> {
        drive.check(&self.grid)?;
        self.check_flux(&drive)?;
        let unit = self.density * self.grid.spacing / self.time_step.powi(2);
        for a in 0..3 {
            match drive {
                Drive::Force(force) => self.force[a][1] = force[a] / unit,
                Drive::Flux(target) if target[a].is_none() => self.force[a][1] = 0.0,
                Drive::Flux(_) => {}
            }
            if self.steps == 0 {
                self.force[a][0] = self.force[a][1];
            }
        }
        self.drive = drive;
        Ok(())
    }

    /// What drives the flow.
    pub fn drive(&self) -> Drive {
        self.drive
    }

    /// The collision; none where the model is one's own.
    pub fn collision(&self) -> Option<Collision> {
        self.collision
    }

    /// Where walls are taken to be.
    pub fn wall_rule(&self) -> &dyn LinkRule {
        &*self.wall_rule
    }

    /// Relaxation time, in time steps.
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// Kinematic viscosity in lattice units, `(tau - 1/2)/3`.
    pub fn lattice_viscosity(&self) -> f64 {
        (self.tau - 0.5) / 3.0
    }

    /// Predicted slip at flat walls: [`Collision::wall_slip`] at this relaxation time, if the collision is built in.
    pub fn wall_slip(&self) -> Option<f64> {
        self.collision.map(|c| c.wall_slip(self.tau))
    }

    /// Mach number of a flow of `speed` (m/s) by the lattice's speed of sound, `sqrt(3) speed dt/dx`.
    pub fn mach(&self, speed: f64) -> f64 {
        3.0_f64.sqrt() * speed / self.velocity_unit()
    }

    /// Steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Number of fluid nodes.
    pub fn fluid_nodes(&self) -> usize {
        self.mask.fluid_nodes
    }

    /// Lattice unit of velocity, m/s.
    pub(crate) fn velocity_unit(&self) -> f64 {
        self.grid.spacing / self.time_step
    }

    /// Lattice units of force per N on a node.
    pub(crate) fn force_scale(&self) -> f64 {
        self.time_step.powi(2) / (self.density * self.grid.spacing.powi(4))
    }

    /// The velocity field at this time: equilibrium plus the first order of what departs from it in a shear.
    /// `velocity` (m/s) is taken at positions (m) within half a spacing of the fluid nodes. The pressure is zero.
    pub fn set_velocity(&mut self, velocity: impl Fn(Vec3) -> Vec3) {
        let (unit, spacing) = (self.velocity_unit(), self.grid.spacing);
        self.populate(|position| {
            let lattice = |x: Vec3| -> [f64; 3] { (velocity(x) / unit).into() };
            let gradient = std::array::from_fn(|a| {
                let mut step = Vec3::zeros();
                step[a] = 0.5 * spacing;
                let (low, high) = (lattice(position - step), lattice(position + step));
                std::array::from_fn(|b| high[b] - low[b])
            });
            (lattice(position), gradient)
        });
    }
}

impl std::fmt::Debug for Fluid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Fluid")
            .field("grid", self.grid())
            .field("density", &self.density)
            .field("viscosity", &self.viscosity)
            .field("time_step", &self.time_step)
            .field("tau", &self.tau)
            .field("collision", &self.collision)
            .field("drive", &self.drive)
            .field("steps", &self.steps)
            .finish_non_exhaustive()
    }
}

fn positive(name: &'static str, value: f64) -> Result<f64, LbmError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(LbmError::NotPositive { name, value })
    }
}
