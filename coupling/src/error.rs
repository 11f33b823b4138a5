//! What a scene reports that it cannot do.

use crate::{ExchangeError, FluidError, StateError};

/// Why a scene cannot be built, or why a run ended early. Nothing is lost: the scene stays as it was at the fault.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The fluid reports a fault.
    #[error(transparent)]
    Fluid(#[from] FluidError),
    /// The exchange between bodies and fluid reports a fault.
    #[error(transparent)]
    Exchange(#[from] ExchangeError),
    /// A state cannot be made or taken.
    #[error(transparent)]
    State(#[from] StateError),
    /// A body was placed inside a wall, or has been pushed into one.
    #[error("body {body} ({kind}): {inside} of {nodes} nodes are inside wall part {part}, the deepest by {depth:.3e} m at ({:.4e}, {:.4e}, {:.4e}) m; place it farther from the wall, or use a stronger contact or a smaller time step", position[0], position[1], position[2])]
    BodyInWall {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Nodes inside.
        inside: usize,
        /// Nodes of the body.
        nodes: usize,
        /// Wall part of the deepest node.
        part: u32,
        /// Depth of the deepest node, m.
        depth: f64,
        /// Its position, m.
        position: [f64; 3],
    },
    /// The time step is over the limit of one term.
    #[error(
        "the time step of {time_step:.3e} s is over the limit of {limit:.3e} s set by {term}; use a smaller relaxation time, a finer grid or a softer law"
    )]
    TimeStep {
        /// What sets the limit.
        term: String,
        /// The scene's time step, s.
        time_step: f64,
        /// The limit, s.
        limit: f64,
    },
    /// A quantity that must be positive is not.
    #[error("{what} is {value:e}, it must be finite and positive")]
    NotPositive {
        /// What it is, with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A body that the fluid moves is in a scene without a fluid.
    #[error(
        "body {body} ({kind}) is moved by a fluid, but the scene has none; give it another motion, or build the scene with a fluid"
    )]
    NeedsFluid {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
    },
    /// The body is not rigid.
    #[error("body {body} ({kind}) is not rigid: it has neither a pose nor a load of its own")]
    NotRigid {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
    },
    /// A velocity that a rigid body is to have is not finite.
    #[error("the velocity given to body {body} is not finite")]
    NotFiniteMotion {
        /// Body number.
        body: u32,
    },
    /// A body says that it is rigid but not what it weighs.
    #[error("body {body} ({kind}): its motion is rigid, but it gives no mass; implement `ImmersedBody::rigid`")]
    NoMass {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
    },
    /// Positions that are not one per node.
    #[error("body {body} has {nodes} nodes, but {given} positions were given: give one position per node")]
    WrongLength {
        /// Body number.
        body: u32,
        /// Nodes of the body.
        nodes: usize,
        /// Positions given.
        given: usize,
    },
    /// The nodes of a rigid body follow its pose.
    #[error("body {body} ({kind}) is rigid, its nodes follow its pose: use `Scene::set_pose`")]
    FollowsPose {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
    },
    /// There is no body of that number.
    #[error("there is no body {body}; the scene has {bodies} bodies")]
    UnknownBody {
        /// The number asked for.
        body: u32,
        /// Bodies in the scene.
        bodies: usize,
    },
    /// A node position or velocity is not finite.
    #[error("body {body} ({kind}): node {node} is not finite at step {step}; use a smaller time step")]
    NotFinite {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Node of the body.
        node: usize,
        /// Step of the scene.
        step: u64,
    },
    /// A node moves too far in one step.
    #[error(
        "body {body} ({kind}): node {node} moves {distance:.3e} m in one step ({step}), the guard allows {limit:.3e} m; use a smaller time step"
    )]
    Displacement {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Node of the body.
        node: usize,
        /// Distance in one step, m.
        distance: f64,
        /// Greatest distance allowed, m.
        limit: f64,
        /// Step of the scene.
        step: u64,
    },
    /// The volume of a closed body has drifted.
    #[error(
        "body {body} ({kind}): volume has changed by {percent:.2} % at step {step}, the guard allows {limit_percent:.2} %; use a smaller time step, a finer grid or a stiffer volume law"
    )]
    VolumeDrift {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Change in per cent.
        percent: f64,
        /// Greatest change allowed, in per cent.
        limit_percent: f64,
        /// Step of the scene.
        step: u64,
    },
    /// The area of a body has grown beyond what the guard allows.
    #[error(
        "body {body} ({kind}): area strain is {strain:.3} at step {step}, the guard allows {limit:.3}; the membrane would be torn"
    )]
    AreaStrain {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Relative growth of the area.
        strain: f64,
        /// Greatest growth allowed.
        limit: f64,
        /// Step of the scene.
        step: u64,
    },
    /// A triangle has collapsed.
    #[error(
        "body {body} ({kind}): triangle {triangle} has shrunk to {ratio:.2e} of its area at step {step}; use a stiffer local area law or a smaller time step"
    )]
    CollapsedTriangle {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Triangle of the body.
        triangle: usize,
        /// Area over area at rest.
        ratio: f64,
        /// Step of the scene.
        step: u64,
    },
    /// An edge has become too long.
    #[error(
        "body {body} ({kind}): the edge between nodes {} and {} is {stretch:.2} times its length at rest at step {step}, the limit is {limit:.2}; use a stiffer law, a smaller time step, or a higher limit", nodes[0], nodes[1]
    )]
    StretchedEdge {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// Nodes of the edge, numbered within the body.
        nodes: [u32; 2],
        /// Length over length at rest.
        stretch: f64,
        /// Greatest allowed.
        limit: f64,
        /// Step of the scene.
        step: u64,
    },
    /// A triangle has turned over onto its neighbour.
    #[error(
        "body {body} ({kind}): triangles {} and {} have turned {degrees:.0} degrees against each other at step {step}, the limit is {limit_degrees:.0}: one of them is inverted; use stiffer bending, more nodes, or a smaller time step", triangles[0], triangles[1]
    )]
    InvertedTriangle {
        /// Body number.
        body: u32,
        /// What the body is.
        kind: String,
        /// The two triangles of the body.
        triangles: [u32; 2],
        /// Angle between their normals, degrees.
        degrees: f64,
        /// Greatest allowed, degrees.
        limit_degrees: f64,
        /// Step of the scene.
        step: u64,
    },
}
