//! Fluid nodes one after the other, whatever their runs: how a scene whose runs are short is stored.
//!
//! Population `i` of a node has one place, and no other is kept. In an odd step node `x` uses the places
//! `(x - c_i, opposite(i))`, but its own place `i` where `x - c_i` is solid: nobody else uses that, and what went out to the wall
//! waits there. So bounce-back needs no copying: what an odd step leaves at a wall is what the even step has to find there,
//! and the reverse.
//!
//! An even step is one loop over all nodes. For an odd one nodes are taken by the batch: their populations are brought together in a
//! [`Buffer`], collide there and go back to where they came from. A batch has [`BLOCKS`] blocks of a vector each. In a block, lanes
//! whose populations `i` stand side by side are one masked vector; the fullest of these is kept by its place and mask, further
//! ones in a list of the batch.

use crate::collide::Places;
use crate::element::Precision;
use crate::ferry::{APART, BLOCKS, Batch, Buffer, Parts, STRIDE, block_lanes};
use crate::stencil::{MAX_Q, opposite};
use crate::storage::Storage;
use std::ops::Range;

/// How many batches before its own a batch is asked for.
const EARLY: usize = 2;

/// Numbers and places of packed nodes.
pub struct Packed {
    /// Number of the first node of each run, and the number of nodes.
    pub starts: Vec<u32>,
    /// Row of each run.
    pub rows: Vec<u32>,
    /// The run of the first node of each batch.
    first_run: Vec<u32>,
    q: usize,
    pub precision: Precision,
    /// Of each batch, population from 1 on, and block: the place of lane 0 from the start of the memory.
    sources: Vec<u32>,
    /// Which lanes are there, a bit each.
    masks: Vec<u8>,
    /// The same of further parts, and of which block and population each is.
    other_sources: Vec<u32>,
    other_masks: Vec<u8>,
    slots: Vec<u8>,
    /// Of each batch the first further part, and their number.
    first_other: Vec<u32>,
    /// Links into walls.
    pub links: usize,
}

/// Lanes of a block.
fn lanes(precision: Precision) -> usize {
    block_lanes(precision.bytes())
}

impl Packed {
    /// No nodes yet.
    pub fn new(storage: &Storage) -> Self {
        Self {
            starts: vec![0],
            rows: Vec::new(),
            first_run: Vec::new(),
            q: storage.velocities().q(),
            precision: storage.precision(),
            sources: Vec::new(),
            masks: Vec::new(),
            other_sources: Vec::new(),
            other_masks: Vec::new(),
            slots: Vec::new(),
            first_other: vec![0],
            links: 0,
        }
    }

    /// Nodes of a batch.
    pub fn batch(&self) -> usize {
        BLOCKS * lanes(self.precision)
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.last().map_or(0, |n| *n as usize)
    }

    /// Number of batches.
    pub fn batches(&self) -> usize {
        self.first_other.len() - 1
    }

    /// Gives back memory that is not used.
    pub fn shrink(&mut self) {
        for numbers in [
            &mut self.starts,
            &mut self.rows,
            &mut self.first_run,
            &mut self.sources,
            &mut self.other_sources,
            &mut self.first_other,
        ] {
            numbers.shrink_to_fit();
        }
        for bytes in [&mut self.masks, &mut self.other_masks, &mut self.slots] {
            bytes.shrink_to_fit();
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.starts)
            + size_of_val(&*self.rows)
            + size_of_val(&*self.first_run)
            + size_of_val(&*self.sources)
            + size_of_val(&*self.masks)
            + size_of_val(&*self.other_sources)
            + size_of_val(&*self.other_masks)
            + size_of_val(&*self.slots)
            + size_of_val(&*self.first_other)
    }

    /// Adds a run of so many nodes.
    pub fn add_run(&mut self, row: usize, nodes: usize) {
        let first = self.nodes();
        let run = self.rows.len() as u32;
        while self.first_run.len() * self.batch() < first + nodes {
            self.first_run.push(run);
        }
        self.rows.push(row as u32);
        self.starts.push((first + nodes) as u32);
    }

