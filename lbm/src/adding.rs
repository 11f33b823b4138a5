//! The pass over the links of packed nodes to which walls add something: what that is, and adding it.

use crate::drive::Balance;
use crate::element::{Element, Half, Precision};
use crate::marks::{BITS, CODED, Marks};
use crate::simd::prefetch;
use crate::stencil::{MAX_Q, opposite};
use crate::storage::Storage;
use crate::terms::Terms;
use std::ops::Range;

/// How many links before its own the place behind is asked for.
const AHEAD: usize = 24;

/// A step as the pass sees it.
#[derive(Clone, Copy)]
pub struct Pass<'a> {
    pub storage: &'a Storage,
    /// Whether the step was an odd one.
    pub odd: bool,
    /// Velocity, lattice units, by which interpolated walls give way.
    pub shrink: f64,
    /// Whether the balance of momentum is wanted.
    pub tally: bool,
}

/// Places as a pass needs them.
struct View<S> {
    data: *mut S,
    /// Where the populations of node 0 stand, and those opposite to them.
    own: [usize; CODED],
    opposite: [usize; CODED],
    odd: bool,
    /// Velocity, lattice units, by which interpolated walls give way.
    shrink: f64,
}

impl<S: Element> View<S> {
    #[inline(always)]
    unsafe fn get(&self, place: usize) -> f64 {
        // SAFETY: the caller's: it is the place of a node.
        unsafe { (*self.data.add(place)).get() }
    }
}

impl Marks {
    fn view<S>(&self, pass: Pass) -> View<S> {
        let (q, arrays) = (pass.storage.velocities().q(), pass.storage.arrays());
        let mut view = View {
            data: pass.storage.data().cast(),
            own: [0; CODED],
            opposite: [0; CODED],
            odd: pass.odd,
            shrink: pass.shrink,
        };
        for i in 0..q {
            view.own[i] = arrays[i];
            view.opposite[i] = arrays[opposite(i)];
        }
        view
    }

    /// What interpolation adds to link `n`.
    ///
    /// # Safety
    /// Its node and the one behind have taken the step, and nobody writes to their places.
    #[inline(always)]
    unsafe fn interpolated<S: Element>(&self, view: &View<S>, (node, i): (usize, usize), n: usize) -> f64 {
        // SAFETY: all are places of nodes.
        unsafe {
            // Where a wall is behind, what left this one waits at that one in either step.
            let (near, far) = (view.get(view.opposite[i] + node), view.get(self.behind[n] as usize));
            let (arriving, leaving) = if view.odd { (near, far) } else { (far, near) };
            let [share, swell] = self.terms.of(n);
            let more = match self.leaving.get(n) {
                None => share * (arriving - leaving),
                Some(other) => {
                    let own = view.get(view.own[i] + node);
                    share * (arriving - own) + other * (leaving - own)
                }
            };
            more - view.shrink * swell
        }
    }

    /// What interpolation adds to the links from number `first` on, one for each of `more`.
    ///
    /// # Safety
    /// All nodes have taken the step, and nothing writes to the populations.
    pub unsafe fn find(&self, pass: Pass, first: usize, more: &mut [f64]) {
        // SAFETY: the caller's.
        unsafe {
            match pass.storage.precision() {
                Precision::F64 => self.find_in(&self.view::<f64>(pass), first, more),
                Precision::F32 => self.find_in(&self.view::<f32>(pass), first, more),
                Precision::F16 => self.find_in(&self.view::<Half>(pass), first, more),
            }
        }
    }

    unsafe fn find_in<S: Element>(&self, view: &View<S>, first: usize, more: &mut [f64]) {
        let end = first + more.len();
        let start = self.first.partition_point(|n| *n as usize <= first).saturating_sub(1);
        for piece in start..self.pieces() {
            let links = self.of_piece(piece);
            if links.start >= end {
                return;
            }
            for n in links.start.max(first)..links.end.min(end) {
                // SAFETY: the caller's.
                more[n - first] = unsafe { self.interpolated(view, self.link_of(piece, n), n) };
            }
        }
    }

    /// Adds to the links of the pieces from number `first` on, one for each of `balances`, by interpolation what is kept or else found
    /// now.
    ///
    /// # Safety
    /// Their nodes and those behind have taken the step, and nothing else touches their places.
    pub unsafe fn add(&self, pass: Pass, first: usize, balances: &mut [Balance], kept: &[f64]) {
        // SAFETY: the caller's.
        unsafe {
            match pass.storage.precision() {
                Precision::F64 => self.add_to(&self.view::<f64>(pass), pass, first, balances, kept),
                Precision::F32 => self.add_to(&self.view::<f32>(pass), pass, first, balances, kept),
                Precision::F16 => self.add_to(&self.view::<Half>(pass), pass, first, balances, kept),
            }
        }
    }

    unsafe fn add_to<S: Element>(
        &self,
        view: &View<S>,
        pass: Pass,
        first: usize,
        balances: &mut [Balance],
        kept: &[f64],
    ) {
        let plain = self.interpolate() && kept.is_empty() && self.pushes.is_empty() && !pass.tally;
        for (piece, balance) in (first..).zip(balances) {
            self.fetch(view, piece + 1);
            // SAFETY: the caller's.
            unsafe {
                if plain {
                    balance.gained += self.add_plainly(view, piece);
                } else {
                    self.add_all(view, pass, piece, balance, kept);
                }
            }
        }
    }

