//! What can be asked for on the command line.

use clap::{Parser, ValueEnum};
use lbm_ibm::coupling::{PN, UM};
use lbm_ibm::membrane::stretch::Patch;
use lbm_ibm::membrane::{Cell, Form, MembraneError, presets};
use std::path::PathBuf;

/// Calibrates the paper's cells: size against the force that pulls their ends, and the recovery in plasma at rest.
#[derive(Clone, Debug, Parser)]
pub struct Options {
    /// Folder for tables, charts and VTK files.
    #[arg(long, default_value = "out/stretch")]
    pub out: PathBuf,
    /// A few forces and coarse grids, to see that everything works.
    #[arg(long)]
    pub smoke: bool,
    /// Which cell.
    #[arg(long, value_enum, default_value_t = Cells::All)]
    pub cell: Cells,
    /// Membrane formulas, by commas.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [FormName::Paper2011, FormName::Corrected])]
    pub form: Vec<FormName>,
    /// Factor on the density of the fluid in the recovery, and so on the Reynolds number and the time step. Half of the
    /// default changes the time constants by about 1 %.
    #[arg(long, default_value_t = 40.0)]
    pub reynolds_scale: f64,
    /// Grid spacing of the recovery in um [default: 0.5 for the red cell, 1 for the tumour cell].
    #[arg(long)]
    pub resolution: Option<f64>,
    /// Relaxation time tau of the fluid in the recovery.
    #[arg(long, default_value_t = 1.0)]
    pub tau: f64,
}

/// One of the paper's cells, or both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Cells {
    /// Red blood cell.
    Rbc,
    /// Tumour cell.
    Ctc,
    /// Both.
    All,
}

/// One of the paper's cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Red blood cell.
    Rbc,
    /// Tumour cell.
    Ctc,
}

/// Membrane formulas by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormName {
    /// The formulas of the paper's software of 2011.
    #[value(name = "paper-2011")]
    Paper2011,
    /// Forms that keep momentum and come from an energy.
    Corrected,
}

impl Cells {
    /// The cells asked for.
    pub fn subjects(self) -> &'static [Subject] {
        match self {
            Self::Rbc => &[Subject::Rbc],
            Self::Ctc => &[Subject::Ctc],
            Self::All => &[Subject::Rbc, Subject::Ctc],
        }
    }
}

impl FormName {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper2011 => "paper-2011",
            Self::Corrected => "corrected",
        }
    }
}

impl Subject {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rbc => "rbc",
            Self::Ctc => "ctc",
        }
    }

    /// The cell at rest.
    pub fn cell(self, form: FormName) -> Result<Cell, MembraneError> {
        let form = match form {
            FormName::Paper2011 => Form::Paper2011,
            FormName::Corrected => Form::Corrected,
        };
        match self {
            Self::Rbc => presets::rbc_paper(form),
            Self::Ctc => presets::ctc_paper(form),
        }
    }

    /// Diameter at rest to which strains refer, m.
    pub fn diameter(self) -> f64 {
        match self {
            Self::Rbc => 8.0 * UM,
            Self::Ctc => presets::CTC_DIAMETER,
        }
    }

    /// Where it is pulled, the calibration's patch first: a bead's contact of 2 um at the rim, or a share of the nodes.
    pub fn patches(self) -> &'static [Patch] {
        match self {
            Self::Rbc => &[Patch::Chord(2.0 * UM)],
            Self::Ctc => &[Patch::Fraction(0.05), Patch::Fraction(0.02), Patch::Fraction(0.1)],
        }
    }

    /// Force at each end from which it is released, N.
    pub fn release_force(self) -> f64 {
        match self {
            Self::Rbc => 100.0 * PN,
            Self::Ctc => 79.0 * PN,
        }
    }
}
