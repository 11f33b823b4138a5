//! What elastic cells cost in a step, as a whole and in parts.

use super::times;
use crate::Fault;
use crate::scenes::Crowd;
use lbm_ibm::coupling::{Bricks, Exchange, ImmersedBody, Lattice, Scene, Soa3, Soa3Mut};
use lbm_ibm::ibm::DeltaExchange;
use lbm_ibm::membrane::Cell;
use rayon::prelude::*;
use serde::Serialize;
use std::time::Instant;

/// Timings of one crowd. Medians, and the least times, which other work on the machine disturbs less.
#[derive(Serialize)]
pub struct Speed {
    /// Delta kernel.
    pub kernel: String,
    /// Nodes along each edge of the cube.
    pub size: usize,
    /// Spheres.
    pub count: usize,
    /// Threads.
    pub threads: usize,
    /// Nodes of all spheres.
    pub nodes: usize,
    /// Markers of all spheres.
    pub markers: usize,
    /// Whole step.
    pub ms_per_step: f64,
    /// Least whole step.
    pub best_ms_per_step: f64,
    /// Step of the bare fluid under a uniform force.
    pub fluid_ms_per_step: f64,
    /// Least step of the bare fluid.
    pub best_fluid_ms_per_step: f64,
    /// Whole step less bare fluid, per node, least times: also what forces on its nodes cost the fluid, and moving.
    pub best_us_per_node_in_step: f64,
    /// Rows of 8 grid nodes that are read, per node.
    pub rows_per_node: f64,
    /// The parts of a step by themselves, one after the other: with few cells all they touch stays in the caches.
    #[serde(flatten)]
    pub parts: Phases,
    /// The same where they stand in a step: between spreading and reading the fluid takes its step, which is not counted.
    pub in_turn: Phases,
}

/// Timings of forces, placing, spreading, reading the fluid's velocity and interpolation, us per node and step.
#[derive(Serialize)]
pub struct Phases {
    /// All of them, median.
    pub us_per_node: f64,
    /// All of them, least.
    pub best_us_per_node: f64,
    /// Elastic forces, least.
    pub forces: f64,
    /// Placing the markers, least.
    pub place: f64,
    /// Spreading, least.
    pub spread: f64,
    /// Reading the fluid's velocity, least.
    pub read: f64,
    /// Interpolation, least.
    pub interpolate: f64,
}

impl Phases {
    /// Of `parts`, for at least `seconds`.
    fn of(parts: &mut Parts, seconds: f64, in_turn: bool) -> Result<Self, Fault> {
        let scale = 1e-6 * parts.force.len().max(1) as f64;
        let mut least = [f64::INFINITY; 5];
        let mut sums = Vec::new();
        times(seconds, || {
            let times = parts.once(in_turn)?;
            least = std::array::from_fn(|i| least[i].min(times[i]));
            sums.push(times.iter().sum());
            Ok(())
        })?;
        sums.sort_by(f64::total_cmp);
        let [us_per_node, best_us_per_node] = median_and_least(&sums, scale);
        let [forces, place, spread, read, interpolate] = least.map(|t| t / scale);
        Ok(Self {
            us_per_node,
            best_us_per_node,
            forces,
            place,
            spread,
            read,
            interpolate,
        })
    }
}

impl std::fmt::Display for Phases {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:.3} us a node, best {:.3}: forces {:.3}, place {:.3}, spread {:.3}, read {:.3}, interpolate {:.3}",
            self.us_per_node, self.best_us_per_node, self.forces, self.place, self.spread, self.read, self.interpolate
        )
    }
}

/// Median and least, in units of `scale` seconds.
fn median_and_least(times: &[f64], scale: f64) -> [f64; 2] {
    [times[times.len() / 2] / scale, times[0] / scale]
}

