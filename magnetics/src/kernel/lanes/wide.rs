//! Eight numbers in one AVX-512 register.

use super::{Isa, LANES, Lanes};
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Proof that this processor has AVX-512F: only [`Avx512::detect`] makes one.
#[derive(Clone, Copy)]
pub(crate) struct Avx512(());

/// Eight numbers; made only from the token [`Avx512`].
#[derive(Clone, Copy)]
pub(crate) struct Wide(__m512d);

impl Avx512 {
    /// The token, if this processor has the instructions.
    pub fn detect() -> Option<Self> {
        std::arch::is_x86_feature_detected!("avx512f").then_some(Self(()))
    }
}

impl Isa for Avx512 {
    type V = Wide;
    #[inline(always)]
    fn splat(self, value: f64) -> Wide {
        // SAFETY: the token says that AVX-512F is there.
        Wide(unsafe { _mm512_set1_pd(value) })
    }
    #[inline(always)]
    fn load(self, from: &[f64; LANES]) -> Wide {
        // SAFETY: as above; the array has eight numbers, and the load asks for no alignment.
        Wide(unsafe { _mm512_loadu_pd(from.as_ptr()) })
    }
}

impl Lanes for Wide {
    type Mask = __mmask8;
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        // SAFETY: a `Wide` exists only where AVX-512F is there; so for every method of this type.
        Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        // Fourteen bits, and the series of (1 - e)^(-1/2) to the third power of what they miss.
        // SAFETY: as for `mul_add`.
        unsafe {
            let y = _mm512_rsqrt14_pd(self.0);
            let e = _mm512_fnmadd_pd(_mm512_mul_pd(self.0, y), y, _mm512_set1_pd(1.0));
            let series = _mm512_fmadd_pd(_mm512_set1_pd(0.3125), e, _mm512_set1_pd(0.375));
            let series = _mm512_fmadd_pd(series, e, _mm512_set1_pd(0.5));
            Self(_mm512_fmadd_pd(_mm512_mul_pd(e, y), series, y))
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_abs_pd(self.0) })
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_max_pd(self.0, b.0) })
    }
    #[inline(always)]
    fn less(self, b: Self) -> __mmask8 {
        // SAFETY: as for `mul_add`.
        unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, b.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask8, a: Self, b: Self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_mask_blend_pd(mask, b.0, a.0) })
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        // SAFETY: as for `mul_add`.
        unsafe {
            let mantissa = _mm512_getmant_pd::<_MM_MANT_NORM_1_2, _MM_MANT_SIGN_SRC>(self.0);
            (Self(_mm512_getexp_pd(self.0)), Self(mantissa))
        }
    }
    #[inline(always)]
    fn array(self) -> [f64; LANES] {
        let mut out = [0.0; LANES];
        // SAFETY: as for `mul_add`; the array has eight numbers, and the store asks for no alignment.
        unsafe { _mm512_storeu_pd(out.as_mut_ptr(), self.0) };
        out
    }
}

impl Add for Wide {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_add_pd(self.0, b.0) })
    }
}

impl Sub for Wide {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_sub_pd(self.0, b.0) })
    }
}

impl Mul for Wide {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_mul_pd(self.0, b.0) })
    }
}

impl Div for Wide {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_div_pd(self.0, b.0) })
    }
}

impl Neg for Wide {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // SAFETY: as for `mul_add`.
        Self(unsafe { _mm512_sub_pd(_mm512_set1_pd(-0.0), self.0) })
    }
}
