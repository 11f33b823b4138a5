//! Which fluid nodes lie inside cells whose fluid is of another viscosity.

mod cast;

use crate::{BodyInfo, Grid, Soa3Ref};
use cast::Caster;

/// Steps between no part of a node's cube inside and all of it.
pub const LEVELS: u16 = 64;

/// Nodes inside of cells, by levels: 0 is outside; each of the viscosities in use has 64 levels, for the share of a
/// node's cube that is inside.
///
/// It is found anew in every step from the cells' surfaces alone, by rays along x, [`Inside::RAYS`] squared through each
/// node's cube: what a ray meets counts by its sign from there on, so that nothing has to be sorted, parts of a surface that
/// touch or cross do no harm, and coordinates are rounded to whole numbers (of 1/65536 of a spacing) so that a ray through an
/// edge or a corner is counted right.
#[derive(Clone, Debug, Default)]
pub struct Inside {
    shape: [usize; 3],
    /// Inner viscosity over that of the fluid around, of each family of levels.
    ratios: Vec<f64>,
    /// By node, x fastest; empty where no cell has a viscosity of its own.
    level: Vec<u16>,
    /// Nodes of each row (`j + ny k`) that may be inside.
    extent: Vec<[u32; 2]>,
    touched: Vec<u32>,
    caster: Caster,
}

impl Inside {
    /// Rays through a node's cube along y and along z.
    pub const RAYS: usize = 6;

    /// Nothing inside, on a grid.
    pub fn new(grid: &Grid) -> Self {
        Self {
            shape: grid.shape,
            ..Self::default()
        }
    }

    /// Whether no cell has a viscosity of its own.
    pub fn is_empty(&self) -> bool {
        self.ratios.is_empty()
    }

    /// Number of levels in use, that of the outside included.
    pub fn level_count(&self) -> usize {
        1 + self.ratios.len() * usize::from(LEVELS)
    }

    /// Viscosity of a level over that of the fluid around. Across a surface it is the mean by the shares, since the fluid on
    /// both sides is strained alike along it.
    pub fn ratio(&self, level: u16) -> f64 {
        match level.checked_sub(1) {
            None => 1.0,
            Some(n) => {
                let ratio = self.ratios[usize::from(n / LEVELS)];
                1.0 + (ratio - 1.0) * f64::from(n % LEVELS + 1) / f64::from(LEVELS)
            }
        }
    }

    /// The nodes of row (`j`, `k`) that may be inside, from the first to before the second, and their levels.
    #[inline]
    pub fn row(&self, j: usize, k: usize) -> ([usize; 2], &[u16]) {
        let [nx, ny, _] = self.shape;
        let row = j + ny * k;
        let Some(&extent) = self.extent.get(row) else {
            return ([0; 2], &[]);
        };
        let [from, to] = extent.map(|x| x as usize);
        (extent.map(|x| x as usize), &self.level[row * nx..][from..to])
    }

    /// Inner volume in cubes of nodes, by the levels.
    pub fn volume(&self) -> f64 {
        let share = |&l: &u16| f64::from((l + LEVELS - 1) % LEVELS + 1) / f64::from(LEVELS);
        self.level.iter().filter(|l| **l > 0).map(share).sum()
    }

    /// Makes this a copy of another, in the same memory.
    pub fn copy_from(&mut self, other: &Self) {
        self.shape = other.shape;
        self.ratios.clone_from(&other.ratios);
        self.level.clone_from(&other.level);
        self.extent.clone_from(&other.extent);
    }

    /// Finds the nodes inside the bodies that have a viscosity of their own, `ratio` times that of the fluid around, at node
    /// positions `x` (m) of all bodies. Nodes in two bodies belong to the one that has more of them.
    pub fn find<'a>(&mut self, grid: &Grid, x: Soa3Ref<'_>, bodies: impl Iterator<Item = (&'a BodyInfo, f64)>) {
        self.clear(grid);
        for (body, ratio) in bodies {
            let family = match self.ratios.iter().position(|r| *r == ratio) {
                Some(family) => family,
                None => {
                    self.ratios.push(ratio);
                    self.ratios.len() - 1
                }
            };
            if self.level.is_empty() {
                self.level.resize(grid.len(), 0);
                self.extent.resize(grid.shape[1] * grid.shape[2], [0; 2]);
            }
            let mut caster = std::mem::take(&mut self.caster);
            caster.cast(grid, x, &body.triangles, body.range.start, Self::RAYS);
            self.take(grid, &caster, family);
            self.caster = caster;
        }
    }

    fn clear(&mut self, grid: &Grid) {
        let nx = self.shape[0];
        if self.shape != grid.shape {
            *self = Self::new(grid);
        }
        for row in self.touched.drain(..) {
            let [from, to] = self.extent[row as usize].map(|x| x as usize);
            self.level[row as usize * nx..][from..to].fill(0);
            self.extent[row as usize] = [0; 2];
        }
    }

    /// Takes over what the rays have found of one body.
    fn take(&mut self, grid: &Grid, caster: &Caster, family: usize) {
        let [nx, ny, _] = self.shape;
        let first = family as u16 * LEVELS;
        caster.for_each(|node, share| {
            let steps = (share * f64::from(LEVELS)).round().clamp(0.0, f64::from(LEVELS)) as u16;
            let Some([i, j, k]) = grid.home(node).filter(|_| steps > 0) else {
                return;
            };
            let row = j + ny * k;
            let level = &mut self.level[row * nx + i];
            if *level == 0 || (*level - 1) % LEVELS + 1 < steps {
                *level = first + steps;
            }
            let extent = &mut self.extent[row];
            if extent[1] == 0 {
                *extent = [i as u32, i as u32 + 1];
                self.touched.push(row as u32);
            } else {
                *extent = [extent[0].min(i as u32), extent[1].max(i as u32 + 1)];
            }
        });
    }
}

#[cfg(test)]
mod tests;