/// Times `crowd` for at least `seconds` each: the bare fluid, whole steps, and the parts of a step.
///
/// # Errors
/// [`Fault`] where the cells do not fit.
pub fn cells(crowd: &Crowd, threads: usize, seconds: f64) -> Result<Speed, Fault> {
    let mut fluid = crowd.fluid()?;
    let bricks = Bricks::new(fluid.grid());
    // Even and odd steps differ: a pair at a time.
    let (bare, ()) = times(seconds, || {
        fluid.advance(&bricks)?;
        Ok(fluid.advance(&bricks)?)
    })?;
    let mut scene = crowd.scene()?;
    scene.step()?;
    let (whole, ()) = times(seconds, || {
        scene.step()?;
        Ok(scene.step()?)
    })?;
    let [fluid_ms_per_step, best_fluid_ms_per_step] = median_and_least(&bare, 2e-3);
    let [ms_per_step, best_ms_per_step] = median_and_least(&whole, 2e-3);
    let mut parts = Parts::of(crowd, &mut scene)?;
    let nodes = parts.force.len();
    let phases = Phases::of(&mut parts, seconds, false)?;
    let in_turn = Phases::of(&mut parts, seconds, true)?;
    let scale = 1e-6 * nodes.max(1) as f64;
    Ok(Speed {
        kernel: format!("{:?}", crowd.kernel),
        size: crowd.size,
        count: crowd.count,
        threads,
        nodes,
        markers: parts.exchange.marker_count(),
        ms_per_step,
        best_ms_per_step,
        fluid_ms_per_step,
        best_fluid_ms_per_step,
        best_us_per_node_in_step: 1e-3 * (best_ms_per_step - best_fluid_ms_per_step) / scale,
        rows_per_node: parts.rows() as f64 / nodes.max(1) as f64,
        parts: phases,
        in_turn,
    })
}

/// What the parts of a step work on: the nodes of a scene that has taken some steps.
struct Parts<'a> {
    cells: Vec<Cell>,
    x: Soa3,
    v: Soa3,
    force: Soa3,
    exchange: DeltaExchange,
    bricks: Bricks,
    lattice: &'a mut lbm_ibm::lbm::Fluid,
}

impl<'a> Parts<'a> {
    fn of(crowd: &Crowd, scene: &'a mut Scene) -> Result<Self, Fault> {
        let x: Soa3 = scene.positions().iter().collect();
        let infos = scene.bodies().to_vec();
        let sphere = crowd.sphere()?;
        let mut reference = Soa3::default();
        for _ in &infos {
            sphere.reference().iter().for_each(|p| reference.push(p));
        }
        let lattice: &mut lbm_ibm::lbm::Fluid = scene.fluid_as().ok_or("a crowd has a fluid")?;
        let mut exchange = DeltaExchange::new(crowd.kernel);
        exchange.set_bodies(&infos, reference.view(), lattice.grid())?;
        let bricks = Bricks::new(lattice.grid());
        Ok(Self {
            cells: vec![sphere; infos.len()],
            v: Soa3::zeros(x.len()),
            force: Soa3::zeros(x.len()),
            x,
            exchange,
            bricks,
            lattice,
        })
    }

    /// Rows of bricks in use.
    fn rows(&self) -> u32 {
        (0..self.bricks.len()).map(|s| self.bricks.rows(s).count_ones()).sum()
    }

    /// Seconds of forces, placing, spreading, reading and interpolation; whether the fluid takes a step before it is read.
    fn once(&mut self, in_turn: bool) -> Result<[f64; 5], Fault> {
        let mut seconds = [0.0; 5];
        let mut clock = Instant::now();
        let mut stop = |part: usize, clock: &mut Instant| {
            let now = Instant::now();
            seconds[part] = (now - *clock).as_secs_f64();
            *clock = now;
        };
        let per_cell = self.x.len() / self.cells.len().max(1);
        let Soa3 { x, y, z } = &mut self.force;
        let forces = x
            .par_chunks_mut(per_cell.max(1))
            .zip(y.par_chunks_mut(per_cell.max(1)))
            .zip(z.par_chunks_mut(per_cell.max(1)));
        let (positions, velocities) = (&self.x, &self.v);
        self.cells
            .par_iter_mut()
            .zip(forces)
            .enumerate()
            .for_each(|(i, (cell, ((x, y), z)))| {
                let range = i * per_cell..(i + 1) * per_cell;
                for f in [&mut *x, &mut *y, &mut *z] {
                    f.fill(0.0);
                }
                cell.add_internal_forces(
                    positions.slice(range.clone()),
                    velocities.slice(range),
                    &mut Soa3Mut { x, y, z },
                );
            });
        stop(0, &mut clock);
        self.exchange.place(self.x.view(), &mut self.bricks)?;
        stop(1, &mut clock);
        self.bricks.clear_force();
        self.exchange.spread(self.force.view(), &mut self.bricks);
        stop(2, &mut clock);
        if in_turn {
            self.lattice.advance(&self.bricks)?;
            clock = Instant::now();
        }
        self.lattice.read_velocity(&mut self.bricks);
        stop(3, &mut clock);
        self.exchange.interpolate(&self.bricks, self.v.view_mut());
        stop(4, &mut clock);
        Ok(seconds)
    }
}
