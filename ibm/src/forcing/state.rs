//! What the forcing remembers from step to step.

use super::Forcing;
use lbm_ibm_coupling::{StateError, StateReader, StateWriter};

impl Forcing {
    /// Writes the marker forces from which the next step starts, and how the last one ended.
    pub fn save(&self, to: &mut StateWriter) {
        to.count(self.state.marker.len() as u64);
        self.state.marker.iter().for_each(|f| to.vector(*f));
        to.number(self.slip);
        to.count(self.iterations as u64);
    }

    /// Takes what [`Forcing::save`] has written.
    pub fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        from.same("the number of markers of rigid bodies", self.state.marker.len() as u64)?;
        for force in &mut self.state.marker {
            *force = from.vector()?;
        }
        self.slip = from.number()?;
        self.iterations = from.count()? as usize;
        Ok(())
    }
}
