//! Two forces in one sweep: what two sets of moments do to two others at the same places.

use super::Sources;
use super::lanes::{Isa, LANES, Lanes, Work, dot, minus, same, sum, total, vectors};
use lbm_ibm_coupling::Vec3;

/// Sum of the forces of `by` on `on` and of `also_by` on `also_on`, at one target.
pub(super) struct Both<'a> {
    pub by: &'a Sources,
    pub also_by: &'a Sources,
    pub x: Vec3,
    pub on: Vec3,
    pub also_on: Vec3,
    pub near2: f64,
}

impl Work for Both<'_> {
    type Out = Vec3;
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) -> Vec3 {
        let zero = isa.splat(0.0);
        let (mut force, mut along, mut also_along) = ([zero; 3], zero, zero);
        let (near2, one, minus_five) = (isa.splat(self.near2), isa.splat(1.0), isa.splat(-5.0));
        let (x, on, also_on) = (same(isa, self.x), same(isa, self.on), same(isa, self.also_on));
        let [places, by, also_by] = [slices(&self.by.x), slices(&self.by.m), slices(&self.also_by.m)];
        for at in (0..places[0].len()).step_by(LANES) {
            let (m, also_m) = (vectors(isa, by, at), vectors(isa, also_by, at));
            let r = minus(x, vectors(isa, places, at));
            let r2 = dot(r, r);
            let off = r2.less(near2);
            let inverse = I::V::select(off, zero, I::V::select(off, one, r2).inverse_sqrt());
            let inv2 = inverse * inverse;
            let inv5 = inv2 * inv2 * inverse;
            let (source, also_source) = (dot(m, r), dot(also_m, r));
            let (target, also_target) = (dot(on, r), dot(also_on, r));
            along = inv5.mul_add(source, along);
            also_along = inv5.mul_add(also_source, also_along);
            let (v, also_v) = (inv5 * target, inv5 * also_target);
            let product = target.mul_add(source, also_target * also_source);
            let w = inv5 * (minus_five * inv2).mul_add(product, dot(on, m) + dot(also_on, also_m));
            for c in 0..3 {
                force[c] = w.mul_add(r[c], v.mul_add(m[c], also_v.mul_add(also_m[c], force[c])));
            }
        }
        3.0 * (total(force) + self.on * sum(along) + self.also_on * sum(also_along))
    }
}

fn slices(of: &[Vec<f64>; 3]) -> [&[f64]; 3] {
    [&of[0], &of[1], &of[2]]
}
