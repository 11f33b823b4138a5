//! Expansions of dipoles about the centres of boxes.
//!
//! With s = x_j - z the places about a source's centre z, the potential sum_j m_j.r/r^3 is sum_b M_b D^b(x - z), D^b the
//! derivatives of 1/r and M_b = (-1)^|b| sum_j m_j.grad s^b/b!. About a target's centre at distance R it is sum_a L_a t^a/a!,
//! L_a = sum_b M_b D^(a+b)(R) with |a| + |b| up to the order (Dehnen 2002, J. Comput. Phys. 179, 27). B = -grad of that
//! potential, and the force on a moment is the gradient of m.B: the very gradient of the expanded energy.

use super::terms::{ALL, Terms};
use crate::kernel::lanes::{Isa, LANES, Lanes, Work, dot, minus, same, sum, vectors};
use crate::kernel::{Sum, Want};
use lbm_ibm_coupling::{Soa3, Vec3};
use std::ops::Range;

/// Powers x^a/a! of the components of a vector, for as many terms as `out` has.
#[inline(always)]
fn powers<I: Isa>(isa: I, terms: &Terms, x: [I::V; 3], out: &mut [I::V]) {
    out[0] = isa.splat(1.0);
    for k in 1..out.len() {
        let step = &terms.steps[k - 1];
        out[k] = out[step.lower] * (x[step.axis] * isa.splat(step.inverse));
    }
}

/// The same for one vector.
fn plain_powers(terms: &Terms, x: Vec3, out: &mut [f64]) {
    out[0] = 1.0;
    for k in 1..out.len() {
        let step = &terms.steps[k - 1];
        out[k] = out[step.lower] * x[step.axis] * step.inverse;
    }
}

/// The components of the vectors before `end`.
fn to(v: &Soa3, end: usize) -> [&[f64]; 3] {
    [&v.x[..end], &v.y[..end], &v.z[..end]]
}

/// Adds the moments of `points` about `centre` to `multipole`.
pub(super) struct Gather<'a> {
    pub terms: &'a Terms,
    pub x: &'a Soa3,
    pub m: &'a Soa3,
    pub points: Range<usize>,
    pub centre: Vec3,
    pub multipole: &'a mut [f64],
}

impl Work for Gather<'_> {
    type Out = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let terms = self.terms;
        let lower = super::terms::count(terms.order - 1);
        let mut power = [isa.splat(0.0); ALL];
        let mut sums = [isa.splat(0.0); ALL];
        let (x, m, centre) = (
            to(self.x, self.points.end),
            to(self.m, self.points.end),
            same(isa, self.centre),
        );
        for at in self.points.clone().step_by(LANES) {
            let m = vectors(isa, m, at);
            let s = minus(vectors(isa, x, at), centre);
            powers(isa, terms, s, &mut power[..lower]);
            for (a, p) in power[..lower].iter().enumerate() {
                let places = &terms.sums(a)[1..4];
                for c in 0..3 {
                    let to = &mut sums[places[c] as usize];
                    *to = p.mul_add(m[c], *to);
                }
            }
        }
        for (k, out) in self.multipole.iter_mut().enumerate() {
            let sign = if terms.degree[k].is_multiple_of(2) { 1.0 } else { -1.0 };
            *out = sign * sum(sums[k]);
        }
    }
}

/// Adds `part`, a multipole at `shift` from the centre of `whole`, to `whole`.
pub(super) fn shift_up(terms: &Terms, part: &[f64], shift: Vec3, whole: &mut [f64]) {
    let mut power = [0.0; ALL];
    plain_powers(terms, -shift, &mut power[..terms.len()]);
    for (b, m) in part.iter().enumerate().skip(1) {
        for (to, p) in terms.sums(b).iter().zip(&power) {
            whole[*to as usize] += m * p;
        }
    }
}

/// Adds the expansion `whole` to that about a centre `shift` from its own.
pub(super) fn shift_down(terms: &Terms, whole: &[f64], shift: Vec3, part: &mut [f64]) {
    let mut power = [0.0; ALL];
    plain_powers(terms, shift, &mut power[..terms.len()]);
    for (a, out) in part.iter_mut().enumerate().skip(1) {
        let mut sum = 0.0;
        for (from, p) in terms.sums(a).iter().zip(&power) {
            sum += whole[*from as usize] * p;
        }
        *out += sum;
    }
}

/// Adds what the multipoles of some boxes are about a target's centre to `local`.
pub(super) struct Translate<'a, C: Fn(usize) -> Vec3> {
    pub terms: &'a Terms,
    pub sources: &'a [u32],
    pub centre: C,
    pub target: Vec3,
    pub multipoles: &'a [f64],
    pub local: &'a mut [f64],
}

