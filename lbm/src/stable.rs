//! How fast a uniform flow may be.

use crate::relaxation::{Collision, OddRate, VelocitySet};

/// Relaxation times of the table.
const TAUS: [f64; 12] = [0.5005, 0.501, 0.505, 0.51, 0.52, 0.55, 0.6, 0.7, 0.8, 1.0, 1.5, 2.0];

/// Collisions by their names in the scan, with the greatest stable velocities, lattice units: the least of three directions, as
/// `cargo run --release -p lbm-ibm-benches --bin stability` prints them.
#[rustfmt::skip]
const LIMITS: [(&str, [f64; 12]); 5] = [
    ("BGK", [0.0553, 0.0621, 0.1197, 0.1557, 0.1845, 0.1973, 0.2182, 0.2708, 0.3110, 0.3332, 0.3332, 0.3332]),
    ("TRT316", [0.0030, 0.0060, 0.0307, 0.0614, 0.1228, 0.3071, 0.3259, 0.3320, 0.3332, 0.3332, 0.3332, 0.3332]),
    ("TRT14", [0.0025, 0.0052, 0.0264, 0.0528, 0.1058, 0.2647, 0.3332, 0.3332, 0.3332, 0.3332, 0.3332, 0.3332]),
    ("MRT", [0.0011, 0.0023, 0.0119, 0.0242, 0.0492, 0.1295, 0.2847, 0.3332, 0.3332, 0.3332, 0.3332, 0.3328]),
    ("REG", [0.0258, 0.0365, 0.0791, 0.1058, 0.1408, 0.1992, 0.2515, 0.3044, 0.3293, 0.3332, 0.3332, 0.3332]),
];

/// Greatest stable velocity, lattice units, if it was computed; between relaxation times linear in the logarithm of `tau - 1/2`.
pub fn limit(collision: Collision, set: VelocitySet, tau: f64) -> Option<f64> {
    let same = |a: f64, b: f64| (a - b).abs() < 1e-12;
    let family = match collision {
        Collision::Bgk => "BGK",
        Collision::Trt { magic } if same(magic, 3.0 / 16.0) && set == VelocitySet::D3Q19 => "TRT316",
        Collision::Trt { magic } if same(magic, 0.25) && set == VelocitySet::D3Q19 => "TRT14",
        Collision::Trt { magic } if same(magic, 3.0 / 16.0) => "TRT",
        Collision::Regularised if set == VelocitySet::D3Q19 => "REG",
        Collision::RecursiveRegularised => "RR",
        Collision::CentralMoments {
            bulk: 1.0,
            odd: OddRate::Rate(1.0),
        } => "CM",
        collision if collision == Collision::mrt() => "MRT",
        _ => return None,
    };
    let suffix = match set {
        VelocitySet::D3Q19 => "",
        VelocitySet::D3Q27 => "27",
        VelocitySet::D2Q9 => "9",
    };
    let named = |(name, _): &&(&str, [f64; 12])| name.strip_prefix(family) == Some(suffix);
    let (_, limits) = LIMITS.iter().find(named)?;
    let above = TAUS.iter().position(|t| *t >= tau).unwrap_or(TAUS.len() - 1).max(1);
    let place = |tau: f64| (tau - 0.5).ln();
    let (low, high) = (place(TAUS[above - 1]), place(TAUS[above]));
    let share = ((place(tau) - low) / (high - low)).clamp(0.0, 1.0);
    Some(limits[above - 1] + share * (limits[above] - limits[above - 1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_met_at_its_relaxation_times_and_not_left_between_them() {
        let bgk = |tau: f64| limit(Collision::Bgk, VelocitySet::D3Q19, tau).expect("in the table");
        assert_eq!(bgk(TAUS[3]), LIMITS[0].1[3]);
        assert!(bgk(0.53) > bgk(0.52) && bgk(0.53) < bgk(0.55));
        assert_eq!(bgk(5.0), LIMITS[0].1[11]);
        let other = Collision::Trt { magic: 0.1 };
        assert_eq!(limit(other, VelocitySet::D3Q19, 0.8), None);
    }
}
