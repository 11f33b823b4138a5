//! What a magnetic model reports that it cannot do.

/// Why a source, a bead or a model cannot be built or solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MagneticsError {
    /// A quantity that must be positive is not.
    #[error("{what} is {value:e}, it must be finite and positive")]
    NotPositive {
        /// What it is, with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A susceptibility that no material has.
    #[error(
        "{kind} susceptibility is {value}, it must lie in ({low}, {high}); data sheets give the apparent slope M/H, tables of materials the intrinsic one"
    )]
    Susceptibility {
        /// `apparent` or `intrinsic`.
        kind: &'static str,
        /// The value given.
        value: f64,
        /// Least value, excluded.
        low: f64,
        /// Greatest value, excluded.
        high: f64,
    },
    /// The edges of a sheet are not at right angles.
    #[error("the half edges of the sheet meet at {degrees:.3} degrees, they must be orthogonal")]
    NotOrthogonal {
        /// Angle between them, degrees.
        degrees: f64,
    },
    /// A table M(H) that is not an increasing curve through the origin.
    #[error(
        "row {row} of the table M(H) does not rise: fields must grow strictly and magnetisations must not fall, from (0, 0)"
    )]
    Table {
        /// First row that fails, counted from 0.
        row: usize,
    },
    /// Two beads overlap.
    #[error("beads {first} and {second} overlap by {depth:.3e} m; move them apart or let contact do it")]
    Overlap {
        /// First bead.
        first: usize,
        /// Second bead.
        second: usize,
        /// Depth of the overlap, m.
        depth: f64,
    },
    /// A position, a field or a moment is not finite.
    #[error("{what} of bead {bead} is not finite")]
    NotFinite {
        /// What it is.
        what: &'static str,
        /// Which bead.
        bead: usize,
    },
    /// The numbers of beads and positions differ.
    #[error("{beads} beads but {positions} positions")]
    Count {
        /// Beads given.
        beads: usize,
        /// Positions given.
        positions: usize,
    },
    /// The model knows only linear and remanent beads.
    #[error("{model} knows only linear and remanent beads, bead {bead} saturates; use mutual dipoles")]
    NotLinear {
        /// The model.
        model: &'static str,
        /// Which bead.
        bead: usize,
    },
    /// A setting of a tree that it cannot honour.
    #[error("{what} of the tree is {value}, it must lie in [{low}, {high}]")]
    Tree {
        /// Which setting.
        what: &'static str,
        /// The value given.
        value: f64,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
    /// The solver has not reached its tolerance.
    #[error("{model}: residual {residual:.2e} after {iterations} iterations, asked for {tolerance:.2e}")]
    NotConverged {
        /// The model.
        model: &'static str,
        /// Relative residual reached.
        residual: f64,
        /// Iterations made.
        iterations: usize,
        /// Relative residual asked for.
        tolerance: f64,
    },
    /// A time step or a duration that the dynamics cannot honour.
    #[error("the step of bead dynamics has shrunk to {step:.3e} s at time {time:.3e} s; {remedy}")]
    Step {
        /// Step tried, s.
        step: f64,
        /// Time, s.
        time: f64,
        /// What to do.
        remedy: &'static str,
    },
}

pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, MagneticsError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(MagneticsError::NotPositive { what, value })
    }
}
