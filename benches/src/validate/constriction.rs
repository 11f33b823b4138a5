//! A capsule that is driven through a throat.

mod case;
mod passage;
pub(super) mod wall;
mod watch;

pub use case::constriction;
