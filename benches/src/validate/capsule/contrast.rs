//! Capsules with another viscosity inside.

use super::Material;
use super::steady::{Steady, capsule, material, steady, unbounded};
use crate::Fault;
use crate::reference::Table;
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};

/// Law, viscosity ratio and capillary number of the rows that are run in full, and spacings a radius: at 8 the inclination of the second one is
/// 1.4 degrees off, an error of the first order.
const FULL: &[(&str, f64, f64, f64)] = &[
    ("SK", 5.0, 0.1, 8.0),
    ("SK", 5.0, 0.2, 12.0),
    ("NH", 5.0, 0.1, 8.0),
    ("NH", 2.0, 0.2, 8.0),
    ("SK", 2.0, 0.1, 8.0),
    ("SK", 0.2, 0.2, 8.0),
];
/// The same of a quick run.
const QUICK: &[(&str, f64, f64, f64)] = &[("SK", 2.0, 0.1, 5.0)];
/// Edge of the box in radii, and of the larger one that tells what the box does.
const BOXES: [f64; 2] = [8.0, 12.0];

/// A capsule, and how it is computed.
#[derive(Clone, Copy)]
struct Job {
    material: Material,
    ratio: f64,
    capillary: f64,
    /// Strain at which it is settled.
    settled: f64,
    /// Spacings a radius; in both boxes, and in the smaller one.
    radii: [f64; 2],
}

/// Deformation and inclination in an unbounded flow, the tank-treading period there, what is found in the box, and the
/// seconds.
struct Found {
    free: [f64; 2],
    period: Option<f64>,
    boxed: Steady,
    seconds: f64,
}

/// Runs all jobs, the longest first.
fn run(jobs: &[Job], with_period: bool) -> Result<Vec<Found>, Fault> {
    let runs: Vec<_> = [(1, BOXES[0]), (0, BOXES[1]), (0, BOXES[0])]
        .into_iter()
        .flat_map(|(radius, size)| jobs.iter().map(move |job| (job, job.radii[radius], size)))
        .collect();
    let found = side_by_side(&runs, |&(job, radius, size)| {
        let capsule = capsule(job.material, job.capillary, job.ratio, radius, size);
        steady(&capsule, job.settled, with_period)
    })?;
    let of = |part: usize, n: usize| found[part * jobs.len() + n];
    let one = |n: usize| {
        let [fine, large, small] = [0, 1, 2].map(|part| of(part, n));
        let [in_box, without] = unbounded(BOXES, [small.0.deformation, large.0.deformation]);
        let [angle_in_box, angle_without] = unbounded(BOXES, [small.0.angle, large.0.angle]);
        let period = fine
            .0
            .period
            .zip(small.0.period)
            .zip(large.0.period)
            .map(|((fine, small), large)| {
                let [in_box, without] = unbounded(BOXES, [small, large]);
                fine * without / in_box
            });
        Found {
            period,
            free: [
                fine.0.deformation * without / in_box,
                fine.0.angle + angle_without - angle_in_box,
            ],
            boxed: fine.0,
            seconds: fine.1 + large.1 + small.1,
        }
    };
    Ok((0..jobs.len()).map(one).collect())
}

/// Capsules between sliding plates, 8 or 12 spacings a radius (5 in a quick run), the effect of the box taken off: the deformation
/// within 2 %, the inclination within 1 degree; the volume of the fluid inside follows the surface within 1e-3, in full
/// over a whole turn.
pub fn capsule_shear_contrast(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let (mut jobs, mut rows) = (Vec::new(), Vec::new());
    for row in table.rows() {
        let (ratio, capillary) = (row.number("lambda")?, row.number("Ca")?);
        let name = (row.text("law")?, ratio, capillary);
        let chosen = if effort.quick { QUICK } else { FULL };
        if let Some(&(.., radius)) = chosen.iter().find(|c| (c.0, c.1, c.2) == name) {
            rows.push(row);
            jobs.push(Job {
                material: material(row)?,
                ratio,
                capillary,
                settled: row.number("t_end")?.min(if effort.quick { 7.0 } else { 12.0 }),
                radii: [if effort.quick { 3.0 } else { 4.0 }, radius],
            });
        } else {
            findings.left_out += 1;
        }
    }
    for ((row, job), found) in rows.iter().zip(&jobs).zip(run(&jobs, !effort.quick)?) {
        let mut name = row.key(&["law", "lambda", "Ca"]);
        name.insert("R_over_h".to_owned(), job.radii[1].to_string());
        findings.begin_done(name, found.seconds);
        let (exact, angle) = (row.number("D")?, row.number("theta_deg")?);
        findings.check("D", found.free[0], exact, 0.02);
        findings.report("D in the box", found.boxed.deformation, exact, exact);
        findings.check_scaled("inclination (degrees)", found.free[1], angle, 1.0, 1.0);
        findings.report("change of D in the last strain unit", found.boxed.drift, 0.0, exact);
        findings.check_scaled("volume inside", found.boxed.inside, 0.0, 1.0, 1e-3);
        let period = row.number("tt_period_gdot")?;
        if let Some(found) = found.period {
            findings.check("tank-treading period", found, period, 0.03);
        }
    }
    Ok(findings)
}
