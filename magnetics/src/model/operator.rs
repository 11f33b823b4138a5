//! The linear operator of mutual induction, and conjugate gradients on it.

use super::near::Interaction;
use crate::bead::Response;
use lbm_ibm_coupling::{Soa3, Vec3};

/// I - |P|^(1/2) G |P|^(1/2) S, with P = |P|^(1/2) S |P|^(1/2) the polarisabilities, S their signs, and G all dipoles' fields.
pub(super) struct Operator<'a> {
    response: &'a [Response],
    sign: Vec<f64>,
    diamagnetic: bool,
}

/// How far conjugate gradients came.
pub(super) struct Solved {
    pub iterations: usize,
    /// Root of the sum of squares of what is left, as a field (T).
    pub off: f64,
    /// What is left, scaled as the unknowns are.
    residual: Soa3,
}

impl<'a> Operator<'a> {
    pub fn new(response: &'a [Response]) -> Self {
        let sign: Vec<f64> = response
            .iter()
            .map(|r| if r.across < 0.0 { -1.0 } else { 1.0 })
            .collect();
        let diamagnetic = sign.iter().any(|s| *s < 0.0);
        Self {
            response,
            sign,
            diamagnetic,
        }
    }

    /// Moments (A m2) of the scaled unknowns: |P|^(1/2) S y.
    pub fn moments(&self, y: &Soa3) -> Soa3 {
        let one = |i: usize| root(&self.response[i], y.get(i)) * self.sign[i];
        (0..y.len()).map(one).collect()
    }

    /// Local fields (T) of the scaled unknowns that have been found: |P|^(-1/2) (y + residual), without a sum over pairs. None
    /// where a bead has no polarisability.
    pub fn local_field(&self, y: &Soa3, solved: &Solved) -> Option<Soa3> {
        let polarisable = self.response.iter().all(|r| r.along != 0.0 && r.across != 0.0);
        let one = |i: usize| unroot(&self.response[i], y.get(i) + solved.residual.get(i));
        polarisable.then(|| (0..y.len()).map(one).collect())
    }

    fn apply(&self, dipoles: &mut Interaction<'_>, y: &Soa3, transposed: bool) -> Soa3 {
        let n = y.len();
        let m = if transposed {
            (0..n).map(|i| root(&self.response[i], y.get(i))).collect()
        } else {
            self.moments(y)
        };
        let mut field = Soa3::default();
        dipoles.induced_field(m.view(), &mut field);
        let sign = |i: usize| if transposed { self.sign[i] } else { 1.0 };
        (0..n)
            .map(|i| y.get(i) - root(&self.response[i], field.get(i)) * sign(i))
            .collect()
    }

    /// Solves for what the fields `b` (T) bring about, to `tolerance` (T), by conjugate gradients that start from `y`: on the
    /// operator itself, which is positive definite, or with diamagnetic beads on its normal equations.
    pub fn solve(&self, dipoles: &mut Interaction<'_>, b: &Soa3, tolerance: f64, y: &mut Soa3) -> Solved {
        let n = b.len();
        let right: Soa3 = (0..n).map(|i| root(&self.response[i], b.get(i))).collect();
        let largest = self.response.iter().map(|r| r.across.abs()).fold(0.0, f64::max).sqrt();
        let solved = |iterations: usize, r: Soa3| Solved {
            iterations,
            off: if largest > 0.0 { norm(&r) / largest } else { 0.0 },
            residual: r,
        };
        let goal = tolerance * largest;
        let mut residual = right.clone();
        if y.len() == n && norm(y) > 0.0 {
            residual = axpy(&right, -1.0, &self.apply(dipoles, y, false));
        }
        let useless = norm(&residual) > norm(&right);
        if y.len() != n || useless {
            *y = Soa3::zeros(n);
            residual = right;
        }
        if norm(&residual) <= goal {
            return solved(0, residual);
        }
        let mut z = self.gradient(dipoles, &residual);
        let mut p = z.clone();
        let mut zz = dot(&z, &z);
        let most = 20 * n.max(10);
        for made in 1..=most {
            let q = self.apply(dipoles, &p, false);
            let curvature = if self.diamagnetic { dot(&q, &q) } else { dot(&p, &q) };
            if curvature <= 0.0 {
                return solved(made, residual);
            }
            let alpha = zz / curvature;
            add(y, alpha, &p);
            add(&mut residual, -alpha, &q);
            if norm(&residual) <= goal {
                return solved(made, residual);
            }
            z = self.gradient(dipoles, &residual);
            let next = dot(&z, &z);
            p = axpy(&z, next / zz, &p);
            zz = next;
        }
        solved(most, residual)
    }

    fn gradient(&self, dipoles: &mut Interaction<'_>, residual: &Soa3) -> Soa3 {
        if self.diamagnetic {
            self.apply(dipoles, residual, true)
        } else {
            residual.clone()
        }
    }
}

/// |P|^(1/2) v of a polarisability that is along or across the field.
fn root(response: &Response, v: Vec3) -> Vec3 {
    let n = response.direction;
    let (along, across) = (response.along.abs().sqrt(), response.across.abs().sqrt());
    n * (n.dot(&v) * (along - across)) + v * across
}

/// |P|^(-1/2) v, for a polarisability that is not zero.
fn unroot(response: &Response, v: Vec3) -> Vec3 {
    let n = response.direction;
    let (along, across) = (1.0 / response.along.abs().sqrt(), 1.0 / response.across.abs().sqrt());
    n * (n.dot(&v) * (along - across)) + v * across
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(&b)).sum()
}

/// Root of the sum of squares.
pub(super) fn norm(a: &Soa3) -> f64 {
    dot(a, a).sqrt()
}

/// Adds s b to a.
fn add(a: &mut Soa3, s: f64, b: &Soa3) {
    for (a, b) in [(&mut a.x, &b.x), (&mut a.y, &b.y), (&mut a.z, &b.z)] {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += s * b);
    }
}

/// a + s b.
pub(super) fn axpy(a: &Soa3, s: f64, b: &Soa3) -> Soa3 {
    a.iter().zip(b.iter()).map(|(a, b)| a + b * s).collect()
}
