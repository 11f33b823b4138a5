//! Elements of a mesh some at a time, so that the arithmetic of a law runs on whole vectors.

use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Elements at a time.
pub(super) const BATCH: usize = 64;
/// One number for each of them.
pub(super) type Lanes = [f64; BATCH];
/// One vector for each of them.
pub(super) type Vectors = [Lanes; 3];

/// Room for vectors.
pub(super) const ZERO: Vectors = [[0.0; BATCH]; 3];

/// Positions of the nodes of at most [`BATCH`] elements. Lanes without an element keep what they held.
#[inline(always)]
pub(super) fn gather<const N: usize>(x: Soa3Ref<'_>, elements: &[[u32; N]], out: &mut [Vectors; N]) {
    // Known to be as long as each other, so that one look at the bounds will do.
    let n = x.x.len();
    let (x, y, z) = (x.x, &x.y[..n], &x.z[..n]);
    for (l, nodes) in elements.iter().enumerate().take(BATCH) {
        for p in 0..N {
            let i = nodes[p] as usize;
            out[p][0][l] = x[i];
            out[p][1][l] = y[i];
            out[p][2][l] = z[i];
        }
    }
}

/// Adds the forces on the nodes of at most [`BATCH`] elements, in the order of the elements.
#[inline(always)]
pub(super) fn scatter<const N: usize>(forces: &[Vectors; N], elements: &[[u32; N]], force: &mut Soa3Mut<'_>) {
    let n = force.x.len();
    let (x, y, z) = (&mut *force.x, &mut force.y[..n], &mut force.z[..n]);
    for (l, nodes) in elements.iter().enumerate().take(BATCH) {
        for p in 0..N {
            let i = nodes[p] as usize;
            x[i] += forces[p][0][l];
            y[i] += forces[p][1][l];
            z[i] += forces[p][2][l];
        }
    }
}

/// Sum of the first `n` lanes: eight sums side by side, then those.
#[inline(always)]
pub(super) fn sum(of: &Lanes, n: usize) -> f64 {
    let mut partial = [0.0; 8];
    for (l, v) in of[..n].iter().enumerate() {
        partial[l % 8] += v;
    }
    partial.iter().sum()
}

/// One lane of a vector.
#[inline(always)]
pub(super) fn at(v: &Vectors, l: usize) -> [f64; 3] {
    [v[0][l], v[1][l], v[2][l]]
}

#[inline(always)]
pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Coefficients of `(atan z / z - 1) / z^2` in powers of `z^2` for `z` to tan(pi/8), by Remez' exchange; error of atan
/// 3.5e-17 of its value, before rounding.
const ATAN: [f64; 10] = [
    -0.3333333333333022,
    0.19999999999103935,
    -0.1428571419646232,
    0.11111106700802888,
    -0.09090783462413099,
    0.07690082399440387,
    -0.06641237799087964,
    0.05693119973312209,
    -0.043606944172693056,
    0.02127852315671353,
];
/// tan(pi/8).
const TAN_PI_8: f64 = 0.414_213_562_373_095_03;

/// `atan2(y, x)` without branches, so that a loop of it becomes vectors; zero where both are zero.
#[inline(always)]
pub(super) fn atan2(y: f64, x: f64) -> f64 {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = if ay > ax { (ax, ay) } else { (ay, ax) };
    // Beyond pi/8 the angle from pi/4.
    let far = small > TAN_PI_8 * large;
    let above = if far { small - large } else { small };
    let below = if far { small + large } else { large };
    let z = above / if below > 0.0 { below } else { 1.0 };
    let square = z * z;
    let mut p = ATAN[9];
    for k in (0..9).rev() {
        p = p * square + ATAN[k];
    }
    let first = (z + z * square * p) + if far { FRAC_PI_4 } else { 0.0 };
    let half = if ay > ax { FRAC_PI_2 - first } else { first };
    let whole = if x < 0.0 { PI - half } else { half };
    if y < 0.0 { -whole } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn atan2_is_that_of_the_standard_library() {
        for i in 0..20_000 {
            let (sin, cos) = (0.000_314_159 * i as f64 - PI).sin_cos();
            for size in [1.0, 3e-24, 7e8] {
                let (y, x) = (size * sin, size * cos);
                let exact = y.atan2(x);
                assert!((atan2(y, x) - exact).abs() <= 4.5e-16 * exact.abs(), "{y:e} {x:e}");
            }
        }
        for (y, x) in [
            (0.0, 1.0),
            (0.0, -1.0),
            (1.0, 0.0),
            (-1.0, 0.0),
            (0.0, 0.0),
            (1e-300, -1.0),
        ] {
            assert!((atan2(y, x) - f64::atan2(y, x)).abs() < 1e-15, "{y} {x}");
        }
    }

    #[test]
    fn sums_are_those_of_the_lanes_asked_for() {
        let lanes: Lanes = std::array::from_fn(|l| (l + 1) as f64);
        assert_eq!(sum(&lanes, 13), 91.0);
        assert_eq!(sum(&lanes, 64), 2080.0);
    }
}
