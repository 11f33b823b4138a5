//! The ladder of models.

mod auto;
mod corrected;
mod dense;
mod estimate;
mod fixed;
mod multipole;
mod mutual;
mod near;
mod operator;
mod state;
mod strength;
mod tables;

pub use auto::Auto;
pub use corrected::PairCorrected;
pub use dense::dense_moments;
pub use fixed::{FixedDipoles, dipole_forces, tree_forces};
pub use multipole::Multipoles;
pub use mutual::MutualDipoles;

use crate::bead::Bead;
use crate::error::MagneticsError;
use crate::source::FieldSource;
use lbm_ibm_coupling::{Soa3, Soa3Ref, StateError, StateReader, StateWriter, Vec3};

/// Beads somewhere in a field: what a model solves.
#[derive(Clone, Copy)]
pub struct Problem<'a> {
    beads: &'a [Bead],
    positions: Soa3Ref<'a>,
    source: &'a dyn FieldSource,
    time: f64,
}

impl<'a> Problem<'a> {
    /// `beads` at `positions` (m, one each) in the field of `source` at `time` (s).
    ///
    /// # Errors
    /// [`MagneticsError::Count`], [`MagneticsError::NotFinite`] for a position.
    pub fn new(
        beads: &'a [Bead],
        positions: Soa3Ref<'a>,
        source: &'a dyn FieldSource,
        time: f64,
    ) -> Result<Self, MagneticsError> {
        if beads.len() != positions.len() {
            return Err(MagneticsError::Count {
                beads: beads.len(),
                positions: positions.len(),
            });
        }
        if let Some(bead) = positions.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            return Err(MagneticsError::NotFinite { what: "position", bead });
        }
        Ok(Self {
            beads,
            positions,
            source,
            time,
        })
    }

    /// Tells of the first pair of beads that overlap by more than `allowed` (m). Models take overlaps as they are: the
    /// moments stay finite, but no overlap is physical.
    ///
    /// # Errors
    /// [`MagneticsError::Overlap`].
    pub fn check_overlap(&self, allowed: f64) -> Result<(), MagneticsError> {
        for pair in near::pairs(self, 2.0 * self.largest_radius()) {
            let depth = self.beads[pair.i].radius() + self.beads[pair.j].radius() - pair.distance;
            if depth > allowed {
                return Err(MagneticsError::Overlap {
                    first: pair.i,
                    second: pair.j,
                    depth,
                });
            }
        }
        Ok(())
    }

    /// The beads.
    pub fn beads(&self) -> &'a [Bead] {
        self.beads
    }

    /// Their centres, m.
    pub fn positions(&self) -> Soa3Ref<'a> {
        self.positions
    }

    fn largest_radius(&self) -> f64 {
        self.beads.iter().map(Bead::radius).fold(0.0, f64::max)
    }
}

/// What a model finds; arrays have one entry per bead.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// Moments, A m2.
    pub moment: Soa3,
    /// Forces, N: of the source and of the other beads. The source feels minus their sum.
    pub force: Soa3,
    /// Torques about each bead's own centre, N m.
    pub torque: Soa3,
    /// Energy whose gradient the forces are, J. See each model for what is held fixed.
    pub energy: f64,
    /// How far off it may be.
    pub error: ErrorEstimate,
}

impl Solution {
    /// An empty solution, to be filled by [`Model::solve`].
    pub fn new() -> Self {
        Self::default()
    }

    /// Force on the source (N): minus the sum of the forces on the beads.
    pub fn recoil(&self) -> Vec3 {
        -self.force.iter().sum::<Vec3>()
    }

    fn resize(&mut self, n: usize) {
        self.moment.resize(n);
        self.force.resize(n);
        self.torque.resize(n);
    }
}

/// How far off a solution may be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// Estimated greatest error of the force on any bead, N, against spheres solved exactly.
    pub force: f64,
    /// Relative residual of the linear system.
    pub residual: f64,
    /// Iterations of the solver.
    pub iterations: usize,
}

/// A rung of the ladder: finds moments, forces and torques of beads in a field.
///
/// Forces are F_i = (grad B)^T m_i with the moments held fixed, and the gradient of [`Solution::energy`].
pub trait Model: Send {
    /// What it is, for reports.
    fn name(&self) -> &'static str;

    /// Solves `problem` into `out`. A model keeps its last solution and starts from it when the number of beads is the same.
    ///
    /// # Errors
    /// [`MagneticsError::NotFinite`] for a field, [`MagneticsError::NotConverged`].
    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError>;

    /// Writes the solution from which the next one starts, for [`lbm_ibm_coupling::Scene::save`]. By default there is none.
    fn save(&self, _to: &mut StateWriter) {}

    /// Takes what [`Model::save`] has written.
    ///
    /// # Errors
    /// [`StateError`].
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Ok(())
    }
}

impl<M: Model + ?Sized> Model for Box<M> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        (**self).solve(problem, out)
    }

    fn save(&self, to: &mut StateWriter) {
        (**self).save(to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        (**self).restore(from)
    }
}
