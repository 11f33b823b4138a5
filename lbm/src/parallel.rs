//! Loops that run on the threads of the current rayon pool, or plainly where there is one thread or no rayon.

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

/// Calls `work` for each item with its chunk of `size` numbers of three arrays.
pub fn for_each_chunk<T: Sync>(
    items: &[T],
    [x, y, z]: &mut [Vec<f64>; 3],
    size: usize,
    work: impl Fn(usize, &T, [&mut [f64]; 3]) + Sync,
) {
    #[cfg(feature = "parallel")]
    if threaded() {
        return items
            .par_iter()
            .zip(
                x.par_chunks_mut(size)
                    .zip(y.par_chunks_mut(size))
                    .zip(z.par_chunks_mut(size)),
            )
            .enumerate()
            .for_each(|(n, (item, ((x, y), z)))| work(n, item, [x, y, z]));
    }
    let chunks = x.chunks_mut(size).zip(y.chunks_mut(size)).zip(z.chunks_mut(size));
    for (n, (item, ((x, y), z))) in items.iter().zip(chunks).enumerate() {
        work(n, item, [x, y, z]);
    }
}
