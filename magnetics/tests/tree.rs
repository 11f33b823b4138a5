//! The tree against the direct sum.

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;

const RADIUS: f64 = 2e-6;

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
    (*seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
}

fn vector(seed: &mut u64) -> Vec3 {
    Vec3::new(random(seed), random(seed), random(seed))
}

/// A lattice of `spacing` radii, every bead moved by up to a fifth of the free space.
fn cloud(n: usize, spacing: f64, seed: &mut u64) -> Soa3 {
    let side = (n as f64).cbrt().ceil() as usize;
    let place = |k: usize| Vec3::new((k % side) as f64, (k / side % side) as f64, (k / side / side) as f64);
    (0..n)
        .map(|k| (place(k) * spacing + vector(seed) * (0.2 * (spacing - 2.0))) * RADIUS)
        .collect()
}

/// Upright chains of ten beads with gaps of 0.05 radii.
fn chains(n: usize) -> Soa3 {
    let side = (n as f64 / 10.0).sqrt().ceil() as usize;
    (0..n)
        .map(|k| {
            let (chain, link) = (k / 10, k % 10);
            Vec3::new(
                (chain % side) as f64 * 6.0,
                (chain / side) as f64 * 6.0,
                link as f64 * 2.05,
            ) * RADIUS
        })
        .collect()
}

/// Dense clumps far apart, and a few beads between them.
fn clumps(n: usize, seed: &mut u64) -> Soa3 {
    let mut x = Soa3::default();
    for k in 0..8 {
        let centre = Vec3::new((k % 2) as f64, (k / 2 % 2) as f64, (k / 4) as f64) * (400.0 + 37.0 * k as f64) * RADIUS;
        cloud(n / 8 - 20, 2.4, seed).iter().for_each(|p| x.push(p + centre));
    }
    (0..160).for_each(|k| x.push(Vec3::new(90.0 + 3.0 * k as f64, 60.0, 55.0) * RADIUS));
    x
}

fn moments(n: usize, seed: &mut u64) -> Soa3 {
    (0..n).map(|_| (Vec3::z() + vector(seed) * 0.3) * 1e-12).collect()
}

fn rms(v: impl Iterator<Item = Vec3>) -> f64 {
    v.map(|f| f.norm_squared()).sum::<f64>().sqrt()
}

fn off(a: &Soa3, b: &Soa3) -> f64 {
    rms(a.iter().zip(b.iter()).map(|(a, b)| a - b)) / rms(b.iter())
}

#[test]
fn the_error_falls_with_order_and_opening_and_the_report_knows_it() {
    let seed = &mut 7;
    for (name, x) in [
        ("cloud", cloud(6000, 3.0, seed)),
        ("chains", chains(6000)),
        ("clumps", clumps(6000, seed)),
    ] {
        let m = moments(x.len(), seed);
        let (mut direct, mut out) = (Solution::new(), Solution::new());
        dipole_forces(x.view(), m.view(), true, &mut direct);
        let mut last = f64::INFINITY;
        for (order, opening) in [(4, 0.6), (6, 0.5), (8, 0.4), (10, 0.3)] {
            let tree = Tree::new().with_order(order).unwrap().with_opening(opening).unwrap();
            let report = tree_forces(x.view(), m.view(), true, tree, &mut out);
            let (force, torque) = (off(&out.force, &direct.force), off(&out.torque, &direct.torque));
            println!("{name} order {order} opening {opening}: force {force:.1e}, torque {torque:.1e}, {report:?}");
            // Contacts make most of the force but not of the torque, whose share of the far field is larger.
            assert!(force < 0.35 * last && torque < 10.0 * force, "{name} {order} {opening}");
            // A sample: in clumps a few beads have most of the error.
            assert!(
                report.rms_error < 5.0 * force && report.rms_error > 0.2 * force,
                "{name}: {report:?}"
            );
            last = force;
        }
        assert!(last < 1e-6, "{name}: {last:e}");
    }
}

#[test]
fn an_accuracy_that_is_asked_for_is_reached() {
    let seed = &mut 11;
    let x = cloud(20_000, 3.0, seed);
    let m = moments(x.len(), seed);
    let (mut direct, mut out) = (Solution::new(), Solution::new());
    dipole_forces(x.view(), m.view(), false, &mut direct);
    for accuracy in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let tree = Tree::new().with_accuracy(accuracy).unwrap();
        tree_forces(x.view(), m.view(), false, tree, &mut out);
        let force = off(&out.force, &direct.force);
        println!("accuracy {accuracy:e}: {force:.1e}, {tree:?}");
        assert!(force < accuracy, "{accuracy:e}: {force:e}");
    }
}

