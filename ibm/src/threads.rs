//! Fork and join over slices. Results never depend on the number of threads: each output is computed whole, by one task.

use lbm_ibm_coupling::{Work, on_widest};

/// Number of threads.
pub(crate) fn count() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}

/// Runs both, on two threads where there are two.
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        return rayon::join(a, b);
    }
    (a(), b())
}

/// Sets `out[i]` to `value(first + i)`, at least `leaf` items to a task.
pub(crate) fn fill<T: Send>(out: &mut [T], first: usize, leaf: usize, value: &(impl Fn(usize) -> T + Sync)) {
    if out.len() <= leaf {
        return on_widest(Fill { out, first, value });
    }
    let half = out.len() / 2;
    let (a, b) = out.split_at_mut(half);
    join(|| fill(a, first, leaf, value), || fill(b, first + half, leaf, value));
}

struct Fill<'a, T, F> {
    out: &'a mut [T],
    first: usize,
    value: &'a F,
}

impl<T, F: Fn(usize) -> T> Work for Fill<'_, T, F> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for (i, o) in self.out.iter_mut().enumerate() {
            *o = (self.value)(self.first + i);
        }
    }
}

/// Calls `work` with the number of the first item, `a[i]` and the `i`-th part of `b`, of `width` items.
pub(crate) fn parts<A: Send, B: Send>(
    a: &mut [A],
    b: &mut [B],
    width: usize,
    first: usize,
    work: &(impl Fn(usize, &mut A, &mut [B]) + Sync),
) {
    match a {
        [] => {}
        [a] => work(first, a, b),
        _ => {
            let half = a.len() / 2;
            let (a_left, a_right) = a.split_at_mut(half);
            let (b_left, b_right) = b.split_at_mut(b.len().min(half * width));
            join(
                || parts(a_left, b_left, width, first, work),
                || parts(a_right, b_right, width, first + half * width, work),
            );
        }
    }
}

/// Calls `work` with the number of the first row and that task's part of three arrays with rows of `width` items, at
/// most `leaf` rows to a task.
pub(crate) fn rows(
    out: [&mut [f64]; 3],
    width: usize,
    first: usize,
    leaf: usize,
    work: &(impl Fn(usize, [&mut [f64]; 3]) + Sync),
) {
    let count = out[0].len() / width;
    if count <= leaf {
        return work(first, out);
    }
    let half = count / 2;
    let [x, y, z] = out;
    let (xa, xb) = x.split_at_mut(half * width);
    let (ya, yb) = y.split_at_mut(half * width);
    let (za, zb) = z.split_at_mut(half * width);
    join(
        || rows([xa, ya, za], width, first, leaf, work),
        || rows([xb, yb, zb], width, first + half, leaf, work),
    );
}
