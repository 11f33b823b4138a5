//! Open ends and planes of symmetry with fewer bits, and on other lattice velocities.

use lbm_ibm_coupling::{Bricks, Closure, Grid, Lattice, Vec3};
use lbm_ibm_lbm::{Drive, Face, Fluid, Pace, Precision, Side, VelocitySet, WallRule};
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;

fn fluid(shape: [usize; 3], periodic: [bool; 3], tau: f64, set: VelocitySet, precision: Precision) -> Fluid {
    let grid = Grid::new(shape, SPACING, periodic);
    let fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau)).unwrap();
    fluid.with_velocity_set(set).unwrap().with_precision(precision)
}

fn run(fluid: &mut Fluid, steps: usize) {
    let idle = Bricks::new(fluid.grid());
    for _ in 0..steps {
        fluid.advance(&idle).unwrap();
    }
    fluid.check().unwrap();
}

/// Lattice velocities with bits, and what rounding may leave of an exact result.
const CHOICES: [(VelocitySet, Precision, f64); 5] = [
    (VelocitySet::D3Q19, Precision::F32, 1e-5),
    (VelocitySet::D3Q27, Precision::F64, 1e-9),
    (VelocitySet::D3Q27, Precision::F32, 1e-5),
    (VelocitySet::D2Q9, Precision::F64, 1e-9),
    (VelocitySet::D2Q9, Precision::F32, 1e-5),
];

/// Between plates along either axis of the plane, the flow between two pressures is the parabola and the pressure a straight line.
#[test]
fn poiseuille_flow_passes_pressure_faces() {
    for (set, precision, close) in CHOICES {
        for (along, across) in [(0, 1), (1, 0)] {
            for tau in [0.6, 1.0, 2.5] {
                let (n, length, drop) = (6, 9, 1e-3);
                let mut shape = [1; 3];
                (shape[along], shape[across]) = (length, n);
                let mut fluid = fluid(shape, [false, false, true], tau, set, precision)
                    .with_inertia(false)
                    .with_face(along, Side::Low, Face::Pressure(drop))
                    .unwrap()
                    .with_face(along, Side::High, Face::Pressure(0.0))
                    .unwrap();
                let steps = (40.0 * 81.0 / fluid.lattice_viscosity()) as usize + 4000;
                run(&mut fluid, steps);
                let all = fluid.macroscopic().unwrap();
                let top = drop / (length as f64 * SPACING) * (n as f64 * SPACING).powi(2) / (8.0 * VISCOSITY);
                let mut worst = 0.0_f64;
                for m in 0..n * length {
                    let at = [m % shape[0], m / shape[0]];
                    let (s, y) = (at[along] as f64 + 0.5, at[across] as f64 + 0.5);
                    let exact = 4.0 * top * y * (n as f64 - y) / (n * n) as f64;
                    worst = worst.max((all.velocity[along][m] - exact).abs() / top);
                    worst = worst.max((all.pressure[m] - drop * (1.0 - s / length as f64)).abs() / drop);
                }
                assert!(
                    worst < close,
                    "{set:?} {precision:?} along {along}, tau {tau}: {worst:e}"
                );
            }
        }
    }
}

/// Half a channel beside a plane of symmetry, past an obstacle and with inertia, is the half of the whole.
#[test]
fn half_a_scene_is_the_half_of_it() {
    for (set, precision, close) in CHOICES {
        let deep = if set == VelocitySet::D2Q9 { 1 } else { 6 };
        let flow = |half: bool| {
            let shape = [16, if half { 9 } else { 18 }, deep];
            let mut fluid = fluid(shape, [true, false, true], 0.7, set, precision).with_wall_rule(WallRule::Cli);
            if half {
                fluid.set_face(1, Side::High, Face::Symmetry).unwrap();
            }
            fluid.set_drive(Drive::Force(Vec3::x() * 2e6)).unwrap();
            let rod = Closure::new(
                |x: Vec3| (x.x / SPACING - 6.2).hypot(x.y / SPACING - 9.0) * SPACING - 3.3 * SPACING,
                1e-10,
            );
            fluid.set_walls(Some(Arc::new(rod)), 0.0).unwrap();
            run(&mut fluid, 301);
            fluid.macroscopic().unwrap().velocity
        };
        let (whole, half) = (flow(false), flow(true));
        let top = whole.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
        let mut worst = 0.0_f64;
        for m in 0..16 * 9 * deep {
            let (x, y, z) = (m % 16, m / 16 % 9, m / 144);
            for (a, b) in whole.iter().zip(&half) {
                worst = worst.max((a[(z * 18 + y) * 16 + x] - b[m]).abs() / top);
            }
        }
        assert!(worst < close.max(1e-9), "{set:?} {precision:?}: {worst:e}");
    }
}

