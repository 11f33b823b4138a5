//! The nineteen velocities of the lattice, opposite ones side by side.

/// Number of populations of a node.
pub const Q: usize = 19;

/// Lattice velocities; `C[opposite(i)] = -C[i]`.
pub const C: [[i32; 3]; Q] = [
    [0, 0, 0],
    [1, 0, 0],
    [-1, 0, 0],
    [0, 1, 0],
    [0, -1, 0],
    [0, 0, 1],
    [0, 0, -1],
    [1, 1, 0],
    [-1, -1, 0],
    [1, -1, 0],
    [-1, 1, 0],
    [1, 0, 1],
    [-1, 0, -1],
    [1, 0, -1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, -1],
    [0, 1, -1],
    [0, -1, 1],
];

/// Weight of the rest population.
pub const W_REST: f64 = 1.0 / 3.0;
/// Weight of the six populations along an axis.
pub const W_AXIS: f64 = 1.0 / 18.0;
/// Weight of the twelve populations along a face diagonal.
pub const W_DIAGONAL: f64 = 1.0 / 36.0;

/// The population that moves the other way.
pub const fn opposite(i: usize) -> usize {
    if i == 0 { 0 } else { ((i - 1) ^ 1) + 1 }
}

/// Weight of population `i`.
pub const fn weight(i: usize) -> f64 {
    match i {
        0 => W_REST,
        1..=6 => W_AXIS,
        _ => W_DIAGONAL,
    }
}

/// `c_i . v`.
pub fn along(i: usize, v: [f64; 3]) -> f64 {
    f64::from(C[i][0]) * v[0] + f64::from(C[i][1]) * v[1] + f64::from(C[i][2]) * v[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moments_of_the_weights_are_those_of_an_isotropic_lattice() {
        assert!(((0..Q).map(weight).sum::<f64>() - 1.0).abs() < 1e-15);
        for a in 0..3 {
            for b in 0..3 {
                let second: f64 = (0..Q).map(|i| weight(i) * f64::from(C[i][a] * C[i][b])).sum();
                assert!((second - if a == b { 1.0 / 3.0 } else { 0.0 }).abs() < 1e-15);
            }
        }
        for i in 0..Q {
            assert_eq!(C[opposite(i)], C[i].map(|c| -c));
        }
    }
}
