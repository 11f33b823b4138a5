//! Bending as the paper's software had it.

use super::Law;
use super::elements::Elements;
use super::hinge::Hinge;
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// Bending force of 2011: F = kb (theta - theta0)/theta0 (kb in N), on each of the two nodes opposite to an edge along the
/// inward normal of its triangle, and minus half of their sum on each node of the edge (Dupin et al. 2007, eq. 20, 21).
/// theta is the angle inside the cell, pi when flat, here by atan2.
///
/// Keeps force, but not torque (the edge takes equal halves wherever the opposite nodes sit), and has no energy.
#[derive(Clone, Debug)]
pub struct Bending2011 {
    hinges: Elements<4, 1>,
    modulus: f64,
}

impl Bending2011 {
    /// Hinges at rest on `mesh`, with `modulus` kb in N.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            hinges: Elements::hinges(mesh, |h| [h.angle()]),
            modulus: positive("the bending modulus", modulus)?,
        })
    }
}

impl Law for Bending2011 {
    fn name(&self) -> &str {
        "bending 2011"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for (hinge, [rest]) in self.hinges.iter() {
            let h = Hinge::at(x, hinge);
            let strength = -self.modulus * (h.angle() / rest - 1.0);
            let [a, b, c, d] = [
                hinge[0] as usize,
                hinge[1] as usize,
                hinge[2] as usize,
                hinge[3] as usize,
            ];
            let (first, second) = (
                h.first * (strength / h.first.norm()),
                h.second * (strength / h.second.norm()),
            );
            let half = -0.5 * (first + second);
            force.add(a, half);
            force.add(b, half);
            force.add(c, first);
            force.add(d, second);
        }
    }
}
