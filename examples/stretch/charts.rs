//! Charts of curves and recoveries.

use crate::curve::Row;
use crate::measured::{Bar, PAPER_CTC, tweezers};
use crate::release::Done;
use crate::tables::names;
use lbm_ibm::coupling::{MS, PN, UM};
use lbm_ibm::output::{Chart, Mark};

/// Axial and transverse diameter of the red blood cell against the force, beside the tweezers.
pub fn rbc(rows: &[Row]) -> Chart {
    let mut chart = Chart::new("Red blood cell pulled at both ends", "force, pN", "diameter, um");
    for form in names(rows, |r| r.form) {
        let own = || rows.iter().filter(move |r| r.form == form);
        let points = |of: fn(&Row) -> Option<f64>| own().filter_map(move |r| Some((r.force / PN, of(r)? / UM)));
        chart = chart
            .series(&format!("axial, {form}"), Mark::Line, points(|r| r.axial))
            .series(&format!("transverse, {form}"), Mark::Line, points(|r| r.transverse));
    }
    let readings = tweezers();
    let axial: Vec<(f64, Bar)> = readings.iter().map(|r| (r.force / PN, r.axial)).collect();
    let transverse: Vec<(f64, Bar)> = readings.iter().map(|r| (r.force / PN, r.transverse)).collect();
    let mean = |bars: &[(f64, Bar)]| -> Vec<(f64, f64)> { bars.iter().map(|(f, d)| (*f, d.0 / UM)).collect() };
    let bars = axial.iter().chain(&transverse);
    chart
        .series("axial, tweezers", Mark::Point, mean(&axial))
        .series("transverse, tweezers", Mark::Open, mean(&transverse))
        .error_bars(bars.filter_map(|(f, d)| d.1.map(|(low, high)| (*f, low / UM, high / UM))))
}

/// Strain of the tumour cell against the force, one line per patch and form.
pub fn ctc(rows: &[Row]) -> Chart {
    let mut chart = Chart::new("Tumour cell pulled at both ends", "force, pN", "axial strain, %");
    for form in names(rows, |r| r.form) {
        for patch in names(rows, |r| &r.patch) {
            let own = rows.iter().filter(|r| r.form == form && r.patch == patch);
            let points = own.filter_map(|r| Some((r.force / PN, 100.0 * r.strain?)));
            chart = chart.series(&format!("{patch}, {form}"), Mark::Line, points);
        }
    }
    let (force, strain) = PAPER_CTC;
    chart.series("the paper's target", Mark::Point, [(force / PN, 100.0 * strain)])
}

/// What is left of the extension against the time in units of each cell's viscous time.
pub fn recoveries(done: &[Done]) -> Chart {
    let chart = Chart::new(
        "Recovery in plasma at rest, without membrane viscosity",
        "time over mu a/G, viscosity times radius over shear modulus",
        "extension over extension at the release",
    );
    done.iter().fold(chart, |chart, d| {
        let points = d
            .moments
            .iter()
            .map(|m| (m.time / d.recovery.viscous_time, m.extension));
        chart.series(&format!("{}, {}", d.recovery.cell, d.recovery.form), Mark::Line, points)
    })
}

/// Axial and transverse diameter of one cell against the time.
pub fn diameters(cell: &str, done: &[Done]) -> Chart {
    let chart = Chart::new(&format!("Recovery of the {cell}"), "time, ms", "diameter, um");
    done.iter().filter(|d| d.recovery.cell == cell).fold(chart, |chart, d| {
        let form = d.recovery.form;
        let axial = d.moments.iter().map(|m| (m.time / MS, m.axial / UM));
        let transverse = d.moments.iter().map(|m| (m.time / MS, m.transverse / UM));
        chart.series(&format!("axial, {form}"), Mark::Line, axial).series(
            &format!("transverse, {form}"),
            Mark::Line,
            transverse,
        )
    })
}
