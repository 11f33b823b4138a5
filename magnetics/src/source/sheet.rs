//! Rectangular sheets of magnetic charge: a face of a magnet, and the paper's pair.

mod batch;

use super::quadrature::gauss;
use super::{FieldSource, batch as many};
use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::f64::consts::PI;

/// Beyond this many half lengths the charge is summed by quadrature.
const FAR: f64 = 10.0;
/// Closer to an edge than this fraction of its length the field is that at this distance.
const EDGE: f64 = 1e-9;

/// A rectangle with uniform magnetic surface charge, mu0 sigma (T): one pole face of a magnet of polarisation J = mu0 sigma.
///
/// With u, v, Z the local coordinates from a corner, r^2 = u^2 + v^2 + Z^2 and signs alternating over the corners,
/// B = mu0 sigma/(4 pi) sum (-1)^(i+j) (-ln(v+r), -ln(u+r), arctan(uv/(Zr))); the logarithms of an edge are taken
/// together as ln((r1+r2+l)/(r1+r2-l)), which loses no digits. Beyond 10 half lengths Gauss quadrature of the charge.
/// On the sheet itself the normal component is the mean of both sides; on an edge, where the field is infinite, it is
/// the field at 1e-9 of the edge's length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChargeSheet {
    centre: Vec3,
    axes: Matrix3<f64>,
    half: [f64; 2],
    density: f64,
}

impl ChargeSheet {
    /// A sheet about `centre` (m) with half edges `u` and `v` (m, orthogonal) and charge density mu0 sigma (T).
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for an edge, [`MagneticsError::NotOrthogonal`].
    pub fn new(centre: Vec3, u: Vec3, v: Vec3, density: f64) -> Result<Self, MagneticsError> {
        let (a, b) = (u.norm(), v.norm());
        positive("half edge of the sheet (m)", a)?;
        positive("half edge of the sheet (m)", b)?;
        let (e1, e2) = (u / a, v / b);
        if e1.dot(&e2).abs() > 1e-9 {
            return Err(MagneticsError::NotOrthogonal {
                degrees: e1.dot(&e2).acos().to_degrees(),
            });
        }
        let n = e1.cross(&e2).normalize();
        Ok(Self {
            centre,
            axes: Matrix3::from_columns(&[e1, n.cross(&e1), n]),
            half: [a, b],
            density,
        })
    }

    fn local(&self, p: Vec3) -> (Vec3, Matrix3<f64>) {
        let [a, b] = self.half;
        let scale = self.density / (4.0 * PI);
        if p.norm_squared() > (FAR * a.max(b)).powi(2) {
            let (h, g) = far(p, self.half);
            return (h * scale, g * scale);
        }
        let (u, v, z) = ([p.x + a, p.x - a], [p.y + b, p.y - b], p.z);
        let core = EDGE * a.min(b);
        let mut r = [[0.0; 2]; 2];
        for i in 0..2 {
            for j in 0..2 {
                r[i][j] = (u[i] * u[i] + v[j] * v[j] + z * z).sqrt().max(core);
            }
        }
        let along_v = [0, 1].map(|i| Edge::new(v, r[i], u[i] * u[i] + z * z, core));
        let along_u = [0, 1].map(|j| Edge::new(u, [r[0][j], r[1][j]], v[j] * v[j] + z * z, core));
        let turn = |i: usize, j: usize| {
            if z == 0.0 {
                0.0
            } else {
                (u[i] * v[j] / (z * r[i][j])).atan()
            }
        };
        let h = Vec3::new(
            along_v[1].log - along_v[0].log,
            along_u[1].log - along_u[0].log,
            (turn(0, 0) - turn(0, 1)) - (turn(1, 0) - turn(1, 1)),
        );
        let xx = u[1] * along_v[1].slope - u[0] * along_v[0].slope;
        let yy = v[1] * along_u[1].slope - v[0] * along_u[0].slope;
        let xy = (1.0 / r[1][0] - 1.0 / r[1][1]) - (1.0 / r[0][0] - 1.0 / r[0][1]);
        let xz = z * (along_v[1].slope - along_v[0].slope);
        let yz = z * (along_u[1].slope - along_u[0].slope);
        let g = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, -xx - yy);
        (h * scale, g * scale)
    }
}

/// A charged edge seen from a point: `s` to its two ends along it, `r` to them, `rho2` the square of the distance to its line.
struct Edge {
    /// ln((s0 + r0)/(s1 + r1)), the integral of 1/r along it.
    log: f64,
    /// 1/(r0 (s0 + r0)) - 1/(r1 (s1 + r1)).
    slope: f64,
}

impl Edge {
    fn new(s: [f64; 2], r: [f64; 2], rho2: f64, core: f64) -> Self {
        let length = s[0] - s[1];
        if s[0] > 0.0 && s[1] < 0.0 {
            let rho2 = rho2.max(core * core);
            let excess = rho2 * (1.0 / (r[0] + s[0]) + 1.0 / (r[1] - s[1]));
            let ratio = length / (r[0] + r[1]);
            let log = if ratio < 0.5 {
                2.0 * ratio.atanh()
            } else {
                ((r[0] + r[1] + length) / excess).ln()
            };
            return Self {
                log,
                slope: (s[1] / r[1] - s[0] / r[0]) / rho2,
            };
        }
        let end = |k: usize| 1.0 / (r[k] * (r[k] + s[k].abs()));
        let near = (r[0] + r[1]).max(length * (1.0 + EDGE));
        Self {
            log: 2.0 * (length / near).atanh(),
            slope: if s[1] >= 0.0 { end(0) - end(1) } else { end(1) - end(0) },
        }
    }
}

