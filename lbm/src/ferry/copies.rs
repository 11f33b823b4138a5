//! Populations that stand apart from the fullest part of their block, in small plain copies.

use super::{BLOCKS, Batch, Load, STRIDE, block_lanes};
use crate::simd::prefetch;

/// Numbers that are copied so many at a time.
#[derive(Clone, Copy)]
pub struct Copies<'a> {
    /// How many.
    pub width: usize,
    /// Place of the first of each, from the start of the memory, [`FOLD`] copies together.
    pub sources: &'a [[u32; FOLD]],
    /// Where it goes: its number in a buffer.
    pub slots: &'a [[u16; FOLD]],
}

/// How many numbers are copied at a time. A masked vector costs as much as a whole one, and across two cache lines more than the few
/// copies that most parts take.
pub const WIDTHS: [usize; 3] = [4, 2, 1];

/// Copies that are made in one turn of a loop. The last one of a list is repeated until there are as many.
pub const FOLD: usize = 2;

impl Batch<'_> {
    /// Copies all but the fullest parts.
    ///
    /// # Safety
    /// As for [`Batch::ferry`]; numbers have so many bytes.
    #[inline(always)]
    pub unsafe fn copy_others<T: Copy, const BACK: bool>(&self, load: Load, data: *mut T, buffer: *mut T) {
        let [fours, twos, ones] = &self.others;
        // SAFETY: the caller's.
        unsafe {
            if let Load::Some(clip) = load {
                return self
                    .others
                    .iter()
                    .for_each(|copies| copies.copy_some::<T, BACK>(clip, data, buffer));
            }
            fours.copy::<[T; 4], T, BACK>(data, buffer);
            twos.copy::<[T; 2], T, BACK>(data, buffer);
            ones.copy::<T, T, BACK>(data, buffer);
        }
        if !BACK {
            for source in self.next.as_flattened() {
                prefetch(data.wrapping_add(*source as usize));
            }
        }
    }
}

impl Copies<'_> {
    /// Copies numbers `T` to a buffer, or `BACK`, as many at a time as `W` has.
    ///
    /// # Safety
    /// They are valid on both sides.
    #[inline(always)]
    unsafe fn copy<W: Copy, T, const BACK: bool>(&self, data: *mut T, buffer: *mut T) {
        for (sources, slots) in self.sources.iter().zip(self.slots) {
            for (source, slot) in sources.iter().zip(slots) {
                let (place, room) = (
                    data.wrapping_add(*source as usize).cast::<W>(),
                    buffer.wrapping_add(usize::from(*slot)).cast::<W>(),
                );
                // SAFETY: the caller's.
                unsafe {
                    if BACK {
                        place.write_unaligned(room.read_unaligned());
                    } else {
                        room.write_unaligned(place.read_unaligned());
                    }
                }
            }
        }
    }

    /// The place of the first number of each copy, and its number in a buffer.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize)> {
        let slots = self.slots.as_flattened().iter().map(|slot| usize::from(*slot));
        let sources = self.sources.as_flattened().iter().map(|source| *source as usize);
        sources.zip(slots)
    }

    /// Copies the numbers of some nodes.
    ///
    /// # Safety
    /// Their numbers are valid on both sides.
    unsafe fn copy_some<T: Copy, const BACK: bool>(&self, clip: &[u16; BLOCKS], data: *mut T, buffer: *mut T) {
        let lanes = block_lanes(size_of::<T>());
        for (source, slot) in self.iter() {
            for n in 0..self.width {
                let (_, node) = split(slot + n, size_of::<T>());
                if clip[node / lanes] >> (node % lanes) & 1 == 0 {
                    continue;
                }
                let (place, room) = (data.wrapping_add(source + n), buffer.wrapping_add(slot + n));
                // SAFETY: the caller's.
                unsafe {
                    if BACK {
                        *place = *room;
                    } else {
                        *room = *place;
                    }
                }
            }
        }
    }
}

/// The number in a buffer of population `i` of node `node` of a batch, numbers having so many bytes.
pub fn slot(i: usize, node: usize, bytes: usize) -> usize {
    i * (STRIDE / bytes) + node
}

/// The population and the node of a number in a buffer.
pub fn split(slot: usize, bytes: usize) -> (usize, usize) {
    (slot / (STRIDE / bytes), slot % (STRIDE / bytes))
}
