//! Open ends and planes of symmetry.

use lbm_ibm_coupling::{Boundary, Bricks, Closure, FluidError, Grid, Lattice, Plane, Union, Vec3};
use lbm_ibm_lbm::{Drive, Face, FaceError, Fluid, LbmError, Pace, Side, WallRule};
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;

fn fluid(shape: [usize; 3], periodic: [bool; 3], tau: f64) -> Fluid {
    let grid = Grid::new(shape, SPACING, periodic);
    Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau)).unwrap()
}

fn run(fluid: &mut Fluid, steps: usize) {
    let idle = Bricks::new(fluid.grid());
    for _ in 0..steps {
        fluid.advance(&idle).unwrap();
    }
    fluid.check().unwrap();
}

/// Between plates along every axis, the flow between two pressures is the parabola and the pressure a straight line, exactly.
#[test]
fn poiseuille_flow_passes_pressure_faces_exactly() {
    for (along, across) in [(0, 1), (1, 2), (2, 0), (1, 0)] {
        for tau in [0.6, 1.0, 2.5] {
            let (n, length, drop) = (6, 9, 1e-3);
            let mut shape = [1; 3];
            (shape[along], shape[across]) = (length, n);
            let periodic = [0, 1, 2].map(|a| a != along && a != across);
            let mut fluid = fluid(shape, periodic, tau)
                .with_inertia(false)
                .with_face(along, Side::Low, Face::Pressure(drop))
                .unwrap()
                .with_face(along, Side::High, Face::Pressure(0.0))
                .unwrap();
            let steps = (40.0 * 81.0 / fluid.lattice_viscosity()) as usize + 4000;
            run(&mut fluid, steps);
            let all = fluid.macroscopic().unwrap();
            let gradient = drop / (length as f64 * SPACING);
            let top = gradient * (n as f64 * SPACING).powi(2) / (8.0 * VISCOSITY);
            let mut worst = 0.0_f64;
            for m in 0..n * length {
                let at = [m % shape[0], m / shape[0] % shape[1], m / (shape[0] * shape[1])];
                let (s, y) = (at[along] as f64 + 0.5, at[across] as f64 + 0.5);
                let exact = 4.0 * top * y * (n as f64 - y) / (n * n) as f64;
                let off = |a: usize| all.velocity[a][m] - if a == along { exact } else { 0.0 };
                for a in 0..3 {
                    worst = worst.max(off(a).abs() / top);
                }
                let pressure = drop * (1.0 - s / length as f64);
                worst = worst.max((all.pressure[m] - pressure).abs() / drop);
            }
            assert!(worst < 1e-9, "axis {along}, tau {tau}: {worst:e}");
        }
    }
}

/// Half a channel beside a plane of symmetry is the half of the whole, past an obstacle and with inertia.
#[test]
fn half_a_scene_is_the_half_of_it() {
    for (axis, other) in [(1, 2), (2, 1), (0, 2)] {
        for rule in [WallRule::Halfway, WallRule::Cli] {
            let flow = |half: bool| {
                let mut shape = [12, 12, 12];
                shape[axis] = if half { 8 } else { 16 };
                let mut periodic = [true; 3];
                periodic[axis] = false;
                periodic[other] = false;
                let along = 3 - axis - other;
                let mut fluid = fluid(shape, periodic, 0.7).with_wall_rule(rule);
                if half {
                    fluid.set_face(axis, Side::High, Face::Symmetry).unwrap();
                }
                let mut push = Vec3::zeros();
                push[along] = 2e6;
                push[other] = 3e5;
                fluid.set_drive(Drive::Force(push)).unwrap();
                let mut centre = Vec3::repeat(6.2) * SPACING;
                centre[axis] = 8.0 * SPACING;
                let ball = Closure::new(move |x: Vec3| (x - centre).norm() - 3.3 * SPACING, 1e-10);
                fluid.set_walls(Some(Arc::new(ball)), 0.0).unwrap();
                run(&mut fluid, 301);
                fluid
            };
            let (whole, half) = (flow(false), flow(true));
            let [a, b] = [&whole, &half].map(|f| f.macroscopic().unwrap());
            let shape = half.grid().shape;
            let top = a.velocity.iter().flatten().fold(0.0_f64, |m, u| m.max(u.abs()));
            let mut worst = 0.0_f64;
            for m in 0..half.grid().len() {
                let at = [m % shape[0], m / shape[0] % shape[1], m / (shape[0] * shape[1])];
                let [nx, ny, _] = whole.grid().shape;
                let n = (at[2] * ny + at[1]) * nx + at[0];
                for c in 0..3 {
                    worst = worst.max((a.velocity[c][n] - b.velocity[c][m]).abs() / top);
                }
            }
            // Cuts are known to 1e-9.
            let close = if rule == WallRule::Cli { 1e-9 } else { 1e-12 };
            assert!(worst < close, "axis {axis} {rule:?}: {worst:e}");
        }
    }
}

