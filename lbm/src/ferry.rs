//! Bringing the populations of a batch of packed nodes together for an odd step, and back: masked copies of the fullest part of each
//! block, and small plain ones of what is left.

use crate::element::Precision;
use crate::isa::InstructionSet;
use crate::simd::prefetch_early;
use crate::stencil::MAX_Q;
use crate::storage::Storage;
use std::cell::RefCell;

/// Blocks of a batch.
pub const BLOCKS: usize = 8;
/// Bytes from a population of a [`Buffer`] to the next: a batch, and a block so that they do not fall on the same sets.
pub const STRIDE: usize = (BLOCKS + 1) * 64;

/// Lanes of a block of numbers of so many bytes: those of a vector of 512 bits, of numbers that are computed in.
pub const fn block_lanes(bytes: usize) -> usize {
    if bytes == size_of::<f64>() { 8 } else { 16 }
}

/// The populations of a batch, at first zero.
#[repr(C, align(64))]
pub struct Buffer([u8; MAX_Q * STRIDE]);

impl Buffer {
    pub fn new() -> Self {
        Self([0; MAX_Q * STRIDE])
    }

    /// Lends a thread its own.
    pub fn lend<R>(work: impl FnOnce(&mut Self) -> R) -> R {
        thread_local! {
            static OWN: RefCell<Box<Buffer>> = RefCell::new(Box::new(Buffer::new()));
        }
        OWN.with_borrow_mut(|buffer| work(buffer))
    }

    /// Its first byte.
    pub fn start(&mut self) -> *mut u8 {
        self.0.as_mut_ptr()
    }
}

/// Which parts of a batch are carried.
#[derive(Clone, Copy, PartialEq)]
pub enum Load<'a> {
    /// All, of all nodes.
    All,
    /// All, of some nodes: which lanes of each block.
    Some(&'a [u16; BLOCKS]),
    /// All but the fullest of each population and block, of all nodes.
    Apart,
}

/// Parts of blocks whose populations stand side by side.
#[derive(Clone, Copy)]
pub struct Parts<'a> {
    /// Place of lane 0 of each, from the start of the memory.
    pub sources: &'a [u32],
    /// Which lanes there are, a bit each.
    pub masks: &'a [u8],
}

/// What is copied for a batch.
pub struct Batch<'a> {
    /// The fullest part of each population from 1 on and block.
    pub main: Parts<'a>,
    /// All the others, by [`WIDTHS`].
    pub others: [Copies<'a>; WIDTHS.len()],
    /// Sources of the others of the next batch.
    pub next: &'a [[u32; FOLD]],
    /// Sources of a later batch, and how many nodes on that is.
    pub early: &'a [u32],
    pub later: usize,
}

impl Batch<'_> {
    /// Brings the populations of a batch before an odd step together in a buffer, or `BACK` from there.
    ///
    /// # Safety
    /// Nobody writes them meanwhile, nor reads them on the way back. The storage is that of the nodes, and the instruction set is
    /// there.
    pub unsafe fn ferry<const BACK: bool>(
        &self,
        storage: &Storage,
        isa: InstructionSet,
        load: Load,
        buffer: &mut Buffer,
    ) {
        let (data, buffer) = (storage.data(), buffer.start());
        // SAFETY: the caller's contract; places and masks are those of nodes, and buffers have this layout.
        unsafe {
            if load != Load::Apart {
                match (isa, storage.precision()) {
                    #[cfg(target_arch = "x86_64")]
                    (InstructionSet::Avx512, Precision::F64) => wide::carry64::<BACK>(self, load, data, buffer),
                    #[cfg(target_arch = "x86_64")]
                    (InstructionSet::Avx512, Precision::F32) => wide::carry32::<BACK>(self, load, data, buffer),
                    (_, Precision::F64) => self.carry::<Plain64, BACK>(load, data, buffer),
                    (_, Precision::F32) => self.carry::<Plain32, BACK>(load, data, buffer),
                    (_, Precision::F16) => self.carry::<Plain16, BACK>(load, data, buffer),
                }
            }
            match storage.precision() {
                Precision::F64 => self.copy_others::<u64, BACK>(load, data.cast(), buffer.cast()),
                Precision::F32 => self.copy_others::<u32, BACK>(load, data.cast(), buffer.cast()),
                Precision::F16 => self.copy_others::<u16, BACK>(load, data.cast(), buffer.cast()),
            }
        }
    }
}

/// Moves lanes of a block.
trait Mover {
    type Number: Copy;
    /// As many bytes as there are bits to a block.
    type Mask: Copy;
    const LANES: usize;

    fn masks(bytes: &[u8]) -> &[Self::Mask];
    fn mask(mask: Self::Mask) -> u16;

    /// Copies lanes to a buffer; the others may be written there too.
    ///
    /// # Safety
    /// The instructions are there, the lanes are valid at `from`, and the block at `to`.
    unsafe fn bring(from: *const Self::Number, mask: u16, to: *mut Self::Number);

    /// Copies lanes from a buffer.
    ///
    /// # Safety
    /// The instructions are there, the block is valid at `from`, and the lanes at `to`.
    unsafe fn take(from: *const Self::Number, mask: u16, to: *mut Self::Number);
}

