//! Numbers, and vectors of numbers, behind one trait.

use std::ops::{Add, Div, Mul, Neg, Sub};

pub(crate) mod sealed {
    /// Keeps [`super::Real`] to this crate.
    pub trait Sealed {}
}

/// A number, or a vector of numbers that are worked on at once: `f64`, `f32`, and the vectors of the kernels.
///
/// The vectors come from the kernels alone. So whoever holds one is on a processor with its instruction set, and its
/// arithmetic is safe.
pub trait Real:
    sealed::Sealed
    + Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// `value` in all lanes.
    fn like(self, value: f64) -> Self;
    /// `self * a + b`, rounded once where the instruction set can.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// `b - self * a`, rounded once where the instruction set can.
    fn neg_mul_add(self, a: Self, b: Self) -> Self;
}

/// `a b + c`, fused only where the target has the instruction (a library call would be slow).
macro_rules! fused {
    ($a:expr, $b:expr, $c:expr) => {
        if cfg!(any(target_arch = "aarch64", target_feature = "fma")) {
            $a.mul_add($b, $c)
        } else {
            $a * $b + $c
        }
    };
}

macro_rules! scalar {
    ($t:ident) => {
        impl sealed::Sealed for $t {}
        impl Real for $t {
            #[inline(always)]
            fn like(self, value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                fused!($t::from(self), a, b)
            }
            #[inline(always)]
            fn neg_mul_add(self, a: Self, b: Self) -> Self {
                fused!($t::from(-self), a, b)
            }
        }
    };
}

scalar!(f64);
scalar!(f32);
