//! Fluid of another viscosity inside of cells.

use super::{Fluid, Scene, Slot};
use crate::{BodyInfo, Inside, SceneError, Soa3Ref};

impl Scene {
    /// The nodes inside of cells with a viscosity of their own, as they were found for the last step.
    pub fn inside(&self) -> Option<&Inside> {
        self.fluid.as_ref().map(|f| &f.inside)
    }
}

impl Fluid {
    /// Tells the fluid which nodes are inside of cells with a viscosity of their own.
    pub(super) fn find_inside(
        &mut self,
        bodies: &[Slot],
        infos: &[BodyInfo],
        x: Soa3Ref<'_>,
    ) -> Result<(), SceneError> {
        let any = bodies.iter().any(|slot| slot.body.viscosity_ratio().is_some());
        if any || !self.inside.is_empty() {
            let pairs = bodies.iter().zip(infos);
            let cells = pairs.filter_map(|(slot, info)| Some((info, slot.body.viscosity_ratio()?)));
            self.inside.find(self.lattice.grid(), x, cells);
            self.lattice.set_inside(&self.inside)?;
        }
        Ok(())
    }
}
