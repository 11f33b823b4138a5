//! Vectors of 256 bits by AVX2, FMA and F16C.

use super::{Simd, Stored, arithmetic};
use crate::element::Half;
use std::arch::x86_64::*;

/// Four numbers of 64 bits.
#[derive(Clone, Copy)]
pub struct F64x4(__m256d);

/// Eight numbers of 32 bits.
#[derive(Clone, Copy)]
pub struct F32x8(__m256);

arithmetic!(
    F64x4,
    _mm256_set1_pd,
    f64,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd,
    _mm256_fmadd_pd,
    _mm256_fnmadd_pd
);
arithmetic!(
    F32x8,
    _mm256_set1_ps,
    f32,
    _mm256_add_ps,
    _mm256_sub_ps,
    _mm256_mul_ps,
    _mm256_div_ps,
    _mm256_fmadd_ps,
    _mm256_fnmadd_ps
);

/// The first `n` of four lanes.
#[inline(always)]
unsafe fn mask4(n: usize) -> __m256i {
    const WINDOW: [i64; 8] = [-1, -1, -1, -1, 0, 0, 0, 0];
    // SAFETY: AVX2 is there; `n` is at most 4, so that the four numbers lie in the window.
    unsafe { _mm256_loadu_si256(WINDOW.as_ptr().add(4 - n).cast()) }
}

/// The first `n` of eight lanes.
#[inline(always)]
unsafe fn mask8(n: usize) -> __m256i {
    const WINDOW: [i32; 16] = [-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0];
    // SAFETY: AVX2 is there; `n` is at most 8, so that the eight numbers lie in the window.
    unsafe { _mm256_loadu_si256(WINDOW.as_ptr().add(8 - n).cast()) }
}

/// The four lanes of a mask.
#[inline(always)]
unsafe fn lanes4(mask: u16) -> __m256i {
    // SAFETY: AVX2 is there.
    unsafe {
        let bits = _mm256_setr_epi64x(1, 2, 4, 8);
        _mm256_cmpeq_epi64(_mm256_and_si256(_mm256_set1_epi64x(mask.into()), bits), bits)
    }
}

/// The eight lanes of a mask.
#[inline(always)]
unsafe fn lanes8(mask: u16) -> __m256i {
    // SAFETY: AVX2 is there.
    unsafe {
        let bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(mask.into()), bits), bits)
    }
}

// The caller has AVX2, FMA and F16C by the contracts of [`Simd`] and [`Stored`], and pointers are valid for the lanes that
// are touched; every SAFETY comment below says no more than that.
impl Simd for F64x4 {
    const LANES: usize = 4;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        // SAFETY: AVX2 is there.
        Self(unsafe { _mm256_set1_pd(value) })
    }
    #[inline(always)]
    unsafe fn load_wide(from: *const f64) -> Self {
        // SAFETY: AVX2 is there, four numbers are valid.
        Self(unsafe { _mm256_loadu_pd(from) })
    }
    #[inline(always)]
    unsafe fn store_wide(self, to: *mut f64) {
        // SAFETY: AVX2 is there, four numbers are valid.
        unsafe { _mm256_storeu_pd(to, self.0) }
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut lanes = [0.0; 4];
        // SAFETY: AVX2 is there, the array has four numbers.
        unsafe { _mm256_storeu_pd(lanes.as_mut_ptr(), self.0) };
        (lanes[0] + lanes[2]) + (lanes[1] + lanes[3])
    }
}

impl Stored<f64> for F64x4 {
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
        Self(unsafe { _mm256_maskload_pd(from, mask4(n)) })
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut f64, n: usize) {
        // SAFETY: AVX2 is there, `n` numbers are valid and the others are masked out.
        unsafe { _mm256_maskstore_pd(to, mask4(n), self.0) }
    }
    #[inline(always)]
    unsafe fn load_lanes(self, from: *const f64, mask: u16) -> Self {
        // SAFETY: AVX2 is there, the numbers of the mask are valid.
        unsafe {
            let lanes = lanes4(mask);
            let loaded = _mm256_maskload_pd(from, lanes);
            Self(_mm256_blendv_pd(self.0, loaded, _mm256_castsi256_pd(lanes)))
        }
    }
    #[inline(always)]
    unsafe fn store_lanes(self, to: *mut f64, mask: u16) {
        // SAFETY: AVX2 is there, the numbers of the mask are valid.
        unsafe { _mm256_maskstore_pd(to, lanes4(mask), self.0) }
    }
}

