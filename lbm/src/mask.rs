//! Which nodes are solid, and how wide the gaps between walls are.

use crate::bits::Bits;
use crate::parallel;
use lbm_ibm_coupling::{Boundary, FluidError, Grid, Vec3};
use std::ops::Range;

/// Fewest fluid nodes across a gap that carry a flow.
const NEEDED: usize = 2;
/// Least cosine between an axis and the normals of two walls that face each other across it.
pub const FACING: f64 = 0.8;

/// What becomes of gaps with fewer nodes than [`NEEDED`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NarrowGaps {
    /// They are an error.
    #[default]
    Refused,
    /// Their nodes are solid.
    Filled,
    /// They are left as they are.
    Kept,
}

/// Solid flags of the grid and of one ghost node around it.
pub struct Mask {
    shape: [usize; 3],
    solid: Bits,
    /// Nodes of the grid within a link's length of a wall.
    close: Bits,
    /// Which faces of the grid are walls: low and high end of each axis.
    pub walled: [[bool; 2]; 3],
    /// Number of nodes in the fluid.
    pub fluid_nodes: usize,
}

impl Mask {
    /// A node is solid where the boundary's distance is not positive; beyond a face that is not periodic all is solid.
    pub fn new(grid: &Grid, walls: Option<&dyn Boundary>, t: f64) -> Result<Self, FluidError> {
        let [nx, ny, nz] = grid.shape;
        let rows: Vec<usize> = (0..ny * nz).collect();
        let reach = std::f64::consts::SQRT_2 * grid.spacing;
        let near: Vec<Vec<[bool; 2]>> = parallel::map(&rows, |&row| {
            let look = |i| {
                walls.map_or([false; 2], |w| {
                    let distance = w.probe(grid.position(i, row % ny, row / ny), t).distance;
                    [distance <= 0.0, distance.abs() < reach]
                })
            };
            (0..nx).map(look).collect()
        });
        let solid_nodes = near.iter().flatten().filter(|[solid, _]| *solid).count();
        if solid_nodes == grid.len() {
            return Err(FluidError::NoFluid { nodes: grid.len() });
        }
        let mut mask = Self {
            shape: grid.shape,
            solid: Bits::new((nx + 2) * (ny + 2) * (nz + 2), true),
            walled: [[true; 2]; 3],
            close: Bits::new(grid.len(), false),
            fluid_nodes: grid.len() - solid_nodes,
        };
        for (n, [_, close]) in near.iter().flatten().enumerate() {
            mask.close.put(n, *close);
        }
        let home = |i: isize, a: usize| {
            let n = grid.shape[a] as isize;
            let inside = grid.periodic[a] || (0..n).contains(&i);
            inside.then(|| i.rem_euclid(n) as usize)
        };
        for k in -1..=nz as isize {
            for j in -1..=ny as isize {
                let (Some(y), Some(z)) = (home(j, 1), home(k, 2)) else {
                    continue;
                };
                for i in -1..=nx as isize {
                    let index = mask.index(i, j, k);
                    mask.solid.put(index, home(i, 0).is_none_or(|x| near[z * ny + y][x][0]));
                }
            }
        }
        Ok(mask)
    }

    /// Faces that are not walls bound no gap.
    pub fn with_walled(mut self, walled: [[bool; 2]; 3]) -> Self {
        self.walled = walled;
        self
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.solid.bytes() + self.close.bytes()
    }

    /// Pairs of a fluid node and a solid one beside it along an axis.
    pub fn wall_faces(&self) -> usize {
        let shape = self.shape.map(|n| n as isize);
        let mut faces = 0;
        for k in 0..shape[2] {
            for j in 0..shape[1] {
                for i in 0..shape[0] {
                    let node = [i, j, k];
                    let solid = self.is_solid(i, j, k);
                    for a in 0..3 {
                        let mut beside = node;
                        beside[a] += 1;
                        faces += usize::from(self.is_solid(beside[0], beside[1], beside[2]) != solid);
                        // The other faces of the grid.
                        if node[a] == 0 {
                            beside[a] = -1;
                            faces += usize::from(self.is_solid(beside[0], beside[1], beside[2]) != solid);
                        }
                    }
                }
            }
        }
        faces
    }

