//! Memory of the populations: an array for each, x fastest.

use crate::element::{Element, Half, Precision};
use crate::intervals::{Intervals, row, wrapped};
use crate::mask::Mask;
use crate::parallel;
use crate::simd::MAX_LANES;
use crate::stencil::{MAX_Q, Velocities};
use lbm_ibm_coupling::Grid;
use std::alloc::{Layout, alloc_zeroed, dealloc, handle_alloc_error};

/// Bytes of a cache line.
const LINE: usize = 64;
const HUGE_PAGE: usize = 2 << 20;
/// Distance of two neighbouring arrays beyond a multiple of 4 KiB, in cache lines: equal offsets would make the arrays
/// fight for the same cache sets.
const SKEW: usize = 27;
/// Cache lines in 4 KiB.
const PAGE: usize = 64;

/// One array per population, of the places that are used ([`crate::intervals`]).
///
/// The populations are stored less their weights, `f - w`, which keeps the fine digits of a slow flow.
pub struct Storage {
    memory: *mut u8,
    layout: Layout,
    /// Where in the memory the numbers start, and how many bytes there are.
    data: *mut u8,
    bytes: usize,
    precision: Precision,
    velocities: Velocities,
    arrays: [usize; MAX_Q],
    /// Of each population, or of all where nodes are packed.
    intervals: Vec<Intervals>,
    grid: Grid,
}

// SAFETY: the memory is owned; shared access only reads it, and writing goes through pointers whose users keep apart.
unsafe impl Send for Storage {}
// SAFETY: as above.
unsafe impl Sync for Storage {}

impl Storage {
    /// Whether memory for such a grid can be addressed, with room for ghosts, skew and rounding, and places have numbers of 32
    /// bits.
    pub fn fits(shape: [usize; 3], velocities: Velocities) -> bool {
        let nodes = shape.iter().try_fold(1_usize, |n, s| n.checked_mul(s.checked_add(64)?));
        let numbers = nodes.and_then(|n| n.checked_add(1 << 16)?.checked_mul(velocities.q() * size_of::<f64>()));
        let addressed = numbers.is_some_and(|bytes| bytes < isize::MAX as usize - 2 * HUGE_PAGE);
        addressed && nodes.is_some_and(|n| i32::try_from(n).is_ok())
    }

    /// Fluid at rest, in rows or packed.
    pub fn new(grid: &Grid, mask: &Mask, velocities: Velocities, precision: Precision, packed: bool) -> Self {
        let line = LINE / precision.bytes();
        let unit = line.min(MAX_LANES);
        let populations: Vec<usize> = (0..velocities.q()).collect();
        let intervals = if packed {
            vec![Intervals::packed(grid, mask)]
        } else {
            parallel::map(&populations, |i| Intervals::new(grid, mask, velocities, *i, unit))
        };
        let (mut arrays, mut end) = ([0; MAX_Q], 0);
        for &i in &populations {
            arrays[i] = end_of_page(end, line) + i * SKEW % PAGE * line;
            // A cache line before and after, for what lies just beyond the ends of rows.
            end = arrays[i] + intervals[i % intervals.len()].len + 2 * line;
            arrays[i] += line;
        }
        let bytes = end * precision.bytes();
        let align = if bytes >= HUGE_PAGE { HUGE_PAGE } else { LINE };
        let layout = Layout::from_size_align(bytes + align, 1).expect("the caller has asked whether it fits");
        // SAFETY: the layout is not empty. All bits zero is 0.0. Fresh zeros cost nothing until they are used, which needs the
        // layout without an alignment; so it is found here.
        let memory = unsafe { alloc_zeroed(layout) };
        if memory.is_null() {
            handle_alloc_error(layout);
        }
        let data = memory.wrapping_add(memory.align_offset(align));
        if align == HUGE_PAGE {
            ask_for_huge_pages(data, bytes);
        }
        Self {
            memory,
            layout,
            data,
            bytes,
            precision,
            velocities,
            arrays,
            intervals,
            grid: grid.clone(),
        }
    }

    /// Sets all populations to rest.
    pub fn clear(&mut self) {
        // SAFETY: the block has this size, and `self` is exclusive.
        unsafe { self.data.write_bytes(0, self.bytes) };
    }

