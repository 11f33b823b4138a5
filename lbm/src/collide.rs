//! Collision and streaming of a span of nodes in a row: the arithmetic of the fluid.
//!
//! A node reads population `i` at place `i` and writes the collided one to place `opposite(i)`. The caller chooses the
//! places so that this streams as well (Bailey et al. 2009, "AA pattern").

use crate::d3q19::{Q, W_AXIS, W_DIAGONAL, W_REST, opposite};
use crate::relaxation::Coefficients;
use crate::simd::{Simd, prefetch};

/// How far ahead the places are prefetched, in nodes.
const AHEAD: usize = 96;

/// No force.
pub const FREE: u8 = 0;
/// The same force on every node.
pub const UNIFORM: u8 = 1;
/// A force for each node.
pub const PER_NODE: u8 = 2;

/// Nodes of a row that are collided in one go.
pub struct Span<'a> {
    /// Places of the first node.
    pub places: [*mut f64; Q],
    /// Position of the first node in the row.
    pub start: usize,
    /// Number of nodes.
    pub len: usize,
    /// What will be collided next: the places of its row, and its first node.
    pub next: (&'a [*mut f64; Q], usize),
    /// Numbers of the collision.
    pub coefficients: &'a Coefficients,
    /// Force on every node, lattice units (kernel [`UNIFORM`]).
    pub uniform: [f64; 3],
    /// Force on each node, lattice units (kernel [`PER_NODE`]).
    pub force: [*const f64; 3],
}

impl Span<'_> {
    /// Asks for the populations that come some way after node `x`, in this span or the next.
    #[inline(always)]
    fn fetch_ahead(&self, x: usize) {
        let ahead = x + AHEAD.min(self.len);
        let (places, x) = if ahead < self.len {
            (&self.places, ahead)
        } else {
            (self.next.0, self.next.1 + (ahead - self.len))
        };
        for place in places {
            prefetch(place.wrapping_add(x));
        }
    }
}

/// Density (about 1) and momentum of a vector of nodes.
struct Moments<V> {
    density: V,
    momentum: [V; 3],
}

/// Collides a span; returns the sum of the momentum before collision (lattice units) where `TALLY` is set, else zero.
///
/// # Safety
/// The instruction set of `V` is there; `len` numbers are valid at every place, and no other thread touches them; with
/// [`PER_NODE`] `len` numbers are valid at each force.
#[inline(always)]
pub unsafe fn span<V: Simd, const FORCE: u8, const TALLY: bool>(s: &Span) -> [f64; 3] {
    // SAFETY: the contract of this function is that of every call below: ends are shorter than a vector, and the loop
    // stays between them.
    unsafe {
        let mut sum = [V::splat(0.0); 3];
        let ends = Ends::new::<V>(s);
        for (x, n) in [(0, ends.head), (ends.tail_from, ends.tail)] {
            if n == 0 {
                continue;
            }
            let mut f: [V; Q] = std::array::from_fn(|i| V::load_first(s.places[i].add(x), n));
            let force = match FORCE {
                PER_NODE => s.force.map(|p| V::load_first(p.add(x), n)),
                _ => s.uniform.map(|v| V::splat(v)),
            };
            let momentum = collide::<V, FORCE>(&mut f, force, s.coefficients);
            for i in 0..Q {
                f[i].store_first(s.places[opposite(i)].add(x), n);
            }
            if TALLY {
                sum = std::array::from_fn(|a| sum[a].add(momentum[a]));
            }
        }
        let mut x = ends.head;
        while x < ends.tail_from {
            let mut f: [V; Q] = std::array::from_fn(|i| V::load(s.places[i].add(x)));
            if (x - ends.head).is_multiple_of(8) {
                s.fetch_ahead(x);
            }
            let force = match FORCE {
                PER_NODE => s.force.map(|p| V::load(p.add(x))),
                _ => s.uniform.map(|v| V::splat(v)),
            };
            let momentum = collide::<V, FORCE>(&mut f, force, s.coefficients);
            for i in 0..Q {
                f[i].store(s.places[opposite(i)].add(x));
            }
            if TALLY {
                sum = std::array::from_fn(|a| sum[a].add(momentum[a]));
            }
            x += V::LANES;
        }
        if TALLY { sum.map(|v| v.sum()) } else { [0.0; 3] }
    }
}

/// What is left of a span before and after its whole vectors, which start where a cache line does.
struct Ends {
    head: usize,
    tail_from: usize,
    tail: usize,
}

