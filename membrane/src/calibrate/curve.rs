//! Stretching curves from files.

use super::{Measured, Point};
use crate::MembraneError;
use std::path::Path;

/// Reads a stretching curve from a CSV file: columns `force_pN` and `axial_um`, and where they are there
/// `axial_error_um`, `transverse_um` and `transverse_error_um` (standard errors), in any order and among others; an
/// empty field or `nan` is no value. Lines that begin with # are comments.
///
/// # Errors
/// [`MembraneError::Import`].
pub fn read_curve(path: impl AsRef<Path>) -> Result<Vec<Point>, MembraneError> {
    let path = path.as_ref();
    points(path).map_err(|reason| MembraneError::Import {
        path: path.display().to_string(),
        reason,
    })
}

fn points(path: &Path) -> Result<Vec<Point>, String> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_path(path)
        .map_err(|e| e.to_string())?;
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    let column = |name: &str| header.iter().position(|h| h == name);
    let needed = |name: &str| column(name).ok_or_else(|| format!("it has no column {name}"));
    let (force, axial) = (needed("force_pN")?, needed("axial_um")?);
    let (axial_error, transverse, transverse_error) = (
        column("axial_error_um"),
        column("transverse_um"),
        column("transverse_error_um"),
    );
    let mut points = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|e| e.to_string())?;
        let number = |k: Option<usize>| -> Result<Option<f64>, String> {
            let text = k.and_then(|k| record.get(k)).unwrap_or("");
            if text.is_empty() || text.eq_ignore_ascii_case("nan") {
                return Ok(None);
            }
            match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Some(value)),
                _ => Err(format!("row {} has {text:?} where a number is wanted", row + 1)),
            }
        };
        let measured = |value: Option<usize>, error: Option<usize>| -> Result<Option<Measured>, String> {
            let error = number(error)?.unwrap_or(0.0);
            Ok(number(value)?.map(|value| Measured {
                value: value * 1e-6,
                error: error * 1e-6,
            }))
        };
        let lacks = |name: &str| format!("row {} lacks {name}", row + 1);
        points.push(Point {
            force: number(Some(force))?.ok_or_else(|| lacks("force_pN"))? * 1e-12,
            axial: measured(Some(axial), axial_error)?.ok_or_else(|| lacks("axial_um"))?,
            transverse: measured(transverse, transverse_error)?,
        });
    }
    if points.is_empty() {
        return Err("it has no rows".to_owned());
    }
    Ok(points)
}
