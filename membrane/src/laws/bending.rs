//! Bending from an energy.

use super::Law;
use super::batch::{BATCH, ZERO, at, atan2, cross, dot, gather, minus, numbers, scatter};
use super::hinge::{Hinge, nodes};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, Work, on_widest};
use std::f64::consts::PI;

/// Bending energy of the angle between neighbouring triangles: E = sum over edges of k/2 (theta - theta0)^2, k in J, with
/// theta the angle inside the cell, pi when flat. F = -dE/dx; keeps force and torque.
///
/// On a mesh of equilateral triangles the continuum's bending stiffness is kappa = sqrt(3)/2 k (Seung and Nelson, Phys.
/// Rev. A 38, 1005, 1988).
#[derive(Clone, Debug)]
pub struct Bending {
    hinges: Vec<[u32; 4]>,
    rest: Vec<f64>,
    modulus: f64,
}

impl Bending {
    /// Hinges at rest on `mesh`, with `modulus` k in J.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        let hinges: Vec<_> = mesh.edges().iter().map(nodes).collect();
        Ok(Self {
            rest: hinges.iter().map(|&h| Hinge::at(mesh.nodes(), h).angle()).collect(),
            hinges,
            modulus: positive("the bending stiffness of a hinge", modulus)?,
        })
    }

    /// The stiffness k (J) of a hinge that answers a small change of angle with the same force on the opposite nodes as
    /// [`Bending2011`](super::Bending2011) with `kb` (N): k = kb times the mean of h/theta0, h the height of an opposite
    /// node over its edge.
    pub fn stiffness_from_2011(mesh: &Mesh, kb: f64) -> f64 {
        let ratio = |e| {
            let h = Hinge::at(mesh.nodes(), nodes(e));
            let [c, d] = h.heights();
            0.5 * (c + d) / h.angle()
        };
        kb * mesh.edges().iter().map(ratio).sum::<f64>() / mesh.edges().len() as f64
    }
}

/// All hinges, some at a time.
struct Pass<'a, 'f> {
    law: &'a Bending,
    x: Soa3Ref<'a>,
    force: &'a mut Soa3Mut<'f>,
}

impl Work for Pass<'_, '_> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let modulus = self.law.modulus;
        let (mut corners, mut forces) = ([ZERO; 4], [ZERO; 4]);
        for (hinges, rest) in self.law.hinges.chunks(BATCH).zip(self.law.rest.chunks(BATCH)) {
            gather(self.x, hinges, &mut corners);
            let rest = numbers(rest);
            for i in 0..BATCH {
                let [a, b, c, d] = [0, 1, 2, 3].map(|p| at(&corners[p], i));
                let (edge, c, d) = (minus(b, a), minus(c, a), minus(d, a));
                let (first, second) = (cross(edge, c), cross(d, edge));
                let square = dot(edge, edge);
                let length = square.sqrt();
                // first x second = -edge (d . first).
                let turn = atan2(-length * dot(d, first), dot(first, second));
                // theta grows as an opposite node goes outwards, by one over its height; where the foot of the height
                // lies along the edge tells how the edge's nodes share the reaction.
                let strength = -modulus * ((PI - turn) - rest[i]) * length;
                let u = strength / dot(first, first);
                let v = strength / dot(second, second);
                let per_square = 1.0 / square;
                let (p, q) = (dot(c, edge) * per_square, dot(d, edge) * per_square);
                for k in 0..3 {
                    let (f, g) = (first[k] * u, second[k] * v);
                    forces[0][k][i] = f * (p - 1.0) + g * (q - 1.0);
                    forces[1][k][i] = -f * p - g * q;
                    forces[2][k][i] = f;
                    forces[3][k][i] = g;
                }
            }
            scatter(&forces, hinges, self.force);
        }
    }
}

impl Law for Bending {
    fn name(&self) -> &str {
        "bending"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        on_widest(Pass { law: self, x, force });
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let hinge = |(&hinge, &rest): (&[u32; 4], &f64)| (Hinge::at(x, hinge).angle() - rest).powi(2);
        Some(0.5 * self.modulus * self.hinges.iter().zip(&self.rest).map(hinge).sum::<f64>())
    }
}
