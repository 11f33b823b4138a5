//! Several steps in one sweep, threads, precisions and instruction sets: which of them change the result, and by how much.

use lbm_ibm_coupling::{Boundary, Bricks, Grid, Lattice, Macroscopic, Probe, Vec3};
use lbm_ibm_lbm::{Drive, Fluid, InstructionSet, Pace, Precision};
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
    // The last is wide enough for several blocks of rows.
    let shapes = [[24, 40, 24], [33, 7, 61], [6, 120, 20], [40, 3, 90], [250, 66, 19]];
    for (n, shape) in shapes.into_iter().enumerate() {
        for (m, precision) in ALL.into_iter().enumerate() {
            let bits = n * 3 + m;
            let periodic = [bits & 1 == 0, bits & 2 == 0, bits & 4 == 0];
            let made = || fluid(shape, periodic, precision, InstructionSet::best(), n % 2 == 0);
            let mut single = made();
            let bricks = Bricks::new(single.grid());
            (0..24).for_each(|_| single.advance(&bricks).unwrap());
            let single = single.macroscopic().unwrap();
            let threads: &[usize] = if n == 4 { &[1] } else { &[1, 2, 5] };
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
