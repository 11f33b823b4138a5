//! The multipoles of two spheres for one azimuthal order, m = 0 (field along the line) or 1 (normal to it).
//!
//! With Racah-normalised harmonics and R the distance, the incoming order n at sphere 2 from the outgoing order l of
//! sphere 1 is (-1)^(n+m) S R^-(l+n+1), S = (l+n)!/sqrt((l-m)!(l+m)!(n-m)!(n+m)!). Scaled by q_n = sqrt(|beta_n| a^(2n+1)),
//! and with the signs (-1)^n of sphere 2 taken into its unknowns, y1 = f1 - s1 (-1)^m K^T z2 and z2 = f2 - s2 (-1)^m K y1, s
//! the sign of beta. Eliminating y1 leaves I - s1 s2 K K^T, positive definite since |K| < 1: conjugate gradients.

use lbm_ibm_coupling::nalgebra::{DMatrix, DVector};
use std::f64::consts::{PI, SQRT_2};

/// The system at one order of truncation.
pub(super) struct System {
    m: usize,
    order: usize,
    radius: [f64; 2],
    sign: [f64; 2],
    beta: [Vec<f64>; 2],
    /// Row n of sphere 2, column l of sphere 1, counted from order 1.
    k: Vec<f64>,
}

/// Force on sphere 2 along the line and both moments, in units of mu0 H0^2 and H0.
pub(super) struct Found {
    pub force: f64,
    pub moment: [f64; 2],
}

impl System {
    pub fn new(radius: [f64; 2], permeability: [f64; 2], distance: f64, order: usize, m: usize) -> Self {
        let beta = permeability.map(|mu| {
            (1..=order)
                .map(|l| l as f64 * (mu - 1.0) / (l as f64 * (mu + 1.0) + 1.0))
                .collect::<Vec<_>>()
        });
        let [t1, t2] = radius.map(|a| a / distance);
        let m2 = (m * m) as f64;
        let mut k = vec![0.0; order * order];
        let mut diagonal = if m == 0 { 2.0 } else { 1.0 } * t1 * t2 * (radius[0] * radius[1]).sqrt() / distance;
        for l in 1..=order {
            let row = &mut k[(l - 1) * order..l * order];
            let lf = l as f64;
            row[l - 1] = diagonal;
            let mut value = diagonal;
            for n in l + 1..=order {
                let n = n as f64;
                value *= (lf + n) / (n * n - m2).sqrt() * t1;
                row[n as usize - 1] = value;
            }
            value = diagonal;
            for n in (1..l).rev() {
                let up = n as f64 + 1.0;
                value *= (up * up - m2).sqrt() / (lf + up) / t1;
                row[n - 1] = value;
            }
            diagonal *= (2.0 * lf + 1.0) * (2.0 * lf + 2.0) / ((lf + 1.0).powi(2) - m2) * t1 * t2;
        }
        let root = [0, 1].map(|s: usize| beta[s].iter().map(|b| b.abs().sqrt()).collect::<Vec<_>>());
        for n in 0..order {
            for l in 0..order {
                k[n * order + l] *= root[1][n] * root[0][l];
            }
        }
        Self {
            m,
            order,
            radius,
            sign: permeability.map(|mu| if mu < 1.0 { -1.0 } else { 1.0 }),
            beta,
            k,
        }
    }

    pub fn solve(&self) -> Found {
        let [s1, s2] = self.sign;
        let sigma = if self.m == 0 { 1.0 } else { -1.0 };
        let applied = if self.m == 0 { 1.0 } else { SQRT_2 };
        let q = |s: usize| (self.beta[s][0].abs() * self.radius[s].powi(3)).sqrt();
        let mut f1 = vec![0.0; self.order];
        let mut b = vec![0.0; self.order];
        f1[0] = s1 * q(0) * applied;
        let shift = self.forward(&f1);
        for (b, shift) in b.iter_mut().zip(&shift) {
            *b = -s2 * sigma * shift;
        }
        b[0] -= s2 * q(1) * applied;
        let z2 = self.conjugate_gradients(&b, s1 * s2);
        let back = self.transposed(&z2);
        let y1: Vec<_> = f1.iter().zip(&back).map(|(f, k)| f - s1 * sigma * k).collect();
        let share = if self.m == 0 { 1.0 } else { 0.5 };
        let mut force = 0.0;
        for l in 1..self.order {
            let up = (l + 1) as f64;
            let ratio = if self.beta[1][l] == 0.0 {
                0.0
            } else {
                (self.beta[1][l - 1] / self.beta[1][l]).sqrt()
            };
            force += z2[l - 1] * z2[l] * ratio * (up * up - (self.m * self.m) as f64).sqrt();
        }
        Found {
            force: -4.0 * PI * share * s2 / self.radius[1] * force,
            moment: [4.0 * PI * q(0) * y1[0] / applied, -4.0 * PI * q(1) * z2[0] / applied],
        }
    }

