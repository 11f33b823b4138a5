//! All runs of a study, shared among threads.

use crate::device::Device;
use crate::empty::Empty;
use crate::options::Options;
use crate::passage::{Outcome, Passage};
use crate::squeeze::{Squeeze, squeeze};
use lbm_ibm::coupling::{Run, RunError, Scene, SceneError};
use lbm_ibm::output::{Progress, VtkSeries, write_walls};
use serde::Serialize;
use std::error::Error;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// One run, in SI. What depends on the clock on the wall is not among it.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// rbc, ctc, neutrophil or lymphocyte.
    pub cell: String,
    /// How it meets the slit.
    pub orientation: String,
    /// Height of the slit, m.
    pub gap: f64,
    /// How it ended.
    pub outcome: Outcome,
    /// Time from the nose's meeting the entry plane to the end, s.
    pub elapsed: f64,
    /// The undisturbed fluid's time for the same way, s.
    pub undisturbed: f64,
    /// How it ended on a grid twice as coarse, where that was run.
    pub outcome_coarse: Option<Outcome>,
    /// `elapsed` on that grid, s.
    pub elapsed_coarse: Option<f64>,
    /// Relative change of `elapsed` from this grid to that: at first order the error of `elapsed`, at second three times it.
    pub grid_error: Option<f64>,
    /// Mean velocity in the channel, m/s.
    pub channel_velocity: f64,
    /// Mean velocity in the open gap of the empty device, m/s.
    pub gap_velocity: f64,
    /// Pressure drop of the empty device over its period, Pa.
    pub pressure_drop_empty: f64,
    /// Greatest pressure drop with the cell, Pa.
    pub pressure_drop_peak: f64,
    /// Pressure drop at the end, Pa.
    pub pressure_drop_end: f64,
    /// Least distance of a node from the walls, m.
    pub least_wall_distance: f64,
    /// The same in grid spacings.
    pub least_wall_distance_in_spacings: f64,
    /// Greatest relative growth of the cell's area.
    pub greatest_area_strain: f64,
    /// Greatest relative change of the cell's volume.
    pub volume_drift: f64,
    /// Least area of a triangle over its area at rest: how far the flow has sheared the surface.
    pub least_triangle: f64,
    /// Most edges at once whose two triangles face away from each other.
    pub folded_edges: usize,
    /// Static estimate: force that squeezes the cell in, N.
    pub static_force: f64,
    /// Static estimate: pressure drop with the cell in the slit times blocked area, N.
    pub flow_force: f64,
    /// Static estimate: whether the flow's force is the greater one.
    pub static_passes: bool,
    /// Steps taken.
    pub steps: u64,
    /// Grid spacing, m.
    pub spacing: f64,
    /// Time step, s.
    pub time_step: f64,
    /// Relaxation time.
    pub tau: f64,
    /// Factor on the Reynolds number.
    pub reynolds_scale: f64,
    /// Why the run failed, where it did.
    pub message: String,
}

impl Row {
    /// Takes in the same passage on a coarser grid. A gap may be too narrow for that grid: no reason to lose the row.
    fn compare(&mut self, coarse: Result<Row, Box<dyn Error>>) {
        let message = match &coarse {
            Ok(row) => row.message.clone(),
            Err(error) => error.to_string(),
        };
        if !message.is_empty() {
            self.message.push_str(&format!("on the coarser grid: {message}"));
        }
        self.outcome_coarse = Some(coarse.as_ref().map_or(Outcome::Failed, |c| c.outcome));
        let passed = |row: &Row| row.outcome == Outcome::Pass;
        if let Some(coarse) = coarse.ok().filter(|c| passed(c) && passed(self)) {
            self.elapsed_coarse = Some(coarse.elapsed);
            self.grid_error = Some((coarse.elapsed / self.elapsed - 1.0).abs());
        }
    }
}

/// A run and its wall-clock seconds.
pub struct Done {
    /// The run.
    pub row: Row,
    /// Wall-clock seconds of all of it.
    pub seconds: f64,
}

/// Runs all devices, as many at a time as there are threads; the order of the results is that of the devices.
pub fn run_all(
    devices: &[Device],
    options: &Options,
    progress: &Progress,
) -> Result<Vec<Done>, Box<dyn Error + Send + Sync>> {
    let threads = options
        .threads
        .or_else(|| std::thread::available_parallelism().ok().map(usize::from))
        .unwrap_or(1)
        .max(1);
    let workers = threads.min(devices.len()).max(1);
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Done>>> = devices.iter().map(|_| Mutex::new(None)).collect();
    let work = || -> Result<(), Box<dyn Error + Send + Sync>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads / workers).build()?;
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(device) = devices.get(i) else {
                return Ok(());
            };
            let done = pool.install(|| run_one(device, options).map_err(|e| e.to_string()))?;
            progress.print(&line(&done));
            progress.advance();
            if let Ok(mut slot) = results[i].lock() {
                *slot = Some(done);
            }
        }
    };
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        handles
            .into_iter()
            .try_for_each(|h| h.join().map_err(|_| "a run has panicked")?)
    })?;
    Ok(results
        .into_iter()
        .filter_map(|r| r.into_inner().ok().flatten())
        .collect())
}

