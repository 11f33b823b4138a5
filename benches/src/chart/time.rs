//! What pieces of work cost.

use crate::Fault;
use std::time::{Duration, Instant};

/// A burst is long enough for the clock, and short enough that most are not interrupted.
const BURST: Duration = Duration::from_micros(500);

/// A piece of work that can be done over and over.
pub type Work<'a> = Box<dyn FnMut() -> Result<(), Fault> + 'a>;

/// Processor time that the program has used, s: what other programs take of the machine does not count.
#[cfg(unix)]
fn processor_time() -> f64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call fills the one timespec that it is given.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut now) };
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Time on the clock, s, where a program cannot ask for its own.
#[cfg(not(unix))]
fn processor_time() -> f64 {
    static START: std::sync::LazyLock<Instant> = std::sync::LazyLock::new(Instant::now);
    START.elapsed().as_secs_f64()
}

/// Processor seconds of one call of each work: the lower quartile of 64 bursts (of a quick run 8) of half a millisecond or one call,
/// for what disturbs a machine only ever adds. A first call, which may build tables, does not count. The works take turns,
/// so that it disturbs all alike and ratios are truer than the seconds.
///
/// # Errors
/// The first one of the works.
pub fn seconds_per_call(quick: bool, works: &mut [Work]) -> Result<Vec<f64>, Fault> {
    let mut calls = Vec::with_capacity(works.len());
    for work in works.iter_mut() {
        work()?;
        let (mut count, begin) = (0_u32, Instant::now());
        while count == 0 || begin.elapsed() < BURST {
            work()?;
            count += 1;
        }
        calls.push(count);
    }
    let mut times = vec![Vec::new(); works.len()];
    for _ in 0..if quick { 8 } else { 64 } {
        for ((work, &calls), times) in works.iter_mut().zip(&calls).zip(&mut times) {
            let begin = processor_time();
            for _ in 0..calls {
                work()?;
            }
            times.push((processor_time() - begin) / f64::from(calls));
        }
    }
    let quartile = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 4]
    };
    Ok(times.into_iter().map(quartile).collect())
}
