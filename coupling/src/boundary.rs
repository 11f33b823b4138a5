//! Solid geometry: one signed distance serves fluid, contact and pictures.

mod adapters;

pub use adapters::{Closure, Difference, Moved, Plane, Union};

use crate::Vec3;

/// What a [`Boundary`] says about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Signed distance to the nearest wall, m; positive in the fluid.
    pub distance: f64,
    /// Unit normal of the nearest wall, into the fluid.
    pub normal: Vec3,
    /// Velocity of the wall there, m/s.
    pub velocity: Vec3,
    /// Which wall or bead it is.
    pub part: u32,
}

impl Probe {
    /// A wall at rest, part 0.
    pub fn at_rest(distance: f64, normal: Vec3) -> Self {
        Self {
            distance,
            normal,
            velocity: Vec3::zeros(),
            part: 0,
        }
    }
}

/// Solid geometry: what the fluid flows around and what cells bump into.
///
/// One method makes a device. `distance` must never exceed the true distance to the wall in the fluid (sphere tracing
/// and the contact search rely on it), and its zero set is the wall.
///
/// ```
/// use lbm_ibm_coupling::{Boundary, Probe, Vec3};
///
/// /// A pillar of radius 5 um along z.
/// struct Pillar;
///
/// impl Boundary for Pillar {
///     fn probe(&self, x: Vec3, _t: f64) -> Probe {
///         let r = Vec3::new(x.x, x.y, 0.0);
///         Probe::at_rest(r.norm() - 5e-6, r.normalize())
///     }
/// }
/// assert!(Pillar.probe(Vec3::new(6e-6, 0.0, 0.0), 0.0).distance > 0.0);
/// ```
pub trait Boundary: Send + Sync {
    /// Signed distance, normal, wall velocity and part nearest to `x` (m) at time `t` (s).
    fn probe(&self, x: Vec3, t: f64) -> Probe;

    /// Where the segment from `a` to `b` (m) first meets the wall, as a fraction in `[0, 1]`; `a` is in the fluid.
    /// By default sphere tracing over [`Boundary::probe`], to 1e-9 of the segment.
    fn cut(&self, a: Vec3, b: Vec3, t: f64) -> Option<f64> {
        let length = (b - a).norm();
        if length == 0.0 {
            return None;
        }
        let mut s = 0.0;
        // A segment that grazes a round wall comes nearer by a small share in each step.
        for _ in 0..5000 {
            let d = self.probe(a + (b - a) * s, t).distance / length;
            if d <= 1e-9 {
                return Some(s.min(1.0));
            }
            s += d;
            if s > 1.0 {
                break;
            }
        }
        (self.probe(b, t).distance <= 0.0).then(|| bisect(self, a, b, t))
    }

    /// Whether the wall keeps its shape and place for all time (its surface may still slide on itself).
    fn is_static(&self) -> bool {
        true
    }
}

fn bisect<B: Boundary + ?Sized>(wall: &B, a: Vec3, b: Vec3, t: f64) -> f64 {
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..40 {
        let mid = 0.5 * (lo + hi);
        if wall.probe(a + (b - a) * mid, t).distance > 0.0 {
            lo = mid;
        } else {
            hi = mid;
        }
    }
    0.5 * (lo + hi)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Ball;

    impl Boundary for Ball {
        fn probe(&self, x: Vec3, _t: f64) -> Probe {
            Probe::at_rest(x.norm() - 1.0, x.normalize())
        }
    }

    #[test]
    fn a_segment_that_grazes_a_ball_is_cut() {
        for depth in [1e-2_f64, 1e-3, 1e-4, 1e-5] {
            let height = 1.0 - depth;
            let (a, b) = (Vec3::new(-2.0, height, 0.0), Vec3::new(2.0, height, 0.0));
            let exact = (2.0 - (1.0 - height * height).sqrt()) / 4.0;
            let found = Ball.cut(a, b, 0.0).expect("a cut");
            assert!((found - exact).abs() < 1e-6, "{depth}: {found} {exact}");
        }
        assert_eq!(
            Ball.cut(Vec3::new(-2.0, 1.0001, 0.0), Vec3::new(2.0, 1.0001, 0.0), 0.0),
            None
        );
    }
}
