//! Elements of a mesh, and what is known of each at rest.

use super::batch::{BATCH, Lanes};
use super::hinge::Hinge;
use super::{corners, twice_area};
use crate::Mesh;
use lbm_ibm_coupling::Soa3Ref;
use std::sync::Arc;

/// Elements of `N` nodes each, with `K` numbers about each at rest. Copies share both lists: cells of one kind read the
/// same ones, which then stay in the processor's cache.
#[derive(Clone, Debug)]
pub(super) struct Elements<const N: usize, const K: usize> {
    nodes: Arc<[[u32; N]]>,
    rest: Arc<[[f64; K]]>,
}

impl<const N: usize, const K: usize> Elements<N, K> {
    /// Elements on `nodes`, at rest as `rest` says of each.
    pub fn new(nodes: Arc<[[u32; N]]>, rest: impl Fn([u32; N]) -> [f64; K]) -> Self {
        let rest = nodes.iter().map(|&n| rest(n)).collect();
        Self { nodes, rest }
    }

    /// Node numbers of all elements.
    pub fn nodes(&self) -> &[[u32; N]] {
        &self.nodes
    }

    /// Node numbers of each, and the numbers at rest.
    pub fn iter(&self) -> impl Iterator<Item = ([u32; N], [f64; K])> {
        self.nodes.iter().copied().zip(self.rest.iter().copied())
    }

    /// The same, as many at a time as fit into [`Lanes`].
    #[inline(always)]
    pub fn batches(&self) -> impl Iterator<Item = (&[[u32; N]], &[[f64; K]])> {
        self.nodes.chunks(BATCH).zip(self.rest.chunks(BATCH))
    }

    /// The same elements, at rest in another way.
    pub fn at_rest(&self, rest: impl Fn([u32; N]) -> [f64; K]) -> Self {
        Self::new(self.nodes.clone(), rest)
    }
}

impl Elements<2, 1> {
    /// The edges of `mesh`, with their lengths, m.
    pub fn springs(mesh: &Mesh) -> Self {
        let x = mesh.nodes();
        let ends = mesh.edges().iter().map(|e| e.nodes).collect();
        Self::new(ends, |e| [length(x, e)])
    }
}

impl<const K: usize> Elements<3, K> {
    /// The triangles of `mesh`, with what `rest` says of their corners (m).
    pub fn triangles(mesh: &Mesh, rest: impl Fn([lbm_ibm_coupling::Vec3; 3]) -> [f64; K]) -> Self {
        Self::new(mesh.shared_triangles(), |t| rest(corners(mesh.nodes(), t)))
    }
}

impl Elements<3, 1> {
    /// The triangles of `mesh`, with their areas, m2.
    pub fn areas(mesh: &Mesh) -> Self {
        Self::triangles(mesh, |c| [0.5 * twice_area(c).norm()])
    }
}

impl<const K: usize> Elements<4, K> {
    /// The hinges of `mesh`, in the order of its edges, with what `rest` says of them.
    pub fn hinges(mesh: &Mesh, rest: impl Fn(&Hinge) -> [f64; K]) -> Self {
        let hinges = mesh.edges().iter().map(super::hinge::nodes).collect();
        Self::new(hinges, |h| rest(&Hinge::at(mesh.nodes(), h)))
    }
}

/// Length of an edge, m.
#[inline]
pub(super) fn length(x: Soa3Ref<'_>, [a, b]: [u32; 2]) -> f64 {
    (x.get(b as usize) - x.get(a as usize)).norm()
}

/// The numbers of at most [`BATCH`] elements, ones behind them.
#[inline(always)]
pub(super) fn numbers<const K: usize>(of: &[[f64; K]]) -> [Lanes; K] {
    let mut out = [[1.0; BATCH]; K];
    for (l, values) in of.iter().enumerate().take(BATCH) {
        for k in 0..K {
            out[k][l] = values[k];
        }
    }
    out
}
