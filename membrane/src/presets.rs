//! Cells with their moduli and where these come from.
//!
//! The paper's two cells are [`rbc_paper`] and [`ctc_paper`], by the numbers of its Table 1. The others are [`Preset`]s of
//! the physics: a shape, a [`Material`](crate::Material) and its source. A value that could not be checked against its source
//! says UNVERIFIED.

mod cancer;
mod healthy;
mod paper;

pub use cancer::{MCF7, MCF7_STRETCHER, MCF10, MCF10_STRETCHER, MOD_MCF7, MOD_MCF7_STRETCHER, PAPER_FORCE};
pub use healthy::{CAPSULE, LYMPHOCYTE, NEUTROPHIL, PLATELET, RED_CELL};
pub use paper::{
    CTC_DIAMETER, CTC_NODES, Form, Moduli, RBC_NODES, ctc_paper, ctc_paper_with_nodes, rbc_paper, rbc_paper_with_nodes,
};

use crate::{Cell, Disc, Material, MembraneError, Mesh, Spacing};
use lbm_ibm_coupling::Vec3;
use std::sync::Arc;

/// The shape of a cell at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Outline {
    /// A biconcave disc.
    Disc(Disc),
    /// A sphere of this diameter, m.
    Sphere(f64),
    /// An ellipsoid of these diameters, m.
    Ellipsoid([f64; 3]),
}

/// A cell that is known: what it measures, what it is made of, and where that comes from.
///
/// ```
/// use lbm_ibm_membrane::presets;
///
/// let cell = presets::NEUTROPHIL.with_nodes(300).cell()?;
/// assert_eq!(cell.mesh().nodes().len(), 300);
/// println!("{}", presets::NEUTROPHIL.source);
/// # Ok::<(), lbm_ibm_membrane::MembraneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Preset {
    /// What it is called.
    pub kind: &'static str,
    /// Its shape at rest.
    pub outline: Outline,
    /// Its moduli.
    pub material: Material,
    /// Nodes of its mesh.
    pub nodes: usize,
    /// Where shape and moduli come from.
    pub source: &'static str,
}

impl Preset {
    /// The same on a mesh of another number of nodes.
    #[must_use]
    pub fn with_nodes(mut self, nodes: usize) -> Self {
        self.nodes = nodes;
        self
    }

    /// The same of another material.
    #[must_use]
    pub fn with_material(mut self, material: Material) -> Self {
        self.material = material;
        self
    }

    /// Its mesh at rest.
    ///
    /// # Errors
    /// Those of the generators: [`MembraneError::TooFewNodes`], [`MembraneError::NotPositive`],
    /// [`MembraneError::NoSuchDisc`].
    pub fn mesh(&self) -> Result<Mesh, MembraneError> {
        match self.outline {
            Outline::Disc(disc) => disc.mesh(self.nodes, Spacing::Spiral),
            Outline::Sphere(diameter) => Mesh::sphere(0.5 * diameter, self.nodes),
            Outline::Ellipsoid(diameters) => Mesh::ellipsoid(0.5 * Vec3::from(diameters), self.nodes),
        }
    }

    /// The cell at rest.
    ///
    /// # Errors
    /// Those of [`Preset::mesh`] and [`Material::cell`].
    pub fn cell(&self) -> Result<Cell, MembraneError> {
        self.material.cell(self.kind, Arc::new(self.mesh()?))
    }
}