impl Ends {
    #[inline(always)]
    fn new<V: Simd>(s: &Span) -> Self {
        let head = if s.len > V::LANES {
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

/// Two-relaxation-time collision with Guo's force, populations less their weights; returns the momentum before it.
///
/// With `s = f_i + f_-i`, `d = f_i - f_-i`, `u = sum c f + F/2`:
/// `f_i* = (1 - w+)/2 s + (1 - w-)/2 d + w_i [w+ (rho + 4.5 (c.u)^2 - 1.5 u^2) + (1 - w+/2) (9 (c.u)(c.F) - 3 u.F)
/// + 3 w- c.u + 3 (1 - w-/2) c.F]`, and the terms in `c` change sign for `-i`. With `A` and `B` linear in `u` and `F`
/// the bracket is `e + (c.A)(c.u) + c.B`.
#[inline(always)]
unsafe fn collide<V: Simd, const FORCE: u8>(f: &mut [V; Q], force: [V; 3], k: &Coefficients) -> [V; 3] {
    // SAFETY: the instruction set of `V` is there by the contract of `span`.
    unsafe {
        let k = Splat::<V>::new(k);
        let mut s = [f[0]; 9];
        let mut d = [f[0]; 9];
        for p in 0..9 {
            s[p] = f[2 * p + 1].add(f[2 * p + 2]);
            d[p] = f[2 * p + 1].sub(f[2 * p + 2]);
        }
        let Moments { density, momentum } = moments(f[0], &s, &d);
        let u: [V; 3] = match FORCE {
            FREE => momentum,
            _ => std::array::from_fn(|a| force[a].mul_add(V::splat(0.5), momentum[a])),
        };
        let uu = u[0].mul_add(u[0], u[1].mul_add(u[1], u[2].mul(u[2])));
        let mut e = uu.neg_mul_add(k.speed, density.mul(k.density));
        let (a, b): ([V; 3], [V; 3]) = if FORCE == FREE {
            (u.map(|v| v.mul(k.even_velocity)), u.map(|v| v.mul(k.odd_velocity)))
        } else {
            let uf = u[0].mul_add(force[0], u[1].mul_add(force[1], u[2].mul(force[2])));
            e = uf.neg_mul_add(k.power, e);
            let mix = |kv: V, kf: V| std::array::from_fn(|i| u[i].mul_add(kv, force[i].mul(kf)));
            (mix(k.even_velocity, k.even_force), mix(k.odd_velocity, k.odd_force))
        };
        let e_diagonal = e.mul(V::splat(W_DIAGONAL));
        let e_axis = e.mul(V::splat(W_AXIS));
        f[0] = f[0].mul_add(k.rest, e.mul(V::splat(W_REST)));
        let pair = |s: V, d: V, e: V, cu: V, ca: V, cb: V| {
            let even = ca.mul_add(cu, s.mul_add(k.even, e));
            let odd = d.mul_add(k.odd, cb);
            [even.add(odd), even.sub(odd)]
        };
        for i in 0..3 {
            let [plus, minus] = pair(s[i], d[i], e_axis, u[i], a[i].add(a[i]), b[i].add(b[i]));
            f[2 * i + 1] = plus;
            f[2 * i + 2] = minus;
        }
        for (p, [i, j]) in [(3, [0, 1]), (5, [0, 2]), (7, [1, 2])] {
            let [plus, minus] = pair(s[p], d[p], e_diagonal, u[i].add(u[j]), a[i].add(a[j]), b[i].add(b[j]));
            f[2 * p + 1] = plus;
            f[2 * p + 2] = minus;
            let q = p + 1;
            let [plus, minus] = pair(s[q], d[q], e_diagonal, u[i].sub(u[j]), a[i].sub(a[j]), b[i].sub(b[j]));
            f[2 * q + 1] = plus;
            f[2 * q + 2] = minus;
        }
        momentum
    }
}

/// Density (about 1) and momentum from the sums and differences of the nine opposite pairs.
#[inline(always)]
unsafe fn moments<V: Simd>(rest: V, s: &[V; 9], d: &[V; 9]) -> Moments<V> {
    // SAFETY: the instruction set of `V` is there by the contract of `span`.
    unsafe {
        let low = s[0].add(s[1]).add(s[2].add(s[3]));
        let high = s[4].add(s[5]).add(s[6].add(s[7]));
        let density = low.add(high).add(s[8].add(rest));
        let x = d[0].add(d[3].add(d[4])).add(d[5].add(d[6]));
        let y = d[1].add(d[3].sub(d[4])).add(d[7].add(d[8]));
        let z = d[2].add(d[5].sub(d[6])).add(d[7].sub(d[8]));
        Moments {
            density,
            momentum: [x, y, z],
        }
    }
}

/// Writes density (about 1) and momentum, lattice units, of the nodes of a span to `to`.
///
/// # Safety
/// As for [`span`]; `len` numbers are valid at each of `to`. The populations are only read.
#[inline(always)]
pub unsafe fn read<V: Simd>(places: &[*mut f64; Q], len: usize, to: [*mut f64; 4]) {
    // SAFETY: the contract of this function is that of every call below.
    unsafe {
        let mut x = 0;
        while x < len {
            let n = V::LANES.min(len - x);
            let load = |i: usize| {
                let p = places[i].add(x);
                if n == V::LANES { V::load(p) } else { V::load_first(p, n) }
            };
            let f: [V; Q] = std::array::from_fn(load);
            let s: [V; 9] = std::array::from_fn(|p| f[2 * p + 1].add(f[2 * p + 2]));
            let d: [V; 9] = std::array::from_fn(|p| f[2 * p + 1].sub(f[2 * p + 2]));
            let Moments { density, momentum } = moments(f[0], &s, &d);
            for (v, to) in [density, momentum[0], momentum[1], momentum[2]].into_iter().zip(to) {
                if n == V::LANES {
                    v.store(to.add(x))
                } else {
                    v.store_first(to.add(x), n)
                }
            }
            x += n;
        }
    }
}

/// [`Coefficients`] in all lanes.
struct Splat<V> {
    rest: V,
    even: V,
    odd: V,
    density: V,
    speed: V,
    power: V,
    even_velocity: V,
    even_force: V,
    odd_velocity: V,
    odd_force: V,
}

impl<V: Simd> Splat<V> {
    #[inline(always)]
    unsafe fn new(k: &Coefficients) -> Self {
        // SAFETY: the instruction set of `V` is there by the contract of `span`.
        unsafe {
            Self {
                rest: V::splat(k.rest),
                even: V::splat(k.even),
                odd: V::splat(k.odd),
                density: V::splat(k.density),
                speed: V::splat(k.speed),
                power: V::splat(k.power),
                even_velocity: V::splat(k.even_velocity),
                even_force: V::splat(k.even_force),
                odd_velocity: V::splat(k.odd_velocity),
                odd_force: V::splat(k.odd_force),
            }
        }
    }
}
