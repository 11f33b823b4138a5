//! Multipoles of beads that saturate: dipoles of their own law, multipoles of their secant permeability.
//!
//! The energy is E = E(dipoles, own law) + E(multipoles, secant) - E(dipoles, secant). Both dipole solutions have the same
//! moments, so at fixed permeabilities the forces are those of the multipoles.

use super::coupling::relative_slope;
use super::system::System;
use crate::MU0;
use crate::error::MagneticsError;
use crate::model::mutual::finish;
use crate::model::near::Interaction;
use crate::model::strength::{Strengths, add_bilinear, add_field};
use crate::model::{MutualDipoles, Problem, Solution};
use lbm_ibm_coupling::Soa3;
use lbm_ibm_coupling::nalgebra::Complex;
use std::f64::consts::PI;

/// The dipoles of beads of which some saturate.
pub(super) struct Bent {
    pub strengths: Strengths,
    local: Soa3,
    dipoles: Solution,
}

impl Bent {
    /// Solves the dipoles; none where no bead saturates.
    pub fn of(model: &mut MutualDipoles, problem: &Problem<'_>) -> Result<Option<Self>, MagneticsError> {
        if problem.beads.iter().all(|b| b.permeability().is_some()) {
            return Ok(None);
        }
        let mut interaction = Interaction::new(problem)?;
        let mut dipoles = Solution::new();
        dipoles.resize(problem.beads.len());
        dipoles.error = model.magnetise(problem, &mut interaction, &mut dipoles.moment)?;
        interaction.force(dipoles.moment.view(), &mut dipoles.force);
        finish(problem, &interaction, model.local_field(), &mut dipoles);
        let local: Soa3 = model.local_field().iter().collect();
        Ok(Some(Self {
            strengths: Strengths::of(problem, &local),
            local,
            dipoles,
        }))
    }

    /// Adds to the multipoles' solution, with incoming coefficients `into` but for the source's, what the own laws make of it.
    pub fn add(
        &self,
        model: &mut MutualDipoles,
        problem: &Problem<'_>,
        system: &mut System<'_>,
        mut into: Vec<Complex<f64>>,
        out: &mut Solution,
    ) {
        let n = problem.beads.len();
        let field = std::mem::take(&mut system.far.field);
        system.add_field(&field, &mut into);
        system.far.field = field;
        let unit = 4.0 * PI * MU0 * system.unit;
        let mut slopes = vec![0.0; n];
        let mut doubt: f64 = 0.0;
        for (i, bead) in problem.beads.iter().enumerate() {
            if bead.permeability().is_some() {
                continue;
            }
            let (h, strength) = (self.local.get(i), self.strengths.value[i]);
            out.energy += bead.self_energy(h) - 0.5 * self.dipoles.moment.get(i).dot(&h);
            let first = bead.response(Default::default()).across;
            slopes[i] = 0.5 * first * h.norm_squared() - 0.5 * unit * self.answer(system, &into, problem, i);
            let beyond = (out.force.get(i) - self.dipoles.force.get(i)).norm();
            doubt = doubt.max((1.0 - strength) * beyond);
        }
        out.error.force += doubt;
        let extra = self.strengths.moments(&slopes);
        let mut back = Soa3::zeros(n);
        let mut interaction_force = Soa3::zeros(n);
        let m = &self.dipoles.moment;
        add_field(&mut system.far, &extra, &mut back);
        add_bilinear(&mut system.far, m, &extra, &mut interaction_force);
        let mut last = Soa3::default();
        let (induced, iterations) = model.respond(problem, &mut system.far, &self.local, &back, &mut last);
        add_bilinear(&mut system.far, m, &induced, &mut interaction_force);
        out.error.iterations += iterations + self.dipoles.error.iterations;
        for i in 0..n {
            out.force.add(i, interaction_force.get(i));
            out.moment.add(i, extra.get(i) + induced.get(i));
        }
    }

    /// Sum over the orders of what comes in at bead `i`, weighted by its answer and that's relative slope with its strength.
    fn answer(&self, system: &System<'_>, into: &[Complex<f64>], problem: &Problem<'_>, i: usize) -> f64 {
        let (shape, at) = (&system.shapes[i], i * system.count);
        let (mut sum, mut k, mut l) = (0.0, 0, 1);
        while k < system.count {
            let slope = relative_slope(&problem.beads[i], self.strengths.value[i], l);
            for _ in 0..=l {
                sum += shape.weight[k] * shape.root[k].powi(2) * into[at + k].norm_sqr() * slope;
                k += 1;
            }
            l += 1;
        }
        shape.sign * sum
    }
}
