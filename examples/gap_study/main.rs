//! Which gap lets a red blood cell through and holds a tumour cell, and how leucocytes fare.
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

/// A device per cell and gap. The smoke test has a red cell and a tumour cell before one wide gap each, on coarse grids.
fn devices(options: &Options) -> Vec<Device> {
    if options.smoke {
        let coarse = |resolution: f64| Options {
            resolution: Some(options.resolution.unwrap_or(resolution)),
            reynolds_scale: 12.0,
            start: 0.75,
            ..options.clone()
        };
        return vec![
            Device::new(Subject::RbcEdge, 6.0 * UM, &coarse(1.0)),
            Device::new(Subject::Ctc, 16.0 * UM, &coarse(2.0)),
        ];
    }
    let gaps = |subject: Subject| match subject {
        _ if !options.gaps.is_empty() => options.gaps.clone(),
        Subject::Ctc => (8..=15).map(f64::from).collect(),
        Subject::RbcEdge | Subject::RbcFace => (2..=6).map(f64::from).collect(),
        Subject::Neutrophil | Subject::Lymphocyte => vec![3.0],
    };
    let devices = options.cells.iter().flat_map(|&subject| {
        let gaps: Vec<f64> = gaps(subject);
        gaps.into_iter().map(move |gap| Device::new(subject, gap * UM, options))
    });
    devices.collect()
}
