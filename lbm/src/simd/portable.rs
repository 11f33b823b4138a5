//! Two lanes in plain Rust, which compilers turn into whatever the target has.

use super::Simd;

/// Two numbers.
#[derive(Clone, Copy)]
pub struct Pair([f64; 2]);

/// `a b + c`, fused only where the target has the instruction (a library call would be slow).
#[inline(always)]
fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(any(target_arch = "aarch64", target_feature = "fma")) {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}

impl Simd for Pair {
    const LANES: usize = 2;
    #[inline(always)]
    unsafe fn splat(value: f64) -> Self {
        Self([value; 2])
    }
    #[inline(always)]
    unsafe fn load(from: *const f64) -> Self {
        // SAFETY: two numbers are valid.
        Self(unsafe { [*from, *from.add(1)] })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut f64) {
        // SAFETY: two numbers are valid.
        unsafe {
            *to = self.0[0];
            *to.add(1) = self.0[1];
        }
    }
    #[inline(always)]
    unsafe fn load_first(from: *const f64, n: usize) -> Self {
        // SAFETY: the first number is valid where `n` is 1.
        Self([if n > 0 { unsafe { *from } } else { 0.0 }, 0.0])
    }
    #[inline(always)]
    unsafe fn store_first(self, to: *mut f64, n: usize) {
        if n > 0 {
            // SAFETY: the first number is valid where `n` is 1.
            unsafe { *to = self.0[0] };
        }
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        Self([self.0[0] + b.0[0], self.0[1] + b.0[1]])
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        Self([self.0[0] - b.0[0], self.0[1] - b.0[1]])
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        Self([self.0[0] * b.0[0], self.0[1] * b.0[1]])
    }
    #[inline(always)]
    unsafe fn mul_add(self, b: Self, c: Self) -> Self {
        Self([fused(self.0[0], b.0[0], c.0[0]), fused(self.0[1], b.0[1], c.0[1])])
    }
    #[inline(always)]
    unsafe fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self([fused(-self.0[0], b.0[0], c.0[0]), fused(-self.0[1], b.0[1], c.0[1])])
    }
    #[inline(always)]
    unsafe fn sum(self) -> f64 {
        self.0[0] + self.0[1]
    }
}
