//! Channels with open ends and planes of symmetry.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use lbm_ibm::coupling::{Bricks, Closure, Grid, Lattice, Macroscopic, UM, Vec3};
use lbm_ibm::lbm::{Drive, Face, Fluid, Pace, Precision, Side};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Water.
const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;

fn key(part: &str) -> BTreeMap<String, String> {
    BTreeMap::from([("part".to_owned(), part.to_owned())])
}

fn fluid(shape: [usize; 3], periodic: [bool; 3], tau: f64, precision: Precision) -> Result<Fluid, Fault> {
    let grid = Grid::new(shape, UM, periodic);
    Ok(Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))?.with_precision(precision))
}

fn run(fluid: &mut Fluid, steps: usize) -> Result<Macroscopic, Fault> {
    let bricks = Bricks::new(fluid.grid());
    for _ in 0..steps {
        fluid.advance(&bricks)?;
    }
    Ok(fluid.macroscopic().ok_or("the fluid has no velocity field")?)
}

/// Flow between plates from one pressure to another, without inertia: greatest error of velocity and pressure, over the
/// greatest of each.
fn plates(tau: f64, precision: Precision) -> Result<[f64; 2], Fault> {
    let (n, length, drop) = (8, 12, 1e-3);
    let mut fluid = fluid([length, n, 1], [false, false, true], tau, precision)?
        .with_inertia(false)
        .with_face(0, Side::Low, Face::Pressure(drop))?
        .with_face(0, Side::High, Face::Pressure(0.0))?;
    let steps = 4000 + (40.0 * (length * length) as f64 / fluid.lattice_viscosity()) as usize;
    let all = run(&mut fluid, steps)?;
    let top = drop / (length as f64 * UM) * (n as f64 * UM).powi(2) / (8.0 * VISCOSITY);
    let mut worst = [0.0_f64; 2];
    for m in 0..n * length {
        let (x, y) = ((m % length) as f64 + 0.5, (m / length) as f64 + 0.5);
        let exact = Vec3::x() * (4.0 * top * y * (n as f64 - y) / (n * n) as f64);
        let u = Vec3::from(all.velocity.each_ref().map(|u| u[m]));
        worst[0] = worst[0].max((u - exact).norm() / top);
        worst[1] = worst[1].max((all.pressure[m] - drop * (1.0 - x / length as f64)).abs() / drop);
    }
    Ok(worst)
}

/// A square duct of `n` cells into which a flux starts at once and which it leaves at a pressure.
struct Duct {
    /// Greatest difference of the velocity half way along from the periodic duct with that flux, over its greatest velocity.
    profile: f64,
    /// Pressure gradient there over that of the periodic duct.
    gradient: f64,
    /// What flows out over what flows in, in the last two steps.
    out: f64,
    /// Change of the mass over what has flowed in and out, less one.
    mass: f64,
    /// The greatest excess of the mass in that time over that of the end, over the mass that flows in while a disturbance of the width of
    /// the duct decays.
    excess: f64,
}

