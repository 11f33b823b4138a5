//! A scene that is saved half way, and restored into one built anew, goes on as if it had never stopped: to the last bit.

use lbm_ibm::contact::{CellRepulsion, SoftSphere, WallRepulsion};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{
    Boundary, Elasticity, Grid, ImmersedBody, Motion, Plane, RigidDrive, Scene, SceneError, Soa3, StateError, UM,
    Union, Vec3,
};
use lbm_ibm::ibm::{Buoyancy, DeltaExchange, Kernel, RigidBody};
use lbm_ibm::lbm::{Drive, Fluid, Pace, Precision};
use lbm_ibm::magnetics::{Bead, BeadForces, Intrinsic, PairCorrected, Uniform};
use lbm_ibm::membrane::{Cell, Mesh, laws};
use lbm_ibm::output::{CheckpointError, read_checkpoint, write_checkpoint};
use std::error::Error;
use std::sync::Arc;

type Built = Result<Scene, Box<dyn Error>>;
type Build = fn() -> Built;

const STEPS: usize = 7;

fn walls() -> Arc<dyn Boundary> {
    let low = Plane::new(Vec3::y() * UM, Vec3::y()).with_velocity(Vec3::x() * 1e-3);
    Arc::new(
        Union::new()
            .with(low)
            .with(Plane::new(Vec3::y() * 15.0 * UM, -Vec3::y()).with_part(1)),
    )
}

fn fluid() -> Result<Fluid, Box<dyn Error>> {
    Ok(Fluid::new(
        Grid::new([24, 16, 16], UM, [true; 3]),
        1e3,
        1e-3,
        Pace::Tau(1.0),
    )?)
}

fn scene(fluid: Fluid) -> Scene {
    Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree))
}

fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x * UM, y * UM, z * UM)
}

fn cell() -> Result<Cell, Box<dyn Error>> {
    let mesh = Arc::new(Mesh::sphere(4.0 * UM, 162)?);
    Ok(Cell::new("cell", mesh.clone())
        .with_law(laws::Skalak::new(&mesh, 5e-6, 1.0)?)
        .with_law(laws::Bending::new(&mesh, 2e-19)?))
}

/// Two cells that touch walls and each other, under a held flux, and a pull on their shape at the start.
fn cells_between_walls() -> Built {
    let mut scene = scene(fluid()?.with_drive(Drive::flux(0, 1e-3))?);
    scene.set_walls(walls())?;
    for x in [6.0, 14.6] {
        let id = scene.add_body(cell()?, &at(x, 7.0, 8.0))?;
        let middle = scene.body_positions(id)?.mean();
        let wider: Soa3 = scene
            .body_positions(id)?
            .iter()
            .map(|p| middle + (p - middle).component_mul(&Vec3::new(0.95, 1.3, 0.9)))
            .collect();
        scene.set_body_positions(id, wider.view())?;
    }
    scene.add_field(WallRepulsion::new(walls(), SoftSphere::paper_wall().scaled(0.1)));
    scene.add_field(CellRepulsion::new(SoftSphere::paper_cell().scaled(0.01)));
    Ok(scene)
}

/// A stiff membrane, its forces those at the end of the step.
fn implicit() -> Built {
    let mut scene = cells_between_walls()?;
    scene.set_elasticity(Elasticity::IMPLICIT);
    Ok(scene)
}

/// Beads lighter and heavier than the fluid, one of them held.
fn beads() -> Built {
    let mut scene = scene(fluid()?.with_drive(Drive::Force(Vec3::new(10.0, 2.0, 0.0)))?);
    let mut weight = Buoyancy::new(Vec3::z() * -9.81);
    for (i, density) in [500.0, 1000.0, 4000.0].into_iter().enumerate() {
        let body = RigidBody::sphere(2.5 * UM, density)?.with_kind(format!("bead {i}"));
        weight = weight.with(format!("bead {i}"), body.excess_mass(1e3));
        scene.add_body(body, &at(4.0 + 7.5 * i as f64, 8.2, 7.9))?;
    }
    scene.add_body(RigidBody::sphere(2.0 * UM, 1e3)?.held(), &at(8.0, 3.0, 8.0))?;
    scene.add_field(weight);
    Ok(scene)
}

