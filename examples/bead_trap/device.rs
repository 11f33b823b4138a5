//! The device: a channel along x between two plates and two side walls, three chains of beads across it, magnetic sheets
//! above and below. Its origin is the middle of the row of chains.

use clap::Args;
use lbm_ibm::contact::{ContactError, Spheres};
use lbm_ibm::coupling::{Boundary, Plane, Sphere, UM, Union, Vec3};
use lbm_ibm::magnetics::{Apparent, Bead, FieldSource, MagneticsError, SheetPair, Sum, Uniform};
use std::sync::Arc;

/// Plasma: density, kg/m3, and dynamic viscosity, Pa s.
pub const PLASMA: (f64, f64) = (1025.0, 1.2e-3);
/// Chains in the row, and beads in a chain.
pub const ROW: (usize, usize) = (3, 4);
/// Radius of a bead, m.
pub const RADIUS: f64 = 5.0 * UM;
/// Density of a bead, kg/m3.
pub const DENSITY: f64 = 1300.0;
/// Distance between the plates, m: the beads of a chain and a little room.
pub const HEIGHT: f64 = 41.0 * UM;
/// Half lengths of the sheets along x and y, and the distance between them, m.
const SHEETS: ([f64; 2], f64) = ([40.0 * UM, 60.0 * UM], 80.0 * UM);

/// Sheets and beads.
#[derive(Clone, Copy, Debug, Args)]
pub struct Device {
    /// Field of the sheets in their middle, mT.
    #[arg(long, default_value_t = 50.0)]
    field: f64,
    /// Apparent susceptibility M/H of the beads.
    #[arg(long, default_value_t = 0.5)]
    susceptibility: f64,
}

impl Device {
    /// Field of the sheets in their middle, T.
    pub fn sheets(&self) -> f64 {
        self.field * 1e-3
    }

    /// A bead.
    pub fn bead(&self) -> Result<Bead, MagneticsError> {
        Bead::new(RADIUS, DENSITY, Apparent::new(self.susceptibility)?)
    }

    /// All beads of the row.
    pub fn beads(&self) -> Result<Vec<Bead>, MagneticsError> {
        Ok(vec![self.bead()?; ROW.0 * ROW.1])
    }

    /// The sheets about `centre` (m), and a bias field (T) along the chains.
    pub fn source(&self, centre: Vec3, bias: f64) -> Result<Sum, MagneticsError> {
        let (half, separation) = SHEETS;
        let unit = SheetPair::opposite(Vec3::zeros(), half, separation, 1.0)?;
        let density = self.sheets() / unit.field(Vec3::zeros(), 0.0).z;
        let sheets = SheetPair::opposite(centre, half, separation, density)?;
        Ok(Sum::new().with(sheets).with(Uniform::new(Vec3::z() * bias)))
    }

    /// The plates, part 0 below and 1 above.
    pub fn plates() -> Union {
        Union::new()
            .with(Plane::new(Vec3::z() * (-0.5 * HEIGHT), Vec3::z()))
            .with(Plane::new(Vec3::z() * (0.5 * HEIGHT), -Vec3::z()).with_part(1))
    }

    /// Width of a channel in which side walls and outermost chains are half a gap apart, in whole spacings (m).
    pub fn width(gap: f64, spacing: f64) -> f64 {
        let row = ROW.0 as f64 * (2.0 * RADIUS + gap);
        (row / spacing).round() * spacing
    }

    /// Plates, side walls (parts 2 and 3) `width` (m) apart and beads (parts 4 and on), moved by `shift` (m).
    pub fn walls(width: f64, beads: &[Sphere], shift: Vec3) -> Result<Arc<dyn Boundary>, ContactError> {
        let plate = |z: f64| shift + Vec3::z() * (z * 0.5 * HEIGHT);
        let side = |y: f64| shift + Vec3::y() * (y * 0.5 * width);
        let walls = Union::new()
            .with(Plane::new(plate(-1.0), Vec3::z()))
            .with(Plane::new(plate(1.0), -Vec3::z()).with_part(1))
            .with(Plane::new(side(-1.0), Vec3::y()).with_part(2))
            .with(Plane::new(side(1.0), -Vec3::y()).with_part(3));
        if beads.is_empty() {
            return Ok(Arc::new(walls));
        }
        let moved: Vec<Sphere> = beads.iter().map(|b| Sphere::new(b.centre + shift, b.radius)).collect();
        Ok(Arc::new(walls.with(Spheres::new(&moved)?.with_first_part(4))))
    }
}
