//! Stokes flow through arrays of spheres and of cylinders, and along a channel that is inclined to the grid.

use super::finding::observed_order;
use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::reference::Table;
use lbm_ibm::coupling::{Bricks, Closure, Grid, Lattice, UM, Vec3};
use lbm_ibm::lbm::{Collision, Drive, Fluid, Pace, Precision, WallRule};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Water.
const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
/// Force density along x, N/m3.
const FORCE: f64 = 1.0;

/// A relaxation time at which a flow is soon steady; with CLI it does not depend on it.
const TAU: f64 = 3.0;

/// What a case is computed with.
#[derive(Clone, Copy, Debug)]
pub struct Numerics {
    /// Wall rule.
    pub rule: WallRule,
    /// Relaxation time.
    pub tau: f64,
    /// Nodes along the box.
    pub cells: usize,
    /// Collision.
    pub collision: Collision,
    /// What populations are stored as.
    pub precision: Precision,
}

impl Numerics {
    /// TRT in f64.
    pub fn new(rule: WallRule, tau: f64, cells: usize) -> Self {
        Self {
            rule,
            tau,
            cells,
            collision: Collision::default(),
            precision: Precision::default(),
        }
    }

    /// The same with another precision.
    pub fn stored(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    /// A fluid without inertia at rest; nodes of narrow gaps stay in it.
    ///
    /// # Errors
    /// Those of the fluid.
    pub fn fluid(self, grid: Grid) -> Result<Fluid, Fault> {
        Ok(Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(self.tau))?
            .with_inertia(false)
            .with_collision(self.collision)?
            .with_precision(self.precision)
            .with_wall_rule(self.rule)
            .with_narrow_gaps_kept())
    }
}

/// A steady flow without inertia.
pub struct Steady {
    /// The fluid.
    pub fluid: Fluid,
    /// Superficial velocity, m/s.
    pub velocity: Vec3,
}

impl Steady {
    /// The flow in a periodic box of `shape` nodes of 1 um past solids with a signed distance (m), under a force density
    /// `force` (N/m3). It is steady when the superficial velocity changes by less than `tolerance` of itself in `window`
    /// steps.
    ///
    /// # Errors
    /// Those of the fluid; a flow that does not become steady.
    pub fn new(
        shape: [usize; 3],
        numerics: Numerics,
        distance: impl Fn(Vec3) -> f64 + Clone + Send + Sync + 'static,
        force: Vec3,
        settled: (usize, f64),
    ) -> Result<Self, Fault> {
        Self::from_start(shape, numerics, distance, force, settled, Vec3::zeros())
    }

    /// The same from a uniform velocity (m/s), which saves the time in which a dilute array brings the fluid into motion.
    fn from_start(
        shape: [usize; 3],
        numerics: Numerics,
        distance: impl Fn(Vec3) -> f64 + Clone + Send + Sync + 'static,
        force: Vec3,
        settled: (usize, f64),
        start: Vec3,
    ) -> Result<Self, Fault> {
        Self::settle(numerics, settled, &|numerics| {
            let mut fluid = numerics.fluid(Grid::new(shape, UM, [true; 3]))?;
            fluid.set_drive(Drive::Force(force))?;
            fluid.set_walls(Some(Arc::new(Closure::new(distance.clone(), 1e-4 * UM))), 0.0)?;
            // At rest means at rest with half a step of the force: else a trace of the start stays between walls, in proportion to tau.
            fluid.set_velocity(|_| start);
            Ok(fluid)
        })
    }

    /// Runs a fluid until it is steady, as [`Steady::new`] says.
    ///
    /// # Errors
    /// Those of the fluid; a flow that does not become steady.
    pub fn settle(
        numerics: Numerics,
        (window, tolerance): (usize, f64),
        make: &dyn Fn(Numerics) -> Result<Fluid, Fault>,
    ) -> Result<Self, Fault> {
        let steps = if numerics.precision == Precision::F64 {
            None
        } else {
            // Rounding hides when it is steady: as many steps as in 64 bits.
            let steady = Self::settle(numerics.stored(Precision::F64), (window, tolerance), make)?;
            Some(steady.fluid.steps())
        };
        let mut fluid = make(numerics)?;
        let bricks = Bricks::new(fluid.grid());
        let mut last = Vec3::zeros();
        for _ in 0..1000 {
            for _ in 0..window {
                fluid.advance(&bricks)?;
            }
            let velocity = fluid.superficial_velocity();
            if steps == Some(fluid.steps()) {
                return Ok(Self { fluid, velocity });
            }
            if steps.is_none() && (velocity - last).norm() <= tolerance * velocity.norm() {
                return Ok(Self { fluid, velocity });
            }
            last = velocity;
        }
        Err(format!(
            "{numerics:?}: the flow has not become steady in {} steps",
            fluid.steps()
        )
        .into())
    }
}

/// Offset from the nearest of the points that lie about the middle of each period, m.
fn nearest(x: Vec3, period: f64) -> Vec3 {
    x.map(|x| x.rem_euclid(period) - 0.5 * period)
}