/// Two planes of symmetry and a quarter of a square duct.
#[test]
fn a_quarter_of_a_duct_is_a_quarter_of_it() {
    let flow = |half: bool| {
        let n = if half { 5 } else { 10 };
        let mut fluid = fluid([2, n, n], [true, false, false], 0.8);
        if half {
            fluid.set_face(1, Side::High, Face::Symmetry).unwrap();
            fluid.set_face(2, Side::High, Face::Symmetry).unwrap();
        }
        fluid.set_drive(Drive::flux(0, 1e-3)).unwrap();
        run(&mut fluid, 2000);
        (fluid.superficial_velocity().x, fluid.body_force().x)
    };
    let ((u, force), (half_u, half_force)) = (flow(false), flow(true));
    assert!((u / 1e-3 - 1.0).abs() < 1e-10 && (half_u / 1e-3 - 1.0).abs() < 1e-10);
    assert!((force / half_force - 1.0).abs() < 1e-9, "{force} {half_force}");
}

/// What is asked for flows in and out, the mass is that of the steady state, and after a few cells the profile is the
/// parabola.
#[test]
fn a_flux_goes_in_and_leaves_at_a_pressure() {
    let (n, length) = (12, 40);
    let flux = 1e-3 * (n * 4) as f64 * SPACING * SPACING;
    let mut fluid = fluid([length, n, 4], [false, false, true], 0.8)
        .with_inertia(false)
        .with_face(0, Side::Low, Face::Flux(flux))
        .unwrap()
        .with_face(0, Side::High, Face::Pressure(0.0))
        .unwrap();
    run(&mut fluid, 20_000);
    assert!((fluid.inflow(0, Side::Low) / flux - 1.0).abs() < 1e-12);
    assert!((fluid.inflow(0, Side::High) / flux + 1.0).abs() < 1e-9);
    let all = fluid.macroscopic().unwrap();
    for x in [length / 2, length - 1] {
        for y in 0..n {
            let s = (y as f64 + 0.5) / n as f64;
            let u = all.velocity[0][y * length + x] / 1e-3;
            // The parabola of the flux over the nodes.
            let exact = 6.0 * s * (1.0 - s) / (1.0 + 0.5 / (n * n) as f64);
            assert!((u - exact).abs() < 2e-5, "{x} {y}: {u} {exact}");
        }
    }
}

