//! The closed form of a sheet at eight points.
//!
//! With S = r1 + r2 of an edge of length l and e = S - l, summed without cancellation, the difference of two parallel
//! edges' logarithms ln((S + l)/(S - l)) is the logarithm of one ratio; the four angles add up as the angle of a product of
//! complex numbers, whose turn is known from the side and the projection of the point.

use super::{ChargeSheet, FAR, SheetPair};
use crate::kernel::lanes::{Isa, Lanes, angle, dot, ln_ratio};
use crate::source::batch::{Batch, Eight, to_frame};
use std::f64::consts::{PI, TAU};

/// Nearer to the line of an edge than this fraction of the shorter half edge the source's own formula is asked.
const LINE: f64 = 1e-7;

/// An edge seen from eight points: `s` to its two ends along it, `r` to them.
struct Edge<V> {
    /// r1 + r2 - l.
    excess: V,
    /// 1/(r0 (s0 + r0)) - 1/(r1 (s1 + r1)).
    slope: V,
    /// 1/r to both ends.
    inverse: [V; 2],
}

#[inline(always)]
fn edge<I: Isa>(isa: I, s: [I::V; 2], r: [I::V; 2], rho2: I::V) -> Edge<I::V> {
    let (zero, one) = (isa.splat(0.0), isa.splat(1.0));
    let q = [r[0] + s[0].abs(), r[1] + s[1].abs()];
    let end = [one / (r[0] * q[0]), one / (r[1] * q[1])];
    let inverse = [end[0] * q[0], end[1] * q[1]];
    let before = zero.less(s[0]);
    let after = s[1].less(zero);
    let first = I::V::select(before, rho2 * end[0] * r[0], q[0]);
    let second = I::V::select(after, rho2 * end[1] * r[1], q[1]);
    let apart = end[0] - end[1];
    let between = (s[1] * inverse[1] - s[0] * inverse[0]) / rho2;
    let outside = I::V::select(after, -apart, apart);
    // Both signs: the foot of the point is on the edge.
    let slope = I::V::select(after, I::V::select(before, between, outside), outside);
    Edge {
        excess: first + second,
        slope,
        inverse,
    }
}

/// ln((e1 + 2l)/e1) - ln((e0 + 2l)/e0).
#[inline(always)]
fn difference<I: Isa>(isa: I, one: I::V, zero: I::V, length: f64) -> I::V {
    let twice = isa.splat(2.0 * length);
    let (above, below) = ((one + twice) * zero, (zero + twice) * one);
    ln_ratio(isa, above, below, twice * (zero - one))
}

#[inline(always)]
fn product<V: Lanes>(a: [V; 2], b: [V; 2]) -> [V; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

impl Batch for ChargeSheet {
    #[inline(always)]
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V> {
        let [a, b] = self.half;
        let scale = isa.splat(self.density / (4.0 * PI));
        let (zero, one) = (isa.splat(0.0), isa.splat(1.0));
        let p = to_frame(isa, x, self.centre, &self.axes);
        let (u, v, z) = (
            [p[0] + isa.splat(a), p[0] - isa.splat(a)],
            [p[1] + isa.splat(b), p[1] - isa.splat(b)],
            p[2].abs(),
        );
        let z2 = z * z;
        let along_v = [u[0].mul_add(u[0], z2), u[1].mul_add(u[1], z2)];
        let along_u = [v[0].mul_add(v[0], z2), v[1].mul_add(v[1], z2)];
        let r = [
            [
                v[0].mul_add(v[0], along_v[0]).sqrt(),
                v[1].mul_add(v[1], along_v[0]).sqrt(),
            ],
            [
                v[0].mul_add(v[0], along_v[1]).sqrt(),
                v[1].mul_add(v[1], along_v[1]).sqrt(),
            ],
        ];
        let line = isa.splat((LINE * a.min(b)).powi(2));
        let mut special = I::V::select(isa.splat((FAR * a.max(b)).powi(2)).less(dot(p, p)), one, zero);
        special = I::V::select(zero.less(z), special, one);
        for rho2 in [along_v[0], along_v[1], along_u[0], along_u[1]] {
            special = I::V::select(rho2.less(line), one, special);
        }
        let e = [edge(isa, v, r[0], along_v[0]), edge(isa, v, r[1], along_v[1])];
        let f = [
            edge(isa, u, [r[0][0], r[1][0]], along_u[0]),
            edge(isa, u, [r[0][1], r[1][1]], along_u[1]),
        ];
        // The angles of z r + i u v, two of them taken away.
        let near = product([z * r[0][0], u[0] * v[0]], [z * r[0][1], -(u[0] * v[1])]);
        let far = product([z * r[1][0], -(u[1] * v[0])], [z * r[1][1], u[1] * v[1]]);
        let turn = product(near, far);
        let solid = angle(isa, turn[0], turn[1]);
        let over_u = I::V::select(p[0].abs().less(isa.splat(a)), one, zero);
        let over = I::V::select(p[1].abs().less(isa.splat(b)), over_u, zero);
        let full = I::V::select(solid.less(zero), isa.splat(TAU) * over, zero);
        let solid = solid + full;
        let down = p[2].less(zero);
        let field = [
            difference(isa, e[1].excess, e[0].excess, 2.0 * b) * scale,
            difference(isa, f[1].excess, f[0].excess, 2.0 * a) * scale,
            I::V::select(down, -solid, solid) * scale,
        ];
        let mut gradient = [zero; 6];
        if GRADIENT {
            let xx = u[1] * e[1].slope - u[0] * e[0].slope;
            let yy = v[1] * f[1].slope - v[0] * f[0].slope;
            let xy = (e[1].inverse[0] - e[1].inverse[1]) - (e[0].inverse[0] - e[0].inverse[1]);
            let xz = p[2] * (e[1].slope - e[0].slope);
            let yz = p[2] * (f[1].slope - f[0].slope);
            gradient = [
                xx * scale,
                xy * scale,
                xz * scale,
                yy * scale,
                yz * scale,
                -(xx + yy) * scale,
            ];
        }
        let local = Eight {
            field,
            gradient,
            special,
        };
        local.turned::<I, GRADIENT>(isa, &self.axes)
    }
}

impl Batch for SheetPair {
    #[inline(always)]
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V> {
        let bottom = self.bottom.eight::<I, GRADIENT>(isa, x);
        bottom.plus(self.top.eight::<I, GRADIENT>(isa, x))
    }
}
