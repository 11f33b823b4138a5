//! The regular grid of a fluid, and the box it fills.

use crate::Vec3;

/// A regular grid of cubic cells, fluid nodes at the cell centres.
///
/// Node `(i, j, k)` is at `origin + (i + 1/2, j + 1/2, k + 1/2) spacing`. A face of the box that is not periodic is a
/// no-slip wall, half a spacing from the outermost nodes, unless the fluid has opened it.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Nodes in x, y, z.
    pub shape: [usize; 3],
    /// Node spacing, m.
    pub spacing: f64,
    /// Lower corner of the box, m.
    pub origin: Vec3,
    /// Directions that repeat.
    pub periodic: [bool; 3],
    /// Low and high face of each direction that are no wall: fluid passes, or slips along. Kernels may not reach beyond them,
    /// where no velocity is known.
    pub open: [[bool; 2]; 3],
}

impl Grid {
    /// A grid with its lower corner at zero, its faces periodic or walls.
    pub fn new(shape: [usize; 3], spacing: f64, periodic: [bool; 3]) -> Self {
        Self {
            shape,
            spacing,
            origin: Vec3::zeros(),
            periodic,
            open: [[false; 2]; 3],
        }
    }

    /// The same grid with its lower corner at `origin`, m.
    pub fn with_origin(mut self, origin: Vec3) -> Self {
        self.origin = origin;
        self
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Position of node `(i, j, k)`, m.
    pub fn position(&self, i: usize, j: usize, k: usize) -> Vec3 {
        self.origin + Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * self.spacing
    }

    /// The node of the grid that a node counted on beyond its faces is; none beyond a face that is not periodic.
    pub fn home(&self, node: [i64; 3]) -> Option<[usize; 3]> {
        let mut home = [0; 3];
        for a in 0..3 {
            let n = self.shape[a] as i64;
            if !self.periodic[a] && !(0..n).contains(&node[a]) {
                return None;
            }
            home[a] = node[a].rem_euclid(n) as usize;
        }
        Some(home)
    }

    /// The box that the grid fills.
    pub fn domain(&self) -> Domain {
        let [nx, ny, nz] = self.shape;
        Domain {
            origin: self.origin,
            size: Vec3::new(nx as f64, ny as f64, nz as f64) * self.spacing,
            periodic: self.periodic,
        }
    }
}

/// A box, periodic or not in each direction. Node positions are kept unwrapped; [`Domain::wrap`] brings them home.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner, m.
    pub origin: Vec3,
    /// Edge lengths, m.
    pub size: Vec3,
    /// Directions that repeat.
    pub periodic: [bool; 3],
}

impl Domain {
    /// All of space: no period.
    pub fn unbounded() -> Self {
        Self {
            origin: Vec3::zeros(),
            size: Vec3::repeat(f64::INFINITY),
            periodic: [false; 3],
        }
    }

    /// The periodic image of `x` inside the box, m.
    #[inline]
    pub fn wrap(&self, mut x: Vec3) -> Vec3 {
        for a in 0..3 {
            if self.periodic[a] {
                let s = (x[a] - self.origin[a]) / self.size[a];
                x[a] -= s.floor() * self.size[a];
            }
        }
        x
    }

    /// The shortest periodic image of a difference of positions, m.
    #[inline]
    pub fn shortest(&self, mut d: Vec3) -> Vec3 {
        for a in 0..3 {
            if self.periodic[a] {
                d[a] -= (d[a] / self.size[a]).round() * self.size[a];
            }
        }
        d
    }
}
