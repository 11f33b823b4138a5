//! What moving walls do to the fluid and feel of it.

use super::finding::{gate_of, observed_order};
use super::{Effort, Findings, Outcome};
use crate::Fault;
use lbm_ibm::coupling::{Boundary, Bricks, Grid, Lattice, Plane, Probe, UM, Union, Vec3};
use lbm_ibm::lbm::{Fluid, Pace, Precision, WallRule};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Water.
const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
/// Speed of walls, m/s.
const SPEED: f64 = 1e-4;

fn key(items: &[(&str, String)]) -> BTreeMap<String, String> {
    items.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect()
}

/// Flow between a plate at rest and one that slides, along an axis and along the diagonal of the plates, at several
/// relaxation times: velocities within 1e-10 of the straight line over the speed of the plate, and the shear force on either
/// plate within 1e-10. In 32 bits within 1e-5 and what rounding makes on top: of the velocity as for [`poiseuille_wall_slip`], of the force,
/// which is `nu/n` of the velocity, from ten populations at a node.
///
/// [`poiseuille_wall_slip`]: super::channel::poiseuille_wall_slip
pub fn couette(effort: Effort) -> Outcome {
    let mut findings = Findings::of("couette").stored(effort.precision);
    for tau in [0.55, 1.0, 4.0] {
        for n in [8, 16] {
            findings.begin(key(&[("tau", tau.to_string()), ("cells", n.to_string())]));
            let height = n as f64 * UM;
            let slide = Vec3::new(SPEED, 0.0, 0.5 * SPEED);
            let walls = Union::new().with(Plane::new(Vec3::zeros(), Vec3::y())).with(
                Plane::new(Vec3::y() * height, -Vec3::y())
                    .with_velocity(slide)
                    .with_part(1),
            );
            let walls: Arc<dyn Boundary> = Arc::new(walls);
            let grid = Grid::new([2, n, 2], UM, [true, false, true]);
            let bricks = Bricks::new(&grid);
            let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))?.with_precision(effort.precision);
            fluid.set_walls(Some(walls.clone()), 0.0)?;
            // The slowest disturbance decays by exp(-40), those of the scale of a cell too.
            let decay = (n * n) as f64 / (PI * PI * fluid.lattice_viscosity());
            for _ in 0..(40.0 * (decay + 8.0 * tau)) as usize {
                fluid.advance(&bricks)?;
            }
            let field = fluid.macroscopic().ok_or("the fluid has no velocity field")?;
            let mut worst = 0.0_f64;
            for (m, _) in field.solid.iter().enumerate() {
                let y = ((m / 2) % n) as f64 + 0.5;
                let off = [0, 1, 2].map(|a| field.velocity[a][m] - slide[a] * y / n as f64);
                worst = worst.max(Vec3::from(off).norm() / slide.norm());
            }
            let nu = fluid.lattice_viscosity();
            let gate = |gain| gate_of(effort.precision, 1e-10, gain / nu);
            findings.check_scaled("velocity", worst, 0.0, 1.0, gate((n * n) as f64 / 8.0));
            let loads = fluid.wall_loads(walls.as_ref(), 0.0, Vec3::zeros());
            let loads = loads.ok_or("the fluid tells no loads")?;
            let shear = slide * (VISCOSITY / height * 4.0 * UM * UM);
            for (part, sign) in [(0, 1.0), (1, -1.0)] {
                let off = (loads[part].force - shear * sign).norm() / shear.norm();
                findings.check_scaled(
                    &format!("shear force on plate {part}"),
                    off,
                    0.0,
                    1.0,
                    gate(10.0 * n as f64),
                );
            }
        }
    }
    Ok(findings)
}

/// A sphere (part 0) in the middle of a hollow one (part 1).
struct Shell {
    centre: Vec3,
    inner: f64,
    outer: f64,
    velocity: Vec3,
    spin: Vec3,
}

impl Boundary for Shell {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let r = x - self.centre;
        let out = r.try_normalize(0.0).unwrap_or_else(Vec3::x);
        let (inner, outer) = (r.norm() - self.inner, self.outer - r.norm());
        if inner < outer {
            Probe {
                velocity: self.velocity + self.spin.cross(&out) * self.inner,
                ..Probe::at_rest(inner, out)
            }
        } else {
            Probe {
                part: 1,
                ..Probe::at_rest(outer, -out)
            }
        }
    }
}

/// Radius of the sphere over that of the hollow.
const RATIO: f64 = 0.4;

