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
    /// A setting that a model cannot honour.
    #[error("{what} is {value}, it must lie in [{low}, {high}]")]
    Setting {
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
    /// A bead stands in a wall.
    #[error("bead {bead} is {depth:.3e} m deep in wall part {part}; move it out of the wall")]
    WallOverlap {
        /// Which bead.
        bead: usize,
        /// Part of the walls.
        part: u32,
        /// Depth, m.
        depth: f64,
    },
    /// The forces of contacts have not been found.
    #[error(
        "{contacts} contacts still move beads by {residual:.2e} m a sweep after {sweeps} sweeps, asked for {allowed:.2e} m; allow more sweeps, or less friction"
    )]
    Contact {
        /// Contacts looked at.
        contacts: usize,
        /// Sweeps made.
        sweeps: usize,
        /// Greatest displacement of the last sweep, m.
        residual: f64,
        /// Displacement asked for, m.
        allowed: f64,
    },
    /// The mobility of all beads together is not positive.
    #[error("the mobility of the beads with hydrodynamic interaction is not positive; keep beads from overlapping")]
    Mobility,
    /// A step of fixed length moves a bead too far.
    #[error("bead {bead} moves {moved:.3e} m in a step of {step:.3e} s, {limit:.3e} m is allowed; use a shorter step")]
    LongStep {
        /// Which bead.
        bead: usize,
        /// Length of the step, s.
        step: f64,
        /// How far it moves, m.
        moved: f64,
        /// How far it may, m.
        limit: f64,
    },
    /// Velocities that do not fit the lattice.
    #[error("the lattice has {nodes} nodes but {samples} velocities were given")]
    Samples {
        /// Nodes of the lattice.
        nodes: usize,
        /// Velocities given.
        samples: usize,
    },
    /// Beads have come to no rest.
    #[error(
        "beads are not at rest after {steps} steps: {residual:.2e} of the greatest force is left, asked for {tolerance:.2e}; {remedy}"
    )]
    NoRest {
        /// Steps made.
        steps: usize,
        /// Greatest force left, over the greatest force of the field.
        residual: f64,
        /// What was asked for.
        tolerance: f64,
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

/// `value` if it lies in [`low`, `high`].
pub(crate) fn within(what: &'static str, value: f64, low: f64, high: f64) -> Result<f64, MagneticsError> {
    if (low..=high).contains(&value) {
        Ok(value)
    } else {
        Err(MagneticsError::Setting { what, value, low, high })
    }
}
