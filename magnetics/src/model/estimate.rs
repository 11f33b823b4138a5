//! How far dipoles may be off: what they miss of each near pair, in the local field.

use super::Problem;
use super::near;
use super::tables::{Tables, force_size};
use crate::error::MagneticsError;
use crate::two_sphere::Fineness;
use lbm_ibm_coupling::{Soa3, Soa3Ref};

/// Gaps to which pairs are looked at one by one, in mean radii.
const REACH: f64 = 2.0;
/// What the sum over pairs is multiplied by, for what three beads do together.
const SAFETY: f64 = 1.5;

/// Which dipoles the estimate is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Dipoles {
    Fixed,
    Mutual,
}

/// Estimates the error of dipole forces.
#[derive(Clone, Debug)]
pub(super) struct Estimate {
    tables: Tables,
}

impl Default for Estimate {
    fn default() -> Self {
        Self {
            tables: Tables::new(Fineness::ESTIMATE, REACH),
        }
    }
}

impl Estimate {
    /// Greatest error (N) of the force on any bead: per near pair, exact less dipole force in the local field `local` (T);
    /// for the rest a fraction of the dipole `force` (N), leading order of what is left out at the reach.
    pub fn force(
        &mut self,
        dipoles: Dipoles,
        problem: &Problem<'_>,
        local: &Soa3,
        force: Soa3Ref<'_>,
    ) -> Result<f64, MagneticsError> {
        let n = problem.beads.len();
        let mut off = vec![0.0; n];
        let reach = 2.0 * problem.largest_radius() + self.tables.reach_of(problem);
        for pair in near::pairs(problem, reach) {
            let (i, j) = (pair.i, pair.j);
            let Some((index, _)) = self.tables.of(&problem.beads[i], &problem.beads[j])? else {
                continue;
            };
            let table = self.tables.get(index);
            let missed = match dipoles {
                Dipoles::Fixed => table.beyond_fixed(pair.distance),
                Dipoles::Mutual => table.correction(pair.distance),
            };
            let (a, b) = (local.get(i), local.get(j));
            let size = force_size(&missed, &pair, if a.norm() > b.norm() { a } else { b });
            off[i] += size;
            off[j] += size;
        }
        let mut worst: f64 = 0.0;
        for (i, bead) in problem.beads.iter().enumerate() {
            let mu = bead.initial_permeability();
            let far = REACH + 2.0;
            let tail = match dipoles {
                Dipoles::Fixed => 8.0 * (mu - 1.0).abs() / (mu + 2.0) / far.powi(3),
                Dipoles::Mutual => 25.0 * 2.0 * (mu - 1.0).abs() / (2.0 * mu + 3.0) / far.powi(5),
            };
            worst = worst.max(SAFETY * off[i] + tail * force.get(i).norm());
        }
        Ok(worst)
    }
}
