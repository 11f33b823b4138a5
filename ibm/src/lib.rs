//! How immersed surfaces and a fluid grid exchange velocity and force.
//!
//! Nodes carry the mechanics of a body; the fluid meets it at markers. [`DeltaExchange`] divides each triangle of a mesh
//! until its markers are at most a grid spacing apart, interpolates the fluid's velocity to them with a regularised delta
//! [`Kernel`], and averages it over the patch of each node; forces go back along the transposed path, so that
//! interpolation and spreading are adjoint, total force and (but for one kernel) torque about the markers are kept, and no
//! fluid leaks through a mesh coarser than the grid. The bits do not depend on the number of threads.
//!
//! A surface acts larger in the fluid than its mesh, by [`Kernel::hydrodynamic_shift`]; [`DeltaExchange::with_inset`] puts
//! the markers of rigid bodies, and [`DeltaExchange::with_elastic_inset`] those of elastic ones, deeper by it. [`stokes`] measures this, the radius of a marker, and the leak of any mesh.
//!
//! Forces are spread with weights that sum to one: bricks hold newtons per grid node, velocities are m/s, all in SI.

mod axis;
mod exchange;
mod forcing;
mod friction;
mod inset;
mod kernel;
mod placement;
mod rigid;
mod slip;
mod stability;
pub mod stokes;
mod subdivision;
mod surface;
mod table;
mod threads;
mod transfer;

pub use exchange::DeltaExchange;
pub use friction::{calibrated_friction, friction_ratio, friction_slip_fraction};
pub use kernel::Kernel;
pub use rigid::{Buoyancy, RigidBody, RigidError};
pub use surface::Markers;
