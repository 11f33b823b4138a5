//! A thin sheet of rubber.

use super::Law;
use super::hyperelastic::{StrainEnergy, Triangles};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// The neo-Hookean membrane: W = G/2 (I1 - 1 + 1/(I2 + 1)) per area at rest, `I1 = l1^2 + l2^2 - 2`,
/// `I2 = l1^2 l2^2 - 1`, G the surface shear modulus in N/m.
///
/// A thin sheet of an incompressible rubber (Barthes-Biesel, Diaz and Dhenin, J. Fluid Mech. 460, 211, 2002): it gets thinner
/// as its area grows, and softer. Its area modulus is 3 G and its surface Poisson ratio 1/2. Tension in a principal direction
/// (Cauchy): `T1 = G/(l1 l2) (l1^2 - 1/(l1 l2)^2)`. Triangles of uniform strain; F = -dE/dx, keeps force and torque.
///
/// ```
/// use lbm_ibm_membrane::{Cell, Mesh, laws::NeoHookean};
///
/// let mesh = std::sync::Arc::new(Mesh::sphere(4e-6, 642)?);
/// let capsule = Cell::new("capsule", mesh.clone()).with_law(NeoHookean::new(&mesh, 5e-6)?);
/// # Ok::<(), lbm_ibm_membrane::MembraneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct NeoHookean {
    triangles: Triangles,
    shear: f64,
}

impl NeoHookean {
    /// At rest on `mesh`, with the surface shear modulus `shear` G in N/m.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, shear: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: Triangles::of(mesh),
            shear: positive("the surface shear modulus", shear)?,
        })
    }
}

/// The strain energy, by the shear modulus.
pub(super) struct Rubber(pub f64);

impl StrainEnergy for Rubber {
    #[inline(always)]
    fn energy(&self, i1: f64, i2: f64) -> f64 {
        0.5 * self.0 * (i1 - 1.0 + 1.0 / (i2 + 1.0))
    }

    #[inline(always)]
    fn slopes(&self, _i1: f64, i2: f64) -> [f64; 2] {
        let dilation = i2 + 1.0;
        [0.5 * self.0, -0.5 * self.0 / (dilation * dilation)]
    }
}

impl Law for NeoHookean {
    fn name(&self) -> &str {
        "neo-Hookean membrane"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        self.triangles.add_forces(x, force, &Rubber(self.shear));
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(self.triangles.energy(x, &Rubber(self.shear)))
    }
}
