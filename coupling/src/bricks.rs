//! Velocity and force where bodies touch the fluid.

use crate::lines::{Lines, prefetch};
use crate::threads::join;
use crate::{Grid, Vec3};

/// Nodes along each edge of a brick.
pub const EDGE: usize = 8;
/// Nodes of a brick.
pub const NODES: usize = EDGE * EDGE * EDGE;

/// Slots per task.
const SLOTS: usize = 64;
const NONE: u32 = u32::MAX;

/// Fluid velocity (m/s) and force (N per grid node) in the bricks of 8 x 8 x 8 nodes that bodies touch.
///
/// A brick that is in use has a *slot*; slots are in ascending brick order. Inside a slot node `(i, j, k)` of the brick
/// has index `(k * 8 + j) * 8 + i`. The last brick of a direction may reach past the grid; those nodes mean nothing.
///
/// Bodies are surfaces: they touch few of the 64 rows of a brick, `(j, k)` bit `8 k + j` of [`Bricks::rows`]. Forces of the
/// others are zero, and nobody reads their velocities, so that a fluid need not fill them in.
#[derive(Clone, Debug)]
pub struct Bricks {
    counts: [usize; 3],
    slot_of: Vec<u32>,
    old_slot_of: Vec<u32>,
    wanted: Vec<u64>,
    /// Rows in use by brick, and those whose forces may not be zero.
    rows: Vec<u64>,
    dirty: Vec<u64>,
    active: Vec<u32>,
    velocity: [Lines; 3],
    force: [Lines; 3],
    spare: Lines,
}

impl Bricks {
    /// No brick in use.
    pub fn new(grid: &Grid) -> Self {
        let counts = grid.shape.map(|n| n.div_ceil(EDGE));
        let total = counts.iter().product();
        Self {
            counts,
            slot_of: vec![NONE; total],
            old_slot_of: vec![NONE; total],
            wanted: vec![0; total],
            rows: vec![0; total],
            dirty: vec![0; total],
            active: Vec::new(),
            velocity: Default::default(),
            force: Default::default(),
            spare: Lines::default(),
        }
    }

    /// Bricks in x, y, z.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// Number of slots in use.
    pub fn len(&self) -> usize {
        self.active.len()
    }

    /// Whether no brick is in use.
    pub fn is_empty(&self) -> bool {
        self.active.is_empty()
    }

    /// Brick coordinates of a slot.
    pub fn brick(&self, slot: usize) -> [usize; 3] {
        let b = self.active[slot] as usize;
        let [bx, by, _] = self.counts;
        [b % bx, b / bx % by, b / (bx * by)]
    }

    /// Slot of a brick, if it is in use.
    #[inline]
    pub fn slot(&self, brick: [usize; 3]) -> Option<usize> {
        self.slot_of(self.index(brick))
    }

    /// Slot of a brick by its linear number, if it is in use.
    #[inline]
    pub fn slot_of(&self, index: usize) -> Option<usize> {
        let s = self.slot_of[index];
        (s != NONE).then_some(s as usize)
    }

    /// Linear number of a brick, x fastest.
    #[inline]
    pub fn index(&self, [bx, by, bz]: [usize; 3]) -> usize {
        (bz * self.counts[1] + by) * self.counts[0] + bx
    }

    /// Rows of a slot that are in use: bit `8 k + j`.
    #[inline]
    pub fn rows(&self, slot: usize) -> u64 {
        self.rows[self.active[slot] as usize]
    }

    /// Velocity components of all slots, m/s.
    pub fn velocity(&self) -> [&[f64]; 3] {
        self.velocity.each_ref().map(Lines::numbers)
    }

    /// Velocity components of all slots, m/s, for the fluid to fill.
    pub fn velocity_mut(&mut self) -> [&mut [f64]; 3] {
        self.velocity.each_mut().map(Lines::numbers_mut)
    }

    /// Force components of all slots, N per grid node.
    pub fn force(&self) -> [&[f64]; 3] {
        self.force.each_ref().map(Lines::numbers)
    }

    /// Force components of all slots, N per grid node, for the exchange to fill.
    pub fn force_mut(&mut self) -> [&mut [f64]; 3] {
        self.force.each_mut().map(Lines::numbers_mut)
    }

    /// Velocity to write and force to read: what a fluid needs to fill in the velocity at half a step of force.
    pub fn velocity_mut_and_force(&mut self) -> ([&mut [f64]; 3], [&[f64]; 3]) {
        let velocity = self.velocity.each_mut().map(Lines::numbers_mut);
        (velocity, self.force.each_ref().map(Lines::numbers))
    }

    /// Sets all forces to zero.
    pub fn clear_force(&mut self) {
        let [x, y, z] = self.force.each_mut().map(Lines::numbers_mut);
        Clear {
            active: &self.active,
            brick: 0,
            dirty: &mut self.dirty,
            force: [x, y, z],
        }
        .run(&self.rows);
    }

    /// Sets the velocity of the rows in use to `mobility` (s/kg) times their force.
    pub fn velocity_from_force(&mut self, mobility: f64) {
        for (slot, &b) in self.active.iter().enumerate() {
            let mut left = self.rows[b as usize];
            while left != 0 {
                let at = slot * NODES + left.trailing_zeros() as usize * EDGE;
                for (velocity, force) in self.velocity.iter_mut().zip(&self.force) {
                    let (velocity, force) = (velocity.numbers_mut(), force.numbers());
                    for (u, f) in velocity[at..at + EDGE].iter_mut().zip(&force[at..]) {
                        *u = mobility * f;
                    }
                }
                left &= left - 1;
            }
        }
    }