/// Drag on a sphere of a simple cubic array over Stokes' in an unbounded fluid of the superficial velocity, and the fluid.
/// `radius` is over the period, `place` that of the sphere from the middle of the box, in spacings.
///
/// # Errors
/// As for [`Steady::new`].
pub fn sphere_drag(numerics: Numerics, radius: f64, place: Vec3) -> Result<(f64, Fluid), Fault> {
    let n = numerics.cells;
    let length = n as f64 * UM;
    let a = radius * length;
    let off = place * UM;
    let distance = move |x: Vec3| nearest(x - off, length).norm() - a;
    let window = (0.3 * (n * n) as f64 / (numerics.tau - 0.5) / 10.0).ceil() as usize;
    // Strong enough that populations of 16 bits keep their digits; without inertia the flow is in proportion.
    let force = 1e4 * FORCE;
    let settled = (window.max(50), 1e-6);
    // Of a drag of one in Stokes' units.
    let stokes = force * length.powi(3) / (6.0 * PI * VISCOSITY * a);
    // Hasimoto's (1959) first terms, where they hold.
    let start = if radius < DILUTE {
        stokes * (1.0 - 2.8373 * radius + 4.0 * PI / 3.0 * radius.powi(3))
    } else {
        0.0
    };
    let steady = Steady::from_start(
        [n; 3],
        numerics,
        distance,
        Vec3::x() * force,
        settled,
        Vec3::x() * start,
    )?;
    let drag = stokes / steady.velocity.x;
    Ok((drag, steady.fluid))
}

/// Radius over the period below which an array is dilute.
const DILUTE: f64 = 0.2;

/// Nodes across the period for a sphere of so many nodes' radius.
fn cells(radius_cells: f64, radius: f64) -> usize {
    (radius_cells / radius - 1e-3).ceil() as usize
}

/// Drag in simple cubic arrays of spheres against Zick and Homsy (1982): within 1 % where the radius is 8 nodes or more, and
/// the same within 0.02 % at tau 0.55 and 4. Where spheres touch, the nodes between them stay fluid; the order there is that of
/// the wedge about the contact, and errors are near the digits of the table. Spheres of less than 0.12 of the period are left out: a grid that
/// has 8 nodes to their radius is too large.
pub fn sphere_array_drag(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    for row in table.rows() {
        findings.begin(row.key(&["phi"]));
        let (radius, reference) = (row.number("a_over_L")?, row.number("K_ZH")?);
        if radius < 0.12 || (effort.quick && radius < 0.3) {
            findings.left_out += 1;
            continue;
        }
        let rule = WallRule::Cli;
        let drag = |radius_cells: f64, tau: f64, rule| {
            let cells = cells(radius_cells, radius);
            // A little off the nodes, so that they do not lie in the symmetry planes.
            let place = Vec3::new(0.13, 0.29, 0.41);
            sphere_drag(Numerics::new(rule, tau, cells).stored(effort.precision), radius, place).map(|(drag, _)| drag)
        };
        let radii: &[f64] = match radius {
            _ if effort.quick || radius < DILUTE => &[4.0, 8.0],
            _ if radius < 0.4 => &[4.0, 8.0, 12.0],
            _ => &[4.0, 8.0, 12.0, 16.0],
        };
        let mut drags = Vec::new();
        for &radius_cells in radii {
            let k = drag(radius_cells, TAU, rule)?;
            let what = format!("K, radius {radius_cells}");
            if radius_cells >= 8.0 {
                findings.check(&what, k, reference, 1e-2);
            } else {
                findings.report(&what, k, reference, reference);
            }
            drags.push((1.0 / radius_cells, (k / reference - 1.0).abs(), k));
        }
        let ends = [drags[0], drags[drags.len() - 1]].map(|(h, error, _)| (h, error));
        findings.report("order of K, first to last", observed_order(ends[0], ends[1]), 2.0, 1.0);
        for tau in if effort.quick {
            &[1.0, 4.0][..]
        } else {
            &[0.55, 1.0, 4.0]
        } {
            let k = drag(4.0, *tau, rule)?;
            findings.check(&format!("K, radius 4, tau {tau} to {TAU}"), k, drags[0].2, 2e-4);
        }
        for rule in [WallRule::Halfway, WallRule::Bouzidi] {
            let k = drag(8.0, TAU, rule)?;
            findings.report(&format!("K, radius 8, {rule:?}"), k, reference, reference);
        }
    }
    Ok(findings)
}

/// Force per length on a cylinder of a square array over viscosity and superficial velocity; `phi` is the solid fraction.
fn cylinder_drag(numerics: Numerics, phi: f64) -> Result<f64, Fault> {
    let n = numerics.cells;
    let length = n as f64 * UM;
    let a = (phi / PI).sqrt() * length;
    let off = Vec3::new(0.13, 0.29, 0.0) * UM;
    let distance = move |x: Vec3| {
        let r = nearest(x - off, length);
        r.x.hypot(r.y) - a
    };
    let window = (0.3 * (n * n) as f64 / (numerics.tau - 0.5) / 20.0).ceil() as usize;
    let steady = Steady::new([n, n, 1], numerics, distance, Vec3::x() * FORCE, (window, 1e-5))?;
    Ok(FORCE * length * length / (VISCOSITY * steady.velocity.x))
}

