//! Rows of fluid nodes, and the links by which populations pass walls and the ends of rows.
//!
//! In an odd step node `x` uses the places `(x - c_i, opposite(i))`. Where `x - c_i` is solid nobody else uses that
//! place, so it serves as a private post box (the *ghost*): what comes back from the wall waits in the node's own place
//! `i` (the *home*), which in turn nobody else uses in an odd step. Copying home to ghost after an even step and ghost to
//! home after an odd one is halfway bounce-back; a wall that slides adds `6 w_i c_i.u_wall` on the way. The ends of a
//! row that repeats are ghosts in the same way, with the home at the other end.
//!
//! A wall between two fluid nodes `x` and `z = x - c_i` parts the two places `(x, i)` and `(z, opposite(i))` that they
//! would share: exchanging what is in them is halfway bounce-back on both sides. Such links, and what interpolation adds
//! to the others, come after all rows have collided; see [`crate::interpolate`].

use crate::collide::Places;
use crate::marks::Marks;
use crate::open::Openings;
use crate::packed::Packed;
use crate::rule::Shares;
use crate::stencil::Velocities;
use crate::storage::Storage;
use std::ops::Range;

/// Two places of the same population.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// Where the node finds it before an odd step, and leaves the outgoing one.
    pub ghost: usize,
    /// Where it stands before an even step.
    pub home: usize,
}

/// What interpolation adds to a link.
#[derive(Clone, Copy)]
pub struct Cut {
    /// The link.
    pub link: Link,
    /// The node's own place of the outgoing population, and that of the returning one at the node behind. After an even
    /// step the first holds what leaves the wall and the second what arrives from behind, after an odd one the reverse.
    pub near: usize,
    pub behind: usize,
    pub shares: Shares,
    /// What a wall that swells by one lattice unit of velocity would add.
    pub swell: f64,
    /// The population that comes back from the wall.
    pub direction: usize,
}

/// One side of a wall between two fluid nodes. The ghost of its link is another place than the home of the other side
/// only across the ends of a row.
#[derive(Clone, Copy)]
pub struct Side {
    pub cut: Cut,
    /// What a sliding wall adds.
    pub push: f64,
    /// The share of what goes out that passes the rim of the wall, the same on both sides.
    pub through: f64,
    /// The node, and where its link meets the wall.
    pub node: [usize; 3],
    pub fraction: f64,
}

/// A row with fluid nodes. Neither nodes nor runs are more than numbers of 32 bits count ([`Storage::fits`]).
pub struct Row {
    at: [u32; 2],
    runs: [u32; 2],
}

impl Row {
    /// Row (`j`, `k`), and where its runs stand in the list of [`Links`].
    pub fn new(at: [usize; 2], runs: Range<usize>) -> Self {
        Self {
            at: at.map(|n| n as u32),
            runs: [runs.start as u32, runs.end as u32],
        }
    }

    /// Its place along y and z.
    #[inline(always)]
    pub fn at(&self) -> [usize; 2] {
        self.at.map(|n| n as usize)
    }

    /// Its runs.
    #[inline(always)]
    pub fn runs(&self) -> Range<usize> {
        self.runs[0] as usize..self.runs[1] as usize
    }
}

/// Where the links of a row stand in the lists of [`Links`].
#[derive(Clone)]
pub struct RowLinks {
    pub walls: Range<usize>,
    pub cuts: Range<usize>,
    pub wraps_out: Range<usize>,
    pub wraps_in: Range<usize>,
}

/// In place of the number of a row without fluid.
pub const NO_ROW: u32 = u32::MAX;

/// All rows and links, in the order of the rows.
#[derive(Default)]
pub struct Links {
    pub rows: Vec<Row>,
    /// The links of each row; empty where nodes are packed.
    pub row_links: Vec<RowLinks>,
    /// Fluid nodes `start..end` of a row.
    pub runs: Vec<[u32; 2]>,
    /// Where node 0 of the row of each run finds its populations in an even step, then in an odd one; see
    /// [`Links::places`].
    pub places: Vec<i32>,
    /// Number of each row (`j`, `k`), j fastest; [`NO_ROW`] where there is no fluid.
    pub row_at: Vec<u32>,
    /// Rows of a plane.
    pub ny: usize,
    /// Number of populations.
    pub q: usize,
    /// Links into walls.
    pub walls: Vec<Link>,
    /// The population that comes back from the wall.
    pub directions: Vec<u8>,
    /// What a sliding wall adds to it; empty where no wall slides.
    pub pushes: Vec<f64>,
    /// Where the link meets the wall, as a fraction of its length; empty where all do half way.
    pub fractions: Vec<f64>,
    /// Links that are interpolated.
    pub cuts: Vec<Cut>,
    /// Both sides of walls between fluid nodes.
    pub thin: Vec<[Side; 2]>,
    /// What all interpolated links would add to the mass if the walls swelled by one lattice unit of velocity.
    pub swell: f64,
    /// Ends of rows: homes in this row, to copy after an even step.
    pub wraps_out: Vec<Link>,
    /// Ends of rows: ghosts used by this row, to copy after an odd step.
    pub wraps_in: Vec<Link>,
    /// Links through open faces; each is among those into walls too.
    pub openings: Openings,
    /// Links that are halfway for want of a node behind.
    pub uninterpolated: usize,
    /// Gaps without a node.
    pub closed_gaps: usize,
    /// Places and links of packed nodes, which have none of `places`, `walls`, `cuts` and wraps.
    pub packed: Option<Packed>,
    /// What is added to the links of packed nodes.
    pub marks: Marks,
}