    fn index(&self, i: isize, j: isize, k: isize) -> usize {
        let [nx, ny, _] = self.shape;
        ((k + 1) as usize * (ny + 2) + (j + 1) as usize) * (nx + 2) + (i + 1) as usize
    }

    /// Whether node (`i`, `j`, `k`), each from -1 to the number of nodes, is solid.
    pub fn is_solid(&self, i: isize, j: isize, k: isize) -> bool {
        self.solid.get(self.index(i, j, k))
    }

    /// The same of a node of the grid.
    pub fn is_solid_at(&self, [i, j, k]: [usize; 3]) -> bool {
        self.is_solid(i as isize, j as isize, k as isize)
    }

    /// Runs of fluid nodes of row (`j`, `k`).
    pub fn fluid_runs(&self, j: usize, k: usize) -> impl Iterator<Item = Range<usize>> {
        let (nx, first) = (self.shape[0], self.index(0, j as isize, k as isize));
        let next = move |x: usize, solid: bool| (x..nx).find(|x| self.solid.get(first + x) == solid).unwrap_or(nx);
        let mut end = 0;
        std::iter::from_fn(move || {
            let start = next(end, false);
            end = next(start, true);
            (start < nx).then_some(start..end)
        })
    }

    /// Whether a node of the grid is within a link's length of a wall.
    pub fn is_close(&self, [i, j, k]: [usize; 3]) -> bool {
        self.close.get((k * self.shape[1] + j) * self.shape[0] + i)
    }

    /// The narrowest gap: its number of fluid nodes and its axis.
    ///
    /// A gap is a run of fluid nodes along an axis between two walls that face each other: at the solid node at either
    /// end the wall's normal lies within 37 degrees of the axis. So a run that is short only because it grazes a curved
    /// wall does not count. A gap of a single node is an error, unless such gaps are kept.
    pub fn narrowest(
        &self,
        grid: &Grid,
        walls: Option<&dyn Boundary>,
        t: f64,
        narrow: NarrowGaps,
    ) -> Result<Option<(usize, usize)>, FluidError> {
        let mut narrowest: Option<(usize, usize)> = None;
        let mut fault = None;
        self.for_each_run(grid, walls, t, |line, start, len| {
            if fault.is_some() || narrowest.is_some_and(|(n, _)| len >= n) {
                return;
            }
            let Some(width) = line.gap(start, len) else { return };
            if len < NEEDED && narrow != NarrowGaps::Kept {
                fault = Some(FluidError::NarrowGap {
                    node: line.at(start).map(|i| i as usize),
                    cells: len,
                    needed: NEEDED,
                    axis: ['x', 'y', 'z'][line.axis],
                    spacing: width / NEEDED as f64,
                });
            }
            narrowest = Some((len, line.axis));
        });
        fault.map_or(Ok(narrowest), Err)
    }

    /// Makes the nodes of gaps too narrow to carry a flow solid, until there is none; returns their number. What flow goes
    /// through such a gap is lost: between two spheres in contact it is next to nothing.
    ///
    /// # Errors
    /// [`FluidError::NoFluid`].
    pub fn fill_narrow(&mut self, grid: &Grid, walls: Option<&dyn Boundary>, t: f64) -> Result<usize, FluidError> {
        let before = self.fluid_nodes;
        loop {
            let mut narrow = Vec::new();
            self.for_each_run(grid, walls, t, |line, start, len| {
                if len < NEEDED && line.gap(start, len).is_some() {
                    narrow.extend((start..start + len).map(|s| line.at(s)));
                }
            });
            if narrow.is_empty() {
                return Ok(before - self.fluid_nodes);
            }
            for [i, j, k] in narrow {
                if !self.is_solid(i, j, k) {
                    self.fluid_nodes -= 1;
                    self.make_solid(grid, [i, j, k]);
                }
            }
            if self.fluid_nodes == 0 {
                return Err(FluidError::NoFluid { nodes: grid.len() });
            }
        }
    }