/// A flux goes in and leaves at a pressure or by a convective end: what flows out is what flows in, and the profile is the parabola
/// after a few cells.
#[test]
fn a_flux_goes_in_and_comes_out() {
    let (n, length) = (10, 30);
    for (set, precision, close) in CHOICES {
        for convective in [false, true] {
            let deep = if set == VelocitySet::D2Q9 { 1 } else { 2 };
            let mean = 1e-3;
            let flux = mean * (n * deep) as f64 * SPACING * SPACING;
            let end = if convective {
                Face::Convective(mean)
            } else {
                Face::Pressure(0.0)
            };
            let mut fluid = fluid([length, n, deep], [false, false, true], 0.8, set, precision)
                .with_inertia(false)
                .with_face(0, Side::Low, Face::Flux(flux))
                .unwrap()
                .with_face(0, Side::High, end)
                .unwrap();
            run(&mut fluid, 20_000);
            let out = -fluid.inflow(0, Side::High) / flux;
            let what = format!("{set:?} {precision:?} convective {convective}");
            assert!((fluid.inflow(0, Side::Low) / flux - 1.0).abs() < close, "{what}");
            assert!(
                (out - 1.0).abs() < if convective { 1e-4 } else { close.max(1e-8) },
                "{what}: {out}"
            );
            let all = fluid.macroscopic().unwrap();
            for y in 0..n {
                let s = (y as f64 + 0.5) / n as f64;
                let u = all.velocity[0][y * length + length / 2] / mean;
                // The parabola of the flux over the nodes.
                let exact = 6.0 * s * (1.0 - s) / (1.0 + 0.5 / (n * n) as f64);
                assert!((u - exact).abs() < 1e-4, "{what}, {y}: {u} {exact}");
            }
        }
    }
}

/// A vortex leaves by a convective face in 32 bits as in 64.
#[test]
fn a_vortex_leaves_in_the_plane() {
    let (n, speed) = (48, 0.05);
    for (set, precision, _) in CHOICES {
        let mut fluid = fluid([n, n, 1], [false, true, true], 0.52, set, precision);
        let stream = speed * SPACING / fluid.time_step();
        fluid
            .set_face(0, Side::Low, Face::velocity(move |_| Vec3::x() * stream))
            .unwrap();
        fluid.set_face(0, Side::High, Face::Convective(stream)).unwrap();
        let middle = Vec3::new(32.0, 24.0, 0.5) * SPACING;
        fluid.set_velocity(move |x| {
            let r = (x - middle) / (5.0 * SPACING);
            let s = 0.3 * stream * (-r.x * r.x - r.y * r.y).exp();
            Vec3::new(stream - s * r.y, s * r.x, 0.0)
        });
        let energy = |fluid: &Fluid| {
            let all = fluid.macroscopic().unwrap();
            let off = |m: usize| (all.velocity[0][m] - stream).powi(2) + all.velocity[1][m].powi(2);
            (0..n * n).map(off).sum::<f64>()
        };
        let before = energy(&fluid);
        run(&mut fluid, (40.0 / speed) as usize);
        let left = (energy(&fluid) / before).sqrt();
        assert!(left < 0.02, "{set:?} {precision:?}: {left}");
    }
}
