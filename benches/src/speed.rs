//! Timings of the fluid, of cells in it, and of magnetic sums and fields, as rows that the program `speed` prints and charts
//! are drawn from.

pub mod beads;
pub mod cells;
pub mod dipoles;
pub mod far_field;
pub mod field;
pub mod fluid;

use crate::Fault;
use std::time::Instant;

/// Seconds of each call of `work`, in ascending order: three calls or more, for the seconds asked. `work` returns what is to
/// be told of the last call.
pub fn times<T>(seconds: f64, mut work: impl FnMut() -> Result<T, Fault>) -> Result<(Vec<f64>, T), Fault> {
    let (begin, mut all) = (Instant::now(), Vec::new());
    loop {
        let start = Instant::now();
        let told = work()?;
        all.push(start.elapsed().as_secs_f64());
        if all.len() >= 3 && begin.elapsed().as_secs_f64() >= seconds {
            all.sort_by(f64::total_cmp);
            return Ok((all, told));
        }
    }
}

/// Numbers in [-1, 1) that are the same on every run: the sine of large steps, cut.
fn scattered(k: usize, axis: usize) -> f64 {
    let s = (k as f64 * [12.9898, 78.233, 37.719][axis] + axis as f64).sin() * 43_758.545_3;
    2.0 * (s - s.floor()) - 1.0
}
