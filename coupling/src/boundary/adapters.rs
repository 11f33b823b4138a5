//! Set algebra of walls, and a closure as a wall.

use super::{Boundary, Probe};
use crate::Vec3;
use nalgebra::{Isometry3, Point3};

/// The half space behind a plane is solid.
#[derive(Clone, Debug)]
pub struct Plane {
    point: Vec3,
    normal: Vec3,
    velocity: Vec3,
    part: u32,
}

impl Plane {
    /// A wall through `point` (m) with `normal` into the fluid (any length).
    pub fn new(point: Vec3, normal: Vec3) -> Self {
        Self {
            point,
            normal: normal.normalize(),
            velocity: Vec3::zeros(),
            part: 0,
        }
    }

    /// The wall slides on itself with `velocity`, m/s.
    pub fn with_velocity(mut self, velocity: Vec3) -> Self {
        self.velocity = velocity;
        self
    }

    /// The number of the wall in reports and loads.
    pub fn with_part(mut self, part: u32) -> Self {
        self.part = part;
        self
    }
}

impl Boundary for Plane {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        Probe {
            distance: (x - self.point).dot(&self.normal),
            normal: self.normal,
            velocity: self.velocity,
            part: self.part,
        }
    }
}

/// All solids of several walls together: the nearest one answers.
#[derive(Default)]
pub struct Union(Vec<Box<dyn Boundary>>);

impl Union {
    /// No wall yet: everything is fluid.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a solid.
    pub fn with(mut self, wall: impl Boundary + 'static) -> Self {
        self.0.push(Box::new(wall));
        self
    }
}

impl Boundary for Union {
    fn probe(&self, x: Vec3, t: f64) -> Probe {
        self.0
            .iter()
            .map(|w| w.probe(x, t))
            .min_by(|a, b| a.distance.total_cmp(&b.distance))
            .unwrap_or(Probe::at_rest(f64::INFINITY, Vec3::zeros()))
    }

    fn is_static(&self) -> bool {
        self.0.iter().all(|w| w.is_static())
    }
}

/// The solid of `A` with the solid of `B` cut out of it.
pub struct Difference<A, B>(
    /// What is cut.
    pub A,
    /// What is taken away.
    pub B,
);

impl<A: Boundary, B: Boundary> Boundary for Difference<A, B> {
    fn probe(&self, x: Vec3, t: f64) -> Probe {
        let a = self.0.probe(x, t);
        let b = self.1.probe(x, t);
        if a.distance >= -b.distance {
            a
        } else {
            Probe {
                distance: -b.distance,
                normal: -b.normal,
                ..b
            }
        }
    }

    fn is_static(&self) -> bool {
        self.0.is_static() && self.1.is_static()
    }
}

/// A wall put elsewhere: turned, then shifted (m).
pub struct Moved<B> {
    wall: B,
    pose: Isometry3<f64>,
}

impl<B> Moved<B> {
    /// `wall` under `pose`.
    pub fn new(wall: B, pose: Isometry3<f64>) -> Self {
        Self { wall, pose }
    }
}

impl<B: Boundary> Boundary for Moved<B> {
    fn probe(&self, x: Vec3, t: f64) -> Probe {
        let local = self.pose.inverse_transform_point(&Point3::from(x));
        let p = self.wall.probe(local.coords, t);
        Probe {
            normal: self.pose * p.normal,
            velocity: self.pose * p.velocity,
            ..p
        }
    }

    fn is_static(&self) -> bool {
        self.wall.is_static()
    }
}

/// A signed distance (m, positive in the fluid) given as a closure; the normal is its gradient by central differences.
pub struct Closure<F> {
    distance: F,
    step: f64,
}

impl<F: Fn(Vec3) -> f64 + Send + Sync> Closure<F> {
    /// `distance` of a point; `step` (m) is the half step of the differences for the normal.
    pub fn new(distance: F, step: f64) -> Self {
        Self { distance, step }
    }
}

impl<F: Fn(Vec3) -> f64 + Send + Sync> Boundary for Closure<F> {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let slope = |e: Vec3| (self.distance)(x + e * self.step) - (self.distance)(x - e * self.step);
        let g = Vec3::new(slope(Vec3::x()), slope(Vec3::y()), slope(Vec3::z()));
        let normal = g.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        Probe::at_rest((self.distance)(x), normal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::FRAC_PI_2;

    fn ball(centre: Vec3, radius: f64) -> Closure<impl Fn(Vec3) -> f64 + Send + Sync> {
        Closure::new(move |x| (x - centre).norm() - radius, 1e-6)
    }

    #[test]
    fn the_nearest_wall_of_a_union_answers() {
        let walls = Union::new()
            .with(Plane::new(Vec3::zeros(), Vec3::y()))
            .with(Plane::new(Vec3::y() * 4.0, -Vec3::y()).with_part(1));
        assert_relative_eq!(walls.probe(Vec3::y(), 0.0).distance, 1.0);
        assert_eq!(walls.probe(Vec3::y() * 3.5, 0.0).part, 1);
    }

    #[test]
    fn a_hole_in_a_wall_is_fluid() {
        let block = Plane::new(Vec3::zeros(), Vec3::y());
        let hole = Difference(block, ball(Vec3::zeros(), 1.0));
        assert_relative_eq!(hole.probe(Vec3::y() * -0.25, 0.0).distance, 0.75, epsilon = 1e-12);
        assert!(hole.probe(Vec3::y() * -1.5, 0.0).distance < 0.0);
    }

    #[test]
    fn a_moved_wall_turns_its_normal() {
        let pose = Isometry3::new(Vec3::x() * 2.0, Vec3::z() * FRAC_PI_2);
        let p = Moved::new(Plane::new(Vec3::zeros(), Vec3::y()), pose).probe(Vec3::zeros(), 0.0);
        assert_relative_eq!(p.distance, 2.0, epsilon = 1e-12);
        assert_relative_eq!(p.normal, -Vec3::x(), epsilon = 1e-12);
    }

    #[test]
    fn sphere_tracing_finds_the_cut() {
        let wall = ball(Vec3::zeros(), 1.0);
        let s = wall.cut(Vec3::x() * 3.0, Vec3::zeros(), 0.0).expect("meets the ball");
        assert_relative_eq!(s, 2.0 / 3.0, epsilon = 1e-8);
        assert!(wall.cut(Vec3::x() * 3.0, Vec3::x() * 1.5, 0.0).is_none());
    }
}
