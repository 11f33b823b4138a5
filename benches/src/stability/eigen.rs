//! Eigenvalues of small dense complex matrices.

use lbm_ibm::coupling::nalgebra::Complex;

type C = Complex<f64>;

/// Most steps for one eigenvalue.
const STEPS: usize = 100;

/// Greatest modulus of the eigenvalues of an `n` by `n` matrix, given row after row; none if the iteration fails. The matrix is
/// used up.
///
/// Reduction to Hessenberg form by Householder reflections, then QR steps with Wilkinson's shift by Givens rotations (Golub and Van
/// Loan, Matrix Computations, chapter 7).
pub fn spectral_radius(a: &mut [C], n: usize) -> Option<f64> {
    hessenberg(a, n);
    // What is lost below the diagonal is a change of the matrix in its last digit.
    let none = f64::EPSILON * a.iter().map(|v| v.norm_sqr()).sum::<f64>().sqrt();
    let mut radius = 0.0_f64;
    let mut end = n;
    let mut steps = 0;
    while end > 0 {
        let start = active(a, n, end, none);
        if start + 1 == end {
            radius = radius.max(a[(end - 1) * n + end - 1].norm_sqr().sqrt());
            end -= 1;
            steps = 0;
        } else {
            if steps == STEPS {
                return None;
            }
            steps += 1;
            step(a, n, start, end, steps % 10 == 0);
        }
    }
    Some(radius)
}

/// First row of the last block that does not fall apart; what is not above `none` below the diagonal becomes zero.
fn active(a: &mut [C], n: usize, end: usize, none: f64) -> usize {
    for i in (1..end).rev() {
        let below = &mut a[i * n + i - 1];
        if below.norm_sqr() <= none * none {
            *below = C::new(0.0, 0.0);
            return i;
        }
    }
    0
}

fn hessenberg(a: &mut [C], n: usize) {
    let mut v = vec![C::new(0.0, 0.0); n];
    for k in 0..n.saturating_sub(2) {
        let norm = (k + 1..n).map(|i| a[i * n + k].norm_sqr()).sum::<f64>().sqrt();
        let first = a[(k + 1) * n + k];
        if norm == 0.0 {
            continue;
        }
        let phase = if first.norm() == 0.0 {
            C::new(1.0, 0.0)
        } else {
            first / first.norm()
        };
        for i in k + 1..n {
            v[i] = a[i * n + k];
        }
        v[k + 1] += phase * norm;
        let square: f64 = v[k + 1..n].iter().map(|x| x.norm_sqr()).sum();
        for j in k..n {
            let dot: C = (k + 1..n).map(|i| v[i].conj() * a[i * n + j]).sum();
            let scale = dot * (2.0 / square);
            for i in k + 1..n {
                a[i * n + j] -= v[i] * scale;
            }
        }
        for row in a.chunks_exact_mut(n) {
            let dot: C = (k + 1..n).map(|j| row[j] * v[j]).sum();
            let scale = dot * (2.0 / square);
            for j in k + 1..n {
                row[j] -= scale * v[j].conj();
            }
        }
    }
}

/// A QR step on rows `start..end`. Only the block itself is kept up: eigenvalues need no more.
fn step(a: &mut [C], n: usize, start: usize, end: usize, exceptional: bool) {
    let at = |i: usize, j: usize| a[i * n + j];
    let (p, q) = (at(end - 2, end - 2), at(end - 2, end - 1));
    let (r, s) = (at(end - 1, end - 2), at(end - 1, end - 1));
    let shift = if exceptional {
        s + C::new(r.norm(), 0.0)
    } else {
        let half = (p - s) * 0.5;
        let root = (half * half + q * r).sqrt();
        let (one, two) = (half + root, half - root);
        s + if one.norm_sqr() < two.norm_sqr() { one } else { two }
    };
    let mut rotations = Vec::with_capacity(end - start);
    for i in start..end {
        a[i * n + i] -= shift;
    }
    for i in start..end - 1 {
        let (x, y) = (a[i * n + i], a[(i + 1) * n + i]);
        let length = (x.norm_sqr() + y.norm_sqr()).sqrt();
        let (c, s) = if length == 0.0 {
            (C::new(1.0, 0.0), C::new(0.0, 0.0))
        } else {
            (x / length, y / length)
        };
        for j in i..end {
            let (x, y) = (a[i * n + j], a[(i + 1) * n + j]);
            a[i * n + j] = c.conj() * x + s.conj() * y;
            a[(i + 1) * n + j] = c * y - s * x;
        }
        rotations.push((c, s));
    }
    for (i, (c, s)) in (start..).zip(rotations) {
        for row in start..(i + 2).min(end) {
            let (x, y) = (a[row * n + i], a[row * n + i + 1]);
            a[row * n + i] = x * c + y * s;
            a[row * n + i + 1] = y * c.conj() - x * s.conj();
        }
    }
    for i in start..end {
        a[i * n + i] += shift;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eigenvalues of a circulant matrix are the Fourier transform of its first row; a random similarity hides them.
    #[test]
    fn circulant_matrices_and_their_disguises() {
        for n in [1, 2, 5, 9, 19, 27] {
            let row: Vec<C> = (0..n)
                .map(|i| C::new((1.3 * i as f64).sin(), (0.7 * i as f64).cos()))
                .collect();
            let wave = |k: usize, j: usize| C::from_polar(1.0, std::f64::consts::TAU * (k * j) as f64 / n as f64);
            let value = |k: usize| (0..n).map(|j| row[j] * wave(k, j)).sum::<C>().norm();
            let exact = (0..n).map(value).fold(0.0_f64, f64::max);
            let mut a: Vec<C> = (0..n * n).map(|m| row[(m % n + n - m / n) % n]).collect();
            // P a P^-1 with P = 1 + t e_i e_j^T.
            for (i, j) in [(0, n - 1), (n - 1, 0), (n / 2, n / 3)] {
                if i == j {
                    continue;
                }
                let t = C::new(0.4, -0.3);
                for k in 0..n {
                    let add = t * a[j * n + k];
                    a[i * n + k] += add;
                }
                for k in 0..n {
                    let take = t * a[k * n + i];
                    a[k * n + j] -= take;
                }
            }
            let found = spectral_radius(&mut a, n).expect("converges");
            assert!((found / exact - 1.0).abs() < 1e-12, "{n}: {found} {exact}");
        }
    }
}
