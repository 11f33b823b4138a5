//! Flows with exact solutions, and what must be conserved.

use lbm_ibm_coupling::{Bricks, Closure, Grid, Lattice, Plane, Union, Vec3};
use lbm_ibm_lbm::{Collision, Drive, Fluid, Pace, VelocitySet, WallRule};
use std::f64::consts::PI;
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;

fn water(shape: [usize; 3], periodic: [bool; 3], tau: f64) -> Fluid {
    Fluid::new(Grid::new(shape, SPACING, periodic), DENSITY, VISCOSITY, Pace::Tau(tau)).unwrap()
}

fn run(fluid: &mut Fluid, steps: usize) {
    let idle = Bricks::new(fluid.grid());
    for _ in 0..steps {
        fluid.advance(&idle).unwrap();
    }
}

/// Velocity profile across `axis` of a steady flow between plates, scaled so that the exact one is `y (n - y)`.
fn plates(collision: Collision, tau: f64, n: usize, axis: usize) -> Vec<f64> {
    let mut shape = [2; 3];
    shape[axis] = n;
    let mut periodic = [true; 3];
    periodic[axis] = false;
    let along = (axis + 1) % 3;
    let mut force = Vec3::zeros();
    force[along] = 0.1;
    let mut fluid = water(shape, periodic, tau)
        .with_collision(collision)
        .unwrap()
        .with_drive(Drive::Force(force))
        .unwrap();
    let decay = (n * n) as f64 / (PI * PI * fluid.lattice_viscosity());
    run(&mut fluid, (40.0 * decay) as usize + 200);
    let velocity = &fluid.macroscopic().unwrap().velocity[along];
    let stride: usize = shape[..axis].iter().product();
    let scale = 2.0 * VISCOSITY / (0.1 * SPACING * SPACING);
    (0..n).map(|i| velocity[i * stride] * scale).collect()
}

/// poiseuille_wall_slip of the reference data: zero for TRT with magic 3/16, `(16 L - 3)/12` for BGK.
#[test]
fn the_slip_at_a_flat_wall_is_the_formula() {
    for (n, axis) in [(4, 0), (4, 1), (8, 1), (8, 2)] {
        for tau in [0.55, 0.7, 1.0, 2.0, 4.0] {
            for collision in [Collision::default(), Collision::Bgk, Collision::Trt { magic: 0.25 }] {
                let theory = collision.wall_slip(tau);
                let gate = if collision == Collision::default() { 1e-10 } else { 1e-8 };
                for (i, u) in plates(collision, tau, n, axis).into_iter().enumerate() {
                    let y = i as f64 + 0.5;
                    let slip = u - y * (n as f64 - y);
                    let error = (slip - theory).abs() / (0.25 * (n * n) as f64);
                    assert!(
                        error < gate,
                        "{collision:?} tau {tau} n {n} axis {axis} y {y}: {slip} {theory}"
                    );
                }
            }
        }
    }
}

/// Decay rate per step over `nu k^2` of a shear wave along `axis` on 16 nodes.
fn decay_of_shear(collision: Collision, set: VelocitySet, tau: f64, axis: usize) -> f64 {
    let n = 16;
    let mut shape = [1; 3];
    shape[axis] = n;
    let mut fluid = water(shape, [true; 3], tau)
        .with_collision(collision)
        .unwrap()
        .with_velocity_set(set)
        .unwrap();
    let (k, along) = (2.0 * PI / n as f64, (axis + 1) % 2);
    let speed = 1e-4 * SPACING / fluid.time_step();
    fluid.set_velocity(|p| Vec3::ith(along, speed * (k * p[axis] / SPACING).sin()));
    let top = |fluid: &Fluid| {
        let u = &fluid.macroscopic().unwrap().velocity[along];
        (0..n).map(|i| u[i] * (k * (i as f64 + 0.5)).sin()).sum::<f64>()
    };
    // The start is not an eigenvector.
    run(&mut fluid, 100);
    let before = top(&fluid);
    run(&mut fluid, 20);
    (before / top(&fluid)).ln() / (20.0 * fluid.lattice_viscosity() * k * k)
}

