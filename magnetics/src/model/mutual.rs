//! Mutual dipoles: every bead is magnetised by the source and by all the others.

use super::estimate::{Dipoles, Estimate};
use super::near::{Interaction, error_of_tree};
use super::operator::{Operator, axpy, norm};
use super::state::{restore_list, save_list};
use super::{ErrorEstimate, Model, Problem, Solution};
use crate::bead::Response;
use crate::error::MagneticsError;
use crate::tree::{Summation, Tree, TreeReport};
use lbm_ibm_coupling::{Soa3, Soa3Ref, StateError, StateReader, StateWriter, Vec3};

/// Self-consistent dipoles: h_i = B(x_i) + sum_j G_ij m_j(h_j), m_i the moment of bead i in the local field h_i.
///
/// Conjugate gradients on I - P^(1/2) G P^(1/2), P = dm/dh; with beads that saturate, inside of Newton's method. With the interaction of uniformly magnetised balls the operator is positive definite for every arrangement,
/// overlaps included, and every susceptibility above zero; where beads are diamagnetic, the normal equations. Never fixed-point
/// iteration, which diverges in packed clusters above mu_r = 8.7. The energy is sum int h dm - m.B - m G m/2, stationary
/// in the moments.
#[derive(Clone, Debug)]
pub struct MutualDipoles {
    tolerance: f64,
    local: Soa3,
    scaled: Soa3,
    estimate: Estimate,
    summation: Summation,
    report: Option<TreeReport>,
}

impl Default for MutualDipoles {
    fn default() -> Self {
        Self::new()
    }
}

const NEWTON: usize = 60;

impl MutualDipoles {
    /// Solved to a relative residual of 1e-7.
    pub fn new() -> Self {
        Self {
            tolerance: 1e-7,
            local: Soa3::default(),
            scaled: Soa3::default(),
            estimate: Estimate::default(),
            summation: Summation::default(),
            report: None,
        }
    }

    /// Solved to another relative residual of the local fields.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Sums by this tree, for any number of beads. Without it sums are direct up to 20 000 beads, and by
    /// [`Tree::new`] above.
    pub fn with_tree(mut self, tree: Tree) -> Self {
        self.summation = Summation::Tree(tree);
        self
    }

    /// Sums directly, for any number of beads.
    pub fn with_direct_sums(mut self) -> Self {
        self.summation = Summation::Direct;
        self
    }

    /// What a tree did in the last solution; none if the sums were direct.
    pub fn tree_report(&self) -> Option<TreeReport> {
        self.report
    }

    pub(super) fn summation(&self) -> Summation {
        self.summation
    }

