//! Beads with inertia.

use super::contact::{BeadContact, ContactLaw, Look, Site};
use super::mobility::{Block, Mobility};
use super::system::BeadSystem;
use crate::error::MagneticsError;
use crate::model::Solution;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};

/// Steps below this share of the time are too short.
const SHORTEST: f64 = 1e-14;

/// Heavy beads: m dv/dt = F - (v - u)/M, drag solved exactly over each step.
///
/// In a step the velocity that force and flow would give, w = u + M F, goes linearly from its value at the start to that at the
/// predicted end, and v follows it exactly: v1 = w + e (v0 - w) with e = exp(-step/(m M)), and the terms of the change of w.
/// Constant forces are exact for any step. Contacts are inelastic: one solve keeps beads apart, a second one takes the velocity
/// of approach. Beads do not drag each other along; added mass and history forces are left out.
pub struct Newton {
    system: BeadSystem,
    velocity: Soa3,
    time: f64,
    step: f64,
    longest: f64,
    tolerance: f64,
    started: bool,
}

impl Newton {
    /// Beads at rest with their surroundings.
    pub fn new(system: BeadSystem) -> Self {
        Self {
            velocity: Soa3::zeros(system.beads.len()),
            system,
            time: 0.0,
            step: 1e-9,
            longest: f64::INFINITY,
            tolerance: 1e-4,
            started: false,
        }
    }

    /// Velocities (m/s) at the start, one per bead; those of frozen beads are ignored.
    ///
    /// # Errors
    /// [`MagneticsError::Count`].
    pub fn with_velocities(mut self, velocity: Soa3) -> Result<Self, MagneticsError> {
        if velocity.len() != self.system.beads.len() {
            return Err(MagneticsError::Count {
                beads: self.system.beads.len(),
                positions: velocity.len(),
            });
        }
        self.velocity = velocity;
        for i in (0..self.velocity.len()).filter(|i| self.system.frozen[*i]) {
            self.velocity.set(i, Vec3::zeros());
        }
        Ok(self)
    }

    /// Change of positions by the change of forces allowed in a step, in radii (default 1e-4), and the longest step (s).
    pub fn with_steps(mut self, tolerance: f64, longest: f64) -> Self {
        (self.tolerance, self.longest) = (tolerance, longest);
        self
    }

    /// Goes on to time `end` (s).
    ///
    /// # Errors
    /// As [`Newton::advance`].
    pub fn run_to(&mut self, end: f64) -> Result<(), MagneticsError> {
        while self.time < end {
            self.advance(end)?;
        }
        Ok(())
    }

    /// One step, not beyond `end` (s); returns its length (s).
    ///
    /// # Errors
    /// [`MagneticsError::Step`] if no step is short enough, [`MagneticsError::WallOverlap`] at the start,
    /// [`MagneticsError::Contact`], and those of the model.
    pub fn advance(&mut self, end: f64) -> Result<f64, MagneticsError> {
        if !self.started && !matches!(self.system.contact, ContactLaw::None) {
            self.system.check_walls(self.time)?;
        }
        self.started = true;
        let x0 = self.system.x.clone();
        let (blocks, w0) = self.drift(&x0, self.time)?;
        loop {
            let h = self.step.min(self.longest).min(end - self.time);
            let (error, x1, v1) = self.attempt(&x0, &blocks, &w0, h)?;
            let factor = if error.is_finite() {
                (0.9 / error.max(1e-6).sqrt()).clamp(0.2, 3.0)
            } else {
                0.2
            };
            let cut_short = h < self.step;
            if error <= 1.0 {
                self.land(x0, x1, v1, &blocks, h)?;
                self.time = if end - self.time - h < 1e-12 * h {
                    end
                } else {
                    self.time + h
                };
                if !cut_short || factor < 1.0 {
                    self.step = h * factor;
                }
                return Ok(h);
            }
            self.step = h * factor;
            if self.step < SHORTEST * self.time || self.step < 1e-30 {
                return Err(MagneticsError::Step {
                    step: self.step,
                    time: self.time,
                    remedy: "use contact as a constraint, or larger tolerances",
                });
            }
        }
    }

    /// Mobilities and the velocities that force and flow would give.
    fn drift(&mut self, x: &Soa3, t: f64) -> Result<(Vec<Block>, Soa3), MagneticsError> {
        let force = self.system.forces(x, t)?;
        let system = &self.system;
        let walls = system.walls.as_deref();
        let blocks = system.mobility.blocks(&system.beads, &system.frozen, x, t, walls);
        let drift = |i: usize| {
            if system.frozen[i] {
                return Vec3::zeros();
            }
            system.flow.velocity(x.get(i), t) + blocks[i].times(force.get(i))
        };
        let w = (0..x.len()).map(drift).collect();
        Ok((blocks, w))
    }

