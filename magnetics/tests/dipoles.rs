//! Fixed and mutual dipoles against `dipole_pair_force.csv`, `two_sphere_force.csv` and their own energy.

mod scene;
mod table;

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::{FORCE, beads, cluster, energy_gradient, solve, units};
use table::Table;

#[test]
fn fixed_dipoles_have_the_reference_force_and_torque_to_1e_13() {
    let table = Table::read(include_str!("data/dipole_pair_force.csv"));
    let beads = beads(2, 1e-9, 2.0);
    let mut worst: f64 = 0.0;
    for row in table.rows() {
        let x: Soa3 = [row.vector("x1", "y1", "z1"), row.vector("x2", "y2", "z2")]
            .into_iter()
            .collect();
        let m: Soa3 = [row.vector("m1x", "m1y", "m1z"), row.vector("m2x", "m2y", "m2z")]
            .into_iter()
            .collect();
        let mut model = FixedDipoles::new().with_moments(m);
        let out = solve(&mut model, &beads, &x, &Uniform::new(Vec3::zeros()));
        let force = row.vector("F2x", "F2y", "F2z");
        worst = worst.max((out.force.get(1) - force).norm() / force.norm());
        worst = worst.max((out.force.get(0) + force).norm() / force.norm());
        for (i, name) in [["T1x", "T1y", "T1z"], ["T2x", "T2y", "T2z"]].iter().enumerate() {
            let torque = row.vector(name[0], name[1], name[2]);
            worst = worst.max((out.torque.get(i) - torque).norm() / torque.norm());
        }
    }
    println!("force and torque {worst:e}");
    assert!(worst < 1e-13, "{worst:e}");
}

#[test]
fn mutual_dipoles_have_the_reference_pair_force() {
    let table = Table::read(include_str!("data/two_sphere_force.csv"));
    // One model per permeability, for each makes its own tables for the estimate of error.
    for mu in ["1.1", "1.5", "2", "4", "10", "30", "100"] {
        let beads = beads(2, scene::RADIUS, mu.parse().unwrap());
        let (mut fixed, mut mutual) = (FixedDipoles::new(), MutualDipoles::new().with_tolerance(1e-11));
        for row in table.rows().filter(|r| r.text("mu_r") == mu) {
            let x: Soa3 = [Vec3::zeros(), Vec3::z() * row.number("s") * scene::RADIUS]
                .into_iter()
                .collect();
            for (axis, names) in [
                (Vec3::z(), ["F_par_FD", "F_par_MD"]),
                (Vec3::x(), ["F_perp_FD", "F_perp_MD"]),
            ] {
                let source = Uniform::new(axis * scene::FIELD);
                let models: [&mut dyn Model; 2] = [&mut fixed, &mut mutual];
                for (model, name) in models.into_iter().zip(names) {
                    let force = solve(model, &beads, &x, &source).force.get(1).z / FORCE;
                    approx::assert_relative_eq!(force, row.number(name), max_relative = 1e-9);
                }
            }
        }
    }
}

#[test]
fn the_mutual_solve_converges_in_packed_clusters_to_mu_100_and_with_overlap() {
    for spacing in [2.0, 1.6, 0.7, 0.0] {
        for mu in [2.0, 10.0, 100.0, 1e4] {
            let x = cluster(4, spacing);
            let beads = beads(x.len(), scene::RADIUS, mu);
            let out = solve(
                &mut MutualDipoles::new(),
                &beads,
                &x,
                &Uniform::new(Vec3::z() * scene::FIELD),
            );
            let most = out.moment.iter().map(|m| m.norm()).fold(0.0, f64::max) / units::MOMENT;
            println!(
                "spacing {spacing} mu {mu}: {} iterations, moment {most}",
                out.error.iterations
            );
            assert!(most < 10.0 && out.error.residual <= 1e-7);
        }
    }
}

#[test]
fn conjugate_gradients_and_the_dense_solution_agree() {
    let x = cluster(3, 2.01);
    let beads = beads(x.len(), scene::RADIUS, 30.0);
    let source = Uniform::new(Vec3::new(0.01, 0.02, 0.05));
    let out = solve(&mut MutualDipoles::new().with_tolerance(1e-13), &beads, &x, &source);
    let problem = Problem::new(&beads, x.view(), &source, 0.0).unwrap();
    let dense = dense_moments(&problem).unwrap();
    for i in 0..x.len() {
        approx::assert_relative_eq!(out.moment.get(i), dense.get(i), epsilon = 1e-11 * units::MOMENT);
    }
}