impl<C: Fn(usize) -> Vec3> Work for Translate<'_, C> {
    type Out = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let terms = self.terms;
        let n = terms.len();
        let mut moment = [[0.0; LANES]; ALL];
        let mut sums = [isa.splat(0.0); ALL];
        let mut derivative = [isa.splat(0.0); ALL];
        for boxes in self.sources.chunks(LANES) {
            let mut r = [[1.0; LANES]; 3];
            for l in 0..LANES {
                match boxes.get(l) {
                    Some(b) => {
                        let d = self.target - (self.centre)(*b as usize);
                        for c in 0..3 {
                            r[c][l] = d[c];
                        }
                        let from = &self.multipoles[*b as usize * n..][..n];
                        for (to, m) in moment[..n].iter_mut().zip(from) {
                            to[l] = *m;
                        }
                    }
                    None => moment[..n].iter_mut().for_each(|m| m[l] = 0.0),
                }
            }
            let r = [isa.load(&r[0]), isa.load(&r[1]), isa.load(&r[2])];
            derivatives(isa, terms, r, &mut derivative);
            for b in 1..n {
                let m = isa.load(&moment[b]);
                let places = &terms.sums(b)[1..];
                for (to, from) in sums[1..].iter_mut().zip(places) {
                    *to = m.mul_add(derivative[*from as usize], *to);
                }
            }
        }
        for (to, s) in self.local.iter_mut().zip(&sums) {
            *to += sum(*s);
        }
    }
}

/// All derivatives of 1/r: with n = |a|, n r^2 D^a = -(2n-1) sum_c a_c r_c D^(a-c) - (n-1) sum_c a_c (a_c-1) D^(a-2c).
#[inline(always)]
fn derivatives<I: Isa>(isa: I, terms: &Terms, r: [I::V; 3], out: &mut [I::V; ALL]) {
    let r2 = dot(r, r);
    out[0] = isa.splat(1.0) / r2.sqrt();
    let factor = -(isa.splat(1.0) / r2);
    for (k, step) in terms.steps.iter().enumerate() {
        let mut sum = isa.splat(0.0);
        for c in 0..3 {
            let (one, two) = (step.one[c], step.two[c]);
            if one.0 != 0.0 {
                sum = (isa.splat(one.0) * r[c]).mul_add(out[one.1], sum);
            }
            if two.0 != 0.0 {
                sum = isa.splat(two.0).mul_add(out[two.1], sum);
            }
        }
        out[k + 1] = sum * factor;
    }
}

/// Adds the field, and the force on the moments `m`, of the expansion `local` about `centre` to `out`, one per point.
pub(super) struct Spread<'a> {
    pub terms: &'a Terms,
    pub x: &'a Soa3,
    pub m: &'a Soa3,
    pub points: Range<usize>,
    pub centre: Vec3,
    pub local: &'a [f64],
    pub want: Want,
    pub out: &'a mut [Sum],
}

impl Work for Spread<'_> {
    type Out = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let terms = self.terms;
        let once = super::terms::count(terms.order - 1);
        let twice = super::terms::count(terms.order - 2);
        let mut power = [isa.splat(0.0); ALL];
        let (x, m, centre) = (
            to(self.x, self.points.end),
            to(self.m, self.points.end),
            same(isa, self.centre),
        );
        for (at, out) in self.points.clone().step_by(LANES).zip(self.out.chunks_mut(LANES)) {
            powers(isa, terms, minus(vectors(isa, x, at), centre), &mut power[..once]);
            if self.want != Want::Force {
                let mut field = [isa.splat(0.0); 3];
                for (a, p) in power[..once].iter().enumerate() {
                    let sums = &terms.sums(a)[1..4];
                    for c in 0..3 {
                        field[c] = p.mul_add(isa.splat(self.local[sums[c] as usize]), field[c]);
                    }
                }
                let field = [field[0].array(), field[1].array(), field[2].array()];
                for (l, o) in out.iter_mut().enumerate() {
                    o.field -= Vec3::new(field[0][l], field[1][l], field[2][l]);
                }
            }
            if self.want != Want::Field {
                let m = vectors(isa, m, at);
                // xx, xy, xz, yy, yz, zz: the indices of degree 2 in their order.
                let mut second = [isa.splat(0.0); 6];
                for (a, p) in power[..twice].iter().enumerate() {
                    let sums = &terms.sums(a)[4..10];
                    for c in 0..6 {
                        second[c] = p.mul_add(isa.splat(self.local[sums[c] as usize]), second[c]);
                    }
                }
                let [xx, xy, xz, yy, yz, zz] = second;
                let force = [dot([xx, xy, xz], m), dot([xy, yy, yz], m), dot([xz, yz, zz], m)];
                let force = [force[0].array(), force[1].array(), force[2].array()];
                for (l, o) in out.iter_mut().enumerate() {
                    o.force -= Vec3::new(force[0][l], force[1][l], force[2][l]);
                }
            }
        }
    }
}
