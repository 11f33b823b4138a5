//! Size against force, without a fluid.

use crate::options::{FormName, Subject};
use lbm_ibm::coupling::ImmersedBody;
use lbm_ibm::membrane::MembraneError;
use lbm_ibm::membrane::stretch::{Patch, Shape, Stretch};

/// A cell, how its membrane is computed, where it is pulled, and by which forces (N) one after the other.
#[derive(Clone, Debug)]
pub struct Pull {
    /// The cell.
    pub subject: Subject,
    /// The formulas.
    pub form: FormName,
    /// The nodes at the ends.
    pub patch: Patch,
    /// End forces in ascending order, N.
    pub forces: Vec<f64>,
}

/// What a force makes of a cell: its shape, or why none was found.
pub type Point = (f64, Result<Shape, MembraneError>);

impl Pull {
    /// The whole curve. A force without an equilibrium does not end it: the next one starts from the last shape at rest.
    pub fn curve(&self) -> Result<Vec<Point>, MembraneError> {
        let cell = self.subject.cell(self.form)?;
        let ends = self.patch.ends(cell.reference())?;
        let mut stretch = Stretch::new(cell, ends);
        let point = |&force: &f64| {
            let before = stretch.clone();
            let shape = stretch.pull(force);
            if shape.is_err() {
                stretch = before;
            }
            (force, shape)
        };
        Ok(self.forces.iter().map(point).collect())
    }
}
