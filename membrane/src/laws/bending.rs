//! Bending from an energy.

use super::Law;
use super::hinge::{Hinge, nodes};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

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

impl Law for Bending {
    fn name(&self) -> &str {
        "bending"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for (&hinge, &rest) in self.hinges.iter().zip(&self.rest) {
            let h = Hinge::at(x, hinge);
            h.add_moment(x, hinge, -self.modulus * (h.angle() - rest), force);
        }
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let hinge = |(&hinge, &rest): (&[u32; 4], &f64)| (Hinge::at(x, hinge).angle() - rest).powi(2);
        Some(0.5 * self.modulus * self.hinges.iter().zip(&self.rest).map(hinge).sum::<f64>())
    }
}
