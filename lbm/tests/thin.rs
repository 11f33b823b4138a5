//! Walls thinner than a cell, and gaps without a node.

use lbm_ibm_coupling::{Boundary, Bricks, Closure, Grid, Lattice, Probe, Union, Vec3};
use lbm_ibm_lbm::{Drive, Fluid, Pace, WallRule};
use std::f64::consts::PI;
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;

/// Plates without thickness, half way between nodes, part the fluid as the faces of a grid do: the same flow in every step,
/// across every axis, also at the ends of the box. The load on a plate is that on the two faces.
#[test]
fn a_plate_without_thickness_parts_the_fluid() {
    for (axis, rule) in [
        (0, WallRule::Halfway),
        (1, WallRule::Halfway),
        (2, WallRule::Cli),
        (0, WallRule::Cli),
    ] {
        let (whole, middle) = (10, 4);
        let build = |first: usize, nodes: usize, open: bool| {
            let mut shape = [5, 6, 7];
            shape[axis] = nodes;
            let mut origin = Vec3::zeros();
            origin[axis] = first as f64 * SPACING;
            let periodic = std::array::from_fn(|a| open || a != axis);
            let grid = Grid::new(shape, SPACING, periodic).with_origin(origin);
            let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(0.8))
                .unwrap()
                .with_wall_rule(rule);
            fluid.set_drive(Drive::Force(Vec3::new(3e4, -2e4, 1e4))).unwrap();
            fluid
        };
        let slide = Vec3::new(0.3, 0.2, -0.4).map(|v| v * 1e-1);
        let plates = Plates {
            axis,
            at: [0.0, middle as f64 * SPACING],
            period: whole as f64 * SPACING,
            slide,
        };
        let walls: Arc<dyn Boundary> = Arc::new(plates);
        let mut both = build(0, whole, true);
        let report = both.set_walls(Some(walls.clone()), 0.0).unwrap();
        let face = report.fluid_nodes / whole;
        assert_eq!(
            (report.solid_nodes, report.wall_links, report.thin_links),
            (0, 0, 2 * 5 * face)
        );
        let mut parts = [build(0, middle, false), build(middle, whole - middle, false)];
        for part in &mut parts {
            part.set_walls(Some(walls.clone()), 0.0).unwrap();
        }
        let unit = SPACING / both.time_step();
        let wave = |x: Vec3| {
            let k = x / SPACING;
            Vec3::new((k.y + 0.3 * k.z).sin(), (2.0 * k.x).cos(), (0.7 * k.x + k.y).sin()) * (0.02 * unit)
        };
        both.set_velocity(wave);
        parts.iter_mut().for_each(|p| p.set_velocity(wave));
        let mass = |fluid: &Fluid| fluid.macroscopic().unwrap().pressure.iter().sum::<f64>();
        let before = mass(&both);
        for step in 0..9 {
            both.advance(&Bricks::new(both.grid())).unwrap();
            let all = both.macroscopic().unwrap();
            let mut force = [Vec3::zeros(); 2];
            for (part, first) in parts.iter_mut().zip([0, middle]) {
                part.advance(&Bricks::new(part.grid())).unwrap();
                let own = part.macroscopic().unwrap();
                let [nx, ny, nz] = part.grid().shape;
                for (n, at) in (0..nz)
                    .flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
                    .enumerate()
                {
                    let mut at = at;
                    at[axis] += first;
                    let m = (at[2] * both.grid().shape[1] + at[1]) * both.grid().shape[0] + at[0];
                    for a in 0..3 {
                        let off = (all.velocity[a][m] - own.velocity[a][n]).abs() / unit;
                        assert!(off < 1e-15, "axis {axis} step {step} node {at:?}: {off:e}");
                    }
                    assert!((all.pressure[m] - own.pressure[n]).abs() < 1e-15 * DENSITY * unit * unit);
                }
                for (sum, load) in force
                    .iter_mut()
                    .zip(part.wall_loads(walls.as_ref(), 0.0, Vec3::zeros()).unwrap())
                {
                    *sum += load.force;
                }
            }
            let loads = both.wall_loads(walls.as_ref(), 0.0, Vec3::zeros()).unwrap();
            for (load, force) in loads.iter().zip(force) {
                assert!(
                    (load.force - force).norm() < 1e-12 * force.norm(),
                    "axis {axis}: {load:?} {force:?}"
                );
            }
        }
        assert!((mass(&both) - before).abs() < 1e-12 * DENSITY * unit * unit);
    }
}

/// Two plates without thickness, part 0 and 1, that slide on themselves.
struct Plates {
    axis: usize,
    at: [f64; 2],
    period: f64,
    slide: Vec3,
}

impl Boundary for Plates {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let off = self
            .at
            .map(|at| (x[self.axis] - at + 0.5 * self.period).rem_euclid(self.period) - 0.5 * self.period);
        let part = usize::from(off[1].abs() < off[0].abs());
        let mut normal = Vec3::zeros();
        normal[self.axis] = off[part].signum();
        let mut velocity = self.slide;
        velocity[self.axis] = 0.0;
        Probe {
            velocity,
            part: part as u32,
            ..Probe::at_rest(off[part].abs(), normal)
        }
    }
}

