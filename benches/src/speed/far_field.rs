//! The direct sum and trees of several accuracies against the number of beads: the chart `far-field`.

use super::{scattered, times};
use crate::Fault;
use lbm_ibm::coupling::{Soa3, UM, Vec3};
use lbm_ibm::magnetics::{Solution, Tree, dipole_forces, tree_forces};
use serde::Serialize;

/// Greatest number of beads that are summed directly.
const DIRECT: usize = 40_000;

/// Force and torque of all beads once, one line and number of the chart.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// `direct`, or `tree` and its accuracy.
    pub label: String,
    /// Beads.
    pub n: usize,
    /// Seconds, the fastest of three or more.
    pub seconds: f64,
    /// Rms error of the forces over their rms, held against the direct sum at 128 beads; zero for the direct sum.
    pub rms_error: f64,
}

/// A loose cloud: a cubic lattice of three radii, beads of 2 um moved by up to 0.4 radii in each direction, and their
/// moments, nearly along z.
fn cloud(count: usize) -> (Soa3, Soa3) {
    let side = (count as f64).cbrt().ceil() as usize;
    let place = |k: usize| Vec3::new((k % side) as f64, (k / side % side) as f64, (k / side / side) as f64);
    let off = |k: usize| Vec3::from([0, 1, 2].map(|a| scattered(k, a)));
    let x = (0..count).map(|k| (place(k) * 6.0 + off(k) * 0.8) * UM).collect();
    let m = (0..count).map(|k| (Vec3::z() + off(k + 7) * 0.2) * 1e-12).collect();
    (x, m)
}

/// Times the direct sum and trees of accuracy 1e-2 to 1e-5 for each number of beads, with the threads of the pool that it is
/// called in.
///
/// # Errors
/// None for these settings.
pub fn far_field(counts: &[usize], seconds: f64) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    let mut out = Solution::new();
    for n in counts.iter().copied() {
        let (x, m) = cloud(n);
        if n <= DIRECT {
            let (all, ()) = times(seconds, || {
                dipole_forces(x.view(), m.view(), true, &mut out);
                Ok(())
            })?;
            rows.push(Row {
                label: "direct".into(),
                n,
                seconds: all[0],
                rms_error: 0.0,
            });
        }
        for accuracy in [1e-2, 1e-3, 1e-4, 1e-5] {
            let tree = Tree::new().with_accuracy(accuracy)?;
            let (all, report) = times(seconds, || Ok(tree_forces(x.view(), m.view(), true, tree, &mut out)))?;
            rows.push(Row {
                label: format!("tree {accuracy:e}"),
                n,
                seconds: all[0],
                rms_error: report.rms_error,
            });
        }
    }
    Ok(rows)
}
