//! The exact pair against `two_sphere_force.csv` and `unequal_pair_force.csv`.

mod table;

use lbm_ibm_coupling::Vec3;
use lbm_ibm_magnetics::{MU0, TwoSpheres};
use std::f64::consts::PI;
use table::Table;

fn off(value: f64, expected: f64) -> f64 {
    ((value - expected) / expected).abs()
}

#[test]
fn equal_spheres_to_1e_9() {
    let table = Table::read(include_str!("data/two_sphere_force.csv"));
    let (mut worst, mut rows) = (0.0f64, 0);
    for row in table.rows() {
        let (mu, s) = (row.number("mu_r"), row.number("s"));
        let unconverged = mu > 99.0 && s == 2.0;
        // Without optimisation the closest gaps of strong spheres take minutes.
        let slow = cfg!(debug_assertions) && row.number("Lmax") > 300.0;
        if unconverged || slow {
            continue;
        }
        let pair = TwoSpheres::new([1.0; 2], [mu; 2]).unwrap().solve(s).unwrap();
        for (value, name) in [
            (pair.force_par, "F_par"),
            (pair.force_perp, "F_perp"),
            (pair.force_tan, "F_tan"),
            (pair.moment_par[0] / (4.0 * PI), "m_par"),
            (pair.moment_par[1] / (4.0 * PI), "m_par"),
            (pair.moment_perp[0] / (4.0 * PI), "m_perp"),
        ] {
            let error = off(value, row.number(name));
            assert!(error < 1e-9, "mu {mu} s {s} {name}: {error:e}");
            worst = worst.max(error);
        }
        rows += 1;
    }
    println!("equal spheres, {rows} rows: {worst:e}");
    assert!(rows > 100);
}

#[test]
fn unequal_spheres_to_1e_9() {
    let table = Table::read(include_str!("data/unequal_pair_force.csv"));
    let mut worst = 0.0f64;
    for row in table.rows() {
        let pair = TwoSpheres::new(
            [row.number("a1"), row.number("a2")],
            [row.number("mu1"), row.number("mu2")],
        )
        .unwrap()
        .solve(row.number("R"))
        .unwrap();
        for (value, name) in [
            (pair.force_par, "F_par"),
            (pair.force_perp, "F_perp"),
            (pair.force_tan, "F_tan"),
            (pair.moment_par[0] / (4.0 * PI), "m1_par"),
            (pair.moment_par[1] / (4.0 * PI), "m2_par"),
            (pair.moment_perp[0] / (4.0 * PI), "m1_perp"),
            (pair.moment_perp[1] / (4.0 * PI), "m2_perp"),
        ] {
            let error = off(value, row.number(name));
            assert!(error < 1e-9, "R {} {name}: {error:e}", row.text("R"));
            worst = worst.max(error);
        }
    }
    println!("unequal spheres: {worst:e}");
}

#[test]
fn the_force_is_the_slope_of_the_total_moment_also_for_diamagnetic_spheres() {
    for mu in [[0.1, 0.1], [0.2, 5.0], [3.0, 0.5], [1.0, 4.0]] {
        let pair = TwoSpheres::new([1.0, 1.5], mu).unwrap();
        let (r, h) = (2.6, 1e-3);
        let [a, b] = pair.solve(r + h).unwrap().total_moment();
        let [c, d] = pair.solve(r - h).unwrap().total_moment();
        let now = pair.solve(r).unwrap();
        assert!((0.5 * (a - c) / (2.0 * h) - now.force_par).abs() < 1e-5 * now.force_par.abs().max(1e-9));
        assert!((0.5 * (b - d) / (2.0 * h) - now.force_perp).abs() < 1e-5 * now.force_perp.abs().max(1e-9));
    }
}

#[test]
fn the_pair_turns_to_the_field_and_overlap_is_an_error() {
    let pair = TwoSpheres::new([1.0; 2], [4.0; 2]).unwrap();
    let found = pair.solve(2.1).unwrap();
    // Field at 30 degrees from the line towards +x: the second sphere is pulled towards +x and inwards.
    let b = Vec3::new(0.5, 0.0, 0.75f64.sqrt());
    let force = found.force(b, Vec3::z()) * MU0;
    assert!((force.x + found.force_tan * 60f64.to_radians().sin()).abs() < 1e-14 && force.x > 0.0);
    assert!((force.z - 0.75 * found.force_par - 0.25 * found.force_perp).abs() < 1e-14);
    assert!(pair.solve(1.9).is_err() && TwoSpheres::new([1.0, 0.0], [2.0; 2]).is_err());
}
