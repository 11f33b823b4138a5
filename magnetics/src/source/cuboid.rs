//! A block magnet.

use super::batch::{self, Batch, Eight, to_frame};
use super::dipole::{dipole_field, dipole_gradient};
use super::quadrature::gauss;
use super::{ChargeSheet, FieldSource};
use crate::MU0;
use crate::error::{MagneticsError, positive};
use crate::kernel::lanes::{Isa, Lanes, dot};
use lbm_ibm_coupling::nalgebra::{Matrix3, Rotation3};
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};

/// Beyond this many half lengths the magnet is summed as dipoles: its charges would cancel in the last digits.
const FAR: f64 = 20.0;

/// A cuboid of uniform polarisation J (T) in any direction: six [`ChargeSheet`]s of density J.n, and J inside.
///
/// Returns B = mu0 (H + M), with on a face the mean of both sides. Beyond 20 half lengths Gauss quadrature of dipoles.
#[derive(Clone, Debug, PartialEq)]
pub struct Cuboid {
    centre: Vec3,
    half: Vec3,
    polarisation: Vec3,
    rotation: Rotation3<f64>,
    faces: Vec<ChargeSheet>,
}

impl Cuboid {
    /// A block about `centre` (m) with half edges `half` (m) along x, y, z and polarisation J = mu0 M (T).
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for an edge.
    pub fn new(centre: Vec3, half: Vec3, polarisation: Vec3) -> Result<Self, MagneticsError> {
        for a in 0..3 {
            positive("half edge of the cuboid (m)", half[a])?;
        }
        let mut faces = Vec::new();
        for a in (0..3).filter(|a| polarisation[*a] != 0.0) {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            for side in [-1.0, 1.0] {
                let place = Vec3::ith(a, side * half[a]);
                let (u, v) = (Vec3::ith(b, half[b]), Vec3::ith(c, half[c]));
                faces.push(ChargeSheet::new(place, u, v, side * polarisation[a])?);
            }
        }
        Ok(Self {
            centre,
            half,
            polarisation,
            rotation: Rotation3::identity(),
            faces,
        })
    }

    /// Turns the block and its polarisation about its centre.
    pub fn with_rotation(mut self, rotation: Rotation3<f64>) -> Self {
        self.rotation = rotation;
        self
    }

    /// One inside, a half on a face, zero outside.
    fn inside(&self, p: Vec3) -> f64 {
        (0..3)
            .map(|a| match p[a].abs() - self.half[a] {
                d if d < 0.0 => 1.0,
                0.0 => 0.5,
                _ => 0.0,
            })
            .product()
    }

    fn far(&self, p: Vec3) -> (Vec3, Matrix3<f64>) {
        let points = match p.norm() / self.half.max() {
            h if h > 1e4 => 2,
            h if h > 200.0 => 3,
            _ => 5,
        };
        let rule = gauss(points);
        let moment = self.polarisation * (self.half.product() / MU0);
        let (mut b, mut g) = (Vec3::zeros(), Matrix3::zeros());
        for (x, wx) in rule {
            for (y, wy) in rule {
                for (z, wz) in rule {
                    let r = p - self.half.component_mul(&Vec3::new(*x, *y, *z));
                    let m = moment * (wx * wy * wz);
                    b += dipole_field(m, r);
                    g += dipole_gradient(m, r);
                }
            }
        }
        (b, g)
    }
}

impl FieldSource for Cuboid {
    fn field(&self, x: Vec3, t: f64) -> Vec3 {
        self.field_and_gradient(x, t).0
    }

    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64> {
        self.field_and_gradient(x, t).1
    }

    fn field_and_gradient(&self, x: Vec3, t: f64) -> (Vec3, Matrix3<f64>) {
        let p = self.rotation.inverse_transform_vector(&(x - self.centre));
        let (b, g) = if p.norm() > FAR * self.half.max() {
            self.far(p)
        } else {
            let start = (self.polarisation * self.inside(p), Matrix3::zeros());
            self.faces.iter().fold(start, |(b, g), face| {
                let (db, dg) = face.field_and_gradient(p, t);
                (b + db, g + dg)
            })
        };
        let turn = self.rotation.matrix();
        (turn * b, turn * g * turn.transpose())
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        batch::fields(self, x, t, b);
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        batch::fields_and_gradients(self, x, t, b, g);
    }
}

impl Batch for Cuboid {
    #[inline(always)]
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V> {
        let (zero, one) = (isa.splat(0.0), isa.splat(1.0));
        let p = to_frame(isa, x, self.centre, self.rotation.matrix());
        let mut sum = Eight::zero(isa);
        for face in &self.faces {
            let part = face.eight::<I, GRADIENT>(isa, p);
            sum = sum.plus(part);
        }
        // Of its faces a point may be far for one alone: what is far is said of the block.
        let far2 = isa.splat((FAR * self.half.max()).powi(2));
        sum.special = I::V::select(far2.less(dot(p, p)), one, sum.special);
        let mut inside = one;
        for c in 0..3 {
            inside = I::V::select(p[c].abs().less(isa.splat(self.half[c])), inside, zero);
        }
        for c in 0..3 {
            sum.field[c] = inside.mul_add(isa.splat(self.polarisation[c]), sum.field[c]);
        }
        sum.turned::<I, GRADIENT>(isa, self.rotation.matrix())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_cube_has_the_field_of_its_demagnetisation_factor_at_the_centre_and_continuous_flux() {
        let j = Vec3::new(0.4, -0.2, 1.0);
        let cube = Cuboid::new(Vec3::zeros(), Vec3::repeat(1e-3), j).unwrap();
        assert_relative_eq!(cube.field(Vec3::zeros(), 0.0), j * (2.0 / 3.0), epsilon = 1e-14);
        let p = Vec3::new(0.3e-3, -0.2e-3, 1e-3);
        let jump = |s: f64| cube.field(p + Vec3::z() * s, 0.0);
        assert_relative_eq!(jump(1e-12).z, jump(-1e-12).z, epsilon = 1e-8);
        assert_relative_eq!(jump(0.0), (jump(1e-12) + jump(-1e-12)) * 0.5, epsilon = 1e-8);
    }

    #[test]
    fn charges_and_dipoles_agree_where_they_meet() {
        let block = Cuboid::new(Vec3::zeros(), Vec3::new(1.0, 0.5, 0.7), Vec3::new(0.4, -0.2, 1.0)).unwrap();
        let p = Vec3::new(0.48, 0.6, 0.64) * 19.9;
        let (b, g) = block.far(p);
        let (c, h) = block.field_and_gradient(p, 0.0);
        assert_relative_eq!(b, c, epsilon = 1e-13 * b.norm());
        assert_relative_eq!(g, h, epsilon = 2e-12 * g.norm());
    }
}
