//! Walls that are not half way between nodes.

use lbm_ibm_coupling::{Boundary, Bricks, Closure, Grid, Lattice, Plane, Probe, Union, Vec3};
use lbm_ibm_lbm::{Collision, Drive, Fluid, Pace, WallRule};
use std::f64::consts::PI;
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;
const FORCE: f64 = 10.0;

/// Runs until no velocity changes by more than 1e-9 of the greatest in `window` steps.
fn settle(fluid: &mut Fluid, window: usize) {
    let idle = Bricks::new(fluid.grid());
    let mut last = Vec3::zeros();
    for _ in 0..200 {
        for _ in 0..window {
            fluid.advance(&idle).unwrap();
        }
        let now = fluid.superficial_velocity();
        if (now - last).norm() < 1e-9 * now.norm() {
            return;
        }
        last = now;
    }
    panic!("the flow does not settle");
}

/// A channel of slope 1:3 in a box of 3n by n nodes, `0.8` of the period across; root mean square of velocities off the
/// parabola, and the sum of all velocities along the channel, relative to the greatest velocity.
fn inclined(rule: WallRule, n: usize, tau: f64) -> (f64, f64) {
    let length = n as f64 * SPACING;
    let across = Vec3::new(-1.0, 3.0, 0.0) / 10f64.sqrt();
    let along = Vec3::new(3.0, 1.0, 0.0) / 10f64.sqrt();
    let period = 3.0 * length / 10f64.sqrt();
    let half = 0.4 * period;
    let distance = move |x: Vec3| half - ((across.dot(&x) - 0.13 * period).rem_euclid(period) - 0.5 * period).abs();
    let grid = Grid::new([3 * n, n, 1], SPACING, [true; 3]);
    let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))
        .unwrap()
        .with_inertia(false)
        .with_wall_rule(rule)
        .with_drive(Drive::Force(along * FORCE))
        .unwrap();
    let walls: Arc<dyn Boundary> = Arc::new(Closure::new(distance, 1e-10));
    let report = fluid.set_walls(Some(walls.clone()), 0.0).unwrap();
    assert_eq!(
        (report.uninterpolated_links, report.thin_links, report.closed_gaps),
        (0, 0, 0)
    );
    let window = ((n * n) as f64 * 0.6 / (10.0 * fluid.lattice_viscosity())).ceil() as usize;
    settle(&mut fluid, window.max(40));
    let all = fluid.macroscopic().unwrap();
    let load = fluid.wall_loads(walls.as_ref(), 0.0, Vec3::zeros()).unwrap()[0].force;
    let drive = along * (FORCE * report.fluid_nodes as f64 * SPACING.powi(3));
    assert!((load - drive).norm() < 1e-6 * drive.norm(), "{load:?} {drive:?}");
    let top = FORCE * half * half / (2.0 * VISCOSITY);
    let (mut off, mut sum, mut nodes) = (0.0, 0.0, 0.0);
    for j in 0..n {
        for i in 0..3 * n {
            let at = j * 3 * n + i;
            if all.solid[at] == 1 {
                continue;
            }
            let u = Vec3::new(all.velocity[0][at], all.velocity[1][at], all.velocity[2][at]) / top;
            let d = distance(fluid.grid().position(i, j, 0)) / half;
            off += (u - along * (d * (2.0 - d))).norm_squared();
            sum += u.dot(&along);
            nodes += 1.0;
        }
    }
    ((off / nodes).sqrt(), sum / nodes)
}

/// CLI's wall stays where it is whatever tau, Bouzidi's does not; both are of second order, halfway walls of first.
#[test]
fn an_inclined_wall_does_not_move_with_tau() {
    let flux = |rule, tau| inclined(rule, 10, tau).1;
    let spread = |rule| {
        let all = [0.55, 0.8, 4.0].map(|tau| flux(rule, tau));
        all[1..].iter().map(|f| (f / all[0] - 1.0).abs()).fold(0.0, f64::max)
    };
    let (cli, bouzidi) = (spread(WallRule::Cli), spread(WallRule::Bouzidi));
    assert!(cli < 1e-4 && bouzidi > 0.05, "{cli} {bouzidi}");
    let order = |rule| (inclined(rule, 10, 2.0).0 / inclined(rule, 40, 2.0).0).log2() / 2.0;
    let orders = [WallRule::Cli, WallRule::Bouzidi, WallRule::Halfway].map(order);
    assert!(orders[0] > 1.9 && orders[1] > 1.9 && orders[2] < 1.5, "{orders:?}");
    let error = inclined(WallRule::Cli, 20, 2.0).0;
    assert!(error < 4e-3, "{error}");
}

