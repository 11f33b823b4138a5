//! Every rung of the ladder on the same chains.

use super::{scattered, times};
use crate::Fault;
use lbm_ibm::coupling::{Soa3, UM, Vec3};
use lbm_ibm::magnetics::{
    Bead, FixedDipoles, Intrinsic, Model, MutualDipoles, PairCorrected, Problem, Solution, Tree, Uniform,
    dipole_forces, tree_forces,
};
use serde::Serialize;

const RADIUS: f64 = 2.0 * UM;

/// One rung.
#[derive(Clone, Debug, Serialize)]
pub struct Rung {
    /// Sum or model.
    pub rung: &'static str,
    /// `bare`: the sum alone. `cold`: a new model's first solution, its tables among it. `warm`: the next, every bead moved by
    /// up to 1e-3 radii in each direction since the last.
    pub start: &'static str,
    /// Beads.
    pub count: usize,
    /// Threads.
    pub threads: usize,
    /// Milliseconds per solution, the median.
    pub ms: f64,
    /// Milliseconds of the fastest.
    pub best_ms: f64,
    /// Fastest time over the number of ordered pairs, ns.
    pub ns_per_pair: f64,
    /// Iterations of conjugate gradients in the last solution.
    pub iterations: usize,
    /// Sampled rms error of a tree's forces over their rms; zero where the sum is direct.
    pub tree_error: f64,
}

/// How the rungs sum.
#[derive(Clone, Copy, Debug)]
pub enum Sums {
    /// As models choose by themselves; the bare sums directly.
    Automatic,
    /// Directly, whatever the number.
    Direct,
    /// By a tree of this accuracy.
    Tree(f64),
}

/// Chains of ten touching-but-for-5 % beads, side by side, every bead moved by `step` times up to 1e-3 radii.
fn chains(count: usize, step: usize) -> Soa3 {
    let side = (count.div_ceil(10) as f64).sqrt().ceil() as usize;
    (0..count)
        .map(|k| {
            let (chain, link) = (k / 10, k % 10);
            let foot = Vec3::new((chain % side) as f64, (chain / side) as f64, 0.0) * (6.0 * RADIUS);
            let moved = (0..step.min(1)).map(|_| Vec3::from([0, 1, 2].map(|a| scattered(k + 31 * step, a))));
            foot + Vec3::z() * (link as f64 * 2.05 * RADIUS) + moved.sum::<Vec3>() * (0.5e-3 * RADIUS)
        })
        .collect()
}

/// Times every rung with `count` beads, or the `bare` sums alone.
///
/// # Errors
/// Those of the models.
pub fn rungs(count: usize, threads: usize, seconds: f64, sums: Sums, bare: bool) -> Result<Vec<Rung>, Fault> {
    let bead = Bead::new(RADIUS, 1500.0, Intrinsic::new(1.0)?)?;
    let beads = vec![bead; count];
    let source = Uniform::new(Vec3::z() * 0.05);
    let (mut out, x) = (Solution::new(), chains(count, 0));
    let row = |rung, start, times: &[f64], iterations, tree_error| Rung {
        rung,
        start,
        count,
        threads,
        ms: 1e3 * times[times.len() / 2],
        best_ms: 1e3 * times[0],
        ns_per_pair: 1e9 * times[0] / (count as f64).powi(2),
        iterations,
        tree_error,
    };
    let tree = match sums {
        Sums::Tree(accuracy) => Some(Tree::new().with_accuracy(accuracy)?),
        _ => None,
    };
    let direct = matches!(sums, Sums::Direct);
    FixedDipoles::new().solve(&Problem::new(&beads, x.view(), &source, 0.0)?, &mut out)?;
    let m = out.moment.clone();
    let mut rows = Vec::new();
    for (name, torque) in [
        ("fixed dipoles, force", false),
        ("fixed dipoles, force and torque", true),
    ] {
        let (all, error) = times(seconds, || {
            Ok(match tree {
                Some(tree) => tree_forces(x.view(), m.view(), torque, tree, &mut out).rms_error,
                None => {
                    dipole_forces(x.view(), m.view(), torque, &mut out);
                    0.0
                }
            })
        })?;
        rows.push(row(name, "bare", &all, 0, error));
    }
    if bare {
        return Ok(rows);
    }
    macro_rules! rung {
        ($name:literal, $new:expr) => {{
            let model = || match (tree, direct) {
                (Some(tree), _) => $new.with_tree(tree),
                (None, true) => $new.with_direct_sums(),
                (None, false) => $new,
            };
            let (all, made) = times(0.0, || {
                model().solve(&Problem::new(&beads, x.view(), &source, 0.0)?, &mut out)?;
                Ok(out.error.iterations)
            })?;
            rows.push(row($name, "cold", &all, made, 0.0));
            let (mut model, mut step) = (model(), 0);
            model.solve(&Problem::new(&beads, x.view(), &source, 0.0)?, &mut out)?;
            let mut spent = Vec::new();
            let begin = std::time::Instant::now();
            while spent.len() < 3 || begin.elapsed().as_secs_f64() < seconds {
                step += 1;
                let y = chains(count, step);
                let start = std::time::Instant::now();
                model.solve(&Problem::new(&beads, y.view(), &source, 0.0)?, &mut out)?;
                spent.push(start.elapsed().as_secs_f64());
            }
            spent.sort_by(f64::total_cmp);
            let error = model.tree_report().map_or(0.0, |r| r.rms_error);
            rows.push(row($name, "warm", &spent, out.error.iterations, error));
        }};
    }
    rung!("fixed dipoles", FixedDipoles::new());
    rung!("mutual dipoles", MutualDipoles::new());
    rung!("pair-corrected", PairCorrected::new());
    Ok(rows)
}
