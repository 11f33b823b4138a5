//! How nodes and fluid meet.

use crate::{Bricks, Grid, ImmersedBody, Motion, Soa3Mut, Soa3Ref};
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
    /// A marker has left the grid through a face that is not periodic.
    #[error("body {body}: a marker at ({:.4e}, {:.4e}, {:.4e}) m is outside the grid or not finite; use a smaller time step or a stronger wall contact", position[0], position[1], position[2])]
    OutsideGrid {
        /// Body number.
        body: u32,
        /// Marker position, m.
        position: [f64; 3],
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
}

/// Interpolates fluid velocity to nodes and spreads node forces to the fluid; implemented by the crate `lbm-ibm-ibm`.
///
/// A scene calls [`Exchange::place`], [`Exchange::interpolate`] and [`Exchange::spread`] once a step in this order.
pub trait Exchange: Any + Send {
    /// Takes the bodies of the scene, whenever one comes or goes; `reference` are the node positions (m) at which each
    /// body's surface is divided into markers.
    ///
    /// # Errors
    /// [`ExchangeError::GridTooSmall`].
    fn set_bodies(&mut self, bodies: &[BodyInfo], reference: Soa3Ref<'_>, grid: &Grid) -> Result<(), ExchangeError>;

    /// Moves the markers to node positions `x` (m, unwrapped) and takes the bricks they touch into use.
    ///
    /// # Errors
    /// [`ExchangeError::MarkerGap`], [`ExchangeError::OutsideGrid`].
    fn place(&mut self, x: Soa3Ref<'_>, bricks: &mut Bricks) -> Result<(), ExchangeError>;

    /// Velocity of the fluid (m/s) at every node.
    fn interpolate(&mut self, bricks: &Bricks, velocity: Soa3Mut<'_>);

    /// Adds the forces on the nodes (N) to the bricks: the adjoint of [`Exchange::interpolate`].
    fn spread(&mut self, force: Soa3Ref<'_>, bricks: &mut Bricks);

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
