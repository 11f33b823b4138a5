//! Loops that run on the threads of the current rayon pool, or plainly where there is one thread or no rayon.

use lbm_ibm_coupling::BRICK_NODES;
#[cfg(feature = "parallel")]
use rayon::prelude::*;

/// Whether there is a pool with more than one thread.
#[cfg(feature = "parallel")]
fn threaded() -> bool {
    rayon::current_num_threads() > 1
}

/// Threads of the current pool.
pub fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Calls `work` for pieces of `size` states with the number of the first. `few` says that threads would not pay.
pub fn for_pieces<S: Send>(few: bool, states: &mut [S], size: usize, work: impl Fn(usize, &mut [S]) + Sync) {
    #[cfg(feature = "parallel")]
    if !few && threaded() {
        let pieces = states.par_chunks_mut(size).enumerate();
        return pieces.for_each(|(n, piece)| work(n * size, piece));
    }
    let _ = few;
    for (n, piece) in states.chunks_mut(size).enumerate() {
        work(n * size, piece);
    }
}

/// The results of `work` in the order of the items.
pub fn map<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    #[cfg(feature = "parallel")]
    if threaded() {
        return items.par_iter().map(work).collect();
    }
    items.iter().map(work).collect()
}

/// The first result, in the order of the items.
pub fn find_map_first<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> Option<R> + Sync + Send) -> Option<R> {
    #[cfg(feature = "parallel")]
    if threaded() {
        return items.par_iter().find_map_first(work);
    }
    items.iter().find_map(work)
}

/// Calls `work` for parts of `size` items, with the number of the first and with the bricks of these items in three arrays.
pub fn for_slots<T: Sync>(
    items: &[T],
    [x, y, z]: [&mut [f64]; 3],
    size: usize,
    work: impl Fn(usize, &[T], [&mut [f64]; 3]) + Sync,
) {
    let nodes = size * BRICK_NODES;
    #[cfg(feature = "parallel")]
    if threaded() {
        let parts = x.par_chunks_mut(nodes).zip(y.par_chunks_mut(nodes));
        return items
            .par_chunks(size)
            .zip(parts.zip(z.par_chunks_mut(nodes)))
            .enumerate()
            .for_each(|(n, (items, ((x, y), z)))| work(n * size, items, [x, y, z]));
    }
    let parts = x.chunks_mut(nodes).zip(y.chunks_mut(nodes)).zip(z.chunks_mut(nodes));
    for (n, (items, ((x, y), z))) in items.chunks(size).zip(parts).enumerate() {
        work(n * size, items, [x, y, z]);
    }
}
