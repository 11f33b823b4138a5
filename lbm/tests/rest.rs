//! A fluid whose force is set before the first step starts from rest.

use lbm_ibm_coupling::{Bricks, Closure, Grid, Lattice, Vec3};
use lbm_ibm_lbm::{Collision, Drive, Fluid, Pace, Precision, VelocitySet};
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const FORCE: [f64; 3] = [30.0, -20.0, 10.0];

fn collisions() -> [Collision; 6] {
    [
        Collision::default(),
        Collision::Bgk,
        Collision::mrt(),
        Collision::Regularised,
        Collision::RecursiveRegularised,
        Collision::central_moments(),
    ]
}

fn water(shape: [usize; 3], tau: f64) -> Fluid {
    let grid = Grid::new(shape, 1e-6, [true; 3]);
    Fluid::new(grid, DENSITY, 1e-3, Pace::Tau(tau)).unwrap()
}

fn pull() -> Drive {
    Drive::Force(Vec3::from(FORCE))
}

/// Greatest departure from `u = F t/rho`, in parts of the velocity.
fn departure(fluid: &Fluid) -> f64 {
    let exact = Vec3::from(FORCE) * (fluid.steps() as f64 * fluid.time_step() / DENSITY);
    let all = fluid.macroscopic().unwrap();
    let nodes = (0..all.pressure.len()).map(|n| Vec3::from([0, 1, 2].map(|a| all.velocity[a][n])));
    nodes.map(|u| (u - exact).norm()).fold(0.0, f64::max) / exact.norm()
}

#[test]
fn the_velocity_is_zero_and_then_the_force_times_the_time() {
    for set in [VelocitySet::D3Q19, VelocitySet::D3Q27] {
        for tau in [0.55, 1.0, 3.0] {
            // MRT is built for nineteen velocities.
            let of_set = |c: &Collision| set == VelocitySet::D3Q19 || *c != Collision::mrt();
            for collision in collisions().into_iter().filter(of_set) {
                let mut fluid = water([9, 5, 4], tau).with_velocity_set(set).unwrap();
                fluid = fluid.with_collision(collision).unwrap().with_drive(pull()).unwrap();
                let all = fluid.macroscopic().unwrap();
                assert!(all.velocity.iter().flatten().chain(&all.pressure).all(|v| *v == 0.0));
                assert_eq!(fluid.superficial_velocity(), Vec3::zeros());
                let mut bricks = Bricks::new(fluid.grid());
                bricks.want(0);
                bricks.commit();
                fluid.read_velocity(&mut bricks);
                assert!(bricks.velocity().iter().flat_map(|v| v.iter()).all(|v| *v == 0.0));
                let idle = Bricks::new(fluid.grid());
                for steps in [1, 2, 40] {
                    (0..steps).for_each(|_| fluid.advance(&idle).unwrap());
                    assert!(
                        departure(&fluid) < 1e-11,
                        "{set:?} {tau} {collision:?}: {}",
                        departure(&fluid)
                    );
                }
            }
        }
    }
}

#[test]
fn sweeps_and_other_precisions_start_from_rest_too() {
    for (precision, bound) in [(Precision::F64, 1e-12), (Precision::F32, 1e-5)] {
        let mut fluid = water([24, 24, 40], 0.8)
            .with_precision(precision)
            .with_drive(pull())
            .unwrap();
        fluid.advance_by(8).unwrap();
        assert!(departure(&fluid) < bound, "{precision:?}: {}", departure(&fluid));
    }
}

/// What would stay of the start between walls, in proportion to the relaxation time, is not there: after the first step the momentum is
/// that of one step's force in every population.
#[test]
fn the_force_may_be_set_before_the_walls_or_after_and_a_saved_fluid_goes_on_alike() {
    let walls = || Arc::new(Closure::new(|x: Vec3| (x.x - 6e-6).hypot(x.y - 6e-6) - 3.3e-6, 1e-9));
    let start = |first: bool| {
        let mut fluid = water([12, 12, 6], 2.0);
        if first {
            fluid.set_drive(pull()).unwrap();
        }
        fluid.set_walls(Some(walls()), 0.0).unwrap();
        if !first {
            fluid.set_drive(pull()).unwrap();
        }
        fluid
    };
    let run = |fluid: &mut Fluid, steps: usize| {
        let idle = Bricks::new(fluid.grid());
        (0..steps).for_each(|_| fluid.advance(&idle).unwrap());
        fluid.save().unwrap()
    };
    let mut fluid = start(true);
    let begin = fluid.save().unwrap();
    let third = run(&mut fluid, 3);
    let end = run(&mut fluid, 6);
    assert!(run(&mut start(false), 9) == end);
    for (state, left) in [(&begin, 9), (&third, 6)] {
        let mut other = start(true);
        other.restore(state).unwrap();
        assert!(run(&mut other, left) == end);
    }
    // The same by hand.
    let mut given = start(true);
    given.set_velocity(|_| Vec3::zeros());
    assert!(run(&mut given, 9) == end);
}
