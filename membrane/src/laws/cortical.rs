//! Cortical tension.

use super::Law;
use super::elements::Elements;
use super::triangles::{self, Tensions};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, surface_area};

/// Constant tension of the cortex: E = T S, T in N/m, S the area of the cell. The liquid-drop model of a leucocyte
/// (Yeung and Evans, Biophys. J. 56, 139, 1989; Hochmuth, J. Biomech. 33, 15, 2000). F = -dE/dx; keeps force and
/// torque.
///
/// It has no rest shape: the cell becomes a sphere, inside which the pressure is higher by 2 T/R. With a
/// [`Volume`](super::Volume) law of modulus kv the volume settles lower by 2 T/(R kv), unless that law's rest volume
/// is larger. Nothing holds the nodes in the surface: add a weak law that does, such as [`Bending`](super::Bending)
/// with a local area.
#[derive(Clone, Debug)]
pub struct CorticalTension {
    triangles: Elements<3, 0>,
    tension: f64,
}

impl CorticalTension {
    /// On the triangles of `mesh`, with `tension` T in N/m.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, tension: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: Elements::triangles(mesh, |_| []),
            tension: positive("the cortical tension", tension)?,
        })
    }
}

impl Law for CorticalTension {
    fn name(&self) -> &str {
        "cortical tension"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let tensions = Tensions {
            local: 0.0,
            global: self.tension,
            pressure: 0.0,
        };
        triangles::add(x, &self.triangles, &tensions, force);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(self.tension * surface_area(x, self.triangles.nodes()))
    }
}
