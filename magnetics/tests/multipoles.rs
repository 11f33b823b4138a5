//! Near multipoles against `bead_cluster_force.csv`, `two_sphere_force.csv` and `bead_chain_tension.csv`.

mod scene;
mod table;

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::{FIELD, FORCE, RADIUS, beads, cluster, energy_gradient, solve, units};
use table::Table;

#[test]
fn clusters_to_1e_4_at_the_default_order_and_1e_7_at_a_high_one() {
    let table = Table::read(include_str!("data/bead_cluster_force.csv"));
    let rows: Vec<_> = table.rows().collect();
    let key = |k: usize| (rows[k].text("config"), rows[k].text("mu_r"));
    let mut first = 0;
    while first < rows.len() {
        let last = (first..rows.len())
            .find(|k| key(*k) != key(first))
            .unwrap_or(rows.len());
        let group = &rows[first..last];
        let x: Soa3 = group.iter().map(|r| r.vector("x", "y", "z") * RADIUS).collect();
        let mu = group[0].number("mu_r");
        let beads = beads(x.len(), RADIUS, mu);
        let source = Uniform::new(Vec3::z() * FIELD);
        let largest = group
            .iter()
            .map(|r| r.vector("Fx", "Fy", "Fz").norm())
            .fold(0.0, f64::max);
        for (mut model, limit) in [
            (Multipoles::default(), 1e-4),
            (Multipoles::new(26).with_tolerance(1e-12), 1e-7),
        ] {
            if limit < 1e-5 && cfg!(debug_assertions) {
                continue;
            }
            let out = solve(&mut model, &beads, &x, &source);
            let mut off: f64 = 0.0;
            for (i, row) in group.iter().enumerate() {
                off = off.max((out.force.get(i) / FORCE - row.vector("Fx", "Fy", "Fz")).norm() / largest);
                let m = out.moment.get(i) / units::MOMENT - row.vector("mx", "my", "mz");
                assert!(m.norm() < limit);
            }
            let estimate = out.error.force / FORCE / largest;
            println!(
                "{} mu {mu}: {off:.2e}, estimate {estimate:.2e}, {} iterations",
                key(first).0,
                out.error.iterations
            );
            assert!(off < limit && off < estimate + 2e-12);
        }
        first = last;
    }
}

#[test]
fn pairs_to_1e_6_from_gaps_of_a_tenth_and_at_contact_to_mu_4() {
    let table = Table::read(include_str!("data/two_sphere_force.csv"));
    let mut worst = 0.0f64;
    for row in table.rows() {
        let (mu, s) = (row.number("mu_r"), row.number("s"));
        if s < 2.1 && (mu > 4.0 || s > 2.0) || cfg!(debug_assertions) && (s < 2.3 || mu > 4.0) {
            continue;
        }
        // The multipoles that the reference needed for 1e-12, and half as many at most.
        let order = if s < 2.1 {
            70
        } else {
            (0.6 * row.number("Lmax")).ceil() as usize
        };
        let mut model = Multipoles::new(order).with_tolerance(1e-13).with_reach(100.0);
        let x: Soa3 = [Vec3::zeros(), Vec3::new(0.36, 0.48, 0.8) * (s * RADIUS)]
            .into_iter()
            .collect();
        let n = Vec3::new(0.36, 0.48, 0.8);
        let across = Vec3::new(0.8, -0.6, 0.0);
        for (field, name) in [(n, "F_par"), (across, "F_perp")] {
            let out = solve(&mut model, &beads(2, RADIUS, mu), &x, &Uniform::new(field * FIELD));
            let error = (out.force.get(1) / FORCE - n * row.number(name)).norm() / row.number(name).abs();
            let estimate = out.error.force / FORCE / row.number(name).abs();
            assert!(error < 1e-6, "mu {mu} s {s} {name}: {error:e}");

            assert!(error < estimate + 1e-10, "mu {mu} s {s} {name}: {error:e} {estimate:e}");
            worst = worst.max(error);
        }
    }
    println!("pairs: {worst:e}");
}

