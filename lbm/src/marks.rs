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

/// In place of the number of the node behind, where there is none.
const NONE: u32 = u32::MAX;
/// Links from one to that whose places are asked for.
const AHEAD: usize = 24;

/// Links into walls to which something is added, in the order of their nodes.
#[derive(Default)]
pub struct Marks {
    /// Number of the node.
    nodes: Vec<u32>,
    /// The population that comes back.
    directions: Vec<u8>,
    /// What a sliding wall adds; empty where no wall slides.
    pushes: Vec<f64>,
    /// The node behind the node, the share of what arrives, and what a swelling wall would add (see [`Cut`]); empty where no link is
    /// interpolated.
    behind: Vec<u32>,
    arriving: Vec<f64>,
    swells: Vec<f64>,
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
}

impl Marks {
    /// From all links into walls, `(home, direction)`, what sliding adds to each (or nothing at all), and those that are cut, in the
    /// same order. `piece` is the number of nodes whose links are asked for together.
    pub fn new(
        storage: &Storage,
        links: impl Iterator<Item = (usize, u8)>,
        pushes: &[f64],
        cuts: &[Cut],
        piece: usize,
    ) -> Self {
        let arrays = storage.arrays();
        let mut marks = Self {
            piece,
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
            marks.nodes.push((home - arrays[i]) as u32);
            marks.directions.push(direction);
            if !pushes.is_empty() {
                marks.pushes.push(push);
            }
            if cuts.is_empty() {
                continue;
            }
            let behind = cut.filter(|c| c.behind != c.near);
            marks
                .behind
                .push(behind.map_or(NONE, |c| (c.behind - arrays[i]) as u32));
            let shares = cut.map_or([0.0; 2], |c| [c.shares.arriving, c.shares.leaving]);
            marks.clash |= behind.is_none() && shares != [0.0; 2];
            marks.arriving.push(shares[0]);
            if !opposed {
                marks.leaving.push(shares[1]);
            }
            marks.swells.push(cut.map_or(0.0, |c| c.swell));
        }
        let pieces = marks.nodes.last().map_or(0, |last| *last as usize / piece + 1);
        let first = |n: usize| marks.nodes.partition_point(|node| (*node as usize) < n * piece) as u32;
        marks.first = (0..=pieces).map(first).collect();
        marks.nodes.shrink_to_fit();
        marks.behind.shrink_to_fit();
        marks.directions.shrink_to_fit();
        for numbers in [
            &mut marks.pushes,
            &mut marks.arriving,
            &mut marks.swells,
            &mut marks.leaving,
        ] {
            numbers.shrink_to_fit();
        }
        marks
    }

