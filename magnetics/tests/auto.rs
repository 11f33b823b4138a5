//! The model that picks its rung: clusters, chains, random beads, and the seams between rungs.

mod scene;

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::{FIELD, RADIUS, beads, cluster, energy_gradient, solve, units};

#[test]
fn the_force_is_the_gradient_of_the_energy_across_the_seams_and_forces_sum_to_zero() {
    let sheets = SheetPair::opposite(Vec3::zeros(), [40e-6, 30e-6], 50e-6, 0.2).unwrap();
    let chi = |mu: f64| Intrinsic::new(mu - 1.0).unwrap();
    // Gaps of 0.15 are closed, of 0.6 and 0.7 half open; a chain leads away, and beads lie where links fade.
    for spacing in [2.15, 2.6, 2.7] {
        let mut x = cluster(2, spacing);
        x.push(Vec3::new(9.5e-6, 1e-6, 3e-6));
        x.push(Vec3::new(13.7e-6, 1.5e-6, 2e-6));
        x.push(Vec3::new(7e-6, 10e-6, -4e-6));
        x.push(Vec3::new(-10e-6, 1e-6, 1e-6));
        for mixed in [false, true] {
            if cfg!(debug_assertions) && !(mixed && spacing == 2.6) {
                continue;
            }
            let room = |i: usize, j: usize| i == j || (x.get(i) - x.get(j)).norm() > 2.1 * RADIUS;
            assert!((0..x.len()).all(|i| (0..x.len()).all(|j| room(i, j))));
            let mut beads: Vec<_> = (0..x.len())
                .map(|i| {
                    let large = mixed && i == 2;
                    let radius = if large { 1.05 * RADIUS } else { 0.98 * RADIUS };
                    Bead::new(radius, 1500.0, chi(if large { 2.0 } else { 4.0 })).unwrap()
                })
                .collect();
            if mixed {
                beads[5] = Bead::new(RADIUS, 1500.0, Magnetisation::Remanent(Vec3::new(1e4, -2e4, 3e4))).unwrap();
            }
            let mut model = Auto::new().with_order(4).with_tolerance(1e-13);
            let error = energy_gradient(&mut model, &beads, &x, &sheets);
            println!("spacing {spacing} mixed {mixed}: {error:e}");
            assert!(error < 1e-7, "{spacing} {mixed} {error:e}");
            let field = Vec3::new(0.01, 0.03, 0.05);
            let out = solve(&mut model, &beads, &x, &Uniform::new(field));
            let largest = out.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
            assert!(out.recoil().norm() < 1e-11 * largest);
            let total: Vec3 = (0..x.len())
                .map(|i| x.get(i).cross(&out.force.get(i)) + out.torque.get(i))
                .sum();
            let expected = out.moment.iter().sum::<Vec3>().cross(&field);
            assert!(
                (total - expected).norm() < 1e-6 * largest * RADIUS,
                "{total} {expected}"
            );
        }
    }
}

/// Beads thrown into a ball at random without overlap, gaps of at least `gap` radii.
fn thrown(n: usize, size: f64, gap: f64, seed: u64) -> Soa3 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(1);
    let mut random = || {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let mut x = Soa3::default();
    while x.len() < n {
        let p = Vec3::new(random(), random(), random()) * size;
        if p.norm() < size && x.iter().all(|q| (q - p).norm() > 2.0 + gap) {
            x.push(p);
        }
    }
    x.iter().map(|p| p * RADIUS).collect()
}

#[test]
fn every_estimate_covers_the_error_among_random_beads() {
    for (n, size, gap) in [(8, 3.6, 0.02), (8, 4.2, 0.1), (4, 0.0, 0.1)] {
        for seed in 0..3 {
            for mu in [2.0, 4.0, 10.0] {
                if cfg!(debug_assertions) && (seed > 0 || mu > 2.0 || gap < 0.1) {
                    continue;
                }
                // With no size: a packed cluster, shaken.
                let x: Soa3 = if size > 0.0 {
                    thrown(n, size, gap, seed)
                } else {
                    let shaken = thrown(n, 50.0, gap, seed);
                    let ordered = cluster(2, 2.0 + gap + 0.1);
                    ordered.iter().zip(shaken.iter()).map(|(x, s)| x + s * 1e-3).collect()
                };
                let many = beads(n, RADIUS, mu);
                let source = Uniform::new(Vec3::new(0.3, 0.4, 0.866) * FIELD);
                let exact = solve(&mut Multipoles::new(24), &many, &x, &source);
                let largest = exact.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
                let models: [&mut dyn Model; 5] = [
                    &mut FixedDipoles::new(),
                    &mut MutualDipoles::new(),
                    &mut PairCorrected::new(),
                    &mut Auto::new(),
                    &mut Multipoles::new(8),
                ];
                for model in models {
                    let out = solve(model, &many, &x, &source);
                    let off = (0..n)
                        .map(|i| (out.force.get(i) - exact.force.get(i)).norm())
                        .fold(0.0, f64::max);
                    println!(
                        "n {n} gap {gap} seed {seed} mu {mu} {}: off {:.2e} of the largest, over the estimate {:.2}",
                        model.name(),
                        off / largest,
                        off / out.error.force
                    );
                    assert!(off < out.error.force + exact.error.force, "{}", model.name());
                }
            }
        }
    }
}

