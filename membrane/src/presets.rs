//! Cells with their moduli and where these come from.
//!
//! The paper's two cells are [`rbc_paper`] and [`ctc_paper`], by the numbers of its Table 1. The table gives bare
//! numbers. Read with lengths in um and forces in nN, and with the formulas of the software of the time, they
//! reproduce both of the paper's calibrations; see [`crate::stretch`].
//!
//! The others are [`Preset`]s of the physics: a shape, a [`Material`](crate::Material) and its source. A value that
//! could not be checked against its source says UNVERIFIED.

mod cancer;
mod healthy;
mod preset;

pub use cancer::{MCF7, MCF7_STRETCHER, MCF10, MCF10_STRETCHER, MOD_MCF7, MOD_MCF7_STRETCHER, PAPER_FORCE};
pub use healthy::{CAPSULE, LYMPHOCYTE, NEUTROPHIL, PLATELET, RED_CELL};
pub use preset::{Outline, Preset};

use crate::laws::{Area2011, Balanced, Bending, Bending2011, FourModuli, LocalArea, Reach, Stretching, Volume};
use crate::{Cell, Disc, MembraneError, Mesh, Spacing};
use std::sync::Arc;

/// Which formulas give the paper's moduli their meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Form {
    /// Those of the software that the paper used, needed for its calibration; the area forces do not keep momentum, and
    /// a cell in a narrow slit drives itself.
    Paper2011,
    /// The same with net force and torque taken off ([`Balanced`]): the same calibration, momentum kept.
    Paper2011Balanced,
    /// Gradients of energies with the same response at small strain.
    Corrected,
}

/// The paper's four moduli, the area's one twice: K^S, K^B, K^A local and global in N, K^V in Pa.
///
/// They belong to a mesh: with another edge length L0 the same continuum has [`Moduli::for_edge`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli {
    /// Stretching of the edges, N.
    pub stretching: f64,
    /// Bending between the triangles, N.
    pub bending: f64,
    /// Area of each triangle, N.
    pub local_area: f64,
    /// Area of the cell, N.
    pub global_area: f64,
    /// Volume of the cell, Pa.
    pub volume: f64,
}

impl Moduli {
    /// Table 1 of the paper, red blood cell: 0.008, 0.0016, 0.01, 1 nN and 10 nN/um2, for 400 nodes and 8 um.
    pub const RBC_PAPER: Self = Self {
        stretching: 0.008e-9,
        bending: 0.0016e-9,
        local_area: 0.01e-9,
        global_area: 1e-9,
        volume: 10e3,
    };

    /// Table 1 of the paper, tumour cell: 0.0023, 0.000464, 0.0029, 0.29 nN and 2.9 nN/um2, for 306 nodes and 16 um.
    pub const CTC_PAPER: Self = Self {
        stretching: 0.0023e-9,
        bending: 0.000464e-9,
        local_area: 0.0029e-9,
        global_area: 0.29e-9,
        volume: 2.9e3,
    };

    /// The moduli that give the same continuum on a mesh with edges of `to` (m) as these do with edges of `from` (m).
    ///
    /// For equilateral triangles of edge L0: shear modulus sqrt(3)/4 ks/L0 and area modulus 2 k/L0, so ks and k go
    /// with L0; bending stiffness 3/4 kb L0/theta0 with theta0 near pi, so kb goes with 1/L0; kv is the volume modulus
    /// itself.
    pub fn for_edge(self, from: f64, to: f64) -> Self {
        let ratio = to / from;
        Self {
            stretching: self.stretching * ratio,
            bending: self.bending / ratio,
            local_area: self.local_area * ratio,
            global_area: self.global_area * ratio,
            volume: self.volume,
        }
    }

