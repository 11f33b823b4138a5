//! How many steps a fluid without bodies is asked to take at once.

use lbm_ibm_coupling::{
    Boundary, Bricks, Exchange, ExchangeError, FluidError, Grid, Guard, Lattice, Run, Scene, Schedule, Soa3Mut,
    Soa3Ref, WallReport,
};
use std::sync::{Arc, Mutex};

/// A fluid that notes how many steps it was asked for.
struct Noting(Grid, Arc<Mutex<Vec<usize>>>);

impl Noting {
    fn note(&self, steps: usize) -> Result<(), FluidError> {
        self.1.lock().expect("one thread").push(steps);
        Ok(())
    }
}

impl Lattice for Noting {
    fn grid(&self) -> &Grid {
        &self.0
    }
    fn time_step(&self) -> f64 {
        1e-6
    }
    fn viscosity(&self) -> f64 {
        1e-3
    }
    fn density(&self) -> f64 {
        1e3
    }
    fn set_walls(&mut self, _: Option<Arc<dyn Boundary>>, _: f64) -> Result<WallReport, FluidError> {
        Ok(WallReport::default())
    }
    fn read_velocity(&mut self, _: &mut Bricks) {}
    fn advance(&mut self, _: &Bricks) -> Result<(), FluidError> {
        self.note(1)
    }
    fn advance_many(&mut self, _: &Bricks, steps: usize) -> Result<(), FluidError> {
        self.note(steps)
    }
}

/// Without bodies nothing is exchanged.
struct Nothing;

impl Exchange for Nothing {
    fn set_bodies(&mut self, _: &[lbm_ibm_coupling::BodyInfo], _: Soa3Ref<'_>, _: &Grid) -> Result<(), ExchangeError> {
        Ok(())
    }
    fn place(&mut self, _: Soa3Ref<'_>, _: &mut Bricks) -> Result<(), ExchangeError> {
        Ok(())
    }
    fn spread(&mut self, _: Soa3Ref<'_>, _: &mut Bricks) {}
    fn interpolate(&mut self, _: &Bricks, _: Soa3Mut<'_>) {}
}

fn scene(every: u64) -> (Scene, Arc<Mutex<Vec<usize>>>) {
    let notes = Arc::default();
    let fluid = Noting(Grid::new([8; 3], 1e-6, [true; 3]), Arc::clone(&notes));
    let guard = Guard {
        every,
        ..Guard::default()
    };
    (Scene::with_fluid(fluid, Nothing).with_guard(guard), notes)
}

fn asked(notes: &Arc<Mutex<Vec<usize>>>) -> Vec<usize> {
    notes.lock().expect("one thread").clone()
}

#[test]
fn steps_are_taken_at_once_up_to_the_next_look() -> Result<(), Box<dyn std::error::Error>> {
    let (mut scene, notes) = scene(50);
    let mut looks = Vec::new();
    let end = Run::new()
        .until_step(120)
        .observe(Schedule::Steps(70), |scene| {
            looks.push(scene.steps());
            Ok(())
        })
        .run(&mut scene)?;
    assert_eq!((end.steps, scene.steps(), end.reason.as_str()), (120, 120, "steps"));
    assert_eq!(looks, [0, 70]);
    // The guard looks at 50 and 100, the observer at 70.
    assert_eq!(asked(&notes), [50, 20, 30, 20]);
    assert_eq!(scene.time(), 120.0 * 1e-6);
    Ok(())
}

#[test]
fn a_time_is_not_passed() -> Result<(), Box<dyn std::error::Error>> {
    for time in [1e-6, 7.4e-6, 7.6e-6, 99.5e-6, 100e-6] {
        let ((mut at_once, _), (mut singly, _)) = (scene(1000), scene(1000));
        let one = Run::new()
            .until_time(time)
            .observe(Schedule::Seconds(3e-6), |_| Ok(()))
            .run(&mut at_once)?;
        let other = Run::new()
            .until("time", |s| s.time() >= time - 0.5 * s.time_step())
            .run(&mut singly)?;
        assert_eq!(one.steps, other.steps, "{time}");
    }
    Ok(())
}

#[test]
fn a_condition_is_asked_before_every_step() -> Result<(), Box<dyn std::error::Error>> {
    let (mut scene, notes) = scene(50);
    let mut asks = 0;
    let run = Run::new().until_step(9).until("never", |_| {
        asks += 1;
        false
    });
    run.run(&mut scene)?;
    assert_eq!(asks, 9);
    assert_eq!(asked(&notes), [1; 9]);
    Ok(())
}
