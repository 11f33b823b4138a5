//! The area of each triangle, of the cell, and its volume, at the price of one.

use super::triangles::{self, Tensions};
use super::{GlobalArea, Law, LocalArea, Volume};
use crate::{MembraneError, Mesh};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// [`LocalArea`], [`GlobalArea`] and [`Volume`] together: the same forces and energy in one pass over the triangles
/// instead of three.
#[derive(Clone, Debug)]
pub struct AreaVolume {
    local: LocalArea,
    global: GlobalArea,
    volume: Volume,
}

impl AreaVolume {
    /// At rest on `mesh`, with the moduli of the triangles' areas and of the cell's (N/m) and of its volume (Pa).
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, local: f64, global: f64, volume: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            local: LocalArea::new(mesh, local)?,
            global: GlobalArea::new(mesh, global)?,
            volume: Volume::new(mesh, volume)?,
        })
    }
}

impl Law for AreaVolume {
    fn name(&self) -> &str {
        "local area, global area, volume"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let (area, volume) = triangles::measure(x, self.local.triangles());
        let tensions = Tensions {
            global: self.global.tension(area),
            pressure: self.volume.pressure(volume),
            ..self.local.tensions()
        };
        triangles::add(x, self.local.triangles(), &tensions, force);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        Some(self.local.energy(x)? + self.global.energy(x)? + self.volume.energy(x)?)
    }
}
