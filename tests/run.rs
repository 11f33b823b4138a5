//! A run is the same whether its steps are taken one by one or as many at once as the fluid can.

use lbm_ibm::coupling::{Grid, MS, Plane, Run, Scene, Schedule, UM, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Drive, Fluid, Pace};
use std::error::Error;
use std::sync::Arc;

/// Walls half way between nodes, and large enough to be swept over.
fn channel() -> Result<Scene, Box<dyn Error>> {
    let grid = Grid::new([32, 34, 36], 1.0 * UM, [true, true, true]);
    let fluid = Fluid::new(grid, 1e3, 1e-3, Pace::Tau(0.9))?.with_drive(Drive::Force(Vec3::new(1e3, 0.0, 20.0)))?;
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree));
    scene.set_walls(Arc::new(Plane::new(Vec3::y() * 2.0 * UM, Vec3::y())))?;
    Ok(scene)
}

#[test]
fn steps_at_once_are_single_steps_to_the_last_bit() -> Result<(), Box<dyn Error>> {
    let (mut at_once, mut singly) = (channel()?, channel()?);
    let end = Run::new()
        .until_time(0.05 * MS)
        .observe(Schedule::Steps(37), |_| Ok(()))
        .run(&mut at_once)?;
    assert!(end.steps > 100, "{}", end.steps);
    for _ in 0..end.steps {
        singly.step()?;
    }
    assert_eq!(at_once.time(), singly.time());
    assert!(at_once.save()? == singly.save()?);
    Ok(())
}