    /// Makes a node and its images among the ghosts solid.
    fn make_solid(&mut self, grid: &Grid, node: [isize; 3]) {
        let images = |a: usize| {
            let (n, i) = (grid.shape[a] as isize, node[a]);
            let wrapped = [i - n, i, i + n].into_iter();
            wrapped.filter(move |s| *s == i || (grid.periodic[a] && (-1..=n).contains(s)))
        };
        for k in images(2) {
            for j in images(1) {
                for i in images(0) {
                    let index = self.index(i, j, k);
                    self.solid.put(index, true);
                }
            }
        }
    }

    /// Calls `run(line, start, length)` for every run of fluid nodes along every axis.
    fn for_each_run(
        &self,
        grid: &Grid,
        walls: Option<&dyn Boundary>,
        t: f64,
        mut run: impl FnMut(&Line<'_>, usize, usize),
    ) {
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            for v in 0..grid.shape[c] {
                for u in 0..grid.shape[b] {
                    let mut node = [0; 3];
                    (node[b], node[c]) = (u as isize, v as isize);
                    let line = Line {
                        grid,
                        walls,
                        t,
                        axis,
                        node,
                        walled: self.walled[axis],
                    };
                    for [start, len] in self.runs(&line) {
                        run(&line, start, len);
                    }
                }
            }
        }
    }

    /// Start and length of the fluid runs of a line that end at solids; a run may pass through a periodic end.
    fn runs(&self, line: &Line) -> Vec<[usize; 2]> {
        let n = line.grid.shape[line.axis];
        let solid = |s: usize| {
            let mut at = line.node;
            at[line.axis] = (s % n) as isize;
            self.is_solid(at[0], at[1], at[2])
        };
        let (from, to) = if line.grid.periodic[line.axis] {
            match (0..n).find(|&s| solid(s)) {
                Some(first) => (first, first + n),
                None => return Vec::new(),
            }
        } else {
            (0, n)
        };
        let mut runs: Vec<[usize; 2]> = Vec::new();
        let mut start = None;
        for s in from..=to {
            match (start, s == to || solid(s)) {
                (None, false) => start = Some(s),
                (Some(first), true) => {
                    runs.push([first, s - first]);
                    start = None;
                }
                _ => {}
            }
        }
        runs
    }
}

/// A line of nodes along an axis.
struct Line<'a> {
    grid: &'a Grid,
    walls: Option<&'a dyn Boundary>,
    t: f64,
    axis: usize,
    node: [isize; 3],
    /// Whether the faces at its ends are walls.
    walled: [bool; 2],
}

impl Line<'_> {
    /// The node `s` places along the line.
    fn at(&self, s: usize) -> [isize; 3] {
        let mut node = self.node;
        node[self.axis] = (s % self.grid.shape[self.axis]) as isize;
        node
    }

    /// Width (m) of the gap of `len` nodes from `start` on, if the walls at its ends face each other.
    fn gap(&self, start: usize, len: usize) -> Option<f64> {
        let low = self.depth(start as isize - 1, 1.0)?;
        let high = self.depth((start + len) as isize, -1.0)?;
        Some((len as f64 + 1.0) * self.grid.spacing - low - high)
    }

    /// How deep (m) the solid node `s` lies behind its wall, if the wall's normal points along `side`.
    fn depth(&self, s: isize, side: f64) -> Option<f64> {
        let n = self.grid.shape[self.axis] as isize;
        if !self.grid.periodic[self.axis] && !(0..n).contains(&s) {
            return self.walled[usize::from(s >= n)].then_some(0.5 * self.grid.spacing);
        }
        let mut at = self.node;
        at[self.axis] = s.rem_euclid(n);
        let [i, j, k] = at.map(|i| i as usize);
        let probe = self.walls?.probe(self.grid.position(i, j, k), self.t);
        let normal: Vec3 = probe.normal;
        (normal[self.axis] * side > FACING).then_some(-probe.distance)
    }
}
