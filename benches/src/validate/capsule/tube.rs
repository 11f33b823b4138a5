//! Capsules driven along the axis of a tube, against the axisymmetric boundary integral.

use super::Material;
use super::steady::key;
use super::tube_scene::{Settled, Tube};
use crate::Fault;
use crate::reference::{Row, Table};
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Row of a quick run: law, radius over the tube's, capillary number.
const QUICK: (&str, f64, f64) = ("SK", 0.8, 0.05);
/// Rows that are run in full.
const FULL: &[(&str, f64, f64)] = &[
    ("SK", 0.8, 0.02),
    ("SK", 0.8, 0.05),
    ("NH", 0.8, 0.02),
    ("NH", 0.8, 0.05),
    ("SK", 0.9, 0.05),
    ("SK", 0.9, 0.1),
    ("NH", 0.9, 0.05),
    ("SK", 1.1, 0.05),
    ("SK", 1.1, 0.1),
];

/// Ratio of the radii above which a tube is tight.
const TIGHT: f64 = 0.85;

/// Ratio above which a capsule is so compressed along the hoops that a membrane without bending folds.
const FOLDING: f64 = 1.0;
/// Stiffness of hinges over shear modulus times radius squared, and spacings to the tube's radius, of one more run of such a capsule:
/// without hinges folds are as short as the mesh lets them and hardly show, weak hinges make them long enough to be seen.
const HINGES: (f64, f64) = (0.002, 20.0);
/// Departure of the widest ring from a circle over the tube's radius, with those hinges, from which on it is folded.
const FOLDED: f64 = 0.01;

/// Runs that are done: the two cases are about the same ones.
static DONE: Mutex<Vec<(Tube, Settled, f64)>> = Mutex::new(Vec::new());

/// The run of a row, where it is wanted.
fn tube(row: &Row, effort: Effort) -> Result<Option<Tube>, Fault> {
    let (law, ratio, capillary) = (row.text("law")?, row.number("a_over_R")?, row.number("Ca")?);
    let material = match law {
        "NH" => Material::NeoHookean,
        "SK" => Material::Skalak(1.0),
        _ => return Err(row.unknown("law").into()),
    };
    let wanted = if effort.quick {
        (law, ratio, capillary) == QUICK
    } else {
        FULL.contains(&(law, ratio, capillary))
    };
    let (cells, step) = match effort.quick {
        true => (16.0, 0.015),
        false if ratio > FOLDING => (32.0, 0.011),
        false if ratio > TIGHT => (24.0, 0.0075),
        false => (20.0, 0.012),
    };
    Ok(wanted.then_some(Tube {
        material,
        ratio,
        capillary,
        bending: 0.0,
        cells,
        length: if ratio > 1.0 { 5.0 } else { 3.5 },
        step: step * capillary,
        slip: ratio <= FOLDING,
    }))
}

impl Tube {
    /// The run that tells whether it folds, where that is to be asked.
    fn hinged(&self) -> Option<Self> {
        let (bending, cells) = HINGES;
        (self.ratio > FOLDING).then_some(Self {
            bending,
            cells,
            ..*self
        })
    }
}

/// Departure of the widest ring from a circle over the tube's radius of each tube with weak hinges; zero where it is not asked for.
fn folds(tubes: &[Tube]) -> Result<Vec<f64>, Fault> {
    let hinged: Vec<Tube> = tubes.iter().filter_map(Tube::hinged).collect();
    let mut found = settle(&hinged)?.into_iter();
    let fold = |t: &Tube| t.hinged().and_then(|_| found.next()).map_or(0.0, |f| f.0.meridian.fold);
    Ok(tubes.iter().map(fold).collect())
}

/// Runs those that are not done yet; results in the order of the list.
fn settle(tubes: &[Tube]) -> Result<Vec<(Settled, f64)>, Fault> {
    let mut done = DONE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut new = tubes.to_vec();
    new.retain(|t| !done.iter().any(|d| d.0 == *t));
    // The longest first.
    new.sort_by(|a, b| (b.ratio / b.step).total_cmp(&(a.ratio / a.step)));
    let found = side_by_side(&new, Tube::settle)?;
    done.extend(
        new.into_iter()
            .zip(found)
            .map(|(tube, (settled, seconds))| (tube, settled, seconds)),
    );
    let of = |t: &Tube| done.iter().find(|d| d.0 == *t).map(|d| (d.1.clone(), d.2));
    Ok(tubes.iter().filter_map(of).collect())
}

