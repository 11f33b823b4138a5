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
use crate::developed::Developed;
use crate::faces::Faces;
use crate::mask::Mask;
use crate::open::Openings;
use crate::rule::{CutLink, LinkRule, Shares};
use crate::stencil::{Velocities, opposite};
use crate::storage::Storage;
use crate::surface::{Between, Meeting, Surface};
use std::ops::Range;

/// A fraction this close to a half is one.
const HALF: f64 = 1e-8;

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
    /// The node, and where its link meets the wall.
    pub node: [usize; 3],
    pub fraction: f64,
}

/// A row with fluid nodes: where its parts stand in the lists of [`Links`].
pub struct Row {
    pub j: usize,
    pub k: usize,
    pub runs: Range<usize>,
    pub walls: Range<usize>,
    pub cuts: Range<usize>,
    pub wraps_out: Range<usize>,
    pub wraps_in: Range<usize>,
}

/// In place of the number of a row without fluid.
const NO_ROW: u32 = u32::MAX;

/// All rows and links, in the order of the rows.
#[derive(Default)]
pub struct Links {
    pub rows: Vec<Row>,
    /// Fluid nodes `start..end` of a row.
    pub runs: Vec<Range<usize>>,
    /// Where node 0 of the row of each run finds its populations in an even step, then in an odd one; see
    /// [`Links::places`].
    pub places: Vec<i32>,
    /// Number of each row (`j`, `k`), j fastest; [`NO_ROW`] where there is no fluid.
    pub row_at: Vec<u32>,
    /// Rows of a plane.
    ny: usize,
    /// Number of populations.
    q: usize,
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
}

/// What links are made from.
pub struct Maker<'a> {
    pub surface: Surface<'a>,
    pub mask: &'a Mask,
    pub storage: &'a Storage,
    pub rule: &'a dyn LinkRule,
    /// Relaxation time.
    pub tau: f64,
    pub faces: &'a Faces,
    /// Density, kg/m3.
    pub density: f64,
    pub mach_limit: f64,
    /// Profiles of the faces with a flux.
    pub profiles: [[Option<Developed>; 2]; 3],
    /// Both ends of the links that pass thin walls, sorted.
    pub severed: Vec<([usize; 3], usize)>,
}

impl<'a> Maker<'a> {
    /// For the walls as they stand.
    pub fn new(
        surface: Surface<'a>,
        mask: &'a Mask,
        storage: &'a Storage,
        rule: &'a dyn LinkRule,
        faces: &'a Faces,
    ) -> Self {
        Self {
            surface,
            mask,
            storage,
            rule,
            faces,
            tau: 1.0,
            density: 0.0,
            mach_limit: f64::INFINITY,
            profiles: Default::default(),
            severed: Vec::new(),
        }
    }

    /// Finds all rows, runs and links.
    pub fn links(mut self) -> Links {
        let Between { thin, closed_gaps } = self.surface.between(self.mask);
        let mut links = Links {
            closed_gaps,
            ny: self.surface.grid.shape[1],
            q: self.storage.velocities().q(),
            row_at: vec![NO_ROW; self.surface.grid.shape[1] * self.surface.grid.shape[2]],
            ..Links::default()
        };
        for &(node, i) in &thin {
            self.severed.push((node, i));
            if let Some(far) = self.surface.in_grid(node, i) {
                self.severed.push((far, opposite(i)));
            }
        }
        self.severed.sort_unstable();
        self.develop();
        let [_, ny, nz] = self.surface.grid.shape;
        for k in 0..nz {
            for j in 0..ny {
                let starts = links.ends();
                links.add_runs(self.mask.row(j, k));
                if links.runs.len() == starts[0] {
                    continue;
                }
                for run in starts[0]..links.runs.len() {
                    for x in links.runs[run].clone() {
                        self.add_incoming([x, j, k], &mut links);
                    }
                }
                self.add_outgoing(j, k, &mut links);
                self.add_places(j, k, starts[0], &mut links);
                links.row_at[k * ny + j] = links.rows.len() as u32;
                let ends = links.ends();
                let range = |n: usize| starts[n]..ends[n];
                links.rows.push(Row {
                    j,
                    k,
                    runs: range(0),
                    walls: range(1),
                    cuts: range(2),
                    wraps_out: range(3),
                    wraps_in: range(4),
                });
            }
        }
        for (node, i) in thin {
            if let Some(far) = self.surface.in_grid(node, i) {
                let sides = [self.side(node, i, &mut links), self.side(far, opposite(i), &mut links)];
                links.thin.push(sides);
            }
        }
        self.settle_fluxes(&mut links);
        if links.fractions.iter().all(|f| (f - 0.5).abs() < HALF) {
            links.fractions = Vec::new();
        }
        links.balance_pushes(self.rule.interpolates(), self.storage.velocities());
        links
    }

