//! Size and direction of a deformed capsule.

use lbm_ibm::coupling::nalgebra::{Matrix2, Matrix3};
use lbm_ibm::coupling::{Soa3Ref, Vec3};

/// The ellipsoid that has the same second moments of volume as a closed surface.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ellipsoid {
    /// Longer semi-axis in the plane of shear (x, y), m.
    pub length: f64,
    /// Shorter semi-axis in the plane of shear, m.
    pub breadth: f64,
    /// Semi-axis along the vorticity (z), m.
    pub width: f64,
    /// Angle of the longer axis with x, degrees.
    pub angle: f64,
}

impl Ellipsoid {
    /// Taylor's deformation, `(L - B)/(L + B)`.
    pub fn deformation(&self) -> f64 {
        (self.length - self.breadth) / (self.length + self.breadth)
    }
}

/// The ellipsoid of a closed surface that the plane of shear divides evenly.
pub fn ellipsoid(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> Ellipsoid {
    let origin = x.mean();
    let (mut volume, mut first, mut second) = (0.0, Vec3::zeros(), Matrix3::zeros());
    for &[a, b, c] in triangles {
        let p = [a, b, c].map(|i| x.get(i as usize) - origin);
        // The tetrahedron to the origin: its second moments are V/20 (sum of p p + s s), s the sum of the corners.
        let v = p[0].dot(&p[1].cross(&p[2])) / 6.0;
        let s = p[0] + p[1] + p[2];
        volume += v;
        first += s * (v / 4.0);
        second += (p.iter().map(|p| p * p.transpose()).sum::<Matrix3<f64>>() + s * s.transpose()) * (v / 20.0);
    }
    let centre = first / volume;
    let moments = (second / volume - centre * centre.transpose()) * 5.0;
    let plane = Matrix2::new(moments[(0, 0)], moments[(0, 1)], moments[(0, 1)], moments[(1, 1)]).symmetric_eigen();
    let (long, short) = if plane.eigenvalues[0] > plane.eigenvalues[1] {
        (0, 1)
    } else {
        (1, 0)
    };
    let axis = plane.eigenvectors.column(long);
    Ellipsoid {
        length: plane.eigenvalues[long].sqrt(),
        breadth: plane.eigenvalues[short].sqrt(),
        width: moments[(2, 2)].sqrt(),
        angle: (axis[1] / axis[0]).atan().to_degrees(),
    }
}
