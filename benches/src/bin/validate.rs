//! Holds the library against analytic solutions and published data.

use clap::{Parser, ValueEnum};
use lbm_ibm::lbm::Precision;
use lbm_ibm_benches::Fault;
use lbm_ibm_benches::reference::Table;
use lbm_ibm_benches::validate::{CASES, Case, Effort, Finding, Findings, STORED, comparison};
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;
use std::process::ExitCode;

/// What populations are stored as.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Bits {
    /// 64 bits.
    F64,
    /// 32 bits: gates tighter than 1e-5 are 1e-5.
    F32,
    /// 16 bits: nothing gates.
    F16,
}

/// Holds the library against analytic solutions and published data. A case has the name of a reference file,
/// or of what a scene has to keep.
#[derive(Parser)]
struct Options {
    /// Cases to run; all by default.
    cases: Vec<String>,
    /// Leave out slow rows; ends in three minutes.
    #[arg(long)]
    quick: bool,
    /// Folder of reference files in the same columns, instead of the package's own.
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,
    /// Only rows of the reference files that have this in a column; once for each column.
    #[arg(long, value_name = "COLUMN=VALUE", value_parser = column_and_value)]
    only: Vec<(String, String)>,
    /// Write all findings as JSON, after each case those so far.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// What the fluid's populations are stored as; other than 64 bits for the cases of the fluid alone.
    #[arg(long, value_enum, default_value = "f64")]
    precision: Bits,
    /// Findings of an earlier run, as JSON, to print a table of both.
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// Print every finding, not only each case's worst.
    #[arg(long)]
    verbose: bool,
}

fn column_and_value(text: &str) -> Result<(String, String), String> {
    let (column, value) = text.split_once('=').ok_or("COLUMN=VALUE is wanted, such as Ca=0.1")?;
    Ok((column.to_owned(), value.to_owned()))
}

fn main() -> ExitCode {
    let options = Options::parse();
    match run(&options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("validate: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(options: &Options) -> Result<bool, Fault> {
    for name in &options.cases {
        if !CASES.iter().any(|(n, _)| n == name) {
            let known: Vec<_> = CASES.iter().map(|(n, _)| *n).collect();
            return Err(format!("there is no case `{name}`; the cases are {}", known.join(", ")).into());
        }
    }
    let folder = options.reference.clone().unwrap_or_else(Table::own_folder);
    let effort = Effort {
        quick: options.quick,
        precision: match options.precision {
            Bits::F64 => Precision::F64,
            Bits::F32 => Precision::F32,
            Bits::F16 => Precision::F16,
        },
    };
    let before: Option<Vec<Finding>> = match &options.against {
        Some(path) => Some(serde_json::from_reader(BufReader::new(File::open(path)?))?),
        None => None,
    };
    let stored = |name: &str| options.precision == Bits::F64 || STORED.contains(&name);
    if let Some(name) = options.cases.iter().find(|c| !stored(c)) {
        return Err(format!(
            "`{name}` is computed in 64 bits only; those in others are {}",
            STORED.join(", ")
        )
        .into());
    }
    let wanted = |name: &str| stored(name) && (options.cases.is_empty() || options.cases.iter().any(|c| c == name));
    let mut all = Vec::new();
    for (name, case) in CASES.iter().filter(|(n, _)| wanted(n)) {
        let findings = match case {
            Case::Rows(compute) => {
                let mut table = Table::read(&folder, name)?;
                for (column, value) in &options.only {
                    table = table.only(column, value)?;
                }
                compute(&table, effort)?
            }
            Case::Alone(_) if !options.only.is_empty() => {
                return Err(format!("`{name}` has no reference file whose rows --only could choose from").into());
            }
            Case::Alone(compute) => compute(effort)?,
        };
        print_case(name, &findings, options);
        all.extend(findings.found);
        if let Some(path) = &options.json {
            lbm_ibm::output::write_json(path, &all)?;
        }
    }
    if let Some(before) = before {
        println!("{}", comparison(&before, &all));
    }
    let failed = all.iter().filter(|f| !f.pass).count();
    println!("{} passed, {failed} failed", all.len() - failed);
    Ok(failed == 0)
}

fn print_case(name: &str, findings: &Findings, options: &Options) {
    println!("{name}");
    let found = findings.found.as_slice();
    let gated = |f: &&Finding| f.gate.is_some();
    let over = |f: &Finding| f.relative_error / f.gate.unwrap_or(1.0).max(f64::MIN_POSITIVE);
    let worst = found.iter().filter(gated).max_by(|a, b| over(a).total_cmp(&over(b)));
    for f in found {
        let is_worst = worst.is_some_and(|w| std::ptr::eq(w, f));
        if options.verbose || !f.pass || is_worst || f.quantity.starts_with("order") {
            print_finding(f);
        }
    }
    let rows = found.iter().filter(gated).count();
    let seconds: f64 = seconds_of_rows(found);
    println!(
        "  {rows} gated quantities, {} reported, {seconds:.1} s",
        found.len() - rows
    );
    if findings.left_out > 0 {
        let why = if options.quick {
            "slow ones come without --quick"
        } else {
            "the text of the case says why"
        };
        println!("  {} rows left out: {why}", findings.left_out);
    }
}

/// The last finding of each row has the seconds of the row.
fn seconds_of_rows(found: &[Finding]) -> f64 {
    let ends = found.iter().zip(found.iter().skip(1).map(Some).chain([None]));
    ends.filter(|(f, next)| next.is_none_or(|n| n.row != f.row))
        .map(|(f, _)| f.seconds)
        .sum()
}

fn print_finding(f: &Finding) {
    let row: Vec<_> = f.row.iter().map(|(k, v)| format!("{k}={v}")).collect();
    let verdict = match (f.gate, f.pass) {
        (None, _) => "reported".to_owned(),
        (Some(gate), true) => format!("ok   (gate {gate:.1e})"),
        (Some(gate), false) => format!("FAIL (gate {gate:.1e})"),
    };
    println!(
        "  {:44} {:24} {:14.7e} ref {:14.7e} err {:9.2e} {verdict} {:.2} s",
        row.join(" "),
        f.quantity,
        f.value,
        f.reference,
        f.relative_error,
        f.seconds
    );
}
