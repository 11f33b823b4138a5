//! Steady flow in a box whose lid slides: the square of Ghia, Ghia and Shin (1982) and the cube of Albensoeder and Kuhlmann
//! (2005).

use super::profile::interpolate;
use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::reference::Table;
use lbm_ibm::coupling::{Boundary, Bricks, Grid, Lattice, Macroscopic, Probe, UM, Vec3};
use lbm_ibm::lbm::{Fluid, Pace, Precision};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Water.
const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
/// Speed of the lid, cells per step: a Mach number of 0.17.
const LID: f64 = 0.1;
/// Greatest change of a velocity in the time in which the lid passes once, over the speed of the lid, in a steady flow.
const STEADY: f64 = 1e-5;
/// Passes of the lid in which a flow has to become steady.
const PASSES: usize = 200;

/// The walls of the box; the edges that the lid shares with walls at rest are at rest.
struct Walls {
    length: f64,
    speed: f64,
}

impl Boundary for Walls {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let side = x.x.min(self.length - x.x);
        let (floor, lid) = (x.y, self.length - x.y);
        let normal = if side < floor.min(lid) {
            Vec3::x() * (0.5 * self.length - x.x).signum()
        } else {
            Vec3::y() * (0.5 * self.length - x.y).signum()
        };
        let touches = |distance: f64| distance < 1e-6 * UM;
        let slides = touches(lid) && !touches(side);
        Probe {
            velocity: Vec3::x() * if slides { self.speed } else { 0.0 },
            ..Probe::at_rest(side.min(floor).min(lid), normal)
        }
    }
}

/// A box of `n` cells along x and y, closed or periodic along z, whose lid at the end of y slides along x.
struct Cavity {
    n: usize,
    /// Velocity over that of the lid.
    velocity: [Vec<f64>; 3],
    /// Passes of the lid until the flow was steady.
    passes: usize,
}

impl Cavity {
    fn new(n: usize, depth: Option<usize>, reynolds: f64, precision: Precision) -> Result<Self, Fault> {
        let length = n as f64 * UM;
        let speed = reynolds * VISCOSITY / (DENSITY * length);
        let grid = Grid::new([n, n, depth.unwrap_or(1)], UM, [false, false, depth.is_none()]);
        let walls = Walls { length, speed };
        let bricks = Bricks::new(&grid);
        let mut fluid =
            Fluid::new(grid, DENSITY, VISCOSITY, Pace::TimeStep(LID * UM / speed))?.with_precision(precision);
        fluid.set_walls(Some(Arc::new(walls)), 0.0)?;
        let mut last: Option<Macroscopic> = None;
        for passes in 0..PASSES {
            for _ in 0..(n as f64 / LID) as usize {
                fluid.advance(&bricks)?;
            }
            fluid.check()?;
            let now = fluid.macroscopic().ok_or("the fluid has no velocity field")?;
            let change = last.map_or(f64::INFINITY, |last| {
                let pairs = now.velocity.iter().flatten().zip(last.velocity.iter().flatten());
                pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
            });
            if change < STEADY * speed {
                let velocity = now.velocity.map(|u| u.into_iter().map(|u| u / speed).collect());
                return Ok(Self { n, velocity, passes });
            }
            last = Some(now);
        }
        Err(format!("Re {reynolds}, {n} cells: the flow has not become steady in {PASSES} passes of the lid").into())
    }

    /// Component `a` of the velocity at (`x`, `y`) in the middle of z, in units of the box and the lid.
    fn at(&self, a: usize, x: f64, y: f64) -> f64 {
        let (n, layer) = (self.n, self.n * self.n);
        let depth = self.velocity[a].len() / layer;
        let plane = |k: usize| {
            let field = &self.velocity[a][k * layer..][..layer];
            interpolate(field, [n; 2], [x * n as f64, y * n as f64])
        };
        0.5 * (plane((depth - 1) / 2) + plane(depth / 2))
    }
}

/// Root mean square of the differences of pairs of a value and its reference.
fn off(pairs: &[[f64; 2]]) -> f64 {
    let squares = pairs.iter().map(|[u, reference]| (u - reference).powi(2));
    (squares.sum::<f64>() / pairs.len() as f64).sqrt()
}

