//! The angle between two triangles that share an edge.

use crate::mesh::Edge;
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, Vec3};
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

    /// Sine and cosine of the angle by which the two normals differ, positive where the cell is convex: pi less the
    /// angle inside.
    #[inline]
    pub fn turn(&self) -> (f64, f64) {
        let sin = self.first.cross(&self.second).dot(&self.edge) / self.edge.norm();
        let cos = self.first.dot(&self.second);
        let size = sin.hypot(cos);
        (sin / size, cos / size)
    }

    /// Adds `moment` (J) times the gradient of the angle inside the cell: the forces of an energy E with
    /// moment = -dE/dtheta.
    #[inline]
    pub fn add_moment(&self, x: Soa3Ref<'_>, nodes: [u32; 4], moment: f64, force: &mut Soa3Mut<'_>) {
        let [a, b, c, d] = nodes.map(|i| i as usize);
        let square = self.edge.norm_squared();
        // theta grows as an opposite node goes outwards, by one over its height; where the foot of the height lies
        // along the edge tells how the edge's nodes share the reaction.
        let strength = moment * square.sqrt();
        let first = self.first * (strength / self.first.norm_squared());
        let second = self.second * (strength / self.second.norm_squared());
        let start = x.get(a);
        let (p, q) = (
            (x.get(c) - start).dot(&self.edge) / square,
            (x.get(d) - start).dot(&self.edge) / square,
        );
        force.add(a, first * (p - 1.0) + second * (q - 1.0));
        force.add(b, -first * p - second * q);
        force.add(c, first);
        force.add(d, second);
    }
}