    /// Local field at each bead in the last solution, T.
    pub fn local_field(&self) -> Soa3Ref<'_> {
        self.local.view()
    }

    /// Solves for the moments and the local fields.
    pub(super) fn magnetise(
        &mut self,
        problem: &Problem<'_>,
        dipoles: &mut Interaction<'_>,
        moment: &mut Soa3,
    ) -> Result<ErrorEstimate, MagneticsError> {
        let (iterations, residual) = if problem.beads.iter().all(|b| b.permeability().is_some()) {
            self.linear(problem, dipoles, moment)
        } else {
            self.newton(problem, dipoles, moment)
        };
        if residual > self.tolerance {
            return Err(MagneticsError::NotConverged {
                model: "mutual dipoles",
                residual,
                iterations,
                tolerance: self.tolerance,
            });
        }
        Ok(ErrorEstimate {
            force: 0.0,
            residual,
            iterations,
        })
    }

    fn linear(&mut self, problem: &Problem<'_>, dipoles: &mut Interaction<'_>, moment: &mut Soa3) -> (usize, f64) {
        let response: Vec<_> = problem.beads.iter().map(|b| b.response(Vec3::zeros())).collect();
        let remanent: Soa3 = response.iter().map(|r| r.moment).collect();
        let mut b = dipoles.field.clone();
        if norm(&remanent) > 0.0 {
            let mut field = Soa3::default();
            dipoles.induced_field(remanent.view(), &mut field);
            b = axpy(&b, 1.0, &field);
        }
        let operator = Operator::new(&response);
        let scale = norm(&b).max(f64::MIN_POSITIVE);
        let solved = operator.solve(dipoles, &b, self.tolerance * scale, &mut self.scaled);
        *moment = axpy(&operator.moments(&self.scaled), 1.0, &remanent);
        self.local = match operator.local_field(&self.scaled, &solved) {
            Some(local) => local,
            None => {
                let mut induced = Soa3::default();
                dipoles.induced_field(moment.view(), &mut induced);
                axpy(&dipoles.field, 1.0, &induced)
            }
        };
        (solved.iterations, solved.off / scale)
    }

    fn newton(&mut self, problem: &Problem<'_>, dipoles: &mut Interaction<'_>, moment: &mut Soa3) -> (usize, f64) {
        let n = problem.beads.len();
        if self.local.len() != n || !self.local.iter().all(|h| h.iter().all(|c| c.is_finite())) {
            self.local.clone_from(&dipoles.field);
        }
        let mut made = 0;
        let mut state = State::at(problem, dipoles, &self.local);
        for _ in 0..NEWTON {
            let scale = norm(&dipoles.field).max(norm(&state.induced)).max(f64::MIN_POSITIVE);
            let before = norm(&state.residual);
            if before <= self.tolerance * scale {
                moment.clone_from(&state.moment);
                self.local = axpy(&dipoles.field, 1.0, &state.induced);
                return (made, before / scale);
            }
            let operator = Operator::new(&state.response);
            let mut scaled = Soa3::zeros(n);
            made += operator
                .solve(dipoles, &state.residual, 0.3 * self.tolerance * scale, &mut scaled)
                .iterations;
            let mut step = Soa3::default();
            dipoles.induced_field(operator.moments(&scaled).view(), &mut step);
            let step = axpy(&state.residual, 1.0, &step);
            // Saturating beads can overshoot: shorten the step until the residual falls.
            let mut fraction = 1.0;
            loop {
                let trial = axpy(&self.local, fraction, &step);
                let next = State::at(problem, dipoles, &trial);
                let fell = norm(&next.residual) < (1.0 - 1e-4 * fraction) * before;
                if fell || fraction < 1e-4 {
                    self.local = trial;
                    state = next;
                    break;
                }
                fraction *= 0.5;
            }
        }
        (made, f64::INFINITY)
    }

    /// Moments (A m2) that the additional fields `b` (T) induce on top of the local fields `local` (T), to first order,
    /// starting from `last`, the scaled moments of the last call; and the iterations made. They are a part of a correction: the root of the tolerance is enough.
    pub(super) fn respond(
        &self,
        problem: &Problem<'_>,
        dipoles: &mut Interaction<'_>,
        local: &Soa3,
        b: &Soa3,
        last: &mut Soa3,
    ) -> (Soa3, usize) {
        let beads = problem.beads.iter().enumerate();
        let response: Vec<_> = beads.map(|(i, bead)| bead.response(local.get(i))).collect();
        let operator = Operator::new(&response);
        let solved = operator.solve(dipoles, b, self.tolerance.sqrt() * norm(b), last);
        (operator.moments(last), solved.iterations)
    }
}

/// Moments, fields and residual for one guess of the local fields.
struct State {
    response: Vec<Response>,
    moment: Soa3,
    induced: Soa3,
    residual: Soa3,
}

impl State {
    fn at(problem: &Problem<'_>, dipoles: &mut Interaction<'_>, local: &Soa3) -> Self {
        let response: Vec<_> = (0..local.len())
            .map(|i| problem.beads[i].response(local.get(i)))
            .collect();
        let moment: Soa3 = response.iter().map(|r| r.moment).collect();
        let mut induced = Soa3::default();
        dipoles.induced_field(moment.view(), &mut induced);
        let residual = (0..local.len())
            .map(|i| dipoles.field.get(i) + induced.get(i) - local.get(i))
            .collect();
        Self {
            response,
            moment,
            induced,
            residual,
        }
    }
}

impl Model for MutualDipoles {
    fn name(&self) -> &'static str {
        "mutual dipoles"
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let mut dipoles = Interaction::summed(problem, &self.summation)?;
        out.resize(problem.beads.len());
        out.error = self.magnetise(problem, &mut dipoles, &mut out.moment)?;
        dipoles.force(out.moment.view(), &mut out.force);
        self.report = dipoles.report;
        let missed = error_of_tree(self.report, &out.force);
        finish(problem, &dipoles, self.local.view(), out);
        let estimate = &mut self.estimate;
        let of_dipoles = estimate.force(Dipoles::Mutual, problem, &self.local, out.force.view())?;
        out.error.force = missed + of_dipoles + out.error.residual * norm(&out.force);
        Ok(())
    }

    fn save(&self, to: &mut StateWriter) {
        save_list(&self.scaled, to);
        save_list(&self.local, to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        restore_list(&mut self.scaled, from)?;
        restore_list(&mut self.local, from)
    }
}

/// Adds the source's force, and finds torques and energy of moments that are known, in the fields `local` (T).
pub(super) fn finish(problem: &Problem<'_>, dipoles: &Interaction<'_>, local: Soa3Ref<'_>, out: &mut Solution) {
    dipoles.add_source_force(out.moment.view(), &mut out.force);
    out.energy = 0.0;
    for (i, bead) in problem.beads.iter().enumerate() {
        let (m, own, local) = (out.moment.get(i), dipoles.field.get(i), local.get(i));
        out.torque.set(i, m.cross(&local));
        out.energy += bead.self_energy(local) - 0.5 * m.dot(&(own + local));
    }
}
