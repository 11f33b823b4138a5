//! Discrete Fourier transform of any length, by its prime factors.

use lbm_ibm_coupling::nalgebra::Complex;

/// Transforms of one length and direction.
#[derive(Clone, Debug)]
pub(super) struct Fourier {
    /// `exp(sign 2 pi i j / n)`.
    roots: Vec<Complex<f64>>,
}

impl Fourier {
    /// Unscaled transforms of `n` values with kernel `exp(sign 2 pi i jk / n)`.
    pub fn new(n: usize, sign: f64) -> Self {
        let angle = |j: usize| sign * 2.0 * std::f64::consts::PI * j as f64 / n as f64;
        Self {
            roots: (0..n).map(|j| Complex::new(angle(j).cos(), angle(j).sin())).collect(),
        }
    }

    /// Transforms a field of n^3 values, x fastest, along all axes.
    pub fn transform_cube(&self, field: &mut [Complex<f64>]) {
        let n = self.roots.len();
        let mut line = vec![Complex::default(); n];
        let mut out = line.clone();
        let mut column = line.clone();
        for stride in [1, n, n * n] {
            for a in 0..n * n {
                let start = a % stride + a / stride * stride * n;
                for (i, v) in line.iter_mut().enumerate() {
                    *v = field[start + i * stride];
                }
                self.transform(&line, 1, &mut out, &mut column);
                for (i, v) in out.iter().enumerate() {
                    field[start + i * stride] = *v;
                }
            }
        }
    }

    /// Decimation in time: `p` transforms of every `p`-th value, combined.
    fn transform(&self, line: &[Complex<f64>], step: usize, out: &mut [Complex<f64>], column: &mut [Complex<f64>]) {
        let (n, all) = (out.len(), self.roots.len());
        if n == 1 {
            out[0] = line[0];
            return;
        }
        let p = (2..=n).find(|p| n % p == 0).unwrap_or(n);
        let m = n / p;
        for (q, part) in out.chunks_exact_mut(m).enumerate() {
            self.transform(&line[q * step..], step * p, part, column);
        }
        for k in 0..m {
            for q in 0..p {
                column[q] = out[q * m + k] * self.roots[q * k * step];
            }
            for r in 0..p {
                out[r * m + k] = (0..p).map(|q| column[q] * self.roots[q * r % p * (all / p)]).sum();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_sum_and_inverts() {
        let n = 30;
        let line: Vec<_> = (0..n).map(|i| Complex::new((i as f64).sin(), 0.3 * i as f64)).collect();
        let (forward, backward) = (Fourier::new(n, -1.0), Fourier::new(n, 1.0));
        let (mut out, mut back, mut column) = (line.clone(), line.clone(), line.clone());
        forward.transform(&line, 1, &mut out, &mut column);
        for k in 0..n {
            let sum: Complex<f64> = (0..n).map(|j| line[j] * forward.roots[j * k % n]).sum();
            assert!((sum - out[k]).norm() < 1e-11);
        }
        backward.transform(&out, 1, &mut back, &mut column);
        assert!((0..n).all(|i| (back[i] / n as f64 - line[i]).norm() < 1e-13));
    }
}
