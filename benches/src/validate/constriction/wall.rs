//! A tube with a rounded throat.

use lbm_ibm::coupling::{Boundary, Probe, Vec3};

/// A tube along x with a throat in it: its solid is all that is less than `lip` away from the part of `|x| <= half` outside of
/// the tube, so that a quarter of a circle leads from the throat to the tube's wall. The distance is exact in the fluid. Lengths
/// in m.
#[derive(Clone, Copy, Debug)]
pub struct Throat {
    /// Its middle.
    pub centre: Vec3,
    /// Radius of the tube.
    pub tube: f64,
    /// Radius of the lip: that of the tube less that of the throat.
    pub lip: f64,
    /// Half of the length over which the throat is straight.
    pub half: f64,
}

impl Throat {
    /// Radius of the opening (m) at a place along the axis.
    pub fn radius(&self, x: f64) -> f64 {
        let beyond = ((x - self.centre.x).abs() - self.half).max(0.0);
        self.tube - (self.lip * self.lip - beyond * beyond).max(0.0).sqrt()
    }
}

impl Boundary for Throat {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let arm = Vec3::new(0.0, x.y - self.centre.y, x.z - self.centre.z);
        let outward = arm.try_normalize(0.0).unwrap_or_else(Vec3::y);
        let along = x.x - self.centre.x;
        let to_tube = self.tube - arm.norm();
        let beyond = (along.abs() - self.half).max(0.0);
        let below = to_tube.max(0.0);
        let to_lip = beyond.hypot(below) - self.lip;
        if to_tube <= to_lip {
            return Probe::at_rest(to_tube, -outward);
        }
        let from_lip = Vec3::x() * (beyond * along.signum()) - outward * below;
        Probe::at_rest(to_lip, from_lip.try_normalize(0.0).unwrap_or(-outward))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THROAT: Throat = Throat {
        centre: Vec3::new(1.0, 2.0, 3.0),
        tube: 2.0,
        lip: 1.1,
        half: 1.0,
    };

    #[test]
    fn the_opening_is_where_the_distance_is_zero() {
        for n in -40..=40 {
            let x = THROAT.centre.x + 0.1 * f64::from(n);
            let wall = THROAT.centre
                + Vec3::new(x - THROAT.centre.x, 0.6, 0.8).component_mul(&Vec3::new(
                    1.0,
                    THROAT.radius(x),
                    THROAT.radius(x),
                ));
            assert!(THROAT.probe(wall, 0.0).distance.abs() < 1e-7, "{x}");
        }
        assert!((THROAT.radius(1.0) - 0.9).abs() < 1e-15 && (THROAT.radius(5.0) - 2.0).abs() < 1e-15);
    }

    #[test]
    fn the_distance_is_that_to_the_nearest_wall() {
        // Points of the wall in the plane of the probed point.
        let wall: Vec<[f64; 2]> = (0..=80_000)
            .map(|n| -4.0 + 1e-4 * f64::from(n))
            .map(|x| [x, THROAT.radius(THROAT.centre.x + x)])
            .collect();
        for (x, r) in [(0.0, 0.3), (1.4, 0.5), (2.0, 1.4), (-2.0, 1.1), (-2.6, 1.9), (3.0, 1.0)] {
            let probe = THROAT.probe(THROAT.centre + Vec3::new(x, 0.6 * r, -0.8 * r), 0.0);
            let nearest = wall
                .iter()
                .map(|w| (w[0] - x).hypot(w[1] - r))
                .fold(f64::INFINITY, f64::min);
            assert!(
                (probe.distance - nearest).abs() < 2e-3,
                "{x} {r}: {} {nearest}",
                probe.distance
            );
            let to = THROAT.centre + Vec3::new(x, 0.6 * r, -0.8 * r) - probe.normal * probe.distance;
            assert!(THROAT.probe(to, 0.0).distance.abs() < 1e-9);
        }
    }
}