/// A pipe whose round wall passes the faces, of radius `r` cells and 5 radii long: the flux half way along it over what goes in,
/// the pressure gradient there over that of the same flux in a periodic pipe, and what goes out over what goes in.
fn pipe(rule: WallRule, r: f64) -> [f64; 3] {
    let n = 2 * (r + 1.2).ceil() as usize;
    let middle = 0.5 * n as f64 * SPACING;
    let bore: Arc<dyn Boundary> = Arc::new(Closure::new(
        move |x: Vec3| r * SPACING - (x.y - middle).hypot(x.z - middle),
        1e-10,
    ));
    let mut whole = fluid([1, n, n], [true; 3], 1.0)
        .with_inertia(false)
        .with_wall_rule(rule);
    let force = 100.0;
    whole.set_drive(Drive::Force(Vec3::x() * force)).unwrap();
    whole.set_walls(Some(bore.clone()), 0.0).unwrap();
    run(&mut whole, (20.0 * r * r) as usize + 2000);
    let area = SPACING * SPACING;
    let flux = whole.superficial_velocity().x * (n * n) as f64 * area;
    let length = (5.0 * r) as usize;
    let mut open = fluid([length, n, n], [false, true, true], 1.0)
        .with_inertia(false)
        .with_wall_rule(rule)
        .with_face(0, Side::High, Face::Pressure(2.0))
        .unwrap();
    open.set_walls(Some(bore), 0.0).unwrap();
    open.set_face(0, Side::Low, Face::Flux(flux)).unwrap();
    run(&mut open, (200.0 * r * r) as usize + 2000);
    let all = open.macroscopic().unwrap();
    let half = length / 2;
    let inside = (0..n * n).map(|m| all.velocity[0][m * length + half]).sum::<f64>() * area;
    let p = |x: usize| all.pressure[((n / 2) * n + n / 2) * length + x];
    let gradient = 0.5 * (p(half - 1) - p(half + 1)) / SPACING;
    [inside / flux, gradient / force, -open.inflow(0, Side::High) / flux]
}

/// Halfway walls keep the mass. Interpolated ones lose some where the profile changes at the inflow, of second order, and gain
/// it where it goes out.
#[test]
fn faces_may_cut_a_round_wall() {
    let [inside, gradient, out] = pipe(WallRule::Halfway, 4.8);
    assert!((inside - 1.0).abs() < 1e-5 && (gradient - 1.0).abs() < 1e-5 && (out - 1.0).abs() < 1e-5);
    let [coarse, fine] = [4.8, 9.6].map(|r| pipe(WallRule::Cli, r));
    assert!(
        (coarse[0] - 1.0).abs() < 1e-2 && (fine[0] - 1.0).abs() < 2.5e-3,
        "{coarse:?} {fine:?}"
    );
    for [inside, gradient, out] in [coarse, fine] {
        assert!(
            (gradient - inside).abs() < 1e-3 && (out - 1.0).abs() < 1e-4,
            "{gradient} {inside} {out}"
        );
    }
}

/// A vortex that a uniform stream carries out: what is left of it behind a convective face, and of its pressure.
#[test]
fn a_vortex_leaves_by_a_convective_face() {
    let (n, speed) = (48, 0.05);
    let mut fluid = fluid([n, n, 1], [false, true, true], 0.52);
    let unit = SPACING / fluid.time_step();
    let stream = speed * unit;
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
    assert!(left < 0.02, "{left}");
}

/// Walls, inflow and a convective end: the mass stays bounded, and what goes in comes out.
#[test]
fn a_convective_end_keeps_the_mass_bounded() {
    let (n, length) = (10, 30);
    let flux = 2e-2 * (n * 2) as f64 * SPACING * SPACING;
    let mut fluid = fluid([length, n, 2], [false, false, true], 0.7)
        .with_face(0, Side::Low, Face::Flux(flux))
        .unwrap();
    let speed = 2e-2;
    fluid.set_face(0, Side::High, Face::Convective(speed)).unwrap();
    run(&mut fluid, 20_000);
    let mean = |fluid: &Fluid| {
        let p = fluid.macroscopic().unwrap().pressure;
        p.iter().sum::<f64>() / p.len() as f64
    };
    let first = mean(&fluid);
    assert!(
        (fluid.inflow(0, Side::High) / flux + 1.0).abs() < 1e-4,
        "{}",
        fluid.inflow(0, Side::High) / flux
    );
    run(&mut fluid, 20_000);
    let drop = 12.0 * VISCOSITY * 2e-2 / (n as f64 * SPACING).powi(2) * length as f64 * SPACING;
    assert!(
        (mean(&fluid) - first).abs() < 1e-3 * drop,
        "{} {first} {drop}",
        mean(&fluid)
    );
}

