//! Beads on the move.

mod drag;
mod overdamped;

pub use drag::{PairMobility, parallel_drag, perpendicular_drag, squeeze_mobility, wall_mobility};
pub use overdamped::{Overdamped, Regime, Repulsion};
