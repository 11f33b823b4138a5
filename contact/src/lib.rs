//! Walls, devices and contact forces.
//!
//! [`SlitChannel`] is the device of the gap study; [`Solid`] turns any parry shape into a
//! [`Boundary`](lbm_ibm_coupling::Boundary), [`Spheres`] many spheres, such as the beads of frozen chains. [`WallRepulsion`] and [`CellRepulsion`] keep cells off walls and off each
//! other by a [`SoftSphere`] law, [`BeadRepulsion`] spherical beads off everything.

mod bead;
mod cell;
#[cfg(feature = "parry")]
mod compound;
mod error;
#[cfg(feature = "parry")]
mod slit;
mod soft_sphere;
#[cfg(feature = "parry")]
mod solid;
#[cfg(feature = "parry")]
mod spheres;
mod wall;

pub use bead::BeadRepulsion;
pub use cell::CellRepulsion;
pub use error::ContactError;
#[cfg(feature = "parry")]
pub use parry3d_f64 as parry;
#[cfg(feature = "parry")]
pub use slit::SlitChannel;
pub use soft_sphere::{CutOff, SoftSphere};
#[cfg(feature = "parry")]
pub use solid::Solid;
#[cfg(feature = "parry")]
pub use spheres::Spheres;
pub use wall::WallRepulsion;
