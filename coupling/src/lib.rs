//! The contract between fluid, bodies, forces and walls, and the clock that steps them.
//!
//! All quantities are SI and `f64`. Four traits are the seams where third parties join: [`Boundary`] (solid geometry),
//! [`Lattice`] (a fluid), [`ImmersedBody`] (a cell, a bead) and [`ForceField`] (whatever pushes bodies). [`Exchange`]
//! joins bodies and fluid and comes with `lbm-ibm-ibm`. A [`Scene`] owns one of each kind, and [`Scene::step`] is one
//! time step; [`Run`] is everything around it.

mod body;
mod boundary;
mod bricks;
mod cells;
mod error;
mod exchange;
mod field;
mod grid;
mod guard;
mod inside;
mod lattice;
mod lines;
mod noise;
mod rigid;
mod run;
mod scene;
mod soa;
mod sphere;
mod state;
mod threads;
mod units;
mod widest;

pub use body::{ImmersedBody, Motion, enclosed_volume, surface_area};
pub use boundary::{Boundary, Closure, Difference, Moved, Plane, Probe, Union};
pub use bricks::{Bricks, EDGE as BRICK_EDGE, NODES as BRICK_NODES};
pub use cells::CellList;
pub use error::SceneError;
pub use exchange::{BodyInfo, Exchange, ExchangeError};
pub use field::{ForceField, Loads, View, Wrench};
pub use grid::{Domain, Grid};
pub use guard::Guard;
pub use inside::Inside;
pub use lattice::{FluidError, Lattice, Macroscopic, WallReport};
pub use lines::prefetch;
pub use noise::Noise;
pub use rigid::{Rigid, RigidDrive, RigidLaw, RigidState};
pub use run::{Finished, Run, RunError, Schedule};
pub use scene::{Elasticity, Scene};
pub use soa::{Soa3, Soa3Mut, Soa3Ref};
pub use sphere::Sphere;
pub use state::{StateError, StateReader, StateWriter};

pub use units::{MM, MS, NN, PN, Scales, UM, US, Units, UnitsReport};

pub use widest::{Work, on_widest};

pub use nalgebra;

/// A vector in space: position (m), velocity (m/s), force (N).
pub type Vec3 = nalgebra::Vector3<f64>;
