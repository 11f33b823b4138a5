//! Beads between two magnetic charge sheets form chains; a flow tilts and breaks them; a bias field sets their gap.
//!
//! `cargo run --release --example bead_chaining -- --help`

mod gaps;
mod options;
mod pinned;
mod report;
mod scatter;

use options::Options;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let clock = Instant::now();
    let options = Options::read();
    std::fs::create_dir_all(&options.out)?;
    let (mut rows, mut formed) = (Vec::new(), Vec::new());
    for flowing in [false, true] {
        let (more, end) = scatter::run(&options, flowing)?;
        scatter::print(&end, &more, &options.out);
        rows.extend(more);
        formed.push(end);
    }
    let leaning = pinned::run(&options)?;
    pinned::print(&leaning, &options);
    let gaps = gaps::run(&options)?;
    gaps::print(&gaps);
    report::write(&options.out, &rows, &formed, &leaning, &gaps)?;
    println!(
        "\n{:.1} s; tables, charts and VTK files in {}",
        clock.elapsed().as_secs_f64(),
        options.out.display()
    );
    Ok(())
}
