//! Mutual dipoles: every bead is magnetised by the source and by all the others.

use super::estimate::{Dipoles, Estimate};
use super::near::Interaction;
use super::{ErrorEstimate, Model, Problem, Solution};
use crate::bead::Response;
use crate::error::MagneticsError;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};

/// Self-consistent dipoles: h_i = B(x_i) + sum_j G_ij m_j(h_j), m_i the moment of bead i in the local field h_i.
///
/// Newton's method with conjugate gradients inside, on I - P^(1/2) G P^(1/2) with P = dm/dh: one Newton step for linear
/// beads. With the interaction of uniformly magnetised balls the operator is positive definite for every arrangement,
/// overlaps included, and every susceptibility above zero; where beads are diamagnetic, the normal equations. Never fixed-point
/// iteration, which diverges in packed clusters above mu_r = 8.7. The energy is sum int h dm - m.B - m G m/2, stationary
/// in the moments.
#[derive(Clone, Debug)]
pub struct MutualDipoles {
    tolerance: f64,
    local: Soa3,
    estimate: Estimate,
}

impl Default for MutualDipoles {
    fn default() -> Self {
        Self::new()
    }
}

const NEWTON: usize = 60;

impl MutualDipoles {
    /// Solved to a relative residual of 1e-10.
    pub fn new() -> Self {
        Self {
            tolerance: 1e-10,
            local: Soa3::default(),
            estimate: Estimate::default(),
        }
    }

