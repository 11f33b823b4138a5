//! Rims of walls that are thinner than a cell: how much of a link passes.
//!
//! The velocity at a rim is singular and the nearest node a good part of a spacing away, so a link that passes or not by where
//! it crosses the plane of the wall moves the rim by up to half a spacing, mostly outwards. Links that cross
//! the opening at a distance `s` (in spacings) of less than a half from the rim pass in part instead: the share `k/(1 + k)` of
//! what goes out goes through and the rest comes back, with `k = s^0.75/(0.5 - s)/(tau - 1/2)`. Divided by the
//! viscosity like that the flow does not change with tau. The function of `s` is that for which slits have the resistance
//! of slits at any place on the grid (`--test thin`, `validate slit_pore_resistance`), least so where a rim lies on nodes. It was not fitted to round pores. Mass and momentum are kept link by link.

use crate::surface::Surface;
use lbm_ibm_coupling::{Boundary, Vec3};
use std::f64::consts::TAU;

/// Distance from the rim, in spacings, at which links pass as a whole.
const REACH: f64 = 0.5;
/// Greatest cosine between the normals at the ends of a link that may pass a rim; along walls and round ones of 2 spacings'
/// radius they are closer.
const TURNS: f64 = 0.5;
/// Greatest depth, in spacings, that a thin wall has half a spacing behind its rim; a square edge has 0.35.
const SHALLOW: f64 = 0.25;
/// Directions about a rim in which the wall is sought, and how far from it (in spacings).
const AROUND: usize = 16;
const NEAR: f64 = 0.25;

/// The share of what goes out on a link that passes the opening at a distance `s` (in spacings) from the rim.
pub fn share(s: f64, tau: f64) -> f64 {
    if s >= REACH {
        return 1.0;
    }
    let k = s.powf(0.75) / ((REACH - s) * (tau - 0.5));
    k / (1.0 + k)
}

impl Surface<'_> {
    /// Distance (in spacings) from the rim of a thin wall at which a link from `a` to `b` (m), which meets no wall, crosses its
    /// plane; none if that is half a spacing or more.
    pub fn passes_rim(&self, walls: &dyn Boundary, a: Vec3, b: Vec3) -> Option<f64> {
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
        let outward = (0..AROUND)
            .map(|n| {
                let (sin, cos) = (TAU * n as f64 / AROUND as f64).sin_cos();
                let direction = first * cos + second * sin;
                direction * walls.probe(rim + direction * (NEAR * h), self.t).distance
            })
            .sum::<Vec3>()
            .try_normalize(1e-6 * h)?;
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
        (outward.dot(&(cross - rim)) > 0.0 && s > 0.0 && s < REACH).then_some(s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stencil::{D3Q19, Velocities};
    use lbm_ibm_coupling::{Closure, Grid, Plane};

    fn passes(walls: &dyn Boundary, a: [f64; 3], b: [f64; 3]) -> Option<f64> {
        let grid = Grid::new([8; 3], 1.0, [true; 3]);
        let surface = Surface {
            grid: &grid,
            walls: Some(walls),
            t: 0.0,
            velocity_unit: 1.0,
            velocities: Velocities::of::<D3Q19, 19>(),
        };
        surface.passes_rim(walls, Vec3::from(a), Vec3::from(b))
    }

    #[test]
    fn rims_are_found_and_edges_are_not() {
        // The plane x = 0.5 from y = 0 down.
        let half = Closure::new(|x: Vec3| (x.x - 0.5).hypot(x.y.max(0.0)), 1e-6);
        for s in [0.05, 0.2, 0.45] {
            for [from, to] in [[[0.0, s, 0.0], [1.0, s, 0.0]], [[0.0, s, 0.0], [1.0, s, 1.0]]] {
                let found = passes(&half, from, to).unwrap();
                assert!((found - s).abs() < 1e-4, "{s}: {found}");
            }
            for up in [0.5, -0.5] {
                let found = passes(&half, [0.0, s - up, 0.0], [1.0, s + up, 0.0]).unwrap();
                assert!((found - s).abs() < 1e-4, "{s}: {found}");
            }
        }
        assert_eq!(passes(&half, [0.0, 0.6, 0.0], [1.0, 0.6, 0.0]), None);
        // Past a wall, a ball and a square edge.
        let plane = Plane::new(Vec3::zeros(), Vec3::y());
        assert_eq!(passes(&plane, [0.0, 0.2, 0.0], [1.0, 0.2, 0.0]), None);
        let ball = Closure::new(|x: Vec3| x.norm() - 2.0, 1e-6);
        assert_eq!(passes(&ball, [-0.5, 2.1, 0.0], [0.5, 2.1, 0.0]), None);
        let edge = Closure::new(
            |x: Vec3| match x.x.max(0.0).hypot(x.y.max(0.0)) {
                0.0 => x.x.max(x.y),
                outside => outside,
            },
            1e-6,
        );
        assert_eq!(passes(&edge, [-0.4, 0.6, 0.0], [0.6, -0.4, 0.0]), None);
    }

    #[test]
    fn shares_rise_from_nothing_to_all() {
        assert_eq!([share(0.0, 1.0), share(0.5, 1.0), share(2.0, 3.0)], [0.0, 1.0, 1.0]);
        assert!(share(0.3, 1.0) > share(0.2, 1.0) && share(0.2, 0.6) > share(0.2, 3.0));
    }
}
