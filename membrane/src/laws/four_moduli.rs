//! The paper's four moduli at the price of two passes.

use super::edges::{self, Fold};
use super::elements::Elements;
use super::triangles::{self, Tensions};
use super::{Bending, GlobalArea, Law, LocalArea, Stretching, Volume, bending, stretching};
use crate::{MembraneError, Mesh};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// [`Stretching`], [`Bending`], [`LocalArea`], [`GlobalArea`] and [`Volume`] together: the same forces and energy in one
/// pass over the edges and one over the triangles, instead of one or two for each.
#[derive(Clone, Debug)]
pub struct FourModuli {
    stretching: Stretching,
    bending: Bending,
    local: LocalArea,
    global: GlobalArea,
    volume: Volume,
    /// With angles (rad) and lengths (m) at rest.
    hinges: Elements<4, 2>,
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
        })
    }
}

/// Springs and hinges, by the springs' modulus (N).
struct Edges {
    stretching: f64,
    bending: bending::Angles,
}

impl Fold<2> for Edges {
    const WHOLE: bool = true;

    #[inline(always)]
    fn moment(&self, sin: f64, cos: f64, [angle, _]: [f64; 2]) -> f64 {
        self.bending.moment(sin, cos, [angle])
    }

    #[inline(always)]
    fn pull(&self, length: f64, [_, rest]: [f64; 2]) -> f64 {
        stretching::tension_per_length(self.stretching, length, rest)
    }
}

impl Law for FourModuli {
    fn name(&self) -> &str {
        "stretching, bending, local area, global area, volume"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let edges = Edges {
            stretching: self.stretching.modulus(),
            bending: self.bending.angles(),
        };
        let (area, volume) = edges::fold(&self.hinges, x, force, &edges);
        let tensions = Tensions {
            local: self.local.modulus(),
            global: self.global.tension(area),
            pressure: self.volume.pressure(volume),
        };
        triangles::add(x, self.local.triangles(), &tensions, force);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let laws: [&dyn Law; 5] = [&self.stretching, &self.bending, &self.local, &self.global, &self.volume];
        laws.iter().map(|law| law.energy(x)).sum()
    }
}
