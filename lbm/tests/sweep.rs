//! Several steps in one sweep, threads, precisions and instruction sets: which of them change the result, and by how much.

use lbm_ibm_coupling::{Boundary, Bricks, Closure, FluidError, Grid, Lattice, Macroscopic, Probe, Vec3};
use lbm_ibm_lbm::{Drive, Fluid, InstructionSet, Pace, Precision, WallRule};
use std::sync::Arc;

const ALL: [Precision; 3] = [Precision::F64, Precision::F32, Precision::F16];

/// Solid where a hash of the node says so.
struct Rubble(Grid);

impl Boundary for Rubble {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let at = (x - self.0.origin) / self.0.spacing;
        let hash = at.iter().fold(17_u64, |h, v| {
            (h ^ v.floor() as i64 as u64)
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(29)
        });
        Probe {
            velocity: Vec3::new(1e-4, 0.0, 0.0),
            ..Probe::at_rest(
                if hash.is_multiple_of(9) { -1.0 } else { 1.0 },
                Vec3::new(0.6, 0.6, 0.5),
            )
        }
    }

    fn cut(&self, _a: Vec3, _b: Vec3, _t: f64) -> Option<f64> {
        Some(0.3)
    }
}

fn fluid(shape: [usize; 3], periodic: [bool; 3], precision: Precision, isa: InstructionSet, rubble: bool) -> Fluid {
    let grid = Grid::new(shape, 1e-6, periodic);
    let mut fluid = Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(0.8))
        .unwrap()
        .with_instruction_set(isa)
        .unwrap()
        .with_precision(precision);
    let unit = grid.spacing / fluid.time_step();
    if rubble {
        fluid.set_walls(Some(Arc::new(Rubble(grid.clone()))), 0.0).unwrap();
    }
    fluid.set_velocity(|x| {
        let k = x / grid.spacing;
        Vec3::new(
            (0.4 * k.y + 0.3 * k.z).sin(),
            (0.2 * k.x).cos(),
            (0.7 * k.x + k.y).sin(),
        ) * (0.02 * unit)
    });
    let force = Vec3::new(1e-5, -2e-5, 0.5e-5) * (1e3 * grid.spacing / fluid.time_step().powi(2));
    fluid.set_drive(Drive::Force(force)).unwrap();
    fluid
}

fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(work)
}

fn same(a: &Macroscopic, b: &Macroscopic) -> bool {
    let bits = |m: &Macroscopic| -> Vec<u64> {
        let all = m.velocity.iter().chain([&m.pressure]).flatten();
        all.map(|v| v.to_bits()).collect()
    };
    a.velocity[0].iter().any(|v| *v != 0.0) && bits(a) == bits(b)
}

#[test]
fn sweeps_of_several_steps_give_the_same_bits_as_single_ones_on_any_number_of_threads() {
    // Many planes are divided among threads; the last is wide enough for several blocks of rows.
    let shapes = [[24, 40, 24], [33, 7, 70], [12, 9, 130], [40, 3, 90], [250, 66, 50]];
    for (n, shape) in shapes.into_iter().enumerate() {
        for (m, precision) in ALL.into_iter().enumerate() {
            let bits = n * 3 + m;
            let periodic = [bits & 1 == 0, bits & 2 == 0, bits & 4 == 0];
            let made = || fluid(shape, periodic, precision, InstructionSet::best(), n % 2 == 0);
            let mut single = made();
            let bricks = Bricks::new(single.grid());
            (0..24).for_each(|_| single.advance(&bricks).unwrap());
            let single = single.macroscopic().unwrap();
            let threads: &[usize] = if n == 4 { &[3] } else { &[1, 2, 5] };
            for &threads in threads {
                let many = on_threads(threads, || {
                    let mut many = made();
                    // Even and odd starts, and sweeps of 1 to 8 steps.
                    for steps in [8, 1, 4, 3, 2, 6] {
                        many.advance_by(steps).unwrap();
                    }
                    many.macroscopic().unwrap()
                });
                assert!(same(&single, &many), "{shape:?} {periodic:?} {precision:?} {threads}");
            }
        }
    }
}

/// Greatest difference of the velocities, as a fraction of the greatest velocity.
fn difference(a: &Macroscopic, b: &Macroscopic) -> f64 {
    let (mut worst, mut greatest) = (0.0_f64, 0.0_f64);
    for (a, b) in a.velocity.iter().flatten().zip(b.velocity.iter().flatten()) {
        worst = worst.max((a - b).abs());
        greatest = greatest.max(a.abs());
    }
    assert!(worst.is_finite() && greatest > 0.0);
    worst / greatest
}

