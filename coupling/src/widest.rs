//! Loops compiled for the widest vectors of the processor.

/// Work that [`on_widest`] compiles several times, once for each instruction set. `run` and what it calls in its loops are
/// to be `#[inline(always)]`, or they stay compiled for the least processor.
pub trait Work {
    /// What it returns.
    type Out;
    /// Does it.
    fn run(self) -> Self::Out;
}

/// Does `work` compiled for the widest vectors that this processor has: AVX-512, AVX2, or what the target has.
///
/// Plain arithmetic (no `mul_add`) gives the same bits on all of them, since nothing is contracted or reordered.
///
/// ```
/// use lbm_ibm_coupling::{Work, on_widest};
///
/// struct Scale<'a>(&'a mut [f64], f64);
///
/// impl Work for Scale<'_> {
///     type Out = ();
///     #[inline(always)]
///     fn run(self) {
///         self.0.iter_mut().for_each(|x| *x *= self.1);
///     }
/// }
/// let mut x = [1.0, 2.0, 3.0];
/// on_widest(Scale(&mut x, 2.0));
/// assert_eq!(x, [2.0, 4.0, 6.0]);
/// ```
#[inline]
pub fn on_widest<W: Work>(work: W) -> W::Out {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::is_x86_feature_detected as has;
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma")]
        fn eight<W: Work>(work: W) -> W::Out {
            work.run()
        }
        #[target_feature(enable = "avx2,fma")]
        fn four<W: Work>(work: W) -> W::Out {
            work.run()
        }
        if has!("avx512f") && has!("avx512dq") && has!("avx512vl") && has!("avx512bw") && has!("fma") {
            // SAFETY: all of its features have just been found; AVX-512F has AVX2 in it.
            return unsafe { eight(work) };
        }
        if has!("avx2") && has!("fma") {
            // SAFETY: both have just been found.
            return unsafe { four(work) };
        }
    }
    work.run()
}
