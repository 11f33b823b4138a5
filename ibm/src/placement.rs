//! Markers on the grid: sorted by brick, with the part of the grid that the markers of each brick touch.

mod homes;

use crate::axis::{Axis, BEFORE, SEGMENTS, Segment};
use crate::table::Table;
use crate::threads;
use homes::{Home, OUTSIDE, Spots, homes};
use lbm_ibm_coupling::{BRICK_EDGE, Bricks, Grid, Soa3Ref, Vec3, prefetch};
use std::ops::{Range, RangeInclusive};
use std::sync::atomic::{AtomicU32, Ordering};

/// Markers per task.
const LEAF: usize = 2048;
/// How many markers before its turn one is asked for.
const AHEAD: usize = 16;
/// Bricks per task.
const BRICKS: usize = 32;

/// A marker in brick order.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Placed {
    pub f: [f64; 3],
    pub marker: u32,
    pub corner: [i8; 3],
}

/// The markers of one brick, and the box of nodes (their tile) that their stencils cover.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    /// First of its markers in brick order; the next group's first ends it.
    pub first: usize,
    /// Corner of the tile relative to the brick's.
    pub corner: [i8; 3],
    /// Nodes of the tile in x, y, z.
    pub size: [usize; 3],
    /// First node of the tile in the store of all tiles.
    pub tile: usize,
    pub brick: [usize; 3],
    pub slot: usize,
    /// First of its blocks; the next group's first ends it.
    pub block: usize,
    /// Rows of the tile that stencils touch: bit y of number z.
    pub rows: [u16; SEGMENTS],
}

impl Group {
    /// Nodes of its tile.
    pub fn nodes(&self) -> usize {
        self.size.iter().product()
    }
}

/// A box of nodes that a tile and a brick share. There are many, so their numbers are short.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    /// Rows of the brick that stencils touch: bit `8 z + y`.
    pub rows: u64,
    /// Linear number of the brick.
    brick: u32,
    pub slot: u32,
    pub group: u32,
    /// Corner in the brick.
    pub local: [u8; 3],
    /// Corner in the tile.
    pub tile: [u8; 3],
    pub size: [u8; 3],
}

/// What the stencils of a brick's markers cover.
#[derive(Clone, Copy, Debug, Default)]
struct Bounds {
    /// Least and greatest corners.
    low: [i8; 3],
    high: [i8; 3],
    /// Rows from [`BEFORE`] before the brick on: bit y of number z.
    rows: [u16; SEGMENTS],
}

impl Bounds {
    fn of(markers: &[Placed], support: usize) -> Self {
        let (mut low, mut high) = ([i8::MAX; 3], [i8::MIN; 3]);
        let mut rows = [0u16; SEGMENTS];
        for p in markers {
            for a in 0..3 {
                low[a] = low[a].min(p.corner[a]);
                high[a] = high[a].max(p.corner[a]);
            }
            let row = ((1 << support) - 1) << (p.corner[1] + BEFORE);
            rows[(p.corner[2] + BEFORE) as usize..][..support]
                .iter_mut()
                .for_each(|r| *r |= row);
        }
        Self { low, high, rows }
    }
}

/// Markers by their places: written by several threads, each at places of its own. A copy is to be filled in anew.
#[derive(Debug, Default)]
struct Order(Vec<AtomicU32>);

impl Clone for Order {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// All markers on the grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Placement {
    homes: Vec<Home>,
    /// For each part of the list of markers, the place of its next one in every brick.
    next: Vec<Vec<u32>>,
    /// Bricks with markers in ascending order, and the place behind the last marker of each.
    full: Vec<(u32, u32)>,
    order: Order,
    /// Of each of those bricks.
    bounds: Vec<Bounds>,
    /// Markers in brick order, by number within a brick.
    pub placed: Vec<Placed>,
    /// Place of each marker in that order.
    pub rank: Vec<u32>,
    pub groups: Vec<Group>,
    pub blocks: Vec<Block>,
    /// Blocks in the order of the slots they share, by group within a slot.
    pub by_slot: Vec<u32>,
    pub slot_start: Vec<u32>,
    /// Nodes of all tiles.
    pub tile_nodes: usize,
}

impl Placement {
    /// Places the markers of `table` for node positions `x` (m), wants their bricks and commits.
    ///
    /// # Errors
    /// A marker outside the grid, and its position.
    pub fn place(
        &mut self,
        table: &Table,
        x: Soa3Ref<'_>,
        grid: &Grid,
        support: usize,
        bricks: &mut Bricks,
    ) -> Result<(), (usize, Vec3)> {
        if table.is_plain() {
            let n = table.len();
            let (x, y, z) = (&x.x[..n], &x.y[..n], &x.z[..n]);
            self.locate(n, &|m| [x[m], y[m], z[m]], grid, support, bricks)?;
        } else {
            self.locate(table.len(), &|m| table.position(m, x), grid, support, bricks)?;
        }
        bricks.commit();
        self.order_by_slot(bricks);
        Ok(())
    }

