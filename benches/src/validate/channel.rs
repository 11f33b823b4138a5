//! Slip at the flat walls of a channel.

use super::finding::gate_of;
use super::profile::Channel;
use super::{Effort, Findings, Outcome};
use crate::reference::{ReferenceError, Row, Table};
use lbm_ibm::lbm::{Collision, Precision};

/// Steps beyond which a row is left out of a quick run.
const QUICK_STEPS: usize = 2_000_000;

/// The slip of BGK and TRT between plates against the formula `(16 L - 3)/12`, in units in which the exact flow is
/// `y (N - y)`: the flow minus the parabola, at the node where it is farthest from the formula.
///
/// The slip of TRT with magic number 3/16 is zero to 1e-10 of the centre velocity `N^2/4`; that of any other collision is
/// the formula to 1e-8 in these units, in which it is 1/4 and more but for one tau. The slip of the row, which was solved
/// for numerically, gates at 1e-8 of the centre velocity.
///
/// In 32 bits all three gate at 1e-5 of the centre velocity and what a rounding in every step makes of the flow on top, `2^-24 N^2/(8 nu)` with
/// the viscosity in lattice units: 4e-2 of tau 0.501 on 32 nodes, 1.5e-5 of tau 2.
pub fn poiseuille_wall_slip(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    for row in table.rows() {
        findings.begin(row.key(&["collision", "tau", "N"]));
        let collision = collision(row)?;
        let (tau, n) = (row.number("tau")?, row.number("N")?);
        let (formula, centre) = (collision.wall_slip(tau), 0.25 * n * n);
        // The flow is y (n - y)/2 in units of the channel.
        let expected = |x: f64| 0.5 * (x * (n - x) + formula);
        let mut channel = Channel::new(n as usize, 1, collision, tau, effort.precision)?.start(expected);
        if effort.quick && 10 * channel.decay() > QUICK_STEPS {
            findings.left_out += 1;
            continue;
        }
        let flow = channel.settle(1e-13)?;
        let slip = flow.iter().enumerate().map(|(i, u)| {
            let y = i as f64 + 0.5;
            2.0 * u - y * (n - y)
        });
        let worst = slip
            .max_by(|a, b| (a - formula).abs().total_cmp(&(b - formula).abs()))
            .unwrap_or(f64::NAN);
        // A force that a channel is under moves it by `n^2/(8 nu)`.
        let gate = |tight| gate_of(effort.precision, tight, centre / (2.0 * channel.lattice_viscosity()));
        if formula == 0.0 {
            findings.check_scaled("slip", worst, 0.0, centre, gate(1e-10));
        } else {
            let scale = if effort.precision == Precision::F64 {
                1.0
            } else {
                centre
            };
            findings.check_scaled("slip by the formula", worst, formula, scale, gate(1e-8));
        }
        findings.check_scaled("slip of the row", worst, row.number("slip")?, centre, gate(1e-8));
    }
    Ok(findings)
}

/// BGK, or TRT with the row's magic number.
fn collision(row: &Row) -> Result<Collision, ReferenceError> {
    match row.text("collision")? {
        "BGK" => Ok(Collision::Bgk),
        "TRT" => Ok(Collision::Trt {
            magic: row.number("Lambda")?,
        }),
        _ => Err(row.unknown("collision")),
    }
}