    /// Solved to another relative residual of the local fields.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Local field at each bead in the last solution, T.
    pub fn local_field(&self) -> Soa3Ref<'_> {
        self.local.view()
    }

    /// Solves for the local fields and the moments.
    pub(super) fn magnetise(
        &mut self,
        problem: &Problem<'_>,
        dipoles: &mut Interaction<'_>,
        moment: &mut Soa3,
    ) -> Result<ErrorEstimate, MagneticsError> {
        let n = problem.beads.len();
        if self.local.len() != n || !self.local.iter().all(|h| h.iter().all(|c| c.is_finite())) {
            self.local.clone_from(&dipoles.field);
        }
        let mut made = 0;
        let mut state = State::at(problem, dipoles, &self.local);
        for _ in 0..NEWTON {
            let scale = norm(&dipoles.field).max(norm(&state.induced)).max(f64::MIN_POSITIVE);
            let residual = norm(&state.residual) / scale;
            if residual <= self.tolerance {
                moment.clone_from(&state.moment);
                return Ok(ErrorEstimate {
                    force: 0.0,
                    residual,
                    iterations: made,
                });
            }
            let (step, iterations) = newton_step(dipoles, &state, 0.3 * self.tolerance * scale);
            made += iterations;
            // Saturating beads can overshoot: shorten the step until the residual falls.
            let before = norm(&state.residual);
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
        Err(MagneticsError::NotConverged {
            model: "mutual dipoles",
            residual: norm(&state.residual) / norm(&dipoles.field).max(f64::MIN_POSITIVE),
            iterations: made,
            tolerance: self.tolerance,
        })
    }

    /// Solves A u = b, A = I - P^(1/2) G P^(1/2) of linear beads scaled back to moments: m = P u.
    pub(super) fn respond(&self, problem: &Problem<'_>, dipoles: &mut Interaction<'_>, b: &Soa3) -> (Soa3, usize) {
        let mut state = State::at(problem, dipoles, &self.local);
        state.residual.clone_from(b);
        let (step, iterations) = newton_step(dipoles, &state, self.tolerance * norm(b));
        let moment = (0..b.len())
            .map(|i| state.response[i].polarisability() * step.get(i))
            .collect();
        (moment, iterations)
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

/// |P|^(1/2) v and the sign of P, for a polarisability that is along or across the field.
fn root(response: &Response, v: Vec3) -> Vec3 {
    let n = response.direction;
    let along = n.dot(&v);
    n * (along * (response.along.abs().sqrt() - response.across.abs().sqrt())) + v * response.across.abs().sqrt()
}

/// The change of the local fields that takes away the residual, to `tolerance` (T), and the iterations made.
fn newton_step(dipoles: &mut Interaction<'_>, state: &State, tolerance: f64) -> (Soa3, usize) {
    let response = &state.response;
    let n = response.len();
    let sign: Vec<f64> = response
        .iter()
        .map(|r| if r.across < 0.0 { -1.0 } else { 1.0 })
        .collect();
    let diamagnetic = sign.iter().any(|s| *s < 0.0);
    // A y = y - S |P|^(1/2) G |P|^(1/2) y, with S the signs on the right of G: P = |P|^(1/2) S |P|^(1/2).
    let mut field = Soa3::default();
    let mut apply = |y: &Soa3, transposed: bool| -> Soa3 {
        let m: Soa3 = (0..n)
            .map(|i| root(&response[i], y.get(i)) * if transposed { 1.0 } else { sign[i] })
            .collect();
        dipoles.induced_field(m.view(), &mut field);
        (0..n)
            .map(|i| y.get(i) - root(&response[i], field.get(i)) * if transposed { sign[i] } else { 1.0 })
            .collect()
    };
    let b: Soa3 = (0..n).map(|i| root(&response[i], state.residual.get(i))).collect();
    let largest = response.iter().map(|r| r.across.abs()).fold(0.0, f64::max).sqrt();
    let goal = tolerance * largest;
    let mut y = Soa3::zeros(n);
    let mut residual = b.clone();
    let mut made = 0;
    if norm(&b) > goal {
        let mut z = if diamagnetic {
            apply(&residual, true)
        } else {
            residual.clone()
        };
        let mut p = z.clone();
        let mut zz = dot(&z, &z);
        for _ in 0..20 * n.max(10) {
            let q = apply(&p, false);
            made += 1;
            let curvature = if diamagnetic { dot(&q, &q) } else { dot(&p, &q) };
            if curvature <= 0.0 {
                break;
            }
            let alpha = zz / curvature;
            y = axpy(&y, alpha, &p);
            residual = axpy(&residual, -alpha, &q);
            if norm(&residual) <= goal {
                break;
            }
            z = if diamagnetic {
                apply(&residual, true)
            } else {
                residual.clone()
            };
            let next = dot(&z, &z);
            p = axpy(&z, next / zz, &p);
            zz = next;
        }
    }
    let m: Soa3 = (0..n).map(|i| root(&response[i], y.get(i)) * sign[i]).collect();
    dipoles.induced_field(m.view(), &mut field);
    (axpy(&state.residual, 1.0, &field), made)
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(&b)).sum()
}

pub(super) fn norm(a: &Soa3) -> f64 {
    dot(a, a).sqrt()
}

fn axpy(a: &Soa3, s: f64, b: &Soa3) -> Soa3 {
    a.iter().zip(b.iter()).map(|(a, b)| a + b * s).collect()
}

impl Model for MutualDipoles {
    fn name(&self) -> &'static str {
        "mutual dipoles"
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let mut dipoles = Interaction::new(problem)?;
        out.resize(problem.beads.len());
        out.error = self.magnetise(problem, &mut dipoles, &mut out.moment)?;
        finish(problem, &mut dipoles, out);
        let missed = self
            .estimate
            .force(Dipoles::Mutual, problem, &self.local, out.force.view())?;
        out.error.force = missed + out.error.residual * norm(&out.force);
        Ok(())
    }
}

/// Forces, torques and energy of moments that are known.
pub(super) fn finish(problem: &Problem<'_>, dipoles: &mut Interaction<'_>, out: &mut Solution) {
    let mut induced = Soa3::default();
    dipoles.field_and_force(out.moment.view(), out.moment.view(), &mut induced, &mut out.force);
    dipoles.add_source_force(out.moment.view(), &mut out.force);
    out.energy = 0.0;
    for (i, bead) in problem.beads.iter().enumerate() {
        let (m, own) = (out.moment.get(i), dipoles.field.get(i));
        let local = own + induced.get(i);
        out.torque.set(i, m.cross(&local));
        out.energy += bead.self_energy(local) - m.dot(&own) - 0.5 * m.dot(&induced.get(i));
    }
}
