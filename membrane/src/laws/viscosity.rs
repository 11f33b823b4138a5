//! Membrane viscosity.

use super::{Law, corners, twice_area};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};
use std::sync::Arc;

/// Viscosity within the membrane, beside the elastic laws (Kelvin and Voigt): the tensions
/// 2 eta (D - tr(D)/2 I) + zeta tr(D) I in the plane of each triangle, D its rate of strain, eta the shear and zeta the
/// dilatational viscosity of the membrane in N s/m (Barthes-Biesel and Sgaier, J. Fluid Mech. 160, 119, 1985). A red
/// blood cell has eta of 0.3 to 1 uN s/m (Evans and Hochmuth, Biophys. J. 16, 1, 1976).
///
/// With velocities linear in each triangle the forces are minus half the gradient, with respect to the velocities, of
/// the power that is lost. They keep force and torque, and vanish in every rigid motion. Together with a shear modulus
/// G a shape recovers within the time eta/G.
///
/// The forces follow from the velocities of the nodes now. An explicit step bears them while eta is below some
/// rho h^2/dt (a fluid of density rho on a grid of spacing h): far below a red blood cell's.
#[derive(Clone, Debug)]
pub struct Viscosity {
    triangles: Arc<[[u32; 3]]>,
    shear: f64,
    dilatational: f64,
}

impl Viscosity {
    /// On the triangles of `mesh`, with `shear` viscosity eta in N s/m and no resistance to dilation.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, shear: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: mesh.shared_triangles(),
            shear: positive("the shear viscosity of a membrane", shear)?,
            dilatational: 0.0,
        })
    }

    /// The same with `dilatational` viscosity zeta in N s/m.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn with_dilatational(mut self, dilatational: f64) -> Result<Self, MembraneError> {
        self.dilatational = positive("the dilatational viscosity of a membrane", dilatational)?;
        Ok(self)
    }
}

impl Law for Viscosity {
    fn name(&self) -> &str {
        "membrane viscosity"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for &triangle in &*self.triangles {
            let [a, b, c] = corners(x, triangle);
            let [va, vb, vc] = corners(v, triangle);
            let (e, f) = (b - a, c - a);
            let (de, df) = (vb - va, vc - va);
            let area = 0.5 * twice_area([a, b, c]).norm();
            // The metric of the sides e and f, its inverse, and D with lower indices.
            let (ee, ef, ff) = (e.dot(&e), e.dot(&f), f.dot(&f));
            let determinant = ee * ff - ef * ef;
            let (iee, ief, iff) = (ff / determinant, -ef / determinant, ee / determinant);
            let (dee, def, dff) = (de.dot(&e), 0.5 * (de.dot(&f) + df.dot(&e)), df.dot(&f));
            let trace = iee * dee + 2.0 * ief * def + iff * dff;
            // Tensions with upper indices: 2 eta g D g + (zeta - eta) tr(D) g.
            let (pe, pf) = (iee * dee + ief * def, iee * def + ief * dff);
            let (qe, qf) = (ief * dee + iff * def, ief * def + iff * dff);
            let isotropic = (self.dilatational - self.shear) * trace;
            let tee = 2.0 * self.shear * (pe * iee + pf * ief) + isotropic * iee;
            let tef = 2.0 * self.shear * (pe * ief + pf * iff) + isotropic * ief;
            let tff = 2.0 * self.shear * (qe * ief + qf * iff) + isotropic * iff;
            let first = -(e * tee + f * tef) * area;
            let second = -(e * tef + f * tff) * area;
            force.add(triangle[0] as usize, -first - second);
            force.add(triangle[1] as usize, first);
            force.add(triangle[2] as usize, second);
        }
    }
}
