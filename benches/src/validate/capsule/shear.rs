//! A capsule in a simple shear flow.

use super::Material;
use super::scene::Capsule;
use super::steady::{Steady, capsule, key, material, steady, unbounded};
use crate::Fault;
use crate::reference::Table;
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use std::collections::BTreeMap;

/// Edge of the box in radii, and of the larger one that tells what the box does.
const BOXES: [f64; 2] = [6.0, 9.0];
/// Radius in grid spacings at which the effect of the box is found: at 4 spacings a capsule feels 3.0 % in a box of 6 radii that
/// does 2.6 % to one of 6 spacings.
const COARSE: f64 = 6.0;
/// Capillary numbers whose rows are run in full, for each law.
const FULL: &[(&str, &[f64])] = &[("NH", &[0.05, 0.1, 0.2, 0.3, 0.6]), ("SK", &[0.1, 0.3, 0.6, 1.5])];
/// Rows for which a fine grid is run too, and a coarser one for the order.
const FINE: &[(&str, f64)] = &[("NH", 0.1), ("SK", 0.3)];
/// Radii in grid spacings of their runs, each twice the next; other rows have the middle one.
const FINER: [f64; 3] = [16.0, 8.0, 4.0];
/// Stiffness of the hinges, over shear modulus times radius squared, of the one more run on the finest grid that a law which does
/// not resist compression has: it smooths wrinkles of the size of a triangle, and changes the shape little otherwise.
const BENDING: f64 = 1e-3;
/// Row of a quick run.
const QUICK: (&str, f64) = ("NH", 0.1);

/// What the file says of a law and a capillary number.
struct Truth {
    law: String,
    material: Material,
    capillary: f64,
    deformation: f64,
    angle: f64,
    width: f64,
    /// Tank-treading period times the shear rate, where the file has it.
    period: Option<f64>,
}

/// One run: which truth, radius in spacings, edge of the box in radii, stiffness of the hinges.
#[derive(Clone, Copy)]
struct Job {
    truth: usize,
    radius: f64,
    size: f64,
    bending: f64,
}

/// The rows of the file, the finest of each law and capillary number.
fn truths(table: &Table) -> Result<Vec<Truth>, Fault> {
    let mut all: Vec<Truth> = Vec::new();
    for row in table.rows() {
        let (law, capillary) = (row.text("law")?.to_owned(), row.number("Ca")?);
        let period = Some(row.number("tt_period_gdot")?).filter(|p| p.is_finite());
        let same = all.iter().position(|t| t.law == law && t.capillary == capillary);
        let period = period.or(same.and_then(|i| all[i].period));
        let truth = Truth {
            material: material(row)?,
            law,
            capillary,
            deformation: row.number("D")?,
            angle: row.number("theta_deg")?,
            width: row.number("W_over_a")?,
            period,
        };
        match same {
            Some(i) => all[i] = truth,
            None => all.push(truth),
        }
    }
    Ok(all)
}

fn run(truth: &Truth, job: Job, with_period: bool) -> Result<Steady, Fault> {
    let capsule = Capsule {
        bending: job.bending,
        ..capsule(truth.material, truth.capillary, 1.0, job.radius, job.size)
    };
    // The stiffer the membrane, the sooner it is settled; the box takes its time too.
    steady(&capsule, 5.0 + 8.0 * truth.capillary, with_period)
}

