//! Closed triangle meshes.

mod disc;
mod hull;
#[cfg(feature = "import")]
mod import;
mod quality;
mod relax;
mod shapes;
mod topology;

pub use disc::{Disc, Spacing};
pub use quality::Quality;
pub use topology::Edge;

use crate::MembraneError;
use lbm_ibm_coupling::nalgebra::Rotation3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3, enclosed_volume, surface_area};
use std::sync::Arc;

/// A closed, oriented surface of triangles: the rest shape of a cell.
///
/// Built once and shared by [`std::sync::Arc`] between the copies of a cell. A closed surface of genus 0 with `n` nodes
/// has `2 n - 4` triangles and `3 n - 6` edges.
#[derive(Clone, Debug)]
pub struct Mesh {
    nodes: Soa3,
    triangles: Arc<[[u32; 3]]>,
    edges: Vec<Edge>,
}

impl Mesh {
    /// A mesh of `nodes` (m) and `triangles`, each wound so that its normal by the right hand points outwards.
    ///
    /// # Errors
    /// The surface is open, not a manifold, wound inwards or in mixed senses, a triangle is degenerate, a node is loose or
    /// not finite.
    pub fn new(nodes: Soa3, triangles: Vec<[u32; 3]>) -> Result<Self, MembraneError> {
        topology::check_nodes(&nodes, &triangles)?;
        let edges = topology::edges(&triangles)?;
        let volume = enclosed_volume(nodes.view(), &triangles);
        if volume <= 0.0 {
            return Err(MembraneError::Inward { volume });
        }
        Ok(Self {
            nodes,
            triangles: triangles.into(),
            edges,
        })
    }

    /// Node positions, m.
    pub fn nodes(&self) -> Soa3Ref<'_> {
        self.nodes.view()
    }

    /// Node numbers of the triangles, outward by the right hand.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The same, shared.
    pub(crate) fn shared_triangles(&self) -> Arc<[[u32; 3]]> {
        self.triangles.clone()
    }

    /// Edges with their two triangles, in ascending order of node numbers.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Enclosed volume, m3.
    pub fn volume(&self) -> f64 {
        enclosed_volume(self.nodes(), &self.triangles)
    }

    /// Surface area, m2.
    pub fn area(&self) -> f64 {
        surface_area(self.nodes(), &self.triangles)
    }

    /// Size along x, y and z, m.
    pub fn extent(&self) -> Vec3 {
        extent(self.nodes())
    }

    /// Evenness of the triangles.
    pub fn quality(&self) -> Quality {
        Quality::of(self)
    }

    /// Mean edge length, m.
    pub fn mean_edge(&self) -> f64 {
        self.quality().edge_mean
    }

    /// The mesh scaled by `factor` about the origin.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn scaled(self, factor: f64) -> Result<Self, MembraneError> {
        positive("the scale of a mesh", factor)?;
        Ok(self.mapped(|x| x * factor))
    }

    /// The mesh turned about the origin.
    pub fn rotated(self, rotation: &Rotation3<f64>) -> Self {
        self.mapped(|x| rotation * x)
    }

    /// The mesh moved so that the mean of its nodes is the origin.
    pub fn centred(self) -> Self {
        let mean = self.nodes().mean();
        self.mapped(|x| x - mean)
    }

    fn mapped(mut self, map: impl Fn(Vec3) -> Vec3) -> Self {
        self.nodes = self.nodes.iter().map(map).collect();
        self
    }
}

/// Size of a set of nodes along x, y and z, m.
pub(crate) fn extent(x: Soa3Ref<'_>) -> Vec3 {
    let span = |a: &[f64]| {
        let (lo, hi) = a.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), &v| {
            (lo.min(v), hi.max(v))
        });
        hi - lo
    };
    Vec3::new(span(x.x), span(x.y), span(x.z))
}

/// Refuses a value that is not positive and finite.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, MembraneError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(MembraneError::NotPositive { what, value })
    }
}