    /// Adds a batch of nodes, the last one perhaps not full. `places[i * batch + n]` is where node `n` finds population `i` before an
    /// odd step.
    pub fn add_batch(&mut self, places: &[u32], nodes: usize) {
        let (lanes, batch) = (lanes(self.precision), self.batch());
        let mut parts: Vec<(u32, u16)> = Vec::new();
        for i in 1..self.q {
            for block in 0..BLOCKS {
                parts.clear();
                for lane in 0..lanes.min(nodes.saturating_sub(block * lanes)) {
                    let source = places[i * batch + block * lanes + lane].wrapping_sub(lane as u32);
                    match parts.iter_mut().find(|(s, _)| *s == source) {
                        Some((_, mask)) => *mask |= 1 << lane,
                        None => parts.push((source, 1 << lane)),
                    }
                }
                // The first of the fullest.
                parts.sort_by_key(|(_, mask)| std::cmp::Reverse(mask.count_ones()));
                let (source, mask) = parts.first().copied().unwrap_or((places[i * batch], 0));
                self.sources.push(source);
                self.masks.extend(&mask.to_le_bytes()[..lanes / 8]);
                for (source, mask) in parts.iter().skip(1) {
                    self.other_sources.push(*source);
                    self.other_masks.extend(&mask.to_le_bytes()[..lanes / 8]);
                    self.slots.push((i * APART + block) as u8);
                }
            }
        }
        self.first_other.push(self.other_sources.len() as u32);
    }

    /// Sources of the fullest parts of a batch.
    fn sources_of(&self, batch: usize) -> &[u32] {
        let slots = (self.q - 1) * BLOCKS;
        &self.sources[batch * slots..][..slots]
    }