/// A line of the table on the terminal.
pub fn line(done: &Done) -> String {
    let r = &done.row;
    let mut text = format!(
        "{:10} {:6} {:5.1}  {:9} {:8.1} {:7} {:8.1} {:7.2} {:7.2} {:9.0} {:7.3} {:6.2} {:7.3} {:7.3} {:6} {:7.0} {:7.0} {:8} {:6.1}",
        r.cell,
        r.orientation,
        r.gap * 1e6,
        format!("{:?}", r.outcome).to_lowercase(),
        r.elapsed * 1e3,
        match (r.outcome_coarse, r.grid_error) {
            (Some(coarse), _) if coarse != r.outcome => format!("{coarse:?}").to_lowercase(),
            (_, Some(error)) => format!("{:.1}", error * 1e2),
            _ => "-".to_owned(),
        },
        r.undisturbed * 1e3,
        r.pressure_drop_empty,
        r.pressure_drop_peak,
        r.gap_velocity * 1e6,
        r.least_wall_distance * 1e6,
        r.greatest_area_strain * 1e2,
        r.volume_drift * 1e2,
        r.least_triangle,
        r.folded_edges,
        r.static_force * 1e12,
        r.flow_force * 1e12,
        r.steps,
        done.seconds,
    );
    if !r.message.is_empty() {
        text.push_str(&format!("\n     {}", r.message));
    }
    text
}

/// The head of that table.
pub const HEAD: &str = "cell       facing gap_um outcome  time_ms  grid_% fluid_ms dp0_Pa  dp_Pa   gap_um/s wall_um area_% vol_%   least_t folded squeeze flow_pN  steps    s";

fn run_one(device: &Device, options: &Options) -> Result<Done, Box<dyn Error>> {
    let clock = Instant::now();
    let estimate = squeeze(device)?;
    let folder = options.out.join(format!(
        "{}_{}_{:.2}um",
        device.subject.cell(),
        device.subject.orientation(),
        device.gap * 1e6
    ));
    let mut row = pass(device, &estimate, (!options.no_vtk).then_some(&*folder))?;
    if !(options.no_error || options.paper_mode) {
        row.compare(pass(&device.coarser(), &estimate, None));
    }
    Ok(Done {
        row,
        seconds: clock.elapsed().as_secs_f64(),
    })
}

/// One passage on one grid.
fn pass(device: &Device, estimate: &Squeeze, folder: Option<&Path>) -> Result<Row, Box<dyn Error>> {
    let empty = Empty::of(device)?;
    let cell = device.cell()?;
    let (mut scene, id) = device.scene(empty.pressure_drop)?;
    let mut passage = Passage::new(device, &empty, &cell, id);
    let mut film = folder.map(|to| Film::new(to, &scene, device)).transpose()?;
    let end = watch(&mut scene, &mut passage, film.as_mut());
    let (outcome, message) = match end {
        Ok(outcome) => (outcome, String::new()),
        Err(error) => (Outcome::Failed, error.to_string()),
    };
    if let Some(film) = &mut film {
        film.series.write(&scene)?;
    }
    Ok(row(device, &empty, estimate, &passage, &scene, outcome, message))
}

fn watch(scene: &mut Scene, passage: &mut Passage, mut film: Option<&mut Film>) -> Result<Outcome, RunError> {
    let mut outcome: Result<Option<Outcome>, SceneError> = Ok(None);
    Run::new()
        .observe(lbm_ibm::coupling::Schedule::Steps(20), |scene| match &mut film {
            Some(film) => Ok(film.look(scene)?),
            None => Ok(()),
        })
        .until("outcome", |scene| {
            outcome = passage.look(scene);
            !matches!(outcome, Ok(None))
        })
        .run(scene)?;
    Ok(outcome?.unwrap_or(Outcome::Undecided))
}

/// VTK files of a few moments: at the entry plane, in the middle of the slit, and at the end.
struct Film {
    series: VtkSeries,
    marks: Vec<f64>,
}

impl Film {
    fn new(folder: &Path, scene: &Scene, device: &Device) -> Result<Self, Box<dyn Error>> {
        let series = VtkSeries::new(folder)?;
        write_walls(&folder.join("walls.vti"), scene)?;
        Ok(Self {
            series,
            marks: vec![0.5 * (device.entry + device.exit), device.entry],
        })
    }

    fn look(&mut self, scene: &Scene) -> Result<(), Box<dyn Error + Send + Sync>> {
        let centre = scene.positions().mean().x;
        if self.marks.last().is_some_and(|mark| centre >= *mark) {
            self.marks.pop();
            self.series.write(scene)?;
        }
        Ok(())
    }
}

fn row(
    device: &Device,
    empty: &Empty,
    estimate: &Squeeze,
    passage: &Passage,
    scene: &Scene,
    outcome: Outcome,
    message: String,
) -> Row {
    let units = device.units();
    let flow_force = estimate.flow_force(device, empty);
    Row {
        cell: device.subject.cell().to_owned(),
        orientation: device.subject.orientation().to_owned(),
        gap: device.gap,
        outcome,
        elapsed: passage.elapsed,
        outcome_coarse: None,
        elapsed_coarse: None,
        grid_error: None,
        undisturbed: empty.transit,
        channel_velocity: device.velocity,
        gap_velocity: device.gap_velocity(),
        pressure_drop_empty: empty.pressure_drop,
        pressure_drop_peak: passage.peak_pressure_drop,
        pressure_drop_end: passage.pressure_drop,
        least_wall_distance: passage.least_wall_distance,
        least_wall_distance_in_spacings: passage.least_wall_distance / device.spacing,
        greatest_area_strain: passage.greatest_area_strain,
        volume_drift: passage.volume_drift,
        least_triangle: passage.least_triangle,
        folded_edges: passage.folded_edges,
        static_force: estimate.force,
        flow_force,
        static_passes: flow_force >= estimate.force,
        steps: scene.steps(),
        spacing: device.spacing,
        time_step: units.time_step,
        tau: units.relaxation_time(),
        reynolds_scale: device.scale(),
        message,
    }
}
