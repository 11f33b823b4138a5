//! The velocity of the fluid in the bricks that bodies touch.

use crate::collide::Places;
use crate::fluid::Fluid;
use crate::simd::prefetch;
use crate::stencil::MAX_Q;
use lbm_ibm_coupling::{BRICK_EDGE, BRICK_NODES, Work};
use std::ops::Range;

/// Pieces that are asked for before one is read. Rows of bricks are short and far apart, so that the processor would not
/// fetch the next ones by itself.
const AHEAD: usize = 8;

/// The velocity of the rows in use of some slots.
pub struct ReadBricks<'a> {
    pub fluid: &'a Fluid,
    /// Brick and rows in use of each slot.
    pub slots: &'a [([usize; 3], u64)],
    /// Forces on the nodes of these slots, N.
    pub force: [&'a [f64]; 3],
    /// Velocities of the nodes of these slots, m/s.
    pub to: [&'a mut [f64]; 3],
}

/// Nodes of a run that lie in a row of a brick.
#[derive(Clone, Copy)]
struct Piece {
    run: usize,
    /// First node of the row of the grid.
    start: usize,
    len: usize,
    /// First node of the slots.
    at: usize,
}

/// The pieces of all rows in use.
struct Pieces<'a> {
    fluid: &'a Fluid,
    slots: &'a [([usize; 3], u64)],
    /// Slots that have been begun, and the rows that are left of the last of them.
    begun: usize,
    rows: u64,
    /// What is left of the row that has been begun, and its first node in the grid and in the slots.
    runs: Range<usize>,
    start: usize,
    at: usize,
}

impl<'a> Pieces<'a> {
    fn new(fluid: &'a Fluid, slots: &'a [([usize; 3], u64)]) -> Self {
        Self {
            fluid,
            slots,
            begun: 0,
            rows: 0,
            runs: 0..0,
            start: 0,
            at: 0,
        }
    }

    /// The next piece. Sets rows to zero which do not lie in one run as a whole.
    #[inline(always)]
    fn next(&mut self, to: &mut [&mut [f64]; 3]) -> Option<Piece> {
        loop {
            for run in self.runs.by_ref() {
                let all = self.fluid.links.run(run);
                let (start, end) = (all.start.max(self.start), all.end.min(self.start + BRICK_EDGE));
                if start < end {
                    return Some(Piece {
                        run,
                        start,
                        len: end - start,
                        at: self.at + start - self.start,
                    });
                }
            }
            while self.rows == 0 {
                self.rows = self.slots.get(self.begun)?.1;
                self.begun += 1;
                self.look_up();
            }
            let bit = self.rows.trailing_zeros() as usize;
            self.rows &= self.rows - 1;
            self.begin(bit, to);
        }
    }

    /// Asks for what is known of the runs of the slot that has been begun, and of the rows of the one after it.
    #[inline(always)]
    fn look_up(&self) {
        let links = &self.fluid.links;
        for row in self.rows_of(self.begun - 1) {
            let run = links.rows[row].runs().start;
            prefetch(&raw const links.runs[run]);
            if links.packed.is_none() {
                let places = links.places(run, self.fluid.odd);
                prefetch(places.as_ptr());
                prefetch(places.as_ptr().wrapping_add(places.len() - 1));
            }
        }
        if self.begun < self.slots.len() {
            for row in self.rows_of(self.begun) {
                prefetch(&raw const links.rows[row]);
            }
        }
    }

    /// Numbers of the rows of the grid that a slot uses.
    #[inline(always)]
    fn rows_of(&self, slot: usize) -> impl Iterator<Item = usize> {
        let (brick, mut left) = self.slots[slot];
        let [_, y, z] = brick.map(|b| b * BRICK_EDGE);
        let ([_, ny, nz], links) = (self.fluid.grid.shape, &self.fluid.links);
        std::iter::from_fn(move || {
            while left != 0 {
                let bit = left.trailing_zeros() as usize;
                left &= left - 1;
                let (j, k) = (y + bit % BRICK_EDGE, z + bit / BRICK_EDGE);
                let row = if j < ny && k < nz { links.row_at(j, k) } else { None };
                if row.is_some() {
                    return row;
                }
            }
            None
        })
    }

