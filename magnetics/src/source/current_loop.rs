//! A circular current.

mod many;

use super::{FieldSource, batch};
use crate::MU0;
use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::f64::consts::{PI, TAU};

/// Points of the trapezoid rule: its error is below 1e-15 wherever it is used.
const POINTS: usize = 40;
/// Below this (R^2 + rho^2 + z^2)/(2 R rho) the point is near the wire, and elliptic integrals take over.
const NEAR: f64 = 1.5;
/// Closer to the wire than this fraction of the radius the field is that at this distance.
const WIRE: f64 = 1e-9;

/// A circular loop of current.
///
/// With D = R^2 + rho^2 + z^2 - 2 R rho cos(phi), B_rho = mu0 I R z/(4 pi) int cos(phi) D^(-3/2) dphi and B_z =
/// mu0 I R/(4 pi) int (R - rho cos(phi)) D^(-3/2) dphi (Biot and Savart). Near the wire these are complete elliptic
/// integrals, by the arithmetic-geometric mean; elsewhere the trapezoid rule, which for a periodic integrand is exact to
/// rounding, summed in pairs so that neither the axis nor a far point loses digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurrentLoop {
    centre: Vec3,
    axis: Vec3,
    radius: f64,
    current: f64,
}

/// The integrals over phi: a = int D^(-3/2), b = int cos D^(-3/2) / rho, c = int D^(-5/2), d = int cos D^(-5/2) / rho.
struct Integrals {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
}

impl CurrentLoop {
    /// A loop about `centre` (m) of `radius` (m) that carries `current` (A), right-handed about `axis` (any length).
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the radius or the length of the axis.
    pub fn new(centre: Vec3, axis: Vec3, radius: f64, current: f64) -> Result<Self, MagneticsError> {
        positive("length of the axis", axis.norm())?;
        Ok(Self {
            centre,
            axis: axis.normalize(),
            radius: positive("radius of the loop (m)", radius)?,
            current,
        })
    }

    fn integrals(&self, rho: f64, z: f64) -> Integrals {
        let sum = self.radius.powi(2) + rho * rho + z * z;
        let product = 2.0 * self.radius * rho;
        if sum < NEAR * product {
            self.near_wire(rho, z)
        } else {
            self.trapezoid(rho, sum)
        }
    }

    fn near_wire(&self, rho: f64, z: f64) -> Integrals {
        let r = self.radius;
        let near2 = ((r - rho).powi(2) + z * z).max((WIRE * r).powi(2));
        let q = 2.0 * r * rho;
        let (p, far2) = (near2 + q, near2 + 2.0 * q);
        let (k, e) = elliptic((near2 / far2).sqrt());
        let far = far2.sqrt();
        let one = 4.0 * k / far;
        let three = 4.0 * e / (near2 * far);
        let five = (4.0 * p * three - one) / (3.0 * near2 * far2);
        Integrals {
            a: three,
            b: (p * three - one) / q / rho,
            c: five,
            d: (p * five - three) / q / rho,
        }
    }

    fn trapezoid(&self, rho: f64, sum: f64) -> Integrals {
        let mut out = Integrals {
            a: 0.0,
            b: 0.0,
            c: 0.0,
            d: 0.0,
        };
        let weight = TAU / POINTS as f64;
        for k in 0..POINTS / 4 {
            // phi and pi - phi, and both mirrored at the x axis.
            let cos = ((k as f64 + 0.5) * weight).cos();
            let half = 2.0 * self.radius * cos;
            let (near, far) = (sum - half * rho, sum + half * rho);
            let (s, t) = (near.sqrt(), far.sqrt());
            let (u, v) = (1.0 / s, 1.0 / t);
            let gap = 2.0 * half * u * v / (s + t);
            let (u3, v3) = (u * u * u, v * v * v);
            out.a += u3 + v3;
            out.b += cos * gap * (u * u + u * v + v * v);
            out.c += u3 * u * u + v3 * v * v;
            out.d += cos * gap * (u * u * u * u + u3 * v + u * u * v * v + u * v3 + v * v * v * v);
        }
        for value in [&mut out.a, &mut out.b, &mut out.c, &mut out.d] {
            *value *= 2.0 * weight;
        }
        out
    }
}