#[test]
fn shear_waves_decay_as_the_characteristic_equation_says() {
    let k = 2.0 * PI / 16.0;
    for set in [VelocitySet::D3Q19, VelocitySet::D3Q27, VelocitySet::D2Q9] {
        let (trt, bgk, central) = (Collision::default(), Collision::Bgk, Collision::central_moments());
        for collision in [trt, bgk, central, Collision::Regularised] {
            let waves = collision.tau_of_waves().unwrap();
            for tau in [waves, 0.55, 0.7] {
                let square = (tau - 0.5_f64).powi(2);
                let theory = 1.0 + 2.0 / 3.0 * k * k * (0.125 + 0.5 * square - collision.magic(tau));
                for axis in [0, 1] {
                    let rate = decay_of_shear(collision, set, tau, axis);
                    let error = (rate - theory).abs() / k.powi(4);
                    assert!(error < 0.05, "{set:?} {collision:?} tau {tau}: {rate} {theory} {error}");
                }
            }
        }
    }
    assert_eq!(Collision::Trt { magic: 0.1 }.tau_of_waves(), None);
}

/// duct_flow of the reference data: mean velocity of a square duct of half height b is 0.140577015 G b^2/mu.
#[test]
fn a_square_duct_converges_with_second_order() {
    let error = |n: usize| {
        let force = Vec3::new(0.1, 0.0, 0.0);
        let mut fluid = water([1, n, n], [true, false, false], 1.5)
            .with_drive(Drive::Force(force))
            .unwrap();
        run(&mut fluid, 10 * n * n);
        let b = 0.5 * n as f64 * SPACING;
        (fluid.superficial_velocity().x * VISCOSITY / (0.1 * b * b) / 0.140577015 - 1.0).abs()
    };
    let (coarse, fine) = (error(8), error(16));
    let order = (coarse / fine).log2();
    assert!(order > 1.9 && fine < 4e-3, "order {order}, error {fine}");
}

#[test]
fn a_shear_wave_decays_with_the_viscosity() {
    let error = |tau: f64, n: usize| {
        let k = 2.0 * PI / (n as f64 * SPACING);
        let mut fluid = water([n, 2, 2], [true; 3], tau);
        fluid.set_velocity(|x| Vec3::new(0.0, 1e-3 * (k * x.x).sin(), 0.0));
        let amplitude = |fluid: &Fluid| -> f64 {
            let v = &fluid.macroscopic().unwrap().velocity[1];
            (0..n).map(|i| v[i] * (k * (i as f64 + 0.5) * SPACING).sin()).sum()
        };
        let steps = 101;
        let before = amplitude(&fluid);
        run(&mut fluid, steps);
        let rate = (before / amplitude(&fluid)).ln() / (steps as f64 * fluid.time_step());
        (rate / (VISCOSITY / DENSITY * k * k) - 1.0).abs()
    };
    for tau in [0.6, 1.0, 2.0] {
        let (coarse, fine) = (error(tau, 48), error(tau, 96));
        let order = (coarse / fine).log2();
        assert!(fine < 4e-3 && order > 1.8, "tau {tau}: error {fine}, order {order}");
    }
}

#[test]
fn sliding_plates_make_a_linear_profile() {
    for tau in [0.7, 2.0] {
        let mut fluid = water([3, 10, 2], [true; 3], tau);
        let low = Plane::new(Vec3::new(0.0, 2e-6, 0.0), Vec3::y()).with_velocity(Vec3::new(-1e-3, 0.0, 2e-3));
        let high = Plane::new(Vec3::new(0.0, 8e-6, 0.0), -Vec3::y()).with_velocity(Vec3::new(1e-3, 0.0, 0.0));
        let report = fluid
            .set_walls(Some(Arc::new(Union::new().with(low).with(high))), 0.0)
            .unwrap();
        assert_eq!(report.narrowest, Some((6, 1)));
        assert_eq!(
            (report.fluid_nodes, report.solid_nodes, report.wall_links),
            (36, 24, 60)
        );
        run(&mut fluid, 2001);
        let all = fluid.macroscopic().unwrap();
        for j in 0..10 {
            let s = (j as f64 - 1.5) / 6.0;
            let exact = if (2..8).contains(&j) {
                [1e-3 * (2.0 * s - 1.0), 0.0, 2e-3 * (1.0 - s)]
            } else {
                [0.0; 3]
            };
            for a in 0..3 {
                assert!((all.velocity[a][j * 3] - exact[a]).abs() < 1e-12, "tau {tau}, row {j}");
            }
        }
    }
}

