//! What this crate refuses.

/// Why a wall or a contact law cannot be built.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A quantity that must be positive is not.
    #[error("{what} is {value:e}, it must be finite and positive")]
    NotPositive {
        /// What it is.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// The opening of a slit is as high as its channel, or higher.
    #[error(
        "a gap of {gap:.3e} m does not narrow a channel {height:.3e} m high; make the channel higher or the gap smaller"
    )]
    GapTooWide {
        /// Opening, m.
        gap: f64,
        /// Channel height, m.
        height: f64,
    },
    /// The edges are rounder than the wall is thick.
    #[error("edges of radius {radius:.3e} m need a wall at least {needed:.3e} m thick, it has {thickness:.3e} m")]
    EdgeTooRound {
        /// Edge radius, m.
        radius: f64,
        /// Thickness of the wall, m.
        thickness: f64,
        /// Least thickness, m.
        needed: f64,
    },
    /// A wall of spheres without any sphere.
    #[error("a wall of spheres needs at least one sphere")]
    NoSpheres,
}
