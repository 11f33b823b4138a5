//! Files, charts and progress.

mod checkpoint;
mod error;
#[cfg(feature = "plot")]
mod plot;
#[cfg(feature = "progress")]
mod progress;
mod table;
#[cfg(feature = "vtk")]
mod vtk;

pub use checkpoint::{CheckpointError, read_checkpoint, write_checkpoint};
pub use error::OutputError;
#[cfg(feature = "plot")]
pub use plot::{COLOURS, Chart, Mark};
#[cfg(feature = "progress")]
pub use progress::Progress;
pub use table::{write_csv, write_json};
#[cfg(feature = "vtk")]
pub use vtk::{BeadSeries, VtkSeries, write_walls};
