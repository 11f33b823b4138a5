//! What can be asked for on the command line.

use crate::device::Device;
use crate::flow::Settings;
use clap::Parser;
use std::path::PathBuf;

/// Magnetic beads chain across a channel, are frozen, and cells flow against them: the tumour cell is held, the red cell
/// passes. Then the same with beads that the flow can move, and how far they bend.
#[derive(Clone, Debug, Parser)]
pub struct Options {
    /// Gap between neighbouring chains that the bias field is to give, um.
    #[arg(long, default_value_t = 2.5)]
    pub gap: f64,
    /// Sheets and beads.
    #[command(flatten)]
    pub device: Device,
    /// The flow.
    #[command(flatten)]
    pub flow: Settings,
    /// Longest time that cells flow, ms.
    #[arg(long, default_value_t = 160.0)]
    pub time: f64,
    /// Time that beads are coupled to the flow, ms.
    #[arg(long, default_value_t = 10.0)]
    pub coupled: f64,
    /// Time after the magnets are switched off, ms.
    #[arg(long, default_value_t = 8.0)]
    pub release: f64,
    /// Seed of the scatter.
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Folder for tables, charts and VTK files.
    #[arg(long, default_value = "out/bead_trap")]
    pub out: PathBuf,
    /// A short flow, to see that everything works.
    #[arg(long)]
    pub smoke: bool,
    /// Leave out the VTK files.
    #[arg(long)]
    pub no_vtk: bool,
}

impl Options {
    /// The options as given, or those of the smoke test.
    pub fn read() -> Self {
        let given = Self::parse();
        if !given.smoke {
            return given;
        }
        Self {
            time: 1.0,
            coupled: 0.5,
            release: 0.5,
            ..given
        }
    }
}
