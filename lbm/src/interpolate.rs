//! What comes after all rows of a step have collided: links that are cut elsewhere than half way, and walls that are
//! thinner than a cell.
//!
//! After an even step populations stand where their nodes have left them, after an odd one where they go. All that is read
//! here, apart from the link itself, are the two places between a node and the node behind it, which no link into a wall
//! uses, or, where a wall is behind, those of the link into that one, of which the rows have left both ends alike; the order
//! of links does not matter.

use crate::drive::Balance;
use crate::links::{Cut, Links, Side};
use crate::stencil::Velocities;
use crate::storage::Storage;

/// The second part of a step.
pub struct Interpolate<'a> {
    pub storage: &'a Storage,
    pub links: &'a Links,
    /// Whether the step was an odd one.
    pub odd: bool,
    /// Velocity, lattice units, by which interpolated walls give way for what their links gained in the last step.
    pub shrink: f64,
}

/// What a thin wall's two sides have sent and got: `[outgoing, returning]` each.
pub type Exchanged = [[f64; 2]; 2];

impl Interpolate<'_> {
    /// Interpolates the links of the rows from number `first` on, one for each of `balances`.
    ///
    /// # Safety
    /// All rows have taken the step, no two threads may work on the same row, and nothing else may touch the populations.
    pub unsafe fn rows(&self, first: usize, balances: &mut [Balance]) {
        for (row, balance) in self.links.row_links[first..].iter().zip(balances) {
            balance.gained = 0.0;
            for cut in &self.links.cuts[row.cuts.clone()] {
                let (own, to) = if self.odd {
                    (cut.link.ghost, cut.link.home)
                } else {
                    (cut.link.home, cut.link.ghost)
                };
                // SAFETY: all are places of the populations, and `to` is written by this link alone.
                let more = unsafe {
                    let more = self.more(cut, self.get(own));
                    self.storage.write(to, self.get(to) + more);
                    more
                };
                balance.gained += more;
                for a in 0..3 {
                    balance.walls[a] += f64::from(self.storage.velocities().c(cut.direction)[a]) * more;
                }
            }
        }
    }

    /// Sends populations back from the thin walls from number `first` on, one for each of `exchanged`.
    ///
    /// # Safety
    /// As for [`Interpolate::rows`], no two threads on the same wall.
    pub unsafe fn thin(&self, first: usize, exchanged: &mut [Exchanged]) {
        for ([a, b], exchanged) in self.links.thin[first..].iter().zip(exchanged) {
            let to = |side: &Side| {
                if self.odd {
                    side.cut.link.home
                } else {
                    side.cut.link.ghost
                }
            };
            // After an odd step the outgoing one is where the other side's would come home.
            let (from_a, from_b) = if self.odd {
                (b.cut.link.home, a.cut.link.home)
            } else {
                (a.cut.link.home, b.cut.link.home)
            };
            // SAFETY: all are places of the populations, and this wall alone writes to its own.
            unsafe {
                let send = |side: &Side, own: f64, other: f64| {
                    let back = own + side.push + (1.0 - side.through) * self.more(&side.cut, own);
                    [own, back + side.through * (other - own)]
                };
                let (own, other) = (self.get(from_a), self.get(from_b));
                *exchanged = [send(a, own, other), send(b, other, own)];
                self.storage.write(to(a), exchanged[0][1]);
                self.storage.write(to(b), exchanged[1][1]);
            }
        }
    }

    /// What a cut adds to halfway bounce-back of the outgoing population `own`.
    unsafe fn more(&self, cut: &Cut, own: f64) -> f64 {
        if cut.shares.arriving == 0.0 && cut.shares.leaving == 0.0 {
            return 0.0;
        }
        let (arriving, leaving) = if self.odd {
            (cut.near, cut.behind)
        } else {
            (cut.behind, cut.near)
        };
        // SAFETY: the caller's.
        let (arriving, leaving) = unsafe { (self.get(arriving), self.get(leaving)) };
        cut.shares.arriving * (arriving - own) + cut.shares.leaving * (leaving - own) - self.shrink * cut.swell
    }

    unsafe fn get(&self, index: usize) -> f64 {
        // SAFETY: the caller's.
        unsafe { self.storage.read(index) }
    }
}

/// What thin walls have added to the balance in the last step.
pub fn thin_balance(thin: &[[Side; 2]], exchanged: &[Exchanged], velocities: Velocities) -> Balance {
    let mut balance = Balance::default();
    for (sides, exchanged) in thin.iter().zip(exchanged) {
        for (side, [outgoing, returning]) in sides.iter().zip(exchanged) {
            balance.gained += returning - outgoing - side.push;
            for a in 0..3 {
                balance.walls[a] += f64::from(velocities.c(side.cut.direction)[a]) * (outgoing + returning);
            }
        }
    }
    balance
}
