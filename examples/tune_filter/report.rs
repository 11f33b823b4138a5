//! Tables and the chart.

use crate::device::RADIUS;
use crate::study::{Point, Released, Window};
use crate::subject::Fate;
use lbm_ibm::coupling::{MS, UM};
use lbm_ibm::output::{Chart, Mark, OutputError, write_csv, write_json};
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Summary<'a> {
    points: &'a [Point],
    window: Option<&'a Window>,
    released: Option<&'a Released>,
}

#[derive(Serialize)]
struct Line<'a> {
    bias: f64,
    gap: f64,
    pressure_drop: f64,
    cell: &'a str,
    fate: Fate,
    time: f64,
    place: f64,
    volume_drift: f64,
}

/// Says which fields separate the cells.
pub fn print(points: &[Point], window: Option<&Window>) {
    match window {
        Some(w) => {
            let above = match w.passes {
                Some(bias) => format!("; at {:.1} mT the tumour cell passes, too", bias * 1e3),
                None => String::new(),
            };
            println!(
                "red cells pass and tumour cells do not from {:.1} to {:.1} mT{above}: take {:.1} mT",
                w.least * 1e3,
                w.most * 1e3,
                w.bias * 1e3
            );
        }
        None => println!("none of the {} fields separates the cells", points.len()),
    }
}

/// Writes `fields.csv`, `release.csv`, `tune_filter.svg`, `release.svg` and `summary.json` into `folder`.
pub fn write(
    folder: &Path,
    points: &[Point],
    window: Option<&Window>,
    released: Option<&Released>,
) -> Result<(), OutputError> {
    let lines = points.iter().flat_map(|p| {
        p.ends.iter().map(|e| Line {
            bias: p.bias,
            gap: p.gap,
            pressure_drop: p.pressure_drop,
            cell: &e.cell,
            fate: e.fate,
            time: e.time,
            place: e.place,
            volume_drift: e.volume_drift,
        })
    });
    write_csv(&folder.join("fields.csv"), lines)?;
    let chart = Chart::new("Bias to gap to capture", "bias field, mT", "gap between chains, um");
    let chart = chart.series("gap", Mark::Line, points.iter().map(|p| (p.bias * 1e3, p.gap / UM)));
    let kinds = [
        ("tumour cell held", Fate::Held, Mark::Point),
        ("tumour cell passes", Fate::Pass, Mark::Open),
        ("tumour cell not through in time", Fate::Undecided, Mark::Point),
    ];
    let chart = kinds.into_iter().fold(chart, |chart, (label, fate, mark)| {
        let own = points.iter().filter(|p| p.fate("ctc") == fate);
        chart.series(label, mark, own.map(|p| (p.bias * 1e3, p.gap / UM)))
    });
    let freed = released.filter(|r| r.cell > 2.0 * RADIUS);
    let at = points.iter().filter(|p| freed.is_some_and(|r| r.bias == p.bias));
    chart
        .series(
            "freed when switched off",
            Mark::Open,
            at.map(|p| (p.bias * 1e3, p.gap / UM)),
        )
        .write_svg(&folder.join("tune_filter.svg"))?;
    if let Some(released) = released {
        write_csv(&folder.join("release.csv"), &released.moments)?;
        let chart = Chart::new("Magnets on, then off", "time, ms", "along the flow, um");
        let moments = &released.moments;
        chart
            .series(
                "tumour cell",
                Mark::Line,
                moments.iter().map(|m| (m.time / MS, m.ctc / UM)),
            )
            .series(
                "farthest bead",
                Mark::Line,
                moments.iter().map(|m| (m.time / MS, m.bend / UM)),
            )
            .write_svg(&folder.join("release.svg"))?;
    }
    write_json(
        &folder.join("summary.json"),
        &Summary {
            points,
            window,
            released,
        },
    )
}
