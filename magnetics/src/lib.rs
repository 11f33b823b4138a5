//! Magnetic sources, soft-magnetic beads and the forces between them.
//!
//! All quantities are SI and `f64`; fields are flux densities B (T), gradients dB_i/dx_j (T/m).

mod bead;
mod error;
mod kernel;
mod model;
mod source;
mod two_sphere;

pub use bead::{
    Apparent, Bead, Intrinsic, Magnetisation, Preset, Response, Saturation, SaturationShape, Sourced, Table,
};
pub use error::MagneticsError;
pub use model::{ErrorEstimate, FixedDipoles, Model, MutualDipoles, PairCorrected, Problem, Solution, dense_moments};
pub use source::{
    ChargeSheet, Cuboid, CurrentLoop, FieldSource, MagnetisedSphere, PointDipole, SheetPair, Sum, Uniform,
};

pub use two_sphere::{PairForce, TwoSpheres};

/// The magnetic constant as this crate uses it, 4e-7 pi N/A^2 (the value before 2019; today's differs by 1e-10).
pub const MU0: f64 = 4e-7 * std::f64::consts::PI;
