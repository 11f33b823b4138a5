//! The bodies of an exchange, and where their markers are.

use crate::subdivision::{Edge, Subdivision};
use lbm_ibm_coupling::Soa3;
use std::ops::Range;
use std::sync::Arc;

/// Where a body meets the fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Markers {
    /// At the corners of equal small triangles into which each triangle of a mesh is divided: no fluid leaks through,
    /// however coarse the mesh. A body without triangles has its nodes as markers.
    Surface {
        /// Distance of neighbouring markers, in grid spacings, above which a body is divided more finely. At rest a
        /// body starts at 0.8 of it; at 1.2 of it, when `max_division` does not allow more, the exchange fails.
        max_gap: f64,
        /// Most parts into which an edge is divided.
        max_division: usize,
    },
    /// At the nodes, however far apart (the paper's coupling).
    Nodes,
}

impl Default for Markers {
    /// On the surface, at most one spacing apart, edges divided by 16 at most.
    fn default() -> Self {
        Self::Surface {
            max_gap: 1.0,
            max_division: 16,
        }
    }
}

impl Markers {
    /// Parts into which the edges of a body at rest are divided, the longest `longest` (m), on a grid of `spacing` (m).
    pub(crate) fn division_at_rest(self, longest: f64, spacing: f64) -> usize {
        match self {
            Self::Nodes => 1,
            Self::Surface { max_gap, max_division } => parts(longest, 0.8 * max_gap * spacing, max_division),
        }
    }
}

/// A body as the exchange keeps it.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    pub id: u32,
    pub range: Range<usize>,
    pub triangles: Arc<[[u32; 3]]>,
    pub reference: Soa3,
    pub edges: Vec<Edge>,
    pub division: usize,
    pub subdivision: Subdivision,
}

impl Surface {
    /// Divides its edges into `division` parts.
    pub fn divide(&mut self, division: usize) {
        self.division = division;
        self.subdivision = Subdivision::of_surface(self.reference.view(), &self.triangles, &self.edges, division);
    }
}

/// Parts, at most `most`, into which `length` is to be cut so that none is longer than `longest`.
pub(crate) fn parts(length: f64, longest: f64, most: usize) -> usize {
    ((length / longest).ceil() as usize).clamp(1, most.max(1))
}
