//! Every collision on every set of velocities, in flows with exact solutions.

use lbm_ibm_coupling::{Bricks, Grid, Lattice, Vec3};
use lbm_ibm_lbm::{Collision, Drive, Fluid, LbmError, OddRate, Pace, Precision, VelocitySet};
use std::f64::consts::TAU;

const BUILT_IN: [Collision; 5] = [
    Collision::Bgk,
    Collision::Trt { magic: 0.25 },
    Collision::Regularised,
    Collision::RecursiveRegularised,
    Collision::CentralMoments {
        bulk: 1.0,
        odd: OddRate::Rate(1.0),
    },
];
const SETS: [VelocitySet; 3] = [VelocitySet::D3Q19, VelocitySet::D3Q27, VelocitySet::D2Q9];

/// All pairs that there are.
fn pairs() -> Vec<(Collision, VelocitySet)> {
    let mut all: Vec<_> = BUILT_IN.into_iter().flat_map(|c| SETS.map(|set| (c, set))).collect();
    all.push((Collision::mrt(), VelocitySet::D3Q19));
    all
}

/// Vortices of amplitude 0.1 in a periodic box of 2 pi, viscosity 1, `n` nodes a period, tau 0.8 (so that the time step goes with
/// the square of the spacing): the relative error of the decay rate of the energy, which is 2 times the square of the wave number.
/// In the plane Taylor and Green's (2), in space those of Arnold, Beltrami and Childress (1): both are exact with inertia.
fn decay_error(collision: Collision, set: VelocitySet, n: usize, space: bool) -> f64 {
    let spacing = TAU / n as f64;
    let grid = Grid::new([n, n, if space { n } else { 1 }], spacing, [true; 3]);
    let bricks = Bricks::new(&grid);
    let mut fluid = Fluid::new(grid, 1.0, 1.0, Pace::Tau(0.8))
        .and_then(|f| f.with_collision(collision))
        .and_then(|f| f.with_velocity_set(set))
        .expect("a fluid");
    let plane = |x: Vec3| Vec3::new(x.x.cos() * x.y.sin(), -x.x.sin() * x.y.cos(), 0.0);
    let beltrami = |x: Vec3| Vec3::new(x.z.sin() + x.y.cos(), x.x.sin() + x.z.cos(), x.y.sin() + x.x.cos());
    fluid.set_velocity(|x| 0.1 * if space { beltrami(x) } else { plane(x) });
    let energy = |fluid: &Fluid| -> f64 {
        let all = fluid.macroscopic().expect("fields");
        all.velocity.iter().flatten().map(|u| u * u).sum::<f64>()
    };
    let advance = |fluid: &mut Fluid, t: f64| {
        let steps = (t / fluid.time_step()).round() as usize;
        (0..steps).for_each(|_| fluid.advance(&bricks).expect("a step"));
        steps as f64 * fluid.time_step()
    };
    // What the start has of sound dies away first.
    advance(&mut fluid, 0.6);
    let before = energy(&fluid);
    let time = advance(&mut fluid, 0.6);
    (before / energy(&fluid)).ln() / (if space { 2.0 } else { 4.0 } * time) - 1.0
}

#[test]
fn vortices_decay_at_the_viscosity_with_an_error_of_second_order() {
    for (collision, set) in pairs() {
        for space in [false, true] {
            if space && set == VelocitySet::D2Q9 {
                continue;
            }
            let [coarse, fine] = [16, 32].map(|n| decay_error(collision, set, n, space));
            let order = (coarse / fine).abs().log2();
            println!("{collision:?} {set:?} {space}: {coarse:.2e} {fine:.2e} order {order:.3}");
            assert!(fine.abs() < 5e-3, "{collision:?} {set:?}: viscosity off by {fine:.2e}");
            assert!(order > 1.95, "{collision:?} {set:?}: order {order:.3}");
        }
    }
}

/// Flow between plates by a force along x, on `n` nodes: the velocity is exact but for a slip known in closed form.
#[test]
fn plane_channels_slip_as_predicted() {
    let n = 8;
    for (collision, set) in pairs() {
        for tau in [0.6, 1.7] {
            let grid = Grid::new([2, n, 1], 1e-6, [true, false, true]);
            let bricks = Bricks::new(&grid);
            let (density, viscosity) = (1e3, 1e-3);
            let mut fluid = Fluid::new(grid, density, viscosity, Pace::Tau(tau))
                .and_then(|f| f.with_collision(collision))
                .and_then(|f| f.with_velocity_set(set))
                .and_then(|f| f.with_drive(Drive::Force(Vec3::x() * 1e4)))
                .expect("a fluid");
            let steps = (40.0 * (n * n) as f64 / (tau - 0.5)).min(30_000.0) as usize;
            (0..steps).for_each(|_| fluid.advance(&bricks).expect("a step"));
            let slip = fluid.wall_slip().expect("built in");
            // In units in which the exact flow is y (n - y).
            let unit = 1e4 * 1e-12 / (2.0 * viscosity);
            let velocity = fluid.macroscopic().expect("fields").velocity;
            for j in 0..n {
                let y = j as f64 + 0.5;
                let expected = y * (n as f64 - y) + slip;
                let found = velocity[0][2 * j] / unit;
                assert!(
                    (found / expected - 1.0).abs() < 1e-9,
                    "{collision:?} {set:?} tau {tau}, node {j}: {found} {expected}"
                );
            }
        }
    }
}

