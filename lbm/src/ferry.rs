//! Bringing the populations of a batch of packed nodes together for an odd step, and back: masked copies, block by block.

use crate::element::Precision;
use crate::isa::InstructionSet;
use crate::packed::Packed;
use crate::stencil::MAX_Q;
use crate::storage::Storage;
use std::mem::MaybeUninit;
use std::ops::Range;

/// Blocks of a batch.
pub const BLOCKS: usize = 8;
/// Bytes from a population of a [`Buffer`] to the next: a batch, and a cache line so that they do not fall on the same sets.
pub const STRIDE: usize = 576;

/// Part of a block whose populations stand side by side, beside the fullest one.
#[derive(Clone, Copy)]
pub struct Other {
    /// Place of lane 0, from the start of the memory.
    pub source: u32,
    /// Where lane 0 goes in a buffer, bytes.
    pub to: u16,
    /// Which lanes there are.
    pub mask: u16,
}

/// The populations of a batch.
#[repr(C, align(64))]
pub struct Buffer(MaybeUninit<[u8; MAX_Q * STRIDE]>);

impl Buffer {
    pub fn new() -> Self {
        Self(MaybeUninit::uninit())
    }

    /// Its first byte.
    pub fn start(&mut self) -> *mut u8 {
        self.0.as_mut_ptr().cast()
    }
}

/// What is copied for a batch.
pub struct Batch<'a> {
    pub sources: &'a [u32],
    pub masks: &'a [u8],
    pub others: &'a [Other],
    /// Those of the next batch.
    pub next: &'a [Other],
    /// Sources of the batch after that.
    pub early: &'a [u32],
}

impl Packed {
    /// Brings the populations of the `nodes` of a batch before an odd step together.
    ///
    /// # Safety
    /// Nobody writes them meanwhile. The storage is that of the nodes, and the instruction set is there.
    pub unsafe fn gather(
        &self,
        storage: &Storage,
        isa: InstructionSet,
        batch: usize,
        nodes: &Range<usize>,
        buffer: &mut Buffer,
    ) {
        let all = self.holds(batch, nodes);
        let clip = if all { [0; BLOCKS] } else { self.clip(batch, nodes) };
        let (parts, data, to) = (self.of(batch), storage.data(), buffer.start());
        // SAFETY: the caller's contract; places and masks are those of nodes, and buffers have this layout.
        unsafe {
            match (isa, self.precision) {
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F64) if all => wide64::gather::<false>(&parts, &clip, data, to),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F64) => wide64::gather::<true>(&parts, &clip, data, to),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F32) if all => wide32::gather::<false>(&parts, &clip, data, to),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F32) => wide32::gather::<true>(&parts, &clip, data, to),
                (_, Precision::F64) => parts.copy::<u64, 8, false>((!all).then_some(clip), data, to),
                (_, Precision::F32) => parts.copy::<u32, 16, false>((!all).then_some(clip), data, to),
                (_, Precision::F16) => parts.copy::<u16, 16, false>((!all).then_some(clip), data, to),
            }
        }
    }

    /// Brings them back.
    ///
    /// # Safety
    /// As for [`Packed::gather`], and nobody reads them.
    pub unsafe fn scatter(
        &self,
        storage: &Storage,
        isa: InstructionSet,
        batch: usize,
        nodes: &Range<usize>,
        buffer: &mut Buffer,
    ) {
        let all = self.holds(batch, nodes);
        let clip = if all { [0; BLOCKS] } else { self.clip(batch, nodes) };
        let (parts, data, from) = (self.of(batch), storage.data(), buffer.start());
        // SAFETY: as in `gather`.
        unsafe {
            match (isa, self.precision) {
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F64) if all => wide64::scatter::<false>(&parts, &clip, data, from),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F64) => wide64::scatter::<true>(&parts, &clip, data, from),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F32) if all => wide32::scatter::<false>(&parts, &clip, data, from),
                #[cfg(target_arch = "x86_64")]
                (InstructionSet::Avx512, Precision::F32) => wide32::scatter::<true>(&parts, &clip, data, from),
                (_, Precision::F64) => parts.copy::<u64, 8, true>((!all).then_some(clip), data, from),
                (_, Precision::F32) => parts.copy::<u32, 16, true>((!all).then_some(clip), data, from),
                (_, Precision::F16) => parts.copy::<u16, 16, true>((!all).then_some(clip), data, from),
            }
        }
    }
}

impl Batch<'_> {
    pub fn mask(&self, n: usize, lanes: usize) -> u16 {
        match lanes {
            8 => u16::from(self.masks[n]),
            _ => u16::from_le_bytes([self.masks[2 * n], self.masks[2 * n + 1]]),
        }
    }

    /// Copies to a buffer, or `BACK` from it.
    unsafe fn copy<S: Copy, const LANES: usize, const BACK: bool>(
        &self,
        clip: Option<[u16; BLOCKS]>,
        data: *mut u8,
        buffer: *mut u8,
    ) {
        let part = |source: u32, to: usize, block: usize, mask: u16| {
            let mut mask = clip.map_or(mask, |clip| mask & clip[block]);
            let (place, to) = (
                data.cast::<S>().wrapping_add(source as usize),
                buffer.wrapping_add(to).cast::<S>(),
            );
            let (from, to) = if BACK { (to, place) } else { (place, to) };
            // SAFETY: the lanes of the mask are valid on both sides, and only those are touched.
            unsafe {
                if mask.count_ones() as usize == LANES {
                    return std::ptr::copy_nonoverlapping(from, to, LANES);
                }
                while mask != 0 {
                    let lane = mask.trailing_zeros() as usize;
                    *to.wrapping_add(lane) = *from.wrapping_add(lane);
                    mask &= mask - 1;
                }
            }
        };
        for (n, source) in self.sources.iter().enumerate() {
            let to = (n / BLOCKS + 1) * STRIDE + n % BLOCKS * LANES * size_of::<S>();
            part(*source, to, n % BLOCKS, self.mask(n, LANES));
        }
        for other in self.others {
            let to = usize::from(other.to);
            part(other.source, to, to % STRIDE / (LANES * size_of::<S>()), other.mask);
        }
    }
}

