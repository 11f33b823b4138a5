//! Copying by masked vectors of 512 bits.

use super::{Batch, Load, Mover};
use std::arch::x86_64::*;

macro_rules! mover {
    (
        $name:ident, $number:ty, $mask:ty, $lanes:tt, $carry:ident,
        $load:ident, $load_all:ident, $store:ident, $store_all:ident
    ) => {
        struct $name;

        impl Mover for $name {
            type Number = $number;
            masks!($lanes);

            #[inline(always)]
            unsafe fn bring(from: *const $number, mask: u16, to: *mut $number) {
                // SAFETY: the caller's; other lanes are masked out, or in a buffer.
                unsafe { $store_all(to, $load(mask as $mask, from)) };
            }

            #[inline(always)]
            unsafe fn take(from: *const $number, mask: u16, to: *mut $number) {
                // SAFETY: the caller's; other lanes are masked out, or in a buffer.
                unsafe { $store(to, mask as $mask, $load_all(from)) };
            }
        }

        /// # Safety
        /// As for [`Batch::carry`].
        #[target_feature(enable = "avx512f")]
        pub unsafe fn $carry<const BACK: bool>(parts: &Batch, load: Load, data: *mut u8, buffer: *mut u8) {
            // SAFETY: the caller's.
            unsafe { parts.carry::<$name, BACK>(load, data, buffer) };
        }
    };
}

mover!(
    Wide64,
    f64,
    u8,
    8,
    carry64,
    _mm512_maskz_loadu_pd,
    _mm512_loadu_pd,
    _mm512_mask_storeu_pd,
    _mm512_storeu_pd
);
mover!(
    Wide32,
    f32,
    u16,
    16,
    carry32,
    _mm512_maskz_loadu_ps,
    _mm512_loadu_ps,
    _mm512_mask_storeu_ps,
    _mm512_storeu_ps
);