impl Links {
    /// Fluid nodes of a run, counted along its row.
    #[inline(always)]
    pub fn run(&self, run: usize) -> Range<usize> {
        let [start, end] = self.runs[run];
        start as usize..end as usize
    }

    /// Fluid nodes of a row.
    pub fn nodes(&self, row: &Row) -> impl Iterator<Item = usize> + use<'_> {
        row.runs().flat_map(|run| self.run(run))
    }

    /// Where node 0 of the row of a run finds its incoming populations, and leaves the outgoing ones at the opposite place:
    /// at home before an even step, in the neighbours before an odd one, there in the array of the opposite population.
    #[inline(always)]
    pub fn places(&self, run: usize, odd: bool) -> &[i32] {
        let first = (2 * run + usize::from(odd)) * self.q;
        &self.places[first..][..self.q]
    }

    /// The same as pointers; of packed nodes those before an even step.
    #[inline]
    pub fn pointers(&self, run: usize, odd: bool, storage: &Storage, to: &mut Places) {
        let (arrays, data) = (storage.arrays(), storage.data());
        let bytes = storage.precision().bytes() as isize;
        if let Some(packed) = &self.packed {
            let shift = packed.starts[run] as isize - self.runs[run][0] as isize;
            *to = packed.own(storage, 0).map(|p| p.wrapping_offset(shift * bytes));
            return;
        }
        let turned = usize::from(odd);
        for (i, place) in self.places(run, odd).iter().enumerate() {
            // The opposite population is the neighbour in its pair.
            let array = if i == 0 { 0 } else { ((i - 1) ^ turned) + 1 };
            to[i] = data.wrapping_offset((arrays[array] as isize + *place as isize) * bytes);
        }
    }

    /// Number of row (`j`, `k`), if it has fluid.
    #[inline(always)]
    pub fn row_at(&self, j: usize, k: usize) -> Option<usize> {
        let row = self.row_at.get(k * self.ny + j).copied().unwrap_or(NO_ROW);
        (row != NO_ROW).then_some(row as usize)
    }

    /// Links into walls and through open faces.
    pub fn wall_links(&self) -> usize {
        self.packed.as_ref().map_or(self.walls.len(), |p| p.links)
    }

    /// What balances are summed over in a step: rows, or batches of packed nodes.
    pub fn pieces(&self) -> usize {
        self.packed.as_ref().map_or(self.rows.len(), Packed::batches)
    }

    /// Lengths of the lists of runs, walls, cuts and wraps.
    pub(crate) fn ends(&self) -> [usize; 5] {
        [
            self.runs.len(),
            self.walls.len(),
            self.cuts.len(),
            self.wraps_out.len(),
            self.wraps_in.len(),
        ]
    }

    pub(crate) fn add_wall(&mut self, link: Link, direction: usize, push: f64, fraction: Option<f64>) {
        self.walls.push(link);
        self.directions.push(direction as u8);
        self.pushes.push(push);
        self.fractions.extend(fraction);
    }

    pub(crate) fn add_runs(&mut self, runs: impl Iterator<Item = Range<usize>>) {
        self.runs.extend(runs.map(|run| [run.start as u32, run.end as u32]));
    }

    /// Takes from what moving walls add what it adds to the mass, in proportion to the weights. Halfway walls are left as
    /// they are.
    pub(crate) fn balance_pushes(&mut self, interpolates: bool, velocities: Velocities) {
        let sides = || self.thin.iter().flatten();
        let all: f64 = self.pushes.iter().sum::<f64>() + sides().map(|s| s.push).sum::<f64>();
        if self.pushes.iter().all(|p| *p == 0.0) && sides().all(|s| s.push == 0.0) {
            self.pushes.clear();
        } else if interpolates {
            let directions = self.directions.iter().map(|d| usize::from(*d));
            let weights = directions
                .chain(sides().map(|s| s.cut.direction))
                .map(|i| velocities.weight(i));
            let share = all / weights.sum::<f64>();
            for (push, direction) in self.pushes.iter_mut().zip(&self.directions) {
                *push -= share * velocities.weight(usize::from(*direction));
            }
            for side in self.thin.iter_mut().flatten() {
                side.push -= share * velocities.weight(side.cut.direction);
            }
        }
    }
}
