//! The inner loops: markers against tiles, tiles against bricks.
//!
//! A tile is a dense copy of the nodes around the markers of one brick, so that no stencil is ever cut. When spreading,
//! each group adds to its own tile and each brick then adds up the tiles that reach it, both in a fixed order: no two
//! tasks write to the same place, and the sums are the same for any number of threads.

use crate::kernel::{Cosine, Cubic, Delta, Hat, Kernel, Peskin, Quadratic, Roma};
use crate::placement::{Block, Group, Placed, Placement};
use crate::threads;
use lbm_ibm_coupling::{BRICK_EDGE, BRICK_NODES};

/// Three components and one to fill a vector register.
pub(crate) type Node = [f64; 4];

/// Groups per task.
const GROUPS: usize = 4;
/// Slots per task.
const SLOTS: usize = 8;

/// First node of a row of a block in its brick and in its tile.
#[inline]
fn row(block: &Block, group: &Group, j: usize, k: usize) -> (usize, usize) {
    let [x, y, z] = block.local;
    let brick = ((z + k) * BRICK_EDGE + y + j) * BRICK_EDGE + x;
    let [tx, ty, tz] = block.tile;
    (brick, ((tz + k) * group.size[1] + ty + j) * group.size[0] + tx)
}

/// First node of a marker's stencil in the tile of its group.
#[inline]
fn corner(p: &Placed, group: &Group) -> usize {
    let [x, y, z] = [0, 1, 2].map(|a| (p.corner[a] - group.corner[a]) as usize);
    (z * group.size[1] + y) * group.size[0] + x
}

fn load_tile(placement: &Placement, g: usize, field: [&[f64]; 3], tile: &mut [Node]) {
    tile.fill([0.0; 4]);
    let group = &placement.groups[g];
    let end = placement.groups.get(g + 1).map_or(placement.blocks.len(), |n| n.block);
    for block in &placement.blocks[group.block..end] {
        let [u, v, w] = field.map(|a| &a[block.slot * BRICK_NODES..][..BRICK_NODES]);
        for k in 0..block.size[2] {
            for j in 0..block.size[1] {
                let (from, to) = row(block, group, j, k);
                let n = block.size[0];
                let (u, v, w) = (&u[from..][..n], &v[from..][..n], &w[from..][..n]);
                for (i, node) in tile[to..][..n].iter_mut().enumerate() {
                    *node = [u[i], v[i], w[i], 0.0];
                }
            }
        }
    }
}

#[inline]
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
                    line[a] += wx[i] * nodes[i][a];
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

#[inline]
fn scatter<const S: usize, D: Delta<S>>(p: &Placed, force: Node, group: &Group, tile: &mut [Node]) {
    let [wx, wy, wz] = p.f.map(D::weights);
    let (row, layer) = (group.size[0], group.size[0] * group.size[1]);
    let corner = corner(p, group);
    for k in 0..S {
        for j in 0..S {
            let nodes = &mut tile[corner + k * layer + j * row..][..S];
            let w = wz[k] * wy[j];
            let f = force.map(|f| w * f);
            for i in 0..S {
                for a in 0..4 {
                    nodes[i][a] += wx[i] * f[a];
                }
            }
        }
    }
}

/// A `field` of all slots at all markers, in brick order.
pub(crate) fn interpolate<const S: usize, D: Delta<S>>(
    placement: &Placement,
    field: [&[f64]; 3],
    tiles: &mut [Node],
    out: &mut [[f64; 3]],
) {
    let work = |g: usize, tile: &mut [Node], out: &mut [[f64; 3]]| {
        load_tile(placement, g, field, tile);
        let group = &placement.groups[g];
        for (u, p) in out.iter_mut().zip(placement.markers_of(g)) {
            *u = gather::<S, D>(p, group, tile);
        }
    };
    each_group(&placement.groups, 0, tiles, out, &work);
}

