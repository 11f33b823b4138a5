//! Where beads come to rest.

mod polish;

use super::contact::{BeadContact, Constraint, ContactLaw};
use super::overdamped::Overdamped;
use super::system::BeadSystem;
use crate::error::MagneticsError;
use crate::model::Solution;
use lbm_ibm_coupling::Soa3Ref;

/// Finds where beads are at rest: no velocity left under magnetic force, weight and frictionless contact.
///
/// Beads first go down the energy as overdamped beads do, whose drag changes the way but not where it ends; once little force is
/// left, Newton's method with the closed contacts as equations finds the place itself. A flow, if there is one, is a load:
/// beads held or caught by contact are at rest in it. Friction is left out. Where several places of rest exist the one
/// downhill from the start is found; a start on a ridge by symmetry stays on it.
pub struct QuasiStatic {
    run: Overdamped,
    tolerance: f64,
    steps: usize,
}

/// How well beads rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Greatest force left on a bead, over the greatest force of the field on a bead.
    pub residual: f64,
    /// Steps made downhill.
    pub steps: usize,
    /// Iterations of Newton's method in the last try.
    pub iterations: usize,
}

impl QuasiStatic {
    /// Beads with their surroundings; contact becomes a constraint without friction.
    pub fn new(system: BeadSystem) -> Self {
        let law = match system.contact {
            ContactLaw::Constraint(law) => Constraint {
                friction: 0.0,
                wall_friction: 0.0,
                ..law
            },
            _ => Constraint::frictionless(),
        };
        Self {
            run: Overdamped::from(system.with_contact(law)).with_steps(1e-4, f64::INFINITY),
            tolerance: 1e-9,
            steps: 50_000,
        }
    }

    /// Greatest force left on a bead, over the greatest force of the field (default 1e-9; the model's own tolerance must be
    /// smaller).
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Most steps downhill (default 50000).
    pub fn with_most_steps(mut self, steps: usize) -> Self {
        self.steps = steps;
        self
    }

    /// Moves the beads to rest.
    ///
    /// # Errors
    /// [`MagneticsError::NoRest`] when they find none, as a chain that a flow tears, and those of [`Overdamped::advance`].
    pub fn relax(&mut self) -> Result<Rest, MagneticsError> {
        let mut next = 3e-2;
        let mut wait = 200;
        let mut residual = f64::INFINITY;
        for step in 0..self.steps {
            self.run.advance(f64::INFINITY)?;
            residual = self.residual();
            wait -= 1;
            if residual <= next || wait == 0 {
                if let Some((iterations, residual)) = self.polish()? {
                    return Ok(Rest {
                        residual,
                        steps: step + 1,
                        iterations,
                    });
                }
                next = 0.3 * residual.min(next);
                wait = 200 + step;
            }
        }
        Err(MagneticsError::NoRest {
            steps: self.steps,
            residual,
            tolerance: self.tolerance,
            remedy: "hold beads that a flow or the field carries away, or allow more steps",
        })
    }

    /// Greatest force that the velocities of the last step stand for, over the greatest of the field.
    fn residual(&self) -> f64 {
        let system = self.run.system();
        let drag = |i: usize| system.mobility.stokes(system.beads[i].radius());
        let v = self.run.velocities();
        let left = (0..v.len()).map(|i| v.get(i).norm() * drag(i)).fold(0.0, f64::max);
        left / self.scale()
    }

    /// Greatest force of the field on a bead, N.
    fn scale(&self) -> f64 {
        let largest = self.run.solution().force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let given = self
            .run
            .forces()
            .map_or(0.0, |f| f.iter().map(|f| f.norm()).fold(0.0, f64::max));
        largest.max(given).max(f64::MIN_POSITIVE)
    }

    /// Centres, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.run.positions()
    }

    /// Closed contacts with their forces.
    pub fn contacts(&self) -> &[BeadContact] {
        self.run.contacts()
    }

    /// Moments and magnetic forces.
    pub fn solution(&self) -> &Solution {
        self.run.solution()
    }

    /// The beads and what is around them.
    pub fn system(&self) -> &BeadSystem {
        self.run.system()
    }
}
