//! Calibration: the moduli of a cell from its stretching curve.
//!
//! The diameters of a cell under a pull are computed by [`Stretch`] and fitted to those measured by least squares
//! (Levenberg, Q. Appl. Math. 2, 164, 1944; Marquardt, J. SIAM 11, 431, 1963) in the logarithms of the free moduli,
//! which keeps them positive and makes their errors relative. The curvature of the sum of squares at its minimum gives
//! 95 % confidence intervals; the singular values of its Jacobian tell which products of moduli the data do not
//! determine.
//!
//! ```
//! use lbm_ibm_membrane::calibrate::{Calibration, Point};
//! use lbm_ibm_membrane::stretch::Load;
//! use lbm_ibm_membrane::{Modulus, presets};
//!
//! // A sphere of 16 um that is 18.4 +- 0.2 um long where light pulls each half by 79 pN.
//! let preset = presets::MCF7.with_nodes(100);
//! let mesh = std::sync::Arc::new(preset.mesh()?);
//! let cell = Calibration::new(preset.material, mesh, Load::CosineSquared, vec![Modulus::Shear]);
//! let fit = cell.fit(&[Point::axial(79e-12, 18.4e-6, 0.2e-6)])?;
//! let shear = fit.moduli[0].1;
//! assert!(shear.low < shear.value && shear.value < shear.high);
//! let longer = cell.predict(&fit, 120e-12)?.axial;
//! assert!(longer.value > 18.4e-6);
//! # Ok::<(), lbm_ibm_membrane::MembraneError>(())
//! ```

#[cfg(feature = "import")]
mod curve;
mod squares;

#[cfg(feature = "import")]
pub use curve::read_curve;

use crate::stretch::{Load, Stretch};
use crate::{Material, MembraneError, Mesh, Modulus};
use lbm_ibm_coupling::nalgebra::{DMatrix, DVector};
use squares::{Minimum, Model};
use std::fmt;
use std::sync::Arc;

/// Step of the differences that make a Jacobian, in the logarithm of a modulus.
const STEP: f64 = 0.05;
/// Greatest force (N) left on a node, unless [`Calibration::with_tolerance`] says otherwise: finer than that of a
/// single stretch, since it is differences that count.
pub const TOLERANCE: f64 = 1e-16;

/// A diameter and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Diameter, m.
    pub value: f64,
    /// Standard error (m); zero where it is not known. All or none of a curve's errors are zero.
    pub error: f64,
}

/// A point of a stretching curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Force on each half, N.
    pub force: f64,
    /// Diameter along the pull.
    pub axial: Measured,
    /// Diameter across it (along y).
    pub transverse: Option<Measured>,
}

impl Point {
    /// A point with an axial diameter (m) and its error (m) alone.
    pub fn axial(force: f64, value: f64, error: f64) -> Self {
        Self {
            force,
            axial: Measured { value, error },
            transverse: None,
        }
    }

    /// The same with a transverse diameter (m) and its error (m).
    #[must_use]
    pub fn and_transverse(mut self, value: f64, error: f64) -> Self {
        self.transverse = Some(Measured { value, error });
        self
    }
}

/// A value with the bounds of its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Best value.
    pub value: f64,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

/// A product of powers of moduli: what a direction in their logarithms means.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// Each modulus with its power; the squares of the powers sum to one.
    pub powers: Vec<(Modulus, f64)>,
    /// Factor by which the product may be larger or smaller at 95 % confidence; infinite where the data say nothing.
    pub factor: f64,
}

/// What a calibration found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Fit {
    /// The material with the moduli found.
    pub material: Material,
    /// Each free modulus with its interval, SI.
    pub moduli: Vec<(Modulus, Interval)>,
    /// Sum of the squares of (computed - measured)/error.
    pub chi_squared: f64,
    /// Diameters less free moduli.
    pub freedom: usize,
    /// Products of powers of the moduli with independent errors, the best known first.
    pub combinations: Vec<Combination>,
    /// Fits of the curve that were computed.
    pub iterations: usize,
    /// Half width of a 95 % interval in units of the errors that were given.
    spread: f64,
    /// Singular values and directions (rows) of the Jacobian.
    singular: Vec<(f64, Vec<f64>)>,
}

/// A factor at which a product of moduli counts as not determined.
const OPEN: f64 = 2.0;