#[test]
fn instruction_sets_agree_to_the_rounding_of_each_precision() {
    // The step of the greatest populations, less their weights about 0.01, over that of velocities, and 40 roundings.
    for (precision, rounding) in ALL.into_iter().zip([1e-15, 1e-6, 5e-3]) {
        let run = |isa| {
            let mut fluid = fluid([37, 11, 13], [true, false, true], precision, isa, true);
            fluid.advance_by(20).unwrap();
            fluid.macroscopic().unwrap()
        };
        let plain = run(InstructionSet::Portable);
        for isa in [InstructionSet::Avx2, InstructionSet::Avx512] {
            if isa.is_available() {
                let difference = difference(&plain, &run(isa));
                assert!(difference < 10.0 * rounding, "{precision:?} {isa:?} {difference:e}");
            }
        }
    }
}

/// Viscosity from the decay of a shear wave of `speed` (lattice units) over a period of 64 nodes, over the true one.
fn wave_viscosity(precision: Precision, speed: f64) -> f64 {
    let n = 64;
    let grid = Grid::new([4, n, 4], 1e-6, [true; 3]);
    let mut fluid = Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(0.8))
        .unwrap()
        .with_precision(precision);
    let unit = grid.spacing / fluid.time_step();
    let k = std::f64::consts::TAU / n as f64;
    fluid.set_velocity(|x| Vec3::x() * (speed * unit * (k * x.y / grid.spacing).sin()));
    let amplitude = |fluid: &Fluid| -> f64 {
        let all = fluid.macroscopic().unwrap();
        let part = |(i, v): (usize, &f64)| v * (k * ((i / 4 % n) as f64 + 0.5)).sin();
        all.velocity[0].iter().enumerate().map(part).sum()
    };
    fluid.advance_by(100).unwrap();
    let (start, steps) = (amplitude(&fluid), 1000);
    fluid.advance_by(steps).unwrap();
    let decay = (start / amplitude(&fluid)).ln() / (steps as f64 * k * k);
    decay / fluid.lattice_viscosity()
}

#[test]
fn a_slow_shear_wave_decays_with_the_right_viscosity_in_each_precision() {
    let error = |precision, speed| (wave_viscosity(precision, speed) - 1.0).abs();
    let exact = wave_viscosity(Precision::F64, 1e-3);
    // The lattice's own error at 64 nodes a wave.
    assert!((exact - 1.0).abs() < 2e-3, "{exact}");
    for speed in [1e-2, 1e-3, 1e-4] {
        println!(
            "speed {speed:.0e}: viscosity off by {:.2e} in 32 bits, {:.2e} in 16",
            wave_viscosity(Precision::F32, speed) - exact,
            wave_viscosity(Precision::F16, speed) - exact
        );
        assert!(error(Precision::F32, speed) < 3e-3);
        assert!(error(Precision::F16, speed) < 0.05);
    }
}

#[test]
fn a_channel_has_its_parabola_in_each_precision() {
    for (precision, tolerance) in ALL.into_iter().zip([1e-10, 1e-5, 2e-2]) {
        let n = 8;
        let grid = Grid::new([4, n, 4], 1e-6, [true, false, true]);
        let mut fluid = Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(1.1))
            .unwrap()
            .with_precision(precision);
        let unit = grid.spacing / fluid.time_step();
        let force = 1e-3;
        fluid
            .set_drive(Drive::Force(Vec3::x() * force * 1e3 * unit / fluid.time_step()))
            .unwrap();
        fluid.advance_by(3000).unwrap();
        let all = fluid.macroscopic().unwrap();
        let exact = |y: f64| force / (2.0 * fluid.lattice_viscosity()) * y * (n as f64 - y) * unit;
        let worst = (0..n)
            .map(|j| (all.velocity[0][4 * j] - exact(j as f64 + 0.5)).abs())
            .fold(0.0, f64::max);
        let error = worst / exact(0.5 * n as f64);
        println!("{precision:?}: {error:.1e} of the greatest velocity");
        assert!(error < tolerance, "{precision:?} {error:e}");
    }
}

