//! Rigid bodies in a periodic box: drag for every kernel, free motion at every density, momentum, pairs.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::scenes::{on_threads, side_by_side};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{ForceField, Grid, Loads, Scene, Vec3, View};
use lbm_ibm::ibm::{DeltaExchange, Kernel, RigidBody};
use lbm_ibm::lbm::{Drive, Fluid, Pace};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Grid spacing, m.
pub(crate) const H: f64 = 1e-6;
/// Density of the fluid, kg/m3.
pub(crate) const DENSITY: f64 = 1e3;
/// Viscosity of the fluid, Pa s.
pub(crate) const VISCOSITY: f64 = 1e-3;

pub(crate) fn key(pairs: &[(&str, String)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect()
}

/// A place about the middle of a box that no symmetry of the grid knows.
pub(crate) fn middle(shape: [usize; 3]) -> Vec3 {
    (Vec3::from(shape.map(|n| 0.5 * n as f64)) + Vec3::new(0.13, 0.29, 0.41)) * H
}

/// A pose without rotation.
pub(crate) fn at(x: Vec3) -> Isometry3<f64> {
    Isometry3::translation(x.x, x.y, x.z)
}

/// Given forces (N) on the bodies, in their order.
pub(crate) struct Pull(pub Vec<Vec3>);

impl ForceField for Pull {
    fn name(&self) -> &str {
        "pull"
    }

    fn add_loads(&mut self, _view: &View<'_>, loads: &mut Loads) {
        for (load, force) in loads.body.iter_mut().zip(&self.0) {
            load.force += force;
        }
    }
}

/// A Stokes fluid of relaxation time `tau`.
pub(crate) fn stokes(grid: Grid, tau: f64) -> Result<Fluid, Fault> {
    Ok(Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))?.with_inertia(false))
}

/// Superficial velocity, m/s.
pub(crate) fn flow(scene: &Scene) -> Vec3 {
    scene.fluid().map_or(Vec3::zeros(), |f| f.superficial_velocity())
}

/// Drag of a sphere of radius `a` in a periodic cube of edge `length` over the Stokes drag at the velocity against the
/// superficial one: Hasimoto, J. Fluid Mech. 5 (1959) 317; to 0.2 % for a/L below 0.19.
fn hasimoto(a: f64, length: f64) -> f64 {
    let s = a / length;
    1.0 / (1.0 - 2.837297 * s + 4.0 * PI / 3.0 * s.powi(3) - 27.4 * s.powi(6))
}

/// Drag over Hasimoto's, and over the force that drives the flow, of a held sphere of `radius` spacings in a periodic cube
/// of 32 nodes at a given flux.
fn held(kernel: Kernel, radius: f64, tau: f64) -> Result<[f64; 2], Fault> {
    let n = 32;
    let length = n as f64 * H;
    let nu = (tau - 0.5) / 3.0;
    let fluid = stokes(Grid::new([n; 3], H, [true; 3]), tau)?.with_drive(Drive::flux(0, 1e-3 * nu))?;
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(kernel));
    let id = scene.add_body(RigidBody::sphere(radius * H, DENSITY)?.held(), &at(middle([n; 3])))?;
    for _ in 0..(0.15 * (n * n) as f64 / nu) as usize {
        scene.step()?;
    }
    let force = scene.wrench_on(id)?.force.x;
    let drive = scene.fluid().map_or(0.0, |f| f.body_force().x) * length.powi(3);
    let exact = 6.0 * PI * VISCOSITY * radius * H * flow(&scene).x * hasimoto(radius * H, length);
    Ok([force / exact, force / drive])
}

/// Torque of a turning sphere of `radius` spacings in the same cube over `8 pi mu a^3 W/(1 - phi)`, at a solid fraction phi: the fluid's
/// angular velocity is counted against the mean over the cube, which the sphere's own share makes up for. In cubic
/// symmetry the next term goes with a higher power of phi, which is 0.03 at the most.
fn turned(kernel: Kernel, radius: f64, tau: f64) -> Result<f64, Fault> {
    let n = 32;
    let fluid = stokes(Grid::new([n; 3], H, [true; 3]), tau)?;
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(kernel));
    let rate = Vec3::new(1.0, -2.0, 2.0) * (1e-4 / 3.0 / scene.time_step());
    let body = RigidBody::sphere(radius * H, DENSITY)?.moving(Vec3::zeros(), rate);
    let id = scene.add_body(body, &at(middle([n; 3])))?;
    for _ in 0..(0.15 * (n * n) as f64 * 3.0 / (tau - 0.5)) as usize {
        scene.step()?;
    }
    let torque = -scene.wrench_on(id)?.torque.dot(&rate) / rate.norm_squared();
    let fraction = 4.0 / 3.0 * PI * (radius / n as f64).powi(3);
    Ok(torque * (1.0 - fraction) / (8.0 * PI * VISCOSITY * (radius * H).powi(3)))
}

