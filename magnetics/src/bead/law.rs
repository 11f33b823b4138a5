//! Magnetisation against field.

use super::susceptibility::{Apparent, Intrinsic};
use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::Vec3;

/// How a bead is magnetised.
///
/// Laws give M(H) with H the field inside. A sphere in the applied field H0 has H = H0 - M/3, and every law here is solved
/// with it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Magnetisation {
    /// M = chi H.
    Linear(Intrinsic),
    /// Linear at first, then bounded.
    Saturating(Saturation),
    /// Measured, linear between rows, constant after the last.
    Table(Table),
    /// A magnetisation (A/m) that stays whatever the field, in the frame of the scene.
    Remanent(Vec3),
}

/// The shape of a saturating law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaturationShape {
    /// M = chi H Ms/(Ms + chi H) (Froehlich and Kennelly).
    FroehlichKennelly,
    /// M = Ms (coth s - 1/s), s = 3 chi H/Ms (Langevin).
    Langevin,
}

/// A law that saturates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturation {
    shape: SaturationShape,
    chi: f64,
    limit: f64,
}

/// A measured curve M(H), H the field inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    rows: Vec<[f64; 2]>,
}

impl Saturation {
    /// A law of the initial susceptibility `chi` (either type) and the saturation magnetisation `limit` (A/m).
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for either.
    pub fn new(shape: SaturationShape, chi: impl Into<Intrinsic>, limit: f64) -> Result<Self, MagneticsError> {
        Ok(Self {
            shape,
            chi: positive("initial susceptibility", chi.into().value())?,
            limit: positive("saturation magnetisation (A/m)", limit)?,
        })
    }

    /// M, dM/dH and int M dH at the inner field `h`.
    fn at(&self, h: f64) -> (f64, f64, f64) {
        let (chi, ms) = (self.chi, self.limit);
        match self.shape {
            SaturationShape::FroehlichKennelly => {
                let x = chi * h / ms;
                let m = ms * x / (1.0 + x);
                let coenergy = if x < 1e-3 {
                    ms * ms / chi * x * x * (0.5 - x / 3.0 + x * x / 4.0 - x * x * x / 5.0)
                } else {
                    ms * ms / chi * (x - x.ln_1p())
                };
                (m, chi / (1.0 + x).powi(2), coenergy)
            }
            SaturationShape::Langevin => {
                let s = 3.0 * chi * h / ms;
                let (l, slope, log) = langevin(s);
                (ms * l, 3.0 * chi * slope, ms * ms / (3.0 * chi) * log)
            }
        }
    }
}

/// L(s) = coth s - 1/s, its derivative, and its integral ln(sinh(s)/s).
fn langevin(s: f64) -> (f64, f64, f64) {
    if s < 0.05 {
        let q = s * s;
        return (
            s * (1.0 / 3.0 - q * (1.0 / 45.0 - q * (2.0 / 945.0 - q / 4725.0))),
            1.0 / 3.0 - q * (1.0 / 15.0 - q * (2.0 / 189.0 - q / 675.0)),
            q * (1.0 / 6.0 - q * (1.0 / 180.0 - q * (1.0 / 2835.0 - q / 37800.0))),
        );
    }
    let decay = (-2.0 * s).exp();
    let coth = (1.0 + decay) / (1.0 - decay);
    let inverse_sinh2 = 4.0 * decay / (1.0 - decay).powi(2);
    let log = s + (0.5 * (1.0 - decay) / s).ln();
    (coth - 1.0 / s, 1.0 / (s * s) - inverse_sinh2, log)
}

impl Table {
    /// A curve from rows of H and M (A/m), H the field inside. The first row must be (0, 0).
    ///
    /// # Errors
    /// [`MagneticsError::Table`] names the first row that does not rise.
    pub fn new(rows: &[[f64; 2]]) -> Result<Self, MagneticsError> {
        let origin = rows.first() == Some(&[0.0, 0.0]) && rows.len() > 1;
        if !origin {
            return Err(MagneticsError::Table { row: 0 });
        }
        for (k, pair) in rows.windows(2).enumerate() {
            let [[h0, m0], [h1, m1]] = [pair[0], pair[1]];
            let rises = h1 > h0 && m1 >= m0 && h1.is_finite() && m1.is_finite();
            if !rises {
                return Err(MagneticsError::Table { row: k + 1 });
            }
        }
        Ok(Self { rows: rows.to_vec() })
    }

