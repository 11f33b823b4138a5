//! Bending energies against the continuum.

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_membrane::laws::{Helfrich, KantorNelson};
use lbm_ibm_membrane::{Law, Mesh};
use std::f64::consts::PI;

const KAPPA: f64 = 2e-19;
const RADIUS: f64 = 4e-6;

/// Largest force of a law on a mesh, N.
fn largest(law: &mut dyn Law, mesh: &Mesh) -> f64 {
    let n = mesh.nodes().len();
    let (mut f, v) = (Soa3::zeros(n), Soa3::zeros(n));
    law.add_forces(mesh.nodes(), v.view(), &mut f.view_mut());
    f.iter().map(|f| f.norm()).fold(0.0, f64::max)
}

#[test]
fn a_sphere_has_eight_pi_kappa() {
    let mut errors = Vec::new();
    for nodes in [162, 642, 2562] {
        let mesh = Mesh::sphere(RADIUS, nodes).unwrap();
        let energy = |law: &dyn Law| law.energy(mesh.nodes()).expect("it has an energy") / (8.0 * PI * KAPPA) - 1.0;
        let helfrich = energy(&Helfrich::new(&mesh, KAPPA).unwrap());
        // A sphere of hinges between equilateral triangles has 4 pi k/sqrt(3).
        let hinges = energy(&KantorNelson::new(&mesh, 2.0 * 3.0_f64.sqrt() * KAPPA).unwrap().flat());
        println!("{nodes} nodes: Helfrich {helfrich:+.2e}, Kantor-Nelson {hinges:+.2e}");
        errors.push((helfrich, hinges));
    }
    assert!(errors[1].0.abs() < 0.01, "{errors:?}");
    assert!(
        errors.windows(2).all(|e| e[1].0.abs() < 0.8 * e[0].0.abs()),
        "it converges: {errors:?}"
    );
    assert!(errors.iter().all(|e| e.1.abs() < 0.15), "hinges do not: {errors:?}");
}

#[test]
fn a_sphere_of_the_spontaneous_curvature_has_no_energy() {
    let mesh = Mesh::sphere(RADIUS, 642).unwrap();
    let energy = |c0: f64| {
        let law = Helfrich::new(&mesh, KAPPA)
            .unwrap()
            .with_spontaneous_curvature(c0)
            .unwrap();
        law.energy(mesh.nodes()).unwrap() / (8.0 * PI * KAPPA)
    };
    // kappa/2 (2/R - c0)^2 4 pi R^2 over 8 pi kappa: (1 - c0 R/2)^2.
    for share in [-1.0_f64, 0.5, 2.0] {
        let found = energy(share * 2.0 / RADIUS);
        assert!(
            (found - (1.0 - share).powi(2)).abs() < 0.01 * (1.0 + share.abs()).powi(2),
            "{share}: {found}"
        );
    }
    assert!(energy(2.0 / RADIUS).abs() < 0.01);
}

#[test]
fn the_area_difference_of_a_sphere_is_that_of_its_radius() {
    let mesh = Mesh::sphere(RADIUS, 642).unwrap();
    let plain = Helfrich::new(&mesh, KAPPA).unwrap();
    let sphere = plain.integrated_curvature(mesh.nodes());
    assert!((sphere / (4.0 * PI * RADIUS) - 1.0).abs() < 0.01, "{sphere:e}");
    // pi kappa_bar/(2 A D^2) (2 D)^2 (M - M0)^2 with M - M0 = 4 pi R s: 8 pi^2 kappa_bar s^2.
    let share = 0.3;
    let law = plain
        .clone()
        .with_area_difference(&mesh, KAPPA, (1.0 - share) * sphere)
        .unwrap();
    let extra = law.energy(mesh.nodes()).unwrap() - plain.energy(mesh.nodes()).unwrap();
    let wanted = 8.0 * PI * PI * KAPPA * share * share;
    assert!((extra / wanted - 1.0).abs() < 0.02, "{extra:e} {wanted:e}");
}

#[test]
fn the_energy_does_not_depend_on_the_size_and_a_sphere_is_at_rest() {
    let small = Mesh::sphere(RADIUS, 642).unwrap();
    let large = small.clone().scaled(7.0).unwrap();
    let energy = |mesh: &Mesh| Helfrich::new(mesh, KAPPA).unwrap().energy(mesh.nodes()).unwrap();
    assert!((energy(&large) / energy(&small) - 1.0).abs() < 1e-12);
    // What forces are left on a sphere belong to the mesh: they are small beside those of an ellipsoid.
    let egg = Mesh::ellipsoid(Vec3::new(6e-6, 4e-6, 3e-6), 642).unwrap();
    let on = |mesh: &Mesh| largest(&mut Helfrich::new(mesh, KAPPA).unwrap(), mesh);
    println!(
        "greatest force on a sphere {:.1e}, on an ellipsoid {:.1e} N",
        on(&small),
        on(&egg)
    );
}

/// Bending energy of a prolate spheroid of semi-axes a > b over 8 pi kappa, by quadrature of the two curvatures.
fn spheroid(a: f64, b: f64) -> f64 {
    let n = 2000;
    let mut sum = 0.0;
    for k in 0..n {
        let t = PI * (k as f64 + 0.5) / n as f64;
        let (s, c) = t.sin_cos();
        // Axis along a: x = a cos t, r = b sin t.
        let g = (a * a * s * s + b * b * c * c).sqrt();
        let (c1, c2) = (a * b / g.powi(3), a / (b * g));
        sum += 0.5 * (c1 + c2).powi(2) * 2.0 * PI * b * s * g * PI / n as f64;
    }
    sum / (8.0 * PI)
}

#[test]
fn an_ellipsoid_has_the_energy_of_its_curvatures() {
    let exact = spheroid(6e-6, 3e-6);
    assert!((spheroid(1.0, 1.0) - 1.0).abs() < 1e-6);
    for nodes in [642, 2562] {
        let mesh = Mesh::ellipsoid(Vec3::new(6e-6, 3e-6, 3e-6), nodes).unwrap();
        let found = Helfrich::new(&mesh, KAPPA).unwrap().energy(mesh.nodes()).unwrap() / (8.0 * PI * KAPPA);
        println!("{nodes} nodes: {found:.4} of {exact:.4}");
        assert!((found / exact - 1.0).abs() < 0.02, "{nodes}: {found} {exact}");
    }
}
