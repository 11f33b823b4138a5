//! Tables and charts of a study.

use crate::passage::Outcome;
use crate::study::{Done, Row};
use lbm_ibm::output::{Chart, Mark, OutputError, write_csv, write_json};
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Summary<'a> {
    runs: Vec<&'a Row>,
    timing: Timing,
}

#[derive(Serialize)]
struct Timing {
    /// Wall-clock seconds of each run.
    seconds: Vec<f64>,
    /// Wall-clock seconds of the study.
    total: f64,
}

/// Writes `summary.json`, `runs.csv`, `outcome.svg` and `transit.svg` into `folder`.
pub fn write(folder: &Path, done: &[Done], total: f64) -> Result<(), OutputError> {
    let runs: Vec<&Row> = done.iter().map(|d| &d.row).collect();
    write_csv(&folder.join("runs.csv"), &runs)?;
    outcome_chart(&runs).write_svg(&folder.join("outcome.svg"))?;
    transit_chart(&runs).write_svg(&folder.join("transit.svg"))?;
    let timing = Timing {
        seconds: done.iter().map(|d| d.seconds).collect(),
        total,
    };
    write_json(&folder.join("summary.json"), &Summary { runs, timing })
}

/// The subjects in the order of their first run.
fn subjects(runs: &[&Row]) -> Vec<(String, String)> {
    let mut seen = Vec::new();
    for r in runs {
        let subject = (r.cell.clone(), r.orientation.clone());
        if !seen.contains(&subject) {
            seen.push(subject);
        }
    }
    seen
}

fn outcome_chart(runs: &[&Row]) -> Chart {
    let subjects = subjects(runs);
    let names: Vec<_> = subjects
        .iter()
        .enumerate()
        .map(|(i, (c, o))| format!("{} = {c} {o}", i + 1))
        .collect();
    let height = |r: &Row| {
        let at = subjects.iter().position(|(c, o)| *c == r.cell && *o == r.orientation);
        at.map_or(0.0, |i| i as f64 + 1.0)
    };
    let kinds = [
        (Outcome::Pass, "pass", Mark::Open),
        (Outcome::Stuck, "stuck", Mark::Point),
        (Outcome::Undecided, "undecided", Mark::Point),
        (Outcome::Failed, "failed", Mark::Point),
    ];
    let chart = Chart::new("Outcome by gap and cell", "gap, um", &names.join(", "));
    kinds.into_iter().fold(chart, |chart, (kind, name, mark)| {
        let points = runs
            .iter()
            .filter(|r| r.outcome == kind)
            .map(|r| (r.gap * 1e6, height(r)));
        chart.series(name, mark, points)
    })
}

fn transit_chart(runs: &[&Row]) -> Chart {
    let chart = Chart::new(
        "Time from touching the slit to having passed it",
        "gap, um",
        "transit time, ms",
    );
    subjects(runs).iter().fold(chart, |chart, (cell, orientation)| {
        let own = |r: &&&Row| r.cell == *cell && r.orientation == *orientation && r.outcome == Outcome::Pass;
        let points: Vec<_> = runs
            .iter()
            .filter(own)
            .map(|r| (r.gap * 1e6, r.elapsed * 1e3))
            .collect();
        let fluid: Vec<_> = runs
            .iter()
            .filter(own)
            .map(|r| (r.gap * 1e6, r.undisturbed * 1e3))
            .collect();
        chart
            .series(&format!("{cell} {orientation}"), Mark::Point, points)
            .series(&format!("fluid alone, {cell} {orientation}"), Mark::Line, fluid)
    })
}
