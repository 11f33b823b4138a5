//! Speed of the bare fluid, of whole scenes, and of magnetic sums and fields.

use clap::{Args, Parser, Subcommand};
use lbm_ibm::coupling::{Bricks, Grid, Lattice, UM, Vec3};
use lbm_ibm::lbm::{Drive, Fluid};
use lbm_ibm_benches::Fault;
use lbm_ibm_benches::scenes::{crowd, on_threads, plasma};
use lbm_ibm_benches::speed::dipoles::{Rung, Sums, rungs};
use lbm_ibm_benches::speed::far_field::{Row, far_field};
use lbm_ibm_benches::speed::{field, fluid};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Speed of the bare fluid, of whole scenes, and of magnetic sums and fields.
#[derive(Parser)]
struct Options {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    /// The fluid alone in a cube, with and without a uniform force, step by step and in sweeps of several steps.
    Fluid {
        #[command(flatten)]
        case: fluid::Case,
        #[command(flatten)]
        timing: Timing,
    },
    /// Whole steps of a scene: elastic spheres of 642 nodes in a periodic cube.
    Cells {
        /// Spheres.
        #[arg(long, default_value_t = 50)]
        count: usize,
        /// Nodes along each edge of the cube.
        #[arg(long, default_value_t = 64)]
        size: usize,
        #[command(flatten)]
        timing: Timing,
    },
    /// Every rung of the magnetic ladder: chains of ten beads with gaps of 0.05 radii, mu_r 2. A warm start is the solution
    /// after every bead has moved by up to 1e-3 radii.
    Dipoles {
        /// Beads.
        #[arg(long, default_value_t = 10_000)]
        count: usize,
        /// Sum by a tree of this accuracy.
        #[arg(long, conflicts_with = "direct")]
        tree: Option<f64>,
        /// Sum directly, whatever the number.
        #[arg(long)]
        direct: bool,
        /// The bare sums alone, no model.
        #[arg(long)]
        bare: bool,
        #[command(flatten)]
        timing: Timing,
    },
    /// The field of each source, with and without gradient, at points scattered about it.
    Field {
        /// Points.
        #[arg(long, default_value_t = 1_000_000)]
        points: usize,
        #[command(flatten)]
        timing: Timing,
    },
    /// Forces and torques of a cloud, directly and by trees of several accuracies.
    FarField {
        /// Numbers of beads.
        #[arg(long, value_delimiter = ',', default_value = "1000,3000,10000,30000,100000")]
        counts: Vec<usize>,
        #[command(flatten)]
        timing: Timing,
    },
}

#[derive(Args)]
struct Timing {
    /// Threads.
    #[arg(long, default_value_t = 1)]
    threads: usize,
    /// Least seconds to measure for.
    #[arg(long, default_value_t = 2.0)]
    seconds: f64,
    /// Write the results as JSON to a file, or to the output (-) instead of a table.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct SceneSpeed {
    size: usize,
    count: usize,
    threads: usize,
    nodes: usize,
    ms_per_step: f64,
    fluid_ms_per_step: f64,
    /// Microseconds per node and step, the bare fluid's time taken off.
    us_per_node: f64,
}

