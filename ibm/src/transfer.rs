//! The inner loops: markers against tiles, tiles against bricks.
//!
//! A tile is a dense copy of the nodes around the markers of one brick, so that no stencil is ever cut. When interpolating,
//! the groups of a task take turns with one tile, which stays in cache. When spreading, each group adds to its own tile
//! and each brick adds up the tiles that reach it, both in a fixed order: no two tasks write to the same place, and the
//! sums are the same for any number of threads. Most bricks are added up as soon as the last tile that reaches them is
//! there, while those tiles are still in cache.

mod tasks;

use crate::kernel::{Cosine, Cubic, Delta, Hat, Kernel, Peskin, Quadratic, Roma, Six, Smoothed};
use crate::placement::{Block, Group, Placed, Placement};
use crate::threads;
use lbm_ibm_coupling::{BRICK_EDGE, BRICK_NODES, Work, on_widest, prefetch};
use std::marker::PhantomData;
use tasks::{Part, each_group};

/// Three components and one to fill a vector register; none lies across two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(crate) struct Node(pub [f64; 4]);

/// Room that is kept between the passes.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    tiles: Vec<Node>,
    /// Slots that are added up.
    done: Vec<bool>,
}

/// Rows of a brick.
const BRICK_ROWS: usize = BRICK_EDGE * BRICK_EDGE;
/// Slots per task.
const SLOTS: usize = 32;

/// First node of a row of a block in its brick (row `bit` of it) and in its tile.
#[inline(always)]
fn row(block: &Block, group: &Group, bit: usize) -> (usize, usize) {
    let (j, k) = (bit % BRICK_EDGE, bit / BRICK_EDGE);
    let [x, y, z] = block.local.map(usize::from);
    let [tx, ty, tz] = block.tile.map(usize::from);
    let tile = ((tz + k - z) * group.size[1] + ty + j - y) * group.size[0] + tx;
    (bit * BRICK_EDGE + x, tile)
}

/// The bits that are set, in ascending order.
#[inline(always)]
fn bits(mut left: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = left.trailing_zeros() as usize;
        left &= left.wrapping_sub(1);
        (bit < 64).then_some(bit)
    })
}

/// Sets the rows of a tile that stencils touch to zero.
#[inline(always)]
fn clear(group: &Group, tile: &mut [Node]) {
    for (k, rows) in group.rows[..group.size[2]].iter().enumerate() {
        for j in bits(u64::from(*rows)) {
            tile[(k * group.size[1] + j) * group.size[0]..][..group.size[0]].fill(Node::default());
        }
    }
}

/// First node of a marker's stencil in the tile of its group.
#[inline(always)]
fn corner(p: &Placed, group: &Group) -> usize {
    let [x, y, z] = [0, 1, 2].map(|a| (p.corner[a] - group.corner[a]) as usize);
    (z * group.size[1] + y) * group.size[0] + x
}

/// Asks for the rows of bricks that group `g` reaches, if there is such a group.
#[inline(always)]
fn fetch(placement: &Placement, g: usize, field: [&[f64]; 3]) {
    if g >= placement.groups.len() {
        return;
    }
    for block in placement.blocks_of(g) {
        let brick = field.map(|a| &a[block.slot as usize * BRICK_NODES..][..BRICK_NODES]);
        for bit in bits(block.rows) {
            brick.iter().for_each(|a| prefetch(&a[bit % BRICK_ROWS * BRICK_EDGE]));
        }
    }
}

#[inline(always)]
fn load_tile(placement: &Placement, g: usize, field: [&[f64]; 3], tile: &mut [Node]) {
    let group = &placement.groups[g];
    clear(group, tile);
    for block in placement.blocks_of(g) {
        let [u, v, w] = field.map(|a| &a[block.slot as usize * BRICK_NODES..][..BRICK_NODES]);
        let n = usize::from(block.size[0]);
        for bit in bits(block.rows) {
            let (from, to) = row(block, group, bit);
            let (u, v, w) = (&u[from..][..n], &v[from..][..n], &w[from..][..n]);
            for (i, node) in tile[to..][..n].iter_mut().enumerate() {
                *node = Node([u[i], v[i], w[i], 0.0]);
            }
        }
    }
}

