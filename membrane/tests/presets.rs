//! Presets: at rest where they say so, calibrated as they say.

use lbm_ibm_coupling::{ImmersedBody, Soa3, enclosed_volume};
use lbm_ibm_membrane::laws::CorticalTension;
use lbm_ibm_membrane::presets::{self, Preset};
use lbm_ibm_membrane::stretch::{Load, Patch, Stretch, pull};
use lbm_ibm_membrane::{Material, MembraneError, Modulus, Sheet};

/// Force; bar of the axial diameter; mean and curve of the transverse one, its bar.
type Row = (f64, [f64; 2], f64, f64, [f64; 2]);

/// Force (pN); bar of the axial diameter; mean of the transverse one, that of the reference curve, its bar (um):
/// optical tweezers (Mills et al. 2004, Suresh et al. 2005, digitised by the authors of HemoCell).
const TWEEZERS: [Row; 12] = [
    (
        16.0,
        [8.3522167, 10.09688],
        6.1970443,
        7.1195964,
        [5.5812808, 6.8128079],
    ),
    (
        19.5,
        [8.7010494, 10.445813],
        6.2791461,
        6.9606037,
        [5.6428571, 6.9154351],
    ),
    (
        31.0,
        [9.6247947, 11.389984],
        5.7249589,
        6.5705119,
        [5.1297209, 6.320197],
    ),
    (
        38.0,
        [10.076355, 12.293103],
        5.4376026,
        6.3190579,
        [4.8218391, 5.9917898],
    ),
    (
        47.0,
        [10.815272, 12.970443],
        5.0681445,
        6.0564906,
        [4.2881773, 5.8275862],
    ),
    (67.5, [11.882594, 13.873563], 4.63711, 5.5087119, [3.9392447, 5.3555008]),
    (87.6, [12.58046, 14.981938], 4.63711, 4.980475, [4.000821, 5.273399]),
    (
        108.5,
        [12.867816, 15.823481],
        4.5960591,
        4.5657066,
        [3.9802956, 5.2323481],
    ),
    (
        130.0,
        [13.894089, 16.623974],
        4.5344828,
        4.4479135,
        [3.8776683, 5.1912972],
    ),
    (
        151.0,
        [14.42775, 16.870279],
        4.3497537,
        4.3710546,
        [3.7750411, 4.9860427],
    ),
    (
        172.8,
        [14.263547, 17.876026],
        4.5960591,
        4.2748173,
        [4.0829228, 5.047619],
    ),
    (
        193.0,
        [14.489327, 18.019704],
        4.3908046,
        4.2098654,
        [3.7545156, 4.9449918],
    ),
];

#[test]
fn the_red_cell_is_inside_the_tweezers_bars() -> Result<(), MembraneError> {
    let cell = presets::RED_CELL.with_nodes(400).cell()?;
    let beads = Load::Beads(Patch::Chord(2e-6).ends(cell.reference())?);
    let mut stretch = Stretch::new(cell, beads).with_tolerance(1e-16);
    for (force, [low, high], mean, curve, [least, most]) in TWEEZERS {
        let shape = stretch.pull(force * 1e-12)?;
        let (axial, transverse) = (shape.axial * 1e6, shape.transverse * 1e6);
        println!("{force} pN: {axial:.2}, {transverse:.2} um");
        assert!(low < axial && axial < high, "{force} pN: {axial:.2} um");
        if force > 87.0 {
            assert!(
                least < transverse && transverse < most,
                "{force} pN: {transverse:.2} um"
            );
        } else {
            assert!(
                (transverse - mean).abs() <= (curve - mean).abs(),
                "{force} pN: {transverse:.2} um"
            );
        }
        assert!(
            (shape.area_ratio - 1.0).abs() < 4e-3 && (shape.volume_ratio - 1.0).abs() < 3e-3,
            "{shape:?}"
        );
    }
    Ok(())
}

