//! Contact as a constraint: beads on beads, on walls, with friction.

mod scene;

use lbm_ibm_coupling::{Plane, Soa3, Union, Vec3};
use lbm_ibm_magnetics::*;
use scene::RADIUS;
use std::f64::consts::PI;
use std::sync::Arc;

const VISCOSITY: f64 = 1e-3;
const ZETA: f64 = 6.0 * PI * VISCOSITY * RADIUS;

fn plain() -> Uniform {
    Uniform::new(Vec3::zeros())
}

fn run_of(x: &[Vec3]) -> Overdamped {
    let x: Soa3 = x.iter().copied().collect();
    Overdamped::new(
        scene::beads(x.len(), RADIUS, 2.0),
        x,
        plain(),
        FixedDipoles::new(),
        VISCOSITY,
    )
    .unwrap()
}

/// A force f on every bead, as gravity.
fn gravity_for(f: Vec3) -> Vec3 {
    let bead = &scene::beads(1, RADIUS, 2.0)[0];
    f / (bead.buoyant_weight(1000.0, Vec3::z()).z)
}

#[test]
fn a_bead_on_a_slope_sticks_below_the_friction_angle_and_slides_above() {
    let floor = Arc::new(Plane::new(Vec3::zeros(), Vec3::z()));
    for (slope, friction) in [(0.1, 0.2), (0.19, 0.2), (0.25, 0.2), (0.5, 0.2), (0.3, 0.0)] {
        let weight = 1e-12;
        let pull = Vec3::new(slope, 0.0, -1.0) * weight;
        let law = Constraint {
            friction: 0.0,
            wall_friction: friction,
            ..Constraint::default()
        };
        let mut run = run_of(&[Vec3::z() * RADIUS])
            .with_walls(floor.clone())
            .with_gravity(gravity_for(pull), 1000.0)
            .with_contact(law);
        run.run_to(1e-2).unwrap();
        let v = run.velocities().get(0).x;
        let expected = (slope - friction).max(0.0) * weight / (ZETA * parallel_drag(1e-3));
        assert!(
            (v - expected).abs() < 1e-6 * weight / ZETA,
            "{slope} {friction}: {v:e} {expected:e}"
        );
        let c = run.contacts()[0];
        assert_eq!((c.bead, c.with), (0, Partner::Wall(0)));
        assert!((c.normal_force / weight - 1.0).abs() < 1e-6);
        assert!((c.friction.norm() / weight - slope.min(friction)).abs() < 1e-6);
    }
}

#[test]
fn a_moving_wall_drags_beads_and_a_corner_holds_them() {
    // A wall that slides slowly takes a resting bead along.
    let belt = Arc::new(Plane::new(Vec3::zeros(), Vec3::z()).with_velocity(Vec3::x() * 1e-6));
    let weight = 1e-12;
    let mut run = run_of(&[Vec3::z() * RADIUS])
        .with_walls(belt)
        .with_gravity(gravity_for(Vec3::z() * -weight), 1000.0);
    run.run_to(1e-2).unwrap();
    assert!((run.velocities().get(0).x / 1e-6 - 1.0).abs() < 1e-6);
    // Pushed into a corner of two walls a bead has two contacts.
    let corner = Union::new()
        .with(Plane::new(Vec3::zeros(), Vec3::z()).with_part(1))
        .with(Plane::new(Vec3::zeros(), Vec3::x()).with_part(2));
    let mut run = run_of(&[Vec3::new(1.3, 0.0, 1.2) * RADIUS])
        .with_walls(Arc::new(corner))
        .with_gravity(gravity_for(Vec3::new(-1.0, 0.0, -2.0) * weight), 1000.0)
        .with_contact(Constraint::frictionless());
    run.run_to(3.0).unwrap();
    let forces: Vec<_> = run
        .contacts()
        .iter()
        .map(|c| (c.with, c.normal_force / weight))
        .collect();
    assert_eq!(forces.len(), 2, "{forces:?}");
    assert!(
        (forces[0].1 - 2.0).abs() < 1e-4 && (forces[1].1 - 1.0).abs() < 1e-4,
        "{forces:?}"
    );
    assert!((run.positions().get(0) - Vec3::new(1.0, 0.0, 1.0) * RADIUS).norm() < 1e-6 * RADIUS);
    assert!(run.overlap() < 1e-6 * RADIUS);
}

#[test]
fn contact_forces_add_up_along_a_pushed_column() {
    // Five beads under their weight on a floor: the lowest contact carries five weights.
    let weight = 1e-12;
    let x: Vec<Vec3> = (0..5).map(|k| Vec3::z() * (1.0 + 2.0 * k as f64) * RADIUS).collect();
    let floor = Arc::new(Plane::new(Vec3::zeros(), Vec3::z()));
    let mut run = run_of(&x)
        .with_walls(floor)
        .with_gravity(gravity_for(Vec3::z() * -weight), 1000.0);
    run.run_to(1e-3).unwrap();
    assert_eq!(run.contacts().len(), 5);
    for c in run.contacts() {
        let carried = match c.with {
            Partner::Wall(_) => 5.0,
            Partner::Bead(_) => 5.0 - c.bead.max(1) as f64,
        };
        let carried = if let Partner::Bead(j) = c.with {
            5.0 - j.max(c.bead) as f64
        } else {
            carried
        };
        assert!((c.normal_force / weight - carried).abs() < 1e-4 * carried, "{c:?}");
    }
}

#[test]
fn a_bead_slides_or_rolls_over_a_held_one() {
    // Pushed across and onto a held bead: with friction 0.2 and no rolling it moves at (push - 0.2 press)/zeta; rolling takes
    // no limit of friction and moves at push/(1/M + ...): v = M f with rim speed v - a w = 0, so f_t = v (8 pi eta a).
    let (push, press) = (1e-12, 2e-12);
    for rolling in [false, true] {
        let law = Constraint {
            friction: 0.9,
            rolling,
            ..Constraint::default()
        };
        let law = if rolling {
            law
        } else {
            Constraint { friction: 0.2, ..law }
        };
        let mut run = run_of(&[Vec3::zeros(), Vec3::z() * (2.0 * RADIUS)])
            .with_gravity(gravity_for(Vec3::new(push, 0.0, -press)), 1000.0)
            .with_contact(law);
        run.freeze(0);
        run.advance(1e-6).unwrap();
        let expected = if rolling {
            push / (ZETA * (1.0 + 8.0 / 6.0))
        } else {
            (push - 0.2 * press) / ZETA
        };
        let v = run.velocities().get(1);
        assert!(
            (v.x / expected - 1.0).abs() < 1e-4,
            "rolling {rolling}: {} {expected}",
            v.x
        );
        assert!(v.z.abs() < 1e-4 * expected);
    }
}
