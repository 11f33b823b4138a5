//! A membrane by the moduli of a continuum, whatever its mesh.

use crate::laws::{
    CorticalTension, GlobalArea, KantorNelson, LocalArea, NeoHookean, Pressure, Skalak, Volume, WormLikeChain,
};
use crate::{Cell, MembraneError, Mesh};
use std::f64::consts::PI;
use std::sync::Arc;

/// How the sheet resists shear.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Sheet {
    /// [`Skalak`]: stiffens, its area modulus at least that of C = -1/2, zero.
    Skalak,
    /// [`NeoHookean`]: softens, its area modulus is three times the shear modulus.
    NeoHookean,
    /// [`WormLikeChain`] springs with this extension at rest over the contour length: stiffens, its area modulus at
    /// least twice the shear modulus; what it lacks is a [`LocalArea`] law.
    WormLikeChain(f64),
}

/// The moduli of a membrane as a continuum, for a cell on any mesh. A modulus of zero leaves its law out.
///
/// ```
/// use lbm_ibm_membrane::{Material, Mesh, Sheet};
///
/// let capsule = Material { shear: 5e-6, dilation: 15e-6, ..Material::none(Sheet::NeoHookean) };
/// let cell = capsule.cell("capsule", Mesh::sphere(4e-6, 642)?.into())?;
/// assert_eq!(cell.laws().len(), 1);
/// # Ok::<(), lbm_ibm_membrane::MembraneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The sheet's kind.
    pub sheet: Sheet,
    /// Shear modulus G of the sheet, N/m.
    pub shear: f64,
    /// Area modulus of the sheet, N/m: it acts on every triangle.
    pub dilation: f64,
    /// Bending stiffness kappa, J: [`KantorNelson`] hinges at rest in the angles of the mesh.
    pub bending: f64,
    /// Modulus of the cell's whole area, N/m: [`GlobalArea`].
    pub area: f64,
    /// Modulus of the cell's volume, Pa: [`Volume`].
    pub volume: f64,
    /// Cortical tension, N/m: [`CorticalTension`], with the [`Pressure`] in a sphere of the cell's volume, so that a
    /// sphere is at rest at its size.
    pub tension: f64,
}

/// Which modulus of a [`Material`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Modulus {
    /// [`Material::shear`]; the ratio of [`Material::dilation`] to it is kept.
    Shear,
    /// [`Material::dilation`].
    Dilation,
    /// [`Material::bending`].
    Bending,
    /// [`Material::area`].
    Area,
    /// [`Material::volume`].
    Volume,
    /// [`Material::tension`].
    Tension,
}

impl Modulus {
    /// Its name and unit.
    pub fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::Shear => ("shear", "N/m"),
            Self::Dilation => ("dilation", "N/m"),
            Self::Bending => ("bending", "J"),
            Self::Area => ("area", "N/m"),
            Self::Volume => ("volume", "Pa"),
            Self::Tension => ("tension", "N/m"),
        }
    }
}

impl Material {
    /// A sheet of this kind with all moduli zero, to be filled in.
    pub fn none(sheet: Sheet) -> Self {
        Self {
            sheet,
            shear: 0.0,
            dilation: 0.0,
            bending: 0.0,
            area: 0.0,
            volume: 0.0,
            tension: 0.0,
        }
    }

    /// One of its moduli, SI.
    pub fn modulus(&self, which: Modulus) -> f64 {
        match which {
            Modulus::Shear => self.shear,
            Modulus::Dilation => self.dilation,
            Modulus::Bending => self.bending,
            Modulus::Area => self.area,
            Modulus::Volume => self.volume,
            Modulus::Tension => self.tension,
        }
    }

    /// The same with another value (SI) of one modulus; with that of the shear modulus the sheet's area modulus goes in
    /// proportion.
    #[must_use]
    pub fn with(mut self, which: Modulus, value: f64) -> Self {
        match which {
            Modulus::Shear => {
                if self.shear > 0.0 {
                    self.dilation *= value / self.shear;
                }
                self.shear = value;
            }
            Modulus::Dilation => self.dilation = value,
            Modulus::Bending => self.bending = value,
            Modulus::Area => self.area = value,
            Modulus::Volume => self.volume = value,
            Modulus::Tension => self.tension = value,
        }
        self
    }

    /// A cell named `kind` at rest on `mesh`.
    ///
    /// # Errors
    /// [`MembraneError::OutOfRange`] for a negative modulus, or an area modulus that the sheet cannot have.
    pub fn cell(&self, kind: &str, mesh: Arc<Mesh>) -> Result<Cell, MembraneError> {
        let m = &*mesh;
        let mut cell = Cell::new(kind, mesh.clone());
        if present("the shear modulus", self.shear)? {
            cell = match self.sheet {
                Sheet::Skalak => cell.with_law(Skalak::new(m, self.shear, 0.5 * (self.dilation / self.shear - 1.0))?),
                Sheet::NeoHookean => {
                    between(
                        "the area modulus of a neo-Hookean sheet",
                        self.dilation,
                        3.0 * self.shear,
                        true,
                    )?;
                    cell.with_law(NeoHookean::new(m, self.shear)?)
                }
                Sheet::WormLikeChain(extension) => {
                    between(
                        "the area modulus of worm-like chains",
                        self.dilation,
                        2.0 * self.shear,
                        false,
                    )?;
                    let springs = WormLikeChain::new(m, self.shear)?.with_extension(extension)?;
                    let rest = self.dilation - 2.0 * self.shear;
                    let cell = cell.with_law(springs);
                    if rest > 0.0 {
                        cell.with_law(LocalArea::new(m, rest)?)
                    } else {
                        cell
                    }
                }
            };
        } else if present("the area modulus of the sheet", self.dilation)? {
            cell = cell.with_law(LocalArea::new(m, self.dilation)?);
        }
        if present("the bending stiffness", self.bending)? {
            cell = cell.with_law(KantorNelson::new(m, KantorNelson::modulus_for(self.bending))?);
        }
        if present("the modulus of the cell's area", self.area)? {
            cell = cell.with_law(GlobalArea::new(m, self.area)?);
        }
        if present("the cortical tension", self.tension)? {
            cell = cell.with_law(CorticalTension::new(m, self.tension)?);
            let curvature = (4.0 * PI / (3.0 * m.volume())).cbrt();
            cell = cell.with_law(Pressure::new(m, 2.0 * self.tension * curvature)?);
        }
        if present("the modulus of the cell's volume", self.volume)? {
            cell = cell.with_law(Volume::new(m, self.volume)?);
        }
        Ok(cell)
    }
}

/// Whether a modulus is there; refuses negative and infinite ones.
fn present(what: &'static str, value: f64) -> Result<bool, MembraneError> {
    if (0.0..f64::INFINITY).contains(&value) {
        return Ok(value > 0.0);
    }
    Err(MembraneError::OutOfRange {
        what,
        value,
        low: 0.0,
        high: f64::INFINITY,
    })
}

/// Refuses a `value` that is not `bound` (to rounding) where it is `fixed`, or below it.
fn between(what: &'static str, value: f64, bound: f64, fixed: bool) -> Result<(), MembraneError> {
    let (low, high) = (bound, if fixed { bound } else { f64::INFINITY });
    if value >= low * (1.0 - 1e-9) && value <= high * (1.0 + 1e-9) {
        return Ok(());
    }
    Err(MembraneError::OutOfRange { what, value, low, high })
}
