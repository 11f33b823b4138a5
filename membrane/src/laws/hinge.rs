//! The angle between two triangles that share an edge.

use crate::mesh::Edge;
use lbm_ibm_coupling::{Soa3Ref, Vec3};
use std::f64::consts::PI;

/// A hinge: the edge `a`, `b` between the outward triangles `(a, b, c)` and `(b, a, d)`.
pub(super) struct Hinge {
    /// From `a` to `b`, m.
    pub edge: Vec3,
    /// Twice the area vector of `(a, b, c)`, m2.
    pub first: Vec3,
    /// Twice the area vector of `(b, a, d)`, m2.
    pub second: Vec3,
}

/// Node numbers `[a, b, c, d]` of the hinge at an edge.
pub(super) fn nodes(e: &Edge) -> [u32; 4] {
    [e.nodes[0], e.nodes[1], e.opposite[0], e.opposite[1]]
}

impl Hinge {
    #[inline]
    pub fn at(x: Soa3Ref<'_>, nodes: [u32; 4]) -> Self {
        let [a, b, c, d] = nodes;
        let (a, b, c, d) = (
            x.get(a as usize),
            x.get(b as usize),
            x.get(c as usize),
            x.get(d as usize),
        );
        let edge = b - a;
        Self {
            edge,
            first: edge.cross(&(c - a)),
            second: (d - a).cross(&edge),
        }
    }

    /// The angle inside the cell between the two triangles, rad: pi when flat, less where the cell is convex.
    #[inline]
    pub fn angle(&self) -> f64 {
        let sin = self.first.cross(&self.second).dot(&self.edge) / self.edge.norm();
        PI - sin.atan2(self.first.dot(&self.second))
    }

    /// Heights of `c` and `d` over the edge, m.
    pub fn heights(&self) -> [f64; 2] {
        let length = self.edge.norm();
        [self.first.norm() / length, self.second.norm() / length]
    }
}
