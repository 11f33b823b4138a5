//! Tables and charts.

use crate::{gaps, pinned, scatter};
use lbm_ibm::coupling::{MS, UM};
use lbm_ibm::output::{Chart, Mark, OutputError, write_csv, write_json};
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Summary<'a> {
    formed: &'a [scatter::Formed],
    leaning: &'a [pinned::Row],
    gaps: &'a [gaps::Row],
}

/// Writes `chaining.csv`, `leaning.csv`, `gaps.csv`, a chart of each, and `summary.json` into `folder`.
pub fn write(
    folder: &Path,
    rows: &[scatter::Row],
    formed: &[scatter::Formed],
    leaning: &[pinned::Row],
    gaps: &[gaps::Row],
) -> Result<(), OutputError> {
    write_csv(&folder.join("chaining.csv"), rows)?;
    write_csv(&folder.join("leaning.csv"), leaning)?;
    write_csv(&folder.join("gaps.csv"), gaps)?;
    chaining_chart(rows).write_svg(&folder.join("chaining.svg"))?;
    leaning_chart(leaning).write_svg(&folder.join("leaning.svg"))?;
    gap_chart(gaps).write_svg(&folder.join("gaps.svg"))?;
    write_json(&folder.join("summary.json"), &Summary { formed, leaning, gaps })
}

fn chaining_chart(rows: &[scatter::Row]) -> Chart {
    let chart = Chart::new("Beads form chains", "time, ms", "beads per chain (mean over beads)");
    [("rest", "at rest"), ("flow", "in the flow")]
        .into_iter()
        .fold(chart, |chart, (run, label)| {
            let own = rows.iter().filter(|r| r.run == run);
            chart.series(label, Mark::Line, own.map(|r| (r.time / MS, r.mean_length)))
        })
}

fn leaning_chart(rows: &[pinned::Row]) -> Chart {
    let points = |whole: bool| {
        let own = rows.iter().filter(move |r| r.whole == whole);
        own.map(|r| (r.speed * 1e3, r.tilt.to_degrees()))
    };
    Chart::new("A chain in a flow, its foot held", "mean speed, mm/s", "tilt, degrees")
        .series("whole", Mark::Point, points(true))
        .series("broken", Mark::Open, points(false))
}

fn gap_chart(rows: &[gaps::Row]) -> Chart {
    let chart = Chart::new(
        "Gap between chains and bias field",
        "bias over the sheets' field",
        "gap, um",
    );
    rows.chunk_by(|a, b| a.beads == b.beads).fold(chart, |chart, same| {
        let points = same.iter().map(|r| (r.bias / r.sheets, r.gap / UM));
        // The same gaps as those of the weaker sheets: circles on their line.
        let mark = if same[0].beads.contains("x 2") {
            Mark::Open
        } else {
            Mark::Line
        };
        chart.series(&same[0].beads, mark, points)
    })
}
