//! All beads' multipoles together.

use super::coupling::{Field, Link, Shape};
use crate::MU0;
use crate::model::near::Interaction;
use lbm_ibm_coupling::nalgebra::Complex;
use lbm_ibm_coupling::{Soa3, Vec3};
use std::f64::consts::PI;

/// The coupled system of all beads, lengths in the largest radius.
pub(super) struct System<'a> {
    pub shapes: Vec<Shape>,
    pub links: Vec<Link>,
    pub far: Interaction<'a>,
    pub far_distance: f64,
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
        self.far.field_at(x, moments.view(), self.far_distance, &mut field);
        for i in 0..self.shapes.len() {
            let h = field.get(i) / MU0;
            into[i * self.count] += h_to_coefficients(h, self.unit)[0];
            into[i * self.count + 1] += h_to_coefficients(h, self.unit)[1];
        }
        into
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
pub(super) fn h_to_coefficients(h: Vec3, unit: f64) -> [Complex<f64>; 2] {
    [Complex::new(-h.z * unit, 0.0), Complex::new(h.x, -h.y) * unit]
}
