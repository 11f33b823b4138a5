//! Beads with inertia against closed forms.

mod scene;

use lbm_ibm_coupling::{Plane, Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::RADIUS;
use std::f64::consts::PI;
use std::sync::Arc;

const VISCOSITY: f64 = 1e-3;

fn falling(radius: f64, z: f64) -> (BeadSystem, f64, f64) {
    let bead = Bead::new(radius, 7800.0, Intrinsic::new(1.0).unwrap()).unwrap();
    let gravity = Vec3::z() * -9.81;
    let tau = bead.density() * bead.volume() / (6.0 * PI * VISCOSITY * radius);
    let end = bead.buoyant_weight(1000.0, gravity).z / (6.0 * PI * VISCOSITY * radius);
    let x: Soa3 = [Vec3::z() * z].into_iter().collect();
    let system = BeadSystem::new(
        vec![bead],
        x,
        Uniform::new(Vec3::zeros()),
        FixedDipoles::new(),
        VISCOSITY,
    )
    .unwrap();
    (system.with_gravity(gravity, 1000.0), tau, end)
}

#[test]
fn a_heavy_bead_falls_as_the_closed_form_and_reaches_its_terminal_velocity() {
    let (system, tau, end) = falling(100e-6, 0.0);
    let mut run = Newton::new(system);
    for t in [0.1 * tau, tau, 30.0 * tau] {
        run.run_to(t).unwrap();
        let v = end * (1.0 - (-t / tau).exp());
        let z = end * (t - tau * (1.0 - (-t / tau).exp()));
        assert!((run.velocities().get(0).z / v - 1.0).abs() < 1e-12);
        assert!((run.positions().get(0).z / z - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_thrown_bead_stops_after_its_length_and_rests_on_the_floor() {
    let (system, tau, _) = falling(100e-6, 0.0);
    let v0 = Vec3::x() * 0.1;
    let thrown = system.with_gravity(Vec3::zeros(), 1000.0);
    let mut run = Newton::new(thrown).with_velocities([v0].into_iter().collect()).unwrap();
    run.run_to(50.0 * tau).unwrap();
    assert!((run.positions().get(0).x / (0.1 * tau) - 1.0).abs() < 1e-12);
    let (system, tau, end) = falling(100e-6, 3e-4);
    let weight = -end * 6.0 * PI * VISCOSITY * 100e-6;
    let mut run = Newton::new(system.with_walls(Arc::new(Plane::new(Vec3::zeros(), Vec3::z()))));
    run.run_to(50.0 * tau).unwrap();
    assert!(
        (run.positions().get(0).z / 100e-6 - 1.0).abs() < 1e-7,
        "{}",
        run.positions().get(0).z
    );
    assert!(run.velocities().get(0).norm() < 1e-6 * -end);
    // Contacts are solved to 1e-4 of the motion without them.
    assert!((run.contacts()[0].normal_force / weight - 1.0).abs() < 1e-4);
}

#[test]
fn light_beads_move_as_overdamped_ones() {
    // A magnetic pair on its way to contact: Stokes number 1e-2 and less.
    let system = || {
        let x: Soa3 = [Vec3::zeros(), Vec3::new(0.4, 0.0, 3.0) * RADIUS].into_iter().collect();
        let source = Uniform::new(Vec3::z() * 0.005);
        BeadSystem::new(scene::beads(2, RADIUS, 2.0), x, source, FixedDipoles::new(), VISCOSITY).unwrap()
    };
    let m = scene::beads(1, RADIUS, 2.0)[0].response(Vec3::z() * 0.005).moment.z;
    let t0 = 2.0 * PI * PI * VISCOSITY * RADIUS.powi(6) / (MU0 * m * m);
    let mut light = Newton::new(system()).with_steps(1e-6, f64::INFINITY);
    let mut none = Overdamped::from(system()).with_steps(1e-6, f64::INFINITY);
    for t in [10.0 * t0, 30.0 * t0, 100.0 * t0] {
        light.run_to(t).unwrap();
        none.run_to(t).unwrap();
        let [a, b] = [light.positions(), none.positions()].map(|x| (x.get(1) - x.get(0)) / RADIUS);
        println!("{:.3} t0: {a:?} {b:?}", t / t0);
        assert!((a - b).norm() < 5e-3, "{a:?} {b:?}");
    }
    assert!(none.regime().is_overdamped() && none.regime().stokes > 0.0);
    assert_eq!(light.contacts().len(), 1);
    assert!((light.contacts()[0].normal_force / none.contacts()[0].normal_force - 1.0).abs() < 1e-3);
}
