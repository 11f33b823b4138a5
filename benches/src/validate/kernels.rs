//! Hydrodynamic radii of delta kernels.

use super::rigid::key;
use super::{Effort, Findings, Outcome};
use crate::reference::{ReferenceError, Row, Table};
use crate::scenes::side_by_side;
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::ibm::Kernel;
use lbm_ibm::ibm::stokes::{kernel_radius, sphere_radius, surface_radius};
use lbm_ibm::membrane::Mesh;

/// The kernel that a row names; what follows the name in brackets says who uses it.
fn kernel(row: &Row) -> Result<Kernel, ReferenceError> {
    match row.text("kernel")?.split_whitespace().next() {
        Some("hat2") => Ok(Kernel::TwoPoint),
        Some("Roma3") => Ok(Kernel::RomaThree),
        Some("Bspline3") => Ok(Kernel::SplineThree),
        Some("Peskin4") => Ok(Kernel::PeskinFour),
        Some("cosine4") => Ok(Kernel::CosineFour),
        Some("Bspline4") => Ok(Kernel::SplineFour),
        _ => Err(row.unknown("kernel")),
    }
}

/// Radius of a single marker, mean over its place in a cell, within 5 %.
pub fn ibm_kernel_radius(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    for row in table.rows() {
        findings.begin(row.key(&["kernel"]));
        let (radius, deviation) = kernel_radius(kernel(row)?, 32, 60);
        findings.check("a/h", radius, row.number("a_h_over_h")?, 0.05);
        findings.report("relative deviation", deviation, row.number("rel_std")?, 1.0);
    }
    // No file has the wider kernels: the crate's own figures against the computation, and how little they vary.
    for (kernel, spread) in [(Kernel::SmoothedFour, 0.002), (Kernel::SixPoint, 0.0005)] {
        findings.begin(key(&[("kernel", format!("{kernel:?}"))]));
        let (radius, deviation) = kernel_radius(kernel, 32, 60);
        findings.check("a/h", kernel.marker_radius(), radius, 0.001);
        findings.check_scaled("relative deviation", deviation, 0.0, 1.0, spread);
    }
    Ok(findings)
}

/// How much larger than its markers a sphere acts, within 0.05 spacings, on a box at least four radii wide.
pub fn ibm_sphere_radius(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let computed = side_by_side(table.rows(), |row| {
        let (radius, spacing) = (row.number("R_over_h")?, row.number("spacing_over_h")?);
        let box_edge = 48 * (radius / 12.0).ceil().max(1.0) as usize;
        Ok(sphere_radius(kernel(row)?, radius, spacing, box_edge)? - radius)
    })?;
    for (row, (shift, seconds)) in table.rows().iter().zip(computed) {
        findings.begin_done(row.key(&["kernel", "R_over_h", "spacing_over_h"]), seconds);
        findings.check_scaled("shift/h", shift, row.number("shift_over_h")?, 1.0, 0.05);
    }
    // After the correction: a mesh of four spacings with its markers deeper by the kernel's shift.
    let mesh = Mesh::sphere(4.0, 642)?;
    let x: Soa3 = mesh
        .nodes()
        .iter()
        .map(|p| p + Vec3::new(24.13, 24.29, 24.41))
        .collect();
    let corrected = side_by_side(&Kernel::ALL, |&kernel| {
        Ok(surface_radius(kernel, true, x.view(), mesh.triangles(), 48)?)
    })?;
    for (kernel, (radius, seconds)) in Kernel::ALL.iter().zip(corrected) {
        let row = [
            ("kernel", format!("{kernel:?}")),
            ("corrected R_over_h", "4".to_owned()),
        ];
        findings.begin_done(key(&row), seconds);
        findings.check("drag over that of the true size", radius / 4.0, 1.0, 0.01);
    }
    Ok(findings)
}
