//! Fixed dipoles: every bead has the moment of a lone bead in the source's field.

use super::estimate::{Dipoles, Estimate};
use super::near::{FACTOR, Interaction};
use super::{ErrorEstimate, Model, Problem, Solution};
use crate::error::MagneticsError;
use crate::kernel::{self, Sources, Want};
use lbm_ibm_coupling::{Soa3, Soa3Ref};

/// Forces (N) of dipoles of given moments `m` (A m2) at `x` (m) on each other, and with `torque` their torques (N m): the
/// bare sum, without source, energy or estimate. Dipoles at one place are left out.
pub fn dipole_forces(x: Soa3Ref<'_>, m: Soa3Ref<'_>, torque: bool, out: &mut Solution) {
    let mut sources = Sources::default();
    sources.set_positions(x);
    sources.set_moments(m);
    let want = if torque { Want::Both } else { Want::Force };
    let mut field = Soa3::default();
    kernel::sums(
        &sources,
        x,
        m,
        f64::MIN_POSITIVE.sqrt(),
        want,
        &mut field,
        &mut out.force,
    );
    out.torque.resize(x.len());
    for i in 0..x.len() {
        out.force.set(i, out.force.get(i) * FACTOR);
        if torque {
            out.torque.set(i, m.get(i).cross(&field.get(i)) * FACTOR);
        }
    }
}

/// Dipoles that do not magnetise each other.
///
/// The pair force is 3 mu0/(4 pi r^5) [(m1.r) m2 + (m2.r) m1 + (m1.m2) r - 5 (m1.r)(m2.r) r/r^2]. The energy is -sum m.B -
/// sum over pairs of m_i.B_j, and the forces are its gradient with the moments held.
#[derive(Clone, Debug, Default)]
pub struct FixedDipoles {
    given: Option<Soa3>,
    estimate: Estimate,
}

impl FixedDipoles {
    /// Moments from each bead's law in the source's field.
    pub fn new() -> Self {
        Self::default()
    }

    /// Moments (A m2) that are given, one per bead, in place of each bead's law.
    pub fn with_moments(mut self, moments: Soa3) -> Self {
        self.given = Some(moments);
        self
    }
}

impl Model for FixedDipoles {
    fn name(&self) -> &'static str {
        "fixed dipoles"
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let n = problem.beads.len();
        let mut dipoles = Interaction::new(problem)?;
        out.resize(n);
        match &self.given {
            Some(m) if m.len() != n => {
                return Err(MagneticsError::Count {
                    beads: n,
                    positions: m.len(),
                });
            }
            Some(m) => out.moment.clone_from(m),
            None => {
                for (i, bead) in problem.beads.iter().enumerate() {
                    out.moment.set(i, bead.response(dipoles.field.get(i)).moment);
                }
            }
        }
        let mut local = Soa3::default();
        dipoles.field_and_force(out.moment.view(), out.moment.view(), &mut local, &mut out.force);
        dipoles.add_source_force(out.moment.view(), &mut out.force);
        out.energy = 0.0;
        for i in 0..n {
            let (m, own) = (out.moment.get(i), dipoles.field.get(i));
            out.torque.set(i, m.cross(&(own + local.get(i))));
            out.energy -= m.dot(&own) + 0.5 * m.dot(&local.get(i));
        }
        for i in 0..n {
            local.add(i, dipoles.field.get(i));
        }
        out.error = ErrorEstimate {
            force: self.estimate.force(Dipoles::Fixed, problem, &local, out.force.view())?,
            ..ErrorEstimate::default()
        };
        Ok(())
    }
}
