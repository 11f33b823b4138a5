//! Many spheres as one wall: the beads of frozen chains, an array of posts.

use crate::{ContactError, compound};
use lbm_ibm_coupling::{Boundary, Domain, Probe, Sphere, Vec3};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::Ray;
use parry3d_f64::query::RayCast;
use parry3d_f64::shape::{Ball, Compound, SharedShape};
use std::sync::Arc;

/// Spheres as a solid wall, found by parry's tree of boxes; sphere `i` is part `first + i`, so that the load on each
/// bead of a frozen chain is told apart (`Scene::loads`, `wall`).
///
/// ```
/// use lbm_ibm_contact::Spheres;
/// use lbm_ibm_coupling::{Boundary, Sphere, Vec3};
///
/// let chain = [0.0, 10e-6, 20e-6].map(|z| Sphere::new(Vec3::z() * z, 5e-6));
/// let wall = Spheres::new(&chain)?;
/// let probe = wall.probe(Vec3::new(7e-6, 0.0, 10e-6), 0.0);
/// assert!((probe.distance - 2e-6).abs() < 1e-18 && probe.part == 1);
/// # Ok::<(), lbm_ibm_contact::ContactError>(())
/// ```
#[derive(Clone)]
pub struct Spheres {
    compound: Arc<Compound>,
    /// The sphere that each shape of the compound is an image of.
    of: Vec<u32>,
    first: u32,
}

impl Spheres {
    /// The union of `spheres`.
    ///
    /// # Errors
    /// [`ContactError::NoSpheres`], [`ContactError::NotPositive`] for a radius.
    pub fn new(spheres: &[Sphere]) -> Result<Self, ContactError> {
        Self::of_images(spheres.iter().copied().zip(0..))
    }

    /// The union of `spheres` and of their periodic images in `domain` that reach into it.
    ///
    /// # Errors
    /// As for [`Spheres::new`].
    pub fn periodic(spheres: &[Sphere], domain: &Domain) -> Result<Self, ContactError> {
        let mut images = Vec::new();
        for (sphere, number) in spheres.iter().zip(0..) {
            let home = domain.wrap(sphere.centre);
            let shifts = |a: usize| if domain.periodic[a] { -1..=1 } else { 0..=0 };
            for i in shifts(0) {
                for j in shifts(1) {
                    for k in shifts(2) {
                        let shift = Vec3::new(f64::from(i), f64::from(j), f64::from(k)).component_mul(&domain.size);
                        // A particle within a period of the face still sees the nearest image.
                        images.push((Sphere::new(home + shift, sphere.radius), number));
                    }
                }
            }
        }
        Self::of_images(images.into_iter())
    }

    fn of_images(images: impl Iterator<Item = (Sphere, u32)>) -> Result<Self, ContactError> {
        let (mut shapes, mut of) = (Vec::new(), Vec::new());
        for (sphere, number) in images {
            if !(sphere.radius.is_finite() && sphere.radius > 0.0) {
                return Err(ContactError::NotPositive {
                    what: "the radius of a sphere (m)",
                    value: sphere.radius,
                });
            }
            let c = sphere.centre;
            let ball = SharedShape(Arc::new(Ball::new(sphere.radius)));
            shapes.push((Pose::translation(c.x, c.y, c.z), ball));
            of.push(number);
        }
        if shapes.is_empty() {
            return Err(ContactError::NoSpheres);
        }
        Ok(Self {
            compound: Arc::new(Compound::new(shapes)),
            of,
            first: 0,
        })
    }

    /// The number of the first sphere in reports and loads.
    pub fn with_first_part(mut self, first: u32) -> Self {
        self.first = first;
        self
    }
}

