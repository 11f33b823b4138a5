//! The sums in plain Rust, written so that the compiler vectorises them.

use super::{LANES, Sources, Sum, Want};
use lbm_ibm_coupling::Vec3;

type Lanes = [f64; LANES];

/// Sums at one target with 256-bit vectors.
#[cfg(target_arch = "x86_64")]
pub(super) fn one_avx2(sources: &Sources, x: Vec3, m: Vec3, near2: f64, want: Want) -> Sum {
    #[target_feature(enable = "avx2,fma")]
    fn wide(sources: &Sources, x: Vec3, m: Vec3, near2: f64, want: Want) -> Sum {
        one(sources, x, m, near2, want)
    }
    // SAFETY: the caller has found AVX2 and FMA on this machine.
    unsafe { wide(sources, x, m, near2, want) }
}

/// Sums at one target.
#[inline(always)]
pub(super) fn one(sources: &Sources, x: Vec3, m: Vec3, near2: f64, want: Want) -> Sum {
    match want {
        Want::Field => sum::<true, false>(sources, x, m, near2),
        Want::Force => sum::<false, true>(sources, x, m, near2),
        Want::Both => sum::<true, true>(sources, x, m, near2),
    }
}

#[inline(always)]
fn sum<const FIELD: bool, const FORCE: bool>(sources: &Sources, x: Vec3, m: Vec3, near2: f64) -> Sum {
    let mut field = [[0.0; LANES]; 3];
    let mut force = [[0.0; LANES]; 3];
    let mut along = [0.0; LANES];
    let [px, py, pz] = &sources.x;
    let [mx, my, mz] = &sources.m;
    for k in (0..px.len()).step_by(LANES) {
        let load = |a: &[f64]| -> Lanes { std::array::from_fn(|l| a[k + l]) };
        let (px, py, pz) = (load(px), load(py), load(pz));
        let (mx, my, mz) = (load(mx), load(my), load(mz));
        for l in 0..LANES {
            let (rx, ry, rz) = (x.x - px[l], x.y - py[l], x.z - pz[l]);
            let r2 = rx * rx + ry * ry + rz * rz;
            let keep = r2 >= near2;
            let inv2 = if keep { 1.0 / r2 } else { 0.0 };
            let inv3 = inv2 * inv2.sqrt();
            let inv5 = inv3 * inv2;
            let source = mx[l] * rx + my[l] * ry + mz[l] * rz;
            if FIELD {
                let w = 3.0 * source * inv5;
                field[0][l] += w * rx - inv3 * mx[l];
                field[1][l] += w * ry - inv3 * my[l];
                field[2][l] += w * rz - inv3 * mz[l];
            }
            if FORCE {
                let target = m.x * rx + m.y * ry + m.z * rz;
                let both = m.x * mx[l] + m.y * my[l] + m.z * mz[l];
                let w = inv5 * (both - 5.0 * target * source * inv2);
                let v = inv5 * target;
                along[l] += inv5 * source;
                force[0][l] += w * rx + v * mx[l];
                force[1][l] += w * ry + v * my[l];
                force[2][l] += w * rz + v * mz[l];
            }
        }
    }
    let total = |a: [Lanes; 3]| Vec3::from(a.map(|lanes| lanes.iter().sum::<f64>()));
    Sum {
        field: total(field),
        force: 3.0 * (total(force) + m * along.iter().sum::<f64>()),
    }
}
