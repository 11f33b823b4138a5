//! A cell in a scene: its volume on a long way, and the same bits on any number of threads.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::scenes::{channel, on_threads, side_by_side, slit};
use lbm_ibm::coupling::{ImmersedBody, Scene, Soa3, UM, US, enclosed_volume};
use lbm_ibm::membrane::{Cell, Form, Moduli, presets};
use std::collections::BTreeMap;

fn key(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect()
}

/// Volume drift on a way.
#[derive(Default)]
struct Travel {
    /// Way of the centroid, m.
    distance: f64,
    /// Greatest relative change of the volume.
    drift: f64,
    /// Relative change at the end.
    end: f64,
}

/// Carries the first body of a scene over `distance` (m) along x, or as far as the guard lets it.
fn travel(scene: &mut Scene, distance: f64) -> Travel {
    let triangles = scene.bodies()[0].triangles.clone();
    let volume = |scene: &Scene| enclosed_volume(scene.positions(), &triangles);
    let (start, rest) = (scene.positions().mean().x, volume(scene));
    let mut way = Travel::default();
    while way.distance < distance {
        if (0..20).any(|_| scene.step().is_err()) {
            break;
        }
        way.distance = scene.positions().mean().x - start;
        way.end = volume(scene) / rest - 1.0;
        way.drift = way.drift.max(way.end.abs());
    }
    way
}

/// A cell to be carried, and how: lengths in m, time step in s.
struct Ride {
    cell: Cell,
    diameter: f64,
    spacing: f64,
    time_step: f64,
    /// Factor on the density.
    scale: f64,
}

/// The paper's cells carried along a channel over 50 diameters (10 in a quick run): the volume drifts by less than 0.5 %
/// with the paper's laws. Without a volume modulus, and with the corrected laws, drift and way are reported.
pub fn free_cell(effort: Effort) -> Outcome {
    let mut findings = Findings::of("free_cell");
    let diameters = if effort.quick { 10.0 } else { 50.0 };
    let rbc = |cell: Cell| Ride {
        cell,
        diameter: 8.0 * UM,
        spacing: UM,
        time_step: 5.0 * US,
        scale: 100.0,
    };
    let ctc = |cell: Cell| Ride {
        cell,
        diameter: presets::CTC_DIAMETER,
        spacing: 2.0 * UM,
        time_step: 17.0 * US,
        scale: 40.0,
    };
    // The law refuses a modulus of zero.
    let no_volume = |cell: Cell, moduli: Moduli| {
        let moduli = Moduli {
            volume: f64::MIN_POSITIVE,
            ..moduli
        };
        moduli.cell(cell.kind(), cell.mesh().clone(), Form::Paper2011Balanced)
    };
    let (red, tumour) = (presets::rbc_paper, presets::ctc_paper);
    let form = Form::Paper2011Balanced;
    let rows = [
        ("2011 balanced", rbc(red(form)?)),
        ("no K_V", rbc(no_volume(red(form)?, Moduli::RBC_PAPER)?)),
        ("2011", ctc(tumour(Form::Paper2011)?)),
        ("2011 balanced", ctc(tumour(form)?)),
        ("corrected", ctc(tumour(Form::Corrected)?)),
        ("no K_V", ctc(no_volume(tumour(form)?, Moduli::CTC_PAPER)?)),
    ];
    let ways = side_by_side(&rows, |(_, ride)| {
        let mut scene = channel(
            ride.cell.clone(),
            ride.diameter,
            ride.spacing,
            ride.time_step,
            ride.scale,
        )?;
        Ok((travel(&mut scene, diameters * ride.diameter), scene.steps()))
    })?;
    for ((form, ride), ((way, steps), seconds)) in rows.iter().zip(ways) {
        let row = [
            ("cell", ride.cell.kind()),
            ("form", form),
            ("diameters", &diameters.to_string()),
        ];
        findings.begin_done(key(&row), seconds);
        let travelled = way.distance / ride.diameter;
        if form.starts_with("2011") {
            findings.check_scaled("greatest volume drift", way.drift, 0.0, 1.0, 5e-3);
            findings.check_at_least("way in diameters", travelled, diameters);
        } else {
            findings.report("greatest volume drift", way.drift, 0.0, 1.0);
            findings.report("way in diameters", travelled, diameters, diameters);
        }
        findings.report("volume drift at the end", way.end, 0.0, 1.0);
        findings.report("steps", steps as f64, 0.0, 1.0);
    }
    Ok(findings)
}

/// A tumour cell in a slit after 300 steps on 1, 2 and 3 threads: no coordinate differs in any bit.
pub fn same_bits(_effort: Effort) -> Outcome {
    let mut findings = Findings::of("same_bits");
    let positions = |threads: usize| -> Result<Soa3, Fault> {
        on_threads(threads, || {
            let mut scene = slit()?;
            for _ in 0..300 {
                scene.step()?;
            }
            Ok(scene.positions().iter().collect())
        })
    };
    findings.begin(key(&[("threads", "1")]));
    let one = positions(1)?;
    for threads in [2, 3] {
        findings.begin(key(&[("threads", &threads.to_string())]));
        let other = positions(threads)?;
        let differ = |a: &[f64], b: &[f64]| a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits()).count();
        let count = differ(&one.x, &other.x) + differ(&one.y, &other.y) + differ(&one.z, &other.z);
        findings.check_scaled("coordinates that differ", count as f64, 0.0, 1.0, 0.0);
    }
    Ok(findings)
}
