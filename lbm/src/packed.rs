//! Fluid nodes one after the other, whatever their runs: how a scene whose runs are short is stored.
//!
//! Population `i` of a node has one place, and no other is kept. In an odd step node `x` uses the places
//! `(x - c_i, opposite(i))`, but its own place `i` where `x - c_i` is solid: nobody else uses that, and what went out to the wall
//! waits there. So bounce-back needs no copying: what an odd step leaves at a wall is what the even step has to find there,
//! and the reverse.
//!
//! An even step is one loop over all nodes. For an odd one nodes are taken by the batch: their populations are brought together in a
//! [`Buffer`], collide there and go back to where they came from. A batch has [`BLOCKS`] blocks of a vector each. In a block, lanes
//! whose populations `i` stand side by side are one masked vector; the fullest of these is kept by its place and mask, what is left in
//! lists of the batch, as copies of four numbers, two and one.

use crate::collide::Places;
use crate::element::Precision;
use crate::ferry::{BLOCKS, Batch, Buffer, Copies, FOLD, Parts, STRIDE, WIDTHS, block_lanes, slot, split};
use crate::simd::prefetch;
use crate::stencil::{MAX_Q, opposite};
use crate::storage::Storage;
use std::ops::Range;

/// How many batches before its own a batch is asked for, and how many before that its lists.
const EARLY: usize = 2;
const EARLIER: usize = 5;

