//! Memory of the populations: an array for each with ghost nodes, x fastest.

use crate::element::{Element, Half, Precision};
use crate::stencil::{MAX_Q, Velocities};
use lbm_ibm_coupling::Grid;
use std::alloc::{Layout, alloc, dealloc, handle_alloc_error};

/// Bytes of a cache line.
const LINE: usize = 64;
const HUGE_PAGE: usize = 2 << 20;
/// Distance of two neighbouring arrays beyond a multiple of 4 KiB, in cache lines: equal offsets would make the arrays
/// fight for the same cache sets.
const SKEW: usize = 27;

/// One array per population, with a ghost node around the grid on every side; node (0, j, k) starts a cache line.
///
/// The populations are stored less their weights, `f - w`, which keeps the fine digits of a slow flow.
pub struct Storage {
    data: *mut u8,
    layout: Layout,
    precision: Precision,
    velocities: Velocities,
    arrays: [usize; MAX_Q],
    shape: [usize; 3],
    periodic: [bool; 3],
    stride: usize,
}

// SAFETY: the memory is owned; shared access only reads it, and writing goes through pointers whose users keep apart.
unsafe impl Send for Storage {}
// SAFETY: as above.
unsafe impl Sync for Storage {}

impl Storage {
    /// Whether memory for such a grid can be addressed, with room for ghosts, skew and rounding.
    pub fn fits(shape: [usize; 3], velocities: Velocities) -> bool {
        let nodes = shape.iter().try_fold(1_usize, |n, s| n.checked_mul(s.checked_add(64)?));
        let numbers = nodes.and_then(|n| n.checked_add(4096)?.checked_mul(velocities.q() * size_of::<f64>()));
        numbers.is_some_and(|bytes| bytes < isize::MAX as usize - 2 * HUGE_PAGE)
    }

    /// Fluid at rest.
    pub fn new(grid: &Grid, velocities: Velocities, precision: Precision) -> Self {
        let [nx, ny, nz] = grid.shape;
        let line = LINE / precision.bytes();
        let stride = (nx + 2).next_multiple_of(line);
        let array = line + stride * (ny + 2) * (nz + 2);
        let pitch = array.next_multiple_of(64 * line) + SKEW * line;
        let bytes = velocities.q() * pitch * precision.bytes();
        let align = if bytes >= HUGE_PAGE { HUGE_PAGE } else { 64 };
        let layout = Layout::from_size_align(bytes.next_multiple_of(align), align)
            .expect("the caller has asked whether it fits");
        // SAFETY: the layout is not empty.
        let data = unsafe { alloc(layout) };
        if data.is_null() {
            handle_alloc_error(layout);
        }
        if align == HUGE_PAGE {
            ask_for_huge_pages(data, layout.size());
        }
        // SAFETY: the block was allocated with this size; all bits zero is 0.0.
        unsafe { data.write_bytes(0, layout.size()) };
        Self {
            data,
            layout,
            precision,
            velocities,
            arrays: std::array::from_fn(|i| i * pitch + line),
            shape: grid.shape,
            periodic: grid.periodic,
            stride,
        }
    }

    /// Sets all populations to rest.
    pub fn clear(&mut self) {
        // SAFETY: the block has this size, and `self` is exclusive.
        unsafe { self.data.write_bytes(0, self.layout.size()) };
    }

    /// Start of the memory.
    pub fn data(&self) -> *mut u8 {
        self.data
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
        assert!(index < self.layout.size() / self.precision.bytes());
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

    /// Index of population `i` at node `x` of the row (`j`, `k`), each from -1 (ghost) to the number of nodes (ghost).
    #[inline]
    pub fn index(&self, i: usize, x: isize, j: isize, k: isize) -> usize {
        self.arrays[i].wrapping_add_signed(self.place(i, x, j, k))
    }

    /// The same, from the start of the array of the population.
    #[inline]
    pub fn place(&self, _i: usize, x: isize, j: isize, k: isize) -> isize {
        let row = (k + 1) as usize * (self.shape[1] + 2) + (j + 1) as usize;
        (row * self.stride) as isize + x
    }

    /// Where the array of each population starts.
    #[inline(always)]
    pub fn arrays(&self) -> &[usize; MAX_Q] {
        &self.arrays
    }

    /// The row that stands at (`j`, `k`), each from -1 to the number of nodes: wrapped where the direction repeats, else
    /// a ghost beyond the grid.
    #[inline]
    pub fn wrapped(&self, j: isize, k: isize) -> [isize; 2] {
        [self.wrap(j, 1), self.wrap(k, 2)]
    }

    #[inline]
    fn wrap(&self, i: isize, axis: usize) -> isize {
        let n = self.shape[axis] as isize;
        match i {
            -1 if self.periodic[axis] => n - 1,
            _ if i == n && self.periodic[axis] => 0,
            _ => i,
        }
    }
}

impl Drop for Storage {
    fn drop(&mut self) {
        // SAFETY: allocated in `new` with this layout.
        unsafe { dealloc(self.data, self.layout) };
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