/// The masks of blocks of eight or sixteen lanes.
macro_rules! masks {
    (8) => {
        type Mask = u8;
        const LANES: usize = 8;

        #[inline(always)]
        fn masks(bytes: &[u8]) -> &[u8] {
            bytes
        }

        #[inline(always)]
        fn mask(mask: u8) -> u16 {
            mask.into()
        }
    };
    (16) => {
        type Mask = [u8; 2];
        const LANES: usize = 16;

        #[inline(always)]
        fn masks(bytes: &[u8]) -> &[[u8; 2]] {
            bytes.as_chunks().0
        }

        #[inline(always)]
        fn mask(mask: [u8; 2]) -> u16 {
            u16::from_le_bytes(mask)
        }
    };
}

/// Copies lane by lane.
///
/// # Safety
/// The lanes of the mask are valid on both sides.
#[inline(always)]
unsafe fn copy<M: Mover>(from: *const M::Number, mut mask: u16, to: *mut M::Number) {
    // SAFETY: the caller's, and only those are touched.
    unsafe {
        if mask.count_ones() as usize == M::LANES {
            return std::ptr::copy_nonoverlapping(from, to, M::LANES);
        }
        while mask != 0 {
            let lane = mask.trailing_zeros() as usize;
            *to.wrapping_add(lane) = *from.wrapping_add(lane);
            mask &= mask - 1;
        }
    }
}

macro_rules! plain {
    ($name:ident, $number:ty, $lanes:tt) => {
        /// Lane by lane.
        struct $name;

        impl Mover for $name {
            type Number = $number;
            masks!($lanes);

            #[inline(always)]
            unsafe fn bring(from: *const $number, mask: u16, to: *mut $number) {
                // SAFETY: the caller's.
                unsafe { copy::<Self>(from, mask, to) }
            }

            #[inline(always)]
            unsafe fn take(from: *const $number, mask: u16, to: *mut $number) {
                // SAFETY: the caller's.
                unsafe { copy::<Self>(from, mask, to) }
            }
        }
    };
}

plain!(Plain64, u64, 8);
plain!(Plain32, u32, 16);
plain!(Plain16, u16, 16);

impl Parts<'_> {
    /// Which lanes part `n` has, of blocks of so many.
    #[inline(always)]
    pub fn mask(&self, n: usize, lanes: usize) -> u16 {
        if lanes == 8 {
            u16::from(self.masks[n])
        } else {
            u16::from_le_bytes([self.masks[2 * n], self.masks[2 * n + 1]])
        }
    }

    /// The same, of a part that there is.
    ///
    /// # Safety
    /// There are more than `n` parts, of blocks of so many lanes.
    #[inline(always)]
    pub unsafe fn mask_unchecked(&self, n: usize, lanes: usize) -> u16 {
        // SAFETY: the caller's.
        unsafe {
            if lanes == 8 {
                u16::from(*self.masks.get_unchecked(n))
            } else {
                u16::from_le_bytes([*self.masks.get_unchecked(2 * n), *self.masks.get_unchecked(2 * n + 1)])
            }
        }
    }
}

impl Batch<'_> {
    /// Copies the fullest parts of all nodes or of some.
    ///
    /// # Safety
    /// As for [`Batch::ferry`], and the instructions of the mover are there.
    #[inline(always)]
    unsafe fn carry<M: Mover, const BACK: bool>(&self, load: Load, data: *mut u8, buffer: *mut u8) {
        // Most batches are whole.
        // SAFETY: the caller's.
        unsafe {
            match load {
                Load::Some(clip) => self.carry_main::<M, BACK, false>(clip, data, buffer),
                _ => self.carry_main::<M, BACK, true>(&[u16::MAX; BLOCKS], data, buffer),
            }
        }
    }

    #[inline(always)]
    unsafe fn carry_main<M: Mover, const BACK: bool, const WHOLE: bool>(
        &self,
        clip: &[u16; BLOCKS],
        data: *mut u8,
        buffer: *mut u8,
    ) {
        let data = data.cast::<M::Number>();
        let sources = self.main.sources.as_chunks::<BLOCKS>().0;
        let masks = M::masks(self.main.masks).as_chunks::<BLOCKS>().0;
        let early = self.early.as_chunks::<BLOCKS>().0;
        for (n, ((sources, masks), early)) in sources.iter().zip(masks).zip(early).enumerate() {
            for block in 0..BLOCKS {
                let mask = clipped::<WHOLE>(M::mask(masks[block]), clip[block]);
                let place = data.wrapping_add(sources[block] as usize);
                let room = buffer
                    .wrapping_add((n + 1) * STRIDE)
                    .cast::<M::Number>()
                    .wrapping_add(block * M::LANES);
                // SAFETY: the caller's.
                unsafe {
                    if BACK {
                        M::take(room, mask, place);
                    } else {
                        M::bring(place, mask, room);
                    }
                }
            }
            if BACK && WHOLE {
                for source in early {
                    prefetch_early(data.wrapping_add(*source as usize));
                }
            }
        }
    }
}

/// The lanes that are not clipped.
#[inline(always)]
fn clipped<const WHOLE: bool>(mask: u16, clip: u16) -> u16 {
    if WHOLE { mask } else { mask & clip }
}

mod copies;
#[cfg(target_arch = "x86_64")]
mod wide;

pub use copies::{Copies, FOLD, WIDTHS, slot, split};
