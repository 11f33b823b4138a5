//! Drag against `sphere_wall_drag.csv`, motion against `bead_dynamics.csv`.

mod scene;
mod table;

use lbm_ibm_coupling::{Plane, Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::RADIUS;
use std::f64::consts::PI;
use std::sync::Arc;
use table::Table;

const VISCOSITY: f64 = 1e-3;

#[test]
fn wall_drag_has_the_reference_values() {
    let table = Table::read(include_str!("data/sphere_wall_drag.csv"));
    for row in table.rows() {
        let gap = row.number("gap_over_a");
        assert!((perpendicular_drag(gap) / row.number("perp_brenner") - 1.0).abs() < 1e-8);
        assert!((bevan_prieve_drag(gap) / row.number("perp_bevan_prieve") - 1.0).abs() < 1e-6);
        assert!((faxen_drag(gap) / row.number("par_faxen5") - 1.0).abs() < 1e-8);
        assert!((near_wall_drag(gap) - row.number("par_near")).abs() < 1e-8);
        let parallel = row.number("par_faxen5").max(row.number("par_near"));
        assert!((parallel_drag(gap) / parallel - 1.0).abs() < 1e-8, "{gap}");
    }
    // Rows of bead_dynamics.csv, part b, mobility.
    for (x, exact) in [
        (6.0, 7.517928395049e-1),
        (3.0, 4.905195703357e-1),
        (2.05, 7.867023283899e-2),
        (2.01, 1.871877696750e-2),
    ] {
        assert!((squeeze_mobility(x) / exact - 1.0).abs() < 1e-11, "{x}");
    }
}

/// Two beads `x` radii apart at angle `alpha` from the field; the moment of a lone bead is that of mu_r = 2.
fn pair(x: f64, alpha: f64, mu: f64, model: impl Model + 'static, mobility: PairMobility) -> Overdamped {
    let places: Soa3 = [Vec3::zeros(), Vec3::new(alpha.sin(), 0.0, alpha.cos()) * (x * RADIUS)]
        .into_iter()
        .collect();
    let source = Uniform::new(Vec3::z() * 0.05);
    Overdamped::new(scene::beads(2, RADIUS, mu), places, source, model, VISCOSITY)
        .unwrap()
        .with_pair_mobility(mobility)
        .with_steps(1e-6, f64::INFINITY)
}

/// t0 = 2 pi^2 eta a^6/(mu0 m^2).
fn t0(mu: f64) -> f64 {
    let m = scene::beads(1, RADIUS, mu)[0].response(Vec3::z() * 0.05).moment.z;
    2.0 * PI * PI * VISCOSITY * RADIUS.powi(6) / (MU0 * m * m)
}

/// Time (in t0) and angle at which the pair comes to `x` radii.
fn time_to(run: &mut Overdamped, x: f64, mu: f64) -> (f64, f64) {
    let apart = |run: &Overdamped| run.positions().get(1) - run.positions().get(0);
    loop {
        let (before, from) = (run.time(), apart(run));
        let at = from.norm() / RADIUS;
        run.advance(f64::INFINITY).unwrap();
        let now = apart(run).norm() / RADIUS;
        if let Some(contact) = run.contacts().first() {
            let r = apart(run);
            return (contact.since / t0(mu), r.x.atan2(r.z));
        }
        if now <= x {
            let s = (at - x) / (at - now);
            let r = from + (apart(run) - from) * s;
            return ((before + s * (run.time() - before)) / t0(mu), r.x.atan2(r.z));
        }
    }
}

#[test]
fn aligned_pairs_meet_after_the_closed_form_time() {
    for (a, ratio) in [(2.25e-6, 2.0), (5e-6, 1.5)] {
        let d: f64 = 2.0 * a;
        let chi = Intrinsic::new(1.0).unwrap();
        let bead = Bead::new(a, 1500.0, chi).unwrap();
        let m = bead.response(Vec3::z() * 0.05).moment.z;
        let expected = 2.0 * PI * PI * VISCOSITY * a * ((ratio * d).powi(5) - d.powi(5)) / (5.0 * MU0 * m * m);
        let x: Soa3 = [Vec3::zeros(), Vec3::z() * (ratio * d)].into_iter().collect();
        let source = Uniform::new(Vec3::z() * 0.05);
        let mut run = Overdamped::new(vec![bead; 2], x, source, FixedDipoles::new(), VISCOSITY).unwrap();
        for (quarter, at) in [
            (0.25, [1.892092431844, 1.428350981082]),
            (0.75, [1.543126788416, 1.215060620170]),
        ] {
            run.run_to(quarter * expected).unwrap();
            let r = (run.positions().get(1) - run.positions().get(0)).norm() / d;
            let reference = at[if ratio == 2.0 { 0 } else { 1 }];
            assert!((r / reference - 1.0).abs() < 1e-3, "{r} {reference}");
        }
        while run.contacts().is_empty() {
            run.advance(f64::INFINITY).unwrap();
        }
        let contact = run.contacts()[0];
        println!(
            "contact after {:e} s, {:e}",
            contact.since,
            contact.since / expected - 1.0
        );
        assert!((contact.since / expected - 1.0).abs() < 1e-3);
        assert!(contact.gap.abs() < 1e-6 * d && run.overlap() < 1e-6 * d);
        // 3 mu0 m^2/(2 pi d^4).
        let pull = 1.5 * MU0 * m * m / (PI * d.powi(4));
        run.run_to(1.1 * expected).unwrap();
        assert!((run.contacts()[0].normal_force / pull - 1.0).abs() < 1e-6);
        assert!(run.velocities().get(0).norm() < 1e-6 * pull / (6.0 * PI * VISCOSITY * a));
        assert!(run.regime().reynolds > 0.0);
    }
}

#[test]
fn perpendicular_and_oblique_pairs_have_the_reference_motion() {
    let mut run = pair(2.5, PI / 2.0, 2.0, FixedDipoles::new(), PairMobility::None);
    run.run_to(1000.0 * t0(2.0)).unwrap();
    let x = (run.positions().get(1) - run.positions().get(0)).norm() / RADIUS;
    assert!((x / 4.818549624650 - 1.0).abs() < 1e-4, "{x}");
    for (alpha, x0, time, angle) in [
        (1.2, 6.0, 1.5096320810e4, 1.8985907451e-1),
        (0.5, 6.0, 2.0538718713e3, 1.5114315030e-1),
        (1.5, 4.0, 1.0571043060e5, 1.3364205489e-1),
    ] {
        let mut run = pair(x0, alpha, 2.0, FixedDipoles::new(), PairMobility::None);
        let (t, at) = time_to(&mut run, 2.0, 2.0);
        println!(
            "oblique {alpha}: time {:e}, angle {:e}",
            t / time - 1.0,
            at / angle - 1.0
        );
        assert!((t / time - 1.0).abs() < 5e-3 && (at / angle - 1.0).abs() < 5e-3);
    }
}

#[test]
fn hydrodynamic_interaction_and_exact_forces_have_the_reference_times() {
    use PairMobility::{None, RotnePrager, Squeeze};
    let fixed = || -> Box<dyn Model> { Box::new(FixedDipoles::new()) };
    let exact = || -> Box<dyn Model> { Box::new(PairCorrected::new().with_reach(12.0)) };
    // Times at x = 5, 3, 2.2, 2.01 of bead_dynamics.csv, part b, start x = 6.
    type Case = (&'static str, f64, Box<dyn Model>, PairMobility, [f64; 4]);
    let cases: [Case; 6] = [
        (
            "fixed, none",
            2.0,
            fixed(),
            None,
            [9.302e2, 1.5066e3, 1.544892736e3, 1.548638392e3],
        ),
        (
            "fixed, Rotne-Prager",
            2.0,
            fixed(),
            RotnePrager,
            [1.2652846852e3, 2.1423667172e3, 2.2208327431e3, 2.2303064593e3],
        ),
        (
            "fixed, squeeze",
            2.0,
            fixed(),
            Squeeze,
            [1.2721692176e3, 2.1685429477e3, 2.26624762e3, 2.3026858936e3],
        ),
        (
            "exact 2, squeeze",
            2.0,
            exact(),
            Squeeze,
            [1.2637083151e3, 2.1437919587e3, 2.2315750232e3, 2.2579372805e3],
        ),
        (
            "exact 4, squeeze",
            4.0,
            exact(),
            Squeeze,
            [1.2553643296e3, 2.1196938116e3, 2.1985789343e3, 2.2164495835e3],
        ),
        (
            "exact 4, none",
            4.0,
            exact(),
            None,
            [9.1795237052e2, 1.4746237389e3, 1.5060846231e3, 1.508076923e3],
        ),
    ];
    for (name, mu, model, mobility, times) in cases {
        let mut run = pair(6.0, 0.0, mu, model, mobility);
        for (x, expected) in [5.0, 3.0, 2.2, 2.01].into_iter().zip(times) {
            let t = time_to(&mut run, x, mu).0;
            println!("{name} x {x}: {:e}", t / expected - 1.0);
            assert!((t / expected - 1.0).abs() < 5e-3, "{name} {x}: {t} {expected}");
        }
    }
}

#[test]
fn a_bead_sinks_slower_near_a_wall_and_rests_on_its_repulsion() {
    let bead = Bead::new(RADIUS, 2000.0, Intrinsic::new(1.0).unwrap()).unwrap();
    let weight = bead.buoyant_weight(1000.0, Vec3::z() * -9.81).norm();
    let gap = 0.1 * RADIUS;
    let x: Soa3 = [Vec3::z() * (RADIUS + gap)].into_iter().collect();
    let floor = Arc::new(Plane::new(Vec3::zeros(), Vec3::z()));
    let still = Uniform::new(Vec3::zeros());
    let new = || {
        Overdamped::new(vec![bead.clone()], x.clone(), still, FixedDipoles::new(), VISCOSITY)
            .unwrap()
            .with_gravity(Vec3::z() * -9.81, 1000.0)
            .with_walls(floor.clone())
    };
    let mut run = new();
    run.advance(1e-9).unwrap();
    let free = weight / (6.0 * PI * VISCOSITY * RADIUS);
    assert!((-run.velocities().get(0).z / free * 11.4591572 - 1.0).abs() < 1e-4);
    let law = Repulsion {
        strength: 100.0 * weight,
        range: 10e-9,
    };
    let mut run = new().with_contact(law).with_flow(|x, _| Vec3::x() * (100.0 * x.z));
    run.run_to(0.5).unwrap();
    let rest = run.positions().get(0);
    assert!((rest.z - RADIUS - 10e-9 * 100f64.ln()).abs() < 1e-9, "{}", rest.z);
    assert!(rest.x > 0.9 * 100.0 * RADIUS * 0.5 && run.regime().is_overdamped());
}

#[test]
fn bad_starts_are_named_and_frozen_beads_stay() {
    let x: Soa3 = [Vec3::zeros(), Vec3::z() * RADIUS].into_iter().collect();
    let source = Uniform::new(Vec3::z() * 0.05);
    let beads = scene::beads(2, RADIUS, 2.0);
    let overlap = Overdamped::new(beads.clone(), x.clone(), source, FixedDipoles::new(), 1e-3);
    assert!(matches!(overlap.err(), Some(MagneticsError::Overlap { .. })));
    let thin = Overdamped::new(beads, x, source, FixedDipoles::new(), 0.0);
    assert!(matches!(thin.err(), Some(MagneticsError::NotPositive { .. })));
    let mut run = pair(3.0, 0.0, 2.0, MutualDipoles::new(), PairMobility::None);
    run.freeze(0);
    run.run_to(1e-5).unwrap();
    assert_eq!(run.positions().get(0), Vec3::zeros());
    assert!(run.positions().get(1).z < 3.0 * RADIUS);
}
