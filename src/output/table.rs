//! Tables as CSV, and JSON.

use super::OutputError;
use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes rows as CSV with a header line of their field names.
///
/// # Errors
/// [`OutputError`] with the path.
pub fn write_csv<R: Serialize>(path: &Path, rows: impl IntoIterator<Item = R>) -> Result<(), OutputError> {
    let mut writer = csv::Writer::from_path(path).map_err(|e| OutputError::at(path, e))?;
    for row in rows {
        writer.serialize(row).map_err(|e| OutputError::at(path, e))?;
    }
    writer.flush().map_err(|e| OutputError::at(path, e))
}

/// Writes a value as indented JSON.
///
/// # Errors
/// [`OutputError`] with the path.
pub fn write_json(path: &Path, value: &impl Serialize) -> Result<(), OutputError> {
    let file = File::create(path).map_err(|e| OutputError::at(path, e))?;
    let mut writer = BufWriter::new(file);
    serde_json::to_writer_pretty(&mut writer, value).map_err(|e| OutputError::at(path, e))?;
    writeln!(writer)
        .and_then(|()| writer.flush())
        .map_err(|e| OutputError::at(path, e))
}
