//! Several time steps in one sweep over the memory, while a tile is in the cache.
//!
//! Row (`j`, `k`) can take step `t` as soon as the nine rows about it have taken step `t - 1`; nothing else matters, for in
//! one step each place is used by one row alone ([`crate::links`]). So the order is free, and the result is the same to the
//! last bit as step by step.
//!
//! The planes are divided into slabs, one for each thread. In the first phase a slab takes step `t` on the planes that are
//! more than `t` planes inside it; in the second the wedges about the seams between slabs are filled. Within either, blocks
//! of rows are done one after the other, each of them `t` rows behind in step `t`, and within a block the planes in turn,
//! again each `t` planes behind.

use crate::ferry::Buffer;
use crate::packed::Packed;
use crate::parallel;
use crate::step::{Ahead, Step};
use std::ops::Range;

/// Bytes of populations that a thread works on at a time, about half of what its share of the last cache holds.
const CACHE: usize = 4 << 20;
/// Fewest rows of a block, as a multiple of the number of steps.
const LEAST_ROWS: usize = 2;

/// A sweep of several steps.
pub struct Sweep<'a> {
    pub step: Step<'a>,
    /// Whether the first step is an odd one.
    pub odd: bool,
    pub steps: usize,
    /// Rows of a plane, and planes.
    pub shape: [usize; 2],
    /// Whether rows and planes repeat.
    pub periodic: [bool; 2],
    /// Bytes of the populations of a row.
    pub row_bytes: usize,
}

/// Planes that are swept together: in step `t` those from `first[0] + t first[1]` to `end[0] + t end[1]`, wrapped.
struct Region {
    first: [isize; 2],
    end: [isize; 2],
}

impl Region {
    fn planes(&self, t: isize) -> Range<isize> {
        self.first[0] + t * self.first[1]..self.end[0] + t * self.end[1]
    }
}

impl Sweep<'_> {
    /// Whether a grid with so many rows and planes has room for the wedges of so many steps, and is faster with them.
    pub fn fits(shape: [usize; 2], steps: usize) -> bool {
        let threads = parallel::threads();
        // The wedges between slabs are done last and alone: slabs that are not far thicker cost more than they save.
        let least = if threads > 1 {
            8 * steps * threads
        } else {
            2 * steps + 2
        };
        shape[0] >= 1 && shape[1] >= least
    }

    /// Takes all steps.
    ///
    /// # Safety
    /// Nothing else may touch the populations meanwhile; the grid has room ([`Sweep::fits`]); no link needs what comes after
    /// all rows, and no balance is wanted.
    pub unsafe fn run(&self) {
        let planes = self.shape[1];
        let slabs = parallel::threads().clamp(1, planes / (2 * self.steps + 2));
        let bound = |slab: usize| (slab * planes / slabs) as isize;
        let closed = |slab: usize| !self.periodic[1] && slab.is_multiple_of(slabs);
        let slope = |slab: usize, s: isize| if closed(slab) { 0 } else { s };
        let inside: Vec<Region> = (0..slabs)
            .map(|slab| Region {
                first: [bound(slab), slope(slab, 1)],
                end: [bound(slab + 1), slope(slab + 1, -1)],
            })
            .collect();
        let seams: Vec<Region> = (0..slabs)
            .filter(|slab| !closed(*slab))
            .map(|slab| Region {
                first: [bound(slab), -1],
                end: [bound(slab), 1],
            })
            .collect();
        for phase in [inside, seams] {
            // SAFETY: regions of a phase do not touch each other's rows, and the phases are one after the other.
            parallel::map(&phase, |region| unsafe { self.region(region) });
        }
    }

    /// Sweeps a region.
    unsafe fn region(&self, region: &Region) {
        let (steps, rows) = (self.steps as isize, self.shape[0] as isize);
        let held = CACHE / (self.row_bytes * (self.steps + 2));
        let block = held.max(LEAST_ROWS * self.steps) as isize;
        let blocks = (rows / block).max(1);
        // Where a block starts in step t: the first ones behind the end of the last, if rows repeat.
        let bound = |n: isize, t: isize| match n {
            0 => {
                if self.periodic[0] {
                    t
                } else {
                    0
                }
            }
            _ if n == blocks => rows + if self.periodic[0] { t } else { 0 },
            _ => n * rows / blocks - t,
        };
        let mut line = Line {
            sweep: self,
            ahead: Ahead::new(),
            buffer: Buffer::new(),
            waiting: None,
        };
        let planes = |t: isize| region.planes(t);
        let first = (0..steps).map(|t| planes(t).start + t).min().unwrap_or(0);
        let end = (0..steps).map(|t| planes(t).end + t).max().unwrap_or(0);
        for n in 0..blocks {
            for front in first..end {
                for t in 0..steps {
                    let plane = front - t;
                    if planes(t).contains(&plane) {
                        // SAFETY: the rows about these have taken the step before.
                        unsafe { line.rows(bound(n, t)..bound(n + 1, t), plane, t) };
                    }
                }
            }
        }
        // SAFETY: as above.
        unsafe { line.finish() };
    }
}

impl Sweep<'_> {
    /// Takes a step on packed rows that follow each other in plane `k`.
    unsafe fn packed(&self, packed: &Packed, rows: Range<isize>, k: usize, odd: bool, buffer: &mut Buffer) {
        let (ny, links) = (self.shape[0] as isize, self.step.links);
        let row = |j: isize| links.row_at(j.rem_euclid(ny) as usize, k);
        let (Some(first), Some(last)) = (rows.clone().find_map(row), rows.rev().find_map(row)) else {
            return;
        };
        let number = |run: usize| packed.starts[run] as usize;
        let nodes = number(links.rows[first].runs().start)..number(links.rows[last].runs().end);
        // SAFETY: the caller's contract.
        unsafe {
            self.step.packed(packed, nodes.clone(), odd, buffer, |_, _| {});
            links.marks.push(self.step.storage, &nodes);
        }
    }
}

/// Rows in the order of work, with the next one known before a row is done.
struct Line<'a> {
    sweep: &'a Sweep<'a>,
    ahead: Ahead,
    /// Room for batches of packed nodes.
    buffer: Buffer,
    /// A row and whether its step is odd.
    waiting: Option<(usize, bool)>,
}

impl Line<'_> {
    unsafe fn rows(&mut self, rows: Range<isize>, plane: isize, t: isize) {
        let [ny, nz] = self.sweep.shape.map(|n| n as isize);
        let (k, odd) = (plane.rem_euclid(nz) as usize, self.sweep.odd ^ (t % 2 == 1));
        if let Some(packed) = &self.sweep.step.links.packed {
            // Rows follow each other, but for the end of the plane.
            let end = rows.start.div_euclid(ny) * ny + ny;
            for rows in [rows.start..rows.end.min(end), rows.start.max(end)..rows.end] {
                // SAFETY: the caller's contract.
                unsafe { self.sweep.packed(packed, rows, k, odd, &mut self.buffer) };
            }
            return;
        }
        for j in rows {
            let j = j.rem_euclid(ny);
            let Some(row) = self.sweep.step.links.row_at(j as usize, k) else {
                continue;
            };
            if let Some((now, was_odd)) = self.waiting.replace((row, odd)) {
                // SAFETY: the caller's contract.
                unsafe { self.sweep.step.row(now, was_odd, (row, odd), &mut self.ahead) };
            }
        }
    }

    unsafe fn finish(&mut self) {
        if let Some(last) = self.waiting.take() {
            // SAFETY: the caller's contract.
            unsafe { self.sweep.step.row(last.0, last.1, last, &mut self.ahead) };
        }
    }
}