impl Fit {
    /// The products of moduli that the data leave open by a factor of two or more.
    pub fn undetermined(&self) -> impl Iterator<Item = &Combination> {
        self.combinations.iter().filter(|c| c.factor > OPEN)
    }
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "chi squared {:.3} with {} degrees of freedom",
            self.chi_squared, self.freedom
        )?;
        for (modulus, i) in &self.moduli {
            let (name, unit) = modulus.name();
            writeln!(
                f,
                "  {name} {:.3e} {unit}, 95 % from {:.3e} to {:.3e}",
                i.value, i.low, i.high
            )?;
        }
        for open in self.undetermined() {
            let product: Vec<_> = open
                .powers
                .iter()
                .filter(|(_, power)| power.abs() > 0.1)
                .map(|(modulus, power)| format!("{}^{power:.2}", modulus.name().0))
                .collect();
            writeln!(
                f,
                "  the data leave {} open by a factor of {:.1}: they do not tell these moduli apart",
                product.join(" x "),
                open.factor
            )?;
        }
        Ok(())
    }
}

/// Diameters that a calibrated cell would have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Force on each half, N.
    pub force: f64,
    /// Along the pull, m.
    pub axial: Interval,
    /// Across it, m.
    pub transverse: Interval,
}

/// A cell whose moduli are to be found.
#[derive(Clone, Debug)]
pub struct Calibration {
    material: Material,
    mesh: Arc<Mesh>,
    load: Load,
    free: Vec<Modulus>,
    tolerance: f64,
}

impl Calibration {
    /// A cell at rest on `mesh`, pulled by `load`; the moduli `free` are to be found, from those of `material` on,
    /// which gives the others.
    pub fn new(material: Material, mesh: Arc<Mesh>, load: Load, free: Vec<Modulus>) -> Self {
        Self {
            material,
            mesh,
            load,
            free,
            tolerance: TOLERANCE,
        }
    }

    /// With another greatest force (N) left on a node at rest.
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Fits the free moduli to the points of a curve.
    ///
    /// Errors of the diameters that are given count as they are, and are widened together where the fit is worse than
    /// they allow; where none is given they are taken as equal, and their size from the fit.
    ///
    /// # Errors
    /// [`MembraneError::TooFewData`]; [`MembraneError::NotPositive`] for a free modulus that starts at zero or an
    /// error that is missing among others; [`MembraneError::NoEquilibrium`] where the cell to start from cannot be
    /// stretched.
    pub fn fit(&self, points: &[Point]) -> Result<Fit, MembraneError> {
        let mut points = points.to_vec();
        points.sort_by(|a, b| a.force.total_cmp(&b.force));
        let measured = || points.iter().flat_map(|p| std::iter::once(p.axial).chain(p.transverse));
        let count = measured().count();
        let blind = measured().all(|m| m.error == 0.0);
        if count < self.free.len() + usize::from(blind) || self.free.is_empty() {
            return Err(MembraneError::TooFewData {
                diameters: count,
                free: self.free.len(),
                errors: !blind,
            });
        }
        if !blind {
            for m in measured() {
                crate::mesh::positive("the error of a diameter", m.error)?;
            }
        }
        let start = self
            .free
            .iter()
            .map(|&m| crate::mesh::positive("the start of a free modulus", self.material.modulus(m)).map(f64::ln));
        let mut curve = Stretching {
            calibration: self,
            points: &points,
            unit: if blind { 1e-6 } else { 0.0 },
        };
        let minimum = squares::minimise(&mut curve, start.collect::<Result<_, _>>()?)?;
        Ok(self.judge(&minimum, count - self.free.len(), blind))
    }

    fn judge(&self, minimum: &Minimum, freedom: usize, blind: bool) -> Fit {
        let chi_squared = minimum.residuals.norm_squared();
        let widening = (chi_squared / freedom.max(1) as f64).sqrt();
        let spread = if freedom > 0 && (blind || widening > 1.0) {
            widening * squares::student(freedom)
        } else {
            squares::NORMAL
        };
        let singular = squares::singular(&minimum.jacobian);
        let width = |along: &dyn Fn(usize) -> f64| spread * deviation(&singular, along);
        let moduli = self.free.iter().enumerate().map(|(k, &modulus)| {
            let value = minimum.logarithms[k].exp();
            let factor = width(&|i| f64::from(i == k)).exp();
            let interval = Interval {
                value,
                low: value / factor,
                high: value * factor,
            };
            (modulus, interval)
        });
        let combinations = singular.iter().map(|(size, direction)| Combination {
            powers: self.free.iter().copied().zip(direction.iter().copied()).collect(),
            factor: (spread / size).exp(),
        });
        Fit {
            material: self.with(&minimum.logarithms),
            moduli: moduli.collect(),
            chi_squared,
            freedom,
            combinations: combinations.collect(),
            iterations: minimum.iterations,
            spread,
            singular,
        }
    }

