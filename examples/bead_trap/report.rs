//! Tables and charts.

use crate::chains::Row;
use crate::flow::{End, Moment, Run};
use lbm_ibm::coupling::{MS, PN, UM};
use lbm_ibm::output::{Chart, Mark, OutputError, write_csv, write_json};
use serde::Serialize;
use std::path::Path;

#[derive(Serialize)]
struct Summary<'a> {
    /// Bias field, T.
    bias: f64,
    /// Gap of the row at rest, m.
    gap: f64,
    ends: &'a [End],
}

/// Says how the cells fared and what the beads bore from moment number `from` on.
pub fn print(run: &Run<'_>, from: usize) {
    for end in run.ends() {
        println!(
            "   {}: {:?} {:.1} ms after it met the row, at {:.2} um, speed {:.4} of the open row's {:.0} um/s, volume {:.3} %",
            end.cell,
            end.fate,
            end.time / MS,
            end.place / UM,
            end.speed,
            run.open_speed / UM,
            100.0 * end.volume_drift
        );
    }
    if let Some(last) = run.moments.last() {
        let bend = run.moments[from..].iter().map(|m| m.bend).fold(0.0, f64::max);
        println!(
            "   at {:.0} ms: pressure drop {:.2} Pa, fluid on beads {:.0} pN,{} beads displaced by at most {:.2} um",
            last.time / MS,
            last.pressure_drop,
            last.fluid_force / PN,
            last.cell_force
                .map_or(String::new(), |f| format!(" cells on beads {:.0} pN,", f / PN)),
            bend / UM
        );
    }
}

/// Writes `cells.csv`, `moments.csv`, `cells.svg` and `summary.json` into `folder`.
pub fn write(folder: &Path, bias: f64, row: &Row, ends: &[End], moments: &[Moment]) -> Result<(), OutputError> {
    write_csv(&folder.join("cells.csv"), ends)?;
    write_csv(&folder.join("moments.csv"), moments)?;
    let chart = Chart::new(
        "Cells at a row of bead chains",
        "time, ms",
        "middle of the cell behind the row, um",
    );
    let mut kinds: Vec<&str> = moments.iter().map(|m| m.beads.as_str()).collect();
    kinds.dedup();
    let chart = kinds.into_iter().fold(chart, |chart, kind| {
        let own = || moments.iter().filter(|m| m.beads == kind);
        chart
            .series(
                &format!("tumour cell, {kind}"),
                Mark::Line,
                own().map(|m| (m.time / MS, m.ctc / UM)),
            )
            .series(
                &format!("red cell, {kind}"),
                Mark::Line,
                own().filter_map(|m| Some((m.time / MS, m.rbc? / UM))),
            )
    });
    chart.write_svg(&folder.join("cells.svg"))?;
    let gap = row.gap;
    write_json(&folder.join("summary.json"), &Summary { bias, gap, ends })
}
