//! Calibrates the paper's cells: how far they stretch when both ends are pulled, and how fast they recover in plasma.
//!
//! `cargo run --release --example stretch -- --help`

mod charts;
mod curve;
mod measured;
mod options;
mod release;
mod tables;
mod workers;

use clap::Parser;
use curve::Row;
use lbm_ibm::output::{Progress, write_csv, write_json};
use options::Options;
use release::{Done, Recovery};
use serde::Serialize;
use std::error::Error;
use std::time::Instant;
use workers::share_out;

#[derive(Serialize)]
struct Summary<'a> {
    rbc: &'a [Row],
    ctc: &'a [Row],
    relaxation: Vec<&'a Recovery>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let clock = Instant::now();
    let options = Options::parse();
    std::fs::create_dir_all(&options.out)?;
    let (rbc, ctc) = stretch(&options)?;
    let done = relax(&options)?;
    write(&options, &rbc, &ctc, &done)?;
    println!(
        "\n{:.1} s; tables, charts and VTK files in {}",
        clock.elapsed().as_secs_f64(),
        options.out.display()
    );
    Ok(())
}

/// The static curves: those of the red cell and those of the tumour cell.
fn stretch(options: &Options) -> Result<(Vec<Row>, Vec<Row>), Box<dyn Error>> {
    let pulls = curve::pulls(options);
    let progress = Progress::new(pulls.len() as u64);
    progress.say("pulling");
    let curves = share_out(&pulls, |pull| {
        let curve = pull.curve();
        progress.advance();
        curve
    })?;
    progress.finish();
    let rows: Vec<Vec<Row>> = curves.into_iter().collect::<Result<_, _>>()?;
    let (rbc, ctc): (Vec<Row>, Vec<Row>) = rows.into_iter().flatten().partition(|r| r.cell == "rbc");
    tables::print_rbc(&rbc);
    tables::print_ctc(&ctc);
    Ok((rbc, ctc))
}

/// The recoveries; one that cannot start is reported and left out.
fn relax(options: &Options) -> Result<Vec<Done>, Box<dyn Error>> {
    let releases = release::releases(options);
    let progress = Progress::new(releases.len() as u64);
    progress.say("releasing");
    let results = share_out(&releases, |release| {
        let done = release.run(&options.out);
        progress.advance();
        done
    })?;
    progress.finish();
    let mut done = Vec::new();
    for (release, result) in releases.iter().zip(results) {
        match result {
            Ok(one) => done.push(one),
            Err(error) => println!("{}: {error}", release.name()),
        }
    }
    tables::print_recoveries(&done, options);
    Ok(done)
}

/// Tables, charts and the summary.
fn write(options: &Options, rbc: &[Row], ctc: &[Row], done: &[Done]) -> Result<(), Box<dyn Error>> {
    let out = &options.out;
    if !rbc.is_empty() {
        write_csv(&out.join("rbc.csv"), rbc)?;
        charts::rbc(rbc).write_svg(&out.join("rbc.svg"))?;
    }
    if !ctc.is_empty() {
        write_csv(&out.join("ctc.csv"), ctc)?;
        charts::ctc(ctc).write_svg(&out.join("ctc.svg"))?;
    }
    write_csv(&out.join("relaxation.csv"), done.iter().flat_map(|d| &d.moments))?;
    charts::recoveries(done).write_svg(&out.join("relaxation.svg"))?;
    for subject in options.cell.subjects() {
        let chart = charts::diameters(subject.name(), done);
        chart.write_svg(&out.join(format!("relaxation_{}.svg", subject.name())))?;
    }
    let relaxation = done.iter().map(|d| &d.recovery).collect();
    write_json(&out.join("summary.json"), &Summary { rbc, ctc, relaxation })?;
    Ok(())
}
