//! Beads that heat shakes.

use super::contact::{BeadContact, ContactLaw, Look, Site};
use super::system::{BeadSystem, Stage};
use crate::error::{MagneticsError, positive};
use crate::model::Solution;
use lbm_ibm_coupling::{Noise, Soa3, Soa3Ref};

/// Boltzmann's constant, J/K (exact).
pub const BOLTZMANN: f64 = 1.380649e-23;
/// Farthest that a bead may go in a step, in radii.
const FARTHEST: f64 = 0.5;

/// Overdamped beads with thermal noise, in steps of one length.
///
/// The midpoint scheme of Fixman (1978): a random force R with the covariance 2 kT/(step M) is held over the step, and the
/// velocity u + M (F + R) at the midpoint moves the beads. It has the drift kT div M, so that the stationary distribution is
/// Boltzmann's also where walls and other beads change the mobility; its error is of first order in the step. The noise is a
/// function of seed, step and bead ([`Noise`]).
pub struct Brownian {
    system: BeadSystem,
    energy: f64,
    seed: u64,
    length: f64,
    steps: u64,
    time: f64,
    velocity: Soa3,
}

impl Brownian {
    /// Beads with their surroundings at `temperature` (K), in steps of `length` (s).
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for temperature or length.
    pub fn new(system: BeadSystem, temperature: f64, length: f64, seed: u64) -> Result<Self, MagneticsError> {
        Ok(Self {
            energy: BOLTZMANN * positive("temperature (K)", temperature)?,
            length: positive("time step (s)", length)?,
            seed,
            steps: 0,
            time: 0.0,
            velocity: Soa3::zeros(system.beads.len()),
            system,
        })
    }

    /// One step.
    ///
    /// # Errors
    /// [`MagneticsError::LongStep`] when a bead moves more than half its radius, [`MagneticsError::WallOverlap`] at the start,
    /// [`MagneticsError::Contact`], [`MagneticsError::Mobility`], and those of the model.
    pub fn advance(&mut self) -> Result<(), MagneticsError> {
        if self.steps == 0 && !matches!(self.system.contact, ContactLaw::None) {
            self.system.check_walls(self.time)?;
        }
        let (n, h) = (self.system.beads.len(), self.length);
        let x = self.system.x.clone();
        let first = self.system.stage(x.clone(), self.time)?;
        let strength = (2.0 * self.energy / h).sqrt();
        let noise = Noise::new(self.seed, self.steps);
        let noise: Soa3 = (0..n).map(|i| noise.normal(i as u64) * strength).collect();
        let (shake, random) = first.mobility.root_times(&noise)?;
        let mut v = first.velocity.clone();
        for i in (0..n).filter(|i| !self.system.frozen[*i]) {
            v.add(i, shake.get(i));
        }
        self.project(&first, &x, 0.5 * h, &mut v)?;
        let middle: Soa3 = (0..n).map(|i| x.get(i) + v.get(i) * (0.5 * h)).collect();
        let middle = self.system.stage(middle, self.time + 0.5 * h)?;
        let mut v = middle.velocity.clone();
        middle.mobility.add(&random, &mut v);
        let sites = self.project(&middle, &x, h, &mut v)?;
        for (bead, b) in self.system.beads.iter().enumerate() {
            let (moved, limit) = (v.get(bead).norm() * h, FARTHEST * b.radius());
            if moved.is_nan() || moved > limit {
                return Err(MagneticsError::LongStep {
                    bead,
                    step: h,
                    moved,
                    limit,
                });
            }
        }
        for i in 0..n {
            self.system.x.add(i, v.get(i) * h);
        }
        let (begin, overlap) = (self.time, sites.iter().map(|s| -s.gap).fold(0.0, f64::max));
        self.system.contacts.accept(sites, overlap, Site::is_closed, |_| begin);
        self.velocity = v;
        self.steps += 1;
        self.time = self.steps as f64 * h;
        Ok(())
    }

    fn project(&mut self, stage: &Stage, base: &Soa3, step: f64, v: &mut Soa3) -> Result<Vec<Site>, MagneticsError> {
        let ContactLaw::Constraint(law) = self.system.contact else {
            return Ok(Vec::new());
        };
        let look = Look {
            x: &stage.x,
            time: stage.time,
            base,
            step,
        };
        self.system.constrain(&law, &look, &stage.mobility, v)
    }

    /// Centres, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.system.positions()
    }

    /// Mean velocities of the last step, m/s.
    pub fn velocities(&self) -> Soa3Ref<'_> {
        self.velocity.view()
    }

    /// Contacts that the last step has closed, with their forces.
    pub fn contacts(&self) -> &[BeadContact] {
        &self.system.contacts.reported
    }

    /// Moments and magnetic forces in the middle of the last step.
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
