//! What a bead answers with, and how multipoles travel between two beads.
//!
//! Coefficients of one bead are stored for l = 1.. and m = 0..=l; the potential is real, X_(l,-m) = (-1)^m conj(X_lm).

use super::solid::irregular;
use crate::bead::Bead;
use crate::model::near::Pair;
use crate::model::strength::weakened;
use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::Complex;

/// Coefficients to `order`.
pub(in crate::model) fn count(order: usize) -> usize {
    (order + 1) * (order + 2) / 2 - 1
}

fn at(l: usize, m: usize) -> usize {
    l * (l + 1) / 2 + m - 1
}

/// How a bead answers: outgoing = -sign root^2 incoming.
pub(in crate::model) struct Shape {
    pub sign: f64,
    /// sqrt(|beta_l| a^(2l+1)/((l+m)!(l-m)!)).
    pub root: Vec<f64>,
    /// How often a coefficient counts: once for m = 0, twice else.
    pub weight: Vec<f64>,
}

impl Shape {
    /// A linear bead, or one at vanishing field.
    pub fn new(bead: &Bead, unit: f64, order: usize) -> Self {
        Self::weakened(bead, 1.0, unit, order)
    }

    /// A bead whose polarisability is `strength` of that at vanishing field.
    pub fn weakened(bead: &Bead, strength: f64, unit: f64, order: usize) -> Self {
        let mu = weakened(bead.initial_permeability(), strength);
        let a = bead.radius() / unit;
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let (mut root, mut weight) = (Vec::new(), Vec::new());
        for l in 1..=order {
            let beta = l as f64 * (mu - 1.0) / (l as f64 * (mu + 1.0) + 1.0);
            let scale = (beta.abs() * a.powi(2 * l as i32 + 1)).sqrt();
            for m in 0..=l {
                root.push(scale / factorial(l + m).sqrt() / factorial(l - m).sqrt());
                weight.push(if m == 0 { 1.0 } else { 2.0 });
            }
        }
        Self {
            sign: if mu < 1.0 { -1.0 } else { 1.0 },
            root,
            weight,
        }
    }
}

/// Slope of the logarithm of a bead's answer at order `l` with its strength.
pub(in crate::model) fn relative_slope(bead: &Bead, strength: f64, l: usize) -> f64 {
    let (mu, l) = (bead.initial_permeability(), l as f64);
    let p = strength * (mu - 1.0) / (mu + 2.0);
    (2.0 * l + 1.0) / (strength * (2.0 * l + 1.0 + (l - 1.0) * p))
}

/// Scratch of a translation: outgoing coefficients of all m.
#[derive(Default)]
pub(in crate::model) struct Field {
    re: Vec<f64>,
    im: Vec<f64>,
    sum_re: Vec<f64>,
    sum_im: Vec<f64>,
}

