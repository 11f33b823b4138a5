//! Area forces as the paper's software had them.

use super::elements::Elements;
use super::{Law, corners, twice_area};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, surface_area};

/// Which area an area force answers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// That of each triangle by itself.
    Local,
    /// That of the whole cell.
    Global,
}

/// Area force of 2011: F = k (S - S0)/S0 (k in N) on each node of each triangle, along the *unit* vector from the node to
/// the triangle's centroid; S the area of the triangle or of the cell (Dupin et al. 2007, eq. 15).
///
/// The three unit vectors of a triangle that is not equilateral do not sum to zero: it keeps neither force nor torque in a
/// deformed cell, and has no energy. The paper's calibration needs it nevertheless.
#[derive(Clone, Debug)]
pub struct Area2011 {
    triangles: Elements<3, 1>,
    rest_total: f64,
    reach: Reach,
    modulus: f64,
}

impl Area2011 {
    /// Triangles at rest on `mesh`, with `modulus` k in N.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, reach: Reach, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: Elements::areas(mesh),
            rest_total: mesh.area(),
            reach,
            modulus: positive("the area modulus", modulus)?,
        })
    }
}

impl Law for Area2011 {
    fn name(&self) -> &str {
        match self.reach {
            Reach::Local => "local area 2011",
            Reach::Global => "global area 2011",
        }
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let whole = match self.reach {
            Reach::Local => 0.0,
            Reach::Global => self.modulus * (surface_area(x, self.triangles.nodes()) / self.rest_total - 1.0),
        };
        for (triangle, [rest]) in self.triangles.iter() {
            let p = corners(x, triangle);
            let strength = match self.reach {
                Reach::Local => self.modulus * (0.5 * twice_area(p).norm() / rest - 1.0),
                Reach::Global => whole,
            };
            let centroid = (p[0] + p[1] + p[2]) / 3.0;
            for (node, corner) in triangle.into_iter().zip(p) {
                let t = centroid - corner;
                force.add(node as usize, t * (strength / t.norm()));
            }
        }
    }
}