    /// Lattice velocity `i`.
    pub fn c(&self, i: usize) -> [isize; 3] {
        self.storage.velocities().c(i).map(|c| c as isize)
    }

    fn add_incoming(&self, node: [usize; 3], links: &mut Links) {
        let [x, j, k] = node.map(|i| i as isize);
        let nx = self.surface.grid.shape[0] as isize;
        for i in 1..self.storage.velocities().q() {
            let [cx, cy, cz] = self.c(i);
            let source = x - cx;
            let solid = self.mask.is_solid(source, j - cy, k - cz);
            if !solid && (0..nx).contains(&source) {
                continue;
            }
            let [sj, sk] = self.storage.wrapped(j - cy, k - cz);
            let ghost = self.storage.index(opposite(i), source, sj, sk);
            if solid {
                let home = self.storage.index(i, x, j, k);
                if self.add_open(node, i, Link { ghost, home }, links) {
                    links.add_wall(Link { ghost, home }, i, 0.0, self.fraction(0.5));
                    continue;
                }
                let meeting = self.meeting(node, i);
                let cut = self.cut(node, i, Link { ghost, home }, meeting, links);
                let push = cut.shares.push * meeting.push;
                links.add_wall(cut.link, i, push, self.fraction(meeting.fraction));
                if cut.shares != Shares::HALFWAY {
                    links.swell += cut.swell;
                    links.cuts.push(cut);
                }
            } else {
                let home = self.storage.index(opposite(i), source.rem_euclid(nx), sj, sk);
                links.wraps_in.push(Link { ghost, home });
            }
        }
    }

    /// A fraction, where fractions are kept.
    fn fraction(&self, fraction: f64) -> Option<f64> {
        self.rule.interpolates().then_some(fraction)
    }

    /// Places of the runs from number `first` on.
    fn add_places(&self, j: usize, k: usize, first: usize, links: &mut Links) {
        for run in first..links.runs.len() {
            let x = links.runs[run].start as isize;
            for i in 0..links.q {
                links
                    .places
                    .push((self.storage.place(i, x, j as isize, k as isize) - x) as i32);
            }
            for i in 0..links.q {
                let [cx, cy, cz] = self.c(i);
                let [sj, sk] = self.storage.wrapped(j as isize - cy, k as isize - cz);
                links
                    .places
                    .push((self.storage.place(opposite(i), x - cx, sj, sk) - x) as i32);
            }
        }
    }

    fn meeting(&self, node: [usize; 3], i: usize) -> Meeting {
        if !self.rule.interpolates() {
            return self.surface.halfway(node, i);
        }
        match self.mirrored(node, i) {
            Some(mirrored) => self.surface.mirrored_meeting(node, i, mirrored),
            None => self.surface.meeting(node, i),
        }
    }

