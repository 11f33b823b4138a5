//! Flow through rectangular ducts against its series.

use super::finding::observed_order;
use super::profile::{Channel, interpolate, mean};
use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::reference::Table;
use lbm_ibm::lbm::{Collision, Precision};

/// A relaxation time at which a flow settles in few steps; with TRT the steady flow does not depend on it.
const TAU: f64 = 2.0;
/// Cells across the short side of a duct.
const CELLS: [usize; 3] = [8, 16, 32];

/// An error below which a quantity has no order to speak of, in 64 and in fewer bits.
const NEARLY_EXACT: [f64; 2] = [1e-5, 2e-4];

/// A flow in units of G b^2/mu, b half the height.
#[derive(Clone, Copy)]
struct Flow {
    /// Velocity in the middle.
    centre: f64,
    /// Mean of the profile.
    mean: f64,
    /// Mean of the nodes, which is the flux: the midpoint rule, whose own error is `G h^2/(24 mu)`.
    nodes: f64,
}

/// Velocity at all nodes in a duct of `nx` by `ny` cells, in units of G b^2/mu.
fn velocity(nx: usize, ny: usize, precision: Precision) -> Result<Vec<f64>, Fault> {
    let mut flow = Channel::new(nx, ny, Collision::default(), TAU, precision)?.settle(1e-9)?;
    let b = 0.5 * ny as f64;
    flow.iter_mut().for_each(|u| *u /= b * b);
    Ok(flow)
}

fn flow(nx: usize, ny: usize, precision: Precision) -> Result<Flow, Fault> {
    let u = velocity(nx, ny, precision)?;
    Ok(Flow {
        centre: interpolate(&u, [nx, ny], [0.5 * nx as f64, 0.5 * ny as f64]),
        mean: mean(&u, [nx, ny]),
        nodes: u.iter().sum::<f64>() / u.len() as f64,
    })
}

/// Flow in a duct with `n` cells across its short side. A long side that is not a whole number of cells lies between two
/// that are.
fn duct(aspect: f64, n: usize, precision: Precision) -> Result<Flow, Fault> {
    let long = n as f64 * aspect.max(1.0 / aspect);
    let duct = |long: usize| {
        let [nx, ny] = if aspect < 1.0 { [n, long] } else { [long, n] };
        flow(nx, ny, precision)
    };
    let part = long - long.floor();
    let low = duct(long.floor() as usize)?;
    if part < 1e-9 {
        return Ok(low);
    }
    let high = duct(long.ceil() as usize)?;
    let between = |of: fn(&Flow) -> f64| of(&low) + part * (of(&high) - of(&low));
    Ok(Flow {
        centre: between(|f| f.centre),
        mean: between(|f| f.mean),
        nodes: between(|f| f.nodes),
    })
}

/// A quantity of a flow, its column in the table, whether its value gates, and whether its order does.
type Quantity<'a> = (&'a str, &'a str, &'a dyn Fn(&Flow) -> f64, bool, bool);

/// Flux, centre velocity and friction factor at 8, 16 and 32 cells across the short side: within 1e-3 at 32 cells, and
/// of second order where the error at 32 cells is above 1e-5 (2e-4 in 32 bits, of which rounding has a tenth).
///
/// The friction factor is Darcy's times the Reynolds number of the hydraulic diameter `4 a b/(a + b)`, from the flux. The
/// mean of the profile has a tenth of the flux's error and gates with its ratio to the centre velocity; of so small an error
/// the order is only reported. The ratio of centre velocity and flux gates by its order: in a square duct of 32 cells the
/// midpoint rule alone puts it off by 1.2e-3.
pub fn duct_flow(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    let nearly_exact = NEARLY_EXACT[usize::from(effort.precision != Precision::F64)];
    for row in table.rows() {
        findings.begin(row.key(&["aspect"]));
        let aspect = row.number("aspect")?;
        let flows = CELLS
            .iter()
            .map(|&n| duct(aspect, n, effort.precision))
            .collect::<Result<Vec<_>, _>>()?;
        let diameter = 4.0 * aspect / (aspect + 1.0);
        let quantities: [Quantity; 6] = [
            (
                "u_centre/u_mean",
                "u_centre_over_mean",
                &|f| f.centre / f.mean,
                true,
                false,
            ),
            ("u_mean", "u_mean", &|f| f.mean, true, false),
            ("u_centre", "u_centre", &|f| f.centre, true, true),
            ("flux", "u_mean", &|f| f.nodes, true, true),
            ("fRe", "fRe_Darcy", &|f| 2.0 * diameter * diameter / f.nodes, true, true),
            (
                "u_centre/flux",
                "u_centre_over_mean",
                &|f| f.centre / f.nodes,
                false,
                true,
            ),
        ];
        for (name, column, quantity, value_gates, order_gates) in quantities {
            let reference = row.number(column)?;
            let values: Vec<f64> = flows.iter().map(quantity).collect();
            let error = |i: usize| (1.0 / CELLS[i] as f64, (values[i] / reference - 1.0).abs());
            for (value, cells) in values.iter().zip(CELLS) {
                let what = format!("{name}, {cells} cells");
                if value_gates && cells == 32 {
                    findings.check(&what, *value, reference, 1e-3);
                } else {
                    findings.report(&what, *value, reference, reference);
                }
            }
            for (i, cells) in ["8 to 16", "16 to 32"].into_iter().enumerate() {
                let (what, order) = (
                    format!("order of {name}, {cells}"),
                    observed_order(error(i), error(i + 1)),
                );
                if order_gates && error(2).1 > nearly_exact {
                    findings.check_at_least(&what, order, 1.9);
                } else {
                    findings.report(&what, order, 2.0, 1.0);
                }
            }
        }
    }
    Ok(findings)
}

/// Velocity in a square duct of 32 and 64 cells on the midline and on the diagonal, between and beyond the nodes by
/// polynomials; relative to the centre velocity.
pub fn square_duct_profile(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    let flows = [
        (32, velocity(32, 32, effort.precision)?),
        (64, velocity(64, 64, effort.precision)?),
    ];
    let centre = interpolate(&flows[1].1, [64; 2], [32.0; 2]);
    for row in table.rows() {
        findings.begin(row.key(&["y_over_b"]));
        let s = row.number("y_over_b")?;
        for (n, u) in &flows {
            let half = 0.5 * *n as f64;
            let at = |x: f64, y: f64| interpolate(u, [*n; 2], [half * (1.0 + x), half * (1.0 + y)]);
            let midline = row.number("u_midline")?;
            findings.check_scaled(
                &format!("u on the midline, {n} cells"),
                at(s, 0.0),
                midline,
                centre,
                1e-3,
            );
            let diagonal = row.number("u_diagonal")?;
            findings.check_scaled(
                &format!("u on the diagonal, {n} cells"),
                at(s, s),
                diagonal,
                centre,
                1e-3,
            );
        }
    }
    Ok(findings)
}