fn name(row: &Row, tube: &Tube) -> BTreeMap<String, String> {
    let mut name = row.key(&["law", "a_over_R", "Ca"]);
    name.extend(key(&[("R_over_h", tube.cells.to_string())]));
    name
}

/// A spherical capsule on the axis of a tube at fixed flux: its velocity within 1 %, extra pressure and film within 3 % at
/// a/R = 0.8, all within 5 % in a narrower tube. The tube's radius is the one that its empty flow has. A membrane that is
/// compressed along the hoops folds, since it has no bending stiffness: at a/R = 1.1 one with weak hinges, on a coarser grid, tells.
pub fn capsule_tube(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let mut rows = Vec::new();
    for row in table.rows() {
        match tube(row, effort)? {
            Some(tube) => rows.push((row, tube)),
            None => findings.left_out += 1,
        }
    }
    let tubes: Vec<Tube> = rows.iter().map(|(_, tube)| *tube).collect();
    let folds = folds(&tubes)?;
    for (((row, tube), (settled, seconds)), fold) in rows.iter().zip(settle(&tubes)?).zip(folds) {
        findings.begin_done(name(row, tube), seconds);
        let gates = if tube.ratio > TIGHT {
            [0.05; 3]
        } else {
            [0.01, 0.03, 0.03]
        };
        let film = row.number("film_over_R")?;
        let length = row.number("L_over_R")?;
        findings.check("U_ratio", settled.velocity, row.number("U_ratio")?, gates[0]);
        let pressure = row.number("dP_extra_R_over_muU")?;
        findings.check("dP_extra_R_over_muU", settled.pressure, pressure, gates[1]);
        findings.check("film_over_R", settled.meridian.film, film, gates[2]);
        findings.report("L_over_R", settled.meridian.length, length, length);
        findings.report("film in spacings", settled.meridian.film * tube.cells, 2.0, 2.0);
        findings.report("fold of the widest ring over R", settled.meridian.fold, 0.0, 1.0);
        if tube.hinged().is_some() {
            findings.report("the same with weak hinges", fold, 0.0, 1.0);
        }
        findings.report("tube's radius over its own", settled.tube_radius, 1.0, 1.0);
        findings.report("change of U_ratio at the end", settled.drift[0], 0.0, 1.0);
        findings.report("change of dP at the end", settled.drift[1], 0.0, 1.0);
        let steady = match &settled.ended_by {
            Some(fault) => format!("steady: {fault}"),
            None => "steady".to_owned(),
        };
        findings.check(&steady, f64::from(u8::from(settled.is_steady())), 1.0, 0.0);
        findings.report("radii gone by the mean flow", settled.way, settled.way, 1.0);
    }
    Ok(findings)
}

/// The surfaces of the runs of [`capsule_tube`] against the file's meridians: normal distance over the tube's radius, 1 % in
/// the mean square; the largest is reported. A folded surface is none of revolution: where weak hinges show that it folds, as at
/// a/R = 1.1, the distance is reported only.
pub fn capsule_tube_profile(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let mut rows: Vec<(&Row, Tube, Vec<[f64; 2]>)> = Vec::new();
    for row in table.rows() {
        let Some(tube) = tube(row, effort)? else {
            findings.left_out += 1;
            continue;
        };
        let point = [row.number("z_over_R")?, row.number("r_over_R")?];
        match rows.iter_mut().find(|r| r.1 == tube) {
            Some((_, _, line)) => line.push(point),
            None => rows.push((row, tube, vec![point])),
        }
    }
    let tubes: Vec<Tube> = rows.iter().map(|r| r.1).collect();
    let folds = folds(&tubes)?;
    for (((row, tube, line), (settled, seconds)), fold) in rows.iter().zip(settle(&tubes)?).zip(folds) {
        findings.begin_done(name(row, tube), seconds);
        let distance = settled.meridian.distance(line);
        if fold < FOLDED {
            findings.check_scaled("rms distance over R", distance.rms, 0.0, 1.0, 0.01);
        } else {
            findings.report("rms distance over R, folded", distance.rms, 0.0, 1.0);
        }
        findings.report("largest distance over R", distance.largest, 0.0, 1.0);
    }
    Ok(findings)
}
