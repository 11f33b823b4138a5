//! What can be asked for on the command line, and the beads, field and channel that follow from it.

use clap::Parser;
use lbm_ibm::coupling::{Boundary, Plane, UM, Union, Vec3};
use lbm_ibm::magnetics::{Apparent, Bead, FieldSource, MagneticsError, SheetPair, Sum, Uniform};
use std::path::PathBuf;
use std::sync::Arc;

/// Beads between two magnetic charge sheets: how fast they form chains, at rest and in a flow, how far the flow tilts the
/// chains and when it breaks them, and how a bias field sets the gap between chains.
#[derive(Clone, Debug, Parser)]
pub struct Options {
    /// Number of beads scattered in the channel.
    #[arg(long, default_value_t = 80)]
    pub beads: usize,
    /// Radius of these beads, um.
    #[arg(long, default_value_t = 2.25)]
    pub radius: f64,
    /// Apparent susceptibility M/H of these beads.
    #[arg(long, default_value_t = 0.8)]
    pub susceptibility: f64,
    /// Density of the beads, kg/m3.
    #[arg(long, default_value_t = 1600.0)]
    pub density: f64,
    /// Fraction of the volume that the scattered beads fill.
    #[arg(long, default_value_t = 0.08)]
    pub fraction: f64,
    /// Field in the middle between the sheets, mT.
    #[arg(long, default_value_t = 50.0)]
    pub field: f64,
    /// Distance between the plates of the channel, um.
    #[arg(long, default_value_t = 30.0)]
    pub height: f64,
    /// Mean speed of the flow, um/s.
    #[arg(long, default_value_t = 460.0)]
    pub speed: f64,
    /// Viscosity of the fluid, mPa s.
    #[arg(long, default_value_t = 1.2)]
    pub viscosity: f64,
    /// Time that the chains have to form, ms.
    #[arg(long, default_value_t = 2.0)]
    pub time: f64,
    /// Seed of the scatter.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Apparent susceptibilities of the beads in the chart of the gap, by commas.
    #[arg(long, value_delimiter = ',', default_values_t = [0.3, 0.5, 0.8, 1.2])]
    pub gap_susceptibilities: Vec<f64>,
    /// Bias fields in that chart over the sheets' field in their middle, by commas.
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0])]
    pub gap_bias: Vec<f64>,
    /// Folder for tables, charts and VTK files.
    #[arg(long, default_value = "out/bead_chaining")]
    pub out: PathBuf,
    /// Few beads and few points, to see that everything works.
    #[arg(long)]
    pub smoke: bool,
}

/// Density of the fluid, kg/m3.
pub const FLUID_DENSITY: f64 = 1025.0;
/// Gravity, m/s2.
pub const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

impl Options {
    /// The options as given, or few of everything for the smoke test.
    pub fn read() -> Self {
        let given = Self::parse();
        if !given.smoke {
            return given;
        }
        Self {
            beads: 12,
            time: 0.3,
            gap_susceptibilities: vec![0.5],
            gap_bias: vec![0.0, 1.0],
            ..given
        }
    }

    /// A bead of the scatter.
    pub fn bead(&self) -> Result<Bead, MagneticsError> {
        Bead::new(self.radius * UM, self.density, Apparent::new(self.susceptibility)?)
    }

    /// Mean speed of the flow, m/s.
    pub fn mean_speed(&self) -> f64 {
        self.speed * UM
    }

    /// Viscosity of the fluid, Pa s.
    pub fn eta(&self) -> f64 {
        self.viscosity * 1e-3
    }

    /// Sheets above and below the plates, and a bias along z (T).
    pub fn source(&self, bias: f64) -> Result<Sum, MagneticsError> {
        let (half, separation) = ([150.0 * UM, 150.0 * UM], 200.0 * UM);
        let unit = SheetPair::opposite(Vec3::zeros(), half, separation, 1.0)?;
        let density = self.field * 1e-3 / unit.field(Vec3::zeros(), 0.0).z;
        let sheets = SheetPair::opposite(Vec3::zeros(), half, separation, density)?;
        Ok(Sum::new().with(sheets).with(Uniform::new(Vec3::z() * bias)))
    }

    /// The plates of the channel, `height` (m) apart about the origin: 0 below, 1 above.
    pub fn plates(height: f64) -> Arc<dyn Boundary> {
        Arc::new(
            Union::new()
                .with(Plane::new(Vec3::z() * (-0.5 * height), Vec3::z()))
                .with(Plane::new(Vec3::z() * (0.5 * height), -Vec3::z()).with_part(1)),
        )
    }
}