    /// Error over what is allowed, positions and velocities at the end without contact.
    fn attempt(&mut self, x0: &Soa3, blocks: &[Block], w: &Soa3, h: f64) -> Result<(f64, Soa3, Soa3), MagneticsError> {
        let (mut x, mut v) = (x0.clone(), self.velocity.clone());
        for i in (0..x.len()).filter(|i| !self.system.frozen[*i]) {
            let lag = self.velocity.get(i) - w.get(i);
            let mass = self.mass(i);
            x.add(
                i,
                w.get(i) * h + blocks[i].map(|m| mass * m * fallen(h, mass * m)).times(lag),
            );
            v.set(i, w.get(i) + blocks[i].map(|m| 1.0 - fallen(h, mass * m)).times(lag));
        }
        let (_, ahead) = self.drift(&x, self.time + h)?;
        let mut error: f64 = 0.0;
        for i in (0..x.len()).filter(|i| !self.system.frozen[*i]) {
            let change = ahead.get(i) - w.get(i);
            let mass = self.mass(i);
            let shift = blocks[i].map(|m| h * second(h, mass * m)).times(change);
            x.add(i, shift);
            v.add(
                i,
                blocks[i]
                    .map(|m| 1.0 - mass * m / h * fallen(h, mass * m))
                    .times(change),
            );
            let e = shift.norm() / (self.tolerance * self.system.beads[i].radius());
            error = if error >= e || error.is_nan() { error } else { e };
        }
        Ok((error, x, v))
    }

    fn mass(&self, i: usize) -> f64 {
        self.system.beads[i].density() * self.system.beads[i].volume()
    }

    /// Takes the step's end, held by contacts.
    fn land(&mut self, x0: Soa3, x1: Soa3, v1: Soa3, blocks: &[Block], h: f64) -> Result<(), MagneticsError> {
        (self.system.x, self.velocity) = (x1, v1);
        let ContactLaw::Constraint(law) = self.system.contact else {
            return Ok(());
        };
        let n = x0.len();
        let end = self.time + h;
        let mut mean: Soa3 = (0..n).map(|i| (self.system.x.get(i) - x0.get(i)) / h).collect();
        // What a force over the step gives: mean velocity, and velocity at the end.
        let of = |f: &dyn Fn(f64, f64) -> f64| {
            let block = |i: usize| blocks[i].map(|m| if m > 0.0 { f(m, self.mass(i)) } else { 0.0 });
            Mobility::Blocks((0..n).map(block).collect())
        };
        let shifting = of(&|m, mass| m * (1.0 - mass * m / h * fallen(h, mass * m)));
        let pushing = of(&|_, mass| h / mass);
        let look = Look {
            x: &x0,
            time: self.time,
            base: &x0,
            step: h,
        };
        let sites = self.system.constrain(&law, &look, &shifting, &mut mean)?;
        self.system.x = (0..n).map(|i| x0.get(i) + mean.get(i) * h).collect();
        let x1 = self.system.x.clone();
        let look = Look {
            x: &x1,
            time: end,
            base: &x1,
            step: h,
        };
        let mut velocity = std::mem::take(&mut self.velocity);
        let held = self.system.constrain(&law, &look, &pushing, &mut velocity)?;
        self.velocity = velocity;
        let overlap = held.iter().map(|s| -s.gap).fold(0.0, f64::max);
        self.system.contacts.accept(sites, overlap, Site::is_closed, |_| end);
        Ok(())
    }

    /// Centres, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.system.positions()
    }

    /// Velocities, m/s.
    pub fn velocities(&self) -> Soa3Ref<'_> {
        self.velocity.view()
    }

    /// Contacts that the last step has closed, with their forces, means over the step.
    pub fn contacts(&self) -> &[BeadContact] {
        &self.system.contacts.reported
    }

    /// Deepest overlap at the end of the last step, m; zero if nothing overlaps.
    pub fn overlap(&self) -> f64 {
        self.system.contacts.overlap
    }

    /// Moments and magnetic forces at the end of the last step.
    pub fn solution(&self) -> &Solution {
        &self.system.solution
    }

    /// The beads and what is around them.
    pub fn system(&self) -> &BeadSystem {
        &self.system
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }
}

/// 1 - exp(-h/tau).
fn fallen(h: f64, tau: f64) -> f64 {
    -(-h / tau).exp_m1()
}

/// 1/2 - tau/h + (tau/h)^2 (1 - exp(-h/tau)), by its series for short steps.
fn second(h: f64, tau: f64) -> f64 {
    let z = h / tau;
    if z < 1e-2 {
        return z / 6.0 - z * z / 24.0 + z * z * z / 120.0;
    }
    0.5 - 1.0 / z + fallen(h, tau) / (z * z)
}
