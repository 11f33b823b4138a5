//! The sums with 512-bit vectors: reciprocal square root to 14 bits and two Newton steps.

use super::{LANES, Sources, Sum, Want};
use lbm_ibm_coupling::Vec3;
use std::arch::x86_64::*;

/// Sums at one target.
pub(super) fn one(sources: &Sources, x: Vec3, m: Vec3, near2: f64, want: Want) -> Sum {
    // SAFETY: the caller has found AVX-512F on this machine.
    unsafe {
        match want {
            Want::Field => sum::<true, false>(sources, x, m, near2),
            Want::Force => sum::<false, true>(sources, x, m, near2),
            Want::Both => sum::<true, true>(sources, x, m, near2),
        }
    }
}

#[inline]
#[target_feature(enable = "avx512f")]
fn load(chunk: &[f64; LANES]) -> __m512d {
    // SAFETY: the chunk has eight values, and the load asks for no alignment.
    unsafe { _mm512_loadu_pd(chunk.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx512f")]
fn dot(a: [__m512d; 3], b: [__m512d; 3]) -> __m512d {
    let xy = _mm512_fmadd_pd(a[0], b[0], _mm512_mul_pd(a[1], b[1]));
    _mm512_fmadd_pd(a[2], b[2], xy)
}

#[inline]
#[target_feature(enable = "avx512f")]
fn total(a: [__m512d; 3]) -> Vec3 {
    Vec3::new(
        _mm512_reduce_add_pd(a[0]),
        _mm512_reduce_add_pd(a[1]),
        _mm512_reduce_add_pd(a[2]),
    )
}

#[target_feature(enable = "avx512f")]
fn sum<const FIELD: bool, const FORCE: bool>(sources: &Sources, x: Vec3, m: Vec3, near2: f64) -> Sum {
    let zero = _mm512_setzero_pd();
    let splat = |v: Vec3| [_mm512_set1_pd(v.x), _mm512_set1_pd(v.y), _mm512_set1_pd(v.z)];
    let (target, moment, near2) = (splat(x), splat(m), _mm512_set1_pd(near2));
    let (three_halves, minus_five) = (_mm512_set1_pd(1.5), _mm512_set1_pd(-5.0));
    let (minus_half, three) = (_mm512_set1_pd(-0.5), _mm512_set1_pd(3.0));
    let (mut field, mut force, mut along) = ([zero; 3], [zero; 3], zero);
    let chunks = sources.x[0].len() / LANES;
    let [x0, x1, x2] = sources.x.each_ref().map(|a| &a.as_chunks::<LANES>().0[..chunks]);
    let [m0, m1, m2] = sources.m.each_ref().map(|a| &a.as_chunks::<LANES>().0[..chunks]);
    for k in 0..chunks {
        let p = [load(&x0[k]), load(&x1[k]), load(&x2[k])];
        let s = [load(&m0[k]), load(&m1[k]), load(&m2[k])];
        let r = [
            _mm512_sub_pd(target[0], p[0]),
            _mm512_sub_pd(target[1], p[1]),
            _mm512_sub_pd(target[2], p[2]),
        ];
        let r2 = dot(r, r);
        let keep = _mm512_cmp_pd_mask::<_CMP_GE_OQ>(r2, near2);
        let mut inv = _mm512_maskz_rsqrt14_pd(keep, r2);
        let half = _mm512_mul_pd(minus_half, r2);
        for _ in 0..2 {
            let step = _mm512_fmadd_pd(_mm512_mul_pd(half, inv), inv, three_halves);
            inv = _mm512_mul_pd(inv, step);
        }
        let inv2 = _mm512_mul_pd(inv, inv);
        let inv3 = _mm512_mul_pd(inv2, inv);
        let inv5 = _mm512_mul_pd(inv3, inv2);
        let source = dot(s, r);
        let pull = _mm512_mul_pd(inv5, source);
        if FIELD {
            let w = _mm512_mul_pd(three, pull);
            for c in 0..3 {
                field[c] = _mm512_fmadd_pd(w, r[c], field[c]);
                field[c] = _mm512_fnmadd_pd(inv3, s[c], field[c]);
            }
        }
        if FORCE {
            let v = _mm512_mul_pd(inv5, dot(moment, r));
            let both = dot(moment, s);
            let five = _mm512_mul_pd(_mm512_mul_pd(minus_five, inv2), source);
            let w = _mm512_fmadd_pd(five, v, _mm512_mul_pd(inv5, both));
            along = _mm512_add_pd(along, pull);
            for c in 0..3 {
                force[c] = _mm512_fmadd_pd(w, r[c], force[c]);
                force[c] = _mm512_fmadd_pd(v, s[c], force[c]);
            }
        }
    }
    Sum {
        field: total(field),
        force: 3.0 * (total(force) + m * _mm512_reduce_add_pd(along)),
    }
}