impl Simd for F32x8 {
    const LANES: usize = 8;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        // SAFETY: AVX2 is there.
        Self(unsafe { _mm256_set1_ps(value as f32) })
    }
    #[inline(always)]
    unsafe fn load_wide(from: *const f64) -> Self {
        // SAFETY: AVX2 is there, eight numbers are valid.
        unsafe {
            let low = _mm256_cvtpd_ps(_mm256_loadu_pd(from));
            let high = _mm256_cvtpd_ps(_mm256_loadu_pd(from.add(4)));
            Self(_mm256_set_m128(high, low))
        }
    }
    #[inline(always)]
    unsafe fn store_wide(self, to: *mut f64) {
        // SAFETY: AVX2 is there, eight numbers are valid.
        unsafe {
            _mm256_storeu_pd(to, _mm256_cvtps_pd(_mm256_castps256_ps128(self.0)));
            _mm256_storeu_pd(to.add(4), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(self.0)));
        }
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        let mut lanes = [0.0; 8];
        // SAFETY: AVX2 is there, the array has eight numbers.
        unsafe { self.store_wide(lanes.as_mut_ptr()) };
        lanes.iter().sum()
    }
}

impl Stored<f32> for F32x8 {
    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: AVX2 is there, eight numbers are valid.
        Self(unsafe { _mm256_loadu_ps(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: AVX2 is there, eight numbers are valid.
        unsafe { _mm256_storeu_ps(to, self.0) }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const f32, n: usize) -> Self {
        // SAFETY: AVX2 is there, `n` numbers are valid and the others are masked out.
        Self(unsafe { _mm256_maskload_ps(from, mask8(n)) })
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut f32, n: usize) {
        // SAFETY: AVX2 is there, `n` numbers are valid and the others are masked out.
        unsafe { _mm256_maskstore_ps(to, mask8(n), self.0) }
    }
    #[inline(always)]
    unsafe fn load_lanes(self, from: *const f32, mask: u16) -> Self {
        // SAFETY: AVX2 is there, the numbers of the mask are valid.
        unsafe {
            let lanes = lanes8(mask);
            let loaded = _mm256_maskload_ps(from, lanes);
            Self(_mm256_blendv_ps(self.0, loaded, _mm256_castsi256_ps(lanes)))
        }
    }
    #[inline(always)]
    unsafe fn store_lanes(self, to: *mut f32, mask: u16) {
        // SAFETY: AVX2 is there, the numbers of the mask are valid.
        unsafe { _mm256_maskstore_ps(to, lanes8(mask), self.0) }
    }
}

impl Stored<Half> for F32x8 {
    #[inline(always)]
    unsafe fn load(from: *const Half) -> Self {
        // SAFETY: AVX2 and F16C are there, eight halves are valid.
        unsafe {
            let halves = _mm256_cvtph_ps(_mm_loadu_si128(from.cast()));
            Self(_mm256_mul_ps(halves, _mm256_set1_ps(1.0 / Half::SCALE)))
        }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut Half) {
        // SAFETY: AVX2 and F16C are there, eight halves are valid.
        unsafe {
            let scaled = _mm256_mul_ps(self.0, _mm256_set1_ps(Half::SCALE));
            _mm_storeu_si128(to.cast(), _mm256_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(scaled));
        }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const Half, n: usize) -> Self {
        let mut all = [Half(0); 8];
        // SAFETY: AVX2 and F16C are there, `n` halves are valid.
        unsafe {
            std::ptr::copy_nonoverlapping(from, all.as_mut_ptr(), n);
            Self::load(all.as_ptr())
        }
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut Half, n: usize) {
        let mut all = [Half(0); 8];
        // SAFETY: AVX2 and F16C are there, `n` halves are valid.
        unsafe {
            self.store(all.as_mut_ptr());
            std::ptr::copy_nonoverlapping(all.as_ptr(), to, n);
        }
    }
}
