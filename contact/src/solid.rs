//! Any parry shape as a solid wall.

use crate::compound;
use lbm_ibm_coupling::nalgebra::{Isometry3, Point3};
use lbm_ibm_coupling::{Boundary, Probe, Vec3};
use parry3d_f64::math::Vector;
use parry3d_f64::query::Ray;
use parry3d_f64::shape::{Ball, Cuboid, SharedShape};
use std::sync::Arc;

/// A parry shape under a pose, thickened by a rounding radius: solid inside, fluid outside.
///
/// Distances are exact for convex shapes and, outside of it, for a compound of them; where its parts overlap, the part
/// that holds a point deepest answers. A triangle mesh needs parry's ORIENTED flag to have an inside.
#[derive(Clone)]
pub struct Solid {
    shape: SharedShape,
    pose: Isometry3<f64>,
    rounding: f64,
    part: u32,
}

impl Solid {
    /// `shape` (lengths in m) under `pose`.
    pub fn new(shape: SharedShape, pose: Isometry3<f64>) -> Self {
        Self {
            shape,
            pose,
            rounding: 0.0,
            part: 0,
        }
    }

    /// A box of full edge lengths `size` (m) about `centre` (m), its edges rounded with `radius` (m), which stays
    /// inside the box.
    pub fn rounded_box(centre: Vec3, size: Vec3, radius: f64) -> Self {
        let half = size * 0.5 - Vec3::repeat(radius);
        let shape = SharedShape(Arc::new(Cuboid::new(vector(half))));
        Self::new(shape, Isometry3::translation(centre.x, centre.y, centre.z)).with_rounding(radius)
    }

    /// A ball of `radius` about `centre`, m.
    pub fn ball(centre: Vec3, radius: f64) -> Self {
        let shape = SharedShape(Arc::new(Ball::new(radius)));
        Self::new(shape, Isometry3::translation(centre.x, centre.y, centre.z))
    }

    /// Grows the solid by `radius` (m) on all sides.
    pub fn with_rounding(mut self, radius: f64) -> Self {
        self.rounding = radius;
        self
    }

    /// The number of the solid in reports and loads.
    pub fn with_part(mut self, part: u32) -> Self {
        self.part = part;
        self
    }

    fn local(&self, x: Vec3) -> Vec3 {
        self.pose.inverse_transform_point(&Point3::from(x)).coords
    }
}

/// parry speaks glam; the two meet here, by components.
fn vector(v: Vec3) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

impl Boundary for Solid {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let local = self.local(x);
        let nearest = match self
            .shape
            .as_compound()
            .map(|parts| compound::project(parts, vector(local)))
        {
            Some(Some((_, nearest))) => nearest,
            _ => self.shape.project_local_point(vector(local), false),
        };
        let away = local - Vec3::new(nearest.point.x, nearest.point.y, nearest.point.z);
        let depth = away.norm();
        let sign = if nearest.is_inside { -1.0 } else { 1.0 };
        // On the surface of the bare shape the normal is that of the ray from its centre.
        let outward = away
            .try_normalize(0.0)
            .map_or_else(|| local.try_normalize(0.0).unwrap_or_else(Vec3::x), |n| n * sign);
        Probe {
            distance: sign * depth - self.rounding,
            normal: self.pose * outward,
            velocity: Vec3::zeros(),
            part: self.part,
        }
    }

    fn cut(&self, a: Vec3, b: Vec3, t: f64) -> Option<f64> {
        if self.rounding > 0.0 {
            return sphere_trace(self, a, b, t);
        }
        let (start, end) = (self.local(a), self.local(b));
        let ray = Ray::new(vector(start), vector(end - start));
        self.shape.cast_local_ray(&ray, 1.0, true)
    }
}

/// The default search of [`Boundary::cut`], for a shape whose rounding parry does not know.
fn sphere_trace(solid: &Solid, a: Vec3, b: Vec3, t: f64) -> Option<f64> {
    struct Bare<'a>(&'a Solid);
    impl Boundary for Bare<'_> {
        fn probe(&self, x: Vec3, t: f64) -> Probe {
            self.0.probe(x, t)
        }
    }
    Bare(solid).cut(a, b, t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    #[test]
    fn a_rounded_box_keeps_its_outer_size() {
        let b = Solid::rounded_box(Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 6.0), 0.5);
        let face = b.probe(Vec3::new(3.0, 2.0, 3.0), 0.0);
        assert_relative_eq!(face.distance, 1.0, epsilon = 1e-12);
        assert_relative_eq!(face.normal, Vec3::x(), epsilon = 1e-12);
        let corner = b.probe(Vec3::new(2.0, 4.0, 3.0), 0.0);
        assert_relative_eq!(corner.distance, 0.5 * 2f64.sqrt() - 0.5, epsilon = 1e-12);
        assert_relative_eq!(b.probe(Vec3::new(1.2, 2.0, 3.0), 0.0).distance, -0.8, epsilon = 1e-12);
    }

    proptest! {
        #[test]
        fn ray_cast_and_sphere_tracing_agree(
            a in prop::array::uniform3(-3.0..3.0f64),
            b in prop::array::uniform3(-3.0..3.0f64),
        ) {
            let ball = Solid::ball(Vec3::zeros(), 1.0);
            let (a, b) = (Vec3::from(a), Vec3::from(b));
            prop_assume!(a.norm() > 1.01);
            let nearest = a + (b - a) * (-a.dot(&(b - a)) / (b - a).norm_squared()).clamp(0.0, 1.0);
            prop_assume!((nearest.norm() - 1.0).abs() > 1e-3);
            match (ball.cut(a, b, 0.0), sphere_trace(&ball, a, b, 0.0)) {
                (Some(s), Some(t)) => prop_assert!((s - t).abs() < 1e-6),
                (None, None) => {}
                other => prop_assert!(false, "{other:?}"),
            }
        }
    }
}
