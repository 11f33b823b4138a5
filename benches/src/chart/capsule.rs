//! A capsule in shear: mesh, kernel, depth of the nodes, time step, explicit and implicit forces, and resolution.

use super::{Chart, Row, Work, seconds_per_call};
use crate::Fault;
use crate::reference::Table;
use crate::scenes::side_by_side;
use crate::validate::capsule::Material;
use crate::validate::capsule::scene::{Capsule, Sheared};
use crate::validate::capsule::steady::{Steady, capsule, settle, unbounded};
use lbm_ibm::coupling::Elasticity;
use lbm_ibm::ibm::Kernel;

/// Capillary number of the neo-Hookean capsule: its membrane is in tension everywhere and does not wrinkle, which one without
/// bending stiffness does at a tenth.
const CAPILLARY: f64 = 0.6;
/// Strain at which it is settled; its shape is averaged over one unit more.
const SETTLED: f64 = 9.0;
/// Nodes and step (as strain) of all curves but those that change them.
const NODES: usize = 642;
const STEP: f64 = 4e-3;
/// No error is given as less: what is left of the start, of the box and in the reference.
const LEAST: f64 = 5e-4;

/// Edges of the boxes, in radii: the smaller one of all points, and one more to find out what it does.
const BOXES: [f64; 2] = [8.0, 12.0];

/// A capsule of so many spacings, as the other curves vary it.
fn base(radius: f64) -> Capsule {
    let kernel = Kernel::RomaThree;
    Capsule {
        nodes: NODES,
        strain_per_step: STEP,
        kernel,
        inset: kernel.hydrodynamic_shift(),
        ..capsule(Material::NeoHookean, CAPILLARY, 1.0, radius, BOXES[0])
    }
}

/// With another kernel, its shift corrected.
fn with_kernel(kernel: Kernel, radius: f64) -> Capsule {
    Capsule {
        kernel,
        inset: kernel.hydrodynamic_shift(),
        ..base(radius)
    }
}

/// With nodes on the surface that slip.
fn slipping(kernel: Kernel, radius: f64) -> Capsule {
    Capsule {
        kernel,
        inset: 0.0,
        slip: true,
        ..base(radius)
    }
}

/// With another step, as strain.
fn with_step(strain_per_step: f64, elasticity: Elasticity, radius: f64) -> Capsule {
    Capsule {
        strain_per_step,
        elasticity,
        ..base(radius)
    }
}

/// A curve: its name, the radii of its points in spacings, and the capsule of a radius.
type Curve = (&'static str, &'static [f64], fn(f64) -> Capsule);

const EXPLICIT: Elasticity = Elasticity::Explicit;
const IMPLICIT: Elasticity = Elasticity::IMPLICIT;

const CURVES: &[Curve] = &[
    ("Roma, 642 nodes, step 4e-3", &[4.0, 6.0, 8.0], base),
    ("2 points", &[4.0, 6.0], |r| with_kernel(Kernel::TwoPoint, r)),
    ("4 points, Peskin", &[4.0, 6.0], |r| with_kernel(Kernel::PeskinFour, r)),
    ("6 points", &[4.0, 6.0], |r| with_kernel(Kernel::SixPoint, r)),
    ("Roma, nodes on the surface", &[4.0, 6.0], |r| Capsule {
        inset: 0.0,
        ..base(r)
    }),
    ("Roma, slip", &[4.0, 6.0, 8.0], |r| slipping(Kernel::RomaThree, r)),
    ("2 points, slip", &[4.0, 6.0], |r| slipping(Kernel::TwoPoint, r)),
    ("162 nodes", &[4.0, 6.0], |r| Capsule { nodes: 162, ..base(r) }),
    ("2562 nodes", &[4.0, 6.0], |r| Capsule { nodes: 2562, ..base(r) }),
    ("tau 1", &[4.0, 6.0], |r| Capsule { tau: 1.0, ..base(r) }),
    ("step 1e-3", &[4.0], |r| with_step(1e-3, EXPLICIT, r)),
    ("step 8e-3", &[4.0, 6.0, 8.0], |r| with_step(8e-3, EXPLICIT, r)),
    ("step 4e-3, implicit", &[4.0, 6.0], |r| with_step(4e-3, IMPLICIT, r)),
    ("step 8e-3, implicit", &[4.0, 6.0], |r| with_step(8e-3, IMPLICIT, r)),
];
/// Radii of a quick run.
const QUICK: f64 = 4.0;
/// Radius in spacings at which it is found out what the box does.
const BOXED: f64 = 4.0;