fn far(p: Vec3, half: [f64; 2]) -> (Vec3, Matrix3<f64>) {
    let halves = p.norm() / half[0].max(half[1]);
    let points = match halves {
        h if h > 1e4 => 2,
        h if h > 40.0 => 4,
        _ => 6,
    };
    let (mut h, mut g) = (Vec3::zeros(), Matrix3::zeros());
    for (s, ws) in gauss(points) {
        for (t, wt) in gauss(points) {
            let d = p - Vec3::new(half[0] * s, half[1] * t, 0.0);
            let length = d.norm();
            let n = d / length;
            let w = ws * wt * half[0] * half[1] / length / length;
            h += n * w;
            g += (Matrix3::identity() - 3.0 * n * n.transpose()) * (w / length);
        }
    }
    (h, g)
}

impl FieldSource for ChargeSheet {
    fn field(&self, x: Vec3, t: f64) -> Vec3 {
        self.field_and_gradient(x, t).0
    }

    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64> {
        self.field_and_gradient(x, t).1
    }

    fn field_and_gradient(&self, x: Vec3, _t: f64) -> (Vec3, Matrix3<f64>) {
        let (h, g) = self.local(self.axes.tr_mul(&(x - self.centre)));
        (self.axes * h, self.axes * g * self.axes.transpose())
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        many::fields(self, x, t, b);
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        many::fields_and_gradients(self, x, t, b, g);
    }
}

/// The paper's source: two equal horizontal sheets, one above and one below the channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetPair {
    bottom: ChargeSheet,
    top: ChargeSheet,
}

impl SheetPair {
    /// Sheets of half lengths `half` in x and y (m) at `centre` -+ `separation`/2 in z (m), the bottom one with mu0 sigma =
    /// `density` (T), the top one with the opposite charge: the field runs from the bottom to the top.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for a length.
    pub fn opposite(centre: Vec3, half: [f64; 2], separation: f64, density: f64) -> Result<Self, MagneticsError> {
        Self::new(centre, half, separation, [density, -density])
    }

    /// The same with equal charges: magnets that face each other, no field at the centre.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for a length.
    pub fn equal(centre: Vec3, half: [f64; 2], separation: f64, density: f64) -> Result<Self, MagneticsError> {
        Self::new(centre, half, separation, [density, density])
    }

    fn new(centre: Vec3, half: [f64; 2], separation: f64, density: [f64; 2]) -> Result<Self, MagneticsError> {
        let up = Vec3::z() * (0.5 * positive("separation of the sheets (m)", separation)?);
        let sheet = |c: Vec3, d: f64| ChargeSheet::new(c, Vec3::x() * half[0], Vec3::y() * half[1], d);
        Ok(Self {
            bottom: sheet(centre - up, density[0])?,
            top: sheet(centre + up, density[1])?,
        })
    }
}

impl FieldSource for SheetPair {
    fn field(&self, x: Vec3, t: f64) -> Vec3 {
        self.field_and_gradient(x, t).0
    }

    fn gradient(&self, x: Vec3, t: f64) -> Matrix3<f64> {
        self.field_and_gradient(x, t).1
    }

    fn field_and_gradient(&self, x: Vec3, t: f64) -> (Vec3, Matrix3<f64>) {
        let (b, g) = self.bottom.field_and_gradient(x, t);
        let (c, h) = self.top.field_and_gradient(x, t);
        (b + c, g + h)
    }

    fn fields(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
        many::fields(self, x, t, b);
    }

    fn fields_and_gradients(&self, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut Vec<Matrix3<f64>>) {
        many::fields_and_gradients(self, x, t, b, g);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn closed_form_and_quadrature_agree_where_they_meet() {
        let half = [1.0, 0.4];
        let sheet = ChargeSheet::new(Vec3::zeros(), Vec3::x(), Vec3::y() * 0.4, 4.0 * PI).unwrap();
        for d in [
            Vec3::new(0.48, 0.6, 0.64),
            Vec3::x(),
            Vec3::y(),
            Vec3::new(-0.6, 0.8, 0.0),
        ] {
            let p = d * 9.9999;
            let (h, g) = far(p, half);
            assert_relative_eq!(sheet.field(p, 0.0), h, epsilon = 1e-14 * 1.6);
            assert_relative_eq!(sheet.gradient(p, 0.0), g, epsilon = 1e-14);
        }
    }

    #[test]
    fn an_endless_sheet_has_half_its_charge_on_each_side_and_none_on_it() {
        let sheet = ChargeSheet::new(Vec3::zeros(), Vec3::x(), Vec3::y(), 1.0).unwrap();
        assert_relative_eq!(sheet.field(Vec3::z() * 1e-9, 0.0).z, 0.5, epsilon = 1e-8);
        assert_relative_eq!(sheet.field(Vec3::z() * -1e-9, 0.0).z, -0.5, epsilon = 1e-8);
        assert_eq!(sheet.field(Vec3::zeros(), 0.0), Vec3::zeros());
        assert!(ChargeSheet::new(Vec3::zeros(), Vec3::x(), Vec3::new(0.1, 1.0, 0.0), 1.0).is_err());
    }
}