/// Adds the forces of all markers (`force(m)`, N) to a `field` of all slots.
pub(crate) fn spread<const S: usize, D: Delta<S>>(
    placement: &Placement,
    force: impl Fn(usize) -> Node + Sync,
    tiles: &mut [Node],
    field: [&mut [f64]; 3],
) {
    let work = |g: usize, tile: &mut [Node], _: &mut [()]| {
        tile.fill([0.0; 4]);
        let group = &placement.groups[g];
        for p in placement.markers_of(g) {
            scatter::<S, D>(p, force(p.marker as usize), group, tile);
        }
    };
    // Units take no memory: only tiles are written.
    each_group(
        &placement.groups,
        0,
        tiles,
        &mut vec![(); placement.placed.len()],
        &work,
    );
    let tiles = &*tiles;
    threads::rows(field, BRICK_NODES, 0, SLOTS, &|first, [fx, fy, fz]| {
        for s in 0..fx.len() / BRICK_NODES {
            let range = s * BRICK_NODES..(s + 1) * BRICK_NODES;
            let brick = [&mut fx[range.clone()], &mut fy[range.clone()], &mut fz[range]];
            collect(placement, first + s, tiles, brick);
        }
    });
}

/// [`interpolate`] by a kernel known at run time.
pub(crate) fn interpolate_by(
    kernel: Kernel,
    p: &Placement,
    field: [&[f64]; 3],
    tiles: &mut [Node],
    out: &mut [[f64; 3]],
) {
    match kernel {
        Kernel::TwoPoint => interpolate::<2, Hat>(p, field, tiles, out),
        Kernel::RomaThree => interpolate::<3, Roma>(p, field, tiles, out),
        Kernel::SplineThree => interpolate::<3, Quadratic>(p, field, tiles, out),
        Kernel::PeskinFour => interpolate::<4, Peskin>(p, field, tiles, out),
        Kernel::CosineFour => interpolate::<4, Cosine>(p, field, tiles, out),
        Kernel::SplineFour => interpolate::<4, Cubic>(p, field, tiles, out),
    }
}

/// [`spread`] by a kernel known at run time.
pub(crate) fn spread_by(
    kernel: Kernel,
    p: &Placement,
    force: impl Fn(usize) -> Node + Sync,
    tiles: &mut [Node],
    field: [&mut [f64]; 3],
) {
    match kernel {
        Kernel::TwoPoint => spread::<2, Hat>(p, force, tiles, field),
        Kernel::RomaThree => spread::<3, Roma>(p, force, tiles, field),
        Kernel::SplineThree => spread::<3, Quadratic>(p, force, tiles, field),
        Kernel::PeskinFour => spread::<4, Peskin>(p, force, tiles, field),
        Kernel::CosineFour => spread::<4, Cosine>(p, force, tiles, field),
        Kernel::SplineFour => spread::<4, Cubic>(p, force, tiles, field),
    }
}

/// Adds the tiles that reach a brick to it.
fn collect(placement: &Placement, slot: usize, tiles: &[Node], [fx, fy, fz]: [&mut [f64]; 3]) {
    for block in placement.blocks_of_slot(slot) {
        let group = &placement.groups[block.group];
        let tile = &tiles[group.tile..];
        for k in 0..block.size[2] {
            for j in 0..block.size[1] {
                let (to, from) = row(block, group, j, k);
                let n = block.size[0];
                let (x, y, z) = (&mut fx[to..][..n], &mut fy[to..][..n], &mut fz[to..][..n]);
                for (i, node) in tile[from..][..n].iter().enumerate() {
                    x[i] += node[0];
                    y[i] += node[1];
                    z[i] += node[2];
                }
            }
        }
    }
}

/// Calls `work` with each group's number, tile and markers.
fn each_group<T: Send>(
    groups: &[Group],
    first: usize,
    tiles: &mut [Node],
    markers: &mut [T],
    work: &(impl Fn(usize, &mut [Node], &mut [T]) + Sync),
) {
    let Some(head) = groups.first() else {
        return;
    };
    let (tile0, marker0) = (head.tile, head.first);
    if groups.len() > GROUPS {
        let half = groups.len() / 2;
        let (left, right) = groups.split_at(half);
        let (tiles_left, tiles_right) = tiles.split_at_mut(right[0].tile - tile0);
        let (left_markers, right_markers) = markers.split_at_mut(right[0].first - marker0);
        threads::join(
            || each_group(left, first, tiles_left, left_markers, work),
            || each_group(right, first + half, tiles_right, right_markers, work),
        );
        return;
    }
    for (i, group) in groups.iter().enumerate() {
        let next = groups.get(i + 1);
        let tile_end = next.map_or(tiles.len(), |n| n.tile - tile0);
        let marker_end = next.map_or(markers.len(), |n| n.first - marker0);
        let (tile, own) = (
            &mut tiles[group.tile - tile0..tile_end],
            &mut markers[group.first - marker0..marker_end],
        );
        work(first + i, tile, own);
    }
}