/// Root mean square of the references.
fn size(pairs: &[[f64; 2]]) -> f64 {
    let squares = pairs.iter().map(|[_, reference]| reference * reference);
    (squares.sum::<f64>() / pairs.len() as f64).sqrt()
}

fn key(items: &[(&str, String)]) -> BTreeMap<String, String> {
    items.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect()
}

/// Velocities on the midlines of the square at Reynolds numbers of 100, 400 and 1000, on 64 and 128 cells: within 1 % of the
/// speed of the lid on 128, root mean square. The rows on walls are left out, and a value that is known to be a misprint.
///
/// Over the velocities of the table themselves the error is reported: at 100 it converges to 3.5 % on the horizontal midline,
/// where the table has a greatest velocity of 0.1753 and a least of -0.2453; later work has 0.1796 and -0.2538 (Marchi, Suero
/// and Araki 2009; not gated). A quick run has 100 and 400.
pub fn cavity_2d_ghia(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    for reynolds in [100, 400, 1000] {
        let column = format!("Re{reynolds}");
        if effort.quick && reynolds == 1000 {
            findings.left_out += 1;
            continue;
        }
        for n in [64, 128] {
            findings.begin(key(&[("Re", reynolds.to_string()), ("cells", n.to_string())]));
            let flow = Cavity::new(n, None, f64::from(reynolds), effort.precision)?;
            for (line, a) in [("u_on_x=0.5", 0), ("v_on_y=0.5", 1)] {
                let mut pairs = Vec::new();
                for row in table.rows().iter().filter(|r| r.text("line").is_ok_and(|l| l == line)) {
                    let (s, reference) = (row.number("coordinate")?, row.number(&column)?);
                    let misprint = a == 1 && reynolds == 400 && s == 0.9063;
                    if s > 0.0 && s < 1.0 && !misprint {
                        let [x, y] = if a == 0 { [0.5, s] } else { [s, 0.5] };
                        pairs.push([flow.at(a, x, y), reference]);
                    }
                }
                let error = off(&pairs);
                if n == 128 {
                    findings.check_scaled(line, error, 0.0, 1.0, 1e-2);
                } else {
                    findings.report(line, error, 0.0, 1.0);
                }
                findings.report(&format!("{line}, over the table"), error / size(&pairs), 0.0, 1.0);
            }
            findings.report("passes of the lid", flow.passes as f64, 0.0, 1.0);
        }
    }
    Ok(findings)
}

/// Velocities on the two midlines of the cube at a Reynolds number of 1000: within 3 % on 96 cells, root mean square over
/// that of the table, and steady on 48, the only ones of a quick run.
pub fn cavity_3d_re1000(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    findings.left_out += usize::from(effort.quick);
    for n in if effort.quick { &[48][..] } else { &[48, 96] } {
        findings.begin(key(&[("cells", n.to_string())]));
        let flow = Cavity::new(*n, Some(*n), 1000.0, effort.precision)?;
        for line in ["v_on_x_axis", "u_on_y_axis"] {
            let mut pairs = Vec::new();
            for row in table.rows().iter().filter(|r| r.text("line").is_ok_and(|l| l == line)) {
                let (s, reference) = (row.number("coordinate")?, row.number("velocity")?);
                if s.abs() >= 0.5 {
                    continue;
                }
                // The table's box has its lid at x = -1/2, sliding along y.
                let value = if line == "v_on_x_axis" {
                    flow.at(0, 0.5, 0.5 - s)
                } else {
                    -flow.at(1, s + 0.5, 0.5)
                };
                pairs.push([value, reference]);
            }
            let error = off(&pairs) / size(&pairs);
            if *n == 96 {
                findings.check_scaled(line, error, 0.0, 1.0, 3e-2);
            } else {
                findings.report(line, error, 0.0, 1.0);
            }
        }
        findings.report("passes of the lid", flow.passes as f64, 0.0, 1.0);
    }
    Ok(findings)
}
