//! The case: all ratios on all grids of the file.

use super::passage::Passage;
use super::watch::Passed;
use crate::reference::{ReferenceError, Row, Table};
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};

/// Columns of the throat's radius in spacings; a quick run has the first.
const GRIDS: [&str; 3] = ["Rt_coarse", "Rt_medium", "Rt_fine"];

/// What a row is about.
fn quantity(row: &Row, passed: &Passed) -> Result<f64, ReferenceError> {
    Ok(match row.text("quantity")? {
        "transit" => passed.transit,
        "dP_entering" => passed.entering,
        "dP_leaving" => passed.leaving,
        "L_over_2a" => passed.length,
        _ => return Err(row.unknown("quantity")),
    })
}

/// The order p of the error in the spacing for which three values, those on the finer grids last, lie on one curve
/// `f + c h^p`, by bisection between 0.01 and 10; not a number where there is none.
fn order(cells: [f64; 3], values: [f64; 3]) -> f64 {
    let [coarse, medium, fine] = cells;
    let wanted = (values[0] - values[1]) / (values[1] - values[2]);
    let ratio = |p: f64| (coarse.powf(-p) - medium.powf(-p)) / (medium.powf(-p) - fine.powf(-p));
    let (mut low, mut high) = (0.01, 10.0);
    if !(ratio(low)..=ratio(high)).contains(&wanted) {
        return f64::NAN;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if ratio(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// A capsule driven from a tube of twice its radius through a throat of a/R_t = 0.9, 1 and 1.1, on three grids: transit time,
/// peak extra pressure and length against the file's extrapolated values. The file states the greatest error on the coarsest
/// grid; on a finer one it has to be less in proportion to the spacing.
pub fn constriction(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let grids = if effort.quick { 1 } else { GRIDS.len() };
    let mut ratios: Vec<(f64, [f64; 3])> = Vec::new();
    for row in table.rows() {
        let ratio = row.number("a_over_Rt")?;
        if !ratios.iter().any(|r| r.0 == ratio) {
            let [coarse, medium, fine] = GRIDS.map(|g| row.number(g));
            ratios.push((ratio, [coarse?, medium?, fine?]));
        }
    }
    findings.left_out = ratios.len() * (GRIDS.len() - grids);
    let mut jobs: Vec<Passage> = ratios
        .iter()
        .flat_map(|&(ratio, cells)| cells.into_iter().take(grids).map(move |cells| Passage { ratio, cells }))
        .collect();
    // The longest first.
    jobs.sort_by(|a, b| (b.ratio * b.cells).total_cmp(&(a.ratio * a.cells)));
    let found = side_by_side(&jobs, Passage::run)?;
    for &(ratio, cells) in &ratios {
        let rows = || {
            table
                .rows()
                .iter()
                .filter(|r| r.number("a_over_Rt").is_ok_and(|a| a == ratio))
        };
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); rows().count()];
        for &n in &cells[..grids] {
            let job = Passage { ratio, cells: n };
            let at = jobs.iter().position(|j| *j == job).ok_or("a grid has not been run")?;
            let (passed, seconds) = &found[at];
            let name = [("a_over_Rt", ratio), ("Rt_over_h", n)];
            let name = name.map(|(k, v)| (k.to_owned(), format!("{v:.3}")));
            findings.begin_done(name.into(), *seconds);
            for (row, values) in rows().zip(&mut values) {
                let value = quantity(row, passed)?;
                let gate = row.number("error_coarse")? * cells[0] / n;
                findings.check(row.text("quantity")?, value, row.number("extrapolated")?, gate);
                values.push(value);
            }
            findings.report("place of the peak, entering", passed.places[0], 0.0, 1.0);
            findings.report("place of the peak, leaving", passed.places[1], 0.0, 1.0);
            findings.report("least gap to the wall over a", passed.film, 0.0, 1.0);
            findings.report("least gap in spacings", passed.film * ratio * n, 2.0, 2.0);
            findings.report("greatest growth of the area", passed.area, 0.0, 1.0);
            findings.report("greatest angle of neighbours (degrees)", passed.fold, 0.0, 180.0);
            findings.report("steps", passed.steps as f64, 0.0, 1.0);
        }
        for (row, values) in rows().zip(values) {
            if let [coarse, medium, fine] = values[..] {
                let name = format!("order of {}", row.text("quantity")?);
                findings.report(&name, order(cells, [coarse, medium, fine]), row.number("order")?, 1.0);
            }
        }
    }
    Ok(findings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_a_power_is_found() {
        let cells = [6.0, 7.781, 12.0];
        for p in [0.5, 1.0, 2.3] {
            let found = order(cells, cells.map(|n| 3.0 - 2.0 * n.powf(-p)));
            assert!((found - p).abs() < 1e-9, "{found} {p}");
        }
        assert!(order(cells, [1.0, 2.0, 1.5]).is_nan());
    }
}