    /// The diameters that the calibrated cell has under `force` (N), with the intervals that follow from those of the
    /// moduli; the model's own error is not in them.
    ///
    /// # Errors
    /// [`MembraneError::NoEquilibrium`].
    pub fn predict(&self, fit: &Fit, force: f64) -> Result<Prediction, MembraneError> {
        let shape = self.stretch(&fit.material)?.pull(force)?;
        let mut slopes = Vec::new();
        for &modulus in &self.free {
            let moved = fit.material.with(modulus, fit.material.modulus(modulus) * STEP.exp());
            let other = self.stretch(&moved)?.pull(force)?;
            slopes.push([other.axial - shape.axial, other.transverse - shape.transverse].map(|d| d / STEP));
        }
        let interval = |value: f64, axis: usize| {
            let half = fit.spread * deviation(&fit.singular, &|i: usize| slopes[i][axis]);
            Interval {
                value,
                low: value - half,
                high: value + half,
            }
        };
        Ok(Prediction {
            force,
            axial: interval(shape.axial, 0),
            transverse: interval(shape.transverse, 1),
        })
    }

    fn with(&self, logarithms: &DVector<f64>) -> Material {
        let set = |m: Material, (&which, q): (&Modulus, &f64)| m.with(which, q.exp());
        // The shear modulus takes the area modulus along, so it comes first.
        let mut order: Vec<_> = self.free.iter().zip(logarithms.iter()).collect();
        order.sort_by_key(|(which, _)| **which != Modulus::Shear);
        order.into_iter().fold(self.material, set)
    }

    fn stretch(&self, material: &Material) -> Result<Stretch, MembraneError> {
        let cell = material.cell("calibration", self.mesh.clone())?;
        Ok(Stretch::new(cell, self.load.clone()).with_tolerance(self.tolerance))
    }
}

/// Standard deviation of a quantity whose slopes in the logarithms are `along`; infinite where a direction that the
/// data do not see has a part in it.
fn deviation(singular: &[(f64, Vec<f64>)], along: &dyn Fn(usize) -> f64) -> f64 {
    let part = |(size, direction): &(f64, Vec<f64>)| {
        let slope: f64 = direction.iter().enumerate().map(|(i, d)| d * along(i)).sum();
        if slope == 0.0 { 0.0 } else { (slope / size).powi(2) }
    };
    singular.iter().map(part).sum::<f64>().sqrt()
}

/// The curve of a cell against the measured one, as a problem of least squares.
struct Stretching<'a> {
    calibration: &'a Calibration,
    points: &'a [Point],
    /// Error (m) to take for all where none is given.
    unit: f64,
}

impl Model for Stretching<'_> {
    type Error = MembraneError;

    fn residuals(&mut self, logarithms: &DVector<f64>) -> Result<DVector<f64>, MembraneError> {
        // Always from rest and by rising forces: a membrane may have more than one equilibrium, and which it finds
        // depends on the way.
        let mut stretch = self.calibration.stretch(&self.calibration.with(logarithms))?;
        let mut residuals = Vec::new();
        for point in self.points {
            let shape = stretch.pull(point.force)?;
            let mut add = |size: f64, m: Measured| residuals.push((size - m.value) / (m.error + self.unit));
            add(shape.axial, point.axial);
            if let Some(transverse) = point.transverse {
                add(shape.transverse, transverse);
            }
        }
        Ok(DVector::from_vec(residuals))
    }

    fn jacobian(&mut self, logarithms: &DVector<f64>, residuals: &DVector<f64>) -> Result<DMatrix<f64>, MembraneError> {
        let mut columns = Vec::new();
        for k in 0..logarithms.len() {
            let mut moved = logarithms.clone();
            moved[k] += STEP;
            columns.push((self.residuals(&moved)? - residuals) / STEP);
        }
        Ok(DMatrix::from_columns(&columns))
    }
}
