//! The case: all ratios on all grids of the file.

use super::passage::{NODE_AREA, Passage};
use super::watch::Passed;
use crate::reference::{ReferenceError, Row, Table};
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};

/// Columns of the throat's radius in spacings.
const GRIDS: [&str; 3] = ["Rt_coarse", "Rt_medium", "Rt_fine"];
/// Ratio of the radii in a quick run, on the first grid, and of the finer mesh there.
const QUICK: f64 = 1.0;
/// Area for each node of that mesh, in squared spacings.
const FINER_MESH: f64 = 0.7;

/// What a row is about.
fn quantity(row: &Row, passed: &Passed) -> Result<f64, ReferenceError> {
    Ok(match row.text("quantity")? {
        "transit" => passed.transit,
        "impulse" => passed.impulse,
        "dP_entering" => passed.entering,
        "dP_leaving" => passed.leaving,
        "L_over_2a" => passed.length,
        _ => return Err(row.unknown("quantity")),
    })
}

/// The order p of the error in the spacing for which three values, those on the finer grids last, lie on one curve
/// `f + c h^p`, by bisection between 0.5 and 10; not a number where there is none: a lower one tells nothing.
fn order(cells: [f64; 3], values: [f64; 3]) -> f64 {
    let [coarse, medium, fine] = cells;
    let wanted = (values[0] - values[1]) / (values[1] - values[2]);
    let ratio = |p: f64| (coarse.powf(-p) - medium.powf(-p)) / (medium.powf(-p) - fine.powf(-p));
    let (mut low, mut high) = (0.5, 10.0);
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

/// The value without spacings by three, those on the finer grids last: with the observed order, at most 2; with 2 where the values
/// are monotone and show no order; the middle of their range where they are not monotone.
fn extrapolated(cells: [f64; 3], values: [f64; 3]) -> f64 {
    let [_, medium, fine] = cells;
    let last = values[2] - values[1];
    if (values[1] - values[0]) * last < 0.0 {
        let [low, high] = [f64::min, f64::max].map(|f| values.into_iter().reduce(f).unwrap_or(f64::NAN));
        return 0.5 * (low + high);
    }
    let p = order(cells, values).min(2.0);
    values[2] + last * fine.powf(-p) / (medium.powf(-p) - fine.powf(-p))
}

/// A capsule driven from a tube of twice its radius through a throat of a/R_t = 0.9, 1 and 1.1, on three grids: transit time,
/// extra pressure summed over it, its peaks, and length against the file's extrapolated values. The file states the greatest
/// error on the coarsest grid; on a finer one it has to be less in proportion to the spacing. A finer mesh on the coarsest grid
/// tells what the mesh does. A quick run has one ratio on the coarsest grid.
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
    let all = ratios.len() * GRIDS.len();
    ratios.retain(|r| !effort.quick || r.0 == QUICK);
    findings.left_out = all - ratios.len() * grids;
    let mut jobs: Vec<Passage> = Vec::new();
    for &(ratio, cells) in &ratios {
        let job = |node_area, cells| Passage {
            ratio,
            cells,
            node_area,
        };
        jobs.extend(cells[..grids].iter().map(|&n| job(NODE_AREA, n)));
        if ratio == QUICK && !effort.quick {
            jobs.push(job(FINER_MESH, cells[0]));
        }
    }
    // The longest first.
    jobs.sort_by(|a, b| (b.ratio * b.cells).total_cmp(&(a.ratio * a.cells)));
    let found = side_by_side(&jobs, Passage::run)?;
    for &(ratio, cells) in &ratios {
        let rows = || {
            let of_ratio = |r: &&Row| r.number("a_over_Rt").is_ok_and(|a| a == ratio);
            table.rows().iter().filter(of_ratio)
        };
        let mut values: Vec<Vec<f64>> = vec![Vec::new(); rows().count()];
        let mut runs: Vec<_> = jobs.iter().zip(&found).filter(|(job, _)| job.ratio == ratio).collect();
        runs.sort_by(|a, b| a.0.cells.total_cmp(&b.0.cells));
        for (job, (passed, seconds)) in runs {
            let name = [("a_over_Rt", ratio), ("Rt_over_h", job.cells)];
            let name = name.map(|(k, v)| (k.to_owned(), format!("{v:.3}")));
            findings.begin_done(name.into(), *seconds);
            for (row, values) in rows().zip(&mut values) {
                let (quantity, value) = (row.text("quantity")?, quantity(row, passed)?);
                let exact = row.number("extrapolated")?;
                if job.node_area == NODE_AREA {
                    let gate = row.number("error_coarse")? * cells[0] / job.cells;
                    findings.check(quantity, value, exact, gate);
                    values.push(value);
                } else {
                    findings.report(&format!("{quantity} on a finer mesh"), value, exact, exact);
                }
            }
            if job.node_area == NODE_AREA {
                details(&mut findings, job, passed);
            }
        }
        for (row, values) in rows().zip(values) {
            if let Ok(values) = <[f64; 3]>::try_from(values) {
                let quantity = row.text("quantity")?;
                findings.begin_done([("a_over_Rt".to_owned(), format!("{ratio:.3}"))].into(), 0.0);
                let stated = row.number("order")?;
                findings.report(&format!("order of {quantity}"), order(cells, values), stated, 1.0);
                let exact = row.number("extrapolated")?;
                let name = format!("{quantity} extrapolated");
                findings.report(&name, extrapolated(cells, values), exact, exact);
            }
        }
    }
    Ok(findings)
}

/// What else was seen of a passage.
fn details(findings: &mut Findings, job: &Passage, passed: &Passed) {
    findings.report("pressure drop of the empty device", passed.empty, 0.0, 1.0);
    findings.report("place of the peak, entering", passed.places[0], 0.0, 1.0);
    findings.report("place of the peak, leaving", passed.places[1], 0.0, 1.0);
    findings.report("least gap to the wall over a", passed.film, 0.0, 1.0);
    findings.report("least gap in spacings", passed.film * job.ratio * job.cells, 2.0, 2.0);
    findings.report("greatest growth of the area", passed.area, 0.0, 1.0);
    findings.report("greatest angle of neighbours (degrees)", passed.fold, 0.0, 180.0);
    findings.report("steps", passed.steps as f64, 0.0, 1.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_a_power_is_found() {
        let cells = [6.0, 7.781, 12.0];
        for p in [0.6, 1.0, 2.3] {
            let found = order(cells, cells.map(|n| 3.0 - 2.0 * n.powf(-p)));
            assert!((found - p).abs() < 1e-9, "{found} {p}");
        }
        assert!(order(cells, [1.0, 2.0, 1.5]).is_nan());
    }

    #[test]
    fn a_power_is_extrapolated_to_its_limit() {
        let cells = [8.0, 10.0, 13.0];
        for p in [0.6, 1.0, 2.0] {
            let limit = extrapolated(cells, cells.map(|n| 3.0 - 2.0 * n.powf(-p)));
            assert!((limit - 3.0).abs() < 1e-9, "{limit} {p}");
        }
        assert!((extrapolated(cells, [1.0, 2.0, 1.5]) - 1.5).abs() < 1e-15);
    }
}
