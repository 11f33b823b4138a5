//! Scenes on disk, to go on from.

use lbm_ibm_coupling::{Scene, SceneError};
use lz4_flex::frame::{BlockSize, FrameDecoder, FrameEncoder, FrameInfo};
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Why a scene is not on the disk, or cannot be taken from there.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The scene cannot tell its state.
    #[error("the scene cannot be saved: {0}")]
    Save(SceneError),
    /// The file cannot be written; one of the same name is as it was.
    #[error("cannot write {}: {source}; is there room, and may the folder be written to?", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
    /// The file cannot be read, or is no whole LZ4 frame.
    #[error("cannot read {}: {source}; give a file of `write_checkpoint`", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
    /// The scene cannot take what the file holds.
    #[error("{}: {source}", path.display())]
    Restore {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        source: SceneError,
    },
}

/// Writes the state of a scene ([`Scene::save`]) to `path`, compressed as an LZ4 frame. It is written beside it and then renamed,
/// so that whoever is interrupted keeps the file of the time before.
///
/// ```
/// # use lbm_ibm::prelude::*;
/// # use lbm_ibm::output::{read_checkpoint, write_checkpoint};
/// # fn build() -> Result<Scene, Box<dyn std::error::Error>> {
/// #     let water = Fluid::new(Grid::new([8, 8, 8], 1.0 * UM, [true; 3]), 1e3, 1e-3, Pace::Tau(1.0))?;
/// #     Ok(Scene::with_fluid(water, DeltaExchange::new(Kernel::RomaThree)))
/// # }
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let folder = std::env::temp_dir().join(format!("lbm-ibm-checkpoint-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// let path = folder.join("run.scene");
/// let mut scene = build()?;
/// if path.exists() {
///     read_checkpoint(&mut scene, &path)?; // goes on where the last run ended
/// }
/// Run::new()
///     .until_step(20)
///     .observe(Schedule::Steps(10), |scene| Ok(write_checkpoint(scene, &path)?))
///     .run(&mut scene)?;
/// # let mut again = build()?;
/// # read_checkpoint(&mut again, &path)?;
/// # assert_eq!((again.steps(), again.save()?), (20, scene.save()?));
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok(()) }
/// ```
///
/// # Errors
/// [`CheckpointError::Save`], [`CheckpointError::Write`].
pub fn write_checkpoint(scene: &Scene, path: &Path) -> Result<(), CheckpointError> {
    let bytes = scene.save().map_err(CheckpointError::Save)?;
    let mut beside = path.as_os_str().to_owned();
    beside.push(".part");
    let write = || -> std::io::Result<()> {
        let frame = FrameInfo::new().block_size(BlockSize::Max4MB).content_checksum(true);
        let mut encoder = FrameEncoder::with_frame_info(frame, File::create(&beside)?);
        encoder.write_all(&bytes)?;
        // On the disk before the name points to it.
        encoder.finish()?.sync_all()?;
        fs::rename(&beside, path)
    };
    let path = path.to_owned();
    write().map_err(|source| CheckpointError::Write { path, source })
}

/// Takes the state in the file at `path` ([`Scene::restore`]).
///
/// # Errors
/// [`CheckpointError::Read`], [`CheckpointError::Restore`].
pub fn read_checkpoint(scene: &mut Scene, path: &Path) -> Result<(), CheckpointError> {
    let at = || path.to_owned();
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| FrameDecoder::new(file).read_to_end(&mut bytes))
        .map_err(|source| CheckpointError::Read { path: at(), source })?;
    scene
        .restore(&bytes)
        .map_err(|source| CheckpointError::Restore { path: at(), source })
}
