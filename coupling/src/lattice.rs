//! A fluid as its neighbours see it.

use crate::{Boundary, Bricks, Grid, Inside, Vec3, Wrench};
use std::any::Any;
use std::sync::Arc;

/// What a fluid reports that it cannot go on with, or cannot take.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FluidError {
    /// A population is not finite or the flow is faster than the method can carry.
    #[error("the fluid failed at node ({}, {}, {}), step {step}: {what}; use a smaller time step or a finer grid", node[0], node[1], node[2])]
    Diverged {
        /// Node indices.
        node: [usize; 3],
        /// Fluid step.
        step: u64,
        /// What was seen there.
        what: String,
    },
    /// A channel between walls has too few nodes to carry a flow.
    #[error("the gap at node ({}, {}, {}) is {cells} cell(s) wide along {axis}, a flow needs {needed}: use a spacing of at most {spacing:.3e} m, or let the fluid fill narrow gaps", node[0], node[1], node[2])]
    NarrowGap {
        /// A node in the gap.
        node: [usize; 3],
        /// Fluid nodes across the gap.
        cells: usize,
        /// Least number that is accepted.
        needed: usize,
        /// Direction across the gap.
        axis: char,
        /// Greatest spacing that would do, m.
        spacing: f64,
    },
    /// There is no fluid node left between the walls.
    #[error(
        "no fluid is left: all {nodes} nodes lie inside walls; check the sign of the boundary's distance (positive in the fluid)"
    )]
    NoFluid {
        /// Nodes of the grid.
        nodes: usize,
    },
    /// The fluid has one viscosity everywhere.
    #[error("the fluid cannot have another viscosity inside of cells: {why}")]
    OneViscosity {
        /// What stands against it, and what would help.
        why: String,
    },
    /// A saved state that is not one of this fluid.
    #[error("the saved state does not fit this fluid, {what}: build the fluid as the saved one was")]
    State {
        /// Where they differ.
        what: String,
    },
    /// Something that a third party's fluid reports.
    #[error(transparent)]
    Other(Box<dyn std::error::Error + Send + Sync>),
}

/// What became of the walls on the grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallReport {
    /// Nodes in the fluid.
    pub fluid_nodes: usize,
    /// Nodes in walls.
    pub solid_nodes: usize,
    /// Links between a fluid node and a wall.
    pub wall_links: usize,
    /// Fewest fluid nodes across any gap between walls, and the axis (0 to 2) it was seen along.
    pub narrowest: Option<(usize, usize)>,
    /// Nodes in gaps too narrow to carry a flow that were made solid, where the fluid was told to do so.
    pub filled_nodes: usize,
    /// Links that take the wall to be half way, for want of a second fluid node to find it from, where the fluid would
    /// interpolate.
    pub uninterpolated_links: usize,
    /// Links between two fluid nodes that a wall thinner than a cell parts: as a whole, or beside its rim in part.
    pub thin_links: usize,
    /// Neighbouring nodes in two walls with a gap between them that is too narrow for a node, and lost.
    pub closed_gaps: usize,
}

/// Velocity, pressure and solid mask on the whole grid, x fastest, for files and pictures.
#[derive(Clone, Debug, Default)]
pub struct Macroscopic {
    /// Velocity components, m/s.
    pub velocity: [Vec<f64>; 3],
    /// Pressure about the rest state, Pa.
    pub pressure: Vec<f64>,
    /// 1 in walls, 0 in the fluid.
    pub solid: Vec<u8>,
}

/// A fluid on a regular grid, with no type parameter. All arguments are SI and f64.
pub trait Lattice: Any + Send {
    /// The grid.
    fn grid(&self) -> &Grid;

    /// Time step, s.
    fn time_step(&self) -> f64;

    /// Dynamic viscosity, Pa s.
    fn viscosity(&self) -> f64;

    /// Density, kg/m3 (the scaled one, where the Reynolds number is scaled).
    fn density(&self) -> f64;

    /// Takes the walls as they stand at time `t` (s). The flow starts anew where a wall was.
    ///
    /// # Errors
    /// [`FluidError::NarrowGap`], [`FluidError::NoFluid`].
    fn set_walls(&mut self, walls: Option<Arc<dyn Boundary>>, t: f64) -> Result<WallReport, FluidError>;

    /// Fills the velocity of the bricks in use, zero in walls. The bricks hold the forces of the last step, or where there
    /// are rigid bodies those of the coming one; half a step of them belongs to the velocity.
    fn read_velocity(&mut self, bricks: &mut Bricks);

    /// One time step under the forces in the bricks.
    ///
    /// # Errors
    /// [`FluidError::Diverged`] where the fluid notices.
    fn advance(&mut self, bricks: &Bricks) -> Result<(), FluidError>;

    /// Several time steps under the forces in the bricks. A fluid may be faster than step by step, with the same result.
    ///
    /// # Errors
    /// As for [`Lattice::advance`].
    fn advance_many(&mut self, bricks: &Bricks, steps: usize) -> Result<(), FluidError> {
        (0..steps).try_for_each(|_| self.advance(bricks))
    }

    /// Takes the nodes that lie inside of cells with a viscosity of their own, before every step in which there are any or
    /// have been.
    ///
    /// # Errors
    /// [`FluidError::OneViscosity`] where the fluid cannot do that, by default.
    fn set_inside(&mut self, inside: &Inside) -> Result<(), FluidError> {
        if inside.is_empty() {
            return Ok(());
        }
        Err(FluidError::OneViscosity {
            why: "it does not know how to; use lbm-ibm-lbm's, or cells with the viscosity of the fluid around"
                .to_owned(),
        })
    }

    /// The uniform force density that drives the flow now, N/m3: minus the pressure gradient it stands for.
    fn body_force(&self) -> Vec3 {
        Vec3::zeros()
    }

    /// Superficial velocity: the integral of the velocity over the box divided by the volume of the box, m/s.
    fn superficial_velocity(&self) -> Vec3 {
        Vec3::zeros()
    }

    /// Force (N) and torque (N m, about the point `about`, m) of the fluid in the last step on each part of the walls that it
    /// was given, if it can tell. A uniform force density that stands for a pressure gradient acts on the fluid alone: a body
    /// of volume V would feel V times [`Lattice::body_force`] more.
    fn wall_loads(&self, _walls: &dyn Boundary, _t: f64, _about: Vec3) -> Option<Vec<Wrench>> {
        None
    }

    /// Looks at every node, for the guard.
    ///
    /// # Errors
    /// [`FluidError::Diverged`] with the first offending node.
    fn check(&self) -> Result<(), FluidError> {
        Ok(())
    }

    /// The whole state, if the fluid can tell: a fluid built alike that takes it goes on as this one would.
    fn save(&self) -> Option<Vec<u8>> {
        None
    }

    /// Takes a state of [`Lattice::save`].
    ///
    /// # Errors
    /// [`FluidError::State`].
    fn restore(&mut self, _state: &[u8]) -> Result<(), FluidError> {
        Err(FluidError::State {
            what: "it can take none".to_string(),
        })
    }

    /// Velocity, pressure and solid mask on the whole grid, for files and pictures.
    fn macroscopic(&self) -> Option<Macroscopic> {
        None
    }
}
