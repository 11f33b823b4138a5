//! Speed of the bare fluid, of whole scenes, and of magnetic sums and fields.

use clap::{Args, Parser, Subcommand};
use lbm_ibm::ibm::Kernel;
use lbm_ibm_benches::Fault;
use lbm_ibm_benches::scenes::{Crowd, Sphere, on_threads};
use lbm_ibm_benches::speed::beads::{Speed as Beads, beads};
use lbm_ibm_benches::speed::cells::{Speed as Cells, cells};
use lbm_ibm_benches::speed::dipoles::{Rung, Sums, rungs};
use lbm_ibm_benches::speed::far_field::{Row, far_field};
use lbm_ibm_benches::speed::{field, fluid};
use serde::Serialize;
use std::path::{Path, PathBuf};

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
    /// Elastic spheres of 642 nodes in a periodic cube: whole steps, and the parts of a step.
    Cells {
        /// Spheres.
        #[arg(long, default_value_t = 50)]
        count: usize,
        /// Nodes along each edge of the cube.
        #[arg(long, default_value_t = 64)]
        size: usize,
        /// Points of the kernel: the trilinear one, Roma's, Peskin's.
        #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=4))]
        points: u8,
        /// Membrane of the spheres.
        #[arg(long, value_enum, default_value_t)]
        law: Sphere,
        /// Walls close the cube.
        #[arg(long)]
        closed: bool,
        /// The spheres repel each other.
        #[arg(long)]
        contact: bool,
        #[command(flatten)]
        timing: Timing,
    },
    /// Rigid beads of 4 spacings' radius in a periodic cube: whole steps beside the bare fluid, and what is called in them.
    Beads {
        /// Beads.
        #[arg(long, default_value_t = 8)]
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

fn main() -> Result<(), Fault> {
    match Options::parse().what {
        What::Fluid { case, timing } => {
            let rows = on_threads(timing.threads, || fluid::speeds(&case, timing.threads, timing.seconds))?;
            show(&rows, timing.json.as_deref(), |r: &fluid::Speed| {
                let rates = format!("{:7.1} MLUPS, best {:7.1}", r.mlups, r.best_mlups);
                let bytes = format!("{:.1} GB/s, {:.1} B a node", r.gigabytes_per_second, r.bytes_per_node);
                let ratio = r.of_periodic.map_or(String::new(), |[rate, bytes]| {
                    format!("; of a periodic cube {rate:.2} of the rate, {bytes:.2} of the memory")
                });
                format!(
                    "{:22} {:?} {:?} {:?} {:4}^3 {} threads {rates}, {bytes}{ratio}",
                    r.case, r.scene, r.precision, r.collision, r.size, r.threads
                )
            })
        }
        What::Cells {
            count,
            size,
            points,
            law,
            closed,
            contact,
            timing,
        } => {
            let crowd = Crowd {
                size,
                count,
                kernel: [Kernel::TwoPoint, Kernel::RomaThree, Kernel::PeskinFour][usize::from(points) - 2],
                law,
                closed,
                contact,
            };
            let speed = on_threads(timing.threads, || cells(&crowd, timing.threads, timing.seconds))?;
            show(&[speed], timing.json.as_deref(), |s: &Cells| {
                format!(
                    "{} spheres, {} nodes, {}, {} threads: {:.3} ms a step, best {:.3} (bare fluid {:.3}, {:.3}), in the step {:.3} us a node; {:.3} rows a node; in turn {}; by themselves {}",
                    s.count,
                    s.nodes,
                    s.kernel,
                    s.threads,
                    s.ms_per_step,
                    s.best_ms_per_step,
                    s.fluid_ms_per_step,
                    s.best_fluid_ms_per_step,
                    s.best_us_per_node_in_step,
                    s.rows_per_node,
                    s.in_turn,
                    s.parts
                )
            })
        }
        What::Beads { count, size, timing } => {
            let speed = on_threads(timing.threads, || beads(size, count, timing.threads, timing.seconds))?;
            show(&[speed], timing.json.as_deref(), |s: &Beads| {
                format!(
                    "{} beads, {} markers, {}^3, {} threads: {:.3} ms a step, best {:.3} (bare fluid {:.3}, {:.3}); holding beads {:.3}, exchange for elastic bodies {:.4}; calls a step: bodies' forces, constraints and memories {}, elastic spreading and interpolation {}",
                    s.count,
                    s.markers,
                    s.size,
                    s.threads,
                    s.ms_per_step,
                    s.best_ms_per_step,
                    s.fluid_ms_per_step,
                    s.best_fluid_ms_per_step,
                    s.holding_ms,
                    s.elastic_exchange_ms,
                    s.body_calls,
                    s.elastic_calls
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

/// Prints a line per result, or writes all as JSON.
fn show<T: Serialize>(results: &[T], json: Option<&Path>, line: impl Fn(&T) -> String) -> Result<(), Fault> {
    match json {
        Some(path) if path == Path::new("-") => println!("{}", serde_json::to_string_pretty(results)?),
        Some(path) => std::fs::write(path, serde_json::to_string_pretty(results)?)?,
        None => results.iter().for_each(|r| println!("{}", line(r))),
    }
    Ok(())
}
