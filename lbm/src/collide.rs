//! Collision and streaming of a span of nodes in a row: the loops of the fluid.
//!
//! A node reads population `i` at place `i` and writes the collided one to place `opposite(i)`. The caller chooses the
//! places so that this streams as well (Bailey et al. 2009, "AA pattern").

use crate::element::Element;
use crate::model::Model;
use crate::simd::{MAX_LANES, Simd, Stored, prefetch};
use crate::stencil::{MAX_Q, moments, opposite};

/// How far ahead the places are prefetched, in bytes.
const AHEAD: usize = 768;
/// Bytes of each population in a short run, at most.
const SHORT: usize = 256;
/// Vectors in a run whose vectors are worth aligning, at least.
const LONG: usize = 6;
/// Bytes of a cache line.
const LINE: usize = 64;

/// No force.
pub const FREE: u8 = 0;
/// The same force on every node.
pub const UNIFORM: u8 = 1;
/// A force for each node.
pub const PER_NODE: u8 = 2;

/// Places of the populations of node 0 of a row; they may lie before the memory.
pub type Places = [*mut u8; MAX_Q];

/// Nodes of a row that are collided in one go.
pub struct Span<'a> {
    /// Places in the row of these nodes.
    pub places: &'a Places,
    /// Position of the first node in the row.
    pub start: usize,
    /// Number of nodes.
    pub len: usize,
    /// What will be collided next: the places of its row, and its first node.
    pub next: (&'a Places, usize),
    /// Force on every node, lattice units (kernel [`UNIFORM`]).
    pub uniform: [f64; 3],
    /// Force on each node, lattice units (kernel [`PER_NODE`]).
    pub force: [*const f64; 3],
}

impl Span<'_> {
    /// What is before the whole vectors of the span, those, and what is behind.
    pub fn parts<V: Simd>(&self) -> [Self; 3] {
        let ends = Ends::new::<V>(self);
        let part = |from: usize, len: usize| Self {
            start: self.start + from,
            len,
            ..*self
        };
        [
            part(0, ends.head),
            part(ends.head, ends.tail_from - ends.head),
            part(ends.tail_from, ends.tail),
        ]
    }

    /// Places of the first node.
    #[inline(always)]
    fn first<S, const Q: usize>(&self) -> [*mut S; Q] {
        let mut first = [std::ptr::null_mut(); Q];
        for (first, place) in first.iter_mut().zip(self.places) {
            *first = place.cast::<S>().wrapping_add(self.start);
        }
        first
    }

    /// Asks for the populations that come some way after node `x`, in this span or the next.
    #[inline(always)]
    fn fetch_ahead<S, const Q: usize>(&self, x: usize) {
        // Behind a short run, and most likely behind the next one too, memory goes on with the runs after it.
        let (far, short) = (AHEAD / size_of::<S>(), self.len < SHORT / size_of::<S>());
        let ahead = x + if short { far } else { far.min(self.len) };
        let (places, x) = if short || ahead < self.len {
            (self.places, self.start + ahead)
        } else {
            (self.next.0, self.next.1 + (ahead - self.len))
        };
        for place in &places[..Q] {
            prefetch(place.cast::<S>().wrapping_add(x));
        }
    }
}

// A closure that the compiler does not inline is compiled without the instruction set of the kernel, and calls one function for each
// operation: hence plain functions and loops here and in the models.

/// The populations of `n` nodes from `x` on, a vector or less.
///
/// # Safety
/// As for [`span`].
#[inline(always)]
unsafe fn gather<V: Stored<S>, S: Element, const Q: usize>(places: &[*mut S; Q], x: usize, n: usize) -> [V; Q] {
    // SAFETY: the caller's contract.
    unsafe {
        let mut f = [V::splat(0.0); Q];
        if n == V::LANES {
            for i in 0..Q {
                f[i] = V::load(places[i].wrapping_add(x));
            }
        } else {
            for i in 0..Q {
                f[i] = V::load_first(places[i].wrapping_add(x), n);
            }
        }
        f
    }
}