#[inline(always)]
fn gather<const S: usize, D: Delta<S>>(p: &Placed, group: &Group, tile: &[Node]) -> [f64; 3] {
    let [wx, wy, wz] = p.f.map(D::weights);
    let (row, layer) = (group.size[0], group.size[0] * group.size[1]);
    let corner = corner(p, group);
    let mut sum = [0.0; 4];
    for k in 0..S {
        for j in 0..S {
            let nodes = &tile[corner + k * layer + j * row..][..S];
            let mut line = [0.0; 4];
            for i in 0..S {
                for a in 0..4 {
                    line[a] += wx[i] * nodes[i].0[a];
                }
            }
            let w = wz[k] * wy[j];
            for a in 0..4 {
                sum[a] += w * line[a];
            }
        }
    }
    [sum[0], sum[1], sum[2]]
}

#[inline(always)]
fn scatter<const S: usize, D: Delta<S>>(p: &Placed, force: Node, group: &Group, tile: &mut [Node]) {
    let [wx, wy, wz] = p.f.map(D::weights);
    let (row, layer) = (group.size[0], group.size[0] * group.size[1]);
    let corner = corner(p, group);
    for k in 0..S {
        for j in 0..S {
            let nodes = &mut tile[corner + k * layer + j * row..][..S];
            let w = wz[k] * wy[j];
            let f = force.0.map(|f| w * f);
            for i in 0..S {
                for a in 0..4 {
                    nodes[i].0[a] += wx[i] * f[a];
                }
            }
        }
    }
}

/// A `field` of all slots at all markers, in brick order.
pub(crate) fn interpolate<const S: usize, D: Delta<S>>(
    placement: &Placement,
    field: [&[f64]; 3],
    scratch: &mut Scratch,
    out: &mut [[f64; 3]],
) {
    scratch.tiles.resize(placement.tile_nodes, Node::default());
    let work = |g: usize, tile: &mut [Node], out: &mut [[f64; 3]]| {
        on_widest(Gather::<S, D> {
            placement,
            g,
            field,
            tile,
            out,
            kernel: PhantomData,
        });
    };
    each_group(placement, 0..placement.groups.len(), &mut scratch.tiles, out, &work);
}

/// Adds the forces of all markers (`force(m)`, N) to a `field` of all slots.
pub(crate) fn spread<const S: usize, D: Delta<S>>(
    placement: &Placement,
    force: impl Fn(usize) -> Node + Sync,
    Scratch { tiles, done }: &mut Scratch,
    mut field: [&mut [f64]; 3],
) {
    tiles.resize(placement.tile_nodes, Node::default());
    let work = |g: usize, tile: &mut [Node]| {
        on_widest(Scatter::<S, D, _> {
            placement,
            g,
            force: &force,
            tile,
            kernel: PhantomData,
        });
    };
    done.clear();
    done.resize(field[0].len() / BRICK_NODES, false);
    let part = Part {
        groups: 0..placement.groups.len(),
        slot: 0,
        tiles: &mut *tiles,
        field: field.each_mut().map(|f| &mut **f),
        done: &mut *done,
    };
    part.spread(placement, tasks::leaf(placement), &work);
    let (tiles, done) = (&*tiles, &*done);
    threads::rows(field, BRICK_NODES, 0, SLOTS, &|first, mut field| {
        for s in 0..field[0].len() / BRICK_NODES {
            if !done[first + s] {
                collect(placement, first + s, (tiles, 0), brick(&mut field, s));
            }
        }
    });
}

/// [`interpolate`] by a kernel known at run time.
pub(crate) fn interpolate_by(
    kernel: Kernel,
    p: &Placement,
    field: [&[f64]; 3],
    tiles: &mut Scratch,
    out: &mut [[f64; 3]],
) {
    match kernel {
        Kernel::TwoPoint => interpolate::<2, Hat>(p, field, tiles, out),
        Kernel::RomaThree => interpolate::<3, Roma>(p, field, tiles, out),
        Kernel::SplineThree => interpolate::<3, Quadratic>(p, field, tiles, out),
        Kernel::PeskinFour => interpolate::<4, Peskin>(p, field, tiles, out),
        Kernel::CosineFour => interpolate::<4, Cosine>(p, field, tiles, out),
        Kernel::SplineFour => interpolate::<4, Cubic>(p, field, tiles, out),
        Kernel::SmoothedFour => interpolate::<5, Smoothed>(p, field, tiles, out),
        Kernel::SixPoint => interpolate::<6, Six>(p, field, tiles, out),
    }
}

