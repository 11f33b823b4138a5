//! Where magnetic fields come from.

mod batch;
mod cuboid;
mod current_loop;
mod dipole;
mod quadrature;
mod sheet;
mod sum;
mod uniform;

pub use cuboid::Cuboid;
pub use current_loop::CurrentLoop;
pub use dipole::{MagnetisedSphere, PointDipole};
pub use sheet::{ChargeSheet, SheetPair};
pub use sum::Sum;
pub use uniform::Uniform;

use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::sync::Arc;

/// A source of magnetic flux density.
///
/// `gradient` is the matrix `G[(i, j)] = dB_i/dx_j` (T/m); outside of magnets and currents it is symmetric and without
/// trace. Both are finite for every finite point: where the field has no value (on an edge, on a wire, at a dipole) a
/// source says in its own words what it returns.
///
/// ```
/// use lbm_ibm_coupling::{Vec3, nalgebra::Matrix3};
/// use lbm_ibm_magnetics::FieldSource;
///
/// /// B = g (x, 0, -z).
/// struct Quadrupole(f64);
///
/// impl FieldSource for Quadrupole {
///     fn field(&self, x: Vec3, _t: f64) -> Vec3 {
///         self.0 * Vec3::new(x.x, 0.0, -x.z)
///     }
///     fn gradient(&self, _x: Vec3, _t: f64) -> Matrix3<f64> {
///         self.0 * Matrix3::from_diagonal(&Vec3::new(1.0, 0.0, -1.0))
///     }
/// }
/// ```
pub trait FieldSource: Send + Sync {
    /// Flux density B (T) at `x` (m) and time `t` (s).
    fn field(&self, x: Vec3, t: f64) -> Vec3;

    /// Gradient dB_i/dx_j (T/m) at `x` (m) and time `t` (s).
    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64>;

    /// Both at once; a source that shares work between them overrides it.
    fn field_and_gradient(&self, x: Vec3, t: f64) -> (Vec3, Matrix3<f64>) {
        (self.field(x, t), self.gradient(x, t))
    }

    /// B (T) at many points; `b` is resized to their number.
    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        b.resize(x.len());
        for i in 0..x.len() {
            b.set(i, self.field(x.get(i), t));
        }
    }

    /// B (T) and its gradient (T/m) at many points; `b` and `g` are resized to their number.
    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        b.resize(x.len());
        g.resize(x.len(), Matrix3::zeros());
        for i in 0..x.len() {
            let (field, gradient) = self.field_and_gradient(x.get(i), t);
            b.set(i, field);
            g[i] = gradient;
        }
    }
}

