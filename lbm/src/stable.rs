//! How fast a uniform flow may be.

use crate::relaxation::{Collision, OddRate, VelocitySet};

/// Relaxation times of the table.
const TAUS: [f64; 12] = [0.5005, 0.501, 0.505, 0.51, 0.52, 0.55, 0.6, 0.7, 0.8, 1.0, 1.5, 2.0];

/// Collisions by their names in the scan, with the greatest stable velocities, lattice units: the least of three directions, as
/// `cargo run --release -p lbm-ibm-benches --bin stability` prints them.
#[rustfmt::skip]
const LIMITS: [(&str, [f64; 12]); 15] = [
    ("BGK", [0.05531, 0.06211, 0.11977, 0.15578, 0.18453, 0.19734, 0.21820, 0.27086, 0.31109, 0.33328, 0.33328, 0.33328]),
    ("TRT316", [0.00305, 0.00609, 0.03070, 0.06141, 0.12281, 0.30711, 0.32594, 0.33203, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("TRT14", [0.00258, 0.00523, 0.02641, 0.05289, 0.10586, 0.26477, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("MRT", [0.00117, 0.00234, 0.01195, 0.02422, 0.04930, 0.12953, 0.28477, 0.33328, 0.33328, 0.33328, 0.33328, 0.33281]),
    ("REG", [0.02586, 0.03656, 0.07914, 0.10586, 0.14086, 0.19922, 0.25156, 0.30445, 0.32930, 0.33328, 0.33328, 0.33328]),
    ("RR", [0.04836, 0.07625, 0.22000, 0.24875, 0.27875, 0.32953, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("CM", [0.06688, 0.09859, 0.24789, 0.31992, 0.32312, 0.33219, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("BGK27", [0.10438, 0.10734, 0.14578, 0.15242, 0.16000, 0.17812, 0.21555, 0.27086, 0.31055, 0.33328, 0.33328, 0.33328]),
    ("TRT27", [0.00742, 0.01484, 0.07375, 0.14625, 0.27234, 0.30164, 0.32461, 0.33203, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("RR27", [0.16094, 0.18703, 0.26187, 0.30125, 0.32273, 0.32906, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("CM27", [0.26875, 0.32188, 0.32508, 0.32680, 0.32930, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("BGK9", [0.16586, 0.16594, 0.16758, 0.17289, 0.18453, 0.19734, 0.21820, 0.27023, 0.31109, 0.33328, 0.33328, 0.33328]),
    ("TRT9", [0.01273, 0.02555, 0.12719, 0.25203, 0.28961, 0.31805, 0.32563, 0.33203, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("RR9", [0.16320, 0.18961, 0.26297, 0.29984, 0.32273, 0.32906, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
    ("CM9", [0.32695, 0.32711, 0.32820, 0.32961, 0.33234, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328, 0.33328]),
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