#[test]
fn mass_is_conserved() {
    for periodic in [[true; 3], [true, false, false], [false; 3]] {
        // Interpolated walls keep it in the long run only.
        let mut fluid = water([13, 9, 9], periodic, 0.7).with_wall_rule(WallRule::Halfway);
        let ball = Closure::new(|x: Vec3| (x - Vec3::new(6.2e-6, 4.5e-6, 4.4e-6)).norm() - 2e-6, 1e-9);
        fluid.set_walls(Some(Arc::new(ball)), 0.0).unwrap();
        fluid.set_velocity(|x| Vec3::new(0.02 * (x.y * 1e6).sin(), 0.0, 0.02 * (x.x * 1e6).cos()));
        let mass = |fluid: &Fluid| fluid.macroscopic().unwrap().pressure.iter().sum::<f64>();
        let scale = |fluid: &Fluid| {
            fluid
                .macroscopic()
                .unwrap()
                .pressure
                .iter()
                .map(|p| p.abs())
                .sum::<f64>()
        };
        let before = mass(&fluid);
        run(&mut fluid, 3);
        let unit = scale(&fluid);
        assert!(unit > 1e-3, "the flow must have a pressure");
        run(&mut fluid, 100);
        assert!((mass(&fluid) - before).abs() < 1e-12 * unit, "{periodic:?}");
    }
}

#[test]
fn a_body_force_gives_its_momentum() {
    let mut fluid = water([9, 5, 4], [true; 3], 0.9)
        .with_drive(Drive::Force(Vec3::new(3.0, -2.0, 1.0)))
        .unwrap();
    fluid.set_velocity(|_| Vec3::zeros());
    for steps in [1, 6, 90] {
        run(&mut fluid, steps);
        let t = fluid.steps() as f64 * fluid.time_step();
        let exact = Vec3::new(3.0, -2.0, 1.0) * t / DENSITY;
        assert!((fluid.superficial_velocity() - exact).norm() < 1e-12 * exact.norm());
    }
}

/// A shear wave that is carried along by a uniform flow decays at nearly the same rate.
#[test]
fn a_moving_wave_is_carried_along() {
    let n = 32;
    let k = 2.0 * PI / (n as f64 * SPACING);
    let mut fluid = water([n, 2, 2], [true; 3], 0.8);
    let unit = SPACING / fluid.time_step();
    fluid.set_velocity(|x| Vec3::new(0.05, 1e-3 * (k * x.x).sin(), 0.0) * unit);
    run(&mut fluid, 160);
    let v = fluid.macroscopic().unwrap().velocity[1].clone();
    let decay = (-VISCOSITY / DENSITY * k * k * 160.0 * fluid.time_step()).exp();
    for i in 0..n {
        let x = (i as f64 + 0.5 - 160.0 * 0.05) * SPACING;
        let exact = 1e-3 * (k * x).sin() * decay;
        assert!((v[i] / unit - exact).abs() < 2e-5, "node {i}");
    }
}

#[test]
fn without_inertia_the_answer_is_linear() {
    let flow = |inertia: bool, strength: f64| {
        let mut fluid = water([12, 8, 3], [true, false, true], 0.8).with_inertia(inertia);
        let ball = Closure::new(|x: Vec3| (x - Vec3::new(4.2e-6, 3.1e-6, 1e-6)).norm() - 1.5e-6, 1e-9);
        fluid.set_walls(Some(Arc::new(ball)), 0.0).unwrap();
        fluid.set_drive(Drive::Force(Vec3::new(strength, 0.0, 0.0))).unwrap();
        run(&mut fluid, 400);
        fluid.superficial_velocity().x
    };
    let nonlinear = |inertia| (flow(inertia, 1e8) / flow(inertia, 1e5) / 1e3 - 1.0).abs();
    assert!(nonlinear(false) < 1e-12);
    assert!(nonlinear(true) > 1e-6);
}