    /// Start of the memory.
    pub fn data(&self) -> *mut u8 {
        self.data
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.bytes + self.intervals.iter().map(Intervals::bytes).sum::<usize>()
    }

    /// What the populations are stored as.
    pub fn precision(&self) -> Precision {
        self.precision
    }

    /// The stencil.
    pub fn velocities(&self) -> Velocities {
        self.velocities
    }

    /// The number at an index of [`Storage::index`].
    #[inline]
    pub fn get(&self, index: usize) -> f64 {
        assert!(index < self.bytes / self.precision.bytes());
        // SAFETY: inside the allocation, and `self` is shared: nobody writes.
        unsafe { self.read(index) }
    }

    /// The number at an index.
    ///
    /// # Safety
    /// The index is one of [`Storage::index`], and nobody writes there.
    #[inline(always)]
    pub unsafe fn read(&self, index: usize) -> f64 {
        // SAFETY: the caller's contract; numbers have this precision.
        unsafe {
            match self.precision {
                Precision::F64 => *self.data.cast::<f64>().add(index),
                Precision::F32 => self.data.cast::<f32>().add(index).read().get(),
                Precision::F16 => self.data.cast::<Half>().add(index).read().get(),
            }
        }
    }

    /// Writes to an index.
    ///
    /// # Safety
    /// The index is one of [`Storage::index`], and nobody else reads or writes there.
    #[inline(always)]
    pub unsafe fn write(&self, index: usize, value: f64) {
        // SAFETY: the caller's contract; numbers have this precision.
        unsafe {
            match self.precision {
                Precision::F64 => *self.data.cast::<f64>().add(index) = value,
                Precision::F32 => *self.data.cast::<f32>().add(index) = f32::near(value),
                Precision::F16 => *self.data.cast::<Half>().add(index) = Half::near(value),
            }
        }
    }

    /// Index of population `i` at node `x` of the row (`j`, `k`), each from -1 (ghost) to the number of nodes (ghost), where
    /// it is used.
    #[inline]
    pub fn index(&self, i: usize, x: isize, j: isize, k: isize) -> usize {
        self.arrays[i].wrapping_add_signed(self.place(i, x, j, k))
    }

    /// The same, from the start of the array of the population.
    #[inline]
    pub fn place(&self, i: usize, x: isize, j: isize, k: isize) -> isize {
        let intervals = self.intervals.get(i).unwrap_or(&self.intervals[0]);
        intervals.place(row(&self.grid, j, k), x)
    }

    /// Whether nodes are packed: then only those of the fluid have places, each its own.
    #[inline]
    pub fn is_packed(&self) -> bool {
        self.intervals.len() == 1
    }

    /// Whether the places of packed nodes have numbers of 32 bits.
    pub fn packs(nodes: usize, velocities: Velocities) -> bool {
        let numbers = nodes.checked_add(1 << 13).and_then(|n| n.checked_mul(velocities.q()));
        numbers.is_some_and(|n| u32::try_from(n).is_ok())
    }

    /// Where the array of each population starts.
    #[inline(always)]
    pub fn arrays(&self) -> &[usize; MAX_Q] {
        &self.arrays
    }

    /// The row that stands at (`j`, `k`); see [`wrapped`].
    #[inline]
    pub fn wrapped(&self, j: isize, k: isize) -> [isize; 2] {
        wrapped(&self.grid, j, k)
    }
}

/// The next multiple of 4 KiB.
fn end_of_page(numbers: usize, line: usize) -> usize {
    numbers.next_multiple_of(PAGE * line)
}

impl Drop for Storage {
    fn drop(&mut self) {
        // SAFETY: allocated in `new` with this layout.
        unsafe { dealloc(self.memory, self.layout) };
    }
}

#[cfg(target_os = "linux")]
fn ask_for_huge_pages(data: *mut u8, bytes: usize) {
    use std::ffi::{c_int, c_void};
    const MADV_HUGEPAGE: c_int = 14;
    unsafe extern "C" {
        fn madvise(address: *mut c_void, length: usize, advice: c_int) -> c_int;
    }
    // SAFETY: advice on memory that is owned; a refusal changes nothing and is no error.
    unsafe { madvise(data.cast(), bytes, MADV_HUGEPAGE) };
}

#[cfg(not(target_os = "linux"))]
fn ask_for_huge_pages(_data: *mut u8, _bytes: usize) {}