/// Complete elliptic integrals K and E for the complementary modulus kc, by the arithmetic-geometric mean.
fn elliptic(kc: f64) -> (f64, f64) {
    let (mut a, mut b) = (1.0, kc);
    let mut excess = (1.0 - kc * kc) / 2.0;
    let mut power = 0.5;
    while (a - b) / a > 1e-9 {
        let c = (a - b) / 2.0;
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
        power *= 2.0;
        excess += power * c * c;
    }
    let mean = (a + b) / 2.0;
    let k = PI / (2.0 * mean);
    (k, k * (1.0 - excess))
}

impl FieldSource for CurrentLoop {
    fn field(&self, x: Vec3, t: f64) -> Vec3 {
        self.field_and_gradient(x, t).0
    }

    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64> {
        self.field_and_gradient(x, t).1
    }

    fn field_and_gradient(&self, x: Vec3, _t: f64) -> (Vec3, Matrix3<f64>) {
        let (r, n) = (self.radius, self.axis);
        let p = x - self.centre;
        let z = p.dot(&n);
        let across = p - n * z;
        let rho = across.norm();
        let i = self.integrals(rho, z);
        let scale = MU0 * self.current * r / (4.0 * PI);
        // B_rho/rho, B_z and their derivatives; d(B_rho)/dz = d(B_z)/drho without a current at the point.
        let outward = z * i.b;
        let axial = r * i.a - rho * rho * i.b;
        let axial_z = -3.0 * z * (r * i.c - rho * rho * i.d);
        let outward_rho = -axial_z - outward;
        let mixed = i.b - 3.0 * z * z * i.d;
        let field = across * outward + n * axial;
        let radial = if rho > 0.0 { across / rho } else { Vec3::zeros() };
        let rr = radial * radial.transpose();
        let nn = n * n.transpose();
        let turn = across * n.transpose();
        let g = (Matrix3::identity() - nn - rr) * outward
            + rr * if rho > 0.0 { outward_rho } else { 0.0 }
            + nn * axial_z
            + (turn + turn.transpose()) * mixed;
        (field * scale, g * scale)
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        batch::fields(self, x, t, b);
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        batch::fields_and_gradients(self, x, t, b, g);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn on_the_axis_the_textbook_formula() {
        let ring = CurrentLoop::new(Vec3::zeros(), Vec3::z(), 2.0, 5.0).unwrap();
        for z in [0.0f64, 0.3, 2.0, 50.0] {
            let expected = MU0 * 5.0 * 4.0 / (2.0 * (4.0 + z * z).powf(1.5));
            assert_relative_eq!(ring.field(Vec3::z() * z, 0.0).z, expected, max_relative = 1e-14);
        }
    }

    #[test]
    fn elliptic_integrals_have_tabulated_values() {
        // K and E at k^2 = 1/2 (Abramowitz and Stegun, table 17.1).
        let (k, e) = elliptic(0.5f64.sqrt());
        assert_relative_eq!(k, 1.854_074_677_301_372, max_relative = 1e-15);
        assert_relative_eq!(e, 1.350_643_881_047_675_5, max_relative = 1e-15);
    }

    #[test]
    fn wire_and_trapezoid_agree_where_they_meet() {
        let ring = CurrentLoop::new(Vec3::zeros(), Vec3::z(), 1.0, 1.0).unwrap();
        for (rho, z) in [(0.382, 0.01), (1.2, 1.0763), (2.618, 0.0)] {
            let (u, v) = (ring.near_wire(rho, z), ring.trapezoid(rho, 1.0 + rho * rho + z * z));
            assert_relative_eq!(u.a, v.a, max_relative = 1e-13);
            assert_relative_eq!(u.b, v.b, max_relative = 1e-13);
            assert_relative_eq!(u.c, v.c, max_relative = 1e-13);
            assert_relative_eq!(u.d, v.d, max_relative = 1e-13);
        }
    }
}