impl Duct {
    fn new(n: usize, precision: Precision) -> Result<Self, Fault> {
        let length = 4 * n;
        let mut whole = fluid([1, n, n], [true, false, false], 1.0, precision)?.with_inertia(false);
        whole = whole.with_drive(Drive::Force(Vec3::x() * 10.0))?;
        let settled = 8 * n * n;
        let developed = run(&mut whole, settled)?.velocity;
        let flux = whole.superficial_velocity().x * (n * n) as f64 * UM * UM;
        let mut open = fluid([length, n, n], [false; 3], 1.0, precision)?
            .with_inertia(false)
            .with_face(0, Side::Low, Face::Flux(flux))?
            .with_face(0, Side::High, Face::Pressure(0.0))?;
        let bricks = Bricks::new(open.grid());
        let mass = |fluid: &Fluid| -> Result<f64, Fault> {
            let all = fluid.macroscopic().ok_or("the fluid has no pressure field")?;
            // Pressure over the square of the speed of sound, kg.
            let sound = (UM / fluid.time_step()).powi(2) / 3.0;
            Ok(all.pressure.iter().sum::<f64>() / sound * UM.powi(3))
        };
        let (mut inside, mut most) = (0.0, 0.0_f64);
        for _ in 0..40 * n * n {
            open.advance(&bricks)?;
            let net = open.inflow(0, Side::Low) + open.inflow(0, Side::High);
            inside += net * DENSITY * open.time_step();
            most = most.max(inside);
        }
        // Over two steps, for what changes sign in every step outlasts all else.
        let last = open.inflow(0, Side::High);
        open.advance(&bricks)?;
        let now = open.inflow(0, Side::High);
        inside += (open.inflow(0, Side::Low) + now) * DENSITY * open.time_step();
        let end = mass(&open)?;
        let all = open.macroscopic().ok_or("the fluid has no velocity field")?;
        let half = length / 2;
        let top = developed[0].iter().fold(0.0_f64, |top, u| top.max(*u));
        let off = (0..n * n).map(|m| (all.velocity[0][m * length + half] - developed[0][m]).abs());
        let line = (n / 2 * n + n / 2) * length;
        let gradient = 0.5 * (all.pressure[line + half - 1] - all.pressure[line + half + 1]) / UM;
        let scale = flux * DENSITY * (n * n) as f64 * UM * UM * DENSITY / VISCOSITY;
        Ok(Self {
            profile: off.fold(0.0, f64::max) / top,
            gradient: gradient / 10.0,
            out: -0.5 * (last + now) / flux,
            mass: inside / end - 1.0,
            excess: (most - end) / scale,
        })
    }
}

/// Half a channel with a step on its floor, beside a plane of symmetry, against the whole: greatest difference of velocities over
/// the greatest velocity.
fn half_channel(precision: Precision) -> Result<f64, Fault> {
    let flow = |half: bool| -> Result<(Vec<f64>, usize), Fault> {
        let n = if half { 8 } else { 16 };
        let mut fluid = fluid([24, n, 4], [true, false, true], 0.6, precision)?;
        if half {
            fluid.set_face(1, Side::High, Face::Symmetry)?;
        }
        let step = |x: Vec3| {
            let low = x.y.min(16.0 * UM - x.y);
            let (out, up) = ((x.x - 8.0 * UM).abs() - 3.0 * UM, low - 4.0 * UM);
            if out > 0.0 && up > 0.0 {
                out.hypot(up)
            } else {
                out.max(up)
            }
        };
        let walls = Closure::new(step, 1e-4 * UM);
        fluid.set_walls(Some(Arc::new(walls)), 0.0)?;
        let mut fluid = fluid.with_drive(Drive::Force(Vec3::x() * 1e6))?;
        Ok((run(&mut fluid, 3000)?.velocity[0].clone(), n))
    };
    let ((whole, n), (half, m)) = (flow(false)?, flow(true)?);
    let top = whole.iter().fold(0.0_f64, |top, u| top.max(u.abs()));
    let rows = (0..4 * m).map(|row| (row / m * n + row % m, row));
    let off = rows.flat_map(|(a, b)| (0..24).map(move |x| (a * 24 + x, b * 24 + x)));
    Ok(off.fold(0.0_f64, |worst, (a, b)| worst.max((whole[a] - half[b]).abs() / top)))
}

