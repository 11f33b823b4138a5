//! The paper's four moduli at the price of two passes.

use super::elements::Elements;
use super::shell::{self, Shell};
use super::triangles::Tensions;
use super::{Bending, GlobalArea, Law, LocalArea, Stretching, Volume};
use crate::{MembraneError, Mesh};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};
use std::sync::Arc;

/// [`Stretching`], [`Bending`], [`LocalArea`], [`GlobalArea`] and [`Volume`] together: the same forces and energy, to
/// the last digits, in one pass over the edges and one over the triangles, instead of one or two for each.
#[derive(Clone, Debug)]
pub struct FourModuli {
    stretching: Stretching,
    bending: Bending,
    local: LocalArea,
    global: GlobalArea,
    volume: Volume,
    /// With angles (rad) and lengths (m) at rest.
    hinges: Elements<4, 2>,
    /// The edges of each triangle.
    sides: Arc<[[u32; 3]]>,
}

impl FourModuli {
    /// At rest on `mesh`, with the modulus of [`Stretching`] (N), that of [`Bending`] (J), those of the triangles' areas and
    /// of the cell's (N/m) and that of its volume (Pa).
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(
        mesh: &Mesh,
        stretching: f64,
        bending: f64,
        local: f64,
        global: f64,
        volume: f64,
    ) -> Result<Self, MembraneError> {
        Ok(Self {
            stretching: Stretching::new(mesh, stretching)?,
            bending: Bending::new(mesh, bending)?,
            local: LocalArea::new(mesh, local)?,
            global: GlobalArea::new(mesh, global)?,
            volume: Volume::new(mesh, volume)?,
            hinges: Elements::hinges(mesh, |h| [h.angle(), h.edge.norm()]),
            sides: shell::sides(mesh),
        })
    }
}

impl Law for FourModuli {
    fn name(&self) -> &str {
        "stretching, bending, local area, global area, volume"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let shell = Shell {
            hinges: &self.hinges,
            triangles: self.local.triangles(),
            sides: &self.sides,
            stretching: self.stretching.modulus(),
            bending: self.bending.angles(),
        };
        shell.add(x, force, |area, volume| Tensions {
            local: self.local.modulus(),
            global: self.global.tension(area),
            pressure: self.volume.pressure(volume),
        });
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let laws: [&dyn Law; 5] = [&self.stretching, &self.bending, &self.local, &self.global, &self.volume];
        laws.iter().map(|law| law.energy(x)).sum()
    }
}
