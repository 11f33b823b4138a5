//! Which gap lets a red blood cell through and holds a tumour cell.
//!
//! `cargo run --release --example gap_study -- --help`

mod device;
mod empty;
mod options;
mod passage;
mod report;
mod squeeze;
mod study;

use clap::Parser;
use device::Device;
use lbm_ibm::coupling::{Scales, UM};
use lbm_ibm::output::Progress;
use options::{Options, Subject};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let clock = Instant::now();
    let options = Options::parse();
    let devices = devices(&options);
    std::fs::create_dir_all(&options.out)?;
    for device in devices.iter().take(1) {
        let scales = Scales {
            velocity: device.gap_velocity(),
            length: device.gap,
            gap: device.gap,
            shear_modulus: 5.2e-6,
        };
        println!("first of {} runs:\n{}\n", devices.len(), device.units().report(scales));
    }
    println!("{}", study::HEAD);
    let progress = Progress::new(devices.len() as u64);
    let done = study::run_all(&devices, &options, &progress).map_err(|e| -> Box<dyn Error> { e })?;
    progress.finish();
    let total = clock.elapsed().as_secs_f64();
    report::write(&options.out, &done, total)?;
    println!(
        "\n{} runs in {total:.1} s; tables, charts and VTK files in {}",
        done.len(),
        options.out.display()
    );
    Ok(())
}

/// A device per cell and gap; the smoke test has one per cell, on a coarse grid.
fn devices(options: &Options) -> Vec<Device> {
    let mut devices = Vec::new();
    for &subject in &options.cells {
        let (gaps, coarse): (Vec<f64>, f64) = match subject {
            _ if options.smoke && subject == Subject::Ctc => (vec![16.0], 2.0),
            Subject::Ctc => ((8..=15).map(f64::from).collect(), 2.0),
            _ if options.smoke => (vec![6.0], 1.0),
            _ => ((2..=6).map(f64::from).collect(), 1.0),
        };
        let gaps = if options.gaps.is_empty() {
            gaps
        } else {
            options.gaps.clone()
        };
        let mut options = options.clone();
        if options.smoke {
            options.resolution.get_or_insert(coarse);
        }
        devices.extend(gaps.iter().map(|gap| Device::new(subject, gap * UM, &options)));
    }
    devices
}
