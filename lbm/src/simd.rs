//! Vectors of numbers behind two traits, so that each kernel is written once.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod portable;

#[cfg(target_arch = "x86_64")]
pub use avx2::{F32x8, F64x4};
#[cfg(target_arch = "x86_64")]
pub use avx512::{F32x16, F64x8};
pub use portable::Lanes;

use crate::element::Element;
use crate::real::Real;

/// Most numbers in a vector.
pub const MAX_LANES: usize = 16;

/// A vector of [`Simd::LANES`] numbers.
///
/// # Safety
/// The functions that make a vector need a processor with the instruction set of the type; then its methods are safe, but
/// for pointers. Those need no alignment, and all lanes must be valid.
pub trait Simd: Real {
    /// Numbers in a vector.
    const LANES: usize;
    /// All lanes equal.
    unsafe fn splat(value: f64) -> Self;
    /// Reads all lanes from numbers of 64 bits.
    unsafe fn load_wide(from: *const f64) -> Self;
    /// Writes all lanes as numbers of 64 bits.
    unsafe fn store_wide(self, to: *mut f64);
    /// Sum of all lanes.
    fn sum(self) -> f64;
}

/// A vector that is stored as elements `S`.
///
/// # Safety
/// As for [`Simd`]; the `_first` forms touch only the first `n` elements, `n` below [`Simd::LANES`], and lanes that are not
/// loaded are zero; the `_lanes` forms touch only those of the mask.
pub trait Stored<S: Element>: Simd {
    /// Reads all lanes.
    unsafe fn load(from: *const S) -> Self;
    /// Writes all lanes.
    unsafe fn store(self, to: *mut S);
    /// Reads the first `n` lanes.
    unsafe fn load_first(from: *const S, n: usize) -> Self;
    /// Writes the first `n` lanes.
    unsafe fn store_first(self, to: *mut S, n: usize);

    /// Reads the lanes of a mask (bit 0 is lane 0) and leaves the others as they are; bits beyond the vector are ignored.
    #[inline(always)]
    unsafe fn load_lanes(self, from: *const S, mask: u16) -> Self {
        let mut all = [S::near(0.0); MAX_LANES];
        // SAFETY: there is room for a vector, and the lanes of the mask are valid.
        unsafe {
            self.store(all.as_mut_ptr());
            for (lane, number) in all.iter_mut().enumerate().take(Self::LANES) {
                if mask >> lane & 1 == 1 {
                    *number = *from.wrapping_add(lane);
                }
            }
            Self::load(all.as_ptr())
        }
    }

    /// Writes the lanes of a mask; bits beyond the vector are ignored.
    #[inline(always)]
    unsafe fn store_lanes(self, to: *mut S, mask: u16) {
        let mut all = [S::near(0.0); MAX_LANES];
        // SAFETY: there is room for a vector, and the lanes of the mask are valid.
        unsafe {
            self.store(all.as_mut_ptr());
            for (lane, number) in all.iter().enumerate().take(Self::LANES) {
                if mask >> lane & 1 == 1 {
                    *to.wrapping_add(lane) = *number;
                }
            }
        }
    }
}

/// Arithmetic of a vector by intrinsics of its width.
#[cfg(target_arch = "x86_64")]
macro_rules! arithmetic {
    ($t:ident, $splat:ident, $s:ty, $add:ident, $sub:ident, $mul:ident, $div:ident, $fma:ident, $fnma:ident) => {
        arithmetic!($t, Add, add, $add);
        arithmetic!($t, Sub, sub, $sub);
        arithmetic!($t, Mul, mul, $mul);
        arithmetic!($t, Div, div, $div);
        impl crate::real::sealed::Sealed for $t {}
        impl std::ops::Neg for $t {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // SAFETY: whoever holds a vector has its instruction set.
                Self(unsafe { $sub($splat(-0.0), self.0) })
            }
        }
        impl crate::real::Real for $t {
            #[inline(always)]
            fn like(self, value: f64) -> Self {
                // SAFETY: whoever holds a vector has its instruction set.
                Self(unsafe { $splat(value as $s) })
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                // SAFETY: whoever holds a vector has its instruction set.
                Self(unsafe { $fma(self.0, a.0, b.0) })
            }
            #[inline(always)]
            fn neg_mul_add(self, a: Self, b: Self) -> Self {
                // SAFETY: whoever holds a vector has its instruction set.
                Self(unsafe { $fnma(self.0, a.0, b.0) })
            }
        }
    };
    ($t:ident, $trait:ident, $name:ident, $f:ident) => {
        impl std::ops::$trait for $t {
            type Output = Self;
            #[inline(always)]
            fn $name(self, b: Self) -> Self {
                // SAFETY: whoever holds a vector has its instruction set.
                Self(unsafe { $f(self.0, b.0) })
            }
        }
    };
}
#[cfg(target_arch = "x86_64")]
use arithmetic;

/// Asks for the cache line at `address`, which need not be valid, for some time later: it comes to the second level.
#[inline(always)]
pub fn prefetch_early<S>(address: *const S) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: as for `prefetch`.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T1 }>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

/// Asks for the cache line at `address`, which need not be valid.
#[inline(always)]
pub fn prefetch<S>(address: *const S) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch has no effect but on caches and never faults; SSE is part of x86-64.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}
