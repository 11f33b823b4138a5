//! Jobs shared among threads.

use std::error::Error;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Does all jobs, as many at a time as there are cores; each has an equal share of the cores for its own threads. The
/// results are in the order of the jobs.
pub fn share_out<J: Sync, R: Send>(jobs: &[J], work: impl Fn(&J) -> R + Sync) -> Result<Vec<R>, Box<dyn Error>> {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let workers = cores.min(jobs.len()).max(1);
    let next = AtomicUsize::new(0);
    let worker = || -> Result<Vec<(usize, R)>, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(cores / workers).build()?;
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(i) else {
                return Ok(done);
            };
            done.push((i, pool.install(|| work(job))));
        }
    };
    let mut results = Vec::new();
    thread::scope(|scope| -> Result<(), Box<dyn Error>> {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(worker)).collect();
        for handle in handles {
            results.extend(handle.join().map_err(|_| "a worker has panicked")??);
        }
        Ok(())
    })?;
    results.sort_by_key(|(i, _)| *i);
    Ok(results.into_iter().map(|(_, r)| r).collect())
}