/// Drag of a held sphere and torque of a turning one of 3 to 6 spacings in a periodic box, for every kernel, from low to high relaxation times,
/// against Hasimoto and its like for a torque: within 1 % from 4 spacings on, 2 % at 3.
pub fn rigid_drag(effort: Effort) -> Outcome {
    let mut findings = Findings::of("rigid_drag");
    let mut rows = Vec::new();
    for kernel in Kernel::ALL {
        for radius in [3.0, 4.0, 6.0]
            .into_iter()
            .filter(|r| *r >= kernel.least_rigid_radius())
        {
            for tau in [0.6, 1.0, 3.0] {
                rows.push((kernel, radius, tau));
            }
        }
    }
    let all = rows.len();
    rows.retain(|(_, radius, tau)| !effort.quick || (*radius < 6.0 && *tau > 0.6));
    findings.left_out = all - rows.len();
    let found = side_by_side(&rows, |&(kernel, radius, tau)| {
        Ok((held(kernel, radius, tau)?, turned(kernel, radius, tau)?))
    })?;
    for ((kernel, radius, tau), (([drag, balance], torque), seconds)) in rows.iter().zip(found) {
        let row = [
            ("kernel", format!("{kernel:?}")),
            ("R_over_h", radius.to_string()),
            ("tau", tau.to_string()),
        ];
        findings.begin_done(key(&row), seconds);
        let gate = if *radius < 4.0 { 0.02 } else { 0.01 };
        findings.check("drag over Hasimoto's", drag, 1.0, gate);
        findings.check("torque over that in a cube", torque, 1.0, gate);
        findings.check("drag over the drive", balance, 1.0, 1e-3);
    }
    Ok(findings)
}

/// Drag over Hasimoto's, and what is lost of the total momentum over that of the displaced fluid, of a free sphere of
/// `radius` spacings and `ratio` times the fluid's density that is pulled through a periodic cube, the fluid as a whole
/// being pulled back.
fn pulled(ratio: f64, radius: f64, tau: f64) -> Result<[f64; 2], Fault> {
    let n = 32;
    let length = n as f64 * H;
    let nu = (tau - 0.5) / 3.0;
    let drag = 6.0 * PI * VISCOSITY * radius * H * hasimoto(radius * H, length);
    let fluid = stokes(Grid::new([n; 3], H, [true; 3]), tau)?;
    let force = Vec3::new(1.0, 0.3, -0.2) * drag * 1e-3 * nu;
    let fluid = fluid.with_drive(Drive::Force(-force / length.powi(3)))?;
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree));
    let body = RigidBody::sphere(radius * H, ratio * DENSITY)?;
    let (excess, volume) = (body.excess_mass(DENSITY), body.volume());
    let id = scene.add_body(body, &at(middle([n; 3])))?;
    scene.add_field(Pull(vec![force]));
    // The slower one of the fluid's diffusion and of Stokes' response, six times.
    let steps = 6.0 * (0.03 * (n * n) as f64 / nu).max(ratio * DENSITY * volume / (drag * scene.time_step()));
    for _ in 0..steps as usize {
        scene.step()?;
    }
    let state = scene.rigid_body(id)?;
    let velocity = state.velocity - flow(&scene);
    // The velocity counts half of the last step's forces.
    let fluid = DENSITY * length.powi(3) * flow(&scene) - 0.5 * scene.time_step() * (state.on_fluid.force - force);
    let lost = fluid + excess * state.velocity;
    let scale = DENSITY * volume * velocity.norm();
    Ok([force.dot(&force) / force.dot(&velocity) / drag, lost.norm() / scale])
}

