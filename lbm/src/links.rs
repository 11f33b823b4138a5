//! Rows of fluid nodes, and the links by which populations pass walls and the ends of rows.
//!
//! In an odd step node `x` uses the places `(x - c_i, opposite(i))`. Where `x - c_i` is solid nobody else uses that
//! place, so it serves as a private post box (the *ghost*): what comes back from the wall waits in the node's own place
//! `i` (the *home*), which in turn nobody else uses in an odd step. Copying home to ghost after an even step and ghost to
//! home after an odd one is halfway bounce-back; a wall that slides adds `6 w_i c_i.u_wall` on the way. The ends of a
//! row that repeats are ghosts in the same way, with the home at the other end.

use crate::d3q19::{C, Q, along, opposite, weight};
use crate::mask::Mask;
use crate::storage::Storage;
use lbm_ibm_coupling::{Boundary, Grid, Vec3};
use std::ops::Range;

/// Two places of the same population.
#[derive(Clone, Copy)]
pub struct Link {
    /// Where the node finds it before an odd step, and leaves the outgoing one.
    pub ghost: usize,
    /// Where it stands before an even step.
    pub home: usize,
}

/// A row with fluid nodes: where its parts stand in the lists of [`Links`].
pub struct Row {
    pub j: usize,
    pub k: usize,
    pub runs: Range<usize>,
    pub walls: Range<usize>,
    pub wraps_out: Range<usize>,
    pub wraps_in: Range<usize>,
}

/// All rows and links, in the order of the rows.
#[derive(Default)]
pub struct Links {
    pub rows: Vec<Row>,
    /// Fluid nodes `start..end` of a row.
    pub runs: Vec<Range<usize>>,
    /// Links into walls.
    pub walls: Vec<Link>,
    /// The population that comes back from the wall.
    pub directions: Vec<u8>,
    /// What a sliding wall adds to it; empty where no wall slides.
    pub pushes: Vec<f64>,
    /// Ends of rows: homes in this row, to copy after an even step.
    pub wraps_out: Vec<Link>,
    /// Ends of rows: ghosts used by this row, to copy after an odd step.
    pub wraps_in: Vec<Link>,
}

/// What the links need to know of a sliding wall.
pub struct Sliding<'a> {
    pub walls: Option<&'a dyn Boundary>,
    pub t: f64,
    /// Lattice units of velocity, m/s.
    pub velocity_unit: f64,
}

impl Links {
    /// Finds all rows, runs and links.
    pub fn new(grid: &Grid, mask: &Mask, storage: &Storage, sliding: &Sliding) -> Self {
        let mut links = Self::default();
        let mut pushes = Vec::new();
        for k in 0..grid.shape[2] {
            for j in 0..grid.shape[1] {
                let starts = links.ends();
                links.add_runs(mask.row(j, k));
                if links.runs.len() == starts[0] {
                    continue;
                }
                for run in starts[0]..links.runs.len() {
                    for x in links.runs[run].clone() {
                        links.add_incoming([x, j, k], grid, mask, storage, sliding, &mut pushes);
                    }
                }
                links.add_outgoing(j, k, grid, mask, storage);
                let ends = links.ends();
                let range = |n: usize| starts[n]..ends[n];
                links.rows.push(Row {
                    j,
                    k,
                    runs: range(0),
                    walls: range(1),
                    wraps_out: range(2),
                    wraps_in: range(3),
                });
            }
        }
        if pushes.iter().any(|p| *p != 0.0) {
            links.pushes = pushes;
        }
        links
    }

    fn ends(&self) -> [usize; 4] {
        [
            self.runs.len(),
            self.walls.len(),
            self.wraps_out.len(),
            self.wraps_in.len(),
        ]
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

    fn add_incoming(
        &mut self,
        node: [usize; 3],
        grid: &Grid,
        mask: &Mask,
        storage: &Storage,
        sliding: &Sliding,
        pushes: &mut Vec<f64>,
    ) {
        let [x, j, k] = node.map(|i| i as isize);
        let nx = grid.shape[0] as isize;
        for i in 1..Q {
            let [cx, cy, cz] = C[i].map(|c| c as isize);
            let source = x - cx;
            let solid = mask.is_solid(source, j - cy, k - cz);
            if !solid && (0..nx).contains(&source) {
                continue;
            }
            let [sj, sk] = storage.wrapped(j - cy, k - cz);
            let ghost = storage.index(opposite(i), source, sj, sk);
            if solid {
                let home = storage.index(i, x, j, k);
                self.walls.push(Link { ghost, home });
                self.directions.push(i as u8);
                pushes.push(sliding.push(i, node, grid));
            } else {
                let home = storage.index(opposite(i), source.rem_euclid(nx), sj, sk);
                self.wraps_in.push(Link { ghost, home });
            }
        }
    }

    /// The places at the two ends of row (`j`, `k`) that nodes at the other end use in an odd step.
    fn add_outgoing(&mut self, j: usize, k: usize, grid: &Grid, mask: &Mask, storage: &Storage) {
        let (j, k, nx) = (j as isize, k as isize, grid.shape[0] as isize);
        for m in 1..Q {
            let [cx, cy, cz] = C[m].map(|c| c as isize);
            let (end, ghost) = match cx {
                1 => (0, nx),
                -1 => (nx - 1, -1),
                _ => continue,
            };
            let both_fluid = !mask.is_solid(end, j, k) && !mask.is_solid(end - cx, j - cy, k - cz);
            if both_fluid {
                let home = storage.index(m, end, j, k);
                let ghost = storage.index(m, ghost, j, k);
                self.wraps_out.push(Link { ghost, home });
            }
        }
    }
}

impl Sliding<'_> {
    /// `6 w_i c_i.u_wall`, the wall's velocity taken half way along the link.
    fn push(&self, i: usize, [x, j, k]: [usize; 3], grid: &Grid) -> f64 {
        let Some(walls) = self.walls else { return 0.0 };
        let c = Vec3::new(f64::from(C[i][0]), f64::from(C[i][1]), f64::from(C[i][2]));
        let halfway = grid.position(x, j, k) - c * (0.5 * grid.spacing);
        let velocity = walls.probe(halfway, self.t).velocity / self.velocity_unit;
        6.0 * weight(i) * along(i, velocity.into())
    }
}
