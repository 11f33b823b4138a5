//! The membrane of a red blood cell.

use super::Law;
use super::hyperelastic::{StrainEnergy, Triangles};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// The membrane of Skalak, Tozeren, Zarda and Chien (Biophys. J. 13, 245, 1973): W = G/4 (I1^2 + 2 I1 - 2 I2 + C I2^2) per
/// area at rest, `I1 = l1^2 + l2^2 - 2`, `I2 = l1^2 l2^2 - 1`, G the surface shear modulus in N/m and C the area ratio.
///
/// It gets stiffer as it is strained. Its area modulus is G (1 + 2 C), its surface Poisson ratio C/(1 + C). Tension in a
/// principal direction (Cauchy): `T1 = G l1/l2 (l1^2 - 1 + C l2^2 (l1^2 l2^2 - 1))`. Triangles of uniform strain; F = -dE/dx,
/// keeps force and torque.
///
/// ```
/// use lbm_ibm_membrane::{Cell, Mesh, laws::Skalak};
///
/// let mesh = std::sync::Arc::new(Mesh::sphere(4e-6, 642)?);
/// let capsule = Cell::new("capsule", mesh.clone()).with_law(Skalak::new(&mesh, 5e-6, 10.0)?);
/// # Ok::<(), lbm_ibm_membrane::MembraneError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Skalak {
    triangles: Triangles,
    shear: f64,
    area_ratio: f64,
}

impl Skalak {
    /// At rest on `mesh`, with the surface shear modulus `shear` G in N/m and the `area_ratio` C, above -1/2.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, shear: f64, area_ratio: f64) -> Result<Self, MembraneError> {
        positive("1/2 plus the area ratio C of Skalak's law", 0.5 + area_ratio)?;
        Ok(Self {
            triangles: Triangles::of(mesh),
            shear: positive("the surface shear modulus", shear)?,
            area_ratio,
        })
    }

    fn energy_per_area(&self) -> Stiffening {
        Stiffening(self.shear, self.area_ratio)
    }
}

/// The strain energy, by shear modulus and area ratio.
pub(super) struct Stiffening(pub f64, pub f64);

impl StrainEnergy for Stiffening {
    #[inline(always)]
    fn energy(&self, i1: f64, i2: f64) -> f64 {
        0.25 * self.0 * (i1 * i1 + 2.0 * (i1 - i2) + self.1 * i2 * i2)
    }

    #[inline(always)]
    fn slopes(&self, i1: f64, i2: f64) -> [f64; 2] {
        [0.5 * self.0 * (i1 + 1.0), 0.5 * self.0 * (self.1 * i2 - 1.0)]
    }
}

impl Law for Skalak {
    fn name(&self) -> &str {
        "Skalak membrane"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        self.triangles.add_forces(x, force, &self.energy_per_area());
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(self.triangles.energy(x, &self.energy_per_area()))
    }
}
