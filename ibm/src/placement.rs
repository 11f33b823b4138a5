//! Markers on the grid: sorted by brick, with the part of the grid that the markers of each brick touch.

use crate::axis::{Axis, BEFORE, SEGMENTS, Segment};
use crate::table::Table;
use crate::threads;
use lbm_ibm_coupling::{BRICK_EDGE, Bricks, Grid, Soa3Ref, Vec3, Work, on_widest};

/// Markers per task.
const LEAF: usize = 2048;
/// Markers at a time.
const BATCH: usize = 64;
/// Brick of a marker that is outside the grid.
const OUTSIDE: u32 = u32::MAX;

/// Where a marker is: the brick of the lower corner of its stencil, the corner in that brick (below zero at a wall),
/// and the remainders that the kernel turns into weights.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Home {
    pub f: [f64; 3],
    pub brick: u32,
    pub corner: [i8; 3],
}

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
    /// First of its blocks; the next group's first ends it.
    pub block: usize,
    /// Rows of the tile that stencils touch: bit y of number z.
    pub rows: [u16; SEGMENTS],
}

/// A box of nodes that a tile and a brick share.
#[derive(Clone, Debug)]
pub(crate) struct Block {
    pub brick: [usize; 3],
    pub slot: usize,
    pub group: usize,
    /// Corner in the brick.
    pub local: [usize; 3],
    /// Corner in the tile.
    pub tile: [usize; 3],
    pub size: [usize; 3],
    /// Rows of the brick that stencils touch: bit `8 z + y`.
    pub rows: u64,
}

/// The grid as markers see it.
struct Spots<'a> {
    axes: &'a [Axis; 3],
    per_spacing: f64,
    support: usize,
    counts: [usize; 3],
}

/// Finds the homes of the markers from number `first` on, on several threads where there are many.
fn homes(out: &mut [Home], first: usize, position: &(impl Fn(usize) -> [f64; 3] + Sync), spots: &Spots<'_>) {
    if out.len() <= LEAF {
        return on_widest(Homes {
            out,
            first,
            position,
            spots,
        });
    }
    let half = out.len() / 2;
    let (a, b) = out.split_at_mut(half);
    threads::join(
        || homes(a, first, position, spots),
        || homes(b, first + half, position, spots),
    );
}

struct Homes<'a, P> {
    out: &'a mut [Home],
    first: usize,
    position: &'a P,
    spots: &'a Spots<'a>,
}

impl<P: Fn(usize) -> [f64; 3]> Work for Homes<'_, P> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Spots {
            axes,
            per_spacing,
            support,
            counts,
        } = *self.spots;
        for (n, out) in self.out.chunks_mut(BATCH).enumerate() {
            let first = self.first + n * BATCH;
            let mut x = [[0.0; BATCH]; 3];
            for l in 0..out.len() {
                let p = (self.position)(first + l);
                (x[0][l], x[1][l], x[2][l]) = (p[0], p[1], p[2]);
            }
            let mut lower = [[0i32; BATCH]; 3];
            let mut within = [true; BATCH];
            for a in 0..3 {
                for l in 0..BATCH {
                    let (corner, f) = axes[a].corner(x[a][l], per_spacing, support);
                    within[l] &= axes[a].holds(corner);
                    lower[a][l] = corner as i32;
                    x[a][l] = f;
                }
            }
            for (l, home) in out.iter_mut().enumerate() {
                let mut brick = [0; 3];
                home.brick = 0;
                for a in 0..3 {
                    if within[l] {
                        let corner = lower[a][l] as usize;
                        brick[a] = corner / BRICK_EDGE;
                        home.corner[a] = (corner % BRICK_EDGE) as i8;
                        home.f[a] = x[a][l];
                        continue;
                    }
                    // Across a period, at a wall, or outside.
                    let x = (self.position)(first + l)[a];
                    let Some((b, corner, f)) = axes[a].home(x, per_spacing, support) else {
                        home.brick = OUTSIDE;
                        break;
                    };
                    (brick[a], home.corner[a], home.f[a]) = (b, corner, f);
                }
                if home.brick != OUTSIDE {
                    home.brick = ((brick[2] * counts[1] + brick[1]) * counts[0] + brick[0]) as u32;
                }
            }
        }
    }
}

