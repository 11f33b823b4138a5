//! What can be asked for on the command line.

use clap::{Parser, ValueEnum};
use lbm_ibm::ibm::Kernel;
use lbm_ibm::membrane::Form;
use std::path::PathBuf;

/// Which gap lets a red blood cell through and holds a tumour cell: drives cells through slits of varying height.
#[derive(Clone, Debug, Parser)]
pub struct Options {
    /// Cells, by commas.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Subject::RbcEdge, Subject::RbcFace, Subject::Ctc, Subject::Neutrophil, Subject::Lymphocyte])]
    pub cells: Vec<Subject>,
    /// Gaps in um, by commas [default: 2 to 6 for red cells, 8 to 15 for tumour cells, 3 for leucocytes].
    #[arg(long, value_delimiter = ',')]
    pub gaps: Vec<f64>,
    /// Grid spacing in um [default: 0.5; 1 for tumour cells].
    #[arg(long)]
    pub resolution: Option<f64>,
    /// Where the fluid has the given speed.
    #[arg(long, value_enum, default_value_t = Where::Channel)]
    pub velocity: Where,
    /// Mean speed of the fluid in um/s.
    #[arg(long, default_value_t = 460.0)]
    pub speed: f64,
    /// What is held: the flux, or the pressure drop of the empty device at that flux.
    #[arg(long, value_enum, default_value_t = Drive::Flux)]
    pub drive: Drive,
    /// The paper's method: BGK, friction coupling, the numbers of its software's samples, the true density.
    #[arg(long)]
    pub paper_mode: bool,
    /// Folder for tables, charts and VTK files.
    #[arg(long, default_value = "out/gap_study")]
    pub out: PathBuf,
    /// Two coarse runs, to see that everything works.
    #[arg(long)]
    pub smoke: bool,
    /// Threads [default: all cores].
    #[arg(long)]
    pub threads: Option<usize>,
    /// Channel height in cell diameters.
    #[arg(long, default_value_t = 1.5)]
    pub height: f64,
    /// Channel width (the slit's long direction, periodic) in cell diameters.
    #[arg(long, default_value_t = 2.0)]
    pub width: f64,
    /// Length of the slit along the flow in um.
    #[arg(long, default_value_t = 5.0)]
    pub thickness: f64,
    /// Radius of the edges of the slit in um.
    #[arg(long, default_value_t = 1.0)]
    pub edge_radius: f64,
    /// Start of the cell's centre upstream of the slit, in cell diameters.
    #[arg(long, default_value_t = 1.5)]
    pub start: f64,
    /// Relaxation time tau.
    #[arg(long, default_value_t = 1.0)]
    pub tau: f64,
    /// Factor on the density, and so on the Reynolds number and the time step.
    #[arg(long, default_value_t = 60.0)]
    pub reynolds_scale: f64,
    /// Factor on the strength of the wall contact.
    #[arg(long, default_value_t = 1.0)]
    pub wall_strength: f64,
    /// Viscosity inside of leucocytes over that of plasma.
    #[arg(long, default_value_t = 1.0)]
    pub contrast: f64,
    /// Delta kernel.
    #[arg(long, value_enum, default_value_t = KernelName::Roma3)]
    pub kernel: KernelName,
    /// Formulas of the paper's membranes.
    #[arg(long, value_enum, default_value_t = FormName::Balanced)]
    pub form: FormName,
    /// Leave out the second run of each row, on a grid twice as coarse, that shows the grid's error.
    #[arg(long)]
    pub no_error: bool,
    /// Leave out the VTK files.
    #[arg(long)]
    pub no_vtk: bool,
}

/// A cell and how it meets the slit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Subject {
    /// Red cell, flat in the plane of the slit.
    RbcEdge,
    /// Red cell, flat across the flow.
    RbcFace,
    /// Tumour cell.
    Ctc,
    /// Neutrophil: a drop with cortical tension.
    Neutrophil,
    /// Lymphocyte, likewise.
    Lymphocyte,
}

/// Where the fluid has the given mean speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Where {
    /// In the channel before the slit.
    Channel,
    /// In the open gap.
    Gap,
}

/// What is held while the cell passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Drive {
    /// The flux; what the cell blocks goes past beside it.
    Flux,
    /// The pressure drop of the empty device at that flux.
    Pressure,
}

/// Delta kernels by points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum KernelName {
    /// 2 points, trilinear.
    Hat2,
    /// 3 points, Roma.
    Roma3,
    /// 4 points, Peskin.
    Peskin4,
}

impl KernelName {
    /// The kernel.
    pub fn kernel(self) -> Kernel {
        match self {
            Self::Hat2 => Kernel::TwoPoint,
            Self::Roma3 => Kernel::RomaThree,
            Self::Peskin4 => Kernel::PeskinFour,
        }
    }
}

/// Membrane formulas by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FormName {
    /// The formulas of the paper's software of 2011; a cell in a narrow slit drives itself.
    Paper2011,
    /// The same with each cell's net force and torque taken off: the same calibration.
    Balanced,
    /// Forms that keep momentum and come from an energy.
    Corrected,
}

impl FormName {
    /// The form.
    pub fn form(self) -> Form {
        match self {
            Self::Paper2011 => Form::Paper2011,
            Self::Balanced => Form::Paper2011Balanced,
            Self::Corrected => Form::Corrected,
        }
    }
}
