//! Many beads between two plates form chains in a flow.

use lbm_ibm_coupling::{Grid, Noise, Plane, Soa3, Union, Vec3};
use lbm_ibm_magnetics::*;
use std::sync::{Arc, RwLock};

const A: f64 = 2.25e-6;
const HEIGHT: f64 = 30e-6;

fn scattered(n: usize, side: f64) -> Soa3 {
    let mut x: Vec<Vec3> = Vec::new();
    let mut k = 0;
    while x.len() < n {
        // Uniform enough: the fractional parts of wide normal numbers.
        let at = Noise::new(1, 0).normal(k).map(|c| (c * 100.0).rem_euclid(1.0));
        let p = Vec3::new(at.x * side, at.y * side, A * 1.01 + at.z * (HEIGHT - 2.02 * A));
        if x.iter().all(|q| (p - q).norm() > 2.02 * A) {
            x.push(p);
        }
        k += 1;
    }
    x.into_iter().collect()
}

fn run(contact: Constraint) -> Overdamped {
    let bead = Bead::new(A, 1600.0, Apparent::new(1.2).unwrap()).unwrap();
    let walls = Union::new()
        .with(Plane::new(Vec3::zeros(), Vec3::z()).with_part(0))
        .with(Plane::new(Vec3::z() * HEIGHT, -Vec3::z()).with_part(1));
    let flow = Flow::poiseuille(Vec3::z() * (0.5 * HEIGHT), Vec3::z(), HEIGHT, Vec3::x() * 1e-3).unwrap();
    let source = Uniform::new(Vec3::z() * 0.05);
    let x = scattered(50, 38e-6);
    let mut run = Overdamped::new(vec![bead; 50], x, source, PairCorrected::new(), 1e-3)
        .unwrap()
        .with_walls(Arc::new(walls))
        .with_contact(contact)
        .in_flow(flow);
    for k in 1..=4 {
        run.run_to(1e-4 * k as f64).unwrap();
        assert!(run.overlap() <= 1e-4 * A);
    }
    run
}

#[test]
fn beads_chain_without_overlap_and_with_forces_inside_the_friction_cone() {
    let law = Constraint::default();
    let end = run(law);
    let chains = find_chains(end.beads(), end.positions(), 0.02 * A);
    let longest = chains.iter().map(|c| c.beads.len()).max().unwrap();
    println!(
        "{} steps, {} contacts, {} chains, longest {longest}",
        end.steps(),
        end.contacts().len(),
        chains.len()
    );
    assert!(longest >= 5 && chains.len() <= 25);
    for c in end.contacts() {
        assert!(c.normal_force > 0.0 && c.since <= end.time() && c.gap < 1e-2 * A);
        assert!(c.friction.norm() <= law.friction * c.normal_force * (1.0 + 1e-9));
        assert!(c.friction.dot(&c.normal).abs() <= 1e-9 * c.normal_force);
    }
    let again = run(law);
    assert_eq!(
        end.positions().iter().collect::<Vec<_>>(),
        again.positions().iter().collect::<Vec<_>>()
    );
}

#[test]
fn flows_have_their_velocities() {
    let at = |f: &Flow, x: Vec3| f.velocity(x, 0.0);
    assert_eq!(at(&Flow::at_rest(), Vec3::x()), Vec3::zeros());
    let slit = Flow::poiseuille(Vec3::z(), Vec3::z(), 2.0, Vec3::x()).unwrap();
    assert_eq!(at(&slit, Vec3::z()).x, 1.5);
    assert_eq!(at(&slit, Vec3::z() * 2.0).x, 0.0);
    assert!(Flow::poiseuille(Vec3::z(), Vec3::z(), 0.0, Vec3::x()).is_err());
    // Trilinear samples have a linear field inside, no slip at walls, and wrap round.
    let grid = Grid::new([4, 5, 6], 0.5, [true, false, false]);
    let linear = |x: Vec3| Vec3::new(x.y + 2.0 * x.z, 1.0, -x.z);
    let nodes = (0..6).flat_map(|k| (0..5).flat_map(move |j| (0..4).map(move |i| [i, j, k])));
    let samples: Soa3 = nodes.map(|[i, j, k]| linear(grid.position(i, j, k))).collect();
    let sampled = SampledFlow::new(grid.clone(), samples.clone()).unwrap();
    for x in [
        Vec3::new(0.9, 1.1, 2.3),
        Vec3::new(-7.3, 0.25, 0.6),
        Vec3::new(40.0, 2.25, 2.75),
    ] {
        assert!((sampled.velocity(x) - linear(x)).norm() < 1e-12);
    }
    assert_eq!(sampled.velocity(Vec3::new(0.3, 0.0, 1.0)), Vec3::zeros());
    assert!((sampled.velocity(Vec3::new(0.3, 0.125, 1.0)) - 0.5 * linear(Vec3::new(0.3, 0.25, 1.0))).norm() < 1e-12);
    assert!(SampledFlow::new(grid, Soa3::zeros(3)).is_err());
    let shared = Arc::new(RwLock::new(sampled));
    let live = Flow::live(shared.clone());
    let before = at(&live, Vec3::new(0.9, 1.1, 2.3));
    let doubled = samples.iter().map(|u| u * 2.0).collect();
    shared.write().unwrap().set(doubled).unwrap();
    assert!((at(&live, Vec3::new(0.9, 1.1, 2.3)) - 2.0 * before).norm() < 1e-12);
}

#[test]
fn a_bead_in_a_wall_and_a_long_step_are_named() {
    let bead = Bead::new(A, 1600.0, Apparent::new(1.2).unwrap()).unwrap();
    assert!(Bead::new(0.0, 1600.0, Apparent::new(1.2).unwrap()).is_err());
    let system = |z: f64| {
        let x: Soa3 = [Vec3::z() * z].into_iter().collect();
        let floor = Arc::new(Plane::new(Vec3::zeros(), Vec3::z()).with_part(7));
        BeadSystem::new(
            vec![bead.clone()],
            x,
            Uniform::new(Vec3::zeros()),
            FixedDipoles::new(),
            1e-3,
        )
        .unwrap()
        .with_walls(floor)
    };
    let inside = Overdamped::from(system(0.5 * A)).run_to(1.0);
    assert!(matches!(
        inside,
        Err(MagneticsError::WallOverlap { bead: 0, part: 7, .. })
    ));
    let long = Brownian::new(system(3.0 * A), 300.0, 1e3, 0).unwrap().advance();
    assert!(matches!(long, Err(MagneticsError::LongStep { bead: 0, .. })));
    // A flow that takes the bead away leaves no place of rest.
    let away = QuasiStatic::new(system(3.0 * A).with_flow(Flow::uniform(Vec3::x())))
        .with_most_steps(50)
        .relax();
    assert!(matches!(away, Err(MagneticsError::NoRest { .. })));
}