/// All markers on the grid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Placement {
    homes: Vec<Home>,
    start: Vec<u32>,
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
        self.locate(table.len(), &|m| table.position(m, x), grid, support, bricks)?;
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
        let axes = Axis::all(grid);
        let counts = bricks.counts();
        self.homes.resize(count, Home::default());
        let spots = Spots {
            axes: &axes,
            per_spacing: 1.0 / grid.spacing,
            support,
            counts,
        };
        homes(&mut self.homes, 0, position, &spots);
        if let Some(m) = self.homes.iter().position(|h| h.brick == OUTSIDE) {
            return Err((m, Vec3::from(position(m))));
        }
        self.sort(counts.iter().product());
        self.group(counts, support, &axes);
        for block in &self.blocks {
            bricks.want_rows(bricks.index(block.brick), block.rows);
        }
        Ok(())
    }

    /// Stable counting sort of the markers by brick.
    fn sort(&mut self, bricks: usize) {
        self.start.clear();
        self.start.resize(bricks + 1, 0);
        for h in &self.homes {
            self.start[h.brick as usize + 1] += 1;
        }
        for b in 0..bricks {
            self.start[b + 1] += self.start[b];
        }
        self.placed.resize(self.homes.len(), Placed::default());
        self.rank.resize(self.homes.len(), 0);
        for (m, h) in self.homes.iter().enumerate() {
            let next = &mut self.start[h.brick as usize];
            self.placed[*next as usize] = Placed {
                f: h.f,
                marker: m as u32,
                corner: h.corner,
            };
            self.rank[m] = *next;
            *next += 1;
        }
    }

    /// Groups of markers, their tiles, and the bricks these touch.
    fn group(&mut self, counts: [usize; 3], support: usize, axes: &[Axis; 3]) {
        self.groups.clear();
        self.blocks.clear();
        self.tile_nodes = 0;
        let mut first = 0;
        // After the sort each brick's start has moved to its end.
        for b in 0..counts.iter().product() {
            let end = self.start[b] as usize;
            if end == first {
                continue;
            }
            let (mut low, mut high) = ([i8::MAX; 3], [i8::MIN; 3]);
            let mut touched = [0u16; SEGMENTS];
            for p in &self.placed[first..end] {
                for a in 0..3 {
                    low[a] = low[a].min(p.corner[a]);
                    high[a] = high[a].max(p.corner[a]);
                }
                let rows = ((1 << support) - 1) << (p.corner[1] + BEFORE);
                touched[(p.corner[2] + BEFORE) as usize..][..support]
                    .iter_mut()
                    .for_each(|r| *r |= rows);
            }
            let mut group = Group {
                first,
                corner: low,
                size: [0, 1, 2].map(|a| (high[a] - low[a]) as usize + support),
                tile: self.tile_nodes,
                block: self.blocks.len(),
                rows: [0; SEGMENTS],
            };
            let [y, z] = [1, 2].map(|a| (low[a] + BEFORE) as usize);
            for (to, from) in group.rows.iter_mut().zip(&touched[z..]) {
                *to = from >> y;
            }
            self.tile_nodes += group.size.iter().product::<usize>();
            let brick = [b % counts[0], b / counts[0] % counts[1], b / (counts[0] * counts[1])];
            self.cut(&group, brick, axes);
            self.groups.push(group);
            first = end;
        }
    }

    fn cut(&mut self, group: &Group, brick: [usize; 3], axes: &[Axis; 3]) {
        let mut segments = [[Segment::default(); SEGMENTS]; 3];
        let mut n = [0; 3];
        for a in 0..3 {
            n[a] = axes[a].segments(brick[a], group.corner[a], group.size[a], &mut segments[a]);
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
                        brick: [x.brick, y.brick, z.brick],
                        slot: 0,
                        group: self.groups.len(),
                        local: [x.local, y.local, z.local],
                        tile: [x.tile, y.tile, z.tile],
                        size: [x.size, y.size, z.size],
                        rows,
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
        for block in &mut self.blocks {
            // Every brick of a block has just been taken into use.
            block.slot = bricks.slot(block.brick).unwrap_or_default();
            self.slot_start[block.slot + 2] += 1;
        }
        for s in 0..slots {
            self.slot_start[s + 2] += self.slot_start[s + 1];
        }
        self.by_slot.resize(self.blocks.len(), 0);
        for (b, block) in self.blocks.iter().enumerate() {
            let next = &mut self.slot_start[block.slot + 1];
            self.by_slot[*next as usize] = b as u32;
            *next += 1;
        }
    }

    /// Markers of one group.
    pub fn markers_of(&self, group: usize) -> &[Placed] {
        let end = self.groups.get(group + 1).map_or(self.placed.len(), |g| g.first);
        &self.placed[self.groups[group].first..end]
    }

    /// Blocks of one slot.
    pub fn blocks_of_slot(&self, slot: usize) -> impl Iterator<Item = &Block> {
        self.by_slot[self.slot_start[slot] as usize..self.slot_start[slot + 1] as usize]
            .iter()
            .map(|&b| &self.blocks[b as usize])
    }
}
