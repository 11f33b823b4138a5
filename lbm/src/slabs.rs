//! All nodes take a step, and packed ones get what walls add while they are in the cache.

use crate::adding::Pass;
use crate::fluid::Fluid;
use crate::lattice::{FEW_NODES, PAYBACK, PIECE};
use crate::parallel;
use lbm_ibm_coupling::Bricks;
use std::ops::Range;

/// Bytes of populations that are collided at a time before links are seen to: a small part of what the last cache holds.
const SLAB: usize = 1 << 21;

impl Fluid {
    /// Rows or batches collide and stream. What walls add to links of packed nodes comes as soon as the nodes behind are done, unless
    /// it is found for all before any is changed.
    pub(crate) fn collide(&mut self, bricks: &Bricks) {
        // Averaged over two steps, or it would feed what changes sign in every step.
        let owed = 0.5 * (self.owed[0] + self.owed[1]);
        self.shrink = if self.links.swell > 0.0 {
            PAYBACK * owed / self.links.swell
        } else {
            0.0
        };
        let all = 0..self.balances.len();
        let marks = &self.links.marks;
        let Some(packed) = self
            .links
            .packed
            .as_ref()
            .filter(|_| !marks.is_empty() && self.more.is_empty())
        else {
            return self.collide_part(bricks, all);
        };
        let slab = self.slab.div_ceil(packed.batch());
        let count = all.len().div_ceil(slab);
        let at = |n: usize| (n * slab).min(all.len());
        let part = |slabs: Range<usize>| at(slabs.start)..at(slabs.end);
        for n in 0..count {
            self.collide_part(bricks, part(n..n + 1));
            // Nodes of the first and the last ones may be neighbours.
            if n >= 2 && n + 2 < count {
                self.add_marks(part(n - 1..n));
            }
        }
        self.add_marks(part(0..1));
        self.add_marks(part(count.saturating_sub(3).max(1)..count.max(1)));
    }

    /// Rows or batches take a step.
    fn collide_part(&mut self, bricks: &Bricks, part: Range<usize>) {
        let mut balances = std::mem::take(&mut self.balances);
        let step = self.step(bricks);
        let (few, odd) = (self.mask.fluid_nodes < FEW_NODES, self.odd);
        let start = part.start;
        parallel::for_pieces(few, &mut balances[part], PIECE, |first, balances| {
            // SAFETY: each row or batch is worked on once, and `self` is exclusive.
            unsafe {
                match &step.links.packed {
                    Some(packed) => step.batches(packed, start + first, balances, odd),
                    None => step.rows(start + first, balances, odd),
                }
            }
        });
        self.balances = balances;
    }

    /// Adds to the links of batches what walls add.
    pub(crate) fn add_marks(&mut self, part: Range<usize>) {
        let mut balances = std::mem::take(&mut self.balances);
        let (pass, marks, start) = (self.pass(self.odd), &self.links.marks, part.start);
        let few = self.mask.fluid_nodes < FEW_NODES;
        parallel::for_pieces(few, &mut balances[part], PIECE, |first, balances| {
            // SAFETY: the nodes and those behind are done, and each link is worked on once.
            unsafe { marks.add(pass, start + first, balances, &self.more) };
        });
        self.balances = balances;
    }

    /// Nodes of a slab.
    pub(crate) fn slab_size(&self) -> usize {
        let Some(packed) = &self.links.packed else { return 0 };
        let populations = self.storage.velocities().q() * self.storage.precision().bytes();
        let unit = packed.batch() * PIECE;
        self.links
            .marks
            .slab(&self.storage, packed.nodes(), SLAB / populations, unit)
    }

    /// What the pass over links has to know of a step, odd or not.
    pub(crate) fn pass(&self, odd: bool) -> Pass<'_> {
        Pass {
            storage: &self.storage,
            odd,
            shrink: self.shrink,
            tally: self.drive.is_flux(),
        }
    }
}
