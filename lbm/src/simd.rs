//! Vectors of `f64` behind one trait, so that each kernel is written once.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
#[cfg(target_arch = "x86_64")]
pub use avx512::Avx512;
pub use portable::Pair;

/// A vector of [`Simd::LANES`] numbers.
///
/// # Safety
/// Every method needs a processor with the instruction set of the type. Pointers need no alignment; `load` and `store`
/// touch [`Simd::LANES`] numbers from the pointer on, the `_first` forms only the first `n`, `n` below `LANES`, and
/// those must be valid. Lanes that are not loaded are zero.
pub trait Simd: Copy {
    /// Numbers in a vector.
    const LANES: usize;
    /// All lanes equal.
    unsafe fn splat(value: f64) -> Self;
    /// Reads all lanes.
    unsafe fn load(from: *const f64) -> Self;
    /// Writes all lanes.
    unsafe fn store(self, to: *mut f64);
    /// Reads the first `n` lanes.
    unsafe fn load_first(from: *const f64, n: usize) -> Self;
    /// Writes the first `n` lanes.
    unsafe fn store_first(self, to: *mut f64, n: usize);
    /// `self + b`.
    unsafe fn add(self, b: Self) -> Self;
    /// `self - b`.
    unsafe fn sub(self, b: Self) -> Self;
    /// `self * b`.
    unsafe fn mul(self, b: Self) -> Self;
    /// `self * b + c`, rounded once where the instruction set can.
    unsafe fn mul_add(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, rounded once where the instruction set can.
    unsafe fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// Sum of all lanes.
    unsafe fn sum(self) -> f64;
}

/// Asks for the cache line at `address`, which need not be valid.
#[inline(always)]
pub fn prefetch(address: *const f64) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch has no effect but on caches and never faults; SSE is part of x86-64.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