    fn at(&self, h: f64) -> (f64, f64, f64) {
        let mut area = 0.0;
        for pair in self.rows.windows(2) {
            let [[h0, m0], [h1, m1]] = [pair[0], pair[1]];
            let slope = (m1 - m0) / (h1 - h0);
            if h <= h1 {
                let m = m0 + slope * (h - h0);
                return (m, slope, area + 0.5 * (m0 + m) * (h - h0));
            }
            area += 0.5 * (m0 + m1) * (h1 - h0);
        }
        let [h1, m1] = self.rows[self.rows.len() - 1];
        (m1, 0.0, area + m1 * (h - h1))
    }

    fn slope_at_origin(&self) -> f64 {
        self.rows[1][1] / self.rows[1][0]
    }
}

impl Magnetisation {
    /// Initial susceptibility (intrinsic).
    pub fn initial_susceptibility(&self) -> f64 {
        match self {
            Self::Linear(chi) => chi.value(),
            Self::Saturating(law) => law.chi,
            Self::Table(table) => table.slope_at_origin(),
            Self::Remanent(_) => 0.0,
        }
    }

    /// M(H), dM/dH and int M dH (A/m, 1, A2/m2) at the field inside, `h` (A/m).
    fn at(&self, h: f64) -> (f64, f64, f64) {
        match self {
            Self::Linear(chi) => (chi.value() * h, chi.value(), 0.5 * chi.value() * h * h),
            Self::Saturating(law) => law.at(h),
            Self::Table(table) => table.at(h),
            Self::Remanent(_) => (0.0, 0.0, 0.0),
        }
    }

    /// The field inside a sphere in the applied field `h0`: h + M(h)/3 = h0, by Newton inside a bracket.
    fn inner(&self, h0: f64) -> f64 {
        if let Self::Linear(chi) = self {
            return h0 / (1.0 + chi.value() / 3.0);
        }
        let (mut low, mut high) = (0.0, h0);
        let mut h = h0 / (1.0 + self.initial_susceptibility() / 3.0);
        for _ in 0..200 {
            let (m, slope, _) = self.at(h);
            let excess = h + m / 3.0 - h0;
            if excess > 0.0 {
                high = h;
            } else {
                low = h;
            }
            let step = excess / (1.0 + slope / 3.0);
            if step.abs() <= 1e-15 * h0 {
                return h - step;
            }
            h -= step;
            if !(low..=high).contains(&h) {
                h = 0.5 * (low + high);
            }
        }
        h
    }

    /// M (A/m) and dM/dH0 of a sphere in the applied field `h0` (A/m), that is with H = H0 - M/3 inside.
    pub fn in_applied_field(&self, h0: f64) -> (f64, f64) {
        let (m, slope, _) = self.at(self.inner(h0));
        (m, slope / (1.0 + slope / 3.0))
    }

    /// int H0 dM (A2/m2) of a sphere brought to the applied field `h0` (A/m).
    pub(crate) fn energy_density(&self, h0: f64) -> f64 {
        let h = self.inner(h0);
        let (m, _, coenergy) = self.at(h);
        h * m - coenergy + m * m / 6.0
    }
}

impl From<Intrinsic> for Magnetisation {
    fn from(chi: Intrinsic) -> Self {
        Self::Linear(chi)
    }
}

impl From<Apparent> for Magnetisation {
    fn from(slope: Apparent) -> Self {
        Self::Linear(slope.into())
    }
}

impl From<Saturation> for Magnetisation {
    fn from(law: Saturation) -> Self {
        Self::Saturating(law)
    }
}

impl From<Table> for Magnetisation {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_langevin_series_meets_the_closed_form() {
        let (a, b, c) = langevin(0.0499999);
        let (d, e, f) = langevin(0.05);
        assert_relative_eq!(a, d, max_relative = 3e-6);
        assert_relative_eq!(b, e, max_relative = 1e-7);
        assert_relative_eq!(c, f, max_relative = 5e-6);
        // L(1) = coth 1 - 1.
        assert_relative_eq!(langevin(1.0).0, 0.313_035_285_499_331_3, max_relative = 1e-14);
        assert_relative_eq!(langevin(800.0).0, 1.0 - 1.0 / 800.0, max_relative = 1e-15);
    }

    #[test]
    fn a_table_that_falls_is_named_by_its_row() {
        let falls = Table::new(&[[0.0, 0.0], [1.0, 2.0], [2.0, 1.0]]);
        assert_eq!(falls, Err(MagneticsError::Table { row: 2 }));
        assert!(Table::new(&[[0.0, 1.0], [1.0, 2.0]]).is_err());
        assert!(Table::new(&[]).is_err());
    }
}
