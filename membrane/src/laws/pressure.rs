//! A constant pressure inside.

use super::{Law, corners, twice_area};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, enclosed_volume};
use std::sync::Arc;

/// Constant pressure p (Pa) inside the cell: E = -p (V - V0), a third of p S n on each node of each triangle of area S
/// and outward normal n. On a closed mesh F = -dE/dx; keeps force and torque.
///
/// It bears what a [`CorticalTension`](super::CorticalTension) T presses on the inside of a sphere of radius R, 2 T/R
/// (Laplace), so that a [`Volume`](super::Volume) law stays at its rest volume.
#[derive(Clone, Debug)]
pub struct Pressure {
    triangles: Arc<[[u32; 3]]>,
    rest: f64,
    pressure: f64,
}

impl Pressure {
    /// In `mesh`, with `pressure` p in Pa.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, pressure: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            triangles: mesh.shared_triangles(),
            rest: mesh.volume(),
            pressure: positive("the pressure inside a cell", pressure)?,
        })
    }
}

impl Law for Pressure {
    fn name(&self) -> &str {
        "pressure"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for &triangle in &*self.triangles {
            let f = twice_area(corners(x, triangle)) * (self.pressure / 6.0);
            for node in triangle {
                force.add(node as usize, f);
            }
        }
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(self.pressure * (self.rest - enclosed_volume(x, &self.triangles)))
    }
}