    pub fn of(&self, batch: usize) -> Batch<'_> {
        let (slots, bytes) = ((self.q - 1) * BLOCKS, lanes(self.precision) / 8);
        let others = |n: usize| self.first_other[n] as usize..self.first_other[n + 1] as usize;
        let (here, last) = (others(batch), self.batches() - 1);
        let later = (batch + EARLY).min(last);
        Batch {
            main: Parts {
                sources: self.sources_of(batch),
                masks: &self.masks[batch * slots * bytes..][..slots * bytes],
            },
            others: Parts {
                sources: &self.other_sources[here.clone()],
                masks: &self.other_masks[here.start * bytes..here.end * bytes],
            },
            slots: &self.slots[here],
            next: if batch < last {
                &self.other_sources[others(batch + 1)]
            } else {
                &[]
            },
            early: self.sources_of(later),
            later: (later - batch) * self.batch(),
        }
    }

    /// Where node `node` finds population `i` before an odd step, from the start of the memory.
    pub fn place(&self, storage: &Storage, node: usize, i: usize) -> usize {
        if i == 0 {
            return storage.arrays()[0] + node;
        }
        let lanes = lanes(self.precision);
        let (batch, at) = (self.of(node / self.batch()), node % self.batch());
        let (block, lane) = (at / lanes, at % lanes);
        let slot = (i - 1) * BLOCKS + block;
        let has = |parts: &Parts, n: usize| parts.mask(n, lanes) >> lane & 1 == 1;
        let source = if has(&batch.main, slot) {
            batch.main.sources[slot]
        } else {
            let mut others = batch.slots.iter().enumerate();
            let here = others.find(|(n, s)| usize::from(**s) == i * APART + block && has(&batch.others, *n));
            here.map_or(0, |(n, _)| batch.others.sources[n])
        };
        source.wrapping_add(lane as u32) as usize
    }

    /// Which lanes of each block of a batch are among `nodes`.
    pub fn clip(&self, batch: usize, nodes: &Range<usize>) -> [u16; BLOCKS] {
        let (lanes, first) = (lanes(self.precision), batch * self.batch());
        std::array::from_fn(|block| {
            let start = first + block * lanes;
            let bits = |to: usize| (1_u32 << to.saturating_sub(start).min(lanes)) - 1;
            (bits(nodes.end) & !bits(nodes.start)) as u16
        })
    }

    /// Places of the populations of a batch in a buffer; the first stands where it is.
    pub fn places(&self, storage: &Storage, batch: usize, buffer: &mut Buffer) -> Places {
        let start = buffer.start();
        let mut places: Places = std::array::from_fn(|i| start.wrapping_add(i.min(self.q - 1) * STRIDE));
        places[0] = self.resting(storage, batch);
        places
    }

    /// The place of population 0 of the first node of a batch.
    pub fn resting(&self, storage: &Storage, batch: usize) -> *mut u8 {
        let number = storage.arrays()[0] + batch * self.batch();
        storage.data().wrapping_add(number * self.precision.bytes())
    }

    /// The nodes' own places from the first of a batch on.
    pub fn own(&self, storage: &Storage, batch: usize) -> Places {
        let (arrays, bytes) = (storage.arrays(), self.precision.bytes());
        let first = batch * self.batch();
        std::array::from_fn(|i| storage.data().wrapping_add((arrays[i] + first) * bytes))
    }

    /// About where the populations of a batch stand before an odd step.
    pub fn sources(&self, storage: &Storage, batch: usize) -> Places {
        let first = self.resting(storage, batch);
        let (mut places, bytes) = ([first; MAX_Q], self.precision.bytes());
        let sources = self.sources_of(batch).iter().step_by(BLOCKS);
        for (place, source) in places[1..].iter_mut().zip(sources) {
            *place = storage.data().wrapping_add(*source as usize * bytes);
        }
        places
    }

    /// Whether all nodes of a batch are among `nodes`.
    pub fn holds(&self, batch: usize, nodes: &Range<usize>) -> bool {
        let first = batch * self.batch();
        nodes.start <= first && nodes.end >= (first + self.batch()).min(self.nodes())
    }

    /// Runs that have nodes in a range, each with those, counted along the row.
    pub fn runs<'a>(
        &'a self,
        runs: &'a [[u32; 2]],
        nodes: &'a Range<usize>,
    ) -> impl Iterator<Item = (usize, Range<usize>)> + 'a {
        let first = self.first_run.get(nodes.start / self.batch()).copied().unwrap_or(0) as usize;
        let start = |run: usize| self.starts[run] as usize;
        (first..runs.len())
            .skip_while(move |run| start(run + 1) <= nodes.start)
            .take_while(move |run| start(*run) < nodes.end)
            .map(move |run| {
                let at = |node: usize| runs[run][0] as usize + (node - start(run));
                (run, at(nodes.start.max(start(run)))..at(nodes.end.min(start(run + 1))))
            })
    }

    /// Calls `link(i, index)` for the links into walls of a batch: the population that comes back, and its place.
    pub fn for_walls(&self, storage: &Storage, batch: usize, mut link: impl FnMut(usize, usize)) {
        let (lanes, arrays) = (lanes(self.precision), storage.arrays());
        let (first, parts) = (batch * self.batch(), self.of(batch));
        let mut each = |i: usize, block: usize, source: u32, mut mask: u16| {
            if source as usize != arrays[i] + first + block * lanes {
                return;
            }
            while mask != 0 {
                link(i, source as usize + mask.trailing_zeros() as usize);
                mask &= mask - 1;
            }
        };
        for (n, source) in parts.main.sources.iter().enumerate() {
            each(n / BLOCKS + 1, n % BLOCKS, *source, parts.main.mask(n, lanes));
        }
        for (n, (source, slot)) in parts.others.sources.iter().zip(parts.slots).enumerate() {
            let slot = usize::from(*slot);
            each(slot / APART, slot % APART, *source, parts.others.mask(n, lanes));
        }
    }

    /// Where population `i` of node `from` stands before an odd step if it comes from node `to`; from a wall, if there is none.
    pub fn link(storage: &Storage, i: usize, node: u32, source: Option<u32>) -> u32 {
        let arrays = storage.arrays();
        match source {
            Some(source) => arrays[opposite(i)] as u32 + source,
            None => arrays[i] as u32 + node,
        }
    }
}