/// Copying by masked vectors of 512 bits.
#[cfg(target_arch = "x86_64")]
macro_rules! wide {
    ($name:ident, $number:ty, $mask:ty, $lanes:literal, $load:ident, $load_all:ident, $store:ident, $store_all:ident) => {
        mod $name {
            use super::{BLOCKS, Batch, STRIDE};
            use crate::simd::{prefetch, prefetch_early};
            use std::arch::x86_64::*;

            const BYTES: usize = $lanes / 8;

            /// To a buffer. With `CLIP` only those lanes are touched.
            ///
            /// # Safety
            /// AVX-512F is there; lanes of the masks are valid at their sources, and the buffer is one.
            #[target_feature(enable = "avx512f")]
            pub unsafe fn gather<const CLIP: bool>(
                parts: &Batch,
                clip: &[u16; BLOCKS],
                data: *mut u8,
                buffer: *mut u8,
            ) {
                let data = data.cast::<$number>();
                let sources = parts.sources.as_chunks::<BLOCKS>().0;
                let masks = parts.masks.as_chunks::<{ BLOCKS * BYTES }>().0;
                for (n, (sources, masks)) in sources.iter().zip(masks).enumerate() {
                    let to = buffer.wrapping_add((n + 1) * STRIDE).cast::<$number>();
                    let masks = masks.as_chunks::<BYTES>().0;
                    for block in 0..BLOCKS {
                        let mut mask = <$mask>::from_le_bytes(masks[block]);
                        if CLIP {
                            mask &= clip[block] as $mask;
                        }
                        let from = data.wrapping_add(sources[block] as usize);
                        // SAFETY: the contract of this function; other lanes are masked out.
                        unsafe { $store_all(to.wrapping_add(block * $lanes), $load(mask, from)) };
                    }
                }
                for other in parts.others {
                    let at = usize::from(other.to);
                    let mut mask = other.mask as $mask;
                    if CLIP {
                        mask &= clip[at % STRIDE / ($lanes * size_of::<$number>())] as $mask;
                    }
                    let (from, to) = (
                        data.wrapping_add(other.source as usize),
                        buffer.wrapping_add(at).cast(),
                    );
                    // SAFETY: as above.
                    unsafe { $store(to, mask, $load(mask, from)) };
                }
                if !CLIP {
                    for other in parts.next {
                        prefetch(data.wrapping_add(other.source as usize));
                    }
                }
            }

            /// From a buffer. With `CLIP` only those lanes are touched.
            ///
            /// # Safety
            /// As for [`gather`].
            #[target_feature(enable = "avx512f")]
            pub unsafe fn scatter<const CLIP: bool>(
                parts: &Batch,
                clip: &[u16; BLOCKS],
                data: *mut u8,
                buffer: *mut u8,
            ) {
                let data = data.cast::<$number>();
                let sources = parts.sources.as_chunks::<BLOCKS>().0;
                let masks = parts.masks.as_chunks::<{ BLOCKS * BYTES }>().0;
                let early = parts.early.as_chunks::<BLOCKS>().0;
                for (n, ((sources, masks), early)) in sources.iter().zip(masks).zip(early).enumerate() {
                    let from = buffer.wrapping_add((n + 1) * STRIDE).cast::<$number>();
                    let masks = masks.as_chunks::<BYTES>().0;
                    for block in 0..BLOCKS {
                        let mut mask = <$mask>::from_le_bytes(masks[block]);
                        if CLIP {
                            mask &= clip[block] as $mask;
                        }
                        let to = data.wrapping_add(sources[block] as usize);
                        // SAFETY: as in `gather`.
                        unsafe { $store(to, mask, $load_all(from.wrapping_add(block * $lanes))) };
                    }
                    if !CLIP {
                        for source in early {
                            prefetch_early(data.wrapping_add(*source as usize));
                        }
                    }
                }
                for other in parts.others {
                    let at = usize::from(other.to);
                    let mut mask = other.mask as $mask;
                    if CLIP {
                        mask &= clip[at % STRIDE / ($lanes * size_of::<$number>())] as $mask;
                    }
                    let to = data.wrapping_add(other.source as usize);
                    // SAFETY: as in `gather`.
                    unsafe { $store(to, mask, $load_all(buffer.wrapping_add(at).cast())) };
                }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
wide!(
    wide64,
    f64,
    u8,
    8,
    _mm512_maskz_loadu_pd,
    _mm512_loadu_pd,
    _mm512_mask_storeu_pd,
    _mm512_storeu_pd
);
#[cfg(target_arch = "x86_64")]
wide!(
    wide32,
    f32,
    u16,
    16,
    _mm512_maskz_loadu_ps,
    _mm512_loadu_ps,
    _mm512_mask_storeu_ps,
    _mm512_storeu_ps
);
