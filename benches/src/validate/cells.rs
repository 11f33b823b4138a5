//! A cell in a scene: its volume on a long way, and the same bits on any number of threads.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::scenes::{channel, on_threads, slit};
use lbm_ibm::coupling::{Scene, Soa3, UM, enclosed_volume};
use lbm_ibm::membrane::{Cell, Form, Moduli, presets};
use std::collections::BTreeMap;

fn key(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), (*v).to_owned())).collect()
}

/// Volume drift on a way.
struct Travel {
    /// Way of the centroid, m.
    distance: f64,
    /// Greatest relative change of the volume.
    drift: f64,
    /// Relative change at the end.
    end: f64,
}

/// Carries the first body of a scene over `distance` (m) along x.
fn travel(scene: &mut Scene, distance: f64) -> Result<Travel, Fault> {
    let triangles = scene.bodies()[0].triangles.clone();
    let volume = |scene: &Scene| enclosed_volume(scene.positions(), &triangles);
    let (start, rest) = (scene.positions().mean().x, volume(scene));
    let mut way = Travel {
        distance: 0.0,
        drift: 0.0,
        end: 0.0,
    };
    while way.distance < distance {
        for _ in 0..20 {
            scene.step()?;
        }
        way.distance = scene.positions().mean().x - start;
        way.end = volume(scene) / rest - 1.0;
        way.drift = way.drift.max(way.end.abs());
    }
    Ok(way)
}

/// The paper's cells carried along a channel over 50 diameters: the volume drifts by less than 0.5 % with the paper's
/// volume modulus; without one the drift is reported.
pub fn free_cell(effort: Effort) -> Outcome {
    let mut findings = Findings::of("free_cell");
    // The law refuses a modulus of zero.
    let soft = |moduli: Moduli| Moduli {
        volume: f64::MIN_POSITIVE,
        ..moduli
    };
    let form = Form::Corrected;
    let (rbc, ctc) = (presets::rbc_paper(form)?, presets::ctc_paper(form)?);
    let rbc_soft = soft(Moduli::RBC_PAPER).cell("rbc", rbc.mesh().clone(), form)?;
    let ctc_soft = soft(Moduli::CTC_PAPER).cell("ctc", ctc.mesh().clone(), form)?;
    let rows: [(&str, &str, Cell, f64, f64); 6] = [
        ("rbc", "corrected", rbc, 8.0 * UM, 1.0 * UM),
        ("rbc", "2011", presets::rbc_paper(Form::Paper2011)?, 8.0 * UM, 1.0 * UM),
        ("rbc", "no K_V", rbc_soft, 8.0 * UM, 1.0 * UM),
        ("ctc", "corrected", ctc, 16.0 * UM, 2.0 * UM),
        ("ctc", "2011", presets::ctc_paper(Form::Paper2011)?, 16.0 * UM, 2.0 * UM),
        ("ctc", "no K_V", ctc_soft, 16.0 * UM, 2.0 * UM),
    ];
    for (name, form, cell, diameter, spacing) in rows {
        findings.begin(key(&[("cell", name), ("form", form)]));
        let mut scene = channel(cell, diameter, spacing, 40.0)?;
        let way = travel(&mut scene, 50.0 * diameter)?;
        if form == "no K_V" {
            findings.report("greatest volume drift", way.drift, 0.0, 1.0);
        } else {
            findings.check_scaled("greatest volume drift", way.drift, 0.0, 1.0, 5e-3);
        }
        findings.report("volume drift at the end", way.end, 0.0, 1.0);
        findings.report("way in diameters", way.distance / diameter, 50.0, 50.0);
        findings.report("steps", scene.steps() as f64, 0.0, 1.0);
    }
    let _ = effort;
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
