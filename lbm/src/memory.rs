//! What the fluid takes in memory.

use crate::fluid::Fluid;

impl Fluid {
    /// Bytes that the fluid holds: populations with their ghosts, rows, links and the mask. What bodies need is in the bricks.
    pub fn memory(&self) -> usize {
        let notes = size_of_val(&*self.balances) + size_of_val(&*self.exchanged);
        self.storage.bytes() + self.links.bytes() + self.mask.bytes() + notes
    }
}
