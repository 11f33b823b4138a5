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

type Condition<'a> = Box<dyn FnMut(&Scene) -> bool + 'a>;
type Observe<'a> = Box<dyn FnMut(&Scene) -> Result<(), Box<dyn std::error::Error + Send + Sync>> + 'a>;

/// What ends a run.
enum Stop<'a> {
    Time(f64),
    Steps(u64),
    Condition(Condition<'a>),
}

impl Stop<'_> {
    fn holds(&mut self, scene: &Scene) -> bool {
        match self {
            Self::Time(time) => scene.time() >= *time - 0.5 * scene.time_step(),
            Self::Steps(steps) => scene.steps() >= *steps,
            Self::Condition(condition) => condition(scene),
        }
    }

    /// Steps that are sure to be taken before it can hold.
    fn ahead(&self, scene: &Scene) -> u64 {
        match self {
            Self::Time(time) => steps_to(*time, scene).saturating_sub(scene.steps()),
            Self::Steps(steps) => steps.saturating_sub(scene.steps()),
            Self::Condition(_) => 1,
        }
    }
}

/// Steps a scene until a condition holds, with observers on schedules. Between what is due a fluid without bodies and fields may
/// take several steps at once ([`Scene::step_by`]): so where the run ends by a time or a number of steps, and by no condition of one's own.
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
        self.stop("time", Stop::Time(time))
    }

    /// Ends the run when the scene has taken `steps` steps in all.
    pub fn until_step(self, steps: u64) -> Self {
        self.stop("steps", Stop::Steps(steps))
    }

    /// Ends the run when `condition` holds; it is asked before every step, in the order of adding.
    pub fn until(self, name: impl Into<String>, condition: impl FnMut(&Scene) -> bool + 'a) -> Self {
        self.stop(name, Stop::Condition(Box::new(condition)))
    }

    fn stop(mut self, name: impl Into<String>, stop: Stop<'a>) -> Self {
        self.stops.push((name.into(), stop));
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
            let ended = self
                .stops
                .iter_mut()
                .find_map(|(name, stop)| stop.holds(scene).then_some(&*name));
            if let Some(name) = ended {
                return Ok(Finished {
                    reason: name.clone(),
                    steps: scene.steps() - start,
                    seconds: clock.elapsed().as_secs_f64(),
                });
            }
            let taken = scene.steps() - start;
            let looks = self.observers.iter().map(|(schedule, done, _)| match schedule {
                Schedule::Steps(n) => n.max(&1) - taken % n.max(&1),
                Schedule::Seconds(s) => steps_to(*done as f64 * s, scene).saturating_sub(taken),
            });
            let stops = self.stops.iter().map(|(_, stop)| stop.ahead(scene));
            // Without anything due there is no end to come either: one step at a time.
            scene.step_by(looks.chain(stops).min().unwrap_or(1).max(1))?;
        }
    }
}

/// The last step that is at `time` (s) or surely before it.
fn steps_to(time: f64, scene: &Scene) -> u64 {
    (time / scene.time_step() - 1.0).max(0.0) as u64
}

fn due(schedule: Schedule, done: u64, scene: &Scene, start: u64) -> bool {
    let taken = scene.steps() - start;
    match schedule {
        Schedule::Steps(n) => taken.is_multiple_of(n.max(1)),
        Schedule::Seconds(s) => taken as f64 * scene.time_step() >= done as f64 * s - 0.5 * scene.time_step(),
    }
}