/// Writes each population to the place of the opposite one.
///
/// # Safety
/// As for [`span`].
#[inline(always)]
unsafe fn scatter<V: Stored<S>, S: Element, const Q: usize>(f: &[V; Q], places: &[*mut S; Q], x: usize, n: usize) {
    // SAFETY: the caller's contract.
    unsafe {
        if n == V::LANES {
            for i in 0..Q {
                f[i].store(places[opposite(i)].wrapping_add(x));
            }
        } else {
            for i in 0..Q {
                f[i].store_first(places[opposite(i)].wrapping_add(x), n);
            }
        }
    }
}

/// A vector of each component from `x` on.
///
/// # Safety
/// The numbers are valid.
#[inline(always)]
unsafe fn wide<V: Simd>(from: [*const f64; 3], x: usize) -> [V; 3] {
    let [a, b, c] = from;
    // SAFETY: the caller's contract.
    unsafe { [V::load_wide(a.add(x)), V::load_wide(b.add(x)), V::load_wide(c.add(x))] }
}

#[inline(always)]
fn add<V: Simd>(sum: &mut [V; 3], more: [V; 3]) {
    for a in 0..3 {
        sum[a] = sum[a] + more[a];
    }
}

#[inline(always)]
fn total<V: Simd>([x, y, z]: [V; 3]) -> [f64; 3] {
    [x.sum(), y.sum(), z.sum()]
}

/// Collides a span; returns the sum of the momentum before collision (lattice units) where `TALLY` is set, else zero.
///
/// # Safety
/// The instruction set of `V` is there; the numbers of all nodes are valid at every place, and no other thread touches them;
/// with [`PER_NODE`] a force is valid for each node, and for [`MAX_LANES`] more.
#[inline(always)]
pub unsafe fn span<M, S, V, const Q: usize, const FORCE: u8, const TALLY: bool>(model: &M, s: &Span) -> [f64; 3]
where
    M: Model<Q>,
    S: Element,
    V: Stored<S>,
{
    // SAFETY: the contract of this function is that of every call below: ends are shorter than a vector, and the loop
    // stays between them.
    unsafe {
        let places = s.first::<S, Q>();
        let uniform = [V::splat(s.uniform[0]), V::splat(s.uniform[1]), V::splat(s.uniform[2])];
        let mut sum = [V::splat(0.0); 3];
        let ends = Ends::new::<V>(s);
        for (x, n) in [(0, ends.head), (ends.tail_from, ends.tail)] {
            if n == 0 {
                continue;
            }
            let mut f = gather::<V, S, Q>(&places, x, n);
            let momentum = match FORCE {
                PER_NODE => model.collide::<V, true>(&mut f, wide(s.force, x)),
                UNIFORM => model.collide::<V, true>(&mut f, uniform),
                _ => model.collide::<V, false>(&mut f, uniform),
            };
            scatter(&f, &places, x, n);
            if TALLY {
                add(&mut sum, momentum);
            }
        }
        let mut x = ends.head;
        while x < ends.tail_from {
            let mut f = gather::<V, S, Q>(&places, x, V::LANES);
            if ((x - ends.head) * size_of::<S>()).is_multiple_of(LINE) {
                s.fetch_ahead::<S, Q>(x);
            }
            let momentum = match FORCE {
                PER_NODE => model.collide::<V, true>(&mut f, wide(s.force, x)),
                UNIFORM => model.collide::<V, true>(&mut f, uniform),
                _ => model.collide::<V, false>(&mut f, uniform),
            };
            scatter(&f, &places, x, V::LANES);
            if TALLY {
                add(&mut sum, momentum);
            }
            x += V::LANES;
        }
        if TALLY { total(sum) } else { [0.0; 3] }
    }
}

