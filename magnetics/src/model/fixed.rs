//! Fixed dipoles: every bead has the moment of a lone bead in the source's field.

use super::estimate::{Dipoles, Estimate};
use super::near::{FACTOR, Interaction, error_of_tree, scale};
use super::{ErrorEstimate, Model, Problem, Solution};
use crate::error::MagneticsError;
use crate::kernel::Want;
use crate::tree::{DipoleSums, Summation, Tree, TreeReport};
use lbm_ibm_coupling::{Soa3, Soa3Ref};

/// Forces (N) of dipoles of given moments `m` (A m2) at `x` (m) on each other, and with `torque` their torques (N m): the
/// bare direct sum, without source, energy or estimate. Dipoles at one place are left out.
pub fn dipole_forces(x: Soa3Ref<'_>, m: Soa3Ref<'_>, torque: bool, out: &mut Solution) {
    bare(x, m, torque, None, out);
}

/// As [`dipole_forces`], by a tree.
pub fn tree_forces(x: Soa3Ref<'_>, m: Soa3Ref<'_>, torque: bool, tree: Tree, out: &mut Solution) -> TreeReport {
    bare(x, m, torque, Some(tree), out).unwrap_or_default()
}

fn bare(x: Soa3Ref<'_>, m: Soa3Ref<'_>, torque: bool, tree: Option<Tree>, out: &mut Solution) -> Option<TreeReport> {
    let mut sums = DipoleSums::new(x, None, f64::MIN_POSITIVE.sqrt(), tree);
    let want = if torque { Want::Both } else { Want::Force };
    let mut field = Soa3::default();
    sums.sums(m, m, want, &mut field, &mut out.force);
    let report = sums.report(&[[m, m]], &out.force);
    scale(&mut out.force, FACTOR);
    out.torque.resize(x.len());
    if torque {
        for i in 0..x.len() {
            out.torque.set(i, m.get(i).cross(&field.get(i)) * FACTOR);
        }
    }
    report
}

/// Dipoles that do not magnetise each other.
///
/// The pair force is 3 mu0/(4 pi r^5) [(m1.r) m2 + (m2.r) m1 + (m1.m2) r - 5 (m1.r)(m2.r) r/r^2]. The energy is -sum m.B -
/// sum over pairs of m_i.B_j, and the forces are its gradient with the moments held.
#[derive(Clone, Debug, Default)]
pub struct FixedDipoles {
    given: Option<Soa3>,
    estimate: Estimate,
    summation: Summation,
    report: Option<TreeReport>,
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
}

impl Model for FixedDipoles {
    fn name(&self) -> &'static str {
        "fixed dipoles"
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let n = problem.beads.len();
        let mut dipoles = Interaction::summed(problem, &self.summation)?;
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
        dipoles.field_and_force(out.moment.view(), &mut local, &mut out.force);
        self.report = dipoles.report;
        let missed = error_of_tree(self.report, &out.force);
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
            force: missed + self.estimate.force(Dipoles::Fixed, problem, &local, out.force.view())?,
            ..ErrorEstimate::default()
        };
        Ok(())
    }
}