/// Beads that magnetise each other; each solution starts from the last.
fn magnetic_beads() -> Built {
    let mut scene = scene(fluid()?);
    let bead = Bead::new(2.5 * UM, 1500.0, Intrinsic::new(3.0)?)?;
    for x in [5.0, 10.5, 16.0] {
        scene.add_body(RigidBody::sphere(2.5 * UM, 1500.0)?.with_kind("bead"), &at(x, 8.0, 8.0))?;
    }
    let source = Uniform::new(Vec3::new(0.02, 0.01, 0.0));
    scene.add_field(BeadForces::new(source, PairCorrected::new()).with_kind("bead", bead));
    Ok(scene)
}

/// A cell with a thicker fluid inside, its volume held, with a viscous membrane; and one whose markers lie inside of it.
fn contrast() -> Built {
    let exchange = DeltaExchange::new(Kernel::RomaThree).with_elastic_inset(true);
    let mut fluid = fluid()?;
    fluid.set_velocity(|x| Vec3::x() * (100.0 * x.y));
    let mut scene = Scene::with_fluid(fluid, exchange);
    scene.set_walls(walls())?;
    let cell = cell()?;
    let memory = laws::Maxwell::new(cell.mesh(), 1e-8, 5e-5)?;
    let cell = cell.with_law(memory).with_viscosity_ratio(5.0)?.with_constant_volume();
    scene.add_body(cell, &at(12.0, 8.0, 8.0))?;
    Ok(scene)
}

/// A cell in a fluid that fluctuates.
fn thermal() -> Built {
    let mut scene = scene(fluid()?.with_precision(Precision::F32).with_temperature(300.0, 7)?);
    scene.add_body(cell()?, &at(12.0, 8.0, 8.0))?;
    Ok(scene)
}

/// Nodes with a mass and friction against the fluid beside a bead, after a body has gone.
fn friction() -> Built {
    let mut scene = scene(fluid()?.with_drive(Drive::Force(Vec3::x() * 1e3))?);
    let gone = scene.add_body(cell()?, &at(6.0, 8.0, 8.0))?;
    let motion = Motion::Newton {
        node_mass: 1e-14,
        friction: 1e-9,
    };
    scene.add_body(cell()?.with_motion(motion), &at(17.0, 8.0, 8.0))?;
    scene.add_body(RigidBody::sphere(2.5 * UM, 2e3)?, &at(6.0, 8.0, 8.0))?;
    scene.remove_body(gone)?;
    Ok(scene)
}

/// A cell that creeps without a fluid.
fn overdamped() -> Built {
    let mut scene = Scene::without_fluid(1e-7)?;
    let cell = cell()?.with_motion(Motion::Overdamped { friction: 1e-8 });
    let wider: Soa3 = cell.reference().iter().map(|p| p * 1.1).collect();
    let id = scene.add_body(cell, &Isometry3::identity())?;
    scene.set_body_positions(id, wider.view())?;
    Ok(scene)
}

const SCENES: &[(&str, Build)] = &[
    ("cells between walls", cells_between_walls),
    ("implicit elasticity", implicit),
    ("rigid beads", beads),
    ("magnetic beads", magnetic_beads),
    ("viscosity contrast", contrast),
    ("thermal", thermal),
    ("friction", friction),
    ("overdamped", overdamped),
];

fn run(scene: &mut Scene, steps: usize) -> Result<(), SceneError> {
    (0..steps).try_for_each(|_| scene.step())
}

#[test]
fn a_restored_scene_goes_on_to_the_last_bit() -> Result<(), Box<dyn Error>> {
    for (name, build) in SCENES {
        let mut straight = build()?;
        run(&mut straight, 2 * STEPS)?;
        let mut half = build()?;
        run(&mut half, STEPS)?;
        let saved = half.save()?;
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            let mut again = build()?;
            // It may have run before.
            run(&mut again, threads)?;
            again.restore(&saved)?;
            assert_eq!((again.steps(), again.time()), (half.steps(), half.time()), "{name}");
            assert!(again.save()? == saved, "{name}: the restored scene differs at once");
            pool.install(|| run(&mut again, STEPS))?;
            assert!(
                again.save()? == straight.save()?,
                "{name}: the restored scene differs {STEPS} steps on"
            );
        }
    }
    Ok(())
}