/// Two beads whose multipoles meet.
pub(in crate::model) struct Link {
    pub i: usize,
    pub j: usize,
    order: usize,
    /// Whether the dipoles' field on dipoles is left to others.
    beyond_dipoles: bool,
    /// Unit vector from j to i.
    pub direction: Vec3,
    /// d ln(weight)/dr of a link that fades, 1/m.
    pub slope: f64,
    /// Half the bispherical distance of the two spheres, at least that of a gap of 0.001 mean radii.
    eta: f64,
    /// I_(L,-q)(R), q = -L..=L, per order L at L^2 + L + q; R from j to i.
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Link {
    /// All orders to `order`, fewer for a pair that is farther apart.
    pub fn new(pair: &Pair, radius: [f64; 2], unit: f64, order: usize) -> Self {
        let eta = eta(2.0 * pair.distance / (radius[0] + radius[1]));
        Self::of(pair, radius, unit, order_at(eta, order))
    }

    /// All orders to `order` but dipole to dipole, with a weight and its slope with distance (1/m).
    pub fn beyond_dipoles(pair: &Pair, radius: [f64; 2], unit: f64, order: usize, weight: (f64, f64)) -> Self {
        let mut link = Self::of(pair, radius, unit, order);
        link.beyond_dipoles = true;
        link.slope = weight.1 / weight.0;
        for value in link.re.iter_mut().chain(&mut link.im) {
            *value *= weight.0;
        }
        link
    }

    fn of(pair: &Pair, radius: [f64; 2], unit: f64, order: usize) -> Self {
        // Overlapping spheres have no converging multipoles: they are coupled as at contact.
        let contact = radius[0] + radius[1];
        let direction = if pair.distance > 0.0 {
            pair.r / pair.distance
        } else {
            Vec3::z()
        };
        let r = direction * pair.distance.max(contact) / unit;
        let eta = eta(2.0 * pair.distance / contact);
        let table = irregular(2 * order + 1, r);
        let (mut re, mut im) = (Vec::new(), Vec::new());
        for l in 0..=2 * order + 1 {
            for q in -(l as isize)..=l as isize {
                let value = table[l * (l + 1) / 2 + q.unsigned_abs()];
                let sign = if q > 0 && q % 2 != 0 { -1.0 } else { 1.0 };
                // I_(l,-q): for q > 0 (-1)^q conj(I_lq), for q < 0 I_(l,|q|).
                re.push(sign * value.re);
                im.push(if q > 0 { -sign } else { 1.0 } * value.im);
            }
        }
        Self {
            i: pair.i,
            j: pair.j,
            order,
            beyond_dipoles: false,
            direction,
            slope: 0.0,
            eta,
            re,
            im,
        }
    }

    /// Adds to `into` what the outgoing coefficients `out` of bead j are at bead i, or with `reversed` those of i at j.
    pub fn carry(&self, out: &[Complex<f64>], into: &mut [Complex<f64>], reversed: bool, work: &mut Field) {
        work.expand(out, self.order, reversed);
        for n in 1..=self.order {
            let first = if self.beyond_dipoles && n == 1 { 2 } else { 1 };
            self.incoming(n, first, work);
            for k in 0..=n {
                let sign = if (n + k).is_multiple_of(2) { 1.0 } else { -1.0 };
                let sign = if reversed && n % 2 == 1 { -sign } else { sign };
                into[at(n, k)] += Complex::new(work.sum_re[k], work.sum_im[k]) * sign;
            }
        }
    }

    /// Sums over the outgoing coefficients from order `lowest` on for the incoming ones of order `n`, k = 0..=n, without
    /// (-1)^(n+k).
    fn incoming(&self, n: usize, lowest: usize, work: &mut Field) {
        for sum in [&mut work.sum_re, &mut work.sum_im] {
            sum.clear();
            sum.resize(n + 1, 0.0);
        }
        for l in lowest..=self.order {
            let order = l + n;
            for m in -(l as isize)..=l as isize {
                let a = (l * l + l) as isize + m;
                let (ar, ai) = (work.re[a as usize], work.im[a as usize]);
                // q = k - m runs upwards with k.
                let first = ((order * order + order) as isize - m) as usize;
                let (ir, ii) = (&self.re[first..=first + n], &self.im[first..=first + n]);
                let sums = work.sum_re.iter_mut().zip(work.sum_im.iter_mut());
                for ((sr, si), (ir, ii)) in sums.zip(ir.iter().zip(ii)) {
                    *sr += ar * ir - ai * ii;
                    *si += ar * ii + ai * ir;
                }
            }
        }
    }

    /// Force on bead i of outgoing `a` from bead j of outgoing `b`, -sum conj(A_lm) grad B, over 4 pi mu0.
    pub fn force(&self, a: &[Complex<f64>], b: &[Complex<f64>], work: &mut Field) -> Vec3 {
        work.expand(b, self.order, false);
        let mut force = Vec3::zeros();
        for l in 1..=self.order {
            let lowest = if self.beyond_dipoles && l == 1 { 2 } else { 1 };
            self.incoming(l + 1, lowest, work);
            let incoming = |m: isize| {
                let k = m.unsigned_abs();
                let sign = if (l + 1 + k).is_multiple_of(2) { 1.0 } else { -1.0 };
                let value = Complex::new(work.sum_re[k], work.sum_im[k]) * sign;
                mirrored(value, m)
            };
            let (mut z, mut minus) = (0.0, Complex::new(0.0, 0.0));
            for m in -(l as isize)..=l as isize {
                let out = mirrored(a[at(l, m.unsigned_abs())], m).conj();
                z -= (out * incoming(m)).re;
                minus += out * incoming(m + 1);
            }
            force += Vec3::new(minus.re, -minus.im, z);
        }
        force
    }

    /// Energy of outgoing `a` of bead i with outgoing `b` of bead j, over 4 pi mu0 unit.
    pub fn energy(&self, a: &[Complex<f64>], b: &[Complex<f64>], work: &mut Field) -> f64 {
        let mut into = vec![Complex::new(0.0, 0.0); a.len()];
        self.carry(b, &mut into, false, work);
        let mut sum = 0.0;
        for l in 1..=self.order {
            for m in 0..=l {
                let (a, b) = (a[at(l, m)], into[at(l, m)]);
                sum += if m == 0 { 1.0 } else { 2.0 } * (a.re * b.re + a.im * b.im);
            }
        }
        sum
    }

    /// Estimate of the force that the orders beyond the last would add, over 4 pi mu0: the energy of each bead's answer at
    /// the last order, carried on as a geometric series, times its relative slope with distance,
    /// (L + 1)/sinh(eta), and 4 for what the last order does to the others.
    pub fn tail(&self, a: &[Complex<f64>], b: &[Complex<f64>], roots: [&[f64]; 2], work: &mut Field) -> f64 {
        let mut sum = 0.0;
        for (out, root, reversed) in [(b, roots[0], false), (a, roots[1], true)] {
            work.expand(out, self.order, reversed);
            let mut energy = |l: usize| -> f64 {
                self.incoming(l, 1, work);
                (0..=l)
                    .map(|m| {
                        let weight = if m == 0 { 1.0 } else { 2.0 };
                        let root = root[at(l, m)];
                        weight * root * root * (work.sum_re[m].powi(2) + work.sum_im[m].powi(2))
                    })
                    .sum()
            };
            // Across the field an order may happen to be near zero: the ones before it stand in, reduced by the asymptotic ratio.
            let least = (-2.0 * self.eta).exp();
            let [last, before, third] = [0, 1, 2].map(|k| energy(self.order.saturating_sub(k).max(1)));
            let measured = if before > 0.0 { last / before } else { 0.0 };
            let ratio = measured.clamp(least, 0.98);
            let last = last.max(before * least).max(third * least * least);
            sum += last * ratio / (1.0 - ratio);
        }
        4.0 * sum * (self.order + 1) as f64 / self.eta.sinh().max(1e-3)
    }
}

/// The coefficient of m from that of |m|.
fn mirrored(value: Complex<f64>, m: isize) -> Complex<f64> {
    if m >= 0 {
        value
    } else if m % 2 == 0 {
        value.conj()
    } else {
        -value.conj()
    }
}

fn eta(s: f64) -> f64 {
    (0.5 * s.max(2.001)).acosh()
}

/// Orders that a pair needs if one at a gap of 0.1 needs `order`: convergence is exp(-2 L eta) with cosh(eta) = s/2, s the
/// distance of the centres in mean radii.
fn order_at(at: f64, order: usize) -> usize {
    let needed = (order as f64 * eta(2.1) / at.max(eta(2.1))).ceil() as usize + 4;
    needed.min(order)
}

impl Field {
    fn expand(&mut self, out: &[Complex<f64>], order: usize, reversed: bool) {
        let length = (order + 1) * (order + 1);
        self.re.resize(length, 0.0);
        self.im.resize(length, 0.0);
        for l in 1..=order {
            let sign = if reversed && l % 2 == 1 { -1.0 } else { 1.0 };
            for m in -(l as isize)..=l as isize {
                let value = mirrored(out[at(l, m.unsigned_abs())], m) * sign;
                let k = ((l * l + l) as isize + m) as usize;
                (self.re[k], self.im[k]) = (value.re, value.im);
            }
        }
    }
}