    /// Places `count` markers at `position(m)` (m) and wants their bricks; after the commit comes
    /// [`Placement::order_by_slot`].
    ///
    /// # Errors
    /// A marker outside the grid, and its position.
    pub fn locate(
        &mut self,
        count: usize,
        position: &(impl Fn(usize) -> [f64; 3] + Sync),
        grid: &Grid,
        support: usize,
        bricks: &mut Bricks,
    ) -> Result<(), (usize, Vec3)> {
        let axes = Axis::all(grid, support);
        let counts = bricks.counts();
        self.homes.resize(count, Home::default());
        let spots = Spots {
            axes: &axes,
            per_spacing: 1.0 / grid.spacing,
            support,
            counts,
        };
        homes(&mut self.homes, 0, position, &spots);
        let total = counts.iter().product();
        if !self.sort(total) {
            let m = self.homes.iter().position(|h| h.brick == OUTSIDE).unwrap_or_default();
            return Err((m, Vec3::from(position(m))));
        }
        self.group(counts, support, &axes);
        for block in &self.blocks {
            bricks.want_rows(block.brick as usize, block.rows);
        }
        Ok(())
    }

    /// Stable counting sort of the markers by brick; not where one is outside the grid. Each task counts the markers of one
    /// part of the list, then finds their places, then fills in one part of the places.
    fn sort(&mut self, bricks: usize) -> bool {
        let markers = self.homes.len();
        let parts = (markers / LEAF).clamp(1, threads::count());
        let size = markers.div_ceil(parts).max(1);
        self.next.resize(parts, Vec::new());
        self.rank.resize(markers, 0);
        let homes = &self.homes;
        threads::parts(&mut self.next, &mut self.rank, size, 0, &|first, next, rank| {
            next.clear();
            next.resize(bricks + 1, 0);
            for h in &homes[first..first + rank.len()] {
                next[bricks.min(h.brick as usize)] += 1;
            }
        });
        if self.next.iter().any(|n| n[bricks] > 0) {
            return false;
        }
        self.full.clear();
        let mut end = 0;
        for b in 0..bricks {
            let first = end;
            for next in &mut self.next {
                end += std::mem::replace(&mut next[b], end);
            }
            if end > first {
                self.full.push((b as u32, end));
            }
        }
        self.placed.resize(markers, Placed::default());
        self.order.0.resize_with(markers, AtomicU32::default);
        let order = &self.order.0;
        threads::parts(&mut self.next, &mut self.rank, size, 0, &|first, next, rank| {
            for (i, (rank, home)) in rank.iter_mut().zip(&homes[first..]).enumerate() {
                let next = &mut next[home.brick as usize];
                *rank = *next;
                // No two markers have the same place, and nobody reads before all are there.
                order[*next as usize].store((first + i) as u32, Ordering::Relaxed);
                *next += 1;
            }
        });
        threads::fill(&mut self.placed, 0, LEAF, &|p| {
            if let Some(later) = order.get(p + AHEAD) {
                prefetch(&homes[later.load(Ordering::Relaxed) as usize]);
            }
            let marker = order[p].load(Ordering::Relaxed);
            let h = &homes[marker as usize];
            Placed {
                f: h.f,
                marker,
                corner: h.corner,
            }
        });
        true
    }

    /// Groups of markers, their tiles, and the bricks these touch.
    fn group(&mut self, counts: [usize; 3], support: usize, axes: &[Axis; 3]) {
        self.bounds.resize(self.full.len(), Bounds::default());
        let (full, placed) = (&self.full, &self.placed);
        let first = |n: usize| n.checked_sub(1).map_or(0, |n| full[n].1 as usize);
        threads::fill(&mut self.bounds, 0, BRICKS, &|n| {
            Bounds::of(&placed[first(n)..full[n].1 as usize], support)
        });
        self.groups.clear();
        self.blocks.clear();
        self.tile_nodes = 0;
        for n in 0..self.full.len() {
            let Bounds { low, high, rows } = &self.bounds[n];
            let b = self.full[n].0 as usize;
            let first = n.checked_sub(1).map_or(0, |n| self.full[n].1 as usize);
            let mut group = Group {
                first,
                corner: *low,
                size: [0, 1, 2].map(|a| (high[a] - low[a]) as usize + support),
                tile: self.tile_nodes,
                brick: [b % counts[0], b / counts[0] % counts[1], b / (counts[0] * counts[1])],
                slot: 0,
                block: self.blocks.len(),
                rows: [0; SEGMENTS],
            };
            let [y, z] = [1, 2].map(|a| (low[a] + BEFORE) as usize);
            for (to, from) in group.rows.iter_mut().zip(&rows[z..]) {
                *to = from >> y;
            }
            self.tile_nodes += group.nodes();
            self.cut(&group, counts, axes);
            self.groups.push(group);
        }
    }

