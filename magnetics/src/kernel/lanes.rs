//! Eight numbers at a time, behind one trait, so that each kernel is written once.
//!
//! A vector of wide registers can only be made from a token, and the token only where the processor has the instructions;
//! the arithmetic itself is therefore safe. Kernels are [`Work`], written with `#[inline(always)]` all the way down, so that
//! [`run`] compiles them once per instruction set. No closure may stand in a kernel's loop, nor `array::map`: what is not
//! inlined is compiled without the instructions.

mod functions;
mod plain;
#[cfg(target_arch = "x86_64")]
mod wide;

pub(crate) use functions::{angle, ln_ratio};
pub(crate) use plain::Plain;
#[cfg(target_arch = "x86_64")]
use wide::Avx512;

use lbm_ibm_coupling::Vec3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Numbers in a vector.
pub(crate) const LANES: usize = 8;

/// Eight numbers and their arithmetic.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A yes or no per lane.
    type Mask: Copy;
    /// `self * b + c`.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// 1/sqrt of positive normal numbers, to the last digits.
    fn inverse_sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The greater.
    fn max(self, b: Self) -> Self;
    /// Where `self < b`.
    fn less(self, b: Self) -> Self::Mask;
    /// `a` where the mask says so, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Exponent e and mantissa m in [1, 2) of positive normal numbers, 2^e m.
    fn split(self) -> (Self, Self);
    /// The numbers.
    fn array(self) -> [f64; LANES];
}

/// Proof that an instruction set is there, and what makes vectors of it.
pub(crate) trait Isa: Copy {
    /// Its vector.
    type V: Lanes;
    /// All lanes equal.
    fn splat(self, value: f64) -> Self::V;
    /// From an array.
    fn load(self, from: &[f64; LANES]) -> Self::V;
}

/// A kernel that runs on any instruction set.
pub(crate) trait Work {
    /// What it returns.
    type Out;
    /// Runs it; implementations are `#[inline(always)]`.
    fn run<I: Isa>(self, isa: I) -> Self::Out;
}

/// Runs `work` with the widest vectors of this processor.
pub(crate) fn run<W: Work>(work: W) -> W::Out {
    #[cfg(target_arch = "x86_64")]
    {
        #[target_feature(enable = "avx512f")]
        fn wide<W: Work>(isa: Avx512, work: W) -> W::Out {
            work.run(isa)
        }
        #[target_feature(enable = "avx2,fma")]
        fn half<W: Work>(work: W) -> W::Out {
            work.run(Plain)
        }
        if let Some(isa) = Avx512::detect() {
            // SAFETY: the token says that AVX-512F is there.
            return unsafe { wide(isa, work) };
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            // SAFETY: both have just been found.
            return unsafe { half(work) };
        }
    }
    work.run(Plain)
}

/// The eight numbers of `from` that begin at `at`; missing ones are `fill`.
#[inline(always)]
pub(crate) fn eight(from: &[f64], at: usize, fill: f64) -> [f64; LANES] {
    match from[at..].first_chunk::<LANES>() {
        Some(chunk) => *chunk,
        None => {
            let mut out = [fill; LANES];
            let rest = &from[at..];
            out[..rest.len()].copy_from_slice(rest);
            out
        }
    }
}

/// Eight vectors of a structure of arrays from `at` on; missing ones are zero.
#[inline(always)]
pub(crate) fn vectors<I: Isa>(isa: I, from: [&[f64]; 3], at: usize) -> [I::V; 3] {
    let [x, y, z] = from;
    [
        isa.load(&eight(x, at, 0.0)),
        isa.load(&eight(y, at, 0.0)),
        isa.load(&eight(z, at, 0.0)),
    ]
}

/// The same vector in all lanes.
#[inline(always)]
pub(crate) fn same<I: Isa>(isa: I, v: Vec3) -> [I::V; 3] {
    [isa.splat(v.x), isa.splat(v.y), isa.splat(v.z)]
}

/// a - b.
#[inline(always)]
pub(crate) fn minus<V: Lanes>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a.b.
#[inline(always)]
pub(crate) fn dot<V: Lanes>(a: [V; 3], b: [V; 3]) -> V {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// The sum of eight vectors.
#[inline(always)]
pub(crate) fn total<V: Lanes>(v: [V; 3]) -> Vec3 {
    Vec3::new(sum(v[0]), sum(v[1]), sum(v[2]))
}

/// The sum of eight numbers.
#[inline(always)]
pub(crate) fn sum<V: Lanes>(v: V) -> f64 {
    let [a, b, c, d, e, f, g, h] = v.array();
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
