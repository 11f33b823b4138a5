//! Two-dimensional elasticity of flat triangles, whatever the strain energy.

use super::corners;
use crate::Mesh;
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// Triangles worked on together.
const LANES: usize = 8;

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
    nodes: Vec<[u32; 3]>,
    /// `A_22 q`, `-A_12 q`, `A_11 q` (no unit) and `q` (1/m2), each of all triangles.
    rest: [Vec<f64>; 4],
}

/// So many numbers, one of each triangle that is worked on.
type Lanes = [f64; LANES];

impl Triangles {
    /// Those of a mesh at rest.
    pub fn of(mesh: &Mesh) -> Self {
        Self::new(mesh.nodes(), mesh.triangles())
    }

    /// Triangles at rest at node positions `x` (m).
    fn new(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> Self {
        let mut rest: [Vec<f64>; 4] = Default::default();
        for &t in triangles {
            let [a, b, c] = corners(x, t);
            let (d, e) = (b - a, c - a);
            let q = 1.0 / d.cross(&e).norm();
            for (to, value) in rest.iter_mut().zip([e.dot(&e) * q, -d.dot(&e) * q, d.dot(&d) * q, q]) {
                to.push(value);
            }
        }
        Self {
            nodes: triangles.to_vec(),
            rest,
        }
    }

    /// Adds minus the gradient of the energy to the force on every node, N.
    #[inline]
    pub fn add_forces(&self, x: Soa3Ref<'_>, force: &mut Soa3Mut<'_>, law: &impl StrainEnergy) {
        for (first, nodes) in self.nodes.chunks(LANES).enumerate() {
            let rest = self.rest_of(first * LANES, nodes.len());
            let edges = edges(x, nodes);
            let mut pull = [[[0.0; LANES]; 3]; 2];
            for i in 0..LANES {
                let [d, e] = [0, 1].map(|k: usize| [edges[k][0][i], edges[k][1][i], edges[k][2][i]]);
                let [p, r, s, q] = [rest[0][i], rest[1][i], rest[2][i], rest[3][i]];
                let (dd, de, ee) = (dot(d, d), dot(d, e), dot(e, e));
                let [w1, w2] = law.slopes(i1(dd, de, ee, [p, r, s, q]), i2(dd, de, ee, q));
                let (of_d, of_both, of_e) = (w1 * p + w2 * q * ee, w1 * r - w2 * q * de, w1 * s + w2 * q * dd);
                for a in 0..3 {
                    pull[0][a][i] = of_d * d[a] + of_both * e[a];
                    pull[1][a][i] = of_both * d[a] + of_e * e[a];
                }
            }
            for (i, &[a, b, c]) in nodes.iter().enumerate() {
                for (k, to) in [&mut *force.x, &mut *force.y, &mut *force.z].into_iter().enumerate() {
                    let (f, g) = (pull[0][k][i], pull[1][k][i]);
                    to[a as usize] += f + g;
                    to[b as usize] -= f;
                    to[c as usize] -= g;
                }
            }
        }
    }

    /// The energy of all triangles, J.
    pub fn energy(&self, x: Soa3Ref<'_>, law: &impl StrainEnergy) -> f64 {
        let one = |(t, &nodes): (usize, &[u32; 3])| {
            let [a, b, c] = corners(x, nodes);
            let (d, e) = (b - a, c - a);
            let (dd, de, ee) = (d.dot(&d), d.dot(&e), e.dot(&e));
            let rest = [0, 1, 2, 3].map(|k: usize| self.rest[k][t]);
            0.5 / rest[3] * law.energy(i1(dd, de, ee, rest), i2(dd, de, ee, rest[3]))
        };
        self.nodes.iter().enumerate().map(one).sum()
    }

    /// What is known of the triangles from `first` on; lanes beyond the last triangle have that of an unstrained one.
    #[inline]
    fn rest_of(&self, first: usize, count: usize) -> [Lanes; 4] {
        let mut lanes = [[1.0; LANES], [0.0; LANES], [1.0; LANES], [1.0; LANES]];
        for (to, from) in lanes.iter_mut().zip(&self.rest) {
            to[..count].copy_from_slice(&from[first..first + count]);
        }
        lanes
    }
}

/// The edges from the first corner to the second and to the third, by component; lanes beyond the last triangle are at rest.
#[inline]
fn edges(x: Soa3Ref<'_>, nodes: &[[u32; 3]]) -> [[Lanes; 3]; 2] {
    let mut edges = [[[0.0; LANES]; 3]; 2];
    edges[0][0] = [1.0; LANES];
    edges[1][1] = [1.0; LANES];
    for (i, &[a, b, c]) in nodes.iter().enumerate() {
        for (k, x) in [x.x, x.y, x.z].into_iter().enumerate() {
            edges[0][k][i] = x[b as usize] - x[a as usize];
            edges[1][k][i] = x[c as usize] - x[a as usize];
        }
    }
    edges
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
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
