//! Beads on the move.

mod brownian;
mod contact;
mod drag;
mod flow;
mod mobility;
mod newton;
mod overdamped;
mod quasi_static;
mod regime;
mod system;

pub use brownian::{BOLTZMANN, Brownian};
pub use contact::{BeadContact, Constraint, ContactLaw, Partner, Repulsion};
pub use drag::{
    WallDrag, bevan_prieve_drag, faxen_drag, near_wall_drag, parallel_drag, perpendicular_drag, squeeze_mobility,
    wall_mobility,
};
pub use flow::{Flow, SampledFlow};
pub use mobility::PairMobility;
pub use newton::Newton;
pub use overdamped::Overdamped;
pub use quasi_static::{QuasiStatic, Rest};
pub use regime::{Exceeded, Regime};
pub use system::BeadSystem;
