//! Rims of walls that are thinner than a cell: how much of a link passes.
//!
//! The velocity at a rim is singular and the nearest node a good part of a spacing away, so a link that passes or not by where
//! it crosses the plane of the wall moves the rim by up to half a spacing. What an opening is then as wide as has a rule: a
//! link stands for the area `6 w h^2` of the plane about its crossing (`w` its weight; those of all links make up the plane),
//! and the opening reaches [`BEYOND`] spacings beyond what its links cover. So with a row of links shut the rim lies at one place, with it open
//! one covered width `W` further, and the link has to pass in part where the true rim is between the two: where it crosses at a distance
//! `s` (in spacings; negative behind the rim, in the wall) within `W/2` of [`BEYOND`] of the rim. The share
//! `k/(1 + k)` of what goes out goes through and the rest comes back. As a leak and a wall in parallel move the rim by
//! `x = k/(k + g)` of the way, `k = g x/(1 - x)`, over `tau - 1/2`, by which the flow does not change with tau.
//!
//! All three were read off the flow through slits, whose exact resistance says where their rims are (Hasimoto 1958): rims at
//! 0.514 and 0.853 spacings from a row of nodes (by the rule 0.513 and 0.847), and at 45 degrees to the grid 0.297 and 0.758 (0.298 and
//! 0.769), and x against k to three digits. Nothing was fitted to round pores. Mass and momentum are kept link by link.

use crate::surface::Surface;
use lbm_ibm_coupling::{Boundary, Vec3};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// How far beyond what its links cover an opening reaches, in spacings.
const BEYOND: f64 = 0.18;
/// Farthest from a rim, in spacings, that a link passes in part.
const REACH: f64 = BEYOND + 0.5 * WIDEST;
/// Width that links cover where their plane's rim runs along the grid, for those that run across the plane and for those that cross it at 45
/// degrees, away from the rim or towards it.
const WIDEST: f64 = 2.0 / 3.0;
const SLANTED: f64 = 1.0 / 3.0;
/// The same of links across the plane where the rim runs at 45 degrees to the grid.
const DIAGONAL: f64 = SLANTED * FRAC_1_SQRT_2;
/// Greatest cosine between the normals at the ends of a link that may pass a rim; along walls and round ones of 2 spacings'
/// radius they are closer.
const TURNS: f64 = 0.5;
/// Greatest depth, in spacings, that a thin wall has half a spacing behind its rim or its face; a square edge has 0.35.
const SHALLOW: f64 = 0.25;
/// Directions about a rim in which the wall is sought, and how far from it (in spacings).
const AROUND: usize = 16;
const NEAR: f64 = 0.25;

/// A link that crosses the plane of a thin wall near its rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Distance of the crossing from the rim in spacings, negative in the wall.
    s: f64,
    /// Width that the link and those like it cover, in spacings.
    width: f64,
}

impl Rim {
    /// That of a link at `s` spacings from a rim whose unit normal in the plane is `outward`, the link's component along which is `tilt` of that across
    /// the plane.
    fn new(s: f64, tilt: f64, outward: Vec3) -> Self {
        // Links across the plane: one row in each spacing, and more the more the rim turns.
        let along = (outward.amax() - FRAC_1_SQRT_2) / (1.0 - FRAC_1_SQRT_2);
        let across = DIAGONAL + (WIDEST - DIAGONAL) * along.clamp(0.0, 1.0);
        let slanted = SLANTED / tilt.max(SLANTED / WIDEST);
        let share = (tilt / FRAC_1_SQRT_2).min(1.0);
        Self {
            s,
            width: across + (slanted - across) * share,
        }
    }

    /// The share of what goes out that passes.
    pub fn share(&self, tau: f64) -> f64 {
        let x = (self.s - BEYOND) / self.width + 0.5;
        if x <= 0.0 {
            return 0.0;
        }
        if x >= 1.0 {
            return 1.0;
        }
        // Read off slits too: from 0.64 at 45 degrees to 0.93 along the grid.
        let k = (0.45 + 0.72 * self.width) * x / ((1.0 - x) * (tau - 0.5));
        k / (1.0 + k)
    }
}

