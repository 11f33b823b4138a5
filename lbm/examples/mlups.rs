//! Million node updates a second of the bare fluid.
//!
//! `cargo run --release -p lbm-ibm-lbm --example mlups -- --size 64,128 --threads 1 --seconds 2`

use lbm_ibm_coupling::{Bricks, Closure, Grid, Lattice, Vec3};
use lbm_ibm_lbm::{Drive, Fluid, InstructionSet, Pace};
use std::sync::Arc;
use std::time::Instant;

fn main() -> Outcome {
    let arguments: Vec<String> = std::env::args().collect();
    let option = |name: &str, default: &str| {
        let at = arguments.iter().position(|a| a == name);
        at.and_then(|at| arguments.get(at + 1))
            .map_or(default, |v| v)
            .to_string()
    };
    let seconds: f64 = option("--seconds", "2").parse()?;
    let isa = match option("--isa", "best").as_str() {
        "portable" => InstructionSet::Portable,
        "avx2" => InstructionSet::Avx2,
        _ => InstructionSet::best(),
    };
    for size in option("--size", "64,128").split(',') {
        for threads in option("--threads", "1").split(',') {
            in_pool(threads.parse()?, || cases(size.parse()?, threads, isa, seconds))?;
        }
    }
    Ok(())
}

type Outcome = Result<(), Box<dyn std::error::Error + Send + Sync>>;

#[cfg(feature = "parallel")]
fn in_pool(threads: usize, work: impl FnOnce() -> Outcome + Send) -> Outcome {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?
        .install(work)
}

#[cfg(not(feature = "parallel"))]
fn in_pool(_threads: usize, work: impl FnOnce() -> Outcome) -> Outcome {
    work()
}

fn cases(n: usize, threads: &str, isa: InstructionSet, seconds: f64) -> Outcome {
    let grid = Grid::new([n; 3], 1e-6, [true; 3]);
    let fluid = || Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(0.8)).and_then(|f| f.with_instruction_set(isa));
    let idle = Bricks::new(&grid);
    let mut full = Bricks::new(&grid);
    (0..full.counts().iter().product()).for_each(|b| full.want(b));
    full.commit();
    let report = |name: &str, mut fluid: Fluid, bricks: &Bricks| -> Outcome {
        fluid.advance(bricks)?;
        fluid.advance(bricks)?;
        let nodes = fluid.fluid_nodes() as f64;
        let mut rates = Vec::new();
        let begin = Instant::now();
        while rates.len() < 5 || begin.elapsed().as_secs_f64() < seconds {
            let start = Instant::now();
            fluid.advance(bricks)?;
            fluid.advance(bricks)?;
            rates.push(2e-6 * nodes / start.elapsed().as_secs_f64());
        }
        rates.sort_by(f64::total_cmp);
        let (median, best) = (rates[rates.len() / 2], rates[rates.len() - 1]);
        println!("{name:26} N={n:4} threads={threads} {isa:?} MLUPS={median:7.1} best={best:7.1}");
        Ok(())
    };
    report("periodic", fluid()?, &idle)?;
    report(
        "uniform force",
        fluid()?.with_drive(Drive::Force(Vec3::new(1.0, 0.0, 0.0)))?,
        &idle,
    )?;
    report("flux control", fluid()?.with_drive(Drive::flux(0, 1e-3))?, &idle)?;
    report("force on every node", fluid()?, &full)?;
    let mut read = fluid()?;
    for phase in ["even", "odd"] {
        let start = Instant::now();
        (0..5).for_each(|_| read.read_velocity(&mut full));
        let rate = 5e-6 * grid.len() as f64 / start.elapsed().as_secs_f64();
        println!("read velocity, {phase:4} step   N={n:4} threads={threads} {isa:?} M/s  ={rate:7.1}");
        read.advance(&idle)?;
    }
    let half = 0.5 * n as f64 * grid.spacing;
    let tube = move |x: Vec3| half - (x.y - half).hypot(x.z - half);
    let mut walled = fluid()?.with_drive(Drive::Force(Vec3::new(1.0, 0.0, 0.0)))?;
    walled.set_walls(Some(Arc::new(Closure::new(tube, 1e-9))), 0.0)?;
    report("tube along x, fluid nodes", walled, &idle)?;
    let rod = move |x: Vec3| (x.x - half).hypot(x.y - half) - 0.5 * half;
    let mut walled = fluid()?.with_drive(Drive::flux(0, 1e-3))?;
    walled.set_walls(Some(Arc::new(Closure::new(rod, 1e-9))), 0.0)?;
    report("rod across x, flux control", walled, &idle)
}