/// Capsules between sliding plates in boxes of 6 radii, the effect of the box taken off: the deformation within 3 % at 8
/// spacings a radius (6 in a quick run) and 1 % at 16, the inclination within 1 degree, the tank-treading period within 3 %.
/// The order in h is that of three grids in the same box. The nodes lie inside the capsule's surface by the kernel's
/// hydrodynamic shift.
pub fn capsule_shear(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let all = truths(table)?;
    let wanted = |t: &Truth| {
        if effort.quick {
            (t.law.as_str(), t.capillary) == QUICK
        } else {
            FULL.iter()
                .any(|(law, list)| *law == t.law && list.contains(&t.capillary))
        }
    };
    let truths: Vec<_> = all.into_iter().filter(wanted).collect();
    findings.left_out = table.rows().len() - truths.len();
    let mut jobs = Vec::new();
    for (truth, t) in truths.iter().enumerate() {
        let is_fine = !effort.quick && FINE.contains(&(t.law.as_str(), t.capillary));
        let radii = if effort.quick {
            &[][..]
        } else if is_fine {
            &FINER[..]
        } else {
            &FINER[1..2]
        };
        let runs = radii.iter().map(|&radius| (radius, BOXES[0]));
        let runs = runs.chain(BOXES.map(|size| (COARSE, size)));
        let job = |radius, size, bending| Job {
            truth,
            radius,
            size,
            bending,
        };
        jobs.extend(runs.map(|(radius, size)| job(radius, size, 0.0)));
        if is_fine && t.law == "NH" {
            jobs.push(job(FINER[0], BOXES[0], BENDING));
        }
    }
    // The longest first.
    jobs.sort_by(|a, b| (b.radius * b.size).total_cmp(&(a.radius * a.size)));
    let found = side_by_side(&jobs, |&job| {
        let truth = &truths[job.truth];
        run(truth, job, !effort.quick && job.radius < 12.0 && truth.period.is_some())
    })?;
    let all: Vec<_> = jobs.iter().zip(found).collect();
    for (number, truth) in truths.iter().enumerate() {
        let of = |size: f64| {
            all.iter()
                .find(|(j, _)| j.truth == number && j.radius == COARSE && j.size == size)
        };
        let (Some((_, (small, _))), Some((_, (large, _)))) = (of(BOXES[0]), of(BOXES[1])) else {
            continue;
        };
        let [boxed, free] = unbounded(BOXES, [small.deformation, large.deformation]);
        let [angle_boxed, angle_free] = unbounded(BOXES, [small.angle, large.angle]);
        for (job, (steady, seconds)) in all.iter().filter(|(j, _)| j.truth == number && j.size == BOXES[0]) {
            findings.begin_done(row(truth, job.radius), *seconds);
            let deformation = steady.deformation * free / boxed;
            if job.bending > 0.0 {
                let name = format!("D with hinges of {BENDING} G a2");
                findings.report(&name, deformation, truth.deformation, truth.deformation);
                let name = format!("width with hinges of {BENDING} G a2");
                findings.report(&name, steady.width, truth.width, truth.width);
                continue;
            }
            if job.radius < 8.0 && !effort.quick {
                findings.report("D", deformation, truth.deformation, truth.deformation);
                continue;
            }
            let gate = if job.radius < 12.0 { 0.03 } else { 0.01 };
            findings.check("D", deformation, truth.deformation, gate);
            findings.report("D in the box", steady.deformation, truth.deformation, truth.deformation);
            let angle = steady.angle + angle_free - angle_boxed;
            findings.check_scaled("inclination (degrees)", angle, truth.angle, 1.0, 1.0);
            findings.report("width", steady.width, truth.width, truth.width);
            findings.report(
                "change of D in the last strain unit",
                steady.drift,
                0.0,
                truth.deformation,
            );
            if let (Some(period), Some(exact)) = (steady.period, truth.period) {
                let [boxed, free] = unbounded(BOXES, [small.period.unwrap_or(period), large.period.unwrap_or(period)]);
                findings.check("tank-treading period", period * free / boxed, exact, 0.03);
                findings.report("tank-treading period in the box", period, exact, exact);
            }
        }
        let boxed = |radius: f64| {
            let mut same = all
                .iter()
                .filter(|(j, _)| j.truth == number && j.size == BOXES[0] && j.bending == 0.0);
            same.find(|(j, _)| j.radius == radius).map(|(_, (s, _))| s.deformation)
        };
        if let [Some(fine), Some(middle), Some(coarse)] = FINER.map(boxed) {
            findings.begin_done(row(truth, FINER[0]), 0.0);
            let order = ((coarse - middle) / (middle - fine)).abs().log2();
            findings.report("order in h", order, 2.0, 2.0);
            let limit = fine + (fine - middle) / 3.0;
            let exact = truth.deformation;
            findings.report(
                "D extrapolated by second order",
                limit * free / small.deformation,
                exact,
                exact,
            );
        }
    }
    Ok(findings)
}

fn row(truth: &Truth, radius: f64) -> BTreeMap<String, String> {
    key(&[
        ("law", truth.law.clone()),
        ("Ca", truth.capillary.to_string()),
        ("R_over_h", radius.to_string()),
    ])
}

/// A capsule in shear for 100 strain units (10 in a quick run): its volume drifts by less than 0.1 % held, and by less than 1 %
/// free. What is left is the time step's: nodes step along the tangents of their paths.
pub fn capsule_volume(effort: Effort) -> Outcome {
    let mut findings = Findings::of("capsule_volume");
    let strain = if effort.quick { 10.0 } else { 100.0 };
    let found = side_by_side(&[true, false], |&holds_volume| {
        let capsule = Capsule {
            holds_volume,
            nodes: 642,
            strain_per_step: 2.5e-4,
            ..capsule(Material::NeoHookean, 0.1, 1.0, 4.0, 6.0)
        };
        let mut sheared = capsule.sheared()?;
        let start = sheared.volume();
        let mut drift = 0.0_f64;
        for n in 1..=20 {
            sheared.run_to(strain * f64::from(n) / 20.0)?;
            drift = drift.max((sheared.volume() / start - 1.0).abs());
        }
        Ok(drift)
    })?;
    for ((name, gate), (drift, seconds)) in [("held", 1e-3), ("free", 1e-2)].into_iter().zip(found) {
        findings.begin_done(
            key(&[("volume", name.to_owned()), ("strain", strain.to_string())]),
            seconds,
        );
        findings.check_scaled("greatest volume drift", drift, 0.0, 1.0, gate);
    }
    Ok(findings)
}
