//! Work-precision charts: the error of a choice against what it costs.
//!
//! `cargo run --release -p lbm-ibm-benches --bin chart -- --list`. A chart is an entry of [`CHARTS`]; what it shows is
//! a function that returns its rows, most often from a table with one line per curve.

mod capsule;
mod channel;
mod draw;
mod front;
mod gap;
mod kernels;
mod magnetics;
mod sphere_drag;
mod spheres;
mod time;

pub use front::front;
pub use time::{Work, seconds_per_call};

use crate::Fault;
use lbm_ibm::output::write_csv;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// Relative difference of two timings, or of two errors, that is no reason to choose.
const NOISE: f64 = 0.05;

/// A work-precision chart.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    /// Its name on the command line, and of its files.
    pub name: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// Label of the cost axis, with the unit: seconds on one thread.
    pub cost: &'static str,
    /// Label of the error axis: relative errors, or with their unit.
    pub error: &'static str,
    /// What to choose when, in a sentence or two.
    pub advice: &'static str,
    /// Its rows; few of them, in seconds, if the argument is true. All but the cost is the same in every run.
    pub cases: fn(bool) -> Result<Vec<Row>, Fault>,
}

/// All charts.
pub const CHARTS: &[Chart] = &[
    channel::DUCT,
    channel::PLANE,
    channel::START_UP,
    kernels::KERNELS,
    magnetics::PAIRS,
    magnetics::CHAINS,
    magnetics::CLUSTERS,
    magnetics::FAR_FIELD,
    spheres::SPHERES,
    sphere_drag::SPHERE_DRAG,
    capsule::CAPSULE,
    gap::GAP,
];

/// A point of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What is computed; each case has a front of its own. Empty where the chart has one case.
    pub case: String,
    /// The curve it belongs to; curves come in the order in which they first appear.
    pub curve: String,
    /// What tells it from the others of its curve.
    pub label: String,
    /// Seconds, above zero.
    pub cost_s: f64,
    /// The cost as a count that is the same on every machine: node updates, marker visits, pairs.
    pub updates: f64,
    /// Deviation from the reference, not negative.
    pub error: f64,
}

impl Row {
    fn check(&self) -> Result<(), Fault> {
        let Self { curve, label, .. } = self;
        if !(self.cost_s.is_finite() && self.cost_s > 0.0) {
            return Err(format!("{curve}, {label}: a cost of {} s is not above zero", self.cost_s).into());
        }
        if !(self.error.is_finite() && self.error >= 0.0) {
            return Err(format!("{curve}, {label}: {} is no error, the case has diverged", self.error).into());
        }
        Ok(())
    }
}

/// Names of the curves, in the order in which they appear.
fn curves(rows: &[Row]) -> Vec<&str> {
    names(rows.iter().map(|r| r.curve.as_str()))
}

/// Names of the cases, in the order in which they appear.
fn cases(rows: &[Row]) -> Vec<&str> {
    names(rows.iter().map(|r| r.case.as_str()))
}

fn names<'a>(all: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut names = Vec::new();
    for name in all {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Which rows are on the front of their case.
fn fronts(rows: &[Row]) -> Vec<bool> {
    let mut best = vec![false; rows.len()];
    for case in cases(rows) {
        let of: Vec<usize> = (0..rows.len()).filter(|i| rows[*i].case == case).collect();
        let points: Vec<_> = of.iter().map(|&i| (rows[i].cost_s, rows[i].error)).collect();
        for (i, on) in of.into_iter().zip(front(&points, NOISE)) {
            best[i] = on;
        }
    }
    best
}

/// A row as the file has it.
#[derive(Serialize)]
struct Record<'a> {
    #[serde(skip_serializing_if = "str::is_empty")]
    case: &'a str,
    curve: &'a str,
    label: &'a str,
    cost_s: String,
    updates: f64,
    error: String,
    front: bool,
}

impl Chart {
    /// The chart of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        CHARTS.iter().find(|c| c.name == name)
    }

    /// Computes the chart and writes `NAME.csv` and `NAME.svg` into a folder, which is made if need be. Returns the
    /// rows and which of them are on the front.
    ///
    /// The columns are case (if there are several), curve, label, cost_s (s), updates, error and front, whether the row is on its case's
    /// Pareto front of cost and error, differences of 5 % apart.
    ///
    /// # Errors
    /// Those of the cases; a cost or an error that is not a number; a file that cannot be written.
    pub fn write(&self, folder: &Path, quick: bool) -> Result<(Vec<Row>, Vec<bool>), Fault> {
        let mut rows = (self.cases)(quick)?;
        rows.iter()
            .try_for_each(Row::check)
            .map_err(|e| format!("chart {}: {e}", self.name))?;
        let order: Vec<String> = curves(&rows).into_iter().map(str::to_owned).collect();
        rows.sort_by_key(|row| order.iter().position(|name| *name == row.curve));
        let best = fronts(&rows);
        fs::create_dir_all(folder).map_err(|e| format!("cannot make {}: {e}", folder.display()))?;
        let path = |extension: &str| -> PathBuf { folder.join(format!("{}.{extension}", self.name)) };
        let records = rows.iter().zip(&best).map(|(row, &front)| Record {
            case: &row.case,
            curve: &row.curve,
            label: &row.label,
            cost_s: format!("{:.3e}", row.cost_s),
            updates: row.updates,
            error: format!("{:.4e}", row.error),
            front,
        });
        write_csv(&path("csv"), records)?;
        let svg = draw::svg(self, &rows, &best)?;
        fs::write(path("svg"), svg).map_err(|e| format!("cannot write {}: {e}", path("svg").display()))?;
        Ok((rows, best))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chart_has_a_name_of_its_own_and_advice() {
        for (i, chart) in CHARTS.iter().enumerate() {
            assert!(!chart.advice.is_empty());
            assert!(
                CHARTS[..i].iter().all(|c| c.name != chart.name),
                "{} is there twice",
                chart.name
            );
        }
    }

    #[test]
    fn every_case_has_a_front_of_its_own() {
        let row = |case: &str, cost_s, error| Row {
            case: case.into(),
            curve: "a".into(),
            label: "b".into(),
            cost_s,
            updates: 1.0,
            error,
        };
        // What is hard costs more and errs more than anything easy; the second of it is beaten by the third.
        let rows = [
            row("easy", 1.0, 1.0),
            row("hard", 2.0, 3.0),
            row("hard", 3.0, 3.0),
            row("hard", 3.0, 2.0),
        ];
        assert_eq!(fronts(&rows), [true, true, false, true]);
    }

    #[test]
    fn a_case_that_has_diverged_is_named() {
        let row = |cost_s, error| Row {
            case: String::new(),
            curve: "BGK".into(),
            label: "tau 9".into(),
            cost_s,
            updates: 1.0,
            error,
        };
        assert!(row(1.0, 0.0).check().is_ok());
        for bad in [
            row(1.0, f64::NAN),
            row(1.0, -1.0),
            row(0.0, 1.0),
            row(f64::INFINITY, 1.0),
        ] {
            let said = bad.check().map_err(|e| e.to_string());
            assert!(said.is_err_and(|e| e.contains("BGK, tau 9")));
        }
    }
}