impl Boundary for Spheres {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let point = Vector::new(x.x, x.y, x.z);
        let Some((shape, projection)) = compound::project(&self.compound, point) else {
            return Probe::at_rest(f64::INFINITY, Vec3::zeros());
        };
        let (pose, _) = &self.compound.shapes()[shape as usize];
        let away = x - Vec3::new(pose.translation.x, pose.translation.y, pose.translation.z);
        let depth = (x - Vec3::new(projection.point.x, projection.point.y, projection.point.z)).norm();
        Probe {
            distance: if projection.is_inside { -depth } else { depth },
            normal: away.try_normalize(0.0).unwrap_or_else(Vec3::x),
            velocity: Vec3::zeros(),
            part: self.first + self.of[shape as usize],
        }
    }

    fn cut(&self, a: Vec3, b: Vec3, _t: f64) -> Option<f64> {
        let along = b - a;
        let ray = Ray::new(Vector::new(a.x, a.y, a.z), Vector::new(along.x, along.y, along.z));
        self.compound.cast_local_ray(&ray, 1.0, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::nalgebra::Isometry3;
    use proptest::prelude::*;

    fn balls(centres: &[[f64; 3]]) -> Vec<Sphere> {
        centres.iter().map(|c| Sphere::new(Vec3::from(*c), 1.0)).collect()
    }

    #[test]
    fn no_sphere_and_no_radius_are_refused() {
        assert!(matches!(Spheres::new(&[]), Err(ContactError::NoSpheres)));
        let flat = Sphere::new(Vec3::zeros(), 0.0);
        assert!(matches!(Spheres::new(&[flat]), Err(ContactError::NotPositive { .. })));
    }

    #[test]
    fn a_sphere_reaches_over_the_period() {
        let domain = Domain {
            origin: Vec3::zeros(),
            size: Vec3::repeat(10.0),
            periodic: [true, false, true],
        };
        let wall = Spheres::periodic(&balls(&[[0.5, 5.0, 5.0], [5.0, 9.5, 15.5]]), &domain).unwrap();
        let over = wall.with_first_part(4).probe(Vec3::new(9.0, 5.0, 5.0), 0.0);
        assert_relative_eq!(over.distance, 0.5, epsilon = 1e-12);
        assert_eq!(over.part, 4);
    }

    proptest! {
        #[test]
        fn the_nearest_sphere_answers(
            centres in prop::collection::vec(prop::array::uniform3(-5.0..5.0f64), 1..20),
            x in prop::array::uniform3(-8.0..8.0f64),
        ) {
            let wall = Spheres::new(&balls(&centres)).unwrap();
            let x = Vec3::from(x);
            let exact = centres.iter().map(|c| (x - Vec3::from(*c)).norm() - 1.0).fold(f64::INFINITY, f64::min);
            let probe = wall.probe(x, 0.0);
            prop_assert!((probe.distance - exact).abs() < 1e-12);
            let centre = Vec3::from(centres[probe.part as usize]);
            prop_assert!(((x - centre).normalize() - probe.normal).norm() < 1e-12);
        }

        #[test]
        fn a_point_in_one_sphere_is_inside_though_another_surface_is_nearer(
            first in prop::array::uniform3(-5.0..5.0f64),
            depth in 0.3..0.9f64,
            before in 0.01..0.29f64,
            towards in prop::array::uniform3(-1.0..1.0f64),
        ) {
            prop_assume!(Vec3::from(towards).norm() > 0.1);
            let first = Vec3::from(first);
            let along = Vec3::from(towards).normalize();
            let x = first + along * (1.0 - depth);
            let second = x + along * (1.0 + before);
            let wall = Spheres::new(&[Sphere::new(first, 1.0), Sphere::new(second, 1.0)]).unwrap();
            prop_assert!((wall.probe(x, 0.0).distance + depth).abs() < 1e-12);
            let shapes = [first, second].map(|c| {
                (Pose::translation(c.x, c.y, c.z), SharedShape(Arc::new(Ball::new(1.0))))
            });
            let solid = crate::Solid::new(SharedShape::compound(shapes.to_vec()), Isometry3::identity());
            prop_assert!((solid.probe(x, 0.0).distance + depth).abs() < 1e-12);
        }

        #[test]
        fn ray_cast_and_sphere_tracing_agree(
            centres in prop::collection::vec(prop::array::uniform3(-5.0..5.0f64), 1..9),
            a in prop::array::uniform3(-8.0..8.0f64),
            b in prop::array::uniform3(-8.0..8.0f64),
        ) {
            struct Traced<'a>(&'a Spheres);
            impl Boundary for Traced<'_> {
                fn probe(&self, x: Vec3, t: f64) -> Probe {
                    self.0.probe(x, t)
                }
            }
            let wall = Spheres::new(&balls(&centres)).unwrap();
            let (a, b) = (Vec3::from(a), Vec3::from(b));
            prop_assume!(wall.probe(a, 0.0).distance > 1e-3 && wall.probe(b, 0.0).distance.abs() > 1e-3);
            if let (Some(s), Some(t)) = (wall.cut(a, b, 0.0), Traced(&wall).cut(a, b, 0.0)) {
                prop_assert!((s - t).abs() < 1e-5);
            }
        }
    }
}
