//! Eight lanes by AVX-512F.

use super::Simd;
use std::arch::x86_64::*;

/// Eight numbers.
#[derive(Clone, Copy)]
pub struct Avx512(__m512d);

// The caller has AVX-512F by the contract of [`Simd`], and pointers are valid for the lanes that are touched; every
// SAFETY comment below says no more than that.
impl Simd for Avx512 {
    const LANES: usize = 8;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: AVX-512F is there, eight numbers are valid.
        Self(unsafe { _mm512_loadu_pd(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: AVX-512F is there, eight numbers are valid.
        unsafe { _mm512_storeu_pd(to, self.0) }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const f64, n: usize) -> Self {
        // SAFETY: AVX-512F is there, `n` numbers are valid and the others are masked out.
        Self(unsafe { _mm512_maskz_loadu_pd((1u8 << n) - 1, from) })
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut f64, n: usize) {
        // SAFETY: AVX-512F is there, `n` numbers are valid and the others are masked out.
        unsafe { _mm512_mask_storeu_pd(to, (1u8 << n) - 1, self.0) }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_add_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_sub_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_mul_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    unsafe fn neg_mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_fnmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    unsafe fn sum(self) -> f64 {
        // SAFETY: AVX-512F is there.
        unsafe { _mm512_reduce_add_pd(self.0) }
    }
}
