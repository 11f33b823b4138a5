//! Friction coupling: nodes pulled along by `F = -xi (v - u)` instead of carried by the fluid.
//!
//! An exchange needs nothing more for it than [`crate::Markers::Nodes`]: velocity at the nodes, and spreading of the
//! reaction. It leaks, and these functions tell how much.

use std::f64::consts::PI;

/// Share of the relative velocity lost to leakage when a cell of `nodes` nodes and radius `radius` (m) is dragged
/// through a fluid of dynamic `viscosity` (Pa s) with a friction of `friction` (kg/s) at each node:
/// `(1 / N xi) / (1 / N xi + 1 / (6 pi mu a))`, the two drags in series.
pub fn friction_slip_fraction(nodes: usize, friction: f64, viscosity: f64, radius: f64) -> f64 {
    let nodal = 1.0 / (nodes as f64 * friction);
    nodal / (nodal + 1.0 / stokes_drag(viscosity, radius))
}

/// Drag of the fluid over the friction of all nodes, `6 pi mu a / (N xi)`: far below one where nodes follow the fluid.
pub fn friction_ratio(nodes: usize, friction: f64, viscosity: f64, radius: f64) -> f64 {
    stokes_drag(viscosity, radius) / (nodes as f64 * friction)
}

/// Friction of a node (kg/s) by the later calibration of the paper's software:
/// `xi = (393 / n) sqrt(S / (4 pi 4^2)) (1.82 + 0.868 (nu - 1.5) + 1.644 (rho - 1.025))` in nN us/um, with the surface `S`
/// in um2, the kinematic viscosity `nu` in um2/us and the density `rho` in g/cm3; here all in SI.
pub fn calibrated_friction(nodes: usize, surface: f64, kinematic_viscosity: f64, density: f64) -> f64 {
    let size = (surface * 1e12 / (4.0 * PI * 16.0)).sqrt();
    let fluid = 1.82 + 0.868 * (kinematic_viscosity * 1e6 - 1.5) + 1.644 * (density * 1e-3 - 1.025);
    393.0 / nodes as f64 * size * fluid * 1e-9
}

fn stokes_drag(viscosity: f64, radius: f64) -> f64 {
    6.0 * PI * viscosity * radius
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn slip_of_the_papers_cells() {
        // Nodes, radius in um, friction in nN us/um; slip and ratio.
        let rows = [
            (400, 3.0, 0.5, 0.29781, 0.424115),
            (400, 3.0, 1.5, 0.123861, 0.141372),
            (306, 8.0, 0.5, 0.596513, 1.4784),
            (306, 8.0, 1.5, 0.330117, 0.492799),
            (306, 8.0, 5.0, 0.128798, 0.14784),
        ];
        let mu = 1.5e-3;
        for (n, a, xi, slip, ratio) in rows {
            assert_relative_eq!(
                friction_slip_fraction(n, xi * 1e-9, mu, a * 1e-6),
                slip,
                max_relative = 1e-5
            );
            assert_relative_eq!(friction_ratio(n, xi * 1e-9, mu, a * 1e-6), ratio, max_relative = 1e-5);
        }
    }

    #[test]
    fn calibration_of_the_papers_cells() {
        let rbc = calibrated_friction(400, 137.58e-12, 1.5e-6, 1025.0);
        let ctc = calibrated_friction(306, 4.0 * PI * 64e-12, 1.5e-6, 1025.0);
        assert_relative_eq!(rbc, 1.48e-9, max_relative = 5e-3);
        assert_relative_eq!(ctc, 4.68e-9, max_relative = 5e-3);
    }
}