fn rungs() -> [Box<dyn Model>; 5] {
    [
        Box::new(FixedDipoles::new()),
        Box::new(MutualDipoles::new().with_tolerance(1e-13)),
        Box::new(PairCorrected::new().with_tolerance(1e-13)),
        Box::new(Auto::new().with_tolerance(1e-13)),
        Box::new(Multipoles::new(8).with_tolerance(1e-13).with_reach(6.0)),
    ]
}

#[test]
fn forces_sum_to_zero_with_the_recoil_of_the_source_on_every_rung() {
    // The source is a dipole far away: a bead that keeps its moment must feel there what `recoil` says.
    let (place, moment) = (Vec3::new(30e-6, -10e-6, 25e-6), Vec3::new(1e-11, 3e-11, -2e-11));
    let x = cluster(2, 2.1);
    let (mut many, mut all) = (beads(x.len(), RADIUS, 6.0), x.clone());
    let apart = rungs().map(|mut model| solve(&mut *model, &many, &x, &PointDipole::new(place, moment)));
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 1e-18;
    many.push(Bead::new(1e-6, 1500.0, Magnetisation::Remanent(moment / volume)).unwrap());
    all.push(place);
    for (mut model, apart) in rungs().into_iter().zip(apart) {
        // Fixed dipoles take their moments from the source, a bead is none to them: they are given here.
        if model.name() == FixedDipoles::new().name() {
            let mut given = apart.moment.clone();
            given.push(moment);
            model = Box::new(FixedDipoles::new().with_moments(given));
        }
        let joined = solve(&mut *model, &many, &all, &Uniform::new(Vec3::zeros()));
        let largest = joined.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let error = (joined.force.get(x.len()) - apart.recoil()).norm() / largest;
        println!(
            "{}: {error:e}, sum {:e}",
            model.name(),
            joined.recoil().norm() / largest
        );
        assert!(error < 1e-8, "{} {error:e}", model.name());
        assert!(joined.recoil().norm() < 1e-11 * largest, "{}", model.name());
    }
}

#[test]
fn overlap_and_permeability_100_leave_every_rung_finite() {
    // Without optimisation the tables of strong spheres take minutes.
    let mu = if cfg!(debug_assertions) { 4.0 } else { 100.0 };
    let models: [Box<dyn Model>; 4] = [
        Box::new(MutualDipoles::new()),
        Box::new(PairCorrected::new()),
        Box::new(Auto::new()),
        Box::new(Multipoles::new(8)),
    ];
    for mut model in models {
        for spacing in [2.0, 1.99, 1.9, 1.0, 0.0] {
            let x = cluster(2, spacing);
            let many = beads(x.len(), RADIUS, mu);
            let out = solve(&mut *model, &many, &x, &Uniform::new(Vec3::new(0.01, 0.02, 0.05)));
            let most = out.moment.iter().map(|m| m.norm()).fold(0.0, f64::max) / units::MOMENT;
            println!("{} at {spacing}: {most:.2}", model.name());
            assert!(
                most < 10.0 && out.energy.is_finite(),
                "{} {spacing}: {most}",
                model.name()
            );
            assert!(
                out.force
                    .iter()
                    .chain(out.moment.iter())
                    .all(|f| f.iter().all(|c| c.is_finite()))
            );
        }
    }
}

#[test]
fn without_closed_contacts_it_is_the_pair_correction_and_in_packed_ones_far_better() {
    let source = Uniform::new(Vec3::new(0.01, 0.02, 0.05));
    let chain: Soa3 = (0..6).map(|k| Vec3::z() * (k as f64 * 2.05 * RADIUS)).collect();
    let many = beads(6, RADIUS, 4.0);
    let one = solve(&mut Auto::new(), &many, &chain, &source);
    let two = solve(&mut PairCorrected::new(), &many, &chain, &source);
    assert_eq!(one.force, two.force);
    let packed = cluster(3, 2.1);
    let many = beads(packed.len(), RADIUS, 4.0);
    let exact = solve(&mut Multipoles::new(20), &many, &packed, &source);
    let largest = exact.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let off = |model: &mut dyn Model| {
        let out = solve(model, &many, &packed, &source);
        let error = |i: usize| (out.force.get(i) - exact.force.get(i)).norm() / largest;
        (0..packed.len()).map(error).fold(0.0, f64::max)
    };
    let (auto, corrected) = (off(&mut Auto::new()), off(&mut PairCorrected::new()));
    println!("packed: automatic {auto:.2e}, pair correction {corrected:.2e}");
    assert!(auto < 0.01 && corrected > 0.1);
}
