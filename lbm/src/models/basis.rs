//! Populations to raw moments and back, stencil by stencil.
//!
//! The moments of a stencil are its monomials `c_x^a c_y^b c_z^c` with powers up to 2: as many as it has velocities. Even and
//! odd ones part, and so do corners, face diagonals and axes: going back peels corners off the moments, then diagonals, then
//! axes, and what is left is at rest.

use crate::models::low::{Low, Third};
use crate::models::shift::{Central, fourth19};
use crate::real::Real;
use crate::stencil::{D2Q9, D3Q19, D3Q27, Stencil};

/// Stencils whose moments the models of [`crate::models`] know.
pub trait Basis<const Q: usize>: Stencil<Q> + Clone + Send + Sync {
    /// Axes along which there is motion.
    const AXES: usize;

    /// Moments to second order, and those of third. What the stencil lacks is zero.
    fn low<V: Real>(f: &[V; Q]) -> (Low<V>, Third<V>);

    /// Populations with these Hermite moments: density (about 1, less 1), momentum and second order (xx, yy, zz, xy, xz, yz). Those of
    /// higher order are zero.
    fn plain<V: Real>(density: V, momentum: [V; 3], second: [V; 6]) -> [V; Q];

    /// Populations with these central moments.
    fn central<V: Real, const FORCE: bool>(c: &Central<V>) -> [V; Q];

    /// The same, less moments that are not of the stencil's own orthogonal polynomials.
    #[inline(always)]
    fn recursive<V: Real, const FORCE: bool>(c: &Central<V>) -> [V; Q] {
        Self::central::<V, FORCE>(c)
    }
}

/// Moments of third and fourth order of the nineteen velocities, and those below.
pub struct Raw19<V> {
    pub low: Low<V>,
    /// The first six of [`Third`].
    pub third: [V; 6],
    /// xxyy, xxzz, yyzz.
    pub fourth: [V; 3],
}

/// Where populations of the planes xy, xz and yz start, and the places of their moments among [`Third`]: `a b b` and
/// `b a a`.
const PAIRS: [(usize, usize, usize); 3] = [(7, 0, 2), (11, 1, 4), (15, 3, 5)];

/// Moments of the nineteen velocities, from the first nineteen of `f`.
#[inline(always)]
pub fn raw19<V: Real>(f: &[V]) -> Raw19<V> {
    let zero = f[0].like(0.0);
    let mut third = [zero; 6];
    let mut fourth = [zero; 3];
    let mut across = [zero; 3];
    for (p, (start, abb, baa)) in PAIRS.into_iter().enumerate() {
        let (s, d) = (f[start] + f[start + 1], f[start] - f[start + 1]);
        let (t, e) = (f[start + 2] + f[start + 3], f[start + 2] - f[start + 3]);
        fourth[p] = s + t;
        across[p] = s - t;
        third[abb] = d + e;
        third[baa] = d - e;
    }
    let [xy, xz, yz] = fourth;
    let x = (f[1] + f[2], f[1] - f[2]);
    let y = (f[3] + f[4], f[3] - f[4]);
    let z = (f[5] + f[6], f[5] - f[6]);
    Raw19 {
        low: Low {
            density: f[0] + (x.0 + y.0 + z.0) + (xy + xz + yz),
            momentum: [
                x.1 + (third[0] + third[1]),
                y.1 + (third[2] + third[3]),
                z.1 + (third[4] + third[5]),
            ],
            second: [
                x.0 + (xy + xz),
                y.0 + (xy + yz),
                z.0 + (xz + yz),
                across[0],
                across[1],
                across[2],
            ],
        },
        third,
        fourth,
    }
}

/// `(s + d) share` and `(s - d) share`.
#[inline(always)]
fn pair<V: Real>(s: V, d: V, share: V) -> [V; 2] {
    let s = s * share;
    [d.mul_add(share, s), d.neg_mul_add(share, s)]
}

/// Writes the populations of the first nineteen velocities.
#[inline(always)]
pub fn populations19<V: Real>(raw: &Raw19<V>, f: &mut [V]) {
    let Low {
        density,
        momentum: [x, y, z],
        second: [xx, yy, zz, ..],
    } = raw.low;
    let (half, quarter) = (density.like(0.5), density.like(0.25));
    let [xyy, xzz, yxx, yzz, zxx, zyy] = raw.third;
    let [xy, xz, yz] = raw.fourth;
    f[0] = density - (xx + yy + zz) + (xy + xz + yz);
    [f[1], f[2]] = pair(xx - (xy + xz), x - (xyy + xzz), half);
    [f[3], f[4]] = pair(yy - (xy + yz), y - (yxx + yzz), half);
    [f[5], f[6]] = pair(zz - (xz + yz), z - (zxx + zyy), half);
    for (p, (start, abb, baa)) in PAIRS.into_iter().enumerate() {
        let [s, t] = pair(raw.fourth[p], raw.low.second[3 + p], quarter);
        let [d, e] = pair(raw.third[abb], raw.third[baa], quarter);
        [f[start], f[start + 1]] = [s + d, s - d];
        [f[start + 2], f[start + 3]] = [t + e, t - e];
    }
}

