//! Work-precision charts.

use clap::Parser;
use lbm_ibm_benches::Fault;
use lbm_ibm_benches::chart::{CHARTS, Chart};
use lbm_ibm_benches::scenes::one_thread;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// Work-precision charts: the error of a choice against what it costs on one thread, as SVG and CSV.
#[derive(Parser)]
struct Options {
    /// Charts to make; all by default.
    names: Vec<String>,
    /// Folder to write to.
    #[arg(long, value_name = "DIR", default_value = "out/charts")]
    out: PathBuf,
    /// Few points and short timings: seconds in all.
    #[arg(long)]
    quick: bool,
    /// List the charts and end.
    #[arg(long)]
    list: bool,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("chart: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Fault> {
    if options.list {
        CHARTS
            .iter()
            .for_each(|c| println!("{:10} {}. {}", c.name, c.title, c.advice));
        return Ok(());
    }
    let named = |name: &String| {
        Chart::named(name).ok_or_else(|| {
            let known: Vec<_> = CHARTS.iter().map(|c| c.name).collect();
            format!("there is no chart `{name}`; the charts are {}", known.join(", "))
        })
    };
    let mut charts: Vec<_> = options.names.iter().map(named).collect::<Result<_, _>>()?;
    if charts.is_empty() {
        charts.extend(CHARTS);
    }
    one_thread()?;
    for chart in charts {
        let begin = Instant::now();
        let (rows, best) = chart.write(&options.out, options.quick)?;
        let seconds = begin.elapsed().as_secs_f64();
        println!("{}: {} rows in {seconds:.1} s; the front:", chart.name, rows.len());
        for (row, _) in rows.iter().zip(best).filter(|(_, b)| *b) {
            println!(
                "  {:30} {:24} {:9.2e} s {:9.2e} updates, error {:9.2e}",
                row.curve, row.label, row.cost_s, row.updates, row.error
            );
        }
    }
    Ok(())
}