    /// Begins a row of the last slot.
    #[inline(always)]
    fn begin(&mut self, bit: usize, to: &mut [&mut [f64]; 3]) {
        let slot = self.begun - 1;
        let [x, y, z] = self.slots[slot].0.map(|b| b * BRICK_EDGE);
        let [_, ny, nz] = self.fluid.grid.shape;
        let (j, k) = (y + bit % BRICK_EDGE, z + bit / BRICK_EDGE);
        (self.start, self.at) = (x, slot * BRICK_NODES + bit * BRICK_EDGE);
        if j >= ny || k >= nz {
            return;
        }
        let links = &self.fluid.links;
        self.runs = links.row_at(j, k).map_or(0..0, |row| links.rows[row].runs());
        let whole = self.runs.len() == 1 && {
            let run = links.run(self.runs.start);
            run.start <= x && x + BRICK_EDGE <= run.end
        };
        if !whole {
            for to in to {
                to[self.at..][..BRICK_EDGE].fill(0.0);
            }
        }
    }
}

impl ReadBricks<'_> {
    /// Asks for all that is needed at a piece, and notes its places in `places` unless they have to be looked up.
    #[inline(always)]
    fn fetch(&self, piece: &Piece, places: &mut Places) {
        for a in 0..3 {
            prefetch(self.force[a][piece.at..].as_ptr());
            prefetch(self.to[a][piece.at..].as_ptr());
        }
        let Fluid { links, storage, .. } = self.fluid;
        if links.packed.is_some() && self.fluid.odd {
            return;
        }
        links.pointers(piece.run, self.fluid.odd, storage, places);
        let bytes = storage.precision().bytes();
        for place in &places[..storage.velocities().q()] {
            let (first, last) = (piece.start * bytes, (piece.start + piece.len - 1) * bytes);
            let first = place.wrapping_add(first);
            prefetch(first);
            let last = place.wrapping_add(last);
            if (first as usize ^ last as usize) & !63 != 0 {
                prefetch(last);
            }
        }
    }

    /// Reads a piece whose places have been noted.
    #[inline(always)]
    fn read(&mut self, piece: &Piece, places: &Places) {
        let fluid = self.fluid;
        let mut moments = [[0.0; BRICK_EDGE]; 4];
        let nodes = piece.start..piece.start + piece.len;
        if fluid.links.packed.is_some() && fluid.odd {
            fluid.moments(piece.run, nodes, moments.each_mut().map(|m| m.as_mut_slice()));
        } else {
            // SAFETY: the places are those of this run, of which the nodes are a part; nothing writes to the populations now,
            // and a piece is no longer than the edge of a brick.
            unsafe { fluid.read(places, nodes, moments.each_mut().map(|m| m.as_mut_ptr())) };
        }
        let (unit, scale) = (fluid.velocity_unit(), fluid.force_scale());
        for a in 0..3 {
            let force = &self.force[a][piece.at..][..piece.len];
            let to = &mut self.to[a][piece.at..][..piece.len];
            let given = fluid.force[a][0];
            let velocity = |moment: f64, force: f64| (moment + 0.5 * (force * scale + given)) * unit;
            match (
                <&mut [f64; BRICK_EDGE]>::try_from(&mut *to),
                <&[f64; BRICK_EDGE]>::try_from(force),
            ) {
                (Ok(to), Ok(force)) => {
                    for i in 0..BRICK_EDGE {
                        to[i] = velocity(moments[a + 1][i], force[i]);
                    }
                }
                _ => {
                    for ((to, force), moment) in to.iter_mut().zip(force).zip(&moments[a + 1]) {
                        *to = velocity(*moment, *force);
                    }
                }
            }
        }
    }
}

impl Work for ReadBricks<'_> {
    type Out = ();

    #[inline(always)]
    fn run(mut self) {
        let mut pieces = Pieces::new(self.fluid, self.slots);
        let mut places = [[std::ptr::null_mut(); MAX_Q]; AHEAD];
        let mut ahead = [None; AHEAD];
        for n in 0..AHEAD {
            ahead[n] = pieces.next(&mut self.to);
            if let Some(piece) = &ahead[n] {
                self.fetch(piece, &mut places[n]);
            }
        }
        let mut n = 0;
        while let Some(piece) = ahead[n] {
            self.read(&piece, &places[n]);
            ahead[n] = pieces.next(&mut self.to);
            if let Some(piece) = &ahead[n] {
                self.fetch(piece, &mut places[n]);
            }
            n = (n + 1) % AHEAD;
        }
    }
}