/// `a / 3 + b`.
#[inline(always)]
pub fn third_of<V: Real>(a: V, b: V) -> V {
    a.mul_add(a.like(1.0 / 3.0), b)
}

/// Raw moments of third order from Hermite ones.
#[inline(always)]
pub fn raise_third<V: Real>(first: &[V; 3], third: Option<[V; 6]>) -> [V; 6] {
    let mut raw = [first[0]; 6];
    for n in 0..6 {
        let plain = first[n / 2] * first[0].like(1.0 / 3.0);
        raw[n] = match third {
            Some(h) => h[n] + plain,
            None => plain,
        };
    }
    raw
}

/// Raw moments to second order from Hermite ones.
#[inline(always)]
pub fn raise_low<V: Real>(density: V, momentum: [V; 3], second: &[V; 6]) -> Low<V> {
    let mut raw = *second;
    for a in 0..3 {
        raw[a] = third_of(density, raw[a]);
    }
    Low {
        density,
        momentum,
        second: raw,
    }
}

/// Raw moments xxyy, xxzz, yyzz of fourth order from Hermite ones of second, those of fourth being zero.
#[inline(always)]
pub fn raise_fourth<V: Real>(density: V, second: &[V; 6]) -> [V; 3] {
    let [xx, yy, zz, ..] = *second;
    let ninth = density * density.like(1.0 / 9.0);
    [
        third_of(xx + yy, ninth),
        third_of(xx + zz, ninth),
        third_of(yy + zz, ninth),
    ]
}

impl Basis<19> for D3Q19 {
    const AXES: usize = 3;

    #[inline(always)]
    fn low<V: Real>(f: &[V; 19]) -> (Low<V>, Third<V>) {
        let raw = raw19(f);
        let [a, b, c, d, e, g] = raw.third;
        (raw.low, [a, b, c, d, e, g, f[0].like(0.0)])
    }

    #[inline(always)]
    fn plain<V: Real>(density: V, momentum: [V; 3], second: [V; 6]) -> [V; 19] {
        let raw = Raw19 {
            low: raise_low(density, momentum, &second),
            third: raise_third(&momentum, None),
            fourth: fourth19(density, &second),
        };
        let mut f = [density; 19];
        populations19(&raw, &mut f);
        f
    }

    #[inline(always)]
    fn central<V: Real, const FORCE: bool>(c: &Central<V>) -> [V; 19] {
        let mut f = [c.density; 19];
        populations19(&c.raw19::<FORCE>(), &mut f);
        f
    }

    #[inline(always)]
    fn recursive<V: Real, const FORCE: bool>(c: &Central<V>) -> [V; 19] {
        let mut f = [c.density; 19];
        populations19(&c.raw19_to_third::<FORCE>(), &mut f);
        f
    }
}

/// Moments of the four pairs of corners.
pub struct Corners<V> {
    /// All, yz, xz, xy: the moments xxyyzz, xxyz, xyyz, xyzz.
    pub even: [V; 4],
    /// x, y, z, xyz: the moments xyyzz, xxyzz, xxyyz, xyz.
    pub odd: [V; 4],
}

/// Sums of four with the signs of x, y, z and their products at the corners; four times its own inverse.
#[inline(always)]
fn signs<V: Real>([a, b, c, d]: [V; 4]) -> [V; 4] {
    let (p, q, r, s) = (a + b, c + d, a - b, c - d);
    [p + q, p - q, r + s, r - s]
}

/// Moments of the corners from the last eight populations.
#[inline(always)]
fn corners<V: Real>(f: &[V; 27]) -> Corners<V> {
    let (mut s, mut d) = ([f[0]; 4], [f[0]; 4]);
    for p in 0..4 {
        (s[p], d[p]) = (f[19 + 2 * p] + f[20 + 2 * p], f[19 + 2 * p] - f[20 + 2 * p]);
    }
    let [all, xy, xz, yz] = signs(s);
    Corners {
        even: [all, yz, xz, xy],
        odd: signs(d),
    }
}

/// Populations from the moments of the nineteen velocities, which count corners too, and those of the corners.
#[inline(always)]
pub fn populations27<V: Real>(mut raw: Raw19<V>, corners: &Corners<V>) -> [V; 27] {
    let [all, yz, xz, xy] = corners.even;
    let [x, y, z, xyz] = corners.odd;
    raw.low.density = raw.low.density - all;
    for (n, corner) in [x, y, z].into_iter().enumerate() {
        raw.low.momentum[n] = raw.low.momentum[n] - corner;
        raw.fourth[n] = raw.fourth[n] - all;
    }
    for (n, corner) in [all, all, all, xy, xz, yz].into_iter().enumerate() {
        raw.low.second[n] = raw.low.second[n] - corner;
    }
    for (n, corner) in [x, x, y, y, z, z].into_iter().enumerate() {
        raw.third[n] = raw.third[n] - corner;
    }
    let mut f = [all; 27];
    populations19(&raw, &mut f);
    let eighth = all.like(0.125);
    let s = signs([all * eighth, xy * eighth, xz * eighth, yz * eighth]);
    let d = signs([x * eighth, y * eighth, z * eighth, xyz * eighth]);
    for p in 0..4 {
        [f[19 + 2 * p], f[20 + 2 * p]] = [s[p] + d[p], s[p] - d[p]];
    }
    f
}

