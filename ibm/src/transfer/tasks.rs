//! Groups shared among threads.

use super::{Node, brick, collect};
use crate::placement::Placement;
use crate::threads;
use lbm_ibm_coupling::BRICK_NODES;
use std::ops::Range;

/// Markers per task: below that another thread is not worth waking.
const MARKERS: usize = 1024;

/// Most markers of a task that spreads: the longer its range of groups, the more slots are its own; all of them for one thread.
pub fn leaf(placement: &Placement) -> usize {
    match threads::count() {
        1 => usize::MAX,
        threads => MARKERS.max(placement.placed.len() / (2 * threads)),
    }
}

/// A range of groups, their tiles, and the slots from the first one's on.
pub struct Part<'a> {
    pub groups: Range<usize>,
    pub slot: usize,
    pub tiles: &'a mut [Node],
    pub field: [&'a mut [f64]; 3],
    /// Whether a slot is added up.
    pub done: &'a mut [bool],
}

impl Part<'_> {
    /// Calls `work` with each group's number and tile, and adds up the slots that no other group reaches.
    pub fn spread(self, placement: &Placement, leaf: usize, work: &(impl Fn(usize, &mut [Node]) + Sync)) {
        let Self {
            groups,
            slot: slot0,
            tiles,
            mut field,
            done,
        } = self;
        let Some(head) = placement.groups.get(groups.start) else {
            return;
        };
        if let Some(middle) = placement.middle(&groups, leaf) {
            let right = &placement.groups[middle];
            let (tiles_left, tiles_right) = tiles.split_at_mut(right.tile - head.tile);
            let (done_left, done_right) = done.split_at_mut(right.slot - slot0);
            let [x, y, z] = field;
            let [x, y, z] = [x, y, z].map(|f| f.split_at_mut((right.slot - slot0) * BRICK_NODES));
            let left = Part {
                groups: groups.start..middle,
                slot: slot0,
                tiles: tiles_left,
                field: [x.0, y.0, z.0],
                done: done_left,
            };
            let right = Part {
                groups: middle..groups.end,
                slot: right.slot,
                tiles: tiles_right,
                field: [x.1, y.1, z.1],
                done: done_right,
            };
            threads::join(
                || left.spread(placement, leaf, work),
                || right.spread(placement, leaf, work),
            );
            return;
        }
        for g in groups.clone() {
            let group = &placement.groups[g];
            let tile = group.tile - head.tile;
            work(g, &mut tiles[tile..tile + group.nodes()]);
            let reach = placement.reach_of_slot(group.slot);
            if *reach.start() >= groups.start && *reach.end() == g {
                done[group.slot - slot0] = true;
                collect(
                    placement,
                    group.slot,
                    (tiles, head.tile),
                    brick(&mut field, group.slot - slot0),
                );
            }
        }
    }
}

/// Calls `work` with each group's number, a tile and its markers. The groups of a task share a tile.
pub fn each_group<T: Send>(
    placement: &Placement,
    groups: Range<usize>,
    tiles: &mut [Node],
    markers: &mut [T],
    work: &(impl Fn(usize, &mut [Node], &mut [T]) + Sync),
) {
    let Some(head) = placement.groups.get(groups.start) else {
        return;
    };
    if let Some(middle) = placement.middle(&groups, MARKERS) {
        let right = &placement.groups[middle];
        let (tiles_left, tiles_right) = tiles.split_at_mut(right.tile - head.tile);
        let (left_markers, right_markers) = markers.split_at_mut(right.first - head.first);
        threads::join(
            || each_group(placement, groups.start..middle, tiles_left, left_markers, work),
            || each_group(placement, middle..groups.end, tiles_right, right_markers, work),
        );
        return;
    }
    let mut left = markers;
    for g in groups {
        let (own, others) = left.split_at_mut(placement.markers_of(g).len());
        work(g, &mut tiles[..placement.groups[g].nodes()], own);
        left = others;
    }
}