/// Strain of a preset on a mesh of 306 nodes at the paper's force.
fn strain(preset: &Preset, stretcher: bool) -> Result<f64, MembraneError> {
    let cell = preset.cell()?;
    let load = if stretcher {
        Load::CosineSquared
    } else {
        Load::Ends(Patch::Fraction(0.05).ends(cell.reference())?)
    };
    Ok(pull(&cell, load, presets::PAPER_FORCE)?.axial / presets::CTC_DIAMETER - 1.0)
}

#[test]
fn breast_cells_stretch_as_they_were_calibrated() -> Result<(), MembraneError> {
    let pairs = [
        (presets::MCF10, presets::MCF10_STRETCHER, 0.105),
        (presets::MCF7, presets::MCF7_STRETCHER, 0.21),
        (presets::MOD_MCF7, presets::MOD_MCF7_STRETCHER, 0.3),
    ];
    for (patches, stretcher, wanted) in pairs {
        let (ends, stress) = (strain(&patches, false)?, strain(&stretcher, true)?);
        let swapped = strain(&patches, true)?;
        println!(
            "{}: {ends:.4} at the ends, {stress:.4} by stress, {swapped:.4} by stress with the moduli of the ends; shear moduli {:.2} and {:.2} uN/m",
            patches.kind,
            patches.material.shear * 1e6,
            stretcher.material.shear * 1e6
        );
        assert!((ends - wanted).abs() < 1e-3 && (stress - wanted).abs() < 1e-3);
        // The same force on two patches strains a cell far more than spread over its surface.
        assert!(swapped < 0.5 * wanted);
    }
    Ok(())
}

#[test]
fn the_stress_of_a_stretcher_pulls_each_half_by_its_force() -> Result<(), MembraneError> {
    // The sum over a half of s0 cos^2 n_x over a sphere is s0 pi R^2/2.
    let (force, radius) = (80e-12, 8e-6);
    let peak = Load::peak_stress(force, radius);
    let n = 20_000;
    let half: f64 = (0..n)
        .map(|k| {
            let c = (k as f64 + 0.5) / n as f64;
            peak * c * c * c * 2.0 * std::f64::consts::PI * radius * radius / n as f64
        })
        .sum();
    assert!((half / force - 1.0).abs() < 1e-6);
    Ok(())
}

#[test]
fn every_preset_is_a_cell_at_rest() -> Result<(), MembraneError> {
    let all = [
        presets::RED_CELL,
        presets::MCF10,
        presets::NEUTROPHIL,
        presets::LYMPHOCYTE,
        presets::PLATELET,
        presets::CAPSULE,
    ];
    for preset in all {
        let mut cell = preset.cell()?;
        let q = cell.mesh().quality();
        assert!(q.least_angle.to_degrees() > 25.0, "{}: {q}", preset.kind);
        let forces = |cell: &mut lbm_ibm_membrane::Cell, x: &Soa3| {
            let (mut f, v) = (Soa3::zeros(x.len()), Soa3::zeros(x.len()));
            cell.add_internal_forces(x.view(), v.view(), &mut f.view_mut());
            f.iter().map(|f| f.norm()).fold(0.0, f64::max)
        };
        let rest: Soa3 = cell.reference().iter().collect();
        let pulled: Soa3 = rest
            .iter()
            .map(|x| lbm_ibm_coupling::Vec3::new(1.1 * x.x, 0.95 * x.y, 0.95 * x.z))
            .collect();
        let (still, strained) = (forces(&mut cell, &rest), forces(&mut cell, &pulled));
        println!(
            "{}: {still:.1e} N at rest, {strained:.1e} N at 10 %; {}",
            preset.kind, preset.source
        );
        // With a cortical tension the nodes of a sphere settle by a little.
        let share = if preset.material.tension > 0.0 { 0.3 } else { 1e-9 };
        assert!(still < share * strained, "{}: {still:e} {strained:e}", preset.kind);
        assert!(!preset.source.is_empty());
    }
    Ok(())
}

