//! Which places of the populations are used, and where they are.
//!
//! The place of population `i` at node `y` is used if `y` is in the fluid, which finds it there before an even step, or if
//! `y - c_i` is, which finds it there before an odd one ([`crate::links`]). The places of a row that follow each other are an
//! interval; intervals follow each other in memory, so that nothing is kept for solid nodes away from the fluid.

use crate::mask::Mask;
use crate::stencil::Velocities;
use lbm_ibm_coupling::Grid;

/// Nodes between two intervals that are rather kept than left out.
const BRIDGED: isize = 2;
/// An interval starts where a cache line does in all of the arrays, unless this times the numbers lost exceeds its length.
const WORTH: usize = 4;

/// Intervals of one population.
pub struct Intervals {
    /// For each row, ghost rows included, the number of its first interval; one more at the end.
    first: Vec<u32>,
    /// The first node of each interval, and the place of node 0 of its row, if it had one.
    starts: Vec<[i32; 2]>,
    /// Numbers that the population needs.
    pub len: usize,
}

/// The row that stands at (`j`, `k`), each from -1 to the number of nodes: wrapped where the direction repeats, else a ghost
/// beyond the grid.
pub fn wrapped(grid: &Grid, j: isize, k: isize) -> [isize; 2] {
    let wrap = |i: isize, axis: usize| {
        let n = grid.shape[axis] as isize;
        match i {
            -1 if grid.periodic[axis] => n - 1,
            _ if i == n && grid.periodic[axis] => 0,
            _ => i,
        }
    };
    [wrap(j, 1), wrap(k, 2)]
}

/// Number of a row in [`Intervals`].
pub fn row(grid: &Grid, j: isize, k: isize) -> usize {
    (k + 1) as usize * (grid.shape[1] + 2) + (j + 1) as usize
}

impl Intervals {
    /// Those of population `i`; `unit` is what a cache line holds.
    pub fn new(grid: &Grid, mask: &Mask, velocities: Velocities, i: usize, unit: usize) -> Self {
        let [_, ny, nz] = grid.shape.map(|n| n as isize);
        let [cx, cy, cz] = velocities.c(i).map(|c| c as isize);
        let mut all = Self {
            first: vec![0],
            starts: Vec::new(),
            len: 0,
        };
        let mut used: Vec<[isize; 2]> = Vec::new();
        for k in -1..=nz {
            for j in -1..=ny {
                used.clear();
                if (0..ny).contains(&j) && (0..nz).contains(&k) {
                    add_runs(mask, [j, k], 0, &mut used);
                }
                if wrapped(grid, j, k) == [j, k] {
                    let [sj, sk] = wrapped_source(grid, j - cy, k - cz);
                    if (0..ny).contains(&sj) && (0..nz).contains(&sk) {
                        add_runs(mask, [sj, sk], cx, &mut used);
                    }
                }
                used.sort_unstable();
                all.add_row(&used, unit);
            }
        }
        all
    }

    /// Those of the fluid nodes alone, one after the other: the same for all populations of packed nodes ([`crate::packed`]).
    pub fn packed(grid: &Grid, mask: &Mask) -> Self {
        let [_, ny, nz] = grid.shape.map(|n| n as isize);
        let mut all = Self {
            first: vec![0],
            starts: Vec::new(),
            len: 0,
        };
        let mut used: Vec<[isize; 2]> = Vec::new();
        for k in -1..=nz {
            for j in -1..=ny {
                used.clear();
                if (0..ny).contains(&j) && (0..nz).contains(&k) {
                    add_runs(mask, [j, k], 0, &mut used);
                }
                for &[start, end] in &used {
                    all.starts.push([start as i32, (all.len as isize - start) as i32]);
                    all.len += (end - start) as usize;
                }
                all.first.push(all.starts.len() as u32);
            }
        }
        all
    }

    fn add_row(&mut self, used: &[[isize; 2]], unit: usize) {
        let mut parts = used.iter().copied().peekable();
        while let Some([start, mut end]) = parts.next() {
            while let Some([_, last]) = parts.next_if(|[next, _]| *next <= end + BRIDGED) {
                end = end.max(last);
            }
            let length = (end - start) as usize;
            let lost = (start - self.len as isize).rem_euclid(unit as isize) as usize;
            if lost * WORTH <= length {
                self.len += lost;
            }
            self.starts.push([start as i32, (self.len as isize - start) as i32]);
            self.len += length;
        }
        self.first.push(self.starts.len() as u32);
    }

    /// Place of node `x` of a row of [`row`].
    #[inline]
    pub fn place(&self, row: usize, x: isize) -> isize {
        let starts = &self.starts[self.first[row] as usize..self.first[row + 1] as usize];
        let after = starts.partition_point(|[start, _]| *start as isize <= x);
        debug_assert!(after > 0, "node {x} of row {row} has no place");
        x + starts[after.max(1) - 1][1] as isize
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.first) + size_of_val(&*self.starts)
    }
}

/// As [`wrapped`], for rows up to two beyond the grid.
fn wrapped_source(grid: &Grid, j: isize, k: isize) -> [isize; 2] {
    let inside = |i: isize, axis: usize| {
        let n = grid.shape[axis] as isize;
        if grid.periodic[axis] { i.rem_euclid(n) } else { i }
    };
    [inside(j, 1), inside(k, 2)]
}

/// Adds the fluid runs of a row, shifted.
fn add_runs(mask: &Mask, [j, k]: [isize; 2], shift: isize, used: &mut Vec<[isize; 2]>) {
    let runs = mask.fluid_runs(j as usize, k as usize);
    used.extend(runs.map(|run| [run.start as isize + shift, run.end as isize + shift]));
}
