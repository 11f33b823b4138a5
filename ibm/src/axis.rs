//! One direction of the grid: where stencils begin, and where bricks and the grid end.

use crate::kernel::lower_corner;
use lbm_ibm_coupling::{BRICK_EDGE, Grid};

/// One axis of a grid as stencils see it.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    origin: f64,
    nodes: i64,
    periodic: bool,
    /// Whether either end is an open face.
    open: [bool; 2],
    /// Nodes at which a stencil may begin without going past the end of the grid, where it ends.
    starts: f64,
}

/// A run of nodes along an axis of a tile that lies in one brick.
#[derive(Clone, Copy, Default)]
pub(crate) struct Segment {
    pub brick: usize,
    pub local: usize,
    pub tile: usize,
    pub size: usize,
}

/// Most nodes of a tile along an axis, and so most segments: corners from 3 before a brick to its last node, and a stencil
/// of 6.
pub(crate) const SEGMENTS: usize = 16;
/// How far before a brick a corner may be, at a wall.
pub(crate) const BEFORE: i8 = 3;

impl Axis {
    /// The axes of a grid for stencils of `support` nodes.
    pub fn all(grid: &Grid, support: usize) -> [Self; 3] {
        [0, 1, 2].map(|a| Self {
            origin: grid.origin[a],
            nodes: grid.shape[a] as i64,
            periodic: grid.periodic[a],
            open: grid.open[a],
            starts: grid.shape[a] as f64 - if grid.periodic[a] { 0.0 } else { support as f64 - 1.0 },
        })
    }

    /// Lowest node of a stencil, a whole number, and the remainder, without regard to the ends of the grid.
    #[inline(always)]
    pub fn corner(&self, x: f64, per_spacing: f64, support: usize) -> (f64, f64) {
        let t = (x - self.origin) * per_spacing - 0.5 + (1.0 - 0.5 * support as f64);
        let lower = t.floor();
        (lower, t - lower)
    }

    /// Whether a stencil with that lowest node begins in the grid and, where the grid ends, ends in it: no case for
    /// [`Axis::home`].
    #[inline(always)]
    pub fn holds(&self, lower: f64) -> bool {
        lower >= 0.0 && lower < self.starts
    }

    /// Brick, corner in it and remainder of a coordinate (m); none outside the grid, or where the stencil reaches through an open
    /// face.
    #[inline]
    pub fn home(&self, x: f64, per_spacing: f64, support: usize) -> Option<(usize, i8, f64)> {
        let s = (x - self.origin) * per_spacing;
        let (mut lower, f) = lower_corner(s - 0.5, support);
        if self.periodic {
            if !s.is_finite() {
                return None;
            }
            if lower < 0 || lower >= self.nodes {
                lower = lower.rem_euclid(self.nodes);
            }
        } else {
            let through = (self.open[0] && lower < 0) || (self.open[1] && lower + support as i64 > self.nodes);
            if through || !(s >= 0.0 && s <= self.nodes as f64) {
                return None;
            }
        }
        let edge = BRICK_EDGE as i64;
        let brick = lower.max(0) / edge;
        Some((brick as usize, (lower - brick * edge) as i8, f))
    }

    /// Cuts `size` nodes from `corner` of `brick` on at brick and grid edges; nodes outside the grid are left out.
    pub fn segments(&self, brick: usize, corner: i8, size: usize, out: &mut [Segment; SEGMENTS]) -> usize {
        let first = (brick * BRICK_EDGE) as i64 + i64::from(corner);
        let mut count = 0;
        let mut t = 0;
        while t < size {
            let mut node = first + t as i64;
            if self.periodic {
                node = node.rem_euclid(self.nodes);
            } else if node < 0 || node >= self.nodes {
                t += 1;
                continue;
            }
            let (brick, local) = (node as usize / BRICK_EDGE, node as usize % BRICK_EDGE);
            let run = (size - t)
                .min(BRICK_EDGE - local)
                .min(self.nodes as usize - node as usize);
            out[count] = Segment {
                brick,
                local,
                tile: t,
                size: run,
            };
            count += 1;
            t += run;
        }
        count
    }
}