/// Drag in square arrays of cylinders against Sangani and Acrivos (1982): within 1 % on 128 nodes to a solid fraction of
/// 0.5, within 5 % on 512 beyond, which takes minutes.
pub fn cylinder_array_drag(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name()).stored(effort.precision);
    for row in table.rows() {
        findings.begin(row.key(&["phi"]));
        let (phi, reference) = (row.number("phi")?, row.number("F_over_muU_SA1982")?);
        if effort.quick && !(0.25..=0.55).contains(&phi) {
            findings.left_out += 1;
            continue;
        }
        let dense = phi > 0.55;
        let (cells, gate) = if dense { (512, 5e-2) } else { (128, 1e-2) };
        let tau = if dense { 1.0 } else { 2.0 };
        let drag = |cells| cylinder_drag(Numerics::new(WallRule::Cli, tau, cells).stored(effort.precision), phi);
        let (coarse, fine) = (drag(cells / 2)?, drag(cells)?);
        findings.report(&format!("F/(mu U), {} cells", cells / 2), coarse, reference, reference);
        findings.check(&format!("F/(mu U), {cells} cells"), fine, reference, gate);
    }
    Ok(findings)
}

/// Mean velocity in a channel of slope 1:3 on a box of 3n by n nodes, 0.8 of the period across, over that of the parabola
/// at the nodes; and the root mean square of the velocities off the parabola over the greatest.
fn inclined(numerics: Numerics) -> Result<(f64, f64), Fault> {
    let n = numerics.cells;
    let across = Vec3::new(-1.0, 3.0, 0.0) / 10f64.sqrt();
    let along = Vec3::new(3.0, 1.0, 0.0) / 10f64.sqrt();
    let period = 3.0 * n as f64 * UM / 10f64.sqrt();
    let half = 0.4 * period;
    let distance = move |x: Vec3| half - ((across.dot(&x) - 0.13 * period).rem_euclid(period) - 0.5 * period).abs();
    let window = (0.6 * (n * n) as f64 / (numerics.tau - 0.5)).ceil() as usize;
    let steady = Steady::new(
        [3 * n, n, 1],
        numerics,
        distance,
        along * FORCE,
        (window.max(1000), 1e-8),
    )?;
    let all = steady.fluid.macroscopic().ok_or("the fluid has no velocity field")?;
    let top = FORCE * half * half / (2.0 * VISCOSITY);
    let (mut sum, mut exact, mut off, mut nodes) = (0.0, 0.0, 0.0, 0.0);
    for m in (0..3 * n * n).filter(|m| all.solid[*m] == 0) {
        let d = distance(steady.fluid.grid().position(m % (3 * n), m / (3 * n), 0)) / half;
        let u = Vec3::new(all.velocity[0][m], all.velocity[1][m], all.velocity[2][m]) / top;
        sum += u.dot(&along);
        exact += d * (2.0 - d);
        off += (u - along * (d * (2.0 - d))).norm_squared();
        nodes += 1.0;
    }
    Ok((sum / exact, (off / nodes).sqrt()))
}

/// A plane channel of slope 1:3: with CLI the flow is the same within 0.1 % at tau 0.55 to 4, and of second order.
pub fn inclined_channel(effort: Effort) -> Outcome {
    let mut findings = Findings::of("inclined_channel").stored(effort.precision);
    for rule in [WallRule::Cli, WallRule::Bouzidi, WallRule::Halfway] {
        let text = [("rule", format!("{rule:?}"))];
        findings.begin(BTreeMap::from(text.map(|(k, v)| (k.to_owned(), v))));
        let gates = rule == WallRule::Cli;
        let at = |tau, cells| inclined(Numerics::new(rule, tau, cells).stored(effort.precision));
        let base = at(1.0, 10)?;
        for tau in [0.55, 0.8, 4.0] {
            let (flow, what) = (at(tau, 10)?.0, format!("flow at tau {tau} over tau 1, 10 cells"));
            if gates {
                findings.check(&what, flow / base.0, 1.0, 1e-3);
            } else {
                findings.report(&what, flow / base.0, 1.0, 1.0);
            }
        }
        let mut errors = vec![(0.1, base.1)];
        for cells in if effort.quick { &[20][..] } else { &[20, 40, 80] } {
            let (flow, off) = at(1.0, *cells)?;
            findings.report(&format!("flow, {cells} cells"), flow, 1.0, 1.0);
            findings.report(&format!("velocity, rms, {cells} cells"), off, 0.0, 1.0);
            errors.push((1.0 / *cells as f64, off));
        }
        let order = observed_order(errors[0], errors[errors.len() - 1]);
        if gates {
            findings.check_at_least("order of the velocity", order, 1.9);
        } else {
            findings.report("order of the velocity", order, 2.0, 1.0);
        }
    }
    Ok(findings)
}
