//! Calibration: moduli that made a curve come back from it, with intervals that hold them.

use lbm_ibm_coupling::ImmersedBody;
use lbm_ibm_membrane::calibrate::{Calibration, Point};
use lbm_ibm_membrane::stretch::{Load, Patch, Stretch};
use lbm_ibm_membrane::{Material, MembraneError, Mesh, Modulus, presets};
use std::sync::Arc;

const PN: f64 = 1e-12;
const UM: f64 = 1e-6;
/// Greatest force left on a node, N: truth and fit come to rest alike, so that a coarse one serves.
const COARSE: f64 = 1e-15;

/// A small red cell held by beads.
fn red_cell() -> Result<(Arc<Mesh>, Load), MembraneError> {
    let preset = presets::RED_CELL.with_nodes(120);
    let mesh = Arc::new(preset.mesh()?);
    let cell = preset.material.cell("red cell", mesh.clone())?;
    let load = Load::Beads(Patch::Chord(2.5 * UM).ends(cell.reference())?);
    Ok((mesh, load))
}

/// Axial and transverse diameters of a material at forces.
fn curve(material: &Material, mesh: &Arc<Mesh>, load: &Load, forces: &[f64]) -> Result<Vec<[f64; 2]>, MembraneError> {
    let mut stretch = Stretch::new(material.cell("truth", mesh.clone())?, load.clone()).with_tolerance(COARSE);
    forces
        .iter()
        .map(|&f| stretch.pull(f).map(|s| [s.axial, s.transverse]))
        .collect()
}

/// Points with an error of 0.1 um, moved by given shares of it.
fn points(forces: &[f64], sizes: &[[f64; 2]], noise: &[f64]) -> Vec<Point> {
    let error = 0.1 * UM;
    let moved = |k: usize| noise[k % noise.len()] * error;
    forces
        .iter()
        .zip(sizes)
        .enumerate()
        .map(|(k, (&f, s))| Point::axial(f, s[0] + moved(2 * k), error).and_transverse(s[1] + moved(2 * k + 1), error))
        .collect()
}

#[test]
fn moduli_come_back_from_their_curve() -> Result<(), MembraneError> {
    let (mesh, load) = red_cell()?;
    let truth = presets::RED_CELL.material.with(Modulus::Shear, 6e-6);
    let forces = [15.0 * PN, 40.0 * PN, 80.0 * PN];
    let sizes = curve(&truth, &mesh, &load, &forces)?;
    let cell = Calibration::new(presets::RED_CELL.material, mesh, load, vec![Modulus::Shear]).with_tolerance(COARSE);

    let exact = cell.fit(&points(&forces, &sizes, &[0.0]))?;
    let shear = exact.moduli[0].1;
    assert!((shear.value / 6e-6 - 1.0).abs() < 2e-3, "{exact}");
    assert!(exact.chi_squared < 1e-3 && shear.low < 6e-6 && 6e-6 < shear.high);
    // The interval is that of the errors: 1.96 over the root of the sum of the squares of the slopes.
    let slope = |k: usize| -> Result<f64, MembraneError> {
        let moved = truth.with(Modulus::Shear, 6.06e-6);
        let other = curve(&moved, &red_cell()?.0, &red_cell()?.1, &forces)?;
        let square = |axis: usize| ((other[k][axis] - sizes[k][axis]) / (1.01_f64.ln() * 0.1 * UM)).powi(2);
        Ok(square(0) + square(1))
    };
    let sum = slope(0)? + slope(1)? + slope(2)?;
    let width = 0.5 * (shear.high / shear.low).ln();
    assert!(
        (width / (1.96 / sum.sqrt()) - 1.0).abs() < 0.1,
        "{width} {}",
        1.96 / sum.sqrt()
    );

    let noisy = cell.fit(&points(&forces, &sizes, &[0.9, -0.4, -1.1, 0.7, 0.3, -0.8]))?;
    println!("{noisy}");
    let shear = noisy.moduli[0].1;
    assert!(shear.low < 6e-6 && 6e-6 < shear.high && noisy.freedom == 5);

    // Without errors the scatter gives them.
    let blind: Vec<Point> = points(&forces, &sizes, &[0.9, -0.4, -1.1, 0.7, 0.3, -0.8])
        .into_iter()
        .map(|p| Point::axial(p.force, p.axial.value, 0.0))
        .collect();
    let shear = cell.fit(&blind)?.moduli[0].1;
    assert!(shear.low < 6e-6 && 6e-6 < shear.high, "{shear:?}");
    Ok(())
}