#[test]
fn settings_that_no_tree_has_are_named() {
    let tree = Tree::new();
    assert!(tree.with_accuracy(0.0).is_err() && tree.with_accuracy(f64::NAN).is_err());
    assert!(tree.with_order(2).is_err() && tree.with_order(11).is_err());
    let message = tree.with_opening(1.5).unwrap_err().to_string();
    assert!(message.contains("opening") && message.contains("1.5"), "{message}");
}

#[test]
fn no_bead_one_bead_and_beads_at_one_place_are_summed() {
    for n in [0, 1, 200] {
        let x: Soa3 = (0..n).map(|_| Vec3::repeat(1e-6)).collect();
        let mut out = Solution::new();
        tree_forces(x.view(), moments(n, &mut 3).view(), true, Tree::new(), &mut out);
        assert!(out.force.len() == n && out.force.iter().all(|f| f == Vec3::zeros()));
    }
}

/// Beads of two sizes, some of which touch or overlap a little.
fn unequal(n: usize) -> (Vec<Bead>, Soa3) {
    let chi = Intrinsic::new(3.0).unwrap();
    let radius = |k: usize| if k.is_multiple_of(3) { RADIUS } else { 0.6 * RADIUS };
    let beads = (0..n).map(|k| Bead::new(radius(k), 1500.0, chi).unwrap()).collect();
    (beads, cloud(n, 2.2, &mut 5))
}

#[test]
fn every_rung_has_the_solution_of_the_direct_sum() {
    let (beads, x) = unequal(2000);
    let source = SheetPair::opposite(Vec3::new(3e-5, 2e-5, 3e-5), [4e-4, 3e-4], 3e-4, 0.2).unwrap();
    let problem = Problem::new(&beads, x.view(), &source, 0.0).unwrap();
    let tree = Tree::new().with_accuracy(1e-5).unwrap();
    let compare = |mut direct: Box<dyn Model>, mut model: Box<dyn Model>| {
        let (mut a, mut b) = (Solution::new(), Solution::new());
        direct.solve(&problem, &mut a).unwrap();
        model.solve(&problem, &mut b).unwrap();
        let (force, moment) = (off(&b.force, &a.force), off(&b.moment, &a.moment));
        println!("{}: force {force:.1e}, moment {moment:.1e}", model.name());
        assert!(force < 5e-5 && moment < 1e-5, "{}: {force:e} {moment:e}", model.name());
        assert!((b.energy - a.energy).abs() < 1e-6 * a.energy.abs());
    };
    let (fixed, mutual) = (FixedDipoles::new(), MutualDipoles::new());
    compare(Box::new(fixed.clone()), Box::new(fixed.with_tree(tree)));
    compare(Box::new(mutual.clone()), Box::new(mutual.with_tree(tree)));
    let corrected = PairCorrected::new();
    compare(Box::new(corrected.clone()), Box::new(corrected.with_tree(tree)));
}

#[test]
fn the_force_of_mutual_dipoles_by_a_tree_is_the_gradient_of_their_energy() {
    let (beads, x) = unequal(300);
    // A coarse tree: its error is a thousand times what the gradient is held to.
    let tree = Tree::new().with_order(4).unwrap().with_opening(0.7).unwrap();
    let mut model = MutualDipoles::new().with_tolerance(1e-12).with_tree(tree);
    let source = Uniform::new(Vec3::new(0.01, 0.02, 0.05));
    let mut solve = |x: &Soa3| {
        let mut out = Solution::new();
        model
            .solve(&Problem::new(&beads, x.view(), &source, 0.0).unwrap(), &mut out)
            .unwrap();
        out
    };
    let force = solve(&x).force;
    let largest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let h = 1e-4 * RADIUS;
    for i in [0, 57, 123, 200, 299] {
        for a in 0..3 {
            let mut energy = |s: f64| {
                let mut y = x.clone();
                y.add(i, Vec3::ith(a, s * h));
                solve(&y).energy
            };
            let slope = (energy(1.0) - energy(-1.0)) / (2.0 * h);
            let error = (force.get(i)[a] + slope).abs() / largest;
            assert!(error < 1e-4, "bead {i} axis {a}: {error:e}");
        }
    }
}

#[cfg(feature = "parallel")]
#[test]
fn the_same_bits_for_any_number_of_threads() {
    let (beads, x) = unequal(1500);
    let source = Uniform::new(Vec3::new(0.01, 0.02, 0.05));
    let problem = Problem::new(&beads, x.view(), &source, 0.0).unwrap();
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut out = Solution::new();
        pool.install(|| PairCorrected::new().with_tree(Tree::new()).solve(&problem, &mut out))
            .unwrap();
        out
    };
    let (one, three) = (solve(1), solve(3));
    assert!(one.force == three.force && one.moment == three.moment && one.energy == three.energy);
}
