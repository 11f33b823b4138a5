//! Irregular solid harmonics.

use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::Complex;

/// I_lm = (l-m)! r^(-l-1) P_lm(cos theta) exp(i m phi) with the Condon-Shortley phase, to `order`, m >= 0, at l(l+1)/2 + m.
///
/// In this scaling the translation theorem has no coefficients, I_lm(R + r) = sum (-1)^(n+k) I_(l+n, m-k)(R) R_nk(r) with
/// R_nk = r^n P_nk exp(i k phi)/(n+k)!, and negative m are I_(l,-m) = (-1)^m conj(I_lm).
pub(super) fn irregular(order: usize, r: Vec3) -> Vec<Complex<f64>> {
    let inverse2 = 1.0 / r.norm_squared();
    let (z, xy) = (r.z * inverse2, Complex::new(-r.x * inverse2, -r.y * inverse2));
    let at = |l: usize, m: usize| l * (l + 1) / 2 + m;
    let mut out = vec![Complex::new(0.0, 0.0); at(order, order) + 1];
    out[0].re = inverse2.sqrt();
    for m in 0..=order {
        if m > 0 {
            out[at(m, m)] = xy * out[at(m - 1, m - 1)] * (2 * m - 1) as f64;
        }
        if m < order {
            out[at(m + 1, m)] = out[at(m, m)] * ((2 * m + 1) as f64 * z);
        }
        for l in m + 2..=order {
            let above = out[at(l - 1, m)] * ((2 * l - 1) as f64 * z);
            let second = ((l - 1) * (l - 1) - m * m) as f64 * inverse2;
            out[at(l, m)] = above - out[at(l - 2, m)] * second;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_of_one_over_r_are_the_harmonics() {
        // (d/dz)^l 1/r = (-1)^l I_l0, (d/dx + i d/dy) 1/r = I_11.
        let r = Vec3::new(0.3, -0.5, 0.9);
        let i = irregular(3, r);
        let d = r.norm();
        assert!((i[1].re - r.z / d.powi(3)).abs() < 1e-14);
        assert!((i[2] - Complex::new(-r.x, -r.y) / d.powi(3)).norm() < 1e-14);
        let second = 3.0 * r.z * r.z / d.powi(5) - 1.0 / d.powi(3);
        assert!((i[3].re - second).abs() < 1e-13);
    }
}
