//! How nodes and fluid meet.

use crate::{Bricks, Grid, ImmersedBody, Motion, RigidState, Soa3Mut, Soa3Ref, StateError, StateReader, StateWriter};
use std::any::Any;
use std::ops::Range;
use std::sync::Arc;

/// A body in a scene, as plain data.
#[derive(Clone, Debug)]
pub struct BodyInfo {
    /// Stable number of the body; never used again after the body is gone.
    pub id: u32,
    /// What it is.
    pub kind: String,
    /// Its nodes in the arrays of the scene.
    pub range: Range<usize>,
    /// Its triangles, node numbers relative to the start of the range.
    pub triangles: Arc<[[u32; 3]]>,
    /// How it moves.
    pub motion: Motion,
}

/// What an exchange cannot do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// Markers are so far apart that fluid leaks between them.
    #[error(
        "body {body}: markers are {gap_in_cells:.2} cells apart in triangle {triangle}, fluid leaks beyond {limit}; use a mesh with more nodes, a coarser grid, or allow more markers per triangle"
    )]
    MarkerGap {
        /// Body number.
        body: u32,
        /// Triangle of the body.
        triangle: usize,
        /// Distance in grid spacings.
        gap_in_cells: f64,
        /// Greatest distance allowed, in grid spacings.
        limit: f64,
    },
    /// A marker has left the grid through a face that is not periodic, or is so near to an open one that its kernel reaches beyond.
    #[error("body {body}: a marker at ({:.4e}, {:.4e}, {:.4e}) m is outside the grid, nearer to an open face than its kernel reaches, or not finite; end the run before a body comes to an open end, use a smaller time step or a stronger wall contact", position[0], position[1], position[2])]
    OutsideGrid {
        /// Body number.
        body: u32,
        /// Marker position, m.
        position: [f64; 3],
    },
    /// A surface is bent so sharply that the markers inside it cross over.
    #[error(
        "body {body}: the surface at ({:.4e}, {:.4e}, {:.4e}) m is bent more sharply than its markers are deep, {depth:.2e} m; use a finer grid, a narrower kernel, or markers on the surface", position[0], position[1], position[2]
    )]
    Fold {
        /// Body number.
        body: u32,
        /// Node position, m.
        position: [f64; 3],
        /// Depth of the markers, m.
        depth: f64,
    },
    /// A direction of the grid is narrower than the kernel.
    #[error(
        "the grid has {nodes} nodes along axis {axis}, the kernel covers {support}: use a finer grid or a narrower kernel"
    )]
    GridTooSmall {
        /// Direction, 0 to 2.
        axis: usize,
        /// Nodes along it.
        nodes: usize,
        /// Points of the kernel.
        support: usize,
    },
    /// A rigid body is too small for the grid to know its size.
    #[error(
        "body {body}: its radius is {radius_in_cells:.2} cells, it acts larger than it is below {least:.2}; use a finer grid or a narrower kernel"
    )]
    TooSmall {
        /// Body number.
        body: u32,
        /// Radius of the sphere of its volume, in grid spacings.
        radius_in_cells: f64,
        /// Least radius, in grid spacings.
        least: f64,
    },
    /// Nodes are to slip, and the viscosity by which they do is not known.
    #[error(
        "body {body}: its nodes slip by the fluid's viscosity, which is {viscosity} Pa s; call Exchange::set_viscosity before set_bodies, or switch the slip off"
    )]
    NoViscosity {
        /// Body number.
        body: u32,
        /// The viscosity that the exchange was told, Pa s.
        viscosity: f64,
    },
    /// The exchange cannot make bodies rigid.
    #[error("body {body} is rigid, and this exchange has no rigid bodies: use lbm-ibm-ibm's, or another motion")]
    NoRigid {
        /// Body number.
        body: u32,
    },
}

