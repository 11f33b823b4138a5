//! What is added to what walls send back to packed nodes: because they slide, and because they cut links elsewhere than half way.
//!
//! A link into a wall of a packed node has one place ([`crate::packed`]), which holds what went out after the nodes have collided and
//! what comes back after this pass. What is read beside it are the two places between the node and the node behind it, which belong
//! to no link into a wall, so the order does not matter. Where a wall is behind and a rule looks there all the same, these are those
//! of the link into that one; then what is added is found for all links before any is changed.

use crate::drive::Balance;
use crate::element::{Element, Half, Precision};
use crate::links::Cut;
use crate::simd::prefetch;
use crate::stencil::{MAX_Q, opposite};
use crate::storage::Storage;
use std::ops::Range;

/// Bits of a code that say which population comes back; the others say which node of its piece the link is of.
const BITS: u32 = 5;
/// Populations that can be told apart.
const CODED: usize = 1 << BITS;
/// How many links before its own the place behind is asked for.
const AHEAD: usize = 24;

/// Links into walls to which something is added, in the order of their nodes.
#[derive(Default)]
pub struct Marks {
    /// The node, counted in its piece, and the population that comes back.
    codes: Vec<u16>,
    /// What a sliding wall adds; empty where no wall slides.
    pushes: Vec<f64>,
    /// Where the node behind has the population that comes back ([`Cut::behind`]), the share of what arrives, and what a swelling wall
    /// would add in parts of `unit`; empty where no link is interpolated.
    behind: Vec<u32>,
    arriving: Vec<f64>,
    swells: Vec<i32>,
    unit: f64,
    /// The share of what leaves; empty where it is that of what arrives, less than nothing.
    leaving: Vec<f64>,
    /// Whether links read each other's places.
    clash: bool,
    /// The first link of each piece of so many nodes, and the number of links.
    first: Vec<u32>,
    piece: usize,
}

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
    /// By how much of its unit each wall gives way.
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
    /// From all links into walls, `(home, direction)`, what sliding adds to each (or nothing at all), and those that are cut, in the
    /// same order. `piece` is the number of nodes whose links are seen to together.
    pub fn new(
        storage: &Storage,
        links: impl Iterator<Item = (usize, u8)>,
        pushes: &[f64],
        cuts: &[Cut],
        piece: usize,
    ) -> Self {
        const { assert!(MAX_Q <= CODED) }
        let arrays = storage.arrays();
        let most = cuts.iter().map(|c| c.swell.abs()).fold(0.0, f64::max);
        let mut marks = Self {
            piece,
            unit: most / f64::from(i32::MAX),
            first: vec![0],
            ..Self::default()
        };
        let opposed = cuts.iter().all(|c| c.shares.leaving == -c.shares.arriving);
        let mut left = cuts.iter().peekable();
        for (n, (home, direction)) in links.enumerate() {
            let i = usize::from(direction);
            let push = pushes.get(n).copied().unwrap_or(0.0);
            let cut = left.next_if(|c| c.link.home == home);
            if push == 0.0 && cut.is_none() {
                continue;
            }
            let node = home - arrays[i];
            while marks.first.len() <= node / piece {
                marks.first.push(marks.codes.len() as u32);
            }
            marks.codes.push((node % piece << BITS | i) as u16);
            if !pushes.is_empty() {
                marks.pushes.push(push);
            }
            if cuts.is_empty() {
                continue;
            }
            marks
                .behind
                .push(cut.map_or(arrays[opposite(i)] + node, |c| c.behind) as u32);
            let shares = cut.map_or([0.0; 2], |c| [c.shares.arriving, c.shares.leaving]);
            marks.clash |= cut.is_none_or(|c| c.behind == c.near) && shares != [0.0; 2];
            marks.arriving.push(shares[0]);
            if !opposed {
                marks.leaving.push(shares[1]);
            }
            let swell = cut
                .filter(|_| shares != [0.0; 2] && most > 0.0)
                .map_or(0.0, |c| c.swell / marks.unit);
            marks.swells.push(swell.round() as i32);
        }
        marks.first.push(marks.codes.len() as u32);
        marks.codes.shrink_to_fit();
        marks.behind.shrink_to_fit();
        marks.swells.shrink_to_fit();
        marks.first.shrink_to_fit();
        for numbers in [&mut marks.pushes, &mut marks.arriving, &mut marks.leaving] {
            numbers.shrink_to_fit();
        }
        marks
    }

    /// Number of links.
    pub fn len(&self) -> usize {
        self.codes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.codes.is_empty()
    }

    /// Whether any of them is interpolated.
    pub fn interpolate(&self) -> bool {
        !self.arriving.is_empty()
    }

    /// Number of links of which it has to be kept what is added: all or none. None where nobody's place is read before and after
    /// it has changed, and what was added can be found again.
    pub fn kept(&self) -> usize {
        if self.clash || !self.leaving.is_empty() {
            self.len()
        } else {
            0
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let numbers = [&self.pushes, &self.arriving, &self.leaving];
        size_of_val(&*self.codes)
            + size_of_val(&*self.behind)
            + size_of_val(&*self.swells)
            + size_of_val(&*self.first)
            + numbers.map(|n| size_of_val(&**n)).iter().sum::<usize>()
    }

    /// Number of the node, and population that comes back, of link `n`.
    pub fn link(&self, n: usize) -> (usize, usize) {
        let piece = self.first.partition_point(|first| *first as usize <= n) - 1;
        self.link_of(piece, n)
    }

    /// The same, of a link of a piece.
    #[inline(always)]
    fn link_of(&self, piece: usize, n: usize) -> (usize, usize) {
        let code = usize::from(self.codes[n]);
        (piece * self.piece + (code >> BITS), code % CODED)
    }

    /// Links of a piece.
    fn of_piece(&self, n: usize) -> Range<usize> {
        let first = |n: usize| self.first.get(n).map_or(self.len(), |l| *l as usize);
        first(n)..first(n + 1)
    }

    /// Pieces with links.
    fn pieces(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The nodes and populations of all links.
    fn all(&self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.pieces()).flat_map(move |piece| self.of_piece(piece).map(move |n| self.link_of(piece, n)))
    }

    /// Nodes of a slab, a multiple of `unit` and at least `least`, such that what is behind a node stands no further than in the next
    /// slab, but for those of the first slab and the last three; all `nodes` if there is no such number.
    pub fn slab(&self, storage: &Storage, nodes: usize, least: usize, unit: usize) -> usize {
        let arrays = storage.arrays();
        let pairs = || {
            let pairs = self.all().zip(&self.behind);
            // Where no node is behind it is a place of the node itself.
            pairs.filter_map(|((node, i), behind)| {
                let behind = *behind as usize;
                (behind != arrays[opposite(i)] + node).then(|| (node, behind - arrays[i]))
            })
        };
        // Neighbours at opposite ends of the grid are at opposite ends of the numbers.
        let apart = pairs().map(|(a, b)| a.abs_diff(b).min(nodes - a.abs_diff(b)));
        let slab = apart.max().unwrap_or(0).max(least).next_multiple_of(unit);
        let count = nodes.div_ceil(slab);
        let fits = |(a, b): (usize, usize)| a < slab || a / slab + 3 >= count || b / slab <= a / slab + 1;
        if pairs().all(fits) { slab } else { nodes }
    }

    fn view<S>(&self, pass: Pass) -> View<S> {
        let (q, arrays) = (pass.storage.velocities().q(), pass.storage.arrays());
        let mut view = View {
            data: pass.storage.data().cast(),
            own: [0; CODED],
            opposite: [0; CODED],
            odd: pass.odd,
            shrink: pass.shrink * self.unit,
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
            let more = match self.leaving.get(n) {
                None => self.arriving[n] * (arriving - leaving),
                Some(share) => {
                    let own = view.get(view.own[i] + node);
                    self.arriving[n] * (arriving - own) + share * (leaving - own)
                }
            };
            more - view.shrink * f64::from(self.swells[n])
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
        let (links, base) = (self.of_piece(piece), piece * self.piece);
        let later = self.behind[links.start..].iter().skip(AHEAD);
        for behind in later.take(links.len()) {
            prefetch(view.data.wrapping_add(*behind as usize));
        }
        let codes = self.codes[links.clone()].iter();
        let shares = self.arriving[links.clone()].iter().zip(&self.swells[links.clone()]);
        // Turned round, the difference of what arrives and what leaves.
        let sign = if view.odd { -1.0 } else { 1.0 };
        let mut gained = 0.0;
        for ((code, behind), (share, swell)) in codes.zip(&self.behind[links]).zip(shares) {
            let (node, i) = (base + usize::from(*code >> BITS), usize::from(*code) % CODED);
            // SAFETY: the place is this link's; the rest is the caller's.
            unsafe {
                let across = view.get(*behind as usize) - view.get(view.opposite[i] + node);
                let more = share * (sign * across) - view.shrink * f64::from(*swell);
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
