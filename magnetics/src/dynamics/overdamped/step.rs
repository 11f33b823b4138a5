//! One step, and what moves beads in it.

use super::{Overdamped, Repulsion};
use crate::dynamics::drag::{PairMobility, wall_mobility};
use crate::error::MagneticsError;
use crate::model::{Model, Problem};
use lbm_ibm_coupling::{Soa3, Vec3};
use std::f64::consts::PI;

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
    /// [`MagneticsError::Step`] if no step is short enough, and those of the model.
    pub fn advance(&mut self, end: f64) -> Result<f64, MagneticsError> {
        if !self.fresh {
            self.velocity = self.rates(&self.x.clone(), self.time)?;
            self.fresh = true;
        }
        let k1 = self.velocity.clone();
        loop {
            let h = self.step.min(self.longest).min(end - self.time);
            let (x, t) = (self.x.clone(), self.time);
            let k2 = self.rates(&combine(&x, &[(0.5 * h, &k1)]), t + 0.5 * h)?;
            let k3 = self.rates(&combine(&x, &[(0.75 * h, &k2)]), t + 0.75 * h)?;
            let thirds = [(2.0 / 9.0 * h, &k1), (h / 3.0, &k2), (4.0 / 9.0 * h, &k3)];
            let next = combine(&x, &thirds);
            let k4 = self.rates(&next, t + h)?;
            let mut error: f64 = 0.0;
            for (i, bead) in self.beads.iter().enumerate() {
                let e = k1.get(i) * (-5.0 / 72.0) + k2.get(i) / 12.0 + k3.get(i) / 9.0 - k4.get(i) / 8.0;
                error = error.max(e.norm() * h / (self.tolerance * bead.radius()));
            }
            let factor = if error.is_finite() {
                (0.9 * error.max(1e-6).powf(-1.0 / 3.0)).clamp(0.2, 3.0)
            } else {
                0.2
            };
            let cut_short = h < self.step;
            if error <= 1.0 {
                (self.x, self.velocity, self.time) = (next, k4, t + h);
                if end - self.time < 1e-12 * h {
                    self.time = end;
                }
                if !cut_short || factor < 1.0 {
                    self.step = h * factor;
                }
                self.note_regime();
                return Ok(h);
            }
            self.step = h * factor;
            if self.step < 1e-30 || t + self.step == t {
                return Err(MagneticsError::Step {
                    step: self.step,
                    time: t,
                    remedy: "give the beads a repulsion, a longer range of it, or a larger tolerance",
                });
            }
        }
    }

    fn note_regime(&mut self) {
        for (i, bead) in self.beads.iter().enumerate() {
            let u = self
                .flow
                .as_ref()
                .map_or(Vec3::zeros(), |u| u(self.x.get(i), self.time));
            let slip = (self.velocity.get(i) - u).norm() * bead.radius() / self.viscosity;
            self.regime.reynolds = self.regime.reynolds.max(self.density * slip);
            self.regime.stokes = self.regime.stokes.max(2.0 / 9.0 * bead.density() * slip);
        }
    }

    fn rates(&mut self, x: &Soa3, t: f64) -> Result<Soa3, MagneticsError> {
        let source = self.source.clone();
        let problem = Problem::new(&self.beads, x.view(), &source, t)?;
        self.model.solve(&problem, &mut self.solution)?;
        let mut force = self.solution.force.clone();
        for (i, bead) in self.beads.iter().enumerate() {
            force.add(i, bead.buoyant_weight(self.density, self.gravity));
        }
        if let Some(law) = self.repulsion {
            self.add_repulsion(x, law, &mut force);
        }
        let mut velocity = Soa3::zeros(x.len());
        for (i, bead) in self.beads.iter().enumerate() {
            let (p, f, a) = (x.get(i), force.get(i), bead.radius());
            let mut v = self.flow.as_ref().map_or(Vec3::zeros(), |u| u(p, t));
            if let Some(walls) = &self.walls {
                let probe = walls.probe(p, t);
                let gap = probe.distance - a;
                let push = self
                    .repulsion
                    .map_or(0.0, |law| law.strength * (-gap / law.range).min(30.0).exp());
                let f = f + probe.normal * push;
                v += wall_mobility(f, a, self.viscosity, probe.normal, gap, self.roughness * a);
            } else {
                v += f / (6.0 * PI * self.viscosity * a);
            }
            velocity.add(i, v);
        }
        if self.mobility != PairMobility::None {
            for i in 0..x.len() {
                for j in 0..i {
                    let radius = [self.beads[i].radius(), self.beads[j].radius()];
                    let forces = [force.get(i), force.get(j)];
                    let [vi, vj] = self.mobility.add(x.get(i) - x.get(j), radius, self.viscosity, forces);
                    velocity.add(i, vi);
                    velocity.add(j, vj);
                }
            }
        }
        for i in (0..x.len()).filter(|i| self.frozen[*i]) {
            velocity.set(i, Vec3::zeros());
        }
        Ok(velocity)
    }

    fn add_repulsion(&self, x: &Soa3, law: Repulsion, force: &mut Soa3) {
        for i in 0..x.len() {
            for j in 0..i {
                let r = x.get(i) - x.get(j);
                let distance = r.norm();
                let gap = distance - self.beads[i].radius() - self.beads[j].radius();
                if gap < 30.0 * law.range && distance > 0.0 {
                    let f = r * (law.strength * (-gap / law.range).min(30.0).exp() / distance);
                    force.add(i, f);
                    force.add(j, -f);
                }
            }
        }
    }
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