impl Basis<27> for D3Q27 {
    const AXES: usize = 3;

    #[inline(always)]
    fn low<V: Real>(f: &[V; 27]) -> (Low<V>, Third<V>) {
        let raw = raw19(f);
        let Corners {
            even: [all, yz, xz, xy],
            odd: [x, y, z, xyz],
        } = corners(f);
        let [xyy, xzz, yxx, yzz, zxx, zyy] = raw.third;
        let mut second = raw.low.second;
        for (n, more) in [all, all, all, xy, xz, yz].into_iter().enumerate() {
            second[n] = second[n] + more;
        }
        let [jx, jy, jz] = raw.low.momentum;
        let low = Low {
            density: raw.low.density + all,
            momentum: [jx + x, jy + y, jz + z],
            second,
        };
        (low, [xyy + x, xzz + x, yxx + y, yzz + y, zxx + z, zyy + z, xyz])
    }

    #[inline(always)]
    fn plain<V: Real>(density: V, momentum: [V; 3], second: [V; 6]) -> [V; 27] {
        let (third_part, ninth) = (density.like(1.0 / 3.0), density.like(1.0 / 9.0));
        let [xx, yy, zz, xy, xz, yz] = second;
        let raw = Raw19 {
            low: raise_low(density, momentum, &second),
            third: raise_third(&momentum, None),
            fourth: raise_fourth(density, &second),
        };
        let [x, y, z] = [momentum[0] * ninth, momentum[1] * ninth, momentum[2] * ninth];
        let corners = Corners {
            even: [
                (xx + yy + zz).mul_add(ninth, density * density.like(1.0 / 27.0)),
                yz * third_part,
                xz * third_part,
                xy * third_part,
            ],
            odd: [x, y, z, density.like(0.0)],
        };
        populations27(raw, &corners)
    }

    #[inline(always)]
    fn central<V: Real, const FORCE: bool>(c: &Central<V>) -> [V; 27] {
        let (raw, corners) = c.raw27::<FORCE>();
        populations27(raw, &corners)
    }
}

/// Populations of the nine velocities from the moments 1; x, y; xx, yy, xy; xyy, yxx; xxyy.
#[inline(always)]
pub fn populations9<V: Real>(density: V, [x, y]: [V; 2], [xx, yy, xy]: [V; 3], [xyy, yxx]: [V; 2], all: V) -> [V; 9] {
    let (half, quarter) = (density.like(0.5), density.like(0.25));
    let [a, b] = pair(xx - all, x - xyy, half);
    let [c, d] = pair(yy - all, y - yxx, half);
    let [e, f] = pair(all + xy, xyy + yxx, quarter);
    let [g, h] = pair(all - xy, xyy - yxx, quarter);
    [density - (xx + yy) + all, a, b, c, d, e, f, g, h]
}

impl Basis<9> for D2Q9 {
    const AXES: usize = 2;

    #[inline(always)]
    fn low<V: Real>(f: &[V; 9]) -> (Low<V>, Third<V>) {
        let zero = f[0].like(0.0);
        let x = (f[1] + f[2], f[1] - f[2]);
        let y = (f[3] + f[4], f[3] - f[4]);
        let p = (f[5] + f[6], f[5] - f[6]);
        let q = (f[7] + f[8], f[7] - f[8]);
        let (all, xyy, yxx) = (p.0 + q.0, p.1 + q.1, p.1 - q.1);
        let low = Low {
            density: f[0] + (x.0 + y.0) + all,
            momentum: [x.1 + xyy, y.1 + yxx, zero],
            second: [x.0 + all, y.0 + all, zero, p.0 - q.0, zero, zero],
        };
        (low, [xyy, zero, yxx, zero, zero, zero, zero])
    }

    #[inline(always)]
    fn plain<V: Real>(density: V, [x, y, _]: [V; 3], second: [V; 6]) -> [V; 9] {
        let [xyy, _, yxx, ..] = raise_third(&[x, y, density], None);
        let [all, ..] = raise_fourth(density, &second);
        let [xx, yy, _, xy, ..] = raise_low(density, [x, y, density], &second).second;
        populations9(density, [x, y], [xx, yy, xy], [xyy, yxx], all)
    }

    #[inline(always)]
    fn central<V: Real, const FORCE: bool>(c: &Central<V>) -> [V; 9] {
        let raw = c.raw19::<FORCE>();
        let ([x, y, _], [xx, yy, _, xy, ..], [xyy, _, yxx, ..]) = (raw.low.momentum, raw.low.second, raw.third);
        populations9(raw.low.density, [x, y], [xx, yy, xy], [xyy, yxx], raw.fourth[0])
    }
}