fn main() -> Result<(), Fault> {
    match Options::parse().what {
        What::Fluid { case, timing } => {
            let rows = on_threads(timing.threads, || fluid::speeds(&case, timing.threads, timing.seconds))?;
            show(&rows, timing.json.as_deref(), |r: &fluid::Speed| {
                let rates = format!("{:7.1} MLUPS, best {:7.1}", r.mlups, r.best_mlups);
                let bytes = format!("{:.1} GB/s, {:.1} B a node", r.gigabytes_per_second, r.bytes_per_node);
                format!(
                    "{:22} {:?} {:?} {:?} {:4}^3 {} threads {rates}, {bytes}",
                    r.case, r.scene, r.precision, r.collision, r.size, r.threads
                )
            })
        }
        What::Cells { count, size, timing } => {
            let speed = on_threads(timing.threads, || scene_speed(size, count, &timing))?;
            show(&[speed], timing.json.as_deref(), |s: &SceneSpeed| {
                let times = format!(
                    "{:.3} ms a step, {:.3} of it bare fluid",
                    s.ms_per_step, s.fluid_ms_per_step
                );
                format!(
                    "{} spheres, {} nodes, {} threads: {times}, {:.3} us a node",
                    s.count, s.nodes, s.threads, s.us_per_node
                )
            })
        }
        What::Dipoles {
            count,
            tree,
            direct,
            bare,
            timing,
        } => {
            let sums = match tree {
                Some(accuracy) => Sums::Tree(accuracy),
                None if direct => Sums::Direct,
                None => Sums::Automatic,
            };
            let rows = on_threads(timing.threads, || {
                rungs(count, timing.threads, timing.seconds, sums, bare)
            })?;
            show(&rows, timing.json.as_deref(), |r: &Rung| {
                let times = format!("{:10.3} ms, best {:10.3}", r.ms, r.best_ms);
                let pairs = format!("{:7.3} ns a pair, {} iterations", r.ns_per_pair, r.iterations);
                format!(
                    "{:32} {:4} {} beads {} threads {times}, {pairs}, tree's error {:.1e}",
                    r.rung, r.start, r.count, r.threads, r.tree_error
                )
            })
        }
        What::Field { points, timing } => {
            let rows = on_threads(timing.threads, || {
                field::sources(points, timing.threads, timing.seconds)
            })?;
            show(&rows, timing.json.as_deref(), |r: &field::Speed| {
                let what = if r.gradient { "field and gradient" } else { "field" };
                format!(
                    "{:16} {what:18} {} points {} threads {:7.1} ns a point, best {:7.1}",
                    r.source, r.points, r.threads, r.ns_per_point, r.best_ns_per_point
                )
            })
        }
        What::FarField { counts, timing } => {
            let rows = on_threads(timing.threads, || far_field(&counts, timing.seconds))?;
            show(&rows, timing.json.as_deref(), |r: &Row| {
                format!(
                    "{:12} {:8} beads {:9.4} s, rms error {:.1e}",
                    r.label, r.n, r.seconds, r.rms_error
                )
            })
        }
    }
}

/// Seconds of each call of `work`, in ascending order: five calls or more, for the time asked.
fn times(timing: &Timing, mut work: impl FnMut() -> Result<(), Fault>) -> Result<Vec<f64>, Fault> {
    work()?;
    let (begin, mut all) = (Instant::now(), Vec::new());
    while all.len() < 5 || begin.elapsed().as_secs_f64() < timing.seconds {
        let start = Instant::now();
        work()?;
        all.push(start.elapsed().as_secs_f64());
    }
    all.sort_by(f64::total_cmp);
    Ok(all)
}

/// An even and an odd step of a periodic cube, over and over.
fn fluid_times(size: usize, timing: &Timing, drive: Drive) -> Result<Vec<f64>, Fault> {
    let grid = Grid::new([size; 3], UM, [true; 3]);
    let bricks = Bricks::new(&grid);
    let mut fluid: Fluid = plasma(grid, 0.8, 1.0)?.with_drive(drive)?;
    times(timing, || {
        fluid.advance(&bricks)?;
        Ok(fluid.advance(&bricks)?)
    })
}

fn scene_speed(size: usize, count: usize, timing: &Timing) -> Result<SceneSpeed, Fault> {
    let median = |times: &[f64]| 1e3 * times[times.len() / 2];
    let fluid_ms_per_step = 0.5 * median(&fluid_times(size, timing, Drive::Force(Vec3::x()))?);
    let mut scene = crowd(size, count)?;
    let nodes = scene.positions().len();
    let ms_per_step = median(&times(timing, || Ok(scene.step()?))?);
    Ok(SceneSpeed {
        size,
        count,
        threads: timing.threads,
        nodes,
        ms_per_step,
        fluid_ms_per_step,
        us_per_node: 1e3 * (ms_per_step - fluid_ms_per_step) / nodes.max(1) as f64,
    })
}

/// Prints a line per result, or writes all as JSON.
fn show<T: Serialize>(results: &[T], json: Option<&Path>, line: impl Fn(&T) -> String) -> Result<(), Fault> {
    match json {
        Some(path) if path == Path::new("-") => println!("{}", serde_json::to_string_pretty(results)?),
        Some(path) => std::fs::write(path, serde_json::to_string_pretty(results)?)?,
        None => results.iter().for_each(|r| println!("{}", line(r))),
    }
    Ok(())
}
