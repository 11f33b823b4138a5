//! Vectors of 512 bits by AVX-512F.

use super::{Simd, Stored, arithmetic};
use crate::element::Half;
use std::arch::x86_64::*;

/// Eight numbers of 64 bits.
#[derive(Clone, Copy)]
pub struct F64x8(__m512d);

/// Sixteen numbers of 32 bits.
#[derive(Clone, Copy)]
pub struct F32x16(__m512);

arithmetic!(
    F64x8,
    _mm512_set1_pd,
    f64,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd,
    _mm512_fmadd_pd,
    _mm512_fnmadd_pd
);
arithmetic!(
    F32x16,
    _mm512_set1_ps,
    f32,
    _mm512_add_ps,
    _mm512_sub_ps,
    _mm512_mul_ps,
    _mm512_div_ps,
    _mm512_fmadd_ps,
    _mm512_fnmadd_ps
);

// The caller has AVX-512F by the contracts of [`Simd`] and [`Stored`], and pointers are valid for the lanes that are
// touched; every SAFETY comment below says no more than that.
impl Simd for F64x8 {
    const LANES: usize = 8;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    unsafe fn load_wide(from: *const f64) -> Self {
        // SAFETY: AVX-512F is there, eight numbers are valid.
        Self(unsafe { _mm512_loadu_pd(from) })
    }
    #[inline(always)]
    unsafe fn store_wide(self, to: *mut f64) {
        // SAFETY: AVX-512F is there, eight numbers are valid.
        unsafe { _mm512_storeu_pd(to, self.0) }
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        // SAFETY: AVX-512F is there.
        unsafe { _mm512_reduce_add_pd(self.0) }
    }
}

impl Stored<f64> for F64x8 {
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
    unsafe fn load_lanes(self, from: *const f64, mask: u16) -> Self {
        // SAFETY: AVX-512F is there, the numbers of the mask are valid.
        Self(unsafe { _mm512_mask_loadu_pd(self.0, mask as u8, from) })
    }
    #[inline(always)]
    unsafe fn store_lanes(self, to: *mut f64, mask: u16) {
        // SAFETY: AVX-512F is there, the numbers of the mask are valid.
        unsafe { _mm512_mask_storeu_pd(to, mask as u8, self.0) }
    }
}

impl Simd for F32x16 {
    const LANES: usize = 16;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        // SAFETY: AVX-512F is there.
        Self(unsafe { _mm512_set1_ps(value as f32) })
    }
    #[inline(always)]
    unsafe fn load_wide(from: *const f64) -> Self {
        // SAFETY: AVX-512F is there, sixteen numbers are valid.
        unsafe {
            let low = _mm256_castps_pd(_mm512_cvtpd_ps(_mm512_loadu_pd(from)));
            let high = _mm256_castps_pd(_mm512_cvtpd_ps(_mm512_loadu_pd(from.add(8))));
            Self(_mm512_castpd_ps(_mm512_insertf64x4::<1>(
                _mm512_castpd256_pd512(low),
                high,
            )))
        }
    }
    #[inline(always)]
    unsafe fn store_wide(self, to: *mut f64) {
        // SAFETY: AVX-512F is there, sixteen numbers are valid.
        unsafe {
            let high = _mm256_castpd_ps(_mm512_extractf64x4_pd::<1>(_mm512_castps_pd(self.0)));
            _mm512_storeu_pd(to, _mm512_cvtps_pd(_mm512_castps512_ps256(self.0)));
            _mm512_storeu_pd(to.add(8), _mm512_cvtps_pd(high));
        }
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut lanes = [0.0; 16];
        // SAFETY: AVX-512F is there, the array has sixteen numbers.
        unsafe { self.store_wide(lanes.as_mut_ptr()) };
        lanes.iter().sum()
    }
}

impl Stored<f32> for F32x16 {
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: AVX-512F is there, sixteen numbers are valid.
        Self(unsafe { _mm512_loadu_ps(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: AVX-512F is there, sixteen numbers are valid.
        unsafe { _mm512_storeu_ps(to, self.0) }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const f32, n: usize) -> Self {
        // SAFETY: AVX-512F is there, `n` numbers are valid and the others are masked out.
        Self(unsafe { _mm512_maskz_loadu_ps((1u16 << n) - 1, from) })
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut f32, n: usize) {
        // SAFETY: AVX-512F is there, `n` numbers are valid and the others are masked out.
        unsafe { _mm512_mask_storeu_ps(to, (1u16 << n) - 1, self.0) }
    }
    #[inline(always)]
    unsafe fn load_lanes(self, from: *const f32, mask: u16) -> Self {
        // SAFETY: AVX-512F is there, the numbers of the mask are valid.
        Self(unsafe { _mm512_mask_loadu_ps(self.0, mask, from) })
    }
    #[inline(always)]
    unsafe fn store_lanes(self, to: *mut f32, mask: u16) {
        // SAFETY: AVX-512F is there, the numbers of the mask are valid.
        unsafe { _mm512_mask_storeu_ps(to, mask, self.0) }
    }
}

impl Stored<Half> for F32x16 {
    #[inline(always)]
    unsafe fn load(from: *const Half) -> Self {
        // SAFETY: AVX-512F is there, sixteen halves are valid.
        unsafe {
            let halves = _mm512_cvtph_ps(_mm256_loadu_si256(from.cast()));
            Self(_mm512_mul_ps(halves, _mm512_set1_ps(1.0 / Half::SCALE)))
        }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut Half) {
        // SAFETY: AVX-512F is there, sixteen halves are valid.
        unsafe {
            let scaled = _mm512_mul_ps(self.0, _mm512_set1_ps(Half::SCALE));
            _mm256_storeu_si256(to.cast(), _mm512_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(scaled));
        }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const Half, n: usize) -> Self {
        let mut all = [Half(0); 16];
        // SAFETY: AVX-512F is there, `n` halves are valid.
        unsafe {
            std::ptr::copy_nonoverlapping(from, all.as_mut_ptr(), n);
            Self::load(all.as_ptr())
        }
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut Half, n: usize) {
        let mut all = [Half(0); 16];
        // SAFETY: AVX-512F is there, `n` halves are valid.
        unsafe {
            self.store(all.as_mut_ptr());
            std::ptr::copy_nonoverlapping(all.as_ptr(), to, n);
        }
    }
}
