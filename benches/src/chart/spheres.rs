//! An array of spheres: wall rule, resolution and relaxation time.

use super::{Chart, Row, Work, seconds_per_call};
use crate::Fault;
use crate::validate::arrays::{Numerics, sphere_drag};
use lbm_ibm::coupling::{Bricks, Lattice, Vec3};
use lbm_ibm::lbm::{Collision, OddRate, Precision, WallRule};

/// Radius over the period, of a solid fraction of 1/8, and the drag over Stokes' (Zick and Homsy 1982), of four digits.
const RADIUS: f64 = 0.3101752454;
const DRAG: f64 = 4.292;
/// Half a unit of its last digit: no error is given as less.
const DIGIT: f64 = 5e-4 / DRAG;

const TRT: Collision = Collision::Trt { magic: 3.0 / 16.0 };
const CENTRAL: Collision = Collision::CentralMoments {
    bulk: 1.0,
    odd: OddRate::Magic(3.0 / 16.0),
};

/// Wall rules, relaxation times, collisions and precisions, a curve each.
const CURVES: &[(&str, WallRule, f64, Collision, Precision)] = &[
    ("halfway, tau 1", WallRule::Halfway, 1.0, TRT, Precision::F64),
    ("halfway, tau 4", WallRule::Halfway, 4.0, TRT, Precision::F64),
    ("Bouzidi, tau 0.7", WallRule::Bouzidi, 0.7, TRT, Precision::F64),
    ("Bouzidi, tau 1", WallRule::Bouzidi, 1.0, TRT, Precision::F64),
    ("Bouzidi, tau 4", WallRule::Bouzidi, 4.0, TRT, Precision::F64),
    ("CLI, tau 1", WallRule::Cli, 1.0, TRT, Precision::F64),
    ("CLI, tau 2", WallRule::Cli, 2.0, TRT, Precision::F64),
    ("CLI, tau 4", WallRule::Cli, 4.0, TRT, Precision::F64),
    ("CLI, tau 4, f32", WallRule::Cli, 4.0, TRT, Precision::F32),
    ("CLI, tau 4, 16 bits", WallRule::Cli, 4.0, TRT, Precision::F16),
    ("CLI, tau 1, BGK", WallRule::Cli, 1.0, Collision::Bgk, Precision::F64),
    (
        "CLI, tau 1, regularised",
        WallRule::Cli,
        1.0,
        Collision::RecursiveRegularised,
        Precision::F64,
    ),
    (
        "CLI, tau 4, central moments",
        WallRule::Cli,
        4.0,
        CENTRAL,
        Precision::F64,
    ),
];
/// Nodes along the period, a point each: 4 to 10 to the radius.
const CELLS: &[usize] = &[13, 16, 20, 26, 32];
/// Where the sphere is, in spacings.
const PLACES: [[f64; 3]; 3] = [[0.13, 0.29, 0.41], [0.0, 0.0, 0.0], [0.5, 0.25, 0.0]];

/// Drag in the array.
pub const SPHERES: Chart = Chart {
    name: "spheres",
    title: "Drag on an array of spheres, an eighth of the volume",
    cost: "cost of a steady flow from rest, s",
    error: "relative error of the drag, rms of three places",
    advice: "CLI, and tau 2 to 4 for a steady flow: its error does not depend on tau. Bouzidi comes near at tau 0.7 only, \
              halfway walls err 2 to 20 times as much.",
    cases: drags,
};

/// Error of the drag over steps until it is steady.
fn drags(quick: bool) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    for &cells in if quick { &CELLS[..2] } else { CELLS } {
        let mut works = Vec::<Work>::new();
        let mut found = Vec::new();
        for &(_, rule, tau, collision, precision) in CURVES {
            let numerics = Numerics {
                collision,
                precision,
                ..Numerics::new(rule, tau, cells)
            };
            let (mut squares, mut steps) = (0.0, 0.0);
            let mut last = None;
            for place in PLACES {
                let (drag, fluid) = sphere_drag(numerics, RADIUS, Vec3::from(place))?;
                squares += (drag / DRAG - 1.0).powi(2) / PLACES.len() as f64;
                steps += fluid.steps() as f64 / PLACES.len() as f64;
                last = Some(fluid);
            }
            let mut fluid = last.ok_or("no place")?;
            found.push((squares.sqrt().max(DIGIT), steps, fluid.fluid_nodes() as f64));
            let bricks = Bricks::new(fluid.grid());
            // An even and an odd step.
            works.push(Box::new(move || {
                fluid.advance(&bricks)?;
                Ok(fluid.advance(&bricks)?)
            }));
        }
        let pairs = seconds_per_call(quick, &mut works)?;
        for ((&(curve, ..), (error, steps, nodes)), pair) in CURVES.iter().zip(found).zip(pairs) {
            rows.push(Row {
                case: String::new(),
                curve: curve.into(),
                label: format!("{cells} nodes"),
                cost_s: 0.5 * pair * steps,
                updates: (steps * nodes).round(),
                error,
            });
        }
    }
    Ok(rows)
}
