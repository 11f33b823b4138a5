//! What can be asked for on the command line.

use crate::device::Device;
use crate::flow::Settings;
use clap::Parser;
use std::path::PathBuf;

/// Which bias field lets red cells through and holds tumour cells: drives both against a row of bead chains at several bias
/// fields, says which fields separate them, and switches the magnets off at the end.
#[derive(Clone, Debug, Parser)]
pub struct Options {
    /// Bias fields over the sheets' field in their middle, by commas.
    #[arg(long, value_delimiter = ',', default_values_t = [0.0, 0.5, 1.0, 2.0, 4.0])]
    pub bias: Vec<f64>,
    /// Sheets and beads.
    #[command(flatten)]
    pub device: Device,
    /// The flow.
    #[command(flatten)]
    pub flow: Settings,
    /// Longest time that cells flow, ms.
    #[arg(long, default_value_t = 130.0)]
    pub time: f64,
    /// Time that held cells flow with beads coupled to the flow before the magnets are switched off, ms.
    #[arg(long, default_value_t = 5.0)]
    pub coupled: f64,
    /// Time after that, ms.
    #[arg(long, default_value_t = 15.0)]
    pub release: f64,
    /// Threads [default: all cores].
    #[arg(long)]
    pub threads: Option<usize>,
    /// Folder for tables and charts.
    #[arg(long, default_value = "out/tune_filter")]
    pub out: PathBuf,
    /// One field and a short flow, to see that everything works.
    #[arg(long)]
    pub smoke: bool,
}

impl Options {
    /// The options as given, or those of the smoke test.
    pub fn short_if_smoke(self) -> Self {
        if !self.smoke {
            return self;
        }
        Self {
            bias: vec![0.5],
            time: 1.0,
            coupled: 0.5,
            release: 0.5,
            ..self
        }
    }

    /// How many threads.
    pub fn thread_count(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.threads.unwrap_or_else(all).max(1)
    }
}