#[test]
fn memory_follows_the_fluid_nodes() {
    let bytes = |fluid: &Fluid| fluid.memory() as f64 / fluid.fluid_nodes() as f64;
    let cube = Grid::new([64; 3], 1e-6, [true; 3]);
    for (precision, size) in ALL.into_iter().zip([8.0, 4.0, 2.0]) {
        let open = Fluid::new(cube.clone(), 1e3, 1e-3, Pace::Tau(0.8))
            .unwrap()
            .with_precision(precision);
        // 19 populations and at most 4 values of 64 bits.
        assert!(bytes(&open) < 19.0 * size + 32.0, "{precision:?} {}", bytes(&open));
    }
    // A slit of 16 nodes in 64.
    let open = Fluid::new(cube.clone(), 1e3, 1e-3, Pace::Tau(0.8)).unwrap();
    let mut slit = Fluid::new(cube, 1e3, 1e-3, Pace::Tau(0.8)).unwrap();
    let walls = Closure::new(|x: Vec3| 8e-6 - (x.y - 32e-6).abs(), 1e-9);
    slit.set_walls(Some(Arc::new(walls)), 0.0).unwrap();
    assert_eq!(slit.fluid_nodes(), 64 * 16 * 64);
    assert!(bytes(&slit) < 1.15 * bytes(&open), "{} {}", bytes(&slit), bytes(&open));
    // A tube of 20 nodes along x and along z, and the pores between spheres: links cost something, cut ones more.
    let large = Grid::new([128; 3], 1e-6, [true; 3]);
    let open = bytes(&Fluid::new(large, 1e3, 1e-3, Pace::Tau(0.8)).unwrap());
    let along_x = |x: Vec3| 10e-6 - (x.y - 12e-6).hypot(x.z - 12e-6);
    let along_z = |x: Vec3| 10e-6 - (x.x - 12e-6).hypot(x.y - 12e-6);
    fn pores(x: Vec3) -> f64 {
        x.map(|v| v - 32e-6 * (v / 32e-6).round()).norm() - 18e-6
    }
    // The same on a warped lattice: no two spheres are alike, and the factor keeps the distance from growing faster than the way.
    let uneven = |x: Vec3| {
        let warp = |v: f64| 2e-6 * (std::f64::consts::PI * v / 32e-6).sin();
        0.8 * pores(x + Vec3::new(warp(x.y + 3e-6), warp(x.z + 7e-6), warp(x.x + 11e-6)))
    };
    type Scene = (fn(Vec3) -> f64, [usize; 3], [f64; 2]);
    let scenes: [Scene; 4] = [
        (along_x, [64, 24, 24], [1.05, 1.11]),
        (along_z, [24, 24, 64], [1.10, 1.15]),
        (pores, [64; 3], [1.10, 1.18]),
        (uneven, [64; 3], [1.10, 1.20]),
    ];
    for (distance, shape, most) in scenes {
        for (rule, most) in [WallRule::Halfway, WallRule::Cli].into_iter().zip(most) {
            let grid = Grid::new(shape, 1e-6, [true; 3]);
            let mut fluid = Fluid::new(grid, 1e3, 1e-3, Pace::Tau(0.8))
                .unwrap()
                .with_wall_rule(rule)
                .with_narrow_gaps_filled();
            fluid
                .set_walls(Some(Arc::new(Closure::new(distance, 1e-9))), 0.0)
                .unwrap();
            let of_open = bytes(&fluid) / open;
            println!("{shape:?} {rule:?}: {of_open:.3} of an open cube");
            assert!(of_open < most, "{shape:?} {rule:?} {of_open}");
        }
    }
}

#[test]
fn a_restarted_run_equals_one_that_was_not_stopped() {
    for (n, precision) in ALL.into_iter().enumerate() {
        for rule in [WallRule::Halfway, WallRule::Cli] {
            let made = || {
                let plain = fluid(
                    [13, 9, 11],
                    [true, n == 1, true],
                    precision,
                    InstructionSet::best(),
                    false,
                );
                let grid = plain.grid().clone();
                let flux = Drive::Flux([Some(1e-3), None, None]);
                let mut fluid = plain.with_wall_rule(rule).with_drive(flux).unwrap();
                fluid.set_walls(Some(Arc::new(Rubble(grid))), 0.0).unwrap();
                fluid
            };
            let walls = Rubble(made().grid().clone());
            let mut straight = made();
            let bricks = Bricks::new(straight.grid());
            for stop in 0..4 {
                let state = straight.save().unwrap();
                let mut again = made();
                again.restore(&state).unwrap();
                let loads = |f: &Fluid| f.wall_loads(&walls, 0.0, Vec3::zeros()).unwrap();
                assert_eq!(loads(&straight), loads(&again), "{precision:?} {rule:?} {stop}");
                for _ in 0..3 {
                    straight.advance(&bricks).unwrap();
                    again.advance(&bricks).unwrap();
                }
                assert!(same(&straight.macroscopic().unwrap(), &again.macroscopic().unwrap()));
                assert_eq!(straight.body_force(), again.body_force());
                assert_eq!(straight.save(), again.save());
            }
            let state = straight.save().unwrap();
            let mut other = fluid([13, 9, 12], [true; 3], precision, InstructionSet::best(), false);
            assert!(matches!(other.restore(&state), Err(FluidError::State { .. })));
            assert!(matches!(made().restore(&state[1..]), Err(FluidError::State { .. })));
            assert!(matches!(
                made().restore(&state[..state.len() - 1]),
                Err(FluidError::State { .. })
            ));
        }
    }
}
