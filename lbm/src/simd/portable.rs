//! A few lanes in plain Rust, which compilers turn into whatever the target has.

use super::{Simd, Stored};
use crate::element::{Element, Half};
use crate::real::{Real, sealed::Sealed};
use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Some numbers.
#[derive(Clone, Copy)]
pub struct Lanes<T, const N: usize>([T; N]);

impl<T, const N: usize> Sealed for Lanes<T, N> {}

impl<T: Real, const N: usize> Add for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(from_fn(|l| self.0[l] + b.0[l]))
    }
}

impl<T: Real, const N: usize> Sub for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(from_fn(|l| self.0[l] - b.0[l]))
    }
}

impl<T: Real, const N: usize> Mul for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(from_fn(|l| self.0[l] * b.0[l]))
    }
}

impl<T: Real, const N: usize> Div for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(from_fn(|l| self.0[l] / b.0[l]))
    }
}

impl<T: Real, const N: usize> Neg for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(from_fn(|l| -self.0[l]))
    }
}

impl<T: Real, const N: usize> Real for Lanes<T, N> {
    #[inline(always)]
    fn like(self, value: f64) -> Self {
        Self(from_fn(|l| self.0[l].like(value)))
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(from_fn(|l| self.0[l].mul_add(a.0[l], b.0[l])))
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        Self(from_fn(|l| self.0[l].neg_mul_add(a.0[l], b.0[l])))
    }
}

// No instruction set is needed; every SAFETY comment below says no more than that pointers are valid for the lanes that
// are touched, by the contracts of [`Simd`] and [`Stored`].
impl<T: Real + Element, const N: usize> Simd for Lanes<T, N> {
    const LANES: usize = N;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        Self([T::near(value); N])
    }
    #[inline(always)]
    unsafe fn load_wide(from: *const f64) -> Self {
        // SAFETY: all lanes are valid.
        Self(from_fn(|l| T::near(unsafe { *from.add(l) })))
    }
    #[inline(always)]
    unsafe fn store_wide(self, to: *mut f64) {
        for l in 0..N {
            // SAFETY: all lanes are valid.
            unsafe { *to.add(l) = self.0[l].get() };
        }
    }
    #[inline(always)]
    fn sum(self) -> f64 {
        self.0.iter().map(|v| v.get()).sum()
    }
}

impl<T: Real + Element, const N: usize> Stored<T> for Lanes<T, N> {
    #[inline(always)]
    unsafe fn load(from: *const T) -> Self {
        // SAFETY: all lanes are valid.
        Self(unsafe { from.cast::<[T; N]>().read() })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T) {
        // SAFETY: all lanes are valid.
        unsafe { to.cast::<[T; N]>().write(self.0) };
    }
    #[inline(always)]
    unsafe fn load_first(from: *const T, n: usize) -> Self {
        // SAFETY: the first `n` lanes are valid.
        Self(from_fn(|l| if l < n { unsafe { *from.add(l) } } else { T::near(0.0) }))
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut T, n: usize) {
        for l in 0..n {
            // SAFETY: the first `n` lanes are valid.
            unsafe { *to.add(l) = self.0[l] };
        }
    }
}

impl<const N: usize> Stored<Half> for Lanes<f32, N> {
    #[inline(always)]
    unsafe fn load(from: *const Half) -> Self {
        // SAFETY: all lanes are valid.
        Self(from_fn(|l| unsafe { *from.add(l) }.to_f32()))
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut Half) {
        for l in 0..N {
            // SAFETY: all lanes are valid.
            unsafe { *to.add(l) = Half::from_f32(self.0[l]) };
        }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const Half, n: usize) -> Self {
        // SAFETY: the first `n` lanes are valid.
        Self(from_fn(|l| if l < n { unsafe { *from.add(l) }.to_f32() } else { 0.0 }))
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut Half, n: usize) {
        for l in 0..n {
            // SAFETY: the first `n` lanes are valid.
            unsafe { *to.add(l) = Half::from_f32(self.0[l]) };
        }
    }
}
