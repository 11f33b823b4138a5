//! Static stretch of the paper's cells against its calibrations and the optical tweezers.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::reference::{ReferenceError, Row, Table};
use lbm_ibm::coupling::ImmersedBody;
use lbm_ibm::membrane::calibrate::{Calibration, Point};
use lbm_ibm::membrane::presets::Preset;
use lbm_ibm::membrane::stretch::{Ends, Load, Patch, Shape, Stretch};
use lbm_ibm::membrane::{Cell, Form, MembraneError, Modulus, presets};
use std::sync::Arc;

const UM: f64 = 1e-6;
const PN: f64 = 1e-12;
/// Greatest force left on a node of the physical red cell, N: at 1e-15 it is up to 1 % too short.
const FINE: f64 = 1e-16;

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

/// The physical and the paper's red cell against the optical tweezers' bars: the error is relative to half a bar, so 1
/// is its end. The physical one's transverse diameter below 88 pN: relative to the distance of the file's curve from
/// the mean. Last, what the physical cell predicts when its shear modulus comes from one force alone: relative to half
/// the interval.
pub fn rbc_optical_tweezers(table: &Table, effort: Effort) -> Outcome {
    let mut findings = compare(
        table,
        presets::rbc_paper,
        Patch::Chord(2.0 * UM),
        |f, row, paper, corrected| {
            let force = row.number("force_pN")?;
            let (middle, half) = bar(row, "exp_axial_lo", "exp_axial_hi")?;
            if half.is_finite() && force <= 88.0 {
                f.check_scaled("axial in bar, paper's (um)", paper.axial / UM, middle, half, 1.0);
                if let Some(corrected) = corrected {
                    f.report("axial, corrected (um)", corrected.axial / UM, middle, half);
                }
            } else if half.is_finite() {
                f.report("axial, paper's (um)", paper.axial / UM, middle, half);
            }
            let (middle, half) = bar(row, "exp_trans_lo", "exp_trans_hi")?;
            if half.is_finite() {
                f.report("transverse, paper's (um)", paper.transverse / UM, middle, half);
            }
            Ok(())
        },
    )?;
    let preset = presets::RED_CELL.with_nodes(if effort.quick { 400 } else { presets::RED_CELL.nodes });
    findings.begin(Default::default());
    let cell = preset.cell()?;
    let ends = Patch::Chord(2.0 * UM).ends(cell.reference())?;
    let mut stretch = Stretch::new(cell, Load::Beads(ends.clone())).with_tolerance(FINE);
    for row in table.rows() {
        let force = row.number("force_pN")?;
        let (middle, half) = bar(row, "exp_axial_lo", "exp_axial_hi")?;
        if !half.is_finite() {
            continue;
        }
        findings.begin(row.key(&["force_pN"]));
        let shape = stretch.pull(force * PN)?;
        let across = shape.transverse / UM;
        findings.check_scaled("axial in bar (um)", shape.axial / UM, middle, half, 1.0);
        if force >= 87.0 {
            let (middle, half) = bar(row, "exp_trans_lo", "exp_trans_hi")?;
            findings.check_scaled("transverse in bar (um)", across, middle, half, 1.0);
        } else {
            let (mean, curve) = (row.number("exp_trans_um")?, row.number("ref_curve_trans_um")?);
            findings.check_scaled(
                "transverse, nearer than the curve (um)",
                across,
                mean,
                (curve - mean).abs(),
                1.0,
            );
        }
    }
    predict(&mut findings, table, &preset, ends)?;
    Ok(findings)
}

/// Middle and half length of a bar.
fn bar(row: &Row, low: &str, high: &str) -> Result<(f64, f64), ReferenceError> {
    let (low, high) = (row.number(low)?, row.number(high)?);
    Ok((0.5 * (low + high), 0.5 * (high - low)))
}

/// Takes the shear modulus from the axial diameter at 47 pN, half a bar as its standard error, and predicts those at
/// higher forces.
fn predict(findings: &mut Findings, table: &Table, preset: &Preset, ends: Ends) -> Result<(), Fault> {
    const ONE: f64 = 47.0;
    const OTHERS: [f64; 2] = [108.5, 172.8];
    let row = |force: f64| {
        let mut rows = table.rows().iter();
        rows.find(|r| r.number("force_pN").is_ok_and(|f| f == force))
            .ok_or("the table lacks a force that is predicted or predicted from")
    };
    let (_, half) = bar(row(ONE)?, "exp_axial_lo", "exp_axial_hi")?;
    let point = Point::axial(ONE * PN, row(ONE)?.number("exp_axial_um")? * UM, half * UM);
    // From twice the preset's modulus, so that it has to be found.
    let start = preset.material.with(Modulus::Shear, 2.0 * preset.material.shear);
    findings.begin(row(ONE)?.key(&["force_pN"]));
    let cell = Calibration::new(start, Arc::new(preset.mesh()?), Load::Beads(ends), vec![Modulus::Shear]);
    let fit = cell.fit(&[point])?;
    let shear = fit.material.shear;
    findings.report(
        "shear modulus from here (N/m)",
        shear,
        preset.material.shear,
        preset.material.shear,
    );
    for force in OTHERS {
        findings.begin(row(force)?.key(&["force_pN"]));
        let axial = cell.predict(&fit, force * PN)?.axial;
        let measured = row(force)?.number("exp_axial_um")?;
        let half = 0.5 * (axial.high - axial.low) / UM;
        findings.check_scaled(
            "axial from 47 pN, in its interval (um)",
            axial.value / UM,
            measured,
            half,
            1.0,
        );
        findings.check("axial from 47 pN (um)", axial.value / UM, measured, 0.1);
    }
    Ok(())
}
