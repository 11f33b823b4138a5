//! One step.

use super::Overdamped;
use crate::dynamics::contact::{ContactLaw, Look, Site};
use crate::dynamics::system::Stage;
use crate::error::MagneticsError;
use lbm_ibm_coupling::Soa3;

/// Tolerance of beads in contact over that of free ones.
const CONTACT: f64 = 10.0;
/// Tolerance of beads whose contacts open or close in the step.
const CHANGE: f64 = 100.0;

/// What a trial step has found.
struct Trial {
    next: Stage,
    /// Velocities and contacts at the end.
    velocity: Soa3,
    sites: Vec<Site>,
    /// Contacts at the beginning, with the approach there.
    before: Vec<Site>,
    /// Contacts that the end position has been held by.
    last: Vec<Site>,
    /// Error over what is allowed.
    error: f64,
    /// Greatest displacement over what is allowed.
    displacement: f64,
    overlap: f64,
}

impl Overdamped {
    /// Goes on to time `end` (s).
    ///
    /// # Errors
    /// As [`Overdamped::advance`].
    pub fn run_to(&mut self, end: f64) -> Result<(), MagneticsError> {
        while self.time < end {
            self.advance(end)?;
        }
        Ok(())
    }

    /// One step, not beyond `end` (s); returns its length (s).
    ///
    /// # Errors
    /// [`MagneticsError::Step`] if no step is short enough, [`MagneticsError::Contact`], [`MagneticsError::WallOverlap`] at the
    /// start, [`MagneticsError::Mobility`], and those of the model.
    pub fn advance(&mut self, end: f64) -> Result<f64, MagneticsError> {
        let stage = match self.stage.take() {
            Some(stage) => stage,
            None => {
                if self.steps == 0 && !matches!(self.system.contact, ContactLaw::None) {
                    self.system.check_walls(self.time)?;
                }
                self.system.stage(self.system.x.clone(), self.time)?
            }
        };
        let allowed = match self.system.contact {
            ContactLaw::Constraint(law) => law.overlap * self.system.smallest_radius(),
            _ => f64::INFINITY,
        };
        loop {
            let h = self.step.min(self.longest).min(end - self.time);
            let trial = self.attempt(&stage, h)?;
            let mut factor = if trial.error.is_finite() {
                (0.9 * trial.error.max(1e-6).powf(-1.0 / 3.0)).clamp(0.2, 3.0)
            } else {
                0.2
            };
            factor = factor.min(0.9 / trial.displacement.max(0.1));
            // What is left of an overlap that was there before the step may stay: the step takes it away as far as it can.
            let deeper = trial.overlap > allowed.max(self.system.contacts.overlap);
            if deeper {
                factor = factor.min(0.5);
            }
            let cut_short = h < self.step;
            if trial.error <= 1.0 && trial.displacement <= 1.0 && !deeper {
                self.accept(trial, h, end);
                if !cut_short || factor < 1.0 {
                    self.step = h * factor;
                }
                return Ok(h);
            }
            self.step = h * factor.max(0.1);
            if self.step < 1e-30 || self.time + self.step == self.time {
                return Err(MagneticsError::Step {
                    step: self.step,
                    time: self.time,
                    remedy: "use contact as a constraint, a longer range of repulsion, or larger tolerances",
                });
            }
        }
    }

    /// Velocities of a stage under contact: from `base` they last for `c` (s).
    fn project(&mut self, stage: &Stage, base: &Soa3, c: f64) -> Result<(Soa3, Vec<Site>), MagneticsError> {
        let mut v = stage.velocity.clone();
        let ContactLaw::Constraint(law) = self.system.contact else {
            return Ok((v, Vec::new()));
        };
        let look = Look {
            x: &stage.x,
            time: stage.time,
            base,
            step: c,
        };
        let sites = self.system.constrain(&law, &look, &stage.mobility, &mut v)?;
        Ok((v, sites))
    }

