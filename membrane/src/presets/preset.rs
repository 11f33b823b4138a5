//! A cell that is known.

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
