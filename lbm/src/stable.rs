//! How fast a uniform flow may be.

use crate::relaxation::{Collision, OddRate, VelocitySet};

/// Relaxation times of the table.
const TAUS: [f64; 12] = [0.5005, 0.501, 0.505, 0.51, 0.52, 0.55, 0.6, 0.7, 0.8, 1.0, 1.5, 2.0];

/// Collisions by their names in the scan, with the greatest stable velocities, lattice units: the least of three directions, as
/// `cargo run --release -p lbm-ibm-benches --bin stability` prints them, or what it printed with fewer waves where that was less. All
/// are upper bounds. Those of CM at the first two relaxation times are of a coarse scan: a finer one says that some wave grows at
/// any velocity, which is not understood.
#[rustfmt::skip]
const LIMITS: [(&str, [f64; 12]); 15] = [
    ("BGK", [0.04702, 0.06166, 0.10696, 0.13289, 0.17496, 0.19511, 0.21816, 0.26987, 0.31092, 0.33333, 0.33333, 0.33333]),
    ("TRT316", [0.00297, 0.00594, 0.02974, 0.05932, 0.11820, 0.27860, 0.32556, 0.33201, 0.33333, 0.33331, 0.33331, 0.33331]),
    ("TRT14", [0.00256, 0.00517, 0.02576, 0.05145, 0.10227, 0.24514, 0.33333, 0.33333, 0.33333, 0.33333, 0.33331, 0.33331]),
    ("MRT", [0.00113, 0.00230, 0.01192, 0.02423, 0.04927, 0.12950, 0.28472, 0.33332, 0.33332, 0.33332, 0.33331, 0.33276]),
    ("REG", [0.02581, 0.03650, 0.07852, 0.10554, 0.14014, 0.19858, 0.25106, 0.30441, 0.32900, 0.33333, 0.33333, 0.33333]),
    ("RR", [0.02892, 0.03872, 0.08151, 0.11316, 0.15606, 0.23495, 0.31513, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333]),
    ("CM", [0.06688, 0.09859, 0.08261, 0.11554, 0.16172, 0.25023, 0.33316, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333]),
    ("BGK27", [0.06069, 0.07269, 0.12664, 0.13977, 0.15247, 0.17719, 0.21559, 0.26987, 0.31058, 0.33333, 0.33333, 0.33333]),
    ("TRT27", [0.00293, 0.00593, 0.02967, 0.05925, 0.11764, 0.27887, 0.32461, 0.33193, 0.33333, 0.33331, 0.33331, 0.33331]),
    ("RR27", [0.16099, 0.18704, 0.26192, 0.29977, 0.32087, 0.32828, 0.33300, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333]),
    ("CM27", [0.25525, 0.30959, 0.32364, 0.32486, 0.32698, 0.33137, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333]),
    ("BGK9", [0.03432, 0.05133, 0.09948, 0.13972, 0.15898, 0.19511, 0.21815, 0.26985, 0.31096, 0.33333, 0.33333, 0.33333]),
    ("TRT9", [0.00335, 0.00675, 0.03364, 0.06696, 0.13080, 0.31803, 0.32556, 0.33200, 0.33333, 0.33333, 0.33333, 0.33333]),
    ("RR9", [0.16318, 0.18940, 0.26294, 0.29980, 0.32133, 0.32836, 0.33300, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333]),
    ("CM9", [0.32470, 0.32478, 0.32576, 0.32681, 0.32869, 0.33235, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333, 0.33333]),
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
