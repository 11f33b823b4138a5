//! Linear stability of the collisions.

use clap::Parser;
use lbm_ibm_benches::Fault;
use lbm_ibm_benches::scenes::side_by_side;
use lbm_ibm_benches::stability::cases::{CASES, TAUS};
use std::process::ExitCode;

/// Greatest stable velocity of each collision (lattice units), flow along an axis, a face diagonal and a space diagonal, by the
/// eigenvalues of all waves of a set and of the neighbourhood of the worst. Prints CSV.
#[derive(Parser)]
struct Options {
    /// Collisions; all by default.
    names: Vec<String>,
    /// Relaxation times; those of the reference file by default.
    #[arg(long, value_delimiter = ',')]
    tau: Vec<f64>,
    /// With the compressible equilibrium of the reference file instead of the collision's own: BGK, TRT, REG and MRT only.
    #[arg(long)]
    compressible: bool,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("stability: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Fault> {
    for name in &options.names {
        if !CASES.iter().any(|c| c.name == name) {
            let known: Vec<_> = CASES.iter().map(|c| c.name).collect();
            return Err(format!("there is no collision `{name}`; there are {}", known.join(", ")).into());
        }
    }
    let taus = if options.tau.is_empty() {
        TAUS.to_vec()
    } else {
        options.tau.clone()
    };
    let wanted = |name: &str| options.names.is_empty() || options.names.iter().any(|n| n == name);
    let work: Vec<_> = CASES
        .iter()
        .filter(|c| wanted(c.name))
        .flat_map(|case| taus.iter().map(move |tau| (case, *tau)))
        .collect();
    println!("collision,tau,umax_100,umax_110,umax_111,umax_min");
    for chunk in work.chunks(taus.len().max(1)) {
        let rows = side_by_side(chunk, |(case, tau)| {
            Ok([0, 1, 2].map(|flow| {
                if options.compressible {
                    case.compressible_limit(*tau, flow).speed
                } else {
                    case.limit(*tau, flow).speed
                }
            }))
        })?;
        for ((case, tau), ([a, b, c], _)) in chunk.iter().zip(rows) {
            println!("{},{tau},{a:.5},{b:.5},{c:.5},{:.5}", case.name, a.min(b).min(c));
        }
    }
    Ok(())
}
