//! What multipoles to a given order, more or less open, have of a pair.

use super::Moments;
use super::system::System;

/// Total moments of a pair whose multipoles end at some order, less those of its mutual dipoles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Truncated {
    /// The moments (m3) and their slopes (m2).
    pub beyond: Moments,
    /// Slopes (m3) with the openness of each sphere, field along the line.
    pub par_open: [f64; 2],
    /// Slopes (m3) with the openness of each sphere, field across the line.
    pub perp_open: [f64; 2],
}

impl Truncated {
    /// Spheres of `radius` (m) at `distance` (m), orders from 2 to `order` open by `open`, from 0 to 1. Overlapping spheres
    /// go on from contact as [`Moments::inside`] does.
    pub fn new(radius: [f64; 2], permeability: [f64; 2], distance: f64, order: usize, open: [f64; 2]) -> Self {
        let contact = radius[0] + radius[1];
        let (unit, at) = (radius[0], distance.max(contact));
        let spheres = radius.map(|a| a / unit);
        let (volume, area) = (unit.powi(3), unit.powi(2));
        let one = |m: usize| {
            let system = System::new(spheres, permeability, at / unit, order, m);
            let (all, slope, opens) = system.truncated(open, at / unit);
            let (dipoles, dipoles_slope, _) = system.truncated([0.0; 2], at / unit);
            let slope = (slope - dipoles_slope) * area;
            ((all - dipoles) * volume, slope, opens.map(|o| o * volume))
        };
        let ((par, par_slope, par_open), (perp, perp_slope, perp_open)) = (one(0), one(1));
        let beyond = Moments {
            par,
            perp,
            par_slope,
            perp_slope,
        };
        Self {
            beyond: beyond.inside(distance - at, contact),
            par_open,
            perp_open,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TwoSpheres;
    use approx::assert_relative_eq;

    #[test]
    fn many_open_orders_are_the_exact_pair_and_slopes_are_derivatives() {
        let (radius, mu) = ([1.0, 1.3], [4.0, 0.5]);
        let exact = TwoSpheres::new(radius, mu).unwrap().solve(2.7).unwrap();
        let dipoles = Truncated::new(radius, mu, 2.7, 40, [1.0; 2]).beyond;
        let near = Truncated::new(radius, mu, 2.7, 1, [1.0; 2]).beyond;
        assert_eq!(near, Moments::default());
        let mutual = |m: usize| System::new(radius, mu, 2.7, 1, m).truncated([0.0; 2], 2.7);
        let [par, perp] = exact.total_moment();
        assert_relative_eq!(dipoles.par + mutual(0).0, par, max_relative = 1e-11);
        assert_relative_eq!(dipoles.perp + mutual(1).0, perp, max_relative = 1e-11);
        assert_relative_eq!(
            dipoles.par_slope + mutual(0).1,
            2.0 * exact.force_par,
            max_relative = 1e-9
        );
        assert_relative_eq!(
            dipoles.perp_slope + mutual(1).1,
            2.0 * exact.force_perp,
            max_relative = 1e-9
        );
        let at = |r: f64, open: [f64; 2]| Truncated::new(radius, mu, r, 6, open);
        let (here, h) = (at(2.4, [0.3, 0.6]), 1e-5);
        let slope = |a: Truncated, b: Truncated| {
            [
                (a.beyond.par - b.beyond.par) / (2.0 * h),
                (a.beyond.perp - b.beyond.perp) / (2.0 * h),
            ]
        };
        let [par, perp] = slope(at(2.4 + h, [0.3, 0.6]), at(2.4 - h, [0.3, 0.6]));
        assert_relative_eq!(par, here.beyond.par_slope, max_relative = 1e-7);
        assert_relative_eq!(perp, here.beyond.perp_slope, max_relative = 1e-7);
        let [par, perp] = slope(at(2.4, [0.3 + h, 0.6]), at(2.4, [0.3 - h, 0.6]));
        assert_relative_eq!(par, here.par_open[0], max_relative = 1e-6);
        assert_relative_eq!(perp, here.perp_open[0], max_relative = 1e-6);
        let [par, perp] = slope(at(2.4, [0.3, 0.6 + h]), at(2.4, [0.3, 0.6 - h]));
        assert_relative_eq!(par, here.par_open[1], max_relative = 1e-6);
        assert_relative_eq!(perp, here.perp_open[1], max_relative = 1e-6);
    }
}