    /// Total moment, its slope with distance and with the openness of both spheres, in units of H0: the orders from 2 on of
    /// sphere s answer with `open[s]` of their strength. Exact slopes of the truncated system.
    pub fn truncated(&self, open: [f64; 2], distance: f64) -> (f64, f64, [f64; 2]) {
        let n = self.order;
        let sigma = if self.m == 0 { 1.0 } else { -1.0 };
        let share = if self.m == 0 { 1.0 } else { 2.0 };
        let weight = |s: usize, l: usize| if l == 0 { 1.0 } else { open[s].sqrt() };
        let q = |s: usize| (share * self.beta[s][0].abs() * self.radius[s].powi(3)).sqrt();
        // [s1, sigma K^T; sigma K, s2] u = g, the moment is 4 pi g.u over the square of the applied field.
        let t = DMatrix::from_fn(2 * n, 2 * n, |r, c| match (r < n, c < n) {
            (true, true) | (false, false) if r == c => self.sign[usize::from(r >= n)],
            (false, true) => sigma * self.k[(r - n) * n + c] * weight(1, r - n) * weight(0, c),
            (true, false) => sigma * self.k[(c - n) * n + r] * weight(1, c - n) * weight(0, r),
            _ => 0.0,
        });
        let mut g = DVector::zeros(2 * n);
        (g[0], g[n]) = (q(0), -q(1));
        let u = t.lu().solve(&g).unwrap_or_else(|| DVector::zeros(2 * n));
        let unit = 4.0 * PI / share;
        let (mut slope, mut opens) = (0.0, [0.0; 2]);
        for row in 0..n {
            let mut into = 0.0;
            for l in 0..n {
                let k = self.k[row * n + l] * weight(0, l) * u[l];
                into += k;
                slope += u[n + row] * weight(1, row) * k * (row + l + 3) as f64;
            }
            if row > 0 {
                opens[1] += into * into;
            }
        }
        for l in 1..n {
            let into: f64 = (0..n)
                .map(|row| self.k[row * n + l] * weight(1, row) * u[n + row])
                .sum();
            opens[0] += into * into;
        }
        let opens = [unit * self.sign[0] * opens[0], unit * self.sign[1] * opens[1]];
        (unit * g.dot(&u), unit * 2.0 * sigma * slope / distance, opens)
    }

    fn forward(&self, v: &[f64]) -> Vec<f64> {
        let row = |r: &[f64]| r.iter().zip(v).map(|(k, v)| k * v).sum();
        self.k.chunks_exact(self.order).map(row).collect()
    }

    fn transposed(&self, v: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.order];
        for (row, v) in self.k.chunks_exact(self.order).zip(v) {
            for (o, k) in out.iter_mut().zip(row) {
                *o += k * v;
            }
        }
        out
    }

    /// Solves (I - s K K^T) z = b.
    fn conjugate_gradients(&self, b: &[f64], s: f64) -> Vec<f64> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut z = vec![0.0; self.order];
        let mut r = b.to_vec();
        let mut p = b.to_vec();
        let mut rr = dot(&r, &r);
        let goal = rr * 1e-32;
        for _ in 0..1000 {
            if rr <= goal {
                break;
            }
            let kkp = self.forward(&self.transposed(&p));
            let q: Vec<_> = p.iter().zip(&kkp).map(|(p, k)| p - s * k).collect();
            let alpha = rr / dot(&p, &q);
            for i in 0..self.order {
                z[i] += alpha * p[i];
                r[i] -= alpha * q[i];
            }
            let next = dot(&r, &r);
            for i in 0..self.order {
                p[i] = r[i] + next / rr * p[i];
            }
            rr = next;
        }
        z
    }
}