impl Surface<'_> {
    /// The rim of a thin wall that a link from `a` to `b` (m), which meets no wall, passes; none if it passes as a whole.
    pub fn passes_rim(&self, walls: &dyn Boundary, a: Vec3, b: Vec3) -> Option<Rim> {
        let (h, along) = (self.grid.spacing, b - a);
        let [near, far] = [a, b].map(|x| walls.probe(x, self.t).normal);
        if near.dot(&far) > TURNS {
            return None;
        }
        // The place on the link that is nearest to the wall, and the place on the wall.
        let (mut s, mut rim, mut away) = (0.5, a, Vec3::zeros());
        for _ in 0..4 {
            let x = a + along * s;
            let probe = walls.probe(x, self.t);
            (rim, away) = (x - probe.normal * probe.distance, probe.normal);
            s = ((rim - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
        }
        let tangent = near.cross(&far).try_normalize(1e-6)?;
        let first = (away - tangent * tangent.dot(&away)).try_normalize(1e-6)?;
        let second = tangent.cross(&first);
        // From the wall to the opening, in its plane.
        let outward = self.opening(walls, rim, [first, second])?;
        if walls.probe(rim - outward * (0.5 * h), self.t).distance < -SHALLOW * h {
            return None;
        }
        let normal = tangent.cross(&outward);
        let at = (rim - a).dot(&normal) / along.dot(&normal);
        if !(0.0..1.0).contains(&at) {
            return None;
        }
        let cross = a + along * at;
        let s = walls.probe(cross, self.t).distance / h;
        let passes = outward.dot(&(cross - rim)) > 0.0 && s > 0.0 && s < REACH;
        passes.then(|| Rim::new(s, (along.dot(&outward) / along.dot(&normal)).abs(), outward))
    }

    /// The rim near which a link from `a` to `b` (m) is cut by a thin wall, which it meets at the fraction `cut` of its length;
    /// none where it does not pass at all.
    pub fn is_cut_at_rim(&self, walls: &dyn Boundary, a: Vec3, b: Vec3, cut: f64) -> Option<Rim> {
        let (h, along) = (self.grid.spacing, b - a);
        let [near, far] = [a, b].map(|x| walls.probe(x, self.t));
        if near.normal.dot(&far.normal) > TURNS {
            return None;
        }
        // The nearer end has the wall beneath it, and not its rim.
        let normal = if near.distance < far.distance {
            near.normal
        } else {
            far.normal
        };
        let first = normal.cross(&along).try_normalize(1e-6 * h);
        let first = first.or_else(|| normal.cross(&Vec3::ith(normal.iamin(), 1.0)).try_normalize(1e-6))?;
        let cross = a + along * cut;
        if walls.probe(cross - normal * (0.5 * h), self.t).distance < -SHALLOW * h {
            return None;
        }
        let outward = self.opening(walls, cross, [first, normal.cross(&first)])?;
        let behind = NEAR - walls.probe(cross + outward * (NEAR * h), self.t).distance / h;
        let tilt = (along.dot(&outward) / along.dot(&normal)).abs();
        (behind < NEAR).then(|| Rim::new(-behind.max(0.0), tilt, outward))
    }

    /// Where the wall is farthest about `at` (m) in the plane of two unit vectors; none where there is wall on all sides.
    fn opening(&self, walls: &dyn Boundary, at: Vec3, plane: [Vec3; 2]) -> Option<Vec3> {
        let h = self.grid.spacing;
        let around = (0..AROUND).map(|n| {
            let (sin, cos) = (TAU * n as f64 / AROUND as f64).sin_cos();
            let direction = plane[0] * cos + plane[1] * sin;
            direction * walls.probe(at + direction * (NEAR * h), self.t).distance
        });
        around.sum::<Vec3>().try_normalize(1e-6 * h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stencil::{D3Q19, Velocities};
    use lbm_ibm_coupling::{Closure, Grid, Plane};

    fn found(walls: &dyn Boundary, a: [f64; 3], b: [f64; 3], cut: Option<f64>) -> Option<Rim> {
        let grid = Grid::new([8; 3], 1.0, [true; 3]);
        let surface = Surface {
            grid: &grid,
            walls: Some(walls),
            t: 0.0,
            velocity_unit: 1.0,
            velocities: Velocities::of::<D3Q19, 19>(),
        };
        let [a, b] = [a, b].map(Vec3::from);
        match cut {
            Some(cut) => surface.is_cut_at_rim(walls, a, b, cut),
            None => surface.passes_rim(walls, a, b),
        }
    }

    fn edge() -> impl Boundary {
        let distance = |x: Vec3| match x.x.max(0.0).hypot(x.y.max(0.0)) {
            0.0 => x.x.max(x.y),
            outside => outside,
        };
        Closure::new(distance, 1e-6)
    }

    #[test]
    fn rims_are_found_and_edges_are_not() {
        // The plane x = 0.5 from y = 0 down.
        let half = Closure::new(|x: Vec3| (x.x - 0.5).hypot(x.y.max(0.0)), 1e-6);
        for s in [-0.15, -0.05, 0.05, 0.2, 0.45] {
            let cut = (s < 0.0).then_some(0.5);
            let near = |from, to, width: f64| {
                let rim = found(&half, from, to, cut).unwrap();
                assert!(
                    (rim.s - s).abs() < 1e-3 && (rim.width - width).abs() < 1e-3,
                    "{s}: {rim:?}"
                );
            };
            near([0.0, s, 0.0], [1.0, s, 0.0], 2.0 / 3.0);
            near([0.0, s, 0.0], [1.0, s, 1.0], 2.0 / 3.0);
            for up in [0.5, -0.5] {
                near([0.0, s - up, 0.0], [1.0, s + up, 0.0], 1.0 / 3.0);
            }
        }
        assert_eq!(found(&half, [0.0, 0.6, 0.0], [1.0, 0.6, 0.0], None), None);
        assert_eq!(found(&half, [0.0, -0.6, 0.0], [1.0, -0.6, 0.0], Some(0.5)), None);
        // Past a wall, a ball and a square edge, and across the edge.
        let plane = Plane::new(Vec3::zeros(), Vec3::y());
        assert_eq!(found(&plane, [0.0, 0.2, 0.0], [1.0, 0.2, 0.0], None), None);
        let ball = Closure::new(|x: Vec3| x.norm() - 2.0, 1e-6);
        assert_eq!(found(&ball, [-0.5, 2.1, 0.0], [0.5, 2.1, 0.0], None), None);
        assert_eq!(found(&edge(), [-0.4, 0.6, 0.0], [0.6, -0.4, 0.0], None), None);
        assert_eq!(found(&edge(), [-0.6, 0.2, 0.0], [0.4, -0.8, 0.0], Some(0.2)), None);
    }

    #[test]
    fn rows_are_closer_where_the_rim_runs_at_an_angle() {
        // Across the plane x = 0.5 up to the line y + z = 0.
        let slanted = Closure::new(|x: Vec3| (x.x - 0.5).hypot((x.y + x.z).max(0.0) * FRAC_1_SQRT_2), 1e-6);
        for (step, width) in [
            (0.0, DIAGONAL),
            (1.0, SLANTED / FRAC_1_SQRT_2),
            (-1.0, SLANTED / FRAC_1_SQRT_2),
        ] {
            let rim = found(
                &slanted,
                [0.0, 0.1 - 0.5 * step, 0.0],
                [1.0, 0.1 + 0.5 * step, 0.0],
                None,
            )
            .unwrap();
            assert!(
                (rim.s - 0.1 * FRAC_1_SQRT_2).abs() < 1e-3 && (rim.width - width).abs() < 1e-3,
                "{rim:?}"
            );
        }
    }

    #[test]
    fn shares_rise_from_nothing_to_all() {
        for (tilt, outward) in [
            (0.0, Vec3::y()),
            (1.0, Vec3::y()),
            (0.0, Vec3::new(0.0, 1.0, 1.0).normalize()),
        ] {
            let share = |s: f64, tau: f64| Rim::new(s, tilt, outward).share(tau);
            let half = 0.5 * Rim::new(0.0, tilt, outward).width;
            assert_eq!([share(BEYOND - half, 1.0), share(BEYOND + half, 1.0)], [0.0, 1.0]);
            assert!(share(0.2, 1.0) > share(0.15, 1.0) && share(0.2, 0.6) > share(0.2, 3.0));
        }
    }
}