#[test]
fn unequal_pairs_as_equal_ones() {
    let table = Table::read(include_str!("data/unequal_pair_force.csv"));
    let mut worst = 0.0f64;
    for row in table
        .rows()
        .filter(|r| r.number("gap") >= if cfg!(debug_assertions) { 0.5 } else { 0.1 })
    {
        let beads: Vec<_> = [("a1", "mu1"), ("a2", "mu2")]
            .map(|(a, mu)| {
                let chi = Intrinsic::new(row.number(mu) - 1.0).unwrap();
                Bead::new(row.number(a) * RADIUS, 1500.0, chi).unwrap()
            })
            .into();
        let x: Soa3 = [Vec3::zeros(), Vec3::z() * (row.number("R") * RADIUS)]
            .into_iter()
            .collect();
        let mut model = Multipoles::new(if cfg!(debug_assertions) { 24 } else { 45 })
            .with_tolerance(1e-12)
            .with_reach(20.0);
        for (axis, name) in [(Vec3::z(), "F_par"), (Vec3::x(), "F_perp")] {
            let out = solve(&mut model, &beads, &x, &Uniform::new(axis * FIELD));
            worst = worst.max((out.force.get(1).z / FORCE / row.number(name) - 1.0).abs());
        }
    }
    println!("unequal pairs: {worst:e}");
    assert!(worst < 1e-6);
}

#[test]
fn the_force_is_the_gradient_of_the_energy_and_forces_sum_to_zero() {
    let mut x = cluster(2, 2.2);
    x.push(Vec3::new(9e-6, 1e-6, 3e-6));
    x.push(Vec3::new(40e-6, 1e-6, 3e-6));
    let chi = |mu: f64| Intrinsic::new(mu - 1.0).unwrap();
    let mut beads: Vec<_> = (0..x.len())
        .map(|i| Bead::new(RADIUS, 1500.0, chi(2.0 + i as f64)).unwrap())
        .collect();
    beads[4] = Bead::new(1.5 * RADIUS, 1500.0, Magnetisation::Remanent(Vec3::new(1e4, -2e4, 3e4))).unwrap();
    let sheets = SheetPair::opposite(Vec3::zeros(), [40e-6, 30e-6], 50e-6, 0.2).unwrap();
    for diamagnetic in [false, true] {
        if diamagnetic {
            beads[1] = Bead::new(RADIUS, 1500.0, chi(0.3)).unwrap();
        }
        let mut model = Multipoles::new(5).with_tolerance(1e-13);
        let error = energy_gradient(&mut model, &beads, &x, &sheets);
        println!("energy {error:e}");
        assert!(error < 1e-7, "{error:e}");
        let out = solve(&mut model, &beads, &x, &Uniform::new(Vec3::new(0.01, 0.03, 0.05)));
        let largest = out.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        assert!(out.recoil().norm() < 1e-11 * largest);
    }
}

#[test]
fn order_one_is_mutual_dipoles_and_packed_overlap_stays_finite() {
    let x = cluster(3, 2.05);
    let many = beads(x.len(), RADIUS, 10.0);
    let source = Uniform::new(Vec3::new(0.01, 0.02, 0.05));
    let one = solve(
        &mut Multipoles::new(1).with_reach(5.0).with_tolerance(1e-13),
        &many,
        &x,
        &source,
    );
    let dipoles = solve(&mut MutualDipoles::new().with_tolerance(1e-13), &many, &x, &source);
    let largest = dipoles.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    for i in 0..x.len() {
        assert!((one.force.get(i) - dipoles.force.get(i)).norm() < 1e-9 * largest);
    }
    let close = cluster(2, 1.95);
    let out = solve(
        &mut Multipoles::new(6),
        &beads(close.len(), RADIUS, 100.0),
        &close,
        &source,
    );
    assert!(out.moment.iter().all(|m| m.norm() < 10.0 * units::MOMENT));
}

#[test]
fn an_order_or_a_reach_that_cannot_be_had_is_refused_with_its_numbers() {
    let beads = beads(2, RADIUS, 3.0);
    let x: Soa3 = [Vec3::zeros(), Vec3::x() * (2.5 * RADIUS)].into_iter().collect();
    let source = Uniform::new(Vec3::z() * FIELD);
    let refused = |model: &mut dyn Model| {
        let problem = Problem::new(&beads, x.view(), &source, 0.0).unwrap();
        model.solve(&problem, &mut Solution::new()).unwrap_err().to_string()
    };
    let told = [
        refused(&mut Multipoles::new(71)),
        refused(&mut Multipoles::new(0)),
        refused(&mut Multipoles::new(8).with_reach(1.5)),
        refused(&mut Auto::new().with_order(41)),
    ];
    for (text, limits) in told.iter().zip([
        "71, it must lie in [1, 70]",
        "[1, 70]",
        "1.5",
        "41, it must lie in [2, 40]",
    ]) {
        assert!(text.contains(limits), "{text}");
    }
}