impl<S: FieldSource + ?Sized> FieldSource for Arc<S> {
    fn field(&self, x: Vec3, t: f64) -> Vec3 {
        (**self).field(x, t)
    }
    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64> {
        (**self).gradient(x, t)
    }
    fn field_and_gradient(&self, x: Vec3, t: f64) -> (Vec3, Matrix3<f64>) {
        (**self).field_and_gradient(x, t)
    }
    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        (**self).fields(x, t, b);
    }
    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        (**self).fields_and_gradients(x, t, b, g);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MU0;

    fn sources() -> Vec<(&'static str, Box<dyn FieldSource>)> {
        let turned = Vec3::new(0.6, 0.8, 0.0);
        let across = Vec3::new(-0.8, 0.6, 0.0);
        vec![
            (
                "sheet",
                Box::new(ChargeSheet::new(Vec3::new(0.1, 0.0, -0.2), turned, across * 0.4, 0.7).unwrap()),
            ),
            (
                "cuboid",
                Box::new(
                    Cuboid::new(
                        Vec3::new(0.1, 0.2, -0.2),
                        Vec3::new(0.5, 0.3, 0.8),
                        Vec3::new(0.3, -0.7, 1.1),
                    )
                    .unwrap()
                    .with_rotation(lbm_ibm_coupling::nalgebra::Rotation3::from_euler_angles(0.3, 0.5, -1.0)),
                ),
            ),
            (
                "dipole",
                Box::new(PointDipole::new(
                    Vec3::new(0.1, 0.0, 0.0),
                    Vec3::new(1.0, 2.0, -0.5) / MU0,
                )),
            ),
            (
                "sphere",
                Box::new(MagnetisedSphere::new(Vec3::zeros(), 0.7, Vec3::new(0.2, 0.1, 1.0)).unwrap()),
            ),
            (
                "loop",
                Box::new(
                    CurrentLoop::new(Vec3::new(0.0, 0.1, 0.0), Vec3::new(0.3, -0.2, 1.0), 0.9, 3.0 / MU0).unwrap(),
                ),
            ),
        ]
    }

    #[test]
    fn fields_have_no_divergence_and_no_curl_and_the_gradient_is_their_derivative() {
        let mut seed = 17u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for (name, source) in sources() {
            for k in 0..200 {
                let x = Vec3::new(random(), random(), random()) * [2.0, 8.0, 60.0, 4000.0][k % 4];
                let h = 1e-3 * x.norm().max(0.1);
                let g = source.gradient(x, 0.0);
                let scale = g.norm().max(source.field(x, 0.0).norm() / x.norm());
                assert!(g.trace().abs() < 1e-12 * scale, "{name} div {}", g.trace());
                assert!((g - g.transpose()).norm() < 1e-12 * scale, "{name} curl at {x:?}");
                let mut fd = Matrix3::zeros();
                for a in 0..3 {
                    let e = Vec3::ith(a, h);
                    let f = |s: f64| source.field(x + e * s, 0.0);
                    let d = (f(1.0) - f(-1.0)) * (8.0 / 12.0) - (f(2.0) - f(-2.0)) / 12.0;
                    fd.set_column(a, &(d / h));
                }
                // Steps that come near an edge or cross a face are no measure of the derivative.
                let near = x.norm() < 2.0;
                if !near {
                    assert!(
                        (fd - g).norm() < 2e-8 * scale,
                        "{name} gradient at {x:?}: {fd} against {g}"
                    );
                }
            }
        }
    }

    #[test]
    fn no_point_gives_a_field_that_is_not_finite() {
        let steps = [
            -1.0, -0.9, -0.7, -0.5, -0.3, 0.0, 0.1, 0.3, 0.4, 0.5, 0.7, 0.8, 0.9, 1.0, 1e30,
        ];
        let plain = Cuboid::new(Vec3::zeros(), Vec3::new(0.5, 0.3, 0.8), Vec3::new(0.3, -0.7, 1.1)).unwrap();
        let sheet = ChargeSheet::new(Vec3::zeros(), Vec3::x(), Vec3::y() * 0.4, 1.0).unwrap();
        let ring = CurrentLoop::new(Vec3::zeros(), Vec3::z(), 0.9, 1.0).unwrap();
        let mut all = sources();
        all.push(("plain cuboid", Box::new(plain)));
        all.push(("plain sheet", Box::new(sheet)));
        all.push(("plain loop", Box::new(ring)));
        for (name, source) in all {
            for x in steps {
                for y in steps {
                    for z in steps {
                        let (b, g) = source.field_and_gradient(Vec3::new(x, y, z), 0.0);
                        assert!(b.iter().chain(g.iter()).all(|v| v.is_finite()), "{name} at {x} {y} {z}");
                    }
                }
            }
        }
    }

    #[test]
    fn far_away_every_magnet_is_its_dipole_to_the_last_digits() {
        let direction = Vec3::new(0.48, -0.6, 0.64);
        for (name, source) in sources() {
            if name == "sheet" {
                continue;
            }
            // B r^3 of a body of moment m: its change with distance falls as the quadrupole, then the octupole.
            for far in [1e4, 1e6] {
                let shape = |d: f64| source.field(direction * d, 0.0) * d.powi(3);
                let relative = (shape(far) - shape(10.0 * far)).norm() / shape(far).norm();
                assert!(relative < 3.0 / far, "{name}: {relative:e} at {far:e}");
            }
        }
    }
}
