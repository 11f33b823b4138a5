//! Gauss-Legendre rules on [-1, 1].

use std::sync::LazyLock;

const MOST: usize = 8;

static RULES: LazyLock<Vec<Vec<(f64, f64)>>> = LazyLock::new(|| (0..=MOST).map(rule).collect());

/// Nodes and weights of the rule with `n` points, at most 8.
pub(super) fn gauss(n: usize) -> &'static [(f64, f64)] {
    &RULES[n]
}

fn rule(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 1..=n {
                    let k = k as f64;
                    (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
                }
                slope = n as f64 * (x * p - before) / (x * x - 1.0);
                let step = p / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_rule_of_n_points_is_exact_to_degree_2n_minus_1() {
        for n in 1..=MOST {
            let even = 2 * n as i32 - 2;
            let sum: f64 = gauss(n).iter().map(|(x, w)| w * x.powi(even)).sum();
            assert_relative_eq!(sum, 2.0 / (even as f64 + 1.0), max_relative = 1e-13);
        }
    }
}