#[test]
fn a_drop_with_cortical_tension_has_the_pressure_of_laplace() -> Result<(), MembraneError> {
    // A neutrophil without the constant pressure inside shrinks until kv (1 - V/V0) = 2 T/R.
    let preset = presets::NEUTROPHIL.with_nodes(400);
    let mesh = std::sync::Arc::new(preset.mesh()?);
    let plain = Material {
        tension: 0.0,
        ..preset.material
    };
    let tension = CorticalTension::new(&mesh, preset.material.tension)?;
    let held = preset.cell()?;
    let shrunk = plain.cell("drop", mesh.clone())?.with_law(tension);
    let volume = |cell: lbm_ibm_membrane::Cell| -> Result<f64, MembraneError> {
        let triangles = cell.triangles().to_vec();
        let mut stretch = Stretch::new(cell, Load::CosineSquared).with_tolerance(1e-14);
        stretch.pull(0.0)?;
        Ok(enclosed_volume(stretch.positions(), &triangles) / mesh.volume() - 1.0)
    };
    let laplace = 2.0 * preset.material.tension / 4.2e-6 / preset.material.volume;
    let (held, shrunk) = (volume(held)?, volume(shrunk)?);
    println!("volume {held:+.2e} and {shrunk:+.2e}, Laplace {:+.2e}", -laplace);
    assert!(held.abs() < 0.02 * laplace, "at rest: {held:e}");
    assert!((shrunk / -laplace - 1.0).abs() < 0.03, "{shrunk:e} {laplace:e}");
    Ok(())
}

#[test]
fn moduli_of_a_material_are_those_of_its_cell() -> Result<(), MembraneError> {
    // In a small uniform dilation by e the energy is K/2 (2 e)^2 A, whatever the sheet.
    let mesh = std::sync::Arc::new(lbm_ibm_membrane::Mesh::sphere(5e-6, 400)?);
    let e = 1e-4;
    let x: Soa3 = mesh.nodes().iter().map(|x| x * (1.0 + e)).collect();
    for (sheet, shear, dilation) in [
        (Sheet::Skalak, 5e-6, 40e-6),
        (Sheet::NeoHookean, 5e-6, 15e-6),
        (Sheet::WormLikeChain(0.4), 5e-6, 12e-6),
    ] {
        let material = Material {
            shear,
            dilation,
            ..Material::none(sheet)
        };
        let energy = material
            .cell("sheet", mesh.clone())?
            .energy(x.view())
            .expect("an energy");
        let found = energy / (0.5 * 4.0 * e * e * mesh.area());
        assert!(
            (found / dilation - 1.0).abs() < 0.02,
            "{sheet:?}: {found:e} of {dilation:e}"
        );
        let double = material.with(Modulus::Shear, 2.0 * shear);
        assert_eq!((double.shear, double.dilation), (2.0 * shear, 2.0 * dilation));
    }
    let soft = Material {
        shear: 5e-6,
        dilation: 6e-6,
        ..Material::none(Sheet::WormLikeChain(0.4))
    };
    assert!(matches!(
        soft.cell("soft", mesh.clone()),
        Err(MembraneError::OutOfRange { .. })
    ));
    let negative = Material { bending: -1.0, ..soft };
    assert!(negative.cell("negative", mesh).is_err());
    Ok(())
}

#[test]
fn a_law_named_in_a_cell_is_there_once() -> Result<(), MembraneError> {
    let cell = presets::NEUTROPHIL.cell()?;
    let names: Vec<&str> = cell.laws().iter().map(|law| law.name()).collect();
    assert_eq!(
        names,
        [
            "neo-Hookean membrane",
            "Kantor-Nelson bending",
            "cortical tension",
            "pressure",
            "volume"
        ]
    );
    Ok(())
}
