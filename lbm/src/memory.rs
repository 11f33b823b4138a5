//! What the fluid takes in memory.

use crate::fluid::Fluid;
use crate::links::Links;
use crate::packed::Packed;

impl Fluid {
    /// Bytes that the fluid holds: populations with their ghosts, rows, links and the mask. What bodies need is in the bricks.
    pub fn memory(&self) -> usize {
        let notes = size_of_val(&*self.balances) + size_of_val(&*self.exchanged) + size_of_val(&*self.more);
        self.storage.bytes() + self.links.bytes() + self.mask.bytes() + notes
    }
}

impl Links {
    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        let links = [&self.walls, &self.wraps_out, &self.wraps_in].map(|l| size_of_val(&**l));
        links.iter().sum::<usize>()
            + size_of_val(&*self.rows)
            + size_of_val(&*self.row_links)
            + size_of_val(&*self.runs)
            + size_of_val(&*self.places)
            + size_of_val(&*self.row_at)
            + size_of_val(&*self.directions)
            + size_of_val(&*self.pushes)
            + size_of_val(&*self.fractions)
            + size_of_val(&*self.cuts)
            + size_of_val(&*self.thin)
            + self.openings.bytes()
            + self.marks.bytes()
            + self.packed.as_ref().map_or(0, Packed::bytes)
    }
}
