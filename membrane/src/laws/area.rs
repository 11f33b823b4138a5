//! Area elasticity from an energy.

use super::elements::Elements;
use super::triangles::{self, Tensions};
use super::{Law, corners, twice_area};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, surface_area};

/// Elasticity of each triangle's area: E = sum of K/2 (S - S0)^2/S0, K in N/m. F = -dE/dx; keeps force and torque.
///
/// A force k (S - S0) t/sum|t|^2 along the node-to-centroid vectors t (Jancigova and Cimrak, Int. J. Numer. Meth. Biomed.
/// Eng. 32, e02757, 2016) also keeps force and torque but has no energy: it is -k/2 (S - S0) times the gradient of
/// ln(sum|t|^2), and S is no function of that sum. This law goes along the triangle's heights instead; the two agree on
/// equilateral triangles.
#[derive(Clone, Debug)]
pub struct LocalArea {
    triangles: Elements<3, 1>,
    modulus: f64,
}

impl LocalArea {
    /// Triangles at rest on `mesh`, with `modulus` K in N/m.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: Elements::areas(mesh),
            modulus: positive("the local area modulus", modulus)?,
        })
    }

    /// The modulus K (N/m) that does the same work in a small uniform dilation as
    /// [`Area2011`](super::Area2011) with `k` (N), local as well as global: K = k T/(2 S0), T the sum over all triangles of
    /// the distances from their nodes to their centroids, S0 the area of the cell; 2 k/L0 for equilateral triangles.
    pub fn modulus_from_2011(mesh: &Mesh, k: f64) -> f64 {
        let medians = |&t: &[u32; 3]| {
            let p = corners(mesh.nodes(), t);
            let centroid = (p[0] + p[1] + p[2]) / 3.0;
            p.iter().map(|x| (x - centroid).norm()).sum::<f64>()
        };
        k * mesh.triangles().iter().map(medians).sum::<f64>() / (2.0 * mesh.area())
    }

    pub(super) fn triangles(&self) -> &Elements<3, 1> {
        &self.triangles
    }

    pub(super) fn modulus(&self) -> f64 {
        self.modulus
    }
}

impl Law for LocalArea {
    fn name(&self) -> &str {
        "local area"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let tensions = Tensions {
            local: self.modulus,
            global: 0.0,
            pressure: 0.0,
        };
        triangles::add(x, &self.triangles, &tensions, force);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let term = |(t, [rest]): ([u32; 3], [f64; 1])| (0.5 * twice_area(corners(x, t)).norm() - rest).powi(2) / rest;
        Some(0.5 * self.modulus * self.triangles.iter().map(term).sum::<f64>())
    }
}

/// Elasticity of the area of the whole cell: E = K/2 (S - S0)^2/S0, K in N/m. F = -dE/dx; keeps force and torque. The
/// modulus converts like that of [`LocalArea`].
#[derive(Clone, Debug)]
pub struct GlobalArea {
    triangles: Elements<3, 0>,
    rest: f64,
    modulus: f64,
}

impl GlobalArea {
    /// At rest on `mesh`, with `modulus` K in N/m.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: Elements::triangles(mesh, |_| []),
            rest: mesh.area(),
            modulus: positive("the global area modulus", modulus)?,
        })
    }

    /// Tension (N/m) of a cell of this area (m2).
    pub(super) fn tension(&self, area: f64) -> f64 {
        self.modulus * (area / self.rest - 1.0)
    }
}

impl Law for GlobalArea {
    fn name(&self) -> &str {
        "global area"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let tensions = Tensions {
            local: 0.0,
            global: self.tension(triangles::measure(x, self.triangles.nodes()).0),
            pressure: 0.0,
        };
        triangles::add(x, &self.triangles, &tensions, force);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(0.5 * self.modulus * (surface_area(x, self.triangles.nodes()) - self.rest).powi(2) / self.rest)
    }
}
