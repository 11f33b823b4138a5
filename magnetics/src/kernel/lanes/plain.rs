//! Eight numbers in plain Rust, which compilers turn into whatever the target has.

use super::{Isa, LANES, Lanes};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// The token of plain Rust: always there.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

/// Eight numbers.
#[derive(Clone, Copy)]
pub(crate) struct Eight([f64; LANES]);

impl Eight {
    #[inline(always)]
    fn with(self, b: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self.0;
        for l in 0..LANES {
            out[l] = f(out[l], b.0[l]);
        }
        Self(out)
    }

    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        Self(self.0.map(f))
    }
}

impl Isa for Plain {
    type V = Eight;
    #[inline(always)]
    fn splat(self, value: f64) -> Eight {
        Eight([value; LANES])
    }
    #[inline(always)]
    fn load(self, from: &[f64; LANES]) -> Eight {
        Eight(*from)
    }
}

impl Lanes for Eight {
    type Mask = [bool; LANES];
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(f64::sqrt)
    }
    #[inline(always)]
    fn inverse_sqrt(self) -> Self {
        self.each(|v| 1.0 / v.sqrt())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.each(f64::abs)
    }
    #[inline(always)]
    fn max(self, b: Self) -> Self {
        self.with(b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn less(self, b: Self) -> [bool; LANES] {
        std::array::from_fn(|l| self.0[l] < b.0[l])
    }
    #[inline(always)]
    fn select(mask: [bool; LANES], a: Self, b: Self) -> Self {
        Self(std::array::from_fn(|l| if mask[l] { a.0[l] } else { b.0[l] }))
    }
    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let exponent = self.each(|v| ((v.to_bits() >> 52) & 0x7ff) as f64 - 1023.0);
        let mantissa = self.each(|v| f64::from_bits(v.to_bits() & ((1 << 52) - 1) | (1023 << 52)));
        (exponent, mantissa)
    }
    #[inline(always)]
    fn array(self) -> [f64; LANES] {
        self.0
    }
}

impl Add for Eight {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.with(b, |a, b| a + b)
    }
}

impl Sub for Eight {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.with(b, |a, b| a - b)
    }
}

impl Mul for Eight {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.with(b, |a, b| a * b)
    }
}

impl Div for Eight {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        self.with(b, |a, b| a / b)
    }
}

impl Neg for Eight {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|a| -a)
    }
}
