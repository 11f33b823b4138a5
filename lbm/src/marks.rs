//! What is added to what walls send back to packed nodes: because they slide, and because they cut links elsewhere than half way.
//!
//! A link into a wall of a packed node has one place ([`crate::packed`]), which holds what went out after the nodes have collided and
//! what comes back after this pass. What is read beside it are the two places between the node and the node behind it, which belong
//! to no link into a wall, so the order does not matter. Where a wall is behind and a rule looks there all the same, these are those
//! of the link into that one; then what is added is found for all links before any is changed.

use crate::links::Cut;
use crate::stencil::{MAX_Q, opposite};
use crate::storage::Storage;
use crate::terms::Terms;
use std::ops::Range;

/// Bits of a code that say which population comes back; the others say which node of its piece the link is of.
pub const BITS: u32 = 5;
/// Populations that can be told apart.
pub const CODED: usize = 1 << BITS;

/// Links into walls to which something is added, in the order of their nodes.
#[derive(Default)]
pub struct Marks {
    /// The node, counted in its piece, and the population that comes back.
    pub codes: Vec<u16>,
    /// What a sliding wall adds; empty where no wall slides.
    pub pushes: Vec<f64>,
    /// Where the node behind has the population that comes back ([`Cut::behind`]); empty where no link is interpolated.
    pub behind: Vec<u32>,
    /// The share of what arrives, and what a swelling wall would add; empty as `behind` is.
    pub terms: Terms,
    /// The share of what leaves; empty where it is that of what arrives, less than nothing.
    pub leaving: Vec<f64>,
    /// Whether links read each other's places.
    clash: bool,
    /// The first link of each piece of so many nodes, and the number of links.
    pub first: Vec<u32>,
    pub piece: usize,
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
        let mut terms = Vec::new();
        let mut marks = Self {
            piece,
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
            marks.codes.push(((node % piece) << BITS | i) as u16);
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
            let swell = cut.filter(|_| shares != [0.0; 2]).map_or(0.0, |c| c.swell);
            terms.push([shares[0], swell]);
            if !opposed {
                marks.leaving.push(shares[1]);
            }
        }
        marks.first.push(marks.codes.len() as u32);
        marks.terms = Terms::new(&terms);
        marks.behind.shrink_to_fit();
        marks.codes.shrink_to_fit();
        marks.first.shrink_to_fit();
        for numbers in [&mut marks.pushes, &mut marks.leaving] {
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
        !self.behind.is_empty()
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
        let numbers = [&self.pushes, &self.leaving];
        size_of_val(&*self.codes)
            + size_of_val(&*self.behind)
            + self.terms.bytes()
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
    pub fn link_of(&self, piece: usize, n: usize) -> (usize, usize) {
        let code = usize::from(self.codes[n]);
        (piece * self.piece + (code >> BITS), code % CODED)
    }

    /// Links of a piece.
    pub fn of_piece(&self, n: usize) -> Range<usize> {
        let first = |n: usize| self.first.get(n).map_or(self.len(), |l| *l as usize);
        first(n)..first(n + 1)
    }

    /// Pieces with links.
    pub fn pieces(&self) -> usize {
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
}