    fn cut(&mut self, group: &Group, counts: [usize; 3], axes: &[Axis; 3]) {
        let mut segments = [[Segment::default(); SEGMENTS]; 3];
        let mut n = [0; 3];
        for a in 0..3 {
            n[a] = axes[a].segments(group.brick[a], group.corner[a], group.size[a], &mut segments[a]);
        }
        let [xs, ys, zs] = &segments;
        for z in &zs[..n[2]] {
            for y in &ys[..n[1]] {
                let mut rows = 0;
                for k in 0..z.size {
                    let row = u64::from(group.rows[z.tile + k] >> y.tile) & ((1 << y.size) - 1);
                    rows |= row << ((z.local + k) * BRICK_EDGE + y.local);
                }
                for x in xs[..n[0]].iter().filter(|_| rows != 0) {
                    self.blocks.push(Block {
                        rows,
                        brick: ((z.brick * counts[1] + y.brick) * counts[0] + x.brick) as u32,
                        slot: 0,
                        group: self.groups.len() as u32,
                        local: [x.local, y.local, z.local].map(|n| n as u8),
                        tile: [x.tile, y.tile, z.tile].map(|n| n as u8),
                        size: [x.size, y.size, z.size].map(|n| n as u8),
                    });
                }
            }
        }
    }

    /// Stable counting sort of the blocks by slot.
    pub fn order_by_slot(&mut self, bricks: &Bricks) {
        let slots = bricks.len();
        self.slot_start.clear();
        self.slot_start.resize(slots + 2, 0);
        // Every brick of a block has just been taken into use, and that of a group is one of them.
        for group in &mut self.groups {
            group.slot = bricks.slot(group.brick).unwrap_or_default();
        }
        for block in &mut self.blocks {
            let slot = bricks.slot_of(block.brick as usize).unwrap_or_default();
            block.slot = slot as u32;
            self.slot_start[slot + 2] += 1;
        }
        for s in 0..slots {
            self.slot_start[s + 2] += self.slot_start[s + 1];
        }
        self.by_slot.resize(self.blocks.len(), 0);
        for (b, block) in self.blocks.iter().enumerate() {
            let next = &mut self.slot_start[block.slot as usize + 1];
            self.by_slot[*next as usize] = b as u32;
            *next += 1;
        }
    }

    /// Markers of one group.
    pub fn markers_of(&self, group: usize) -> &[Placed] {
        let end = self.groups.get(group + 1).map_or(self.placed.len(), |g| g.first);
        &self.placed[self.groups[group].first..end]
    }

    /// Blocks of the tile of one group.
    pub fn blocks_of(&self, group: usize) -> &[Block] {
        let end = self.groups.get(group + 1).map_or(self.blocks.len(), |g| g.block);
        &self.blocks[self.groups[group].block..end]
    }

    /// Where to part `groups` so that each half has as many markers, if they have more than `leaf`.
    pub fn middle(&self, groups: &Range<usize>, leaf: usize) -> Option<usize> {
        let own = &self.groups[groups.clone()];
        let first = own.first()?.first;
        let end = self.groups.get(groups.end).map_or(self.placed.len(), |g| g.first);
        if end - first <= leaf || own.len() < 2 {
            return None;
        }
        let half = own.partition_point(|g| g.first < first + (end - first) / 2);
        Some(groups.start + half.clamp(1, own.len() - 1))
    }

    /// First and last of the groups whose tiles reach a slot that is in use.
    pub fn reach_of_slot(&self, slot: usize) -> RangeInclusive<usize> {
        let blocks = &self.by_slot[self.slot_start[slot] as usize..self.slot_start[slot + 1] as usize];
        let group = |b: Option<&u32>| b.map_or(usize::MAX, |&b| self.blocks[b as usize].group as usize);
        group(blocks.first())..=group(blocks.last())
    }

    /// Blocks of one slot.
    pub fn blocks_of_slot(&self, slot: usize) -> impl Iterator<Item = &Block> {
        self.by_slot[self.slot_start[slot] as usize..self.slot_start[slot + 1] as usize]
            .iter()
            .map(|&b| &self.blocks[b as usize])
    }
}
