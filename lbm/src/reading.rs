//! The velocity of the fluid in the bricks that bodies touch.

use crate::fluid::Fluid;
use crate::simd::prefetch;
use crate::stencil::MAX_Q;
use lbm_ibm_coupling::{BRICK_EDGE, Work};
use std::ops::Range;

/// The velocity of the rows of a brick that are in use.
pub struct ReadBrick<'a> {
    pub fluid: &'a Fluid,
    pub brick: [usize; 3],
    pub rows: u64,
    /// Forces on the nodes of the brick, N.
    pub force: [&'a [f64]; 3],
    /// Velocities of the nodes of the brick, m/s.
    pub to: [&'a mut [f64]; 3],
}

impl ReadBrick<'_> {
    /// Runs of the row of the grid that a row of the brick is.
    #[inline(always)]
    fn runs(&self, bit: usize) -> Range<usize> {
        let [_, y, z] = self.brick.map(|b| b * BRICK_EDGE);
        let links = &self.fluid.links;
        links
            .row_at(y + bit % BRICK_EDGE, z + bit / BRICK_EDGE)
            .map_or(0..0, |row| links.rows[row].runs.clone())
    }

    /// The next row that is in use and in the grid.
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let [_, ny, nz] = self.fluid.grid.shape;
        let [_, y, z] = self.brick.map(|b| b * BRICK_EDGE);
        while self.rows != 0 {
            let bit = self.rows.trailing_zeros() as usize;
            self.rows &= self.rows - 1;
            if y + bit % BRICK_EDGE < ny && z + bit / BRICK_EDGE < nz {
                return Some(bit);
            }
        }
        None
    }

    /// Asks for the populations of a row.
    #[inline(always)]
    fn fetch(&self, bit: usize, nodes: &Range<usize>) {
        let Fluid { links, storage, .. } = self.fluid;
        if links.packed.is_some() && self.fluid.odd {
            return;
        }
        let mut places = [std::ptr::null_mut(); MAX_Q];
        for run in self.runs(bit) {
            let part = links.runs[run].start.max(nodes.start)..links.runs[run].end.min(nodes.end);
            if part.is_empty() {
                continue;
            }
            links.pointers(run, self.fluid.odd, storage, &mut places);
            let bytes = storage.precision().bytes();
            for place in &places[..storage.velocities().q()] {
                prefetch(place.wrapping_add(part.start * bytes));
                prefetch(place.wrapping_add((part.end - 1) * bytes));
            }
        }
    }
}

impl Work for ReadBrick<'_> {
    type Out = ();

    #[inline(always)]
    fn run(mut self) {
        let fluid = self.fluid;
        let x = self.brick[0] * BRICK_EDGE;
        let nodes = x..(x + BRICK_EDGE).min(fluid.grid.shape[0]);
        let (unit, scale) = (fluid.velocity_unit(), fluid.force_scale());
        let mut moments = [[0.0; BRICK_EDGE]; 4];
        let mut ahead = [self.next(), self.next()];
        while let Some(bit) = ahead[0] {
            // Rows are short and far apart, so that the processor would not fetch the next ones by itself.
            ahead = [ahead[1], self.next()];
            if let Some(bit) = ahead[1] {
                self.fetch(bit, &nodes);
            }
            let at = bit * BRICK_EDGE;
            for to in &mut self.to {
                to[at..at + BRICK_EDGE].fill(0.0);
            }
            for run in self.runs(bit) {
                let all = &fluid.links.runs[run];
                let part = all.start.max(nodes.start)..all.end.min(nodes.end);
                if part.is_empty() {
                    continue;
                }
                let (at, len) = (at + part.start - x, part.len());
                fluid.moments(run, part, moments.each_mut().map(|m| m.as_mut_slice()));
                for a in 0..3 {
                    let force = &self.force[a][at..at + len];
                    let to = &mut self.to[a][at..at + len];
                    for ((to, force), moment) in to.iter_mut().zip(force).zip(&moments[a + 1]) {
                        *to = (moment + 0.5 * (force * scale + fluid.force[a][0])) * unit;
                    }
                }
            }
        }
    }
}