/// The deformation of a capsule.
pub const CAPSULE: Chart = Chart {
    name: "capsule",
    title: "Deformation of a neo-Hookean capsule in shear, Ca 0.6",
    cost: "cost of a unit of strain, s",
    error: "relative error of the deformation",
    advice: "The grid first: the error falls with the first order of the spacing, 9 % at 4 to the radius, 3.7 % at 8. Then the narrowest \
              kernel, and the longest step that the fluid bears; relaxation time and mesh (from 642 nodes on) do not matter, and \
              implicit forces only cost, the membrane being soft.",
    cases: deformations,
};

/// A capsule that has been sheared, and what it has become.
struct Done {
    curve: &'static str,
    radius: f64,
    step: f64,
    sheared: Sheared,
    steady: Steady,
}

impl Done {
    /// Nodes of grid and mesh that a step goes over, over the strain of a step.
    fn updates(&self) -> f64 {
        let scene = &self.sheared.scene;
        let grid = scene.fluid().map_or(0, |f| f.grid().len());
        (grid + scene.positions().len()) as f64 / self.step
    }
}

fn deformations(quick: bool) -> Result<Vec<Row>, Fault> {
    let table = Table::read(&Table::own_folder(), "capsule_shear")?;
    let mut exact = f64::NAN;
    // The last of its rows is the finest.
    for row in table.rows() {
        if row.text("law")? == "NH" && row.number("Ca")? == CAPILLARY {
            exact = row.number("D")?;
        }
    }
    let in_box = |size: f64| -> Result<Capsule, Fault> {
        Ok(Capsule {
            size: [size; 3],
            ..base(BOXED)
        })
    };
    let mut jobs = vec![("", in_box(BOXES[1])?), ("", in_box(BOXES[0])?)];
    for (curve, radii, of) in CURVES {
        let radii = radii.iter().filter(|r| !quick || **r <= QUICK);
        jobs.extend(radii.map(|&r| (*curve, of(r))));
    }
    // The longest first.
    let length = |c: &Capsule| (c.radius * c.size[0]).powi(3) / c.strain_per_step;
    jobs.sort_by(|(_, a), (_, b)| length(b).total_cmp(&length(a)));
    let done = side_by_side(&jobs, |(curve, capsule)| {
        let mut sheared = capsule.sheared()?;
        let at = |e| format!("{curve}, radius {}: {e}", capsule.radius);
        let steady = settle(&mut sheared, if quick { 0.2 } else { SETTLED }, false).map_err(at)?;
        Ok(Done {
            curve,
            radius: capsule.radius,
            step: capsule.strain_per_step,
            sheared,
            steady,
        })
    })?;
    let (boxes, mut done): (Vec<_>, Vec<_>) = done.into_iter().map(|(d, _)| d).partition(|d| d.curve.is_empty());
    // The larger box takes longer and comes first.
    let [large, small] = [0, 1].map(|i| boxes.get(i).map_or(f64::NAN, |d| d.steady.deformation));
    let [boxed, free] = unbounded(BOXES, [small, large]);
    let position = |d: &Done| CURVES.iter().position(|(name, ..)| *name == d.curve);
    done.sort_by(|a, b| position(a).cmp(&position(b)).then(a.radius.total_cmp(&b.radius)));

    let updates: Vec<f64> = done.iter().map(Done::updates).collect();
    let mut works: Vec<Work> = Vec::new();
    for d in &mut done {
        // An even and an odd step.
        works.push(Box::new(|| {
            d.sheared.scene.step()?;
            Ok(d.sheared.scene.step()?)
        }));
    }
    let pairs = seconds_per_call(quick, &mut works)?;
    drop(works);
    let rows = done.iter().zip(pairs).zip(updates).map(|((d, pair), updates)| Row {
        case: String::new(),
        curve: d.curve.into(),
        label: format!("{} spacings", d.radius),
        cost_s: 0.5 * pair / d.step,
        updates: updates.round(),
        error: (d.steady.deformation * free / boxed / exact - 1.0).abs().max(LEAST),
    });
    Ok(rows.collect())
}
