//! What plates and periodic images do to the flow that a particle sits in.

use std::f64::consts::PI;

/// Sum of `1/r^3` over a square lattice of unit spacing without the origin, `4 zeta(3/2) beta(3/2)`.
const LATTICE_SUM: f64 = 9.033_621_683_1;
/// Waves that are summed each way; they fall off with `exp(-k H)`.
const WAVES: i32 = 12;

/// Rate of strain xy at a particle of stresslet S half way between plates at rest, `height` apart across y, by its own images
/// in them and those of its neighbours at a distance `period` along x and z, in units of `S/(viscosity height^3)`; `period` is
/// in heights.
///
/// Stokes flow of a force dipole `S_xy = S_yx`: waves along the plates, each with the homogeneous flow that brings it to rest
/// on them; the mean flow `S y/(H L^2)`; and neighbours in the plane of the particle, each of which strains by `-3 S x^2/(8 pi r^5)`.
/// A single particle between plates has Shapira's and Haber's 5.6996 (Int. J. Multiphase Flow 16, 305, 1990).
pub fn strain_of_images(period: f64) -> f64 {
    let waves = (f64::from(WAVES) * period).ceil() as i32;
    let mut sum = 0.0;
    for i in -waves..=waves {
        for j in -waves..=waves {
            let (kx, kz) = (2.0 * PI * f64::from(i) / period, 2.0 * PI * f64::from(j) / period);
            let k = kx.hypot(kz);
            let q = 0.5 * k;
            if k == 0.0 || q > 2.0 * f64::from(WAVES) {
                continue;
            }
            let (s, c) = (q.sinh(), q.cosh());
            let det = c * s + q;
            // v = i (a cosh ky + d k y sinh ky) across, and the shear of the wave across itself.
            let a = -0.5 * q * q / det;
            let d = 0.5 * (-(1.0 - q) * c + q * s) * (-q).exp() / det;
            let shear = 0.5 * (-q).exp() / s;
            sum += 0.5 * k * (-2.0 * (a + d) * (kx / k).powi(2) + shear * (kz / k).powi(2));
        }
    }
    (sum + 0.5) / period.powi(2) - 3.0 / (16.0 * PI) * LATTICE_SUM / period.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// D of a drop half way between plates rises by `5.6996 (1 + 2.5 l)/(1 + l) (a/H)^3`; its stresslet is
    /// `2 pi/3 (5 l + 2)/(l + 1)` viscosities times rate times a^3, and the strain of the shear is half of its rate.
    #[test]
    fn one_particle_between_plates() {
        let rise = 2.0 * 20.0 / 3.0 * PI * 0.5 * strain_of_images(8.0);
        assert!((rise / (2.5 * 5.6996) - 1.0).abs() < 1e-3, "{rise}");
    }
}
