//! The point dipole, and the sphere that is one from outside.

use super::FieldSource;
use super::batch::{self, Batch, Eight};
use crate::MU0;
use crate::error::{MagneticsError, positive};
use crate::kernel::lanes::{Isa, Lanes, dot, minus, same};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};

/// Closer to a point dipole than this (m) its field is reported as zero, the mean over a small ball.
const CORE: f64 = 1e-12;

/// A point dipole: B = mu0/(4 pi r^3) (3 (m.n) n - m). Within 1e-12 m of it the field is reported as zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointDipole {
    /// Where it is, m.
    pub position: Vec3,
    /// Its moment, A m2.
    pub moment: Vec3,
}

impl PointDipole {
    /// A dipole of `moment` (A m2) at `position` (m).
    pub fn new(position: Vec3, moment: Vec3) -> Self {
        Self { position, moment }
    }
}

/// Field (T) of a dipole `m` (A m2) at distance vector `r` (m).
pub(crate) fn dipole_field(m: Vec3, r: Vec3) -> Vec3 {
    let r2 = r.norm_squared();
    let d = r2.sqrt();
    let n = r / d;
    (n * (3.0 * m.dot(&n)) - m) * (MU0 / (4.0 * std::f64::consts::PI) / d / r2)
}

/// Gradient dB_i/dx_j (T/m) of the field of a dipole `m` (A m2) at distance vector `r` (m).
pub(crate) fn dipole_gradient(m: Vec3, r: Vec3) -> Matrix3<f64> {
    let r2 = r.norm_squared();
    let n = r / r2.sqrt();
    let mn = m.dot(&n);
    let mixed = m * n.transpose();
    let g = (Matrix3::identity() - 5.0 * n * n.transpose()) * mn + mixed + mixed.transpose();
    g * (3.0 * MU0 / (4.0 * std::f64::consts::PI) / r2 / r2)
}

impl FieldSource for PointDipole {
    fn field(&self, x: Vec3, _t: f64) -> Vec3 {
        let r = x - self.position;
        if r.norm() < CORE {
            return Vec3::zeros();
        }
        dipole_field(self.moment, r)
    }

    fn gradient(&self, x: Vec3, _t: f64) -> Matrix3<f64> {
        let r = x - self.position;
        if r.norm() < CORE {
            return Matrix3::zeros();
        }
        dipole_gradient(self.moment, r)
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        batch::fields(self, x, t, b);
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        batch::fields_and_gradients(self, x, t, b, g);
    }
}

/// A uniformly magnetised sphere: outside a dipole, inside B = 2/3 J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MagnetisedSphere {
    centre: Vec3,
    radius: f64,
    polarisation: Vec3,
}

impl MagnetisedSphere {
    /// A sphere about `centre` (m) of `radius` (m) and polarisation J = mu0 M (T).
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the radius.
    pub fn new(centre: Vec3, radius: f64, polarisation: Vec3) -> Result<Self, MagneticsError> {
        Ok(Self {
            centre,
            radius: positive("radius of the sphere (m)", radius)?,
            polarisation,
        })
    }

    /// Its moment, A m2.
    pub fn moment(&self) -> Vec3 {
        self.polarisation * (4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3) / MU0)
    }
}

impl FieldSource for MagnetisedSphere {
    fn field(&self, x: Vec3, _t: f64) -> Vec3 {
        let r = x - self.centre;
        if r.norm() < self.radius {
            return self.polarisation * (2.0 / 3.0);
        }
        dipole_field(self.moment(), r)
    }

    fn gradient(&self, x: Vec3, _t: f64) -> Matrix3<f64> {
        let r = x - self.centre;
        if r.norm() < self.radius {
            return Matrix3::zeros();
        }
        dipole_gradient(self.moment(), r)
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        batch::fields(self, x, t, b);
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        batch::fields_and_gradients(self, x, t, b, g);
    }
}

/// Field and gradient of a dipole `m` (A m2) at `centre` (m); nearer than `core` (m) the source is asked.
#[inline(always)]
fn eight<I: Isa, const GRADIENT: bool>(isa: I, x: [I::V; 3], centre: Vec3, m: Vec3, core: f64) -> Eight<I::V> {
    let r = minus(x, same(isa, centre));
    let m = same(isa, m * (MU0 / (4.0 * std::f64::consts::PI)));
    let r2 = dot(r, r);
    let mut out = Eight::zero(isa);
    out.special = I::V::select(r2.less(isa.splat(1.0001 * core * core)), isa.splat(1.0), out.special);
    // Beyond the range of powers of r the source is asked, too.
    out.special = I::V::select(isa.splat(1e30).less(r2), isa.splat(1.0), out.special);
    let inverse2 = isa.splat(1.0) / r2;
    let inverse3 = inverse2 * inverse2.sqrt();
    let pull = dot(m, r) * inverse3 * inverse2;
    let w = isa.splat(3.0) * pull;
    for c in 0..3 {
        out.field[c] = w * r[c] - inverse3 * m[c];
    }
    if GRADIENT {
        let turn = isa.splat(3.0) * inverse3 * inverse2;
        let away = isa.splat(-15.0) * pull * inverse2;
        let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        for k in 0..6 {
            let (a, b) = pairs[k];
            let mixed = m[a].mul_add(r[b], m[b] * r[a]);
            let g = (away * r[a]).mul_add(r[b], turn * mixed);
            out.gradient[k] = if a == b { g + w } else { g };
        }
    }
    out
}

impl Batch for PointDipole {
    #[inline(always)]
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V> {
        eight::<I, GRADIENT>(isa, x, self.position, self.moment, CORE)
    }
}

impl Batch for MagnetisedSphere {
    #[inline(always)]
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V> {
        eight::<I, GRADIENT>(isa, x, self.centre, self.moment(), self.radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_normal_field_is_continuous_at_the_surface_of_a_sphere() {
        let sphere = MagnetisedSphere::new(Vec3::zeros(), 2e-6, Vec3::new(0.1, 0.3, 1.0)).unwrap();
        let n = Vec3::new(0.48, 0.6, 0.64);
        let inside = sphere.field(n * 2e-6 * (1.0 - 1e-12), 0.0).dot(&n);
        let outside = sphere.field(n * 2e-6 * (1.0 + 1e-12), 0.0).dot(&n);
        assert_relative_eq!(inside, outside, max_relative = 1e-10);
        assert!(MagnetisedSphere::new(Vec3::zeros(), 0.0, n).is_err());
    }
}
