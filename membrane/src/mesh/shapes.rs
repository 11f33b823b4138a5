//! Spheres and ellipsoids of any number of nodes.

use super::hull::{convex_hull, golden_spiral};
use super::relax::relax;
use super::{Mesh, positive};
use crate::MembraneError;
use lbm_ibm_coupling::Vec3;

/// Sweeps of evening out.
pub(super) const SWEEPS: usize = 300;

/// An even triangulation of the unit sphere.
pub(super) fn unit_sphere(nodes: usize) -> Result<(Vec<Vec3>, Vec<[u32; 3]>), MembraneError> {
    if nodes < 4 {
        return Err(MembraneError::TooFewNodes {
            shape: "sphere",
            nodes,
            least: 4,
        });
    }
    let mut points = golden_spiral(nodes);
    let mut triangles = convex_hull(&points);
    relax(&mut points, &mut triangles, |x| x.normalize(), SWEEPS)?;
    Ok((points, triangles))
}

impl Mesh {
    /// A sphere of `nodes` nodes (4 or more), all at distance `radius` (m) from the origin, evenly spread. The same on
    /// every run.
    ///
    /// # Errors
    /// [`MembraneError::TooFewNodes`], [`MembraneError::NotPositive`].
    pub fn sphere(radius: f64, nodes: usize) -> Result<Self, MembraneError> {
        positive("the radius of a sphere", radius)?;
        let (points, triangles) = unit_sphere(nodes)?;
        Self::new(points.iter().map(|x| x * radius).collect(), triangles)
    }

    /// An ellipsoid with semi-axes `axes` (m) along x, y and z and `nodes` nodes (4 or more), evenly spread.
    ///
    /// # Errors
    /// [`MembraneError::TooFewNodes`], [`MembraneError::NotPositive`].
    pub fn ellipsoid(axes: Vec3, nodes: usize) -> Result<Self, MembraneError> {
        for &a in &axes {
            positive("a semi-axis of an ellipsoid", a)?;
        }
        let (mut points, mut triangles) = unit_sphere(nodes)?;
        for x in &mut points {
            x.component_mul_assign(&axes);
        }
        let project = |x: Vec3| x / x.component_div(&axes).norm();
        relax(&mut points, &mut triangles, project, SWEEPS)?;
        Self::new(points.into_iter().collect(), triangles)
    }
}
