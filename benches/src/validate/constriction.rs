//! A capsule that is driven through a throat.

mod case;
mod passage;
mod wall;
mod watch;

pub use case::constriction;