/// Numbers and places of packed nodes.
pub struct Packed {
    /// Number of the first node of each run, and the number of nodes.
    pub starts: Vec<u32>,
    /// The run of the first node of each batch.
    first_run: Vec<u32>,
    q: usize,
    pub precision: Precision,
    /// Of each batch, population from 1 on, and block: the place of lane 0 from the start of the memory.
    sources: Vec<u32>,
    /// Which lanes are there, a bit each.
    masks: Vec<u8>,
    /// The copies of what is left: the place of the first number of each, and its number in a buffer.
    other_sources: Vec<[u32; FOLD]>,
    other_slots: Vec<[u16; FOLD]>,
    /// Where the copies of each of [`WIDTHS`] end, those of no batch first; each batch begins where the one before ends.
    other_ends: Vec<[u32; WIDTHS.len()]>,
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
            first_run: Vec::new(),
            q: storage.velocities().q(),
            precision: storage.precision(),
            sources: Vec::new(),
            masks: Vec::new(),
            other_sources: Vec::new(),
            other_slots: Vec::new(),
            other_ends: vec![[0; WIDTHS.len()]],
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
        self.other_ends.len() - 1
    }

    /// Gives back memory that is not used.
    pub fn shrink(&mut self) {
        for numbers in [&mut self.starts, &mut self.first_run, &mut self.sources] {
            numbers.shrink_to_fit();
        }
        self.masks.shrink_to_fit();
        self.other_sources.shrink_to_fit();
        self.other_slots.shrink_to_fit();
        self.other_ends.shrink_to_fit();
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.starts)
            + size_of_val(&*self.first_run)
            + size_of_val(&*self.sources)
            + size_of_val(&*self.masks)
            + size_of_val(&*self.other_sources)
            + size_of_val(&*self.other_slots)
            + size_of_val(&*self.other_ends)
    }

    /// Adds a run of so many nodes.
    pub fn add_run(&mut self, nodes: usize) {
        let first = self.nodes();
        let run = self.starts.len() as u32 - 1;
        while self.first_run.len() * self.batch() < first + nodes {
            self.first_run.push(run);
        }
        self.starts.push((first + nodes) as u32);
    }

    /// Adds a batch of nodes, the last one perhaps not full. `places[i * batch + n]` is where node `n` finds population `i` before an
    /// odd step.
    pub fn add_batch(&mut self, places: &[u32], nodes: usize) {
        let (lanes, batch) = (lanes(self.precision), self.batch());
        let mut parts: Vec<(u32, u16)> = Vec::new();
        let mut others: [Vec<(u32, u16)>; WIDTHS.len()] = Default::default();
        for i in 1..self.q {
            // Those that are left, by the place that node 0 would have: they may pass from block to block.
            let mut left: Vec<(u32, u128)> = Vec::new();
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
                    let (start, mask) = (
                        source.wrapping_sub((block * lanes) as u32),
                        u128::from(*mask) << (block * lanes),
                    );
                    match left.iter_mut().find(|(s, _)| *s == start) {
                        Some((_, all)) => *all |= mask,
                        None => left.push((start, mask)),
                    }
                }
            }
            for (start, mask) in left {
                for (node, width) in cuts(mask) {
                    let to = slot(i, node, self.precision.bytes());
                    others[width].push((start.wrapping_add(node as u32), to as u16));
                }
            }
        }
        self.other_ends.push(others.map(|copies| {
            for copies in copies.chunks(FOLD) {
                let copy = |n: usize| copies[n.min(copies.len() - 1)];
                self.other_sources.push(std::array::from_fn(|n| copy(n).0));
                self.other_slots.push(std::array::from_fn(|n| copy(n).1));
            }
            self.other_sources.len() as u32
        }));
    }

    /// Sources of the fullest parts of a batch.
    fn sources_of(&self, batch: usize) -> &[u32] {
        let slots = (self.q - 1) * BLOCKS;
        &self.sources[batch * slots..][..slots]
    }

    /// Where the copies of a batch stand in the lists, by width.
    fn others_of(&self, batch: usize) -> [Range<usize>; WIDTHS.len()] {
        let mut start = self.other_ends[batch][WIDTHS.len() - 1] as usize;
        self.other_ends[batch + 1].map(|end| std::mem::replace(&mut start, end as usize)..end as usize)
    }

    /// Sources of all copies of a batch.
    fn other_sources_of(&self, batch: usize) -> &[[u32; FOLD]] {
        let [first, .., last] = self.others_of(batch);
        &self.other_sources[first.start..last.end]
    }

    pub fn of(&self, batch: usize) -> Batch<'_> {
        let (slots, bytes) = ((self.q - 1) * BLOCKS, lanes(self.precision) / 8);
        let (last, others) = (self.batches() - 1, self.others_of(batch));
        let later = (batch + EARLY).min(last);
        Batch {
            main: Parts {
                sources: self.sources_of(batch),
                masks: &self.masks[batch * slots * bytes..][..slots * bytes],
            },
            others: std::array::from_fn(|n| Copies {
                width: WIDTHS[n],
                sources: &self.other_sources[others[n].clone()],
                slots: &self.other_slots[others[n].clone()],
            }),
            next: if batch < last {
                self.other_sources_of(batch + 1)
            } else {
                &[]
            },
            early: self.sources_of(later),
            later: (later - batch) * self.batch(),
        }
    }

    /// The lists of a batch that comes later, to ask for: where each starts, and its bytes. They are read as fast as populations are, in
    /// too many streams for a processor to foresee.
    pub fn lists(&self, batch: usize) -> [(*const u8, usize); 4] {
        fn list<T>(all: &[T], part: Range<usize>) -> (*const u8, usize) {
            let start = all.as_ptr().wrapping_add(part.start);
            (start.cast(), part.len() * size_of::<T>())
        }
        let batch = (batch + EARLIER).min(self.batches() - 1);
        let [first, .., last] = self.others_of(batch);
        let slots = (self.q - 1) * BLOCKS;
        let bytes = slots * lanes(self.precision) / 8;
        prefetch(self.other_ends.as_ptr().wrapping_add(batch + EARLIER));
        [
            list(&self.sources, batch * slots..(batch + 1) * slots),
            list(&self.masks, batch * bytes..(batch + 1) * bytes),
            list(&self.other_sources, first.start..last.end),
            list(&self.other_slots, first.start..last.end),
        ]
    }

    /// Where node `node` finds population `i` before an odd step, from the start of the memory.
    pub fn place(&self, storage: &Storage, node: usize, i: usize) -> usize {
        if i == 0 {
            return storage.arrays()[0] + node;
        }
        let lanes = lanes(self.precision);
        let (batch, at) = (self.of(node / self.batch()), node % self.batch());
        let (main, lane) = ((i - 1) * BLOCKS + at / lanes, at % lanes);
        if batch.main.mask(main, lanes) >> lane & 1 == 1 {
            return batch.main.sources[main].wrapping_add(lane as u32) as usize;
        }
        let wanted = slot(i, at, self.precision.bytes());
        let copy = batch.others.iter().find_map(|copies| {
            let (source, slot) = copies
                .iter()
                .find(|(_, slot)| wanted.wrapping_sub(*slot) < copies.width)?;
            Some(source + wanted - slot)
        });
        copy.unwrap_or(0)
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
        for (n, source) in parts.main.sources.iter().enumerate() {
            let (i, block) = (n / BLOCKS + 1, n % BLOCKS);
            if *source as usize != arrays[i] + first + block * lanes {
                continue;
            }
            let mut mask = parts.main.mask(n, lanes);
            while mask != 0 {
                link(i, *source as usize + mask.trailing_zeros() as usize);
                mask &= mask - 1;
            }
        }
        for copies in &parts.others {
            let mut before = None;
            for (source, slot) in copies.iter() {
                let (i, at) = split(slot, self.precision.bytes());
                // The last one may be repeated.
                if source == arrays[i] + first + at && before.replace(slot) != Some(slot) {
                    (source..source + copies.width).for_each(|place| link(i, place));
                }
            }
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

/// Cuts the nodes of a mask into stretches that are as long as one of [`WIDTHS`]: the first node of each, and which of them it is.
fn cuts(mut mask: u128) -> impl Iterator<Item = (usize, usize)> {
    std::iter::from_fn(move || {
        let node = mask.trailing_zeros() as usize;
        let stretch = |width: &usize| (1_u128 << width) - 1;
        let fits = |width: &usize| mask != 0 && mask >> node & stretch(width) == stretch(width);
        let width = WIDTHS.iter().position(fits)?;
        mask &= !(stretch(&WIDTHS[width]) << node);
        Some((node, width))
    })
}