#[test]
fn a_fit_says_which_moduli_the_data_cannot_tell_apart() -> Result<(), MembraneError> {
    // Stretching hardly feels how nearly the volume is kept, at any modulus that keeps it.
    let (mesh, load) = red_cell()?;
    let material = presets::RED_CELL.material;
    let forces = [20.0 * PN, 60.0 * PN];
    let sizes = curve(&material, &mesh, &load, &forces)?;
    let free = vec![Modulus::Shear, Modulus::Volume];
    let fit = Calibration::new(material, mesh, load, free)
        .with_tolerance(COARSE)
        .fit(&points(&forces, &sizes, &[0.0]))?;
    println!("{fit}");
    let open: Vec<_> = fit.undetermined().collect();
    assert_eq!(open.len(), 1);
    let power = |which| {
        open[0]
            .powers
            .iter()
            .find(|(m, _)| *m == which)
            .map_or(0.0, |(_, p)| p.abs())
    };
    assert!(power(Modulus::Volume) > 0.99 && power(Modulus::Shear) < 0.1, "{open:?}");
    assert!(fit.to_string().contains("do not tell these moduli apart"));
    let shear = fit.moduli[0].1;
    assert!(
        (shear.value / material.shear - 1.0).abs() < 0.02 && shear.high / shear.low < 1.3,
        "{fit}"
    );
    Ok(())
}

#[test]
fn one_force_predicts_another_with_its_interval() -> Result<(), MembraneError> {
    let (mesh, load) = red_cell()?;
    let truth = presets::RED_CELL.material.with(Modulus::Shear, 5.2e-6);
    let sizes = curve(&truth, &mesh, &load, &[40.0 * PN, 90.0 * PN])?;
    let cell = Calibration::new(presets::RED_CELL.material, mesh, load, vec![Modulus::Shear]).with_tolerance(COARSE);
    let error = 0.15 * UM;
    let fit = cell.fit(&[Point::axial(40.0 * PN, sizes[0][0] + 0.8 * error, error)])?;
    let far = cell.predict(&fit, 90.0 * PN)?;
    println!("{far:?}, truth {:?}", sizes[1]);
    assert!(far.axial.low < sizes[1][0] && sizes[1][0] < far.axial.high);
    assert!(far.transverse.low < sizes[1][1] && sizes[1][1] < far.transverse.high);
    let width = far.axial.high - far.axial.low;
    assert!(width > 2.0 * error && width < 20.0 * error, "{width:e}");
    Ok(())
}

#[test]
fn too_few_points_are_refused() -> Result<(), MembraneError> {
    let (mesh, load) = red_cell()?;
    let cell = |free| Calibration::new(presets::RED_CELL.material, mesh.clone(), load.clone(), free);
    let point = [Point::axial(40.0 * PN, 11.0 * UM, 0.1 * UM)];
    let both = cell(vec![Modulus::Shear, Modulus::Bending]).fit(&point).unwrap_err();
    assert!(
        matches!(
            both,
            MembraneError::TooFewData {
                diameters: 1,
                free: 2,
                errors: true
            }
        ),
        "{both}"
    );
    let blind = [Point::axial(40.0 * PN, 11.0 * UM, 0.0)];
    assert!(matches!(
        cell(vec![Modulus::Shear]).fit(&blind),
        Err(MembraneError::TooFewData { .. })
    ));
    let absent = cell(vec![Modulus::Tension]).fit(&point).unwrap_err();
    assert!(matches!(absent, MembraneError::NotPositive { .. }), "{absent}");
    Ok(())
}

#[cfg(feature = "import")]
#[test]
fn a_curve_is_read_from_a_file() {
    use lbm_ibm_membrane::calibrate::read_curve;
    let file = |name: &str, text: &str| {
        let path = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&path, text).unwrap();
        path
    };
    let text = "# a comment\nforce_pN, axial_um, axial_error_um, transverse_um, transverse_error_um\n\
                10, 9.1, 0.2, 7.3, 0.3\n20, 10.0, 0.2, nan,\n";
    let points = read_curve(file("curve.csv", text)).unwrap();
    assert_eq!(points.len(), 2);
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
    assert!(close(points[0].force, 10e-12) && close(points[0].transverse.unwrap().error, 0.3e-6));
    assert!(points[1].transverse.is_none() && close(points[1].axial.value, 10e-6));
    for (name, text) in [
        ("no_force.csv", "axial_um\n9\n"),
        ("letters.csv", "force_pN,axial_um\n10,wide\n"),
        ("empty.csv", "force_pN,axial_um\n"),
        ("gap.csv", "force_pN,axial_um\n10,\n"),
    ] {
        let error = read_curve(file(name, text)).unwrap_err();
        assert!(error.to_string().contains(name), "{error}");
    }
}