#[test]
fn a_body_that_was_let_go_goes_on() -> Result<(), Box<dyn Error>> {
    let mut half = beads()?;
    half.set_drive(3, RigidDrive::Free)?;
    run(&mut half, STEPS)?;
    let mut again = beads()?;
    again.restore(&half.save()?)?;
    run(&mut half, STEPS)?;
    run(&mut again, STEPS)?;
    assert!(half.save()? == again.save()?);
    assert!(again.rigid_body(3)?.velocity.norm() > 0.0);
    Ok(())
}

#[test]
fn what_does_not_fit_is_named() -> Result<(), Box<dyn Error>> {
    let saved = overdamped()?.save()?;
    let refused = |bytes: &[u8], build: Build| -> Result<StateError, Box<dyn Error>> {
        let mut scene = build()?;
        let before = scene.save()?;
        match scene.restore(bytes) {
            Err(SceneError::State(error)) => {
                assert!(scene.save()? == before, "the scene has changed");
                Ok(error)
            }
            other => Err(format!("{other:?}").into()),
        }
    };
    let error = refused(b"something else", overdamped)?;
    assert_eq!(error, StateError::NotAScene { bytes: 14 });
    let error = refused(&saved[..saved.len() - 9], overdamped)?;
    assert!(matches!(error, StateError::Damaged { .. }), "{error}");
    let mut flipped = saved.clone();
    flipped[saved.len() / 2] ^= 1;
    assert!(matches!(refused(&flipped, overdamped)?, StateError::Damaged { .. }));
    let mut newer = saved.clone();
    newer[8] = 9;
    assert_eq!(refused(&newer, overdamped)?, StateError::Version { found: 9, known: 2 });
    let error = refused(&saved, beads)?.to_string();
    assert!(error.contains("the time step") && error.contains("1e-7"), "{error}");
    let another: Build = || {
        let mut scene = Scene::without_fluid(1e-7)?;
        let mesh = Arc::new(Mesh::sphere(4.1 * UM, 162)?);
        scene.add_body(
            Cell::new("cell", mesh).with_motion(Motion::Overdamped { friction: 1e-8 }),
            &Isometry3::identity(),
        )?;
        Ok(scene)
    };
    let error = refused(&saved, another)?.to_string();
    assert!(error.contains("body 0: number 0, cell of 162 nodes"), "{error}");
    Ok(())
}

#[test]
fn an_interrupted_save_leaves_the_one_before() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("lbm-ibm-test-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let path = folder.join("run.scene");
    let mut scene = overdamped()?;
    run(&mut scene, 3)?;
    write_checkpoint(&scene, &path)?;
    // A save that cannot be finished: what is beside the file cannot be written to.
    let beside = folder.join("run.scene.part");
    std::fs::create_dir(&beside)?;
    run(&mut scene, 3)?;
    let error = write_checkpoint(&scene, &path);
    assert!(matches!(error, Err(CheckpointError::Write { .. })), "{error:?}");
    let mut again = overdamped()?;
    read_checkpoint(&mut again, &path)?;
    assert_eq!(again.steps(), 3);
    std::fs::remove_dir(&beside)?;
    write_checkpoint(&scene, &path)?;
    read_checkpoint(&mut again, &path)?;
    assert!(again.steps() == 6 && !beside.exists());
    let missing = read_checkpoint(&mut again, &folder.join("none"));
    assert!(matches!(missing, Err(CheckpointError::Read { .. })));
    let mut cut = std::fs::read(&path)?;
    cut.truncate(cut.len() / 2);
    std::fs::write(&path, cut)?;
    let half = read_checkpoint(&mut again, &path);
    assert!(matches!(half, Err(CheckpointError::Read { .. })) && again.steps() == 6);
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}