/// [`spread`] by a kernel known at run time.
pub(crate) fn spread_by(
    kernel: Kernel,
    p: &Placement,
    force: impl Fn(usize) -> Node + Sync,
    tiles: &mut Scratch,
    field: [&mut [f64]; 3],
) {
    match kernel {
        Kernel::TwoPoint => spread::<2, Hat>(p, force, tiles, field),
        Kernel::RomaThree => spread::<3, Roma>(p, force, tiles, field),
        Kernel::SplineThree => spread::<3, Quadratic>(p, force, tiles, field),
        Kernel::PeskinFour => spread::<4, Peskin>(p, force, tiles, field),
        Kernel::CosineFour => spread::<4, Cosine>(p, force, tiles, field),
        Kernel::SplineFour => spread::<4, Cubic>(p, force, tiles, field),
        Kernel::SmoothedFour => spread::<5, Smoothed>(p, force, tiles, field),
        Kernel::SixPoint => spread::<6, Six>(p, force, tiles, field),
    }
}

/// Velocities at the markers of group `g`.
struct Gather<'a, const S: usize, D> {
    placement: &'a Placement,
    g: usize,
    field: [&'a [f64]; 3],
    tile: &'a mut [Node],
    out: &'a mut [[f64; 3]],
    kernel: PhantomData<D>,
}

impl<const S: usize, D: Delta<S>> Work for Gather<'_, S, D> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        fetch(self.placement, self.g + 1, self.field);
        load_tile(self.placement, self.g, self.field, self.tile);
        let group = &self.placement.groups[self.g];
        for (u, p) in self.out.iter_mut().zip(self.placement.markers_of(self.g)) {
            *u = gather::<S, D>(p, group, self.tile);
        }
    }
}

/// Forces of the markers of group `g` on its tile.
struct Scatter<'a, const S: usize, D, F> {
    placement: &'a Placement,
    g: usize,
    force: &'a F,
    tile: &'a mut [Node],
    kernel: PhantomData<D>,
}

impl<const S: usize, D: Delta<S>, F: Fn(usize) -> Node> Work for Scatter<'_, S, D, F> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let group = &self.placement.groups[self.g];
        clear(group, self.tile);
        for p in self.placement.markers_of(self.g) {
            scatter::<S, D>(p, (self.force)(p.marker as usize), group, self.tile);
        }
    }
}

/// Adds the tiles that reach a brick to it.
struct Collect<'a> {
    placement: &'a Placement,
    slot: usize,
    /// And the number of the first of them in the store of all tiles.
    tiles: (&'a [Node], usize),
    brick: [&'a mut [f64]; 3],
}

impl Work for Collect<'_> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let [fx, fy, fz] = self.brick;
        for block in self.placement.blocks_of_slot(self.slot) {
            let group = &self.placement.groups[block.group as usize];
            let tile = &self.tiles.0[group.tile - self.tiles.1..];
            let n = usize::from(block.size[0]);
            for bit in bits(block.rows) {
                let (to, from) = row(block, group, bit);
                let (x, y, z) = (&mut fx[to..][..n], &mut fy[to..][..n], &mut fz[to..][..n]);
                for (i, node) in tile[from..][..n].iter().enumerate() {
                    x[i] += node.0[0];
                    y[i] += node.0[1];
                    z[i] += node.0[2];
                }
            }
        }
    }
}

/// Adds the tiles that reach a slot to its brick.
fn collect(placement: &Placement, slot: usize, tiles: (&[Node], usize), brick: [&mut [f64]; 3]) {
    on_widest(Collect {
        placement,
        slot,
        tiles,
        brick,
    });
}

/// One slot of three fields.
fn brick<'a>(field: &'a mut [&mut [f64]; 3], slot: usize) -> [&'a mut [f64]; 3] {
    field
        .each_mut()
        .map(|f| &mut f[slot * BRICK_NODES..(slot + 1) * BRICK_NODES])
}