/// The same for whole vectors alone, without force and sum: the length is a multiple of that of a vector.
///
/// # Safety
/// As for [`span`].
#[inline(always)]
pub unsafe fn whole_span<M, S, V, const Q: usize>(model: &M, s: &Span)
where
    M: Model<Q>,
    S: Element,
    V: Stored<S>,
{
    // SAFETY: the contract of this function is that of every call below; the loop stays in the span.
    unsafe {
        let places = s.first::<S, Q>();
        let none = [V::splat(0.0); 3];
        let mut x = 0;
        while x < s.len {
            let mut f = gather::<V, S, Q>(&places, x, V::LANES);
            if (x * size_of::<S>()).is_multiple_of(LINE) {
                s.fetch_ahead::<S, Q>(x);
            }
            model.collide::<V, false>(&mut f, none);
            scatter(&f, &places, x, V::LANES);
            x += V::LANES;
        }
    }
}

/// The same in as little code as can be: one loop for whole vectors and ends, with a force on each node (zero where there is
/// none) and the sum of the momentum always.
///
/// # Safety
/// As for [`span`]; forces are null or valid for each node, and for [`MAX_LANES`] more.
#[inline(always)]
pub unsafe fn lean_span<M, S, V, const Q: usize>(model: &M, s: &Span) -> [f64; 3]
where
    M: Model<Q>,
    S: Element,
    V: Stored<S>,
{
    // SAFETY: the contract of this function is that of every call below; parts are no longer than a vector.
    unsafe {
        let places = s.first::<S, Q>();
        let [fx, fy, fz] = s.uniform;
        let uniform = [[fx; MAX_LANES], [fy; MAX_LANES], [fz; MAX_LANES]];
        let (force, stride) = if s.force[0].is_null() {
            ([uniform[0].as_ptr(), uniform[1].as_ptr(), uniform[2].as_ptr()], 0)
        } else {
            (s.force, 1)
        };
        let mut sum = [V::splat(0.0); 3];
        let head = Ends::new::<V>(s).head;
        let mut x = 0;
        while x < s.len {
            let n = if x < head { head } else { V::LANES.min(s.len - x) };
            let mut f = gather::<V, S, Q>(&places, x, n);
            if n == V::LANES && ((x - head) * size_of::<S>()).is_multiple_of(LINE) {
                s.fetch_ahead::<S, Q>(x);
            }
            let momentum = model.collide::<V, true>(&mut f, wide(force, x * stride));
            add(&mut sum, momentum);
            for i in 0..Q {
                let place = places[opposite(i)].wrapping_add(x);
                if n == V::LANES {
                    f[i].store(place);
                } else {
                    f[i].store_first(place, n);
                }
            }
            x += n;
        }
        total(sum)
    }
}

/// What is left of a span before and after its whole vectors. Those of a long span start where a cache line does; in a
/// shorter one that would cost more vectors than it saves.
struct Ends {
    head: usize,
    tail_from: usize,
    tail: usize,
}

impl Ends {
    #[inline(always)]
    fn new<V: Simd>(s: &Span) -> Self {
        let head = if s.len >= LONG * V::LANES {
            s.start.wrapping_neg() % V::LANES
        } else {
            0
        };
        let tail = (s.len - head) % V::LANES;
        Self {
            head,
            tail_from: s.len - tail,
            tail,
        }
    }
}

/// Writes density (less 1) and momentum, lattice units, of the nodes of a span to `to`.
///
/// # Safety
/// As for [`span`]; `len` numbers are valid at each of `to`. The populations are only read.
#[inline(always)]
pub unsafe fn read<M, S, V, const Q: usize>(s: &Span, to: [*mut f64; 4])
where
    M: Model<Q>,
    S: Element,
    V: Stored<S>,
{
    // SAFETY: the contract of this function is that of every call below.
    unsafe {
        let places = s.first::<S, Q>();
        let mut x = 0;
        while x < s.len {
            let n = V::LANES.min(s.len - x);
            let f = gather::<V, S, Q>(&places, x, n);
            let (density, momentum) = moments::<M::Stencil, V, Q>(&f);
            for (v, to) in [density, momentum[0], momentum[1], momentum[2]].into_iter().zip(to) {
                if n == V::LANES {
                    v.store_wide(to.add(x));
                } else {
                    let mut all = [0.0; MAX_LANES];
                    v.store_wide(all.as_mut_ptr());
                    std::ptr::copy_nonoverlapping(all.as_ptr(), to.add(x), n);
                }
            }
            x += n;
        }
    }
}