/// Flow between plates that stand at a fraction `q` of a link from the outermost nodes, `n` nodes between them: what it has
/// too much, in units in which the parabola is `y (h - y)`, least and greatest over the nodes.
fn plates(rule: WallRule, n: usize, q: f64, tau: f64, magic: f64) -> [f64; 2] {
    let height = (n as f64 - 1.0 + 2.0 * q) * SPACING;
    let low = (2.5 - q) * SPACING;
    let walls = Union::new()
        .with(Plane::new(Vec3::y() * low, Vec3::y()))
        .with(Plane::new(Vec3::y() * (low + height), -Vec3::y()));
    let mut fluid = Fluid::new(
        Grid::new([1, n + 4, 2], SPACING, [true; 3]),
        DENSITY,
        VISCOSITY,
        Pace::Tau(tau),
    )
    .unwrap()
    .with_collision(Collision::Trt { magic })
    .unwrap()
    .with_wall_rule(rule)
    .with_drive(Drive::Force(Vec3::z() * FORCE))
    .unwrap();
    fluid.set_walls(Some(Arc::new(walls)), 0.0).unwrap();
    let window = (n * n) as f64 / fluid.lattice_viscosity();
    settle(&mut fluid, window.ceil() as usize + 20);
    let velocity = &fluid.macroscopic().unwrap().velocity[2];
    let scale = 2.0 * VISCOSITY / (FORCE * SPACING * SPACING);
    let off = (0..n).map(|i| {
        let y = i as f64 + q;
        velocity[i + 2] * scale - y * (height / SPACING - y)
    });
    off.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], u| {
        [low.min(u), high.max(u)]
    })
}

/// Of the parabola CLI keeps the slope at the wall exactly and the curvature for one magic number, `3 q^2/4`: the slip is
/// `4 magic/3 - q^2` at every tau. At `q = 1/2` this is the slip of halfway walls.
#[test]
fn plates_may_stand_anywhere() {
    for q in [0.02, 0.2, 0.5, 0.7, 1.0] {
        for tau in [0.6, 3.0] {
            for magic in [3.0 / 16.0, (0.75_f64 * q * q).max(0.02)] {
                let slip = 4.0 / 3.0 * magic - q * q;
                for off in plates(WallRule::Cli, 6, q, tau, magic) {
                    // The cut is known to 1e-9.
                    assert!(
                        (off - slip).abs() < 2e-8,
                        "q {q} tau {tau} magic {magic}: {off} against {slip}"
                    );
                }
            }
        }
    }
}

/// A cylinder that turns in one at rest, both about the middle of a box one node long: greatest error of the velocity over
/// the greatest velocity, and the torques per length over the exact one.
fn couette(rule: WallRule, n: usize, tau: f64) -> (f64, [f64; 2]) {
    let length = n as f64 * SPACING;
    let (inner, outer) = (0.2 * length, 0.43 * length);
    let omega = 1e-3 / inner;
    let walls: Arc<dyn Boundary> = Arc::new(Journal {
        centre: 0.5 * length,
        inner,
        outer,
        omega,
    });
    let grid = Grid::new([n, n, 1], SPACING, [true; 3]);
    let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))
        .unwrap()
        .with_inertia(false)
        .with_wall_rule(rule);
    fluid.set_walls(Some(walls.clone()), 0.0).unwrap();
    let steps = 3.0 * (outer - inner).powi(2) / SPACING.powi(2) / fluid.lattice_viscosity();
    let idle = Bricks::new(fluid.grid());
    for _ in 0..steps as usize {
        fluid.advance(&idle).unwrap();
    }
    let b = omega / (inner.powi(-2) - outer.powi(-2));
    let all = fluid.macroscopic().unwrap();
    let mut worst = 0.0_f64;
    for m in (0..n * n).filter(|m| all.solid[*m] == 0) {
        let x = fluid.grid().position(m % n, m / n, 0) - Vec3::new(0.5, 0.5, 0.0) * length;
        let r = x.x.hypot(x.y);
        let u = b * (1.0 / (r * r) - 1.0 / (outer * outer));
        let off = Vec3::new(
            all.velocity[0][m] + u * x.y,
            all.velocity[1][m] - u * x.x,
            all.velocity[2][m],
        );
        worst = worst.max(off.norm());
    }
    let middle = Vec3::new(0.5, 0.5, 0.5 / n as f64) * length;
    let loads = fluid.wall_loads(walls.as_ref(), 0.0, middle).unwrap();
    let exact = 4.0 * PI * VISCOSITY * b * SPACING;
    (worst / (omega * inner), [0, 1].map(|part| loads[part].torque.z / exact))
}

/// A shaft (part 0) that turns in a bore (part 1).
struct Journal {
    centre: f64,
    inner: f64,
    outer: f64,
    omega: f64,
}

impl Boundary for Journal {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let r = Vec3::new(x.x - self.centre, x.y - self.centre, 0.0);
        let out = r.normalize();
        let (shaft, bore) = (r.norm() - self.inner, self.outer - r.norm());
        if shaft < bore {
            let velocity = Vec3::z().cross(&out) * (self.omega * self.inner);
            Probe {
                velocity,
                ..Probe::at_rest(shaft, out)
            }
        } else {
            Probe {
                part: 1,
                ..Probe::at_rest(bore, -out)
            }
        }
    }
}

