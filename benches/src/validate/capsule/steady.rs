//! The steady shape of a capsule in an unbounded shear flow.

use super::Material;
use super::scene::{Capsule, Sheared};
use crate::Fault;
use crate::reference::Row;
use lbm_ibm::coupling::Elasticity;
use lbm_ibm::ibm::Kernel;
use std::collections::BTreeMap;

/// Kernel of capsules of one viscosity: at Ca 0.6 D is 1 % closer than with three points, at 8 spacings a radius.
const KERNEL: Kernel = Kernel::TwoPoint;
/// Kernel of those with another viscosity inside: at 5 spacings and twice the viscosity the inclination is 0.5 degrees closer than
/// with two points, where the nodes lie not as deep.
const CONTRAST_KERNEL: Kernel = Kernel::RomaThree;
/// Shapes that are averaged over the last strain unit.
const SAMPLES: usize = 5;

/// What a run gives.
#[derive(Clone, Copy, Default)]
pub struct Steady {
    pub deformation: f64,
    /// Degrees.
    pub angle: f64,
    /// Semi-axis along the vorticity, in radii.
    pub width: f64,
    /// Change of the deformation over the last strain unit.
    pub drift: f64,
    /// Tank-treading period times the shear rate, where it was asked for.
    pub period: Option<f64>,
    /// Greatest relative error of the volume of the fluid inside.
    pub inside: f64,
}

/// Runs a capsule to the strain `settled` and one more, and where it is asked for half a turn, or a whole one with another
/// viscosity inside.
///
/// # Errors
/// What the scene finds.
pub fn steady(capsule: &Capsule, settled: f64, with_period: bool) -> Result<Steady, Fault> {
    settle(&mut capsule.sheared()?, settled, with_period)
}

/// The same with a capsule that has been put into its flow.
///
/// # Errors
/// What the scene finds.
pub fn settle(sheared: &mut Sheared, settled: f64, with_period: bool) -> Result<Steady, Fault> {
    sheared.run_to(settled)?;
    let mut found = Steady::default();
    let before = sheared.shape().deformation();
    for n in 1..=SAMPLES {
        sheared.run_to(settled + n as f64 / SAMPLES as f64)?;
        let shape = sheared.shape();
        found.deformation += shape.deformation() / SAMPLES as f64;
        found.angle += shape.angle / SAMPLES as f64;
        found.width += shape.width * sheared.scale / sheared.radius / SAMPLES as f64;
        found.inside = found.inside.max(sheared.inside_error().abs());
    }
    found.drift = sheared.shape().deformation() - before;
    if with_period {
        let (half, inside) = sheared.half_turn()?;
        found.period = Some(2.0 * half);
        found.inside = found.inside.max(inside);
        if sheared.ratio != 1.0 {
            let (half, inside) = sheared.half_turn()?;
            found.period = found.period.map(|first| 0.5 * first + half);
            found.inside = found.inside.max(inside);
        }
    }
    Ok(found)
}

/// What a quantity would be in an unbounded flow, by its values in two boxes of so many radii: what a box does falls off with
/// the cube of its size. Returned as the value in the smaller box and the one without a box.
pub fn unbounded(boxes: [f64; 2], values: [f64; 2]) -> [f64; 2] {
    let [small, large] = boxes.map(|b| b.powi(-3));
    [values[0], values[1] + (values[1] - values[0]) * large / (small - large)]
}

/// A capsule of so many spacings a radius, in a box of so many radii.
pub fn capsule(material: Material, capillary: f64, ratio: f64, radius: f64, size: f64) -> Capsule {
    let kernel = if ratio == 1.0 { KERNEL } else { CONTRAST_KERNEL };
    Capsule {
        material,
        bending: 0.0,
        capillary,
        radius,
        axes: [1.0; 3],
        angle: 0.0,
        size: [size; 3],
        // The pressure in the capsule is that of the viscosity times the rate over the capillary number, and the fluid yields
        // to it a little.
        strain_per_step: 1e-3_f64.min(0.01 * capillary),
        tau: if ratio != 1.0 { 1.5 } else { 3.0 },
        ratio,
        // With half as many, D is 0.3 % lower at 8 spacings.
        nodes: if radius > 12.0 {
            10_242
        } else if radius > 7.0 {
            2562
        } else {
            1280
        },
        kernel,
        inset: kernel.hydrodynamic_shift(),
        slip: false,
        holds_volume: true,
        elasticity: Elasticity::Explicit,
    }
}

/// The material that a row names.
///
/// # Errors
/// The row names none that is known.
pub fn material(row: &Row) -> Result<Material, Fault> {
    Ok(match row.text("law")? {
        "NH" => Material::NeoHookean,
        "SK" => Material::Skalak(row.number("C")?),
        _ => return Err(row.unknown("law").into()),
    })
}

/// A key of the pairs.
pub fn key(pairs: &[(&str, String)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(k, v)| ((*k).to_owned(), v.clone())).collect()
}