    /// Sum of all forces, N.
    pub fn total_force(&self) -> Vec3 {
        let sum = |a: &Lines| a.numbers().iter().sum::<f64>();
        Vec3::new(sum(&self.force[0]), sum(&self.force[1]), sum(&self.force[2]))
    }

    /// Asks for a brick (by linear number) to be in use after the next [`Bricks::commit`].
    #[inline]
    pub fn want(&mut self, index: usize) {
        self.want_rows(index, !0);
    }

    /// Asks for some rows of a brick: bit `8 k + j` of `rows`.
    #[inline]
    pub fn want_rows(&mut self, index: usize, rows: u64) {
        self.wanted[index] |= rows;
    }

    /// Takes up the bricks asked for since the last commit and drops the others. Forces of bricks that stay are kept,
    /// those of new bricks are zero; velocities are to be read anew. Returns whether the set has changed.
    pub fn commit(&mut self) -> bool {
        let changed = self
            .wanted
            .iter()
            .zip(&self.slot_of)
            .any(|(&w, &s)| (w != 0) != (s != NONE));
        if changed {
            self.rebuild();
        }
        std::mem::swap(&mut self.rows, &mut self.wanted);
        for (dirty, rows) in self.dirty.iter_mut().zip(&self.rows) {
            *dirty |= rows;
        }
        self.wanted.fill(0);
        changed
    }

    /// Renumbers the slots; buffers are kept and grow only when more bricks are in use than ever before.
    fn rebuild(&mut self) {
        std::mem::swap(&mut self.slot_of, &mut self.old_slot_of);
        self.slot_of.fill(NONE);
        self.active.clear();
        for (b, _) in self.wanted.iter().enumerate().filter(|(_, w)| **w != 0) {
            self.slot_of[b] = self.active.len() as u32;
            self.active.push(b as u32);
        }
        let n = self.active.len() * NODES;
        for force in &mut self.force {
            std::mem::swap(force, &mut self.spare);
            force.reset(n);
            for (slot, &b) in self.active.iter().enumerate() {
                let old = self.old_slot_of[b as usize];
                if old != NONE {
                    let from = old as usize * NODES;
                    force.numbers_mut()[slot * NODES..][..NODES]
                        .copy_from_slice(&self.spare.numbers()[from..][..NODES]);
                }
            }
        }
        for (dirty, slot) in self.dirty.iter_mut().zip(&self.slot_of) {
            if *slot == NONE {
                *dirty = 0;
            }
        }
        for velocity in &mut self.velocity {
            velocity.reset(n);
        }
    }
}

/// Slots whose forces are to be zero, and the bricks from number `brick` on.
struct Clear<'a> {
    active: &'a [u32],
    brick: usize,
    dirty: &'a mut [u64],
    force: [&'a mut [f64]; 3],
}

impl Clear<'_> {
    fn run(self, rows: &[u64]) {
        let Self {
            active,
            brick,
            dirty,
            force: [x, y, z],
        } = self;
        if active.len() > SLOTS {
            let half = active.len() / 2;
            let (left, right) = active.split_at(half);
            let middle = right[0] as usize;
            let (dirty_left, dirty_right) = dirty.split_at_mut(middle - brick);
            let [x, y, z] = [x, y, z].map(|f| f.split_at_mut(half * NODES));
            let left = Clear {
                active: left,
                brick,
                dirty: dirty_left,
                force: [x.0, y.0, z.0],
            };
            let right = Clear {
                active: right,
                brick: middle,
                dirty: dirty_right,
                force: [x.1, y.1, z.1],
            };
            return join(|| left.run(rows), || right.run(rows));
        }
        for (slot, &b) in active.iter().enumerate() {
            if let Some(&next) = active.get(slot + 1) {
                let mut left = dirty[next as usize - brick];
                while left != 0 {
                    let at = (slot + 1) * NODES + left.trailing_zeros() as usize * EDGE;
                    for force in [&*x, &*y, &*z] {
                        prefetch(&force[at]);
                    }
                    left &= left - 1;
                }
            }
            let b = b as usize;
            let mut left = std::mem::replace(&mut dirty[b - brick], rows[b]);
            while left != 0 {
                let at = slot * NODES + left.trailing_zeros() as usize * EDGE;
                for force in [&mut *x, &mut *y, &mut *z] {
                    force[at..at + EDGE].fill(0.0);
                }
                left &= left - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brick_that_stays_keeps_its_force() {
        let mut bricks = Bricks::new(&Grid::new([20, 8, 8], 1.0, [true; 3]));
        assert_eq!(bricks.counts(), [3, 1, 1]);
        bricks.want(2);
        assert!(bricks.commit());
        bricks.force_mut()[1][5] = 7.0;
        bricks.want(0);
        bricks.want(2);
        assert!(bricks.commit());
        assert_eq!(bricks.slot([2, 0, 0]), Some(1));
        assert_eq!(bricks.force()[1][NODES + 5], 7.0);
        assert_eq!(bricks.total_force().y, 7.0);
    }

    #[test]
    fn rows_are_cleared_that_were_in_use() {
        let mut bricks = Bricks::new(&Grid::new([8, 8, 8], 1.0, [true; 3]));
        bricks.want_rows(0, 1 << 9);
        bricks.commit();
        bricks.clear_force();
        bricks.force_mut()[0][72..80].fill(1.0);
        bricks.want_rows(0, 1 << 63);
        bricks.want_rows(0, 1);
        bricks.commit();
        assert_eq!(bricks.rows(0), 1 << 63 | 1);
        bricks.force_mut()[2][511] = 1.0;
        bricks.clear_force();
        assert_eq!(bricks.total_force(), Vec3::zeros());
    }
}