    /// The link of `node` whose returning population is `i`.
    fn cut(&self, node: [usize; 3], i: usize, link: Link, meeting: Meeting, links: &mut Links) -> Cut {
        let [x, j, k] = node.map(|i| i as isize);
        let [cx, cy, cz] = self.c(i);
        let o = opposite(i);
        let solid = self.mask.is_solid(x + cx, j + cy, k + cz);
        let severed = self.severed.binary_search(&(node, o)).is_ok();
        // Through an open face something arrives too.
        let arrives = !solid || self.is_open(node, o);
        let velocities = self.storage.velocities();
        let shares = self.rule.shares(&CutLink {
            fraction: meeting.fraction,
            behind: arrives && !severed,
            velocity: velocities.c(i),
            weight: velocities.weight(i),
            tau: self.tau,
        });
        // The places of a thin wall behind are exchanged, perhaps before they are read.
        let shares = shares.filter(|s| !severed || *s == Shares::HALFWAY);
        links.uninterpolated += usize::from(shares.is_none());
        // Where the node behind is solid, its place is the ghost of the link on that side.
        let behind = if solid {
            x + cx
        } else {
            (x + cx).rem_euclid(self.surface.grid.shape[0] as isize)
        };
        let [bj, bk] = self.storage.wrapped(j + cy, k + cz);
        Cut {
            link,
            near: self.storage.index(o, x, j, k),
            behind: self.storage.index(i, behind, bj, bk),
            swell: meeting.swell * shares.map_or(1.0, |s| s.push),
            shares: shares.unwrap_or(Shares::HALFWAY),
            direction: i,
        }
    }

    /// The side of a thin wall on which `node` lies, population `i` returning to it.
    fn side(&self, node: [usize; 3], i: usize, links: &mut Links) -> Side {
        let [x, j, k] = node.map(|i| i as isize);
        let [cx, cy, cz] = self.c(i);
        let [sj, sk] = self.storage.wrapped(j - cy, k - cz);
        let link = Link {
            ghost: self.storage.index(opposite(i), x - cx, sj, sk),
            home: self.storage.index(i, x, j, k),
        };
        let meeting = self.meeting(node, i);
        let cut = self.cut(node, i, link, meeting, links);
        if cut.shares != Shares::HALFWAY {
            links.swell += cut.swell;
        }
        Side {
            cut,
            push: cut.shares.push * meeting.push,
            node,
            fraction: meeting.fraction,
        }
    }

    /// The places at the two ends of row (`j`, `k`) that nodes at the other end use in an odd step.
    fn add_outgoing(&self, j: usize, k: usize, links: &mut Links) {
        let (j, k, nx) = (j as isize, k as isize, self.surface.grid.shape[0] as isize);
        for m in 1..self.storage.velocities().q() {
            let [cx, cy, cz] = self.c(m);
            let (end, ghost) = match cx {
                1 => (0, nx),
                -1 => (nx - 1, -1),
                _ => continue,
            };
            let both_fluid = !self.mask.is_solid(end, j, k) && !self.mask.is_solid(end - cx, j - cy, k - cz);
            if both_fluid {
                let home = self.storage.index(m, end, j, k);
                let ghost = self.storage.index(m, ghost, j, k);
                links.wraps_out.push(Link { ghost, home });
            }
        }
    }
}

impl Links {
    /// Where node 0 of the row of a run finds its incoming populations, and leaves the outgoing ones at the opposite place:
    /// at home before an even step, in the neighbours before an odd one, there in the array of the opposite population.
    #[inline(always)]
    pub fn places(&self, run: usize, odd: bool) -> &[i32] {
        let first = (2 * run + usize::from(odd)) * self.q;
        &self.places[first..][..self.q]
    }

    /// The same as pointers.
    #[inline]
    pub fn pointers(&self, run: usize, odd: bool, storage: &Storage, to: &mut Places) {
        let (arrays, data) = (storage.arrays(), storage.data());
        let bytes = storage.precision().bytes() as isize;
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

    fn ends(&self) -> [usize; 5] {
        [
            self.runs.len(),
            self.walls.len(),
            self.cuts.len(),
            self.wraps_out.len(),
            self.wraps_in.len(),
        ]
    }

    fn add_wall(&mut self, link: Link, direction: usize, push: f64, fraction: Option<f64>) {
        self.walls.push(link);
        self.directions.push(direction as u8);
        self.pushes.push(push);
        self.fractions.extend(fraction);
    }

    fn add_runs(&mut self, solid: &[bool]) {
        let mut x = 0;
        for part in solid.chunk_by(|a, b| a == b) {
            if !part[0] {
                self.runs.push(x..x + part.len());
            }
            x += part.len();
        }
    }

    /// Takes from what moving walls add what it adds to the mass, in proportion to the weights. Halfway walls are left as
    /// they are.
    fn balance_pushes(&mut self, interpolates: bool, velocities: Velocities) {
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
