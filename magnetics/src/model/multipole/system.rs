//! All beads' multipoles together.

use super::coupling::{Field, Link, Shape};
use crate::MU0;
use crate::bead::Bead;
use crate::error::MagneticsError;
use crate::model::near::Interaction;
use crate::model::{Problem, Solution};
use lbm_ibm_coupling::nalgebra::Complex;
use lbm_ibm_coupling::{Soa3, Vec3};
use std::f64::consts::PI;

const MOST_ITERATIONS: usize = 2000;

/// The coupled system of all beads, lengths in the largest radius.
pub(in crate::model) struct System<'a> {
    pub shapes: Vec<Shape>,
    pub links: Vec<Link>,
    pub far: Interaction<'a>,
    /// Beyond this (m) beads are dipoles to each other and links have all orders; none where links lack the dipoles'
    /// field on dipoles, which is then taken between all beads.
    pub far_distance: Option<f64>,
    pub unit: f64,
    pub count: usize,
    pub work: Field,
}

impl System<'_> {
    /// Incoming coefficients of order 1 and above at every bead from the outgoing `out`; far beads by their dipoles.
    pub fn incoming(&mut self, out: &[Complex<f64>]) -> Vec<Complex<f64>> {
        let mut into = vec![Complex::new(0.0, 0.0); out.len()];
        for link in &self.links {
            let (i, j) = (link.i * self.count, link.j * self.count);
            link.carry(
                &out[j..j + self.count],
                &mut into[i..i + self.count],
                false,
                &mut self.work,
            );
            link.carry(
                &out[i..i + self.count],
                &mut into[j..j + self.count],
                true,
                &mut self.work,
            );
        }
        let moments = self.moments(out);
        let x = self.far.positions();
        let mut field = Soa3::default();
        match self.far_distance {
            Some(distance) => self.far.field_at(x, moments.view(), distance, &mut field),
            None => self.far.induced_field(moments.view(), &mut field),
        }
        for i in 0..self.shapes.len() {
            let h = field.get(i) / MU0;
            into[i * self.count] += h_to_coefficients(h, self.unit)[0];
            into[i * self.count + 1] += h_to_coefficients(h, self.unit)[1];
        }
        into
    }

    /// Outgoing coefficients of the moments that stay, and the right side of the system: what they and the source induce.
    pub fn right(&mut self, problem: &Problem<'_>) -> (Vec<Complex<f64>>, Vec<Complex<f64>>) {
        let zero = Complex::new(0.0, 0.0);
        let n = problem.beads().len();
        let mut fixed = vec![zero; n * self.count];
        for (i, bead) in problem.beads().iter().enumerate() {
            let m = bead.response(Vec3::zeros()).moment / (4.0 * PI * self.unit.powi(2));
            let at = i * self.count;
            (fixed[at], fixed[at + 1]) = (Complex::new(m.z, 0.0), Complex::new(-m.x, m.y) / 2.0);
        }
        let mut applied = self.incoming(&fixed);
        let field = std::mem::take(&mut self.far.field);
        self.add_field(&field, &mut applied);
        self.far.field = field;
        let right = self.answers(&applied);
        (fixed, right)
    }

    /// Adds the field `b` (T, one per bead) to incoming coefficients.
    pub fn add_field(&self, b: &Soa3, into: &mut [Complex<f64>]) {
        for i in 0..b.len() {
            let h = h_to_coefficients(b.get(i) / MU0, self.unit);
            into[i * self.count] += h[0];
            into[i * self.count + 1] += h[1];
        }
    }

    /// The right side for incoming coefficients.
    pub fn answers(&self, applied: &[Complex<f64>]) -> Vec<Complex<f64>> {
        self.each(applied, |shape, k, b| -b * shape.root[k] * shape.sign)
    }

    /// Solves for the scaled outgoing coefficients `y`, starting from what is there if its length fits, to a relative
    /// residual: conjugate gradients, where a bead is diamagnetic on the normal equations. Returns the residual and the
    /// iterations.
    pub fn solve(
        &mut self,
        right: &[Complex<f64>],
        y: &mut Vec<Complex<f64>>,
        tolerance: f64,
        model: &'static str,
    ) -> Result<(f64, usize), MagneticsError> {
        if y.len() != right.len() {
            *y = vec![Complex::new(0.0, 0.0); right.len()];
        }
        let diamagnetic = self.shapes.iter().any(|s| s.sign < 0.0);
        let start = self.apply(y, false);
        let mut r: Vec<_> = right.iter().zip(&start).map(|(b, a)| b - a).collect();
        let scale = self.dot(right, right).sqrt().max(f64::MIN_POSITIVE);
        let mut z = if diamagnetic { self.apply(&r, true) } else { r.clone() };
        let mut p = z.clone();
        let mut zz = self.dot(&z, &z);
        let mut made = 0;
        let mut residual = self.dot(&r, &r).sqrt() / scale;
        while residual > tolerance {
            if made >= MOST_ITERATIONS {
                return Err(MagneticsError::NotConverged {
                    model,
                    residual,
                    iterations: made,
                    tolerance,
                });
            }
            let q = self.apply(&p, false);
            made += 1;
            let curvature = if diamagnetic {
                self.dot(&q, &q)
            } else {
                self.dot(&p, &q)
            };
            let alpha = zz / curvature;
            for k in 0..y.len() {
                y[k] += p[k] * alpha;
                r[k] -= q[k] * alpha;
            }
            residual = self.dot(&r, &r).sqrt() / scale;
            z = if diamagnetic { self.apply(&r, true) } else { r.clone() };
            let next = self.dot(&z, &z);
            for k in 0..p.len() {
                p[k] = z[k] + p[k] * (next / zz);
            }
            zz = next;
        }
        Ok((residual, made))
    }

    /// Field (T) at bead `i` of incoming coefficients.
    pub fn local_field(&self, into: &[Complex<f64>], i: usize) -> Vec3 {
        let [b0, b1] = [into[i * self.count], into[i * self.count + 1]];
        Vec3::new(b1.re, -b1.im, -b0.re) * (MU0 / self.unit)
    }

    /// Sets the energy (J) and the torques (N m) of the moments in `out`, in the field of the incoming coefficients.
    pub fn energy_and_torques(&self, beads: &[Bead], into: &[Complex<f64>], out: &mut Solution) {
        out.energy = 0.0;
        for (i, bead) in beads.iter().enumerate() {
            let local = self.local_field(into, i);
            let own = self.far.field.get(i);
            let fixed = bead.response(Vec3::zeros()).moment;
            out.torque.set(i, fixed.cross(&(own + local)));
            let induced = out.moment.get(i) - fixed;
            out.energy -= 0.5 * induced.dot(&own) + fixed.dot(&own) + 0.5 * fixed.dot(&local);
        }
    }

    /// Dipole moments (A m2) of outgoing coefficients.
    pub fn moments(&self, out: &[Complex<f64>]) -> Soa3 {
        let scale = 4.0 * PI * self.unit.powi(2);
        out.chunks_exact(self.count)
            .map(|a| Vec3::new(-2.0 * a[1].re, 2.0 * a[1].im, a[0].re) * scale)
            .collect()
    }

    /// y + S K y, or y + K S y.
    pub fn apply(&mut self, y: &[Complex<f64>], transposed: bool) -> Vec<Complex<f64>> {
        let scaled = self.each(y, |shape, k, y| {
            y * shape.root[k] * if transposed { shape.sign } else { 1.0 }
        });
        let into = self.incoming(&scaled);
        let back = self.each(&into, |shape, k, b| {
            b * shape.root[k] * if transposed { 1.0 } else { shape.sign }
        });
        y.iter().zip(&back).map(|(y, b)| y + b).collect()
    }

    /// Adds to `missing` (N) what quadrupoles and octupoles would do beyond the reach, where beads are dipoles: the
    /// greatest force of order l on a dipole, (l+2)! A1 Al/r^(l+3) with aligned axes, twice for what it does to the moments.
    pub fn add_far_tail(&self, out: &[Complex<f64>], scale: f64, missing: &mut [f64]) {
        let x = self.far.positions();
        let size = |i: usize, l: usize| {
            let first = l * (l + 1) / 2 - 1;
            let own = |m: usize| {
                let value = out[i * self.count + first + m];
                // (l+m)!(l-m)!/l!^2: the same in every frame.
                let ratio: f64 = (1..=m).map(|k| (l + k) as f64 / (l - m + k) as f64).product();
                let weight = if m == 0 { 1.0 } else { 2.0 * ratio };
                weight * value.norm_sqr()
            };
            (0..=l).map(own).sum::<f64>().sqrt()
        };
        let orders = if self.count > 5 { 3 } else { 2 };
        if self.count < 5 {
            return;
        }
        let sizes: Vec<[f64; 3]> = (0..x.len())
            .map(|i| [size(i, 1), size(i, 2), if orders == 3 { size(i, 3) } else { 0.0 }])
            .collect();
        for i in 0..x.len() {
            for j in 0..i {
                let distance = (x.get(i) - x.get(j)).norm();
                if self.far_distance.is_none_or(|far| distance < far) {
                    continue;
                }
                let d = self.unit / distance;
                let (a, b) = (sizes[i], sizes[j]);
                let quadrupole = 24.0 * (a[0] * b[1] + a[1] * b[0]) * d.powi(5);
                let octupole = 120.0 * (a[0] * b[2] + a[2] * b[0]) * d.powi(6);
                let force = 2.0 * scale * (quadrupole + octupole);
                missing[i] += force;
                missing[j] += force;
            }
        }
    }

    pub fn each(
        &self,
        v: &[Complex<f64>],
        f: impl Fn(&Shape, usize, Complex<f64>) -> Complex<f64>,
    ) -> Vec<Complex<f64>> {
        let per_bead = v.chunks_exact(self.count).zip(&self.shapes);
        per_bead
            .flat_map(|(v, shape)| v.iter().enumerate().map(|(k, v)| f(shape, k, *v)).collect::<Vec<_>>())
            .collect()
    }

    /// Inner product of real potentials: coefficients of -m count with those of m.
    pub fn dot(&self, a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
        let weight = &self.shapes[0].weight;
        a.iter()
            .zip(b)
            .enumerate()
            .map(|(k, (a, b))| weight[k % self.count] * (a.re * b.re + a.im * b.im))
            .sum()
    }
}

/// Coefficients of orders (1, 0) and (1, 1) of the potential -H.r, lengths in `unit`.
pub(in crate::model) fn h_to_coefficients(h: Vec3, unit: f64) -> [Complex<f64>; 2] {
    [Complex::new(-h.z * unit, 0.0), Complex::new(h.x, -h.y) * unit]
}
