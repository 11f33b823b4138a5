//! One time step of packed nodes, batch by batch.

use crate::collide::{FREE, Places, UNIFORM};
use crate::drive::Balance;
use crate::ferry::{Buffer, Load};
use crate::packed::Packed;
use crate::scattered::Scattered;
use crate::step::{Step, Work};
use std::ops::Range;

impl Step<'_> {
    /// Collides and streams batches from number `first` on, one for each of `balances`; `odd` says whether populations are in the
    /// neighbours.
    ///
    /// # Safety
    /// No two threads may work on the same nodes, and nothing else may touch the populations meanwhile. Every place is used by one
    /// node alone: see [`crate::packed`].
    pub unsafe fn batches(&self, packed: &Packed, first: usize, balances: &mut [Balance], odd: bool) {
        let size = packed.batch();
        let nodes = first * size..((first + balances.len()) * size).min(packed.nodes());
        balances.fill(Balance::default());
        Buffer::lend(|buffer| {
            // SAFETY: as for this function.
            unsafe {
                self.packed(packed, nodes, odd, buffer, |batch, balance| {
                    balances[batch - first] = balance
                })
            }
        });
    }

    /// Collides and streams a range of nodes, and tells the balance of each batch, where one is wanted.
    ///
    /// # Safety
    /// As for [`Step::batches`].
    pub unsafe fn packed(
        &self,
        packed: &Packed,
        nodes: Range<usize>,
        odd: bool,
        buffer: &mut Buffer,
        mut tell: impl FnMut(usize, Balance),
    ) {
        let size = packed.batch();
        let plain = self.bricks.is_empty() && self.inside.is_empty() && self.thermal.is_none();
        if plain && !odd && !self.tally {
            let places = packed.own(self.storage, 0);
            let work = Work {
                kernel: self.kernel,
                places: &places,
                next: (&places, nodes.end),
            };
            // SAFETY: as for this function.
            unsafe { self.span(nodes, &work, None, &mut Balance::default()) };
            return;
        }
        for batch in nodes.start / size..nodes.end.div_ceil(size) {
            let part = nodes.start.max(batch * size)..nodes.end.min((batch + 1) * size);
            // SAFETY: as for this function.
            tell(batch, unsafe { self.batch(packed, batch, &part, odd, plain, buffer) });
        }
    }

    /// Collides and streams nodes of a batch; `plain` ones are alike.
    unsafe fn batch(
        &self,
        packed: &Packed,
        batch: usize,
        nodes: &Range<usize>,
        odd: bool,
        plain: bool,
        buffer: &mut Buffer,
    ) -> Balance {
        let mut balance = Balance::default();
        if odd && plain && nodes.len() == packed.batch() {
            // SAFETY: the places of these nodes are ours.
            balance.momentum = unsafe { self.scattered(packed, batch, buffer) };
            self.tally_walls(packed, batch, &mut balance);
            return balance;
        }
        let first = batch * packed.batch();
        let clip = packed.clip(batch, nodes);
        let load = if packed.holds(batch, nodes) {
            Load::All
        } else {
            Load::Some(&clip)
        };
        let places = if odd {
            // SAFETY: the places of these nodes are ours, and the kernel runs on the same instruction set.
            unsafe { packed.of(batch).ferry::<false>(self.storage, self.isa, load, buffer) };
            packed.places(self.storage, batch, buffer)
        } else {
            packed.own(self.storage, batch)
        };
        let after = (batch + 1).min(packed.batches() - 1);
        let next = if odd {
            packed.sources(self.storage, after)
        } else {
            packed.own(self.storage, after)
        };
        if plain {
            let work = Work {
                kernel: self.kernel,
                places: &places,
                next: (&next, 0),
            };
            // SAFETY: the places of these nodes are ours.
            unsafe { self.span(nodes.start - first..nodes.end - first, &work, None, &mut balance) };
        } else {
            let bytes = packed.precision.bytes() as isize;
            let mut row = None;
            for (run, part) in packed.runs(&self.links.runs, nodes) {
                // Runs follow each other as rows do: only the first one's row is searched for.
                let rows = &self.links.rows;
                let mut at = row.unwrap_or_else(|| rows.partition_point(|row| row.runs().end <= run));
                while rows[at].runs().end <= run {
                    at += 1;
                }
                row = Some(at);
                let row = &rows[at];
                let shift = packed.starts[run] as isize - (first + self.links.run(run).start) as isize;
                let places: Places = places.map(|p| p.wrapping_offset(shift * bytes));
                let work = Work {
                    kernel: self.kernel,
                    places: &places,
                    next: (&next, 0),
                };
                // SAFETY: as above.
                unsafe {
                    let [j, k] = row.at();
                    let inside = self.inside.row(j, k);
                    self.part(row, &part, self.is_touched(row), inside, work, &mut balance);
                }
            }
        }
        if odd {
            // SAFETY: as above.
            unsafe { packed.of(batch).ferry::<true>(self.storage, self.isa, load, buffer) };
        }
        self.tally_walls(packed, batch, &mut balance);
        balance
    }

    /// Collides a whole batch in an odd step, all nodes alike; returns as [`Kernel::collide`](crate::kernel::Kernel::collide) does.
    ///
    /// # Safety
    /// As for [`Step::batches`].
    unsafe fn scattered(&self, packed: &Packed, batch: usize, buffer: &mut Buffer) -> [f64; 3] {
        let force = if self.uniform == [0.0; 3] { FREE } else { UNIFORM };
        let parts = packed.of(batch);
        // SAFETY: the places of these nodes are ours, and the kernel was built for this instruction set and precision.
        unsafe {
            parts.ferry::<false>(self.storage, self.isa, Load::Apart, buffer);
            let scattered = Scattered {
                data: self.storage.data(),
                rest: packed.resting(self.storage, batch),
                buffer: buffer.start(),
                main: parts.main,
                early: (parts.early, parts.later),
                lists: packed.lists(batch),
                uniform: self.uniform,
            };
            let momentum = self.kernel.collide_scattered(&scattered, force, self.tally);
            parts.ferry::<true>(self.storage, self.isa, Load::Apart, buffer);
            momentum
        }
    }

    /// Adds what the walls of a batch have sent back, where that is wanted.
    fn tally_walls(&self, packed: &Packed, batch: usize, balance: &mut Balance) {
        if !self.tally {
            return;
        }
        let velocities = self.storage.velocities();
        packed.for_walls(self.storage, batch, |i, place| {
            // SAFETY: the place is that of a link of these nodes.
            let out = unsafe { self.storage.read(place) };
            for (sum, c) in balance.walls.iter_mut().zip(velocities.c(i)) {
                *sum += f64::from(c) * (2.0 * out);
            }
        });
    }
}
