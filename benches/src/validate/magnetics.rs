//! Magnetic sources, forces between beads on every rung of the ladder, and the motion of beads.
//!
//! Tables are in units of the radius a, the applied field H0, mu0 H0^2 a^2 for forces and 4 pi a^3 H0 for moments.

mod chains_at_rest;
mod clusters;
mod fields;
mod motion;
mod pairs;

pub use clusters::{bead_chain_tension, bead_cluster_force};
pub use fields::{charge_sheet_field, dipole_pair_force};
pub use motion::{bead_dynamics, sphere_wall_drag};
pub use pairs::{two_sphere_force, unequal_pair_force};

use super::Findings;
use crate::Fault;
use crate::reference::{ReferenceError, Row};
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{Bead, FieldSource, Intrinsic, MU0, Model, Problem, Solution};
use std::f64::consts::PI;

/// Radius a of the beads, m.
const RADIUS: f64 = 2e-6;
/// Applied field mu0 H0, T.
const FIELD: f64 = 0.05;
/// Unit of the tables' forces, N.
const FORCE: f64 = FIELD * FIELD * RADIUS * RADIUS / MU0;
/// Unit of the tables' moments, A m2.
const MOMENT: f64 = 4.0 * PI * RADIUS * RADIUS * RADIUS * FIELD / MU0;

/// A linear bead of `radius` (in a) and permeability.
fn bead(radius: f64, permeability: f64) -> Result<Bead, Fault> {
    Ok(Bead::new(radius * RADIUS, 1500.0, Intrinsic::new(permeability - 1.0)?)?)
}

/// Beads at `x` (m) solved by a model.
fn solve(model: &mut dyn Model, beads: &[Bead], x: &Soa3, source: &dyn FieldSource) -> Result<Solution, Fault> {
    let mut out = Solution::new();
    model.solve(&Problem::new(beads, x.view(), source, 0.0)?, &mut out)?;
    Ok(out)
}

/// Three columns as a vector.
fn vector(row: &Row, columns: [&str; 3]) -> Result<Vec3, ReferenceError> {
    let [x, y, z] = columns.map(|c| row.number(c));
    Ok(Vec3::new(x?, y?, z?))
}

/// Multipole orders with which a pair at `s` mean radii between centres is known to 1e-6 or better, at most `most`: orders
/// fall as exp(-2 order acosh(s/2)).
fn orders_at(s: f64, most: usize) -> usize {
    let eta = (0.5 * s.max(2.0001)).acosh();
    ((16.0 / eta).ceil() as usize).clamp(4, most)
}

/// Passes where the error that a model reports covers its true error: the error is the true one over the reported.
fn covers(findings: &mut Findings, quantity: &str, off: f64, reported: f64) {
    findings.check_scaled(quantity, off, 0.0, reported, 1.0);
}