    /// Number of links.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
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
        let numbers = [&self.pushes, &self.arriving, &self.swells, &self.leaving];
        size_of_val(&*self.nodes)
            + size_of_val(&*self.directions)
            + size_of_val(&*self.behind)
            + size_of_val(&*self.first)
            + numbers.map(|n| size_of_val(&**n)).iter().sum::<usize>()
    }

    /// Number of the node, and population that comes back, of link `n`.
    pub fn link(&self, n: usize) -> (usize, usize) {
        (self.nodes[n] as usize, usize::from(self.directions[n]))
    }

    /// Links of a piece.
    pub fn of_piece(&self, n: usize) -> Range<usize> {
        let first = |n: usize| self.first.get(n).map_or(self.len(), |l| *l as usize);
        first(n)..first(n + 1)
    }

    /// Links of a range of nodes.
    pub fn of_nodes(&self, nodes: &Range<usize>) -> Range<usize> {
        let first = |node: usize| {
            let piece = self.of_piece(node / self.piece);
            piece.start + self.nodes[piece].partition_point(|n| (*n as usize) < node)
        };
        first(nodes.start)..first(nodes.end)
    }

    /// Nodes of a slab, a multiple of `unit` and at least `least`, such that what is behind a node stands no further than in the next
    /// slab, but for those of the first slab and the last three; all `nodes` if there is no such number.
    pub fn slab(&self, nodes: usize, least: usize, unit: usize) -> usize {
        let pairs = || {
            let pairs = self.nodes.iter().zip(&self.behind).filter(|(_, b)| **b != NONE);
            pairs.map(|(a, b)| (*a as usize, *b as usize))
        };
        // Neighbours at opposite ends of the grid are at opposite ends of the numbers.
        let apart = pairs().map(|(a, b)| a.abs_diff(b).min(nodes - a.abs_diff(b)));
        let slab = apart.max().unwrap_or(0).max(least).next_multiple_of(unit);
        let count = nodes.div_ceil(slab);
        let fits = |(a, b): (usize, usize)| a < slab || a / slab + 3 >= count || b / slab <= a / slab + 1;
        if pairs().all(fits) { slab } else { nodes }
    }

    /// What interpolation adds to link `n`.
    ///
    /// # Safety
    /// Its node and the one behind have taken the step, and nobody writes to their places. Numbers are stored as `S`.
    #[inline(always)]
    unsafe fn interpolated<S: Element>(&self, pass: Pass, n: usize) -> f64 {
        if self.arriving.is_empty() || (self.arriving[n] == 0.0 && self.leaving.get(n).is_none_or(|l| *l == 0.0)) {
            return 0.0;
        }
        let ((node, i), arrays) = (self.link(n), pass.storage.arrays());
        let data = pass.storage.data().cast::<S>();
        // SAFETY: all are places of nodes.
        unsafe {
            let get = |place: usize| (*data.add(place)).get();
            let near = get(arrays[opposite(i)] + node);
            // Where a wall is behind, what left this one waits at that one in either step.
            let far = match self.behind[n] {
                NONE => near,
                node => get(arrays[i] + node as usize),
            };
            let (arriving, leaving) = if pass.odd { (near, far) } else { (far, near) };
            let more = match self.leaving.get(n) {
                None => self.arriving[n] * (arriving - leaving),
                Some(share) => {
                    let own = get(arrays[i] + node);
                    self.arriving[n] * (arriving - own) + share * (leaving - own)
                }
            };
            more - pass.shrink * self.swells[n]
        }
    }

    /// Asks for the places of a link that comes later.
    #[inline(always)]
    fn fetch<S: Element>(&self, pass: Pass, n: usize) {
        if n < self.behind.len() {
            let ((node, i), arrays) = (self.link(n), pass.storage.arrays());
            let data = pass.storage.data().cast::<S>();
            let behind = self.behind[n] as usize;
            for place in [arrays[i] + node, arrays[opposite(i)] + node, arrays[i] + behind] {
                prefetch(data.wrapping_add(place));
            }
        }
    }

    /// What interpolation adds to the links from number `first` on, one for each of `more`.
    ///
    /// # Safety
    /// All nodes have taken the step, and nothing writes to the populations.
    pub unsafe fn find(&self, pass: Pass, first: usize, more: &mut [f64]) {
        for (n, more) in (first..).zip(more) {
            // SAFETY: the caller's.
            *more = unsafe { self.any_interpolated(pass, n) };
        }
    }

    unsafe fn any_interpolated(&self, pass: Pass, n: usize) -> f64 {
        // SAFETY: the caller's.
        unsafe {
            match pass.storage.precision() {
                Precision::F64 => self.interpolated::<f64>(pass, n),
                Precision::F32 => self.interpolated::<f32>(pass, n),
                Precision::F16 => self.interpolated::<Half>(pass, n),
            }
        }
    }

    /// Adds to links, by interpolation what is kept or else found now; returns what that does to the balance.
    ///
    /// # Safety
    /// Their nodes and those behind have taken the step, and nothing else touches their places.
    pub unsafe fn add(&self, pass: Pass, links: Range<usize>, kept: &[f64]) -> Balance {
        // SAFETY: the caller's.
        unsafe {
            match pass.storage.precision() {
                Precision::F64 => self.add_to::<f64>(pass, links, kept),
                Precision::F32 => self.add_to::<f32>(pass, links, kept),
                Precision::F16 => self.add_to::<Half>(pass, links, kept),
            }
        }
    }

    unsafe fn add_to<S: Element>(&self, pass: Pass, links: Range<usize>, kept: &[f64]) -> Balance {
        let (arrays, velocities) = (pass.storage.arrays(), pass.storage.velocities());
        let data = pass.storage.data().cast::<S>();
        let mut balance = Balance::default();
        // Of each population, what was added.
        let mut sums = [0.0; MAX_Q];
        for n in links {
            self.fetch::<S>(pass, n + AHEAD);
            let (node, i) = self.link(n);
            // SAFETY: the place is this link's; the rest is the caller's.
            unsafe {
                let more = match kept.get(n) {
                    Some(more) => *more,
                    None => self.interpolated::<S>(pass, n),
                };
                balance.gained += more;
                let added = more + self.pushes.get(n).copied().unwrap_or(0.0);
                let place = data.add(arrays[i] + node);
                *place = S::near((*place).get() + added);
                sums[i] += added;
            }
        }
        for (i, sum) in sums.iter().enumerate().take(velocities.q()) {
            for (wall, c) in balance.walls.iter_mut().zip(velocities.c(i)) {
                *wall += f64::from(c) * sum;
            }
        }
        balance
    }

    /// What was added to link `n` in the last step.
    ///
    /// # Safety
    /// Nobody writes to the populations.
    pub unsafe fn added(&self, pass: Pass, n: usize, kept: &[f64]) -> f64 {
        // SAFETY: the caller's; where nothing is kept, the places that it depends on have not been changed since.
        let more = unsafe { kept.get(n).copied().unwrap_or_else(|| self.any_interpolated(pass, n)) };
        more + self.pushes.get(n).copied().unwrap_or(0.0)
    }
}
