//! Flux control, threads, walls that change, and errors.

use lbm_ibm_coupling::{Boundary, Bricks, Closure, FluidError, Grid, Lattice, Plane, Union, Vec3};
use lbm_ibm_lbm::{Collision, Drive, Fluid, LbmError, Pace};
use std::sync::Arc;

fn slit(n: usize, tau: f64) -> Fluid {
    let grid = Grid::new([12, n, 6], 1e-6, [true, false, true]);
    Fluid::new(grid, 1e3, 1e-3, Pace::Tau(tau)).unwrap()
}

fn pillar() -> Arc<dyn Boundary> {
    Arc::new(Closure::new(|x: Vec3| (x.x - 6e-6).hypot(x.z - 3e-6) - 1.6e-6, 1e-9))
}

#[test]
fn flux_control_reaches_its_target_and_the_right_force() {
    for n in [4, 8] {
        for tau in [0.55, 0.8, 1.5, 2.5, 4.0] {
            let mut fluid = slit(n, tau).with_drive(Drive::flux(0, 1e-3)).unwrap();
            let idle = Bricks::new(fluid.grid());
            let mut reached = None;
            for step in 0..4000 {
                fluid.advance(&idle).unwrap();
                let error = (fluid.superficial_velocity().x / 1e-3 - 1.0).abs();
                reached = if error < 1e-6 { reached.or(Some(step)) } else { None };
            }
            let viscous_time = (n * n) as f64 / (10.0 * fluid.lattice_viscosity());
            let reached = reached.unwrap_or(usize::MAX);
            assert!((reached as f64) < 80.0 + viscous_time, "n {n} tau {tau}: {reached}");
            let h = n as f64 * 1e-6;
            // Summed at the nodes, the exact parabola's mean is h^2/12 (1 + 1/(2 n^2)).
            let exact = 12.0 * 1e-3 * 1e-3 / (h * h) / (1.0 + 0.5 / (n * n) as f64);
            assert!((fluid.body_force().x / exact - 1.0).abs() < 1e-9, "n {n} tau {tau}");
            let direct = fluid.macroscopic().unwrap().velocity[0].iter().sum::<f64>() / fluid.grid().len() as f64;
            assert!((direct / 1e-3 - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn flux_control_holds_past_obstacles_and_under_forces_of_bodies() {
    for tau in [0.6, 1.0, 2.5, 4.0] {
        let mut fluid = slit(10, tau).with_drive(Drive::flux(0, 1e-3)).unwrap();
        fluid.set_walls(Some(pillar()), 0.0).unwrap();
        let mut bricks = Bricks::new(fluid.grid());
        bricks.want(0);
        bricks.commit();
        bricks.force_mut()[0].fill(-1e-17);
        for _ in 0..3000 {
            fluid.advance(&bricks).unwrap();
        }
        let error = fluid.superficial_velocity().x / 1e-3 - 1.0;
        assert!(error.abs() < 1e-6, "tau {tau}: {error}");
        // The flow read back node by node, forces of bodies included.
        bricks.want(0);
        bricks.want(1);
        bricks.want(2);
        bricks.want(3);
        bricks.commit();
        fluid.read_velocity(&mut bricks);
        let mut sum = 0.0;
        for slot in 0..bricks.len() {
            let corner = bricks.brick(slot).map(|b| b * 8);
            for n in 0..512 {
                if corner[0] + n % 8 < 12 && corner[1] + n / 8 % 8 < 10 && corner[2] + n / 64 < 6 {
                    sum += bricks.velocity()[0][slot * 512 + n];
                }
            }
        }
        assert!((sum / 720.0 / 1e-3 - 1.0).abs() < 1e-6, "tau {tau}: {}", sum / 720.0);
    }
}

#[test]
fn a_flux_and_its_force_are_the_same_flow() {
    let mut held = slit(8, 0.9).with_drive(Drive::flux(0, 1e-3)).unwrap();
    held.set_walls(Some(pillar()), 0.0).unwrap();
    let idle = Bricks::new(held.grid());
    (0..3000).for_each(|_| held.advance(&idle).unwrap());
    let mut pushed = slit(8, 0.9).with_drive(Drive::Force(held.body_force())).unwrap();
    pushed.set_walls(Some(pillar()), 0.0).unwrap();
    (0..3000).for_each(|_| pushed.advance(&idle).unwrap());
    assert!((pushed.superficial_velocity().x / 1e-3 - 1.0).abs() < 1e-7);
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grid = Grid::new([40, 24, 20], 1e-6, [true, false, true]);
            let mut fluid = Fluid::new(grid, 1e3, 1e-3, Pace::Tau(0.8)).unwrap();
            fluid.set_drive(Drive::flux(0, 1e-2)).unwrap();
            let ball = Closure::new(|x: Vec3| (x - Vec3::new(2e-5, 1e-5, 1e-5)).norm() - 5e-6, 1e-9);
            fluid.set_walls(Some(Arc::new(ball)), 0.0).unwrap();
            let mut bricks = Bricks::new(fluid.grid());
            [1, 5, 6, 20].into_iter().for_each(|b| bricks.want(b));
            bricks.commit();
            for step in 0..41 {
                fluid.read_velocity(&mut bricks);
                let drag: Vec<f64> = bricks.velocity()[0]
                    .iter()
                    .map(|v| -1e-12 * v + f64::from(step) * 1e-18)
                    .collect();
                bricks.force_mut()[0].copy_from_slice(&drag);
                fluid.advance(&bricks).unwrap();
            }
            let all = fluid.macroscopic().unwrap();
            let bits = |v: &Vec<f64>| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            (
                all.velocity.each_ref().map(bits),
                bits(&all.pressure),
                fluid.body_force().x.to_bits(),
            )
        })
    };
    let one = run(1);
    assert!(one == run(2));
    assert!(one == run(3));
}

#[test]
fn a_new_wall_keeps_the_flow_elsewhere_in_both_phases() {
    for steps in [10, 11] {
        let mut fluid = slit(8, 0.8)
            .with_drive(Drive::Force(Vec3::new(100.0, 0.0, 0.0)))
            .unwrap();
        let idle = Bricks::new(fluid.grid());
        (0..steps).for_each(|_| fluid.advance(&idle).unwrap());
        let before = fluid.macroscopic().unwrap();
        fluid.set_walls(Some(pillar()), 0.0).unwrap();
        let after = fluid.macroscopic().unwrap();
        assert!(after.solid.contains(&1));
        for n in 0..after.solid.len() {
            let expected = if after.solid[n] == 1 {
                0.0
            } else {
                before.velocity[0][n]
            };
            assert_eq!(after.velocity[0][n], expected);
        }
        fluid.advance(&idle).unwrap();
        fluid.check().unwrap();
        fluid.set_walls(None, 0.0).unwrap();
        let freed = fluid.macroscopic().unwrap();
        assert!(freed.solid.iter().all(|s| *s == 0));
        let half_force = fluid.body_force().x * 0.5 * fluid.time_step() / 1e3;
        let n = after.solid.iter().position(|s| *s == 1).unwrap();
        assert!((freed.velocity[0][n] - half_force).abs() < 1e-15, "starts at rest");
    }
}

#[test]
fn a_gap_of_one_cell_is_refused_and_a_grazed_wall_is_not() {
    let mut fluid = Fluid::new(Grid::new([8, 8, 8], 1e-6, [true; 3]), 1e3, 1e-3, Pace::Tau(0.8)).unwrap();
    let gap = |width: f64| {
        let low = Plane::new(Vec3::new(0.0, 3.1e-6, 0.0), Vec3::y());
        let high = Plane::new(Vec3::new(0.0, 3.1e-6 + width, 0.0), -Vec3::y());
        Arc::new(Union::new().with(low).with(high))
    };
    match fluid.set_walls(Some(gap(1.2e-6)), 0.0) {
        Err(FluidError::NarrowGap {
            node,
            cells,
            needed,
            axis,
            spacing,
        }) => {
            assert_eq!((node, cells, needed, axis), ([0, 3, 0], 1, 2, 'y'));
            assert!((spacing - 0.6e-6).abs() < 1e-12);
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(fluid.set_walls(Some(gap(2.0e-6)), 0.0).unwrap().narrowest, Some((2, 1)));
    // A hollow ball has runs of a single node near its poles.
    let hollow = Closure::new(|x: Vec3| 2.6e-6 - (x - Vec3::repeat(3.5e-6)).norm(), 1e-9);
    let report = fluid.set_walls(Some(Arc::new(hollow)), 0.0).unwrap();
    assert!(report.narrowest.unwrap().0 >= 2);
    assert!(matches!(
        fluid.set_walls(Some(Arc::new(Closure::new(|_| -1.0, 1e-9))), 0.0),
        Err(FluidError::NoFluid { nodes: 512 })
    ));
    let thin = Fluid::new(
        Grid::new([8, 1, 8], 1e-6, [true, false, true]),
        1e3,
        1e-3,
        Pace::Tau(0.8),
    );
    assert!(matches!(
        thin,
        Err(LbmError::Walls(FluidError::NarrowGap { cells: 1, .. }))
    ));
}

#[test]
fn bad_parameters_are_named_with_a_remedy() {
    let grid = || Grid::new([4; 3], 1e-6, [true; 3]);
    let new = |density: f64, viscosity: f64, pace| Fluid::new(grid(), density, viscosity, pace);
    assert!(matches!(
        new(1e3, 0.0, Pace::Tau(0.8)),
        Err(LbmError::NotPositive { name: "viscosity", .. })
    ));
    assert!(matches!(
        new(-1.0, 1e-3, Pace::Tau(0.8)),
        Err(LbmError::NotPositive { name: "density", .. })
    ));
    assert!(matches!(
        new(1e3, 1e-3, Pace::TimeStep(f64::NAN)),
        Err(LbmError::NotPositive { name: "time step", .. })
    ));
    let Err(error @ LbmError::RelaxationTime { time_step, .. }) = new(1e3, 1e-3, Pace::Tau(0.5)) else {
        panic!()
    };
    assert!(error.to_string().contains("0.5") && error.to_string().contains("time step of at least"));
    assert!(new(1e3, 1e-3, Pace::TimeStep(1.000001 * time_step)).is_ok());
    assert!(matches!(
        new(1e3, 1e-3, Pace::TimeStep(0.9 * time_step)),
        Err(LbmError::RelaxationTime { tau, .. }) if tau > 0.5
    ));
    let empty = Fluid::new(Grid::new([4, 0, 4], 1e-6, [true; 3]), 1e3, 1e-3, Pace::Tau(1.0));
    assert!(matches!(empty, Err(LbmError::EmptyGrid { .. })));
    let vast = Fluid::new(Grid::new([1 << 21; 3], 1e-6, [true; 3]), 1e3, 1e-3, Pace::Tau(1.0));
    assert!(matches!(vast, Err(LbmError::GridTooLarge { .. })));
    let closed = slit(4, 1.0).with_drive(Drive::flux(1, 1e-3));
    assert!(matches!(closed, Err(LbmError::ClosedAxis { axis: 1, .. })));
    let wild = slit(4, 1.0).with_drive(Drive::Force(Vec3::repeat(f64::INFINITY)));
    assert!(matches!(wild, Err(LbmError::NotFinite { .. })));
    let magic = slit(4, 1.0).with_collision(Collision::Trt { magic: -0.1 });
    assert!(matches!(
        magic,
        Err(LbmError::NotPositive {
            name: "magic number",
            ..
        })
    ));
}

#[test]
fn a_flow_that_is_too_fast_names_its_node() {
    let mut fluid = slit(4, 0.8);
    let unit = 1e-6 / fluid.time_step();
    fluid.set_velocity(|x| Vec3::new(if x.x > 5e-6 && x.y > 2e-6 { 0.4 } else { 0.0 }, 0.0, 0.0) * unit);
    match fluid.check() {
        Err(FluidError::Diverged { node, step: 0, what }) => {
            assert_eq!(node, [5, 2, 0]);
            assert!(what.contains("0.69"), "{what}");
        }
        other => panic!("{other:?}"),
    }
    fluid.set_velocity(|_| Vec3::repeat(f64::NAN));
    assert!(matches!(
        fluid.check(),
        Err(FluidError::Diverged { node: [0, 0, 0], .. })
    ));
    fluid.set_drive(Drive::flux(0, 1e-3)).unwrap();
    let idle = Bricks::new(fluid.grid());
    assert!(matches!(
        fluid.advance(&idle),
        Err(FluidError::Diverged { step: 1, .. })
    ));
}