#[test]
fn the_force_of_mutual_dipoles_is_the_gradient_of_their_energy() {
    let chi = Intrinsic::new(9.0).unwrap();
    let laws: Vec<Magnetisation> = vec![
        chi.into(),
        Saturation::new(SaturationShape::FroehlichKennelly, chi, 4e4)
            .unwrap()
            .into(),
        Saturation::new(SaturationShape::Langevin, chi, 4e4).unwrap().into(),
        Intrinsic::new(-0.9).unwrap().into(),
        Magnetisation::Remanent(Vec3::new(1e4, -2e4, 3e4)),
    ];
    let half = [40e-6, 30e-6];
    let sheets = SheetPair::opposite(Vec3::zeros(), half, 50e-6, 0.2).unwrap();
    for mixed in [false, true] {
        for k in 0..laws.len() {
            let law = |i: usize| laws[if mixed { (i + k) % laws.len() } else { k }].clone();
            let x: Soa3 = cluster(2, 2.1)
                .iter()
                .map(|x| x + Vec3::new(3e-6, 1e-6, 4e-6))
                .collect();
            let beads: Vec<_> = (0..x.len())
                .map(|i| Bead::new(scene::RADIUS, 1500.0, law(i)).unwrap())
                .collect();
            let mut model = MutualDipoles::new().with_tolerance(1e-13);
            let error = energy_gradient(&mut model, &beads, &x, &sheets);
            println!("mixed {mixed} law {k}: {error:e}");
            assert!(error < 1e-7, "mixed {mixed} law {k}: {error:e}");
        }
    }
}

#[test]
fn the_force_of_fixed_dipoles_is_the_gradient_of_their_energy_with_moments_held() {
    let sheets = SheetPair::opposite(Vec3::zeros(), [40e-6, 30e-6], 50e-6, 0.2).unwrap();
    for spacing in [2.1, 1.5] {
        let x = cluster(2, spacing);
        let beads = beads(x.len(), scene::RADIUS, 4.0);
        let m = solve(&mut FixedDipoles::new(), &beads, &x, &sheets).moment;
        let mut model = FixedDipoles::new().with_moments(m);
        assert!(energy_gradient(&mut model, &beads, &x, &sheets) < 1e-7);
    }
}

#[test]
fn forces_sum_to_zero_with_the_recoil_of_the_source() {
    // The source is a dipole: as a bead that keeps its moment it must feel what Solution::recoil says.
    let (place, moment) = (Vec3::new(30e-6, -10e-6, 25e-6), Vec3::new(1e-11, 3e-11, -2e-11));
    let x = cluster(2, 2.1);
    let mut beads = beads(x.len(), scene::RADIUS, 6.0);
    let mut model = MutualDipoles::new().with_tolerance(1e-14);
    let apart = solve(&mut model, &beads, &x, &PointDipole::new(place, moment));
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 1e-18;
    beads.push(Bead::new(1e-6, 1500.0, Magnetisation::Remanent(moment / volume)).unwrap());
    let mut y = x.clone();
    y.push(place);
    let mut model = MutualDipoles::new().with_tolerance(1e-14);
    let joined = solve(&mut model, &beads, &y, &Uniform::new(Vec3::zeros()));
    let largest = joined.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    assert!((joined.force.get(x.len()) - apart.recoil()).norm() < 1e-12 * largest);
    assert!(joined.recoil().norm() < 1e-12 * largest);
}

#[test]
fn bad_input_is_named() {
    let beads = beads(2, scene::RADIUS, 2.0);
    let source = Uniform::new(Vec3::z());
    let one: Soa3 = [Vec3::zeros()].into_iter().collect();
    assert!(matches!(
        Problem::new(&beads, one.view(), &source, 0.0),
        Err(MagneticsError::Count { .. })
    ));
    let nan: Soa3 = [Vec3::zeros(), Vec3::repeat(f64::NAN)].into_iter().collect();
    assert!(matches!(
        Problem::new(&beads, nan.view(), &source, 0.0),
        Err(MagneticsError::NotFinite { bead: 1, .. })
    ));
    let close: Soa3 = [Vec3::zeros(), Vec3::z() * 1.9 * scene::RADIUS].into_iter().collect();
    let problem = Problem::new(&beads, close.view(), &source, 0.0).unwrap();
    assert!(matches!(
        problem.check_overlap(0.0),
        Err(MagneticsError::Overlap {
            first: 0,
            second: 1,
            ..
        })
    ));
    assert!(problem.check_overlap(scene::RADIUS).is_ok());
}
