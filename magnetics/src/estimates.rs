//! Estimates on the back of an envelope: how soon two beads meet, how strongly they hold, what flow does to them.

use crate::MU0;
use std::f64::consts::PI;

/// Attraction (N) of two touching beads of `radius` (m), both of `moment` (A m2) along the line between them, as fixed dipoles:
/// F0 = 3 mu0 m^2/(2 pi d^4), d = 2 `radius`.
pub fn contact_force(radius: f64, moment: f64) -> f64 {
    3.0 * MU0 * moment * moment / (2.0 * PI * (2.0 * radius).powi(4))
}

/// Time (s) in which two such beads meet from `distance` (m) between centres along the field, in a fluid of `viscosity` (Pa s):
/// t = 2 pi^2 eta a (r0^5 - d^5)/(5 mu0 m^2), from fixed dipoles and Stokes drag alone. Zero if they touch already.
pub fn contact_time(radius: f64, moment: f64, viscosity: f64, distance: f64) -> f64 {
    let way = (distance.powi(5) - (2.0 * radius).powi(5)).max(0.0);
    2.0 * PI * PI * viscosity * radius * way / (5.0 * MU0 * moment * moment)
}

/// Mason number of beads of `radius` (m) and `moment` (A m2) that stand in a flow of `speed` (m/s): drag over attraction,
/// 6 pi eta a U/F0 with F0 of [`contact_force`]. Definitions in the literature differ by constant factors.
pub fn mason_number(radius: f64, moment: f64, viscosity: f64, speed: f64) -> f64 {
    6.0 * PI * viscosity * radius * speed / contact_force(radius, moment)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn beads_of_4_5_um_at_50_millitesla_meet_within_half_a_millisecond() {
        // bead_dynamics reference, M-450: eta 1e-3 Pa s, a 2.25 um, m 9.4e-13 A m2, from two diameters.
        let time = contact_time(2.25e-6, 9.4e-13, 1e-3, 9e-6);
        assert_relative_eq!(time, 4.576157320188e-4, max_relative = 1e-12);
        assert_eq!(contact_time(2.25e-6, 9.4e-13, 1e-3, 4e-6), 0.0);
    }

    #[test]
    fn a_mason_number_of_one_is_drag_that_equals_attraction() {
        let (a, m, eta) = (2e-6, 5e-13, 1e-3);
        let speed = contact_force(a, m) / (6.0 * PI * eta * a);
        assert_relative_eq!(mason_number(a, m, eta, speed), 1.0, max_relative = 1e-14);
    }
}
