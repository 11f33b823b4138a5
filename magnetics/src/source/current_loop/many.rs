//! The trapezoid rule of a loop at eight points; near the wire the elliptic integrals are asked.

use super::{CurrentLoop, NEAR, POINTS};
use crate::MU0;
use crate::kernel::lanes::{Isa, Lanes, dot, minus, same};
use crate::source::batch::{Batch, Eight};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// Cosines of the rule's points in the first quarter.
static COSINES: LazyLock<[f64; POINTS / 4]> =
    LazyLock::new(|| std::array::from_fn(|k| ((k as f64 + 0.5) * TAU / POINTS as f64).cos()));

impl Batch for CurrentLoop {
    #[inline(always)]
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V> {
        let zero = isa.splat(0.0);
        let n = same(isa, self.axis);
        let p = minus(x, same(isa, self.centre));
        let z = dot(p, n);
        let across = [p[0] - n[0] * z, p[1] - n[1] * z, p[2] - n[2] * z];
        let rho2 = dot(across, across);
        let rho = rho2.sqrt();
        let radius = isa.splat(self.radius);
        let total = radius.mul_add(radius, z.mul_add(z, rho2));
        let mut special = I::V::select(
            total.less(isa.splat(2.0 * NEAR * self.radius) * rho),
            isa.splat(1.0),
            zero,
        );
        // The axis, and what is beyond the range of powers of r.
        special = I::V::select(zero.less(rho), special, isa.splat(1.0));
        special = I::V::select(isa.splat(1e30).less(total), isa.splat(1.0), special);
        let (mut a, mut b, mut c, mut d) = (zero, zero, zero, zero);
        for cosine in COSINES.iter() {
            let (cos, half) = (isa.splat(*cosine), isa.splat(2.0 * self.radius * cosine));
            let (near, far) = (total - half * rho, half.mul_add(rho, total));
            let (s, t) = (near.sqrt(), far.sqrt());
            let (u, v) = (isa.splat(1.0) / s, isa.splat(1.0) / t);
            let uv = u * v;
            let (u2, v2) = (u * u, v * v);
            let gap = (half + half) * uv / (s + t);
            a = a + u2.mul_add(u, v2 * v);
            let along = cos * gap;
            b = along.mul_add(u2 + uv + v2, b);
            if GRADIENT {
                let (u3, v3) = (u2 * u, v2 * v);
                c = c + u3.mul_add(u2, v3 * v2);
                let four = (u2 + v2) * uv + uv * uv;
                d = along.mul_add(u2.mul_add(u2, v2.mul_add(v2, four)), d);
            }
        }
        // The rule's weight, four points each, and mu0 I R/(4 pi).
        let scale = isa.splat(2.0 * TAU / POINTS as f64 * MU0 * self.current * self.radius / (4.0 * PI));
        (a, b, c, d) = (a * scale, b * scale, c * scale, d * scale);
        let outward = z * b;
        let axial = radius * a - rho2 * b;
        let mut out = Eight::zero(isa);
        out.special = special;
        for k in 0..3 {
            out.field[k] = across[k].mul_add(outward, n[k] * axial);
        }
        if GRADIENT {
            let axial_z = isa.splat(-3.0) * z * (radius * c - rho2 * d);
            let outward_rho = -(axial_z + outward);
            let mixed = b - isa.splat(3.0) * z * z * d;
            // outward (1 - nn - ee) + outward_rho ee + axial_z nn + mixed (across n + n across), e = across/rho.
            let radial = (outward_rho - outward) / rho2;
            let along = axial_z - outward;
            let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
            for k in 0..6 {
                let (i, j) = pairs[k];
                let turn = across[i].mul_add(n[j], n[i] * across[j]);
                let g = (radial * across[i]).mul_add(across[j], (along * n[i]).mul_add(n[j], mixed * turn));
                out.gradient[k] = if i == j { g + outward } else { g };
            }
        }
        out
    }
}
