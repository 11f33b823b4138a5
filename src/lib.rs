//! Cell-resolved microfluidics: a lattice-Boltzmann fluid, immersed elastic cells, walls and contact, in SI units.
//!
//! This package re-exports the crates of the workspace under short names and adds files, charts and progress
//! ([`output`]). The seams where a third party joins are the traits of [`coupling`].
//!
//! A red blood cell on its way to a slit:
//!
//! ```
//! use lbm_ibm::prelude::*;
//!
//! let slit = SlitChannel { height: 12.0 * UM, gap: 4.0 * UM, thickness: 5.0 * UM, edge_radius: 1.0 * UM, position: 24.0 * UM };
//! let walls = Arc::new(slit.walls()?);
//! // Plasma on a grid of 1 um; the density, and with it the Reynolds number, is scaled up ten times.
//! let grid = Grid::new([48, 12, 16], 1.0 * UM, [true, false, true]);
//! let plasma = Fluid::new(grid, 10.0 * 1025.0, 1.2e-3, Pace::Tau(1.0))?.with_drive(Drive::flux(0, 460.0 * UM))?;
//! let mut scene = Scene::with_fluid(plasma, DeltaExchange::new(Kernel::RomaThree));
//! scene.set_walls(walls.clone())?;
//! let start = Isometry3::translation(8.0 * UM, 6.0 * UM, 8.0 * UM);
//! let cell = scene.add_body(presets::rbc_paper(Form::Paper2011Balanced)?, &start)?;
//! scene.add_field(WallRepulsion::new(walls, SoftSphere::paper_wall()));
//! Run::new().until_time(1.0 * MS).run(&mut scene)?;
//! assert!(scene.body_positions(cell)?.mean().x > 8.2 * UM);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use lbm_ibm_contact as contact;
pub use lbm_ibm_coupling as coupling;
pub use lbm_ibm_ibm as ibm;
pub use lbm_ibm_lbm as lbm;
pub use lbm_ibm_magnetics as magnetics;
pub use lbm_ibm_membrane as membrane;

pub mod output;

/// What most programs need: `use lbm_ibm::prelude::*;`
pub mod prelude {
    pub use crate::contact::{CellRepulsion, SoftSphere, WallRepulsion};
    #[cfg(feature = "parry")]
    pub use crate::contact::{SlitChannel, Solid};
    pub use crate::coupling::nalgebra::Isometry3;
    pub use crate::coupling::{
        Boundary, ForceField, Grid, ImmersedBody, Lattice, Loads, MM, MS, Motion, NN, PN, Plane, Probe, Run, Scene,
        Schedule, UM, US, Union, Units, Vec3, View,
    };
    pub use crate::ibm::{DeltaExchange, Kernel};
    pub use crate::lbm::{Collision, Drive, Fluid, Pace};
    pub use crate::membrane::{Cell, Form, Mesh, presets};
    pub use std::sync::Arc;
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDoctests;
