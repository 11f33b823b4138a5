//! Bending by the cosine of the angle between triangles.

use super::Law;
use super::edges::{self, Fold};
use super::elements::Elements;
use super::hinge::Hinge;
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// Bending of Kantor and Nelson (Phys. Rev. Lett. 58, 2774, 1987): E = sum over edges of k (1 - cos(phi - phi0)), k in
/// J, phi the angle between the outward normals of the two triangles, positive where the cell is convex. phi0 is that
/// of the rest shape or zero. F = -dE/dx; keeps force and torque.
///
/// The continuum's bending stiffness kappa depends on the shape: sqrt(3)/2 k for a cylinder or a small wave of a mesh
/// of equilateral triangles (Seung and Nelson, Phys. Rev. A 38, 1005, 1988); a sphere has the energy 4 pi k/sqrt(3)
/// (Gompper and Kroll, J. Phys. I France 6, 1305, 1996), on meshes of uneven edges 7 to 14 % more, however fine.
/// [`Helfrich`](super::Helfrich) has one stiffness for both.
#[derive(Clone, Debug)]
pub struct KantorNelson {
    /// With sine and cosine of phi0.
    hinges: Elements<4, 2>,
    modulus: f64,
}

impl KantorNelson {
    /// Hinges at rest in the angles of `mesh`, with `modulus` k in J.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        let turn = |h: &Hinge| {
            let (sin, cos) = h.turn();
            [sin, cos]
        };
        Ok(Self {
            hinges: Elements::hinges(mesh, turn),
            modulus: positive("the bending stiffness of a hinge", modulus)?,
        })
    }

    /// The same with flat hinges at rest (phi0 = 0), as in the first paper.
    #[must_use]
    pub fn flat(mut self) -> Self {
        self.hinges = self.hinges.at_rest(|_| [0.0, 1.0]);
        self
    }

    /// The stiffness k (J) of a hinge for a bending stiffness `kappa` (J) of the continuum, 2 kappa/sqrt(3).
    pub fn modulus_for(kappa: f64) -> f64 {
        2.0 * kappa / 3.0_f64.sqrt()
    }
}

/// Its moment, by the modulus (J).
struct Cosines(f64);

impl Fold<2> for Cosines {
    #[inline(always)]
    fn moment(&self, sin: f64, cos: f64, [sin0, cos0]: [f64; 2]) -> f64 {
        // phi is pi less the angle inside, so the moment on that angle is +dE/dphi.
        self.0 * (sin * cos0 - cos * sin0) / (sin * sin + cos * cos).sqrt()
    }
}

impl Law for KantorNelson {
    fn name(&self) -> &str {
        "Kantor-Nelson bending"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        edges::fold(&self.hinges, x, force, &Cosines(self.modulus));
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let hinge = |(hinge, [sin0, cos0]): ([u32; 4], [f64; 2])| {
            let (sin, cos) = Hinge::at(x, hinge).turn();
            // 1 - cos(d) as 2 sin(d/2)^2, which keeps its digits for small d.
            let (s, c) = (sin * cos0 - cos * sin0, cos * cos0 + sin * sin0);
            2.0 * (0.5 * s.atan2(c)).sin().powi(2)
        };
        Some(self.modulus * self.hinges.iter().map(hinge).sum::<f64>())
    }
}