/// Interpolates fluid velocity to nodes and spreads node forces to the fluid; implemented by the crate `lbm-ibm-ibm`.
///
/// A scene calls [`Exchange::place`], [`Exchange::spread`] and [`Exchange::interpolate`] once a step in this order. Where it
/// has rigid bodies, [`Exchange::place_rigid`] comes before and [`Exchange::hold_rigid`] after the spreading.
pub trait Exchange: Any + Send {
    /// Takes the bodies of the scene, whenever one comes or goes; `reference` are the node positions (m) at which each
    /// body's surface is divided into markers.
    ///
    /// # Errors
    /// [`ExchangeError::GridTooSmall`].
    fn set_bodies(&mut self, bodies: &[BodyInfo], reference: Soa3Ref<'_>, grid: &Grid) -> Result<(), ExchangeError>;

    /// Takes the dynamic viscosity (Pa s) of the fluid around, and the numbers of the bodies with another one inside, with their inner viscosity over it; called
    /// before [`Exchange::set_bodies`]. By default they are of no use.
    fn set_viscosity(&mut self, _viscosity: f64, _inside: &[(u32, f64)]) {}

    /// Moves the markers to node positions `x` (m, unwrapped) and takes the bricks they touch into use.
    ///
    /// # Errors
    /// [`ExchangeError::MarkerGap`], [`ExchangeError::OutsideGrid`].
    fn place(&mut self, x: Soa3Ref<'_>, bricks: &mut Bricks) -> Result<(), ExchangeError>;

    /// Velocity of the fluid (m/s) at every node.
    fn interpolate(&mut self, bricks: &Bricks, velocity: Soa3Mut<'_>);

    /// Adds the forces on the nodes (N) to the bricks: the adjoint of [`Exchange::interpolate`].
    fn spread(&mut self, force: Soa3Ref<'_>, bricks: &mut Bricks);

    /// Takes the rigid bodies of the scene, by number, whenever a body comes or goes. Their nodes are in
    /// [`Exchange::set_bodies`] too, but meet the fluid only through these methods.
    ///
    /// # Errors
    /// [`ExchangeError::NoRigid`] where there are any, by default; [`ExchangeError::TooSmall`].
    fn set_rigid(&mut self, bodies: &[(u32, &dyn ImmersedBody)], _grid: &Grid) -> Result<(), ExchangeError> {
        match bodies.first() {
            Some(&(body, _)) => Err(ExchangeError::NoRigid { body }),
            None => Ok(()),
        }
    }

    /// Wants the bricks that rigid bodies touch; the next [`Exchange::place`] takes them into use.
    ///
    /// # Errors
    /// [`ExchangeError::OutsideGrid`].
    fn place_rigid(&mut self, _bodies: &[RigidState], _bricks: &mut Bricks) -> Result<(), ExchangeError> {
        Ok(())
    }

    /// Adds to the bricks the forces at which the fluid moves with the surfaces of the rigid bodies, each of them moving
    /// as it is driven or by its [`crate::RigidLaw`]; sets velocities and loads of the bodies. The bricks hold the forces
    /// of all other bodies and the velocity with half a step of these; `density` (kg/m3) and dynamic `viscosity` (Pa s) are the
    /// fluid's, `time_step` s.
    ///
    /// # Errors
    /// [`ExchangeError::NoRigid`].
    fn hold_rigid(
        &mut self,
        bodies: &mut [RigidState],
        _density: f64,
        _viscosity: f64,
        _time_step: f64,
        _bricks: &mut Bricks,
    ) -> Result<(), ExchangeError> {
        match bodies.first() {
            Some(body) => Err(ExchangeError::NoRigid { body: body.id }),
            None => Ok(()),
        }
    }

    /// Writes what it remembers from step to step, for [`crate::Scene::save`]. By default that is nothing.
    fn save(&self, _to: &mut StateWriter) {}

    /// Takes what [`Exchange::save`] has written, for the same bodies.
    ///
    /// # Errors
    /// [`StateError`].
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Ok(())
    }

    /// Mass of the fluid (kg) that follows a rigid body within a step, for a fluid of `density` (kg/m3).
    fn rigid_layer(&self, _body: u32, _density: f64) -> f64 {
        0.0
    }

    /// Longest time step (s) at which the explicit motion of `body` (nodes at `x`, m) in a fluid of dynamic `viscosity`
    /// (Pa s) and `density` (kg/m3) is stable, where the exchange can tell.
    fn stable_step(
        &self,
        _body: &mut dyn ImmersedBody,
        _x: Soa3Ref<'_>,
        _viscosity: f64,
        _density: f64,
    ) -> Option<f64> {
        None
    }
}
