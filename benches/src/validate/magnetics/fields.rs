//! The paper's pair of sheets, and point dipoles.

use super::{bead, solve, vector};
use crate::reference::{ReferenceError, Row, Table};
use crate::validate::{Effort, Findings, Outcome};
use lbm_ibm::coupling::nalgebra::Matrix3;
use lbm_ibm::coupling::{Soa3, UM, Vec3};
use lbm_ibm::magnetics::{FieldSource, FixedDipoles, SheetPair, Uniform};
use std::collections::BTreeMap;

/// Columns of the gradient and where they stand in it.
const GRADIENT: [(usize, usize, &str); 6] = [
    (0, 0, "dBx_dx"),
    (0, 1, "dBx_dy"),
    (0, 2, "dBx_dz"),
    (1, 1, "dBy_dy"),
    (1, 2, "dBy_dz"),
    (2, 2, "dBz_dz"),
];

fn sheets(row: &Row) -> Result<SheetPair, crate::Fault> {
    let (half, separation) = ([100.0 * UM, 50.0 * UM], 120.0 * UM);
    Ok(match row.text("config")? {
        "opposite" => SheetPair::opposite(Vec3::zeros(), half, separation, 1.0)?,
        "same" => SheetPair::equal(Vec3::zeros(), half, separation, 1.0)?,
        _ => return Err(row.unknown("config").into()),
    })
}

fn field(row: &Row) -> Result<(Vec3, Matrix3<f64>), ReferenceError> {
    let b = vector(row, ["Bx_T", "By_T", "Bz_T"])?;
    let mut g = Matrix3::zeros();
    for (i, j, column) in GRADIENT {
        g[(i, j)] = row.number(column)?;
        g[(j, i)] = g[(i, j)];
    }
    Ok((b, g))
}

/// Field to 1e-13 and gradient to 1e-11, greatest error of a component over the greatest component that the table has for
/// the same sheets.
pub fn charge_sheet_field(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let mut largest = BTreeMap::new();
    for row in table.rows() {
        let (b, g) = field(row)?;
        let scale = largest.entry(row.text("config")?).or_insert((0.0f64, 0.0f64));
        *scale = (scale.0.max(b.amax()), scale.1.max(g.amax()));
    }
    for row in table.rows() {
        findings.begin(row.key(&["config", "x_m", "y_m", "z_m"]));
        let (b, g) = field(row)?;
        let (b_scale, g_scale) = largest[row.text("config")?];
        let place = vector(row, ["x_m", "y_m", "z_m"])?;
        let (b_found, g_found) = sheets(row)?.field_and_gradient(place, 0.0);
        findings.check_scaled("B, worst component (T)", (b_found - b).amax(), 0.0, b_scale, 1e-13);
        let quantity = "grad B, worst component (T/m)";
        findings.check_scaled(quantity, (g_found - g).amax(), 0.0, g_scale, 1e-11);
    }
    Ok(findings)
}

/// Force and both torques of two point dipoles, each to 1e-13 of its own size; the forces on both are opposite.
pub fn dipole_pair_force(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let beads = vec![bead(1e-3, 2.0)?; 2];
    for row in table.rows() {
        findings.begin(row.key(&["id"]));
        let x: Soa3 = [vector(row, ["x1", "y1", "z1"])?, vector(row, ["x2", "y2", "z2"])?]
            .into_iter()
            .collect();
        let m: Soa3 = [vector(row, ["m1x", "m1y", "m1z"])?, vector(row, ["m2x", "m2y", "m2z"])?]
            .into_iter()
            .collect();
        let mut model = FixedDipoles::new().with_moments(m);
        let out = solve(&mut model, &beads, &x, &Uniform::new(Vec3::zeros()))?;
        let force = vector(row, ["F2x", "F2y", "F2z"])?;
        for (quantity, found, expected) in [
            ("F2, error (N)", out.force.get(1), force),
            ("F1, error (N)", out.force.get(0), -force),
            (
                "T1, error (N m)",
                out.torque.get(0),
                vector(row, ["T1x", "T1y", "T1z"])?,
            ),
            (
                "T2, error (N m)",
                out.torque.get(1),
                vector(row, ["T2x", "T2y", "T2z"])?,
            ),
        ] {
            findings.check_scaled(quantity, (found - expected).norm(), 0.0, expected.norm(), 1e-13);
        }
    }
    Ok(findings)
}
