//! Beads that saturate, on every rung.

mod scene;

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::{FIELD, RADIUS, beads, cluster, energy_gradient, solve};

const LIMIT: f64 = 3e4;
/// Weak beads without optimisation, where the tables of stronger ones take minutes.
const CHI: f64 = if cfg!(debug_assertions) { 0.3 } else { 3.0 };

fn laws() -> [Magnetisation; 3] {
    let chi = Intrinsic::new(CHI).unwrap();
    let bends = |shape| Saturation::new(shape, chi, LIMIT).unwrap();
    [
        bends(SaturationShape::FroehlichKennelly).into(),
        bends(SaturationShape::Langevin).into(),
        Table::new(&[[0.0, 0.0], [5e3, 5e3 * CHI], [2e4, 25e3], [1e5, LIMIT]])
            .unwrap()
            .into(),
    ]
}

fn rungs() -> Vec<Box<dyn Model>> {
    vec![
        Box::new(FixedDipoles::new()),
        Box::new(MutualDipoles::new().with_tolerance(1e-12)),
        Box::new(PairCorrected::new().with_tolerance(1e-12)),
        Box::new(Auto::new().with_tolerance(1e-12)),
        Box::new(Multipoles::new(6).with_tolerance(1e-12)),
    ]
}

/// A closed cluster and a pair.
fn places() -> Soa3 {
    let mut x = cluster(2, 2.2);
    x.push(Vec3::new(9e-6, 1e-6, 3e-6));
    x.push(Vec3::new(13.2e-6, 1.5e-6, 2e-6));
    x
}

fn off(a: &Solution, b: &Solution) -> f64 {
    let largest = b.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let difference = |(a, b): (Vec3, Vec3)| (a - b).norm() / largest;
    a.force.iter().zip(b.force.iter()).map(difference).fold(0.0, f64::max)
}

#[test]
fn in_a_weak_field_every_law_is_linear_and_in_a_strong_one_all_rungs_are_saturated_dipoles() {
    let x = places();
    let linear = beads(x.len(), RADIUS, 1.0 + CHI);
    for (mut bent, mut plain) in rungs().into_iter().zip(rungs()) {
        // The automatic model keeps to the pair correction where beads saturate.
        if bent.name() == Auto::new().name() {
            plain = Box::new(PairCorrected::new().with_tolerance(1e-12));
        }
        for law in laws() {
            let many = vec![Bead::new(RADIUS, 1500.0, law).unwrap(); x.len()];
            let direction = Vec3::new(0.36, 0.48, 0.8);
            let weak = Uniform::new(direction * 1e-8);
            let strong = Uniform::new(direction * 300.0);
            let (one, two) = (
                solve(&mut *bent, &many, &x, &weak),
                solve(&mut *plain, &linear, &x, &weak),
            );
            assert!(off(&one, &two) < 1e-5, "{} weak {:e}", bent.name(), off(&one, &two));
            let out = solve(&mut *bent, &many, &x, &strong);
            let m = direction * (LIMIT * many[0].volume());
            let mut held = FixedDipoles::new().with_moments((0..x.len()).map(|_| m).collect());
            let error = off(&out, &solve(&mut held, &many, &x, &strong));
            println!("{}: strong {error:e}", bent.name());
            assert!(error < 3e-3, "{} {error:e}", bent.name());
        }
    }
}

#[test]
fn the_force_is_the_gradient_of_the_energy_and_forces_sum_to_zero() {
    let sheets = SheetPair::opposite(Vec3::zeros(), [40e-6, 30e-6], 50e-6, 0.2).unwrap();
    let x = places();
    let [fk, langevin, _] = laws();
    let models: [Box<dyn Model>; 4] = [
        Box::new(MutualDipoles::new().with_tolerance(1e-13)),
        Box::new(PairCorrected::new().with_tolerance(1e-13)),
        Box::new(Auto::new().with_tolerance(1e-13)),
        Box::new(Multipoles::new(5).with_tolerance(1e-13)),
    ];
    for mut model in models {
        for law in [&fk, &langevin] {
            let mut many = vec![Bead::new(RADIUS, 1500.0, law.clone()).unwrap(); x.len()];
            many[1] = Bead::new(0.9 * RADIUS, 1500.0, Intrinsic::new(0.6 * CHI).unwrap()).unwrap();
            many[5] = Bead::new(RADIUS, 1500.0, Magnetisation::Remanent(Vec3::new(1e4, -2e4, 3e4))).unwrap();
            let error = energy_gradient(&mut *model, &many, &x, &sheets);
            println!("{}: {error:e}", model.name());
            assert!(error < 1e-7, "{} {error:e}", model.name());
            let out = solve(&mut *model, &many, &x, &Uniform::new(Vec3::new(0.01, 0.03, 0.05)));
            let largest = out.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
            assert!(out.recoil().norm() < 1e-11 * largest, "{}", model.name());
        }
    }
}

#[test]
fn estimates_grow_where_beads_bend() {
    let x = places();
    let [fk, ..] = laws();
    let many = vec![Bead::new(RADIUS, 1500.0, fk).unwrap(); x.len()];
    let source = Uniform::new(Vec3::z() * FIELD);
    let pair: Soa3 = [Vec3::zeros(), Vec3::z() * (2.1 * RADIUS)].into_iter().collect();
    let doubt = |field: f64| {
        let source = Uniform::new(Vec3::z() * field);
        let bent = solve(&mut PairCorrected::new(), &many[..2], &pair, &source);
        let held = solve(&mut MutualDipoles::new(), &many[..2], &pair, &source);
        bent.error.force / (bent.force.get(1) - held.force.get(1)).norm()
    };
    println!(
        "doubt about the correction: {} weak, {} bent",
        doubt(1e-6),
        doubt(FIELD)
    );
    let bends = if cfg!(debug_assertions) { 1.02 } else { 1.5 };
    assert!(doubt(FIELD) > bends * doubt(1e-6));
    // What the rungs differ by among themselves is inside their estimates.
    let best = solve(&mut Multipoles::new(16), &many, &x, &source);
    for model in [
        &mut Auto::new() as &mut dyn Model,
        &mut PairCorrected::new(),
        &mut MutualDipoles::new(),
    ] {
        let out = solve(model, &many, &x, &source);
        let largest = (0..x.len())
            .map(|i| (out.force.get(i) - best.force.get(i)).norm())
            .fold(0.0, f64::max);
        println!("{}: {:.2} of the estimate", model.name(), largest / out.error.force);
        assert!(largest < out.error.force + best.error.force);
    }
}
