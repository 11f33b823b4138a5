//! Static stretch of the paper's cells against its calibrations and the optical tweezers.

use super::{Effort, Findings, Outcome};
use crate::reference::{ReferenceError, Row, Table};
use lbm_ibm::coupling::ImmersedBody;
use lbm_ibm::membrane::stretch::{Patch, Shape, Stretch};
use lbm_ibm::membrane::{Cell, Form, MembraneError, presets};

const UM: f64 = 1e-6;
const PN: f64 = 1e-12;

/// The shape of a cell at each row's force, pulled from one force to the next in ascending order; none from the first
/// force on at which the cell has no equilibrium.
fn shapes(cell: &Cell, patch: Patch, forces: &[f64]) -> Result<Vec<Option<Shape>>, MembraneError> {
    let mut order: Vec<usize> = (0..forces.len()).collect();
    order.sort_by(|&a, &b| forces[a].total_cmp(&forces[b]));
    let mut stretch = Stretch::new(cell.clone(), patch.ends(cell.reference())?);
    let mut shapes = vec![None; forces.len()];
    for i in order {
        match stretch.pull(forces[i]) {
            Ok(shape) => shapes[i] = Some(shape),
            Err(MembraneError::NoEquilibrium { .. }) => break,
            Err(error) => return Err(error),
        }
    }
    Ok(shapes)
}

fn forces(table: &Table) -> Result<Vec<f64>, ReferenceError> {
    table.rows().iter().map(|r| Ok(r.number("force_pN")? * PN)).collect()
}

/// Pulls both forms of a cell and hands each row its two shapes.
fn compare(
    table: &Table,
    preset: fn(Form) -> Result<Cell, MembraneError>,
    patch: Patch,
    mut judge: impl FnMut(&mut Findings, &Row, &Shape, Option<&Shape>) -> Result<(), ReferenceError>,
) -> Outcome {
    let mut findings = Findings::of(table.name());
    let forces = forces(table)?;
    findings.begin(Default::default());
    let paper = shapes(&preset(Form::Paper2011)?, patch, &forces)?;
    let corrected = shapes(&preset(Form::Corrected)?, patch, &forces)?;
    for (i, row) in table.rows().iter().enumerate() {
        findings.begin(row.key(&["force_pN"]));
        let shape = paper[i]
            .as_ref()
            .ok_or("the paper's cell has no equilibrium under a force of the table")?;
        judge(&mut findings, row, shape, corrected[i].as_ref())?;
    }
    Ok(findings)
}

/// The paper's red cell pulled over a chord of 2 um at each end: axial, transverse and thickness.
pub fn paper_rbc_stretch(table: &Table, _effort: Effort) -> Outcome {
    compare(
        table,
        presets::rbc_paper,
        Patch::Chord(2.0 * UM),
        |f, row, paper, corrected| {
            let (axial, transverse) = (row.number("axial_um")?, row.number("trans_um")?);
            let thickness = row.number("thickness_um")?;
            f.check("axial (um)", paper.axial / UM, axial, 0.06);
            f.check("transverse (um)", paper.transverse / UM, transverse, 0.06);
            f.check("thickness (um)", paper.thickness / UM, thickness, 0.06);
            if let Some(corrected) = corrected {
                let across = corrected.transverse / UM;
                f.report("axial, corrected (um)", corrected.axial / UM, axial, axial);
                f.report("transverse, corrected (um)", across, transverse, transverse);
            }
            Ok(())
        },
    )
}

/// The paper's tumour cell pulled at 5 % of its nodes at each end: axial diameter, and the 30 % strain at 79 pN.
pub fn paper_ctc_stretch(table: &Table, _effort: Effort) -> Outcome {
    compare(
        table,
        presets::ctc_paper,
        Patch::Fraction(0.05),
        |f, row, paper, corrected| {
            let axial = row.number("axial_um")?;
            f.check("axial (um)", paper.axial / UM, axial, 0.03);
            if let Some(corrected) = corrected {
                f.report("axial, corrected (um)", corrected.axial / UM, axial, axial);
            }
            if row.number("force_pN")? == 79.0 {
                f.check_scaled("strain", paper.axial / (16.0 * UM) - 1.0, 0.297, 1.0, 0.01);
            }
            Ok(())
        },
    )
}

/// The paper's red cell against the optical tweezers' bars: the error is relative to half a bar, so 1 is its end.
pub fn rbc_optical_tweezers(table: &Table, _effort: Effort) -> Outcome {
    compare(
        table,
        presets::rbc_paper,
        Patch::Chord(2.0 * UM),
        |f, row, paper, corrected| {
            let force = row.number("force_pN")?;
            let (lo, hi) = (row.number("exp_axial_lo")?, row.number("exp_axial_hi")?);
            let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
            if half.is_finite() && force <= 88.0 {
                f.check_scaled("axial in bar (um)", paper.axial / UM, middle, half, 1.0);
                if let Some(corrected) = corrected {
                    f.report("axial, corrected (um)", corrected.axial / UM, middle, half);
                }
            } else if half.is_finite() {
                f.report("axial (um)", paper.axial / UM, middle, half);
            }
            let (lo, hi) = (row.number("exp_trans_lo")?, row.number("exp_trans_hi")?);
            if (hi - lo).is_finite() {
                f.report(
                    "transverse (um)",
                    paper.transverse / UM,
                    0.5 * (lo + hi),
                    0.5 * (hi - lo),
                );
            }
            Ok(())
        },
    )
}
