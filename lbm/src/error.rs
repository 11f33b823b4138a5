//! What a fluid cannot be built with.

use crate::faces::FaceError;
use lbm_ibm_coupling::FluidError;

/// Parameters that make no fluid, or one that would fail.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LbmError {
    /// A quantity that must be positive and finite is not.
    #[error("the {name} is {value}, it must be positive and finite")]
    NotPositive {
        /// What it is.
        name: &'static str,
        /// Its value, SI.
        value: f64,
    },
    /// A quantity that must be finite is not.
    #[error("the {name} is {value}, it must be finite")]
    NotFinite {
        /// What it is.
        name: &'static str,
        /// Its value, SI.
        value: f64,
    },
    /// The grid has no nodes.
    #[error("the grid of {} x {} x {} nodes is empty: use at least one node in each direction", shape[0], shape[1], shape[2])]
    EmptyGrid {
        /// Nodes in x, y, z.
        shape: [usize; 3],
    },
    /// The populations would not fit in the address space.
    #[error("a grid of {} x {} x {} nodes needs more memory than can be addressed: use a coarser spacing or a smaller box", shape[0], shape[1], shape[2])]
    GridTooLarge {
        /// Nodes in x, y, z.
        shape: [usize; 3],
    },
    /// The relaxation time is at, below or too close to 1/2, where the fluid is unstable.
    #[error(
        "the relaxation time is {tau}, it must be at least {least}: use a time step of at least {time_step:.3e} s at this spacing, a finer spacing at this time step, or a higher viscosity"
    )]
    RelaxationTime {
        /// Relaxation time in steps.
        tau: f64,
        /// Least that is accepted.
        least: f64,
        /// The time step at which tau is what is accepted, s.
        time_step: f64,
    },
    /// A relaxation rate with which populations grow, or do not relax at all.
    #[error("the {name} relaxation rate is {value} per step, it must be above 0 and below 2")]
    Rate {
        /// Which one.
        name: &'static str,
        /// Its value, per step.
        value: f64,
    },
    /// Thermal fluctuations that are not small.
    #[error(
        "a node's thermal velocity is {mach:.3} of the speed of sound, at most {limit} is small: use a coarser grid, a smaller time step or a lower temperature"
    )]
    TooHot {
        /// Root of the mean square of a component of the thermal velocity of a node, by the speed of sound.
        mach: f64,
        /// Greatest that is accepted.
        limit: f64,
    },
    /// A collision that can be kept at no temperature.
    #[error(
        "the collision adds to fluctuations by itself (variance {least:.2e} of theirs per step would have to be taken away): use BGK, TRT or a regularised collision"
    )]
    NotThermal {
        /// Least variance that noise would have to add in a step, by the variance of the populations.
        least: f64,
    },
    /// A collision that is not written for the lattice velocities.
    #[error("the collision {collision} is not made for {set}: take D3Q19, or central moments, which can do all")]
    NotOnThisSet {
        /// The collision.
        collision: &'static str,
        /// The lattice velocities.
        set: String,
    },
    /// Lattice velocities in a plane on a grid that is not one.
    #[error(
        "these lattice velocities have no motion along z, and the grid has {nodes} nodes there{}: use a grid one node thick that is periodic along z",
        if *periodic { "" } else { " and is closed" }
    )]
    NotPlane {
        /// Nodes along z.
        nodes: usize,
        /// Whether the grid repeats along z.
        periodic: bool,
    },
    /// A flow in which waves grow until the fluid diverges.
    #[error(
        "a flow of {speed:.3e} m/s is linearly unstable at relaxation time {tau}, where up to {stable:.3e} m/s is stable: use a finer grid, a lower velocity or, before the drive is set, a collision that is stable for longer (RecursiveRegularised, CentralMoments)"
    )]
    Unstable {
        /// Superficial velocity that was asked for, m/s.
        speed: f64,
        /// Greatest stable velocity, m/s.
        stable: f64,
        /// Relaxation time, in steps.
        tau: f64,
    },
    /// Flux control along an axis that does not repeat.
    #[error(
        "a flux of {velocity} m/s cannot be driven along axis {axis}, which has ends: make the axis periodic, or give a face a flux or a pressure"
    )]
    ClosedAxis {
        /// Direction, 0 to 2.
        axis: usize,
        /// Superficial velocity that was asked for, m/s.
        velocity: f64,
    },
    /// What stands at a face of the grid does not fit.
    #[error(transparent)]
    Face(#[from] FaceError),
    /// The processor lacks the instruction set that was asked for.
    #[error("this processor has no {wanted}: use InstructionSet::best()")]
    Unsupported {
        /// What was asked for.
        wanted: String,
    },
    /// The faces of the grid leave no room for a flow.
    #[error(transparent)]
    Walls(#[from] FluidError),
}