/// In the plane nine velocities are the projection of the others: the same collision of a flow that does not depend on z is the same.
#[test]
fn nine_velocities_do_what_more_do_one_node_thick() {
    // With the equilibrium of second order, or all orders on D3Q27.
    for (collision, set, same) in [
        (Collision::Bgk, VelocitySet::D3Q27, 1e-13),
        (Collision::default(), VelocitySet::D3Q19, 1e-13),
        (Collision::RecursiveRegularised, VelocitySet::D3Q27, 1e-3),
        (Collision::central_moments(), VelocitySet::D3Q27, 1e-3),
    ] {
        let [thin, plane] = [set, VelocitySet::D2Q9].map(|set| {
            let grid = Grid::new([12, 10, 1], 1e-6, [true, false, true]);
            let bricks = Bricks::new(&grid);
            let mut fluid = Fluid::new(grid, 1e3, 1e-3, Pace::Tau(0.7))
                .and_then(|f| f.with_collision(collision))
                .and_then(|f| f.with_velocity_set(set))
                .and_then(|f| f.with_drive(Drive::Force(Vec3::x() * 1e7)))
                .expect("a fluid");
            fluid.set_velocity(|x| Vec3::new(0.0, 2e-2 * (TAU * x.x / 12e-6).sin(), 0.0));
            (0..300).for_each(|_| fluid.advance(&bricks).expect("a step"));
            fluid.macroscopic().expect("fields").velocity
        });
        let top = thin[0].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for a in 0..2 {
            for (thin, plane) in thin[a].iter().zip(&plane[a]) {
                assert!(
                    (thin - plane).abs() < same * top,
                    "{collision:?}: {thin} {plane}, of {top}"
                );
            }
        }
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let fluid = || Fluid::new(Grid::new([4, 4, 2], 1e-6, [true; 3]), 1e3, 1e-3, Pace::Tau(0.8)).expect("a fluid");
    let refused = |f: Result<Fluid, LbmError>| f.expect_err("refused");
    let plane = refused(fluid().with_velocity_set(VelocitySet::D2Q9));
    assert!(
        matches!(
            plane,
            LbmError::NotPlane {
                nodes: 2,
                periodic: true
            }
        ),
        "{plane}"
    );
    let mrt = fluid().with_collision(Collision::mrt()).expect("on D3Q19");
    let set = refused(mrt.with_velocity_set(VelocitySet::D3Q27));
    assert!(matches!(set, LbmError::NotOnThisSet { .. }), "{set}");
    let rate = refused(fluid().with_collision(Collision::CentralMoments {
        bulk: 2.5,
        odd: OddRate::Rate(1.0),
    }));
    assert!(matches!(rate, LbmError::Rate { value: 2.5, .. }), "{rate}");
}

/// Stored in 32 bits the models in the moving frame keep their digits as the default does.
#[test]
fn single_precision_keeps_a_slow_flow() {
    for collision in [
        Collision::default(),
        Collision::mrt(),
        Collision::central_moments(),
        Collision::Regularised,
    ] {
        for set in [VelocitySet::D3Q19, VelocitySet::D3Q27] {
            let run = |precision: Precision| {
                let grid = Grid::new([8, 8, 2], 1e-6, [true, false, true]);
                let bricks = Bricks::new(&grid);
                let Ok(fluid) = Fluid::new(grid, 1e3, 1e-3, Pace::Tau(0.9))
                    .and_then(|f| f.with_collision(collision))
                    .and_then(|f| f.with_velocity_set(set))
                    .and_then(|f| f.with_drive(Drive::Force(Vec3::x() * 1e4)))
                else {
                    return None;
                };
                let mut fluid = fluid.with_precision(precision);
                (0..1500).for_each(|_| fluid.advance(&bricks).expect("a step"));
                Some(fluid.superficial_velocity().x)
            };
            let (Some(double), Some(single)) = (run(Precision::F64), run(Precision::F32)) else {
                continue;
            };
            assert!(
                (single / double - 1.0).abs() < 2e-5,
                "{collision:?} {set:?}: {single} {double}"
            );
        }
    }
}

/// A run that the linear limit says will fail is refused before it begins, with the numbers.
#[test]
fn an_unstable_flux_is_refused() {
    let fluid = |collision: Collision| {
        Fluid::new(Grid::new([8; 3], 1e-6, [true; 3]), 1e3, 1e-3, Pace::Tau(0.505))
            .and_then(|f| f.with_collision(collision))
            .expect("a fluid")
    };
    let trt = fluid(Collision::default());
    let stable = trt.stable_speed().expect("in the table");
    let error = trt.with_drive(Drive::flux(0, 1.05 * stable)).expect_err("refused");
    assert!(
        matches!(error, LbmError::Unstable { speed, .. } if speed > stable),
        "{error}"
    );
    assert!(
        fluid(Collision::default())
            .with_drive(Drive::flux(0, 0.95 * stable))
            .is_ok()
    );
    let lasting = fluid(Collision::RecursiveRegularised);
    assert!(lasting.stable_speed().expect("in the table") > 1.5 * stable);
    assert!(lasting.with_drive(Drive::flux(0, 1.05 * stable)).is_ok());
    assert_eq!(fluid(Collision::default()).with_inertia(false).stable_speed(), None);
}