/// A thin slab between nodes parts the fluid, wherever it stands; so do two slabs and what is left between them.
#[test]
fn thin_walls_and_lost_gaps_are_reported() {
    let slab = |y: f64, half: f64| Closure::new(move |x: Vec3| (x.y - y * SPACING).abs() - half * SPACING, 1e-9);
    let grid = || Grid::new([4, 12, 5], SPACING, [true; 3]);
    let mut fluid = Fluid::new(grid(), DENSITY, VISCOSITY, Pace::Tau(0.8))
        .unwrap()
        .with_wall_rule(WallRule::Cli);
    let walls: Arc<dyn Boundary> = Arc::new(Union::new().with(slab(4.1, 0.2)).with(slab(9.0, 1.1)));
    let report = fluid.set_walls(Some(walls.clone()), 0.0).unwrap();
    assert_eq!(
        (report.thin_links, report.solid_nodes, report.closed_gaps),
        (5 * 20, 2 * 20, 0)
    );
    // A stream between the slabs leaves the fluid beyond at rest.
    let between = |y: f64| (4.1..9.0).contains(&(y / SPACING));
    fluid.set_velocity(|x| Vec3::x() * if between(x.y) { 1e-2 } else { 0.0 });
    let idle = Bricks::new(fluid.grid());
    (0..20).for_each(|_| fluid.advance(&idle).unwrap());
    let along = &fluid.macroscopic().unwrap().velocity[0];
    for j in 0..12 {
        let u = along[4 * j];
        assert!(
            if (4..8).contains(&j) { u > 1e-4 } else { u.abs() < 1e-15 },
            "row {j}: {u}"
        );
    }

    let close = Union::new().with(slab(5.5, 1.4)).with(slab(8.5, 1.4));
    let report = fluid.set_walls(Some(Arc::new(close)), 0.0).unwrap();
    assert_eq!((report.thin_links, report.closed_gaps), (0, 20));
}

/// Links between fluid nodes on either side of a square edge do not pass through it; those that graze a ball of 2.5 cells do.
#[test]
fn links_do_not_cut_square_edges() {
    let thin = |distance: fn(Vec3) -> f64| {
        let grid = Grid::new([12; 3], SPACING, [true; 3]);
        let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(1.0)).unwrap();
        let walls = Closure::new(move |x: Vec3| distance(x / SPACING) * SPACING, 1e-10);
        fluid.set_walls(Some(Arc::new(walls)), 0.0).unwrap().thin_links
    };
    // A square from 3.6 to 8.4 cells: the diagonal across each corner is 0.4 cells deep in it.
    let square = |x: Vec3| {
        let (a, b) = ((x.x - 6.0).abs() - 2.4, (x.y - 6.0).abs() - 2.4);
        if a > 0.0 && b > 0.0 { a.hypot(b) } else { a.max(b) }
    };
    assert_eq!(thin(square), 4 * 12);
    assert_eq!(thin(|x| (x - Vec3::new(6.2, 6.1, 6.4)).norm() - 2.5), 0);
}

/// Flow through a slit of 6 cells in plates without thickness, 36 cells apart each way and with the slit's middle `off` cells from that
/// between two nodes, over the exact one: drop `-4 pi mu U/(P ln cos(pi h/2P))` for a period P (Hasimoto 1958).
fn through_slit(off: f64, tau: f64) -> f64 {
    let (n, h) = (36, 6.0);
    let grid = Grid::new([n, n, 1], SPACING, [true; 3]);
    let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))
        .unwrap()
        .with_inertia(false);
    fluid.set_drive(Drive::Force(Vec3::x())).unwrap();
    let middle = 0.5 * n as f64;
    let wall = Closure::new(
        move |x: Vec3| {
            let rim = 0.5 * h - (x.y / SPACING - middle - off).abs();
            (x.x / SPACING - middle).hypot(rim.max(0.0)) * SPACING
        },
        1e-10,
    );
    let report = fluid.set_walls(Some(Arc::new(wall)), 0.0).unwrap();
    assert_eq!(report.solid_nodes, 0);
    fluid.set_velocity(|_| Vec3::zeros());
    let mass = |fluid: &Fluid| fluid.macroscopic().unwrap().pressure.iter().sum::<f64>();
    let idle = Bricks::new(fluid.grid());
    let steps = (400.0 / fluid.lattice_viscosity()).max(4000.0) as usize;
    (0..steps).for_each(|_| fluid.advance(&idle).unwrap());
    let all = fluid.macroscopic().unwrap();
    let scale: f64 = all.pressure.iter().map(|p| p.abs()).sum();
    assert!(mass(&fluid).abs() < 1e-10 * scale, "{:e} of {scale:e}", mass(&fluid));
    let period = n as f64 * SPACING;
    let exact = -4.0 * PI * VISCOSITY / (period * (PI * h / (2.0 * n as f64)).cos().ln());
    fluid.superficial_velocity().x * exact / period
}

/// Rims act where they are, wherever links cross their plane; links that pass or not would let 12 % too much through at any but the
/// first of these places. What passes does not depend on tau.
#[test]
fn rims_act_where_they_are() {
    for off in [0.0, 0.1, 0.25, 0.4, 0.5] {
        let all = [0.7, 1.5, 3.0].map(|tau| through_slit(off, tau));
        assert!((all[0] - 1.0).abs() < 0.015, "{off}: {all:?}");
        assert!(
            all.iter().all(|flow| (flow / all[0] - 1.0).abs() < 1e-5),
            "{off}: {all:?}"
        );
    }
}