/// Force over Stokes' on a sphere that moves, and torque over that in an unbounded fluid on one that turns, in the middle of
/// a hollow sphere; and how far the load on the hollow is from the opposite of it, both relative to the load.
fn shell(radius: f64, tau: f64, turns: bool, precision: Precision) -> Result<[f64; 2], Fault> {
    let cells = (2.0 * radius / RATIO).ceil() as usize + 3;
    let grid = Grid::new([cells; 3], UM, [true; 3]);
    let bricks = Bricks::new(&grid);
    let a = radius * UM;
    // Along no axis of the grid, and a little off the middle.
    let along = Vec3::new(0.8, 0.5, 0.33).normalize() * SPEED;
    let walls: Arc<dyn Boundary> = Arc::new(Shell {
        centre: Vec3::repeat(0.5 * cells as f64 * UM) + Vec3::new(0.13, 0.29, 0.41) * UM,
        inner: a,
        outer: a / RATIO,
        velocity: if turns { Vec3::zeros() } else { along },
        spin: if turns { along / a } else { Vec3::zeros() },
    });
    let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))?
        .with_inertia(false)
        .with_precision(precision)
        .with_wall_rule(WallRule::Cli);
    fluid.set_walls(Some(walls.clone()), 0.0)?;
    let gap = radius / RATIO - radius;
    // Interpolated walls give back the mass that they have gained in 256 steps or so.
    for _ in 0..(2.0 * gap * gap / fluid.lattice_viscosity()) as usize + 4096 {
        fluid.advance(&bricks)?;
    }
    let centre = Vec3::repeat(0.5 * cells as f64 * UM) + Vec3::new(0.13, 0.29, 0.41) * UM;
    let loads = fluid.wall_loads(walls.as_ref(), 0.0, centre);
    let loads = loads.ok_or("the fluid tells no loads")?;
    let of = |part: usize| if turns { loads[part].torque } else { loads[part].force };
    let unbounded = if turns {
        along * (-8.0 * PI * VISCOSITY * a * a)
    } else {
        along * (-6.0 * PI * VISCOSITY * a)
    };
    let load = of(0).dot(&unbounded) / unbounded.norm_squared();
    Ok([load, (of(0) + of(1)).norm() / of(0).norm()])
}

/// Force and torque by momentum exchange on a sphere in the middle of a hollow one at rest, in Stokes flow, at several relaxation
/// times and two resolutions: within 1 % of the exact ones at a radius of 8 cells. How much they depend on the relaxation time
/// is reported, and how far the load on the hollow is from the opposite.
///
/// Moving, `6 pi mu a U K` with `K = 4 (1 - l^5)/(4 - 9 l + 10 l^3 - 9 l^5 + 4 l^6)`, `l` the ratio of the radii (Happel and
/// Brenner 1973, 4-22); turning, `8 pi mu a^3 w/(1 - l^3)` (Landau and Lifshitz 1987, section 20).
pub fn sphere_loads(effort: Effort) -> Outcome {
    let mut findings = Findings::of("sphere_loads").stored(effort.precision);
    let l = RATIO;
    let drag = 4.0 * (1.0 - l.powi(5)) / (4.0 - 9.0 * l + 10.0 * l.powi(3) - 9.0 * l.powi(5) + 4.0 * l.powi(6));
    for (name, turns, exact) in [("force", false, drag), ("torque", true, 1.0 / (1.0 - l.powi(3)))] {
        findings.begin(key(&[("load", name.to_owned())]));
        let mut errors = Vec::new();
        for radius in [4.0, 8.0] {
            let taus: &[f64] = match (radius, effort.quick) {
                (8.0, true) => &[3.0],
                (_, true) => &[1.0, 3.0],
                _ => &[0.55, 1.0, 3.0],
            };
            let mut base = None;
            for tau in taus {
                let [load, rest] = shell(radius, *tau, turns, effort.precision)?;
                let what = format!("radius {radius}, tau {tau}");
                let first = *base.get_or_insert(load);
                if radius >= 8.0 {
                    findings.check(&what, load, exact, 1e-2);
                } else {
                    findings.report(&what, load, exact, exact);
                }
                findings.report(&format!("{what}, to tau {}", taus[0]), load, first, first);
                findings.report(&format!("{what}, both parts"), rest, 0.0, 1.0);
            }
            errors.push((1.0 / radius, (base.unwrap_or(f64::NAN) / exact - 1.0).abs()));
        }
        findings.report("order", observed_order(errors[0], errors[1]), 2.0, 1.0);
    }
    Ok(findings)
}
