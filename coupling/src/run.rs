//! Running a scene: until when, and who looks on.

use crate::{Scene, SceneError};
use std::time::Instant;

/// When an observer is called.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Schedule {
    /// Every so many steps, beginning with the state at the start.
    Steps(u64),
    /// Every so many seconds of simulated time, beginning with the state at the start.
    Seconds(f64),
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// The name of the condition that ended it.
    pub reason: String,
    /// Steps taken in this run.
    pub steps: u64,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The scene reports a fault.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An observer reports a fault.
    #[error("an observer failed at step {step}: {source}")]
    Observer {
        /// Step of the scene.
        step: u64,
        /// What it said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

type Stop<'a> = Box<dyn FnMut(&Scene) -> bool + 'a>;
type Observe<'a> = Box<dyn FnMut(&Scene) -> Result<(), Box<dyn std::error::Error + Send + Sync>> + 'a>;

/// Steps a scene until a condition holds, with observers on schedules.
///
/// ```
/// # use lbm_ibm_coupling::{Run, Scene, Schedule};
/// let mut scene = Scene::without_fluid(1e-6)?;
/// let mut looks = 0;
/// let end = Run::new()
///     .until_time(1e-3)
///     .observe(Schedule::Steps(100), |_| {
///         looks += 1;
///         Ok(())
///     })
///     .run(&mut scene)?;
/// assert_eq!((end.steps, end.reason.as_str()), (1000, "time"));
/// assert_eq!(looks, 11);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Default)]
pub struct Run<'a> {
    stops: Vec<(String, Stop<'a>)>,
    observers: Vec<(Schedule, u64, Observe<'a>)>,
}

impl<'a> Run<'a> {
    /// Neither end nor observers yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Ends the run when the scene's time has reached `time`, s.
    pub fn until_time(self, time: f64) -> Self {
        self.until("time", move |scene| scene.time() >= time - 0.5 * scene.time_step())
    }

    /// Ends the run when the scene has taken `steps` steps in all.
    pub fn until_step(self, steps: u64) -> Self {
        self.until("steps", move |scene| scene.steps() >= steps)
    }

    /// Ends the run when `condition` holds; it is asked before every step, in the order of adding.
    pub fn until(mut self, name: impl Into<String>, condition: impl FnMut(&Scene) -> bool + 'a) -> Self {
        self.stops.push((name.into(), Box::new(condition)));
        self
    }

    /// Calls `look` on a schedule. An error ends the run.
    pub fn observe(
        mut self,
        schedule: Schedule,
        look: impl FnMut(&Scene) -> Result<(), Box<dyn std::error::Error + Send + Sync>> + 'a,
    ) -> Self {
        self.observers.push((schedule, 0, Box::new(look)));
        self
    }

    /// Runs. Observers see a state before the conditions do, the final state included where their schedule has it.
    ///
    /// # Errors
    /// The first fault of the scene or of an observer.
    pub fn run(mut self, scene: &mut Scene) -> Result<Finished, RunError> {
        let (clock, start) = (Instant::now(), scene.steps());
        loop {
            for (schedule, done, look) in &mut self.observers {
                if due(*schedule, *done, scene, start) {
                    *done += 1;
                    look(scene).map_err(|source| RunError::Observer {
                        step: scene.steps(),
                        source,
                    })?;
                }
            }
            if let Some((name, _)) = self.stops.iter_mut().find_map(|(n, s)| s(scene).then_some((n, s))) {
                return Ok(Finished {
                    reason: name.clone(),
                    steps: scene.steps() - start,
                    seconds: clock.elapsed().as_secs_f64(),
                });
            }
            scene.step()?;
        }
    }
}

fn due(schedule: Schedule, done: u64, scene: &Scene, start: u64) -> bool {
    let taken = scene.steps() - start;
    match schedule {
        Schedule::Steps(n) => taken.is_multiple_of(n.max(1)),
        Schedule::Seconds(s) => taken as f64 * scene.time_step() >= done as f64 * s - 0.5 * scene.time_step(),
    }
}
