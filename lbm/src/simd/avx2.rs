//! Four lanes by AVX2 and FMA.

use super::Simd;
use std::arch::x86_64::*;

/// Four numbers.
#[derive(Clone, Copy)]
pub struct Avx2(__m256d);

/// The first `n` of four lanes.
#[inline(always)]
unsafe fn mask(n: usize) -> __m256i {
    const WINDOW: [i64; 8] = [-1, -1, -1, -1, 0, 0, 0, 0];
    // SAFETY: AVX2 is there; `n` is at most 4, so that the four numbers lie in the window.
    unsafe { _mm256_loadu_si256(WINDOW.as_ptr().add(4 - n).cast()) }
}

// The caller has AVX2 and FMA by the contract of [`Simd`], and pointers are valid for the lanes that are touched; every
// SAFETY comment below says no more than that.
impl Simd for Avx2 {
    const LANES: usize = 4;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        // SAFETY: AVX2 is there.
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: AVX2 is there, four numbers are valid.
        Self(unsafe { _mm256_loadu_pd(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: AVX2 is there, four numbers are valid.
        unsafe { _mm256_storeu_pd(to, self.0) }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const f64, n: usize) -> Self {
        // SAFETY: AVX2 is there, `n` numbers are valid and the others are masked out.
        Self(unsafe { _mm256_maskload_pd(from, mask(n)) })
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut f64, n: usize) {
        // SAFETY: AVX2 is there, `n` numbers are valid and the others are masked out.
        unsafe { _mm256_maskstore_pd(to, mask(n), self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        // SAFETY: AVX2 is there.
        Self(unsafe { _mm256_add_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        // SAFETY: AVX2 is there.
        Self(unsafe { _mm256_sub_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        // SAFETY: AVX2 is there.
        Self(unsafe { _mm256_mul_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: FMA is there.
        Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    unsafe fn neg_mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: FMA is there.
        Self(unsafe { _mm256_fnmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    unsafe fn sum(self) -> f64 {
        let mut lanes = [0.0; 4];
        // SAFETY: AVX2 is there, the array has four numbers.
        unsafe { _mm256_storeu_pd(lanes.as_mut_ptr(), self.0) };
        (lanes[0] + lanes[2]) + (lanes[1] + lanes[3])
    }
}
