//! Cells in, bias field out: the bias sets the gap between chains of beads, the gap decides which cells pass, and switching the
//! magnets off sets free what was held.
//!
//! `cargo run --release --example tune_filter -- --help`

#[path = "../bead_trap/chains.rs"]
mod chains;
#[path = "../bead_trap/device.rs"]
mod device;
#[path = "../bead_trap/flow.rs"]
mod flow;
mod options;
mod report;
mod study;
#[path = "../bead_trap/subject.rs"]
mod subject;

use clap::Parser;
use lbm_ibm::coupling::{MS, UM};
use options::Options;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let clock = Instant::now();
    let options = Options::parse().short_if_smoke();
    std::fs::create_dir_all(&options.out)?;
    let points = study::run_all(&options)?;
    let window = study::window(&points);
    report::print(&points, window.as_ref());
    let chosen = window.as_ref().and_then(|w| points.iter().find(|p| p.bias == w.bias));
    let released = chosen.map(|point| study::release(&options, point)).transpose()?;
    if let Some(released) = &released {
        println!(
            "magnets off at {:.1} mT of bias: {:.0} ms later the tumour cell is at {:.1} um, beads have gone up to {:.1} um",
            released.bias * 1e3,
            released.time / MS,
            released.cell / UM,
            released.beads / UM
        );
    }
    report::write(&options.out, &points, window.as_ref(), released.as_ref())?;
    println!(
        "\n{:.1} s; tables and charts in {}",
        clock.elapsed().as_secs_f64(),
        options.out.display()
    );
    Ok(())
}
