//! Bending from an energy.

use super::Law;
use super::batch::atan2;
use super::edges::{self, Fold};
use super::elements::Elements;
use super::hinge::{Hinge, nodes};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};
use std::f64::consts::PI;

/// Bending energy of the angle between neighbouring triangles: E = sum over edges of k/2 (theta - theta0)^2, k in J, with
/// theta the angle inside the cell, pi when flat. F = -dE/dx; keeps force and torque.
///
/// On a mesh of equilateral triangles the continuum's bending stiffness is kappa = sqrt(3)/2 k (Seung and Nelson, Phys.
/// Rev. A 38, 1005, 1988).
#[derive(Clone, Debug)]
pub struct Bending {
    hinges: Elements<4, 1>,
    modulus: f64,
}

impl Bending {
    /// Hinges at rest on `mesh`, with `modulus` k in J.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            hinges: Elements::hinges(mesh, |h| [h.angle()]),
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

    pub(super) fn angles(&self) -> Angles {
        Angles(self.modulus)
    }
}

/// Its moment, by the modulus (J).
pub(super) struct Angles(pub f64);

impl Fold<1> for Angles {
    #[inline(always)]
    fn moment(&self, sin: f64, cos: f64, [rest]: [f64; 1]) -> f64 {
        -self.0 * ((PI - atan2(sin, cos)) - rest)
    }
}

impl Law for Bending {
    fn name(&self) -> &str {
        "bending"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        edges::fold(&self.hinges, x, force, &self.angles());
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let hinge = |(hinge, [rest]): ([u32; 4], [f64; 1])| (Hinge::at(x, hinge).angle() - rest).powi(2);
        Some(0.5 * self.modulus * self.hinges.iter().map(hinge).sum::<f64>())
    }
}
