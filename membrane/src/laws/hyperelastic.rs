//! Two-dimensional elasticity of flat triangles, whatever the strain energy.

use super::batch::{BATCH, ZERO, at, dot, gather, minus, scatter};
use super::corners;
use super::elements::{Elements, numbers};
use crate::Mesh;
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, Vec3, Work, on_widest};

/// Strain energy of a membrane per area at rest, by the invariants of the strain in its plane:
/// `I1 = l1^2 + l2^2 - 2` and `I2 = l1^2 l2^2 - 1`, `l1` and `l2` the principal stretches.
pub(super) trait StrainEnergy {
    /// The energy, J/m2.
    fn energy(&self, i1: f64, i2: f64) -> f64;

    /// Its derivatives by `I1` and `I2`, J/m2.
    fn slopes(&self, i1: f64, i2: f64) -> [f64; 2];
}

/// The triangles of a mesh, and what has to be known of their shape at rest.
///
/// The strain of a flat triangle with linear displacements is uniform (Charrier, Shrivastava and Wu, J. Strain Anal. 24, 55,
/// 1989). With `a_ij` the scalar products of two of its edges, `A_ij` the same at rest and `q = 1/sqrt(det A)` (one over twice
/// the area at rest), `I1 + 2 = A^ij a_ij` and `I2 + 1 = q^2 det a`: no turning into a common plane is needed, and the force on
/// a node is the exact derivative of the energy of its triangles.
#[derive(Clone, Debug)]
pub(super) struct Triangles {
    /// With `A_22 q`, `-A_12 q`, `A_11 q` (no unit) and `q` (1/m2).
    elements: Elements<3, 4>,
}

impl Triangles {
    /// Those of a mesh at rest.
    pub fn of(mesh: &Mesh) -> Self {
        Self {
            elements: Elements::triangles(mesh, at_rest),
        }
    }

    /// Adds minus the gradient of the energy to the force on every node, N.
    pub fn add_forces(&self, x: Soa3Ref<'_>, force: &mut Soa3Mut<'_>, law: &impl StrainEnergy) {
        on_widest(Pass {
            elements: &self.elements,
            x,
            force,
            law,
        });
    }

    /// The energy of all triangles, J.
    pub fn energy(&self, x: Soa3Ref<'_>, law: &impl StrainEnergy) -> f64 {
        let one = |(nodes, rest): ([u32; 3], [f64; 4])| {
            let [a, b, c] = corners(x, nodes);
            let (d, e) = (b - a, c - a);
            let (dd, de, ee) = (d.dot(&d), d.dot(&e), e.dot(&e));
            0.5 / rest[3] * law.energy(i1(dd, de, ee, rest), i2(dd, de, ee, rest[3]))
        };
        self.elements.iter().map(one).sum()
    }
}

/// What has to be known of a triangle at rest.
fn at_rest([a, b, c]: [Vec3; 3]) -> [f64; 4] {
    let (d, e) = (b - a, c - a);
    let q = 1.0 / d.cross(&e).norm();
    [e.dot(&e) * q, -d.dot(&e) * q, d.dot(&d) * q, q]
}

/// All triangles, some at a time.
struct Pass<'a, 'f, L> {
    elements: &'a Elements<3, 4>,
    x: Soa3Ref<'a>,
    force: &'a mut Soa3Mut<'f>,
    law: &'a L,
}

impl<L: StrainEnergy> Work for Pass<'_, '_, L> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let (mut corners, mut forces) = ([ZERO; 3], [ZERO; 3]);
        for (nodes, rest) in self.elements.batches() {
            gather(self.x, nodes, &mut corners);
            let rest = numbers(rest);
            for i in 0..BATCH {
                let [a, b, c] = [0, 1, 2].map(|p| at(&corners[p], i));
                let (d, e) = (minus(b, a), minus(c, a));
                let [p, r, s, q] = [0, 1, 2, 3].map(|k| rest[k][i]);
                let (dd, de, ee) = (dot(d, d), dot(d, e), dot(e, e));
                let [w1, w2] = self.law.slopes(i1(dd, de, ee, [p, r, s, q]), i2(dd, de, ee, q));
                let (of_d, of_both, of_e) = (w1 * p + w2 * q * ee, w1 * r - w2 * q * de, w1 * s + w2 * q * dd);
                for k in 0..3 {
                    let (f, g) = (of_d * d[k] + of_both * e[k], of_both * d[k] + of_e * e[k]);
                    forces[0][k][i] = f + g;
                    forces[1][k][i] = -f;
                    forces[2][k][i] = -g;
                }
            }
            scatter(&forces, nodes, self.force);
        }
    }
}

#[inline(always)]
fn i1(dd: f64, de: f64, ee: f64, [p, r, s, q]: [f64; 4]) -> f64 {
    q * (p * dd + 2.0 * r * de + s * ee) - 2.0
}

#[inline(always)]
fn i2(dd: f64, de: f64, ee: f64, q: f64) -> f64 {
    q * q * (dd * ee - de * de) - 1.0
}

#[cfg(test)]
mod tests;
