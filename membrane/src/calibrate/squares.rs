//! Least squares by Levenberg and Marquardt, and what their minimum says.

use lbm_ibm_coupling::nalgebra::{DMatrix, DVector};

/// Most Jacobians.
const ROUNDS: usize = 20;
/// Most tries of a round.
const TRIES: usize = 12;
/// Longest step in any unknown.
const LONGEST: f64 = 1.0;
/// A step in all unknowns that counts as none.
const LEAST: f64 = 1e-3;
/// A share of the sum of squares whose loss counts as none.
const FLAT: f64 = 1e-4;
/// Half width of a 95 % interval of the normal distribution.
pub(super) const NORMAL: f64 = 1.959_964;

/// Residuals as a function of unknowns.
pub(super) trait Model {
    /// Why residuals cannot be computed.
    type Error;
    fn residuals(&mut self, unknowns: &DVector<f64>) -> Result<DVector<f64>, Self::Error>;
    fn jacobian(&mut self, unknowns: &DVector<f64>, residuals: &DVector<f64>) -> Result<DMatrix<f64>, Self::Error>;
}

/// Where a sum of squares is least.
pub(super) struct Minimum {
    pub logarithms: DVector<f64>,
    pub residuals: DVector<f64>,
    pub jacobian: DMatrix<f64>,
    /// Residuals and Jacobians computed.
    pub iterations: usize,
}

/// Searches for the least sum of squares from a start. A step at which the residuals cannot be computed counts as one
/// that makes them worse.
pub(super) fn minimise<M: Model>(model: &mut M, start: Vec<f64>) -> Result<Minimum, M::Error> {
    let unknowns = DVector::from_vec(start);
    let residuals = model.residuals(&unknowns)?;
    let jacobian = model.jacobian(&unknowns, &residuals)?;
    let mut best = Minimum {
        logarithms: unknowns,
        residuals,
        jacobian,
        iterations: 2,
    };
    let mut damping = 1e-3;
    for _ in 0..ROUNDS {
        let before = best.residuals.norm_squared();
        let Some(moved) = better(model, &mut best, &mut damping) else {
            break;
        };
        best.jacobian = model.jacobian(&best.logarithms, &best.residuals)?;
        best.iterations += 1;
        if moved < LEAST || before - best.residuals.norm_squared() < FLAT * before {
            break;
        }
    }
    Ok(best)
}

/// Moves to the first damped step that lowers the sum of squares: its size, or none.
fn better<M: Model>(model: &mut M, best: &mut Minimum, damping: &mut f64) -> Option<f64> {
    let normal = best.jacobian.tr_mul(&best.jacobian);
    let slope = best.jacobian.tr_mul(&best.residuals);
    for _ in 0..TRIES {
        let mut damped = normal.clone();
        for k in 0..damped.nrows() {
            // An unknown that the residuals do not depend on stays where it is.
            damped[(k, k)] += *damping * normal[(k, k)].max(f64::MIN_POSITIVE.sqrt());
        }
        let step = damped.lu().solve(&-&slope)?;
        let size = step.amax();
        if size < 0.1 * LEAST {
            return None;
        }
        if size <= LONGEST {
            let trial = &best.logarithms + step;
            best.iterations += 1;
            if let Ok(residuals) = model.residuals(&trial)
                && residuals.norm_squared() < best.residuals.norm_squared()
            {
                *damping = (*damping * 0.2).max(1e-9);
                best.logarithms = trial;
                best.residuals = residuals;
                return Some(size);
            }
        }
        *damping *= 6.0;
    }
    None
}

/// Singular values of a matrix, greatest first, with their right directions.
pub(super) fn singular(matrix: &DMatrix<f64>) -> Vec<(f64, Vec<f64>)> {
    let symmetric = matrix.tr_mul(matrix).symmetric_eigen();
    let mut out: Vec<(f64, Vec<f64>)> = (0..matrix.ncols())
        .map(|k| {
            let direction: Vec<f64> = symmetric.eigenvectors.column(k).iter().copied().collect();
            let image = matrix * DVector::from_vec(direction.clone());
            (image.norm(), direction)
        })
        .collect();
    out.sort_by(|a, b| b.0.total_cmp(&a.0));
    out
}

/// Half width of a 95 % interval of Student's distribution.
pub(super) fn student(freedom: usize) -> f64 {
    const FEW: [f64; 10] = [
        12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281,
    ];
    if let Some(&t) = freedom.checked_sub(1).and_then(|k| FEW.get(k)) {
        return t;
    }
    // Expansion in 1/freedom (Abramowitz and Stegun 26.7.5).
    let (z, n) = (NORMAL, freedom as f64);
    z + (z.powi(3) + z) / (4.0 * n)
        + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * n * n)
        + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / (384.0 * n.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// y = exp(a) x^exp(b) with its products: a curved problem with a known answer.
    struct Power<'a>(&'a [(f64, f64)]);

    impl Model for Power<'_> {
        type Error = ();
        fn residuals(&mut self, q: &DVector<f64>) -> Result<DVector<f64>, ()> {
            let r = |&(x, y): &(f64, f64)| q[0].exp() * x.powf(q[1].exp()) - y;
            Ok(DVector::from_iterator(self.0.len(), self.0.iter().map(r)))
        }
        fn jacobian(&mut self, q: &DVector<f64>, residuals: &DVector<f64>) -> Result<DMatrix<f64>, ()> {
            let column = |k: usize| {
                let mut moved = q.clone();
                moved[k] += 1e-6;
                (self.residuals(&moved).unwrap() - residuals) / 1e-6
            };
            Ok(DMatrix::from_columns(&[0, 1].map(column)))
        }
    }

    #[test]
    fn a_power_law_is_found_from_afar() {
        let data: Vec<_> = (1..8)
            .map(|k| 0.5 * f64::from(k))
            .map(|x| (x, 3.0 * x.powf(1.7)))
            .collect();
        let found = minimise(&mut Power(&data), vec![0.0, -1.0]).unwrap();
        assert!((found.logarithms[0].exp() - 3.0).abs() < 1e-4 && (found.logarithms[1].exp() - 1.7).abs() < 1e-4);
        assert!(found.residuals.norm() < 1e-3);
    }

    #[test]
    fn a_straight_line_has_the_textbook_errors() {
        // y = a + b x at x = 0, 1, 2, 3: variances sigma^2 (1/n + mean^2/Sxx) = 0.7 and sigma^2/Sxx = 0.2.
        let rows = [0.0, 1.0, 2.0, 3.0];
        let jacobian = DMatrix::from_fn(4, 2, |i, k| if k == 0 { 1.0 } else { rows[i] });
        let parts = singular(&jacobian);
        let variance = |k: usize| parts.iter().map(|(s, v)| (v[k] / s).powi(2)).sum::<f64>();
        assert!((variance(0) - 0.7).abs() < 1e-12 && (variance(1) - 0.2).abs() < 1e-12);
        assert!(parts[0].0 > parts[1].0);
    }

    #[test]
    fn students_quantiles_are_those_of_tables() {
        for (n, t) in [
            (1, 12.706),
            (5, 2.571),
            (10, 2.228),
            (11, 2.201),
            (20, 2.086),
            (60, 2.000),
            (1000, 1.962),
        ] {
            assert!((student(n) - t).abs() < 1.5e-3, "{n}: {}", student(n));
        }
    }
}