    /// A cell named `kind` at rest on `mesh` with these moduli.
    ///
    /// In [`Form::Corrected`] they are converted by [`LocalArea::modulus_from_2011`] and
    /// [`Bending::stiffness_from_2011`].
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn cell(&self, kind: &str, mesh: Arc<Mesh>, form: Form) -> Result<Cell, MembraneError> {
        let m = &*mesh;
        let cell = Cell::new(kind, mesh.clone());
        Ok(match form {
            Form::Paper2011 => cell
                .with_law(Stretching::new(m, self.stretching)?)
                .with_law(Bending2011::new(m, self.bending)?)
                .with_law(Area2011::new(m, Reach::Local, self.local_area)?)
                .with_law(Area2011::new(m, Reach::Global, self.global_area)?)
                .with_law(Volume::new(m, self.volume)?),
            Form::Paper2011Balanced => cell
                .with_law(Stretching::new(m, self.stretching)?)
                .with_law(
                    Balanced::new(m.nodes().len())
                        .with_law(Bending2011::new(m, self.bending)?)
                        .with_law(Area2011::new(m, Reach::Local, self.local_area)?)
                        .with_law(Area2011::new(m, Reach::Global, self.global_area)?),
                )
                .with_law(Volume::new(m, self.volume)?),
            Form::Corrected => cell.with_law(FourModuli::new(
                m,
                self.stretching,
                Bending::stiffness_from_2011(m, self.bending),
                LocalArea::modulus_from_2011(m, self.local_area),
                LocalArea::modulus_from_2011(m, self.global_area),
                self.volume,
            )?),
        })
    }
}

/// Nodes of the paper's red blood cell.
pub const RBC_NODES: usize = 400;
/// Nodes of the paper's tumour cell.
pub const CTC_NODES: usize = 306;
/// Diameter of the paper's tumour cell, m.
pub const CTC_DIAMETER: f64 = 16e-6;

/// The paper's red blood cell: 400 nodes, 796 triangles, 8 um, its axis along z, on a [`Spacing::Spiral`] mesh.
///
/// With [`Form::Paper2011`] the pattern of the mesh is part of the model: on meshes of the same size and number of
/// nodes the stretched cell's axial diameter differs by 5 %, its transverse diameter and thickness by 5 to 10 %.
///
/// # Errors
/// None that is expected; the mesh generator's are passed on.
pub fn rbc_paper(form: Form) -> Result<Cell, MembraneError> {
    rbc_paper_with_nodes(form, RBC_NODES)
}

/// The paper's tumour cell: 306 nodes, 608 triangles, a sphere of 16 um.
///
/// # Errors
/// None that is expected; the mesh generator's are passed on.
pub fn ctc_paper(form: Form) -> Result<Cell, MembraneError> {
    ctc_paper_with_nodes(form, CTC_NODES)
}

/// The paper's red blood cell on a mesh of `nodes` nodes, its moduli converted by [`Moduli::for_edge`].
///
/// # Errors
/// [`MembraneError::TooFewNodes`].
pub fn rbc_paper_with_nodes(form: Form, nodes: usize) -> Result<Cell, MembraneError> {
    let mesh = Disc::RBC_PAPER.mesh(nodes, Spacing::Spiral)?;
    let moduli = Moduli::RBC_PAPER.for_edge(edge(RBC_NODES, &mesh), mesh.mean_edge());
    moduli.cell("rbc", Arc::new(mesh), form)
}

/// The paper's tumour cell on a mesh of `nodes` nodes, its moduli converted by [`Moduli::for_edge`].
///
/// # Errors
/// [`MembraneError::TooFewNodes`].
pub fn ctc_paper_with_nodes(form: Form, nodes: usize) -> Result<Cell, MembraneError> {
    let mesh = Mesh::sphere(0.5 * CTC_DIAMETER, nodes)?;
    let moduli = Moduli::CTC_PAPER.for_edge(edge(CTC_NODES, &mesh), mesh.mean_edge());
    moduli.cell("ctc", Arc::new(mesh), form)
}

/// Mean edge (m) that `mesh` would have with `nodes` nodes: its own, times the root of the triangles' ratio.
fn edge(nodes: usize, mesh: &Mesh) -> f64 {
    mesh.mean_edge() * (mesh.triangles().len() as f64 / (2 * nodes - 4) as f64).sqrt()
}