/// A free sphere from a tenth to eight times the fluid's density reaches Hasimoto's velocity within 1 %, and fluid and
/// sphere together keep their momentum (for a sphere lighter than the fluid up to what it still accelerates).
pub fn rigid_free(_effort: Effort) -> Outcome {
    let mut findings = Findings::of("rigid_free");
    let rows = [
        (0.1, 4.0, 1.0),
        (0.1, 6.0, 3.0),
        (0.5, 4.0, 0.7),
        (1.0, 4.0, 0.7),
        (1.0, 6.0, 3.0),
        (1.8, 4.0, 1.0),
        (8.0, 4.0, 1.0),
    ];
    let found = side_by_side(&rows, |&(ratio, radius, tau)| pulled(ratio, radius, tau))?;
    for ((ratio, radius, tau), ([drag, lost], seconds)) in rows.iter().zip(found) {
        let row = [
            ("density_ratio", ratio.to_string()),
            ("R_over_h", radius.to_string()),
            ("tau", tau.to_string()),
        ];
        findings.begin_done(key(&row), seconds);
        findings.check("drag over Hasimoto's", drag, 1.0, 0.01);
        let gate = if *ratio < 1.0 { 1e-3 } else { 1e-9 };
        findings.check_scaled("momentum lost", lost, 0.0, 1.0, gate);
    }
    Ok(findings)
}

/// Mobility of two equal spheres `gap` radii apart (centre to centre) that are pushed towards each other along their line,
/// over that of one alone: `x11 - x12` of Jeffrey and Onishi, J. Fluid Mech. 139 (1984) 261.
fn approach(s: f64) -> f64 {
    let own = 1.0 - 15.0 / (4.0 * s.powi(4)) + 11.0 / (2.0 * s.powi(6));
    let other = 1.5 / s - s.powi(-3) + 75.0 / (4.0 * s.powi(7));
    own - other
}

/// Two beads with opposite forces.
fn pair(threads: usize) -> Result<(Scene, f64), Fault> {
    on_threads(threads, || {
        let (n, radius) = (48, 4.0);
        let mut scene = Scene::with_fluid(
            stokes(Grid::new([n; 3], H, [true; 3]), 1.5)?,
            DeltaExchange::new(Kernel::RomaThree),
        );
        let along = Vec3::new(2.0, 1.0, -2.0) / 3.0;
        let alone = 1e-4;
        let force = along * (6.0 * PI * VISCOSITY * radius * H * alone);
        for side in [-1.0, 1.0] {
            let place = middle([n; 3]) + along * (side * 1.5 * radius * H);
            scene.add_body(RigidBody::sphere(radius * H, 1.5 * DENSITY)?, &at(place))?;
        }
        scene.add_field(Pull(vec![force, -force]));
        for _ in 0..600 {
            scene.step()?;
        }
        let [a, b] = [0, 1].map(|i| scene.rigid_bodies()[i].velocity.dot(&along));
        Ok((scene, 0.5 * (a - b) / alone))
    })
}

/// Two beads 3 radii apart that attract each other: velocity within 2 %, no net momentum, the same bits on any number of
/// threads.
pub fn rigid_pair(_effort: Effort) -> Outcome {
    let mut findings = Findings::of("rigid_pair");
    findings.begin(key(&[("threads", "1".to_owned())]));
    let (one, velocity) = pair(1)?;
    let centres = |scene: &Scene| {
        scene.rigid_bodies()[1].pose.translation.vector - scene.rigid_bodies()[0].pose.translation.vector
    };
    findings.check(
        "velocity over that alone",
        velocity,
        approach(centres(&one).norm() / (4.0 * H)),
        0.02,
    );
    let sum = one.rigid_bodies()[0].velocity + one.rigid_bodies()[1].velocity;
    findings.check_scaled(
        "sum of velocities",
        sum.norm(),
        0.0,
        one.rigid_bodies()[0].velocity.norm(),
        1e-2,
    );
    findings.begin(key(&[("threads", "3".to_owned())]));
    let (three, _) = pair(3)?;
    let bits = |scene: &Scene| -> Vec<u64> { scene.positions().x.iter().map(|x| x.to_bits()).collect() };
    let differ = bits(&one).iter().zip(bits(&three)).filter(|(a, b)| **a != *b).count();
    findings.check_scaled("coordinates that differ", differ as f64, 0.0, 1.0, 0.0);
    Ok(findings)
}
