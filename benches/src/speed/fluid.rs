//! The fluid alone, step by step and in sweeps of several steps.

use crate::Fault;
use crate::scenes::plasma;
use clap::{Args, ValueEnum};
use lbm_ibm::coupling::{Bricks, Closure, Grid, Lattice, UM, Vec3};
use lbm_ibm::lbm::{Collision, Drive, Fluid, InstructionSet, Precision, VelocitySet, WallRule};
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// Steps that are timed at once: an even number, since even and odd steps differ.
const STEPS: usize = 8;
/// Nodes along the period of the porous scene, and the radius of its spheres, which overlap.
const PERIOD: f64 = 32.0;
const RADIUS: f64 = 0.56 * PERIOD;
/// Nodes across the tube.
const TUBE: f64 = 20.0;
/// Nodes along the edges of the box about the tube beyond those across it.
const BESIDE: usize = 4;

/// What to run.
#[derive(Args, Clone, Copy, Debug)]
pub struct Case {
    /// Nodes along each edge of the cube.
    #[arg(long, default_value_t = 128)]
    pub size: usize,
    /// How populations are stored.
    #[arg(long, value_enum, default_value_t)]
    pub precision: Bits,
    /// How populations relax.
    #[arg(long, value_enum, default_value_t)]
    pub collision: Relaxation,
    /// The lattice velocities.
    #[arg(long, value_enum, default_value_t)]
    pub velocities: Velocities,
    /// What walls there are.
    #[arg(long, value_enum, default_value_t)]
    pub scene: Scene,
    /// Where walls are taken to be.
    #[arg(long, value_enum, default_value_t)]
    pub walls: Walls,
}

/// How populations are stored.
#[derive(Clone, Copy, Debug, Default, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Bits {
    /// 64 bits.
    #[default]
    F64,
    /// 32 bits.
    F32,
    /// 16 bits, arithmetic in 32.
    F16,
}

/// How populations relax.
#[derive(Clone, Copy, Debug, Default, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Relaxation {
    /// Two relaxation times.
    #[default]
    Trt,
    /// One.
    Bgk,
    /// Many.
    Mrt,
    /// All but the stress forgotten.
    Regularised,
    /// The same, higher moments rebuilt.
    Recursive,
    /// Central moments.
    Central,
}

/// The lattice velocities.
#[derive(Clone, Copy, Debug, Default, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Velocities {
    /// Nineteen.
    #[default]
    D3q19,
    /// Twenty-seven.
    D3q27,
}

/// What walls there are.
#[derive(Clone, Copy, Debug, Default, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Scene {
    /// None.
    #[default]
    Periodic,
    /// Two plates, at the faces of the second axis.
    Slit,
    /// The pores between spheres that overlap, three tenths of the box.
    Porous,
    /// A tube of 20 nodes along x, in a box that just holds it.
    Tube,
    /// The same along z.
    Upright,
}

/// Where walls are taken to be.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum Walls {
    /// Where they are.
    #[default]
    Cli,
    /// Half way between nodes.
    Halfway,
}

/// How fast a case is.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Without or with a uniform force, step by step or in sweeps.
    pub case: String,
    /// What walls there are.
    pub scene: Scene,
    /// Where they are taken to be.
    pub walls: Walls,
    /// Nodes along each edge.
    pub size: usize,
    /// Nodes in the fluid.
    pub fluid_nodes: usize,
    /// How populations are stored.
    pub precision: Bits,
    /// How populations relax.
    pub collision: Relaxation,
    /// The lattice velocities.
    pub velocities: Velocities,
    /// Threads.
    pub threads: usize,
    /// What the kernels are compiled for.
    pub instruction_set: String,
    /// Million fluid nodes a second, the median.
    pub mlups: f64,
    /// The same, the best.
    pub best_mlups: f64,
    /// Populations read and written per second at the median, if none is kept in a cache, GB/s.
    pub gigabytes_per_second: f64,
    /// Memory of the fluid per fluid node.
    pub bytes_per_node: f64,
    /// The best rate, and the memory, over those of a periodic cube of as many nodes a side, run in turns with the scene; none for
    /// that cube itself.
    pub of_periodic: Option<[f64; 2]>,
}