#[test]
fn faces_that_do_not_fit_are_errors() {
    let box_ = || fluid([8, 8, 8], [false, false, true], 1.0);
    let fails = |axis, face| box_().with_face(axis, Side::Low, face).unwrap_err();
    let of = |e| match e {
        LbmError::Face(e) => e,
        e => panic!("{e}"),
    };
    assert_eq!(of(fails(2, Face::Symmetry)), FaceError::Periodic { axis: 2 });
    assert_eq!(of(fails(3, Face::Symmetry)), FaceError::NoAxis { axis: 3 });
    assert!(matches!(
        fails(0, Face::Pressure(f64::NAN)),
        LbmError::NotFinite { name: "pressure", .. }
    ));
    assert!(matches!(fails(0, Face::Convective(0.0)), LbmError::NotPositive { .. }));
    assert!(matches!(
        of(fails(0, Face::velocity(|_| Vec3::x() * f64::INFINITY))),
        FaceError::Velocity {
            axis: 0,
            side: Side::Low,
            ..
        }
    ));
    let e = of(fails(0, Face::velocity(|_| Vec3::x() * 1e3)));
    assert!(matches!(e, FaceError::TooFast { .. }) && e.to_string().contains("time step of at most"));
    assert!(matches!(of(fails(0, Face::Flux(1.0))), FaceError::TooFast { .. }));
    // Two fluxes that are not the same fail in the next step, two that are do not.
    let both = |out: f64| {
        let mut fluid = box_().with_face(0, Side::Low, Face::Flux(1e-14)).unwrap();
        fluid.set_face(0, Side::High, Face::Flux(out)).unwrap();
        let idle = Bricks::new(fluid.grid());
        (0..50).try_for_each(|_| fluid.advance(&idle))
    };
    both(-1e-14).unwrap();
    let Err(FluidError::Other(e)) = both(-2e-14) else {
        panic!()
    };
    let Some(FaceError::Unbalanced { flux }) = e.downcast_ref() else {
        panic!("{e}")
    };
    assert!((flux + 1e-14).abs() < 1e-24);
    // A face that a wall covers.
    let mut fluid = box_();
    fluid.set_face(0, Side::High, Face::Pressure(0.0)).unwrap();
    fluid
        .set_walls(Some(Arc::new(Plane::new(Vec3::x() * 2e-6, Vec3::x()))), 0.0)
        .unwrap();
    let e = fluid.set_face(0, Side::Low, Face::Flux(1e-15)).unwrap_err();
    assert!(matches!(
        of(e),
        FaceError::NoOpening {
            axis: 0,
            side: Side::Low,
            ..
        }
    ));
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut fluid = fluid([36, 34, 30], [false, false, false], 0.8).with_wall_rule(WallRule::Cli);
            fluid.set_face(0, Side::Low, Face::Flux(1e-12)).unwrap();
            fluid.set_face(0, Side::High, Face::Pressure(1.0)).unwrap();
            fluid.set_face(2, Side::High, Face::Symmetry).unwrap();
            fluid.set_face(1, Side::Low, Face::Convective(1e-3)).unwrap();
            let ball = Closure::new(|x: Vec3| (x - Vec3::repeat(17.3e-6)).norm() - 9.2e-6, 1e-9);
            fluid.set_walls(Some(Arc::new(Union::new().with(ball))), 0.0).unwrap();
            let idle = Bricks::new(fluid.grid());
            (0..31).for_each(|_| fluid.advance(&idle).unwrap());
            let all = fluid.macroscopic().unwrap();
            let bits = |v: &Vec<f64>| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            (
                all.velocity.each_ref().map(bits),
                bits(&all.pressure),
                fluid.inflow(0, Side::High).to_bits(),
            )
        })
    };
    let one = run(1);
    assert!(one == run(2));
    assert!(one == run(3));
}