#[test]
fn a_turning_shaft_has_its_torque_at_every_tau() {
    let all = [0.6, 1.0, 3.0].map(|tau| couette(WallRule::Cli, 40, tau));
    for (error, torque) in all {
        assert!(error < 5e-3, "{error}");
        assert!(
            (torque[0] + 1.0).abs() < 5e-3 && (torque[1] - 1.0).abs() < 5e-3,
            "{torque:?}"
        );
        assert!((torque[1] - all[1].1[1]).abs() < 1e-5, "{torque:?}");
    }
    let (error, torque) = couette(WallRule::Cli, 80, 3.0);
    assert!(error < 1.5e-3 && (torque[1] - 1.0).abs() < 5e-4, "{error} {torque:?}");
    assert!((couette(WallRule::Bouzidi, 40, 1.0).1[1] - 1.0).abs() < 5e-3);
}

/// A ball off the nodes in a flow with inertia: interpolation gains mass in every step, until what it gives back is as much.
#[test]
fn interpolated_walls_keep_the_mass_within_a_few_hundred_steps_gain() {
    let centre = Vec3::new(5.31, 6.17, 5.73) * SPACING;
    let mass = |fluid: &Fluid| fluid.macroscopic().unwrap().pressure.iter().sum::<f64>();
    for rule in [WallRule::Cli, WallRule::Bouzidi] {
        let grid = Grid::new([11, 13, 12], SPACING, [true, true, false]);
        let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(0.7))
            .unwrap()
            .with_wall_rule(rule);
        fluid.set_drive(Drive::Force(Vec3::new(1e6, 2e5, 0.0))).unwrap();
        let ball = Closure::new(move |x: Vec3| (x - centre).norm() - 3.4 * SPACING, 1e-9);
        fluid.set_walls(Some(Arc::new(ball)), 0.0).unwrap();
        let idle = Bricks::new(fluid.grid());
        let mut run = |steps: usize| {
            (0..steps).for_each(|_| fluid.advance(&idle).unwrap());
            mass(&fluid)
        };
        let (early, late, last) = (run(1), run(6000), run(6000));
        assert!(
            early != 0.0 && late != 0.0 && (last - late).abs() < 1e-6 * late.abs(),
            "{early} {late} {last}"
        );
    }
}

/// Flux control counts what interpolation adds to the momentum: it holds its target, with the force that the wall takes.
#[test]
fn flux_control_holds_past_interpolated_walls() {
    let ball: Arc<dyn Boundary> = Arc::new(Closure::new(
        |x: Vec3| (x - Vec3::new(6.2, 5.9, 6.1) * SPACING).norm() - 3.3 * SPACING,
        1e-9,
    ));
    for rule in [WallRule::Cli, WallRule::Bouzidi] {
        let grid = Grid::new([12; 3], SPACING, [true; 3]);
        let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(0.9))
            .unwrap()
            .with_wall_rule(rule);
        fluid.set_drive(Drive::flux(0, 1e-3)).unwrap();
        let report = fluid.set_walls(Some(ball.clone()), 0.0).unwrap();
        let idle = Bricks::new(fluid.grid());
        (0..4000).for_each(|_| fluid.advance(&idle).unwrap());
        let error = (fluid.superficial_velocity().x / 1e-3 - 1.0).abs();
        // What the walls still give back of the mass decays in 256 steps.
        assert!(error < 1e-8, "{rule:?}: {error:e}");
        let drive = fluid.body_force() * (report.fluid_nodes as f64 * SPACING.powi(3));
        let load = fluid.wall_loads(ball.as_ref(), 0.0, Vec3::zeros()).unwrap()[0].force;
        assert!((load.x / drive.x - 1.0).abs() < 1e-7, "{rule:?}: {load:?} {drive:?}");
    }
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let grid = Grid::new([40, 34, 33], SPACING, [true; 3]);
            let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(0.8))
                .unwrap()
                .with_wall_rule(WallRule::Cli);
            fluid.set_drive(Drive::flux(0, 1e-2)).unwrap();
            let ball = Closure::new(|x: Vec3| (x - Vec3::repeat(17.3e-6)).norm() - 15.2e-6, 1e-9);
            let plate = Closure::new(|x: Vec3| (x.x - 36.3e-6).hypot((x.y - 17e-6).max(0.0)), 1e-9);
            let report = fluid
                .set_walls(Some(Arc::new(Union::new().with(ball).with(plate))), 0.0)
                .unwrap();
            assert!(report.wall_links > 8192 && report.thin_links > 1000, "{report:?}");
            let idle = Bricks::new(fluid.grid());
            (0..31).for_each(|_| fluid.advance(&idle).unwrap());
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