impl Case {
    fn fluid(&self, drive: Drive) -> Result<Fluid, Fault> {
        let open = !matches!(self.scene, Scene::Slit);
        let mut shape = [self.size; 3];
        let axis = match self.scene {
            Scene::Tube => Some(0),
            Scene::Upright => Some(2),
            _ => None,
        };
        if let Some(axis) = axis {
            shape = [TUBE as usize + BESIDE; 3];
            shape[axis] = self.size;
        }
        let grid = Grid::new(shape, UM, [true, open, true]);
        let precision = match self.precision {
            Bits::F64 => Precision::F64,
            Bits::F32 => Precision::F32,
            Bits::F16 => Precision::F16,
        };
        let collision = match self.collision {
            Relaxation::Trt => Collision::default(),
            Relaxation::Bgk => Collision::Bgk,
            Relaxation::Mrt => Collision::mrt(),
            Relaxation::Regularised => Collision::Regularised,
            Relaxation::Recursive => Collision::RecursiveRegularised,
            Relaxation::Central => Collision::central_moments(),
        };
        let set = match self.velocities {
            Velocities::D3q19 => VelocitySet::D3Q19,
            Velocities::D3q27 => VelocitySet::D3Q27,
        };
        let mut fluid = plasma(grid, 0.8, 1.0)?
            .with_collision(collision)?
            .with_velocity_set(set)?
            .with_precision(precision)
            .with_wall_rule(match self.walls {
                Walls::Cli => WallRule::Cli,
                Walls::Halfway => WallRule::Halfway,
            })
            .with_narrow_gaps_filled()
            .with_drive(drive)?;
        if matches!(self.scene, Scene::Porous) {
            let distance = |x: Vec3| {
                let from_centre = (x / UM).map(|v| v - PERIOD * (v / PERIOD).round());
                (from_centre.norm() - RADIUS) * UM
            };
            fluid.set_walls(Some(Arc::new(Closure::new(distance, 1e-3 * UM))), 0.0)?;
        }
        if let Some(axis) = axis {
            let middle = 0.5 * (TUBE + BESIDE as f64) * UM;
            let distance = move |x: Vec3| {
                let mut from = x.map(|v| v - middle);
                from[axis] = 0.0;
                0.5 * TUBE * UM - from.norm()
            };
            fluid.set_walls(Some(Arc::new(Closure::new(distance, 1e-3 * UM))), 0.0)?;
        }
        Ok(fluid)
    }

    fn speed(&self, drive: Drive, sweeps: bool, threads: usize, seconds: f64) -> Result<Speed, Fault> {
        let mut runs = vec![Run::new(self.fluid(drive)?, sweeps)?];
        if !matches!(self.scene, Scene::Periodic) {
            let scene = Scene::Periodic;
            runs.push(Run::new(Self { scene, ..*self }.fluid(drive)?, sweeps)?);
        }
        let begin = Instant::now();
        while runs[0].times.len() < 3 || begin.elapsed().as_secs_f64() < seconds {
            runs.iter_mut().try_for_each(Run::go)?;
        }
        for run in &mut runs {
            run.times.sort_by(f64::total_cmp);
        }
        let of_periodic = runs.get(1).map(|other| {
            let rate = |run: &Run| run.fluid.fluid_nodes() as f64 / run.times[0];
            [
                rate(&runs[0]) / rate(other),
                runs[0].bytes_per_node() / other.bytes_per_node(),
            ]
        });
        let Run { fluid, times, .. } = &runs[0];
        let nodes = fluid.fluid_nodes();
        let rate = |seconds: f64| 1e-6 * (STEPS * nodes) as f64 / seconds;
        let mlups = rate(times[times.len() / 2]);
        let force = if matches!(drive, Drive::Force(f) if f == Vec3::zeros()) {
            "no force"
        } else {
            "uniform force"
        };
        Ok(Speed {
            case: format!("{force}, {}", if sweeps { "sweeps" } else { "steps" }),
            scene: self.scene,
            walls: self.walls,
            size: self.size,
            fluid_nodes: nodes,
            precision: self.precision,
            collision: self.collision,
            velocities: self.velocities,
            threads,
            instruction_set: format!("{:?}", InstructionSet::best()),
            mlups,
            best_mlups: rate(times[0]),
            gigabytes_per_second: 1e-3 * mlups * self.traffic(),
            bytes_per_node: runs[0].bytes_per_node(),
            of_periodic,
        })
    }

    /// Bytes that a node update moves at least: its populations, read and written.
    pub fn traffic(&self) -> f64 {
        let bytes = match self.precision {
            Bits::F64 => 8.0,
            Bits::F32 => 4.0,
            Bits::F16 => 2.0,
        };
        let populations = match self.velocities {
            Velocities::D3q19 => 19.0,
            Velocities::D3q27 => 27.0,
        };
        2.0 * populations * bytes
    }
}

/// A fluid that is timed.
struct Run {
    fluid: Fluid,
    bricks: Bricks,
    sweeps: bool,
    /// Of [`STEPS`] steps each, s.
    times: Vec<f64>,
}

impl Run {
    fn new(fluid: Fluid, sweeps: bool) -> Result<Self, Fault> {
        let bricks = Bricks::new(fluid.grid());
        let times = Vec::new();
        let mut run = Self {
            fluid,
            bricks,
            sweeps,
            times,
        };
        run.go()?;
        run.times.clear();
        Ok(run)
    }

    fn go(&mut self) -> Result<(), Fault> {
        let start = Instant::now();
        if self.sweeps {
            self.fluid.advance_many(&self.bricks, STEPS)?;
        } else {
            (0..STEPS).try_for_each(|_| self.fluid.advance(&self.bricks))?;
        }
        self.times.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    fn bytes_per_node(&self) -> f64 {
        self.fluid.memory() as f64 / self.fluid.fluid_nodes() as f64
    }
}

/// Without and with a uniform force, each step by step and in sweeps.
///
/// # Errors
/// Those of the fluid.
pub fn speeds(case: &Case, threads: usize, seconds: f64) -> Result<Vec<Speed>, Fault> {
    let mut all = Vec::new();
    for drive in [Drive::default(), Drive::Force(Vec3::x())] {
        for sweeps in [false, true] {
            all.push(case.speed(drive, sweeps, threads, seconds)?);
        }
    }
    Ok(all)
}
