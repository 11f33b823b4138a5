//! Volume elasticity.

use super::Law;
use super::elements::Elements;
use super::triangles::{self, Tensions};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, enclosed_volume};

/// Volume elasticity: F = -kv (V - V0)/V0 S n/3 on each node of each triangle of area S and outward normal n (Dupin et al.
/// 2007, eq. 13; kv in Pa).
///
/// On a closed mesh that is exactly the gradient of E = kv/2 (V - V0)^2/V0, so it keeps force and torque.
#[derive(Clone, Debug)]
pub struct Volume {
    triangles: Elements<3, 0>,
    rest: f64,
    modulus: f64,
}

impl Volume {
    /// At rest on `mesh`, with `modulus` kv in Pa.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: Elements::triangles(mesh, |_| []),
            rest: mesh.volume(),
            modulus: positive("the volume modulus", modulus)?,
        })
    }

    /// Pressure (Pa) outwards in a cell of this volume (m3).
    pub(super) fn pressure(&self, volume: f64) -> f64 {
        self.modulus * (1.0 - volume / self.rest)
    }
}

impl Law for Volume {
    fn name(&self) -> &str {
        "volume"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let tensions = Tensions {
            local: 0.0,
            global: 0.0,
            pressure: self.pressure(triangles::measure(x, self.triangles.nodes()).1),
        };
        triangles::add(x, &self.triangles, &tensions, force);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(0.5 * self.modulus * (enclosed_volume(x, self.triangles.nodes()) - self.rest).powi(2) / self.rest)
    }
}