/// A vortex of 5 cells that a stream carries out of a box of 48 by 48 cells: the greatest root mean square difference of the
/// velocities, while it leaves and after, from those in a box three times as long, over the vortex's greatest velocity.
fn vortex(precision: Precision, end: impl Fn(f64) -> Face) -> Result<f64, Fault> {
    const N: usize = 48;
    let speed = 0.05;
    let make = |length: usize, end: &dyn Fn(f64) -> Face| -> Result<Fluid, Fault> {
        let mut fluid = fluid([length, N, 1], [false, true, true], 0.52, precision)?;
        let stream = speed * UM / fluid.time_step();
        fluid.set_face(0, Side::Low, Face::velocity(move |_| Vec3::x() * stream))?;
        fluid.set_face(0, Side::High, end(stream))?;
        let middle = Vec3::new(32.0, 24.0, 0.5) * UM;
        fluid.set_velocity(move |x| {
            let r = (x - middle) / (5.0 * UM);
            let s = 0.3 * stream * (-r.x * r.x - r.y * r.y).exp();
            Vec3::new(stream - s * r.y, s * r.x, 0.0)
        });
        Ok(fluid)
    };
    let (mut near, mut far) = (make(N, &end)?, make(3 * N, &|_| Face::Pressure(0.0))?);
    let top = 0.3 * speed * UM / near.time_step() * (-0.5_f64).exp() / 2.0_f64.sqrt();
    let mut worst = 0.0_f64;
    for _ in 0..6 {
        let steps = (8.0 / speed) as usize;
        let (a, b) = (run(&mut near, steps)?, run(&mut far, steps)?);
        let nodes = (0..N).flat_map(|j| (0..N).map(move |i| (j * N + i, 3 * j * N + i)));
        let squares = nodes.flat_map(|(m, n)| [0, 1].map(|c| ((a.velocity[c][m] - b.velocity[c][n]) / top).powi(2)));
        worst = worst.max((squares.sum::<f64>() / (N * N) as f64).sqrt());
    }
    Ok(worst)
}

/// Open ends and planes of symmetry.
///
/// Flow between plates from one pressure to another has the parabola and the straight line to 1e-9 at every relaxation time. In
/// a square duct a flux with its developed profile goes in and leaves at a pressure: half way along within 1e-4 of the
/// periodic duct, what goes out is what goes in within 1e-6, and the mass is what has flowed in less what has flowed out to
/// 1e-9. Half a channel is the half of the whole to 1e-10. A vortex leaves by a convective face with less than 0.5 % of its velocity coming
/// back; a pressure face is reported.
pub fn open_channel(effort: Effort) -> Outcome {
    let mut findings = Findings::of("open_channel").stored(effort.precision);
    findings.begin(key("between pressures"));
    for tau in [0.6, 1.0, 2.5] {
        let [velocity, pressure] = plates(tau, effort.precision)?;
        findings.check_scaled(&format!("velocity, tau {tau}"), velocity, 0.0, 1.0, 1e-9);
        findings.check_scaled(&format!("pressure, tau {tau}"), pressure, 0.0, 1.0, 1e-9);
    }
    findings.begin(key("flux to pressure"));
    let duct = Duct::new(16, effort.precision)?;
    findings.check_scaled("profile", duct.profile, 0.0, 1.0, 1e-4);
    findings.check("pressure gradient", duct.gradient, 1.0, 1e-4);
    findings.check("out over in", duct.out, 1.0, 1e-6);
    if effort.precision == Precision::F64 {
        findings.check_scaled("mass less what flowed in", duct.mass, 0.0, 1.0, 1e-9);
    } else {
        // Rounding is no exchange between nodes: it adds up over the steps.
        findings.report("mass less what flowed in", duct.mass, 0.0, 1.0);
    }
    findings.report("greatest excess of mass", duct.excess, 0.0, 1.0);
    findings.begin(key("half a channel"));
    findings.check_scaled("velocity", half_channel(effort.precision)?, 0.0, 1.0, 1e-10);
    findings.begin(key("vortex that leaves"));
    findings.check_scaled(
        "convective",
        vortex(effort.precision, Face::Convective)?,
        0.0,
        1.0,
        5e-3,
    );
    findings.report("pressure", vortex(effort.precision, |_| Face::Pressure(0.0))?, 0.0, 1.0);
    Ok(findings)
}