    fn attempt(&mut self, stage: &Stage, h: f64) -> Result<Trial, MagneticsError> {
        let (x, t) = (&stage.x, stage.time);
        let (k1, before) = self.project(stage, x, 0.5 * h)?;
        let second = self.system.stage(combine(x, &[(0.5 * h, &k1)]), t + 0.5 * h)?;
        let (k2, at2) = self.project(&second, x, 0.75 * h)?;
        let third = self.system.stage(combine(x, &[(0.75 * h, &k2)]), t + 0.75 * h)?;
        let base = combine(x, &[(2.0 / 9.0 * h, &k1), (h / 3.0, &k2)]);
        let (k3, at3) = self.project(&third, &base, 4.0 / 9.0 * h)?;
        let next = self.system.stage(combine(&base, &[(4.0 / 9.0 * h, &k3)]), t + h)?;
        let (k4, sites) = self.project(&next, &next.x, 0.5 * h)?;
        let allowed = self.allowed([&before, &at2, &at3, &sites]);
        let (mut error, mut displacement): (f64, f64) = (0.0, 0.0);
        for (i, bead) in self.system.beads.iter().enumerate() {
            let e = k1.get(i) * (-5.0 / 72.0) + k2.get(i) / 12.0 + k3.get(i) / 9.0 - k4.get(i) / 8.0;
            error = max(error, e.norm() * h / (allowed[i] * bead.radius()));
            let moved = (next.x.get(i) - x.get(i)).norm();
            displacement = max(displacement, moved / (self.farthest * bead.radius()));
        }
        Ok(Trial {
            overlap: sites.iter().map(|s| -s.gap).fold(0.0, f64::max),
            next,
            velocity: k4,
            sites,
            before,
            last: at3,
            error,
            displacement,
        })
    }

    /// Error of each bead's position that a step may make, in radii, given the contacts of its stages: more for beads in contact,
    /// most for beads whose contacts open or close, for their velocities jump while the contact itself holds.
    fn allowed(&self, stages: [&Vec<Site>; 4]) -> Vec<f64> {
        let mut closed: Vec<[usize; 4]> = vec![[0; 4]; self.system.beads.len()];
        for (k, sites) in stages.iter().enumerate() {
            for bead in sites.iter().filter(|s| s.is_closed()).flat_map(Site::beads) {
                closed[bead][k] += 1;
            }
        }
        let allowed = |c: &[usize; 4]| match c {
            [0, 0, 0, 0] => self.tolerance,
            [a, b, c, d] if a == b && b == c && c == d => CONTACT * self.tolerance,
            _ => CHANGE * self.tolerance,
        };
        closed.iter().map(allowed).collect()
    }

    fn accept(&mut self, trial: Trial, h: f64, end: f64) {
        let begin = self.time;
        self.time += h;
        if end - self.time < 1e-12 * h {
            self.time = end;
        }
        self.system.x.clone_from(&trial.next.x);
        self.velocity = trial.velocity;
        let of = |sites: &[Site], s: &Site| sites.binary_search_by_key(&s.key(), Site::key).ok();
        // A contact counts as closed once it has held a step's end; the last solve already looks into the next step.
        let is_closed = |s: &Site| s.is_closed() && of(&trial.last, s).is_some_and(|k| trial.last[k].is_closed());
        let closed_at = |s: &Site| {
            let known = of(&trial.before, s);
            known.map_or(self.time, |k| begin + trial.before[k].time_to_close(s).min(h))
        };
        let mut contacts = std::mem::take(&mut self.system.contacts);
        contacts.accept(trial.sites, trial.overlap, is_closed, closed_at);
        self.system.contacts = contacts;
        self.regime.note(&self.system, &self.velocity, self.time);
        self.stage = Some(trial.next);
        self.steps += 1;
    }
}

/// The greater of two, not a number if one is not.
fn max(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

fn combine(x: &Soa3, terms: &[(f64, &Soa3)]) -> Soa3 {
    let mut out = x.clone();
    for (s, v) in terms {
        for i in 0..x.len() {
            out.add(i, v.get(i) * *s);
        }
    }
    out
}
