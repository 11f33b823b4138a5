//! Beads chain across a channel, are frozen, and cells flow against them; then the same with beads that the flow can move.
//!
//! `cargo run --release --example bead_trap -- --help`

mod chains;
mod device;
mod flow;
mod forming;
mod options;
mod report;
mod subject;

use flow::{Beads, Run};
use lbm_ibm::coupling::{MS, Sphere, UM, US};
use lbm_ibm::output::{BeadSeries, OutputError, VtkSeries, write_csv, write_walls};
use options::Options;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let clock = Instant::now();
    let options = Options::read();
    std::fs::create_dir_all(&options.out)?;
    let device = options.device;
    let gap = options.gap * UM;
    let bias = forming::bias_for(&device, gap)?;
    println!(
        "a bias of {:.1} mT on the sheets' {:.1} mT gives a gap of {:.2} um",
        bias * 1e3,
        device.sheets() * 1e3,
        options.gap
    );
    let formed = forming::form(&device, bias, gap, options.flow.speed * UM, 10.0 * MS, options.seed)?;
    let when = formed
        .formed
        .map_or("not in time".to_owned(), |t| format!("after {:.0} us", t / US));
    println!(
        "1. loose columns of beads in the flow are {} chains {when}; least gap {:.2} um",
        formed.row.chains,
        formed.row.gap / UM
    );
    if !options.no_vtk {
        film(&options, &formed)?;
    }
    let row = chains::at_rest(&device, bias, gap)?;
    println!("2. at rest the gap is {:.3} um; frozen there", row.gap / UM);
    let series = |name: &str| -> Result<Option<VtkSeries>, OutputError> {
        let folder = options.out.join(name);
        (!options.no_vtk).then(|| VtkSeries::new(&folder)).transpose()
    };
    let started = Instant::now();
    let mut frozen = Run::new(&device, &options.flow, &row, Beads::Frozen, bias)?;
    frozen.until_settled(options.time * MS, series("frozen")?.as_mut())?;
    if !options.no_vtk {
        write_walls(&options.out.join("frozen/walls.vti"), frozen.scene())?;
    }
    println!("3. frozen beads, {:.0} s:", started.elapsed().as_secs_f64());
    report::print(&frozen, 0);
    write_csv(&options.out.join("loads.csv"), frozen.bead_loads())?;
    let mut ends = frozen.ends();
    let mut moments = std::mem::take(&mut frozen.moments);

    let started = Instant::now();
    let mut coupled = Run::new(&device, &options.flow, &row, Beads::Coupled, bias)?;
    coupled.place_cells(&frozen.cell_positions()?)?;
    let mut film = series("coupled")?;
    coupled.until_settled(options.coupled * MS, film.as_mut())?;
    println!(
        "4. beads that flow and field move, {:.0} s:",
        started.elapsed().as_secs_f64()
    );
    report::print(&coupled, 0);
    ends.extend(coupled.ends());
    let seen = coupled.moments.len();

    let started = Instant::now();
    coupled.switch_off();
    coupled.until_settled(options.release * MS, film.as_mut())?;
    println!("5. magnets off, {:.0} s:", started.elapsed().as_secs_f64());
    report::print(&coupled, seen);
    ends.extend(coupled.ends());
    moments.extend(coupled.moments);
    report::write(&options.out, bias, &row, &ends, &moments)?;
    println!(
        "\n{:.1} s; tables, charts and VTK files in {}",
        clock.elapsed().as_secs_f64(),
        options.out.display()
    );
    Ok(())
}

fn film(options: &Options, formed: &forming::Forming) -> Result<(), Box<dyn Error>> {
    let mut series = BeadSeries::new(&options.out.join("forming"))?;
    for (time, centres) in &formed.film {
        let spheres: Vec<Sphere> = centres.iter().map(|c| Sphere::new(c, device::RADIUS)).collect();
        series.write(*time, &spheres, &[])?;
    }
    Ok(())
}