    /// Asks for the places of the links of a piece.
    #[inline(always)]
    fn fetch<S>(&self, view: &View<S>, piece: usize) {
        for n in self.of_piece(piece) {
            let (node, i) = self.link_of(piece, n);
            prefetch(view.data.wrapping_add(view.own[i] + node));
            prefetch(view.data.wrapping_add(view.opposite[i] + node));
        }
    }

    /// Adds to the links of a piece where nothing is kept, no wall slides and no balance but that of the mass is wanted, which is
    /// returned.
    ///
    /// # Safety
    /// As for [`Marks::add`].
    #[inline(always)]
    unsafe fn add_plainly<S: Element>(&self, view: &View<S>, piece: usize) -> f64 {
        let links = self.of_piece(piece);
        // SAFETY: the caller's.
        unsafe {
            match &self.terms {
                Terms::Few { numbers, pairs } => {
                    let terms = numbers[links].iter().map(|number| pairs[usize::from(*number)]);
                    self.add_terms(view, piece, terms)
                }
                Terms::Many { shares, swells, units } => {
                    let both = shares[links.clone()].iter().zip(&swells[links]);
                    let terms = both.map(|(share, swell)| [f64::from(*share) * units[0], f64::from(*swell) * units[1]]);
                    self.add_terms(view, piece, terms)
                }
            }
        }
    }

    /// The same with the terms of its links.
    #[inline(always)]
    unsafe fn add_terms<S: Element>(&self, view: &View<S>, piece: usize, terms: impl Iterator<Item = [f64; 2]>) -> f64 {
        let (links, base) = (self.of_piece(piece), piece * self.piece);
        let later = self.behind[links.start..].iter().skip(AHEAD);
        for behind in later.take(links.len()) {
            prefetch(view.data.wrapping_add(*behind as usize));
        }
        let codes = self.codes[links.clone()].iter();
        // Turned round, the difference of what arrives and what leaves.
        let sign = if view.odd { -1.0 } else { 1.0 };
        let mut gained = 0.0;
        for ((code, behind), [share, swell]) in codes.zip(&self.behind[links]).zip(terms) {
            let (node, i) = (base + usize::from(*code >> BITS), usize::from(*code) % CODED);
            // SAFETY: the place is this link's; the rest is the caller's.
            unsafe {
                let across = view.get(*behind as usize) - view.get(view.opposite[i] + node);
                let more = share * (sign * across) - view.shrink * swell;
                gained += more;
                let place = view.data.add(view.own[i] + node);
                *place = S::near((*place).get() + more);
            }
        }
        gained
    }

    /// Adds to the links of a piece whatever there is.
    ///
    /// # Safety
    /// As for [`Marks::add`].
    unsafe fn add_all<S: Element>(
        &self,
        view: &View<S>,
        pass: Pass,
        piece: usize,
        balance: &mut Balance,
        kept: &[f64],
    ) {
        let velocities = pass.storage.velocities();
        // Of each population, what was added.
        let mut sums = [0.0; MAX_Q];
        for n in self.of_piece(piece) {
            let (node, i) = self.link_of(piece, n);
            // SAFETY: the place is this link's; the rest is the caller's.
            unsafe {
                let more = match kept.get(n) {
                    Some(more) => *more,
                    None if self.interpolate() => self.interpolated(view, (node, i), n),
                    None => 0.0,
                };
                balance.gained += more;
                let added = more + self.pushes.get(n).copied().unwrap_or(0.0);
                let place = view.data.add(view.own[i] + node);
                *place = S::near((*place).get() + added);
                sums[i] += added;
            }
        }
        for (i, sum) in sums.iter().enumerate().take(velocities.q()) {
            for (wall, c) in balance.walls.iter_mut().zip(velocities.c(i)) {
                *wall += f64::from(c) * sum;
            }
        }
    }

    /// Adds what sliding walls add to the links of a range of nodes; none is interpolated.
    ///
    /// # Safety
    /// The nodes have taken the step, and nothing else touches their places.
    pub unsafe fn push(&self, storage: &Storage, nodes: &Range<usize>) {
        for piece in nodes.start / self.piece..nodes.end.div_ceil(self.piece) {
            for n in self.of_piece(piece) {
                let (node, i) = self.link_of(piece, n);
                if nodes.contains(&node) {
                    let place = storage.arrays()[i] + node;
                    // SAFETY: the place is this link's.
                    unsafe { storage.write(place, storage.read(place) + self.pushes[n]) };
                }
            }
        }
    }

    /// What was added to link `n` in the last step.
    ///
    /// # Safety
    /// Nobody writes to the populations.
    pub unsafe fn added(&self, pass: Pass, n: usize, kept: &[f64]) -> f64 {
        let mut more = [kept.get(n).copied().unwrap_or(0.0)];
        if kept.is_empty() && self.interpolate() {
            // SAFETY: the caller's; where nothing is kept, the places that it depends on have not been changed since.
            unsafe { self.find(pass, n, &mut more) };
        }
        more[0] + self.pushes.get(n).copied().unwrap_or(0.0)
    }
}
