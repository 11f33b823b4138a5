//! The recovery of a cell in plasma at rest, once the pull has ceased.

use crate::options::{FormName, Options, Subject};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{
    Grid, ImmersedBody, Run, RunError, Scene, Schedule, Soa3, Soa3Ref, UM, Units, Vec3, enclosed_volume,
};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Fluid, Pace};
use lbm_ibm::membrane::stretch::Stretch;
use lbm_ibm::output::VtkSeries;
use serde::Serialize;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Blood plasma: density, kg/m3, and dynamic viscosity, Pa s.
pub const PLASMA: (f64, f64) = (1025.0, 1.2e-3);
/// Shares of the extension between which the exponential is fitted.
pub const FIT: (f64, f64) = (0.8, 0.1);
/// Share of the extension at which the cell counts as recovered; that of the smoke test.
const RECOVERED: (f64, f64) = (0.05, 0.25);
/// Shares of the extension at which VTK files are written, beside the start and the end.
const FRAMES: [f64; 3] = [0.2, 0.5, 0.8];
/// Longest run and distance of two looks, in units of [`Recovery::viscous_time`].
const LONGEST: f64 = 20.0;
const LOOK: f64 = 0.02;

/// A cell that is let go in a periodic box.
#[derive(Clone, Debug)]
pub struct Release {
    subject: Subject,
    form: FormName,
    spacing: f64,
    size: Vec3,
    tau: f64,
    reynolds_scale: f64,
    /// Share of the extension at which the run ends.
    until: f64,
}

/// A moment of the recovery, SI.
#[derive(Clone, Debug, Serialize)]
pub struct Moment {
    /// rbc or ctc.
    pub cell: &'static str,
    /// Membrane formulas.
    pub form: &'static str,
    /// Time since the release, s.
    pub time: f64,
    /// Size along the pull, m.
    pub axial: f64,
    /// Size across the pull, m.
    pub transverse: f64,
    /// Extension along the pull over that at the release.
    pub extension: f64,
}

/// A recovery in short, SI.
#[derive(Clone, Debug, Serialize)]
pub struct Recovery {
    /// rbc or ctc.
    pub cell: &'static str,
    /// Membrane formulas.
    pub form: &'static str,
    /// Force at each end before the release, N.
    pub force: f64,
    /// Size along the pull at rest, m.
    pub axial_rest: f64,
    /// Size along the pull at the release, m.
    pub axial_released: f64,
    /// Size along the pull at the end, m.
    pub axial_end: f64,
    /// Time constant of the exponential, s; none where too little of the recovery was seen.
    pub time_constant: Option<f64>,
    /// Root mean square of the fit's error in the logarithm of the extension.
    pub fit_error: Option<f64>,
    /// Time after which a tenth of the extension is left, s.
    pub time_to_tenth: Option<f64>,
    /// Viscosity of the fluid times the cell's radius over its shear modulus, s.
    pub viscous_time: f64,
    /// Time simulated, s.
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Relative change of the volume from release to end.
    pub volume_drift: f64,
    /// Way of the centre from release to end, m.
    pub centre_drift: f64,
    /// Grid spacing, m.
    pub spacing: f64,
    /// Time step, s.
    pub time_step: f64,
    /// Relaxation time of the fluid.
    pub tau: f64,
    /// Factor on the density.
    pub reynolds_scale: f64,
    /// Why the run ended early, where it did.
    pub message: String,
}

/// A recovery, its moments, and its wall-clock seconds.
pub struct Done {
    /// In short.
    pub recovery: Recovery,
    /// In full.
    pub moments: Vec<Moment>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// All recoveries that are asked for.
pub fn releases(options: &Options) -> Vec<Release> {
    let subjects = options.cell.subjects().iter();
    let each = |&subject: &Subject| {
        options
            .form
            .iter()
            .map(move |&form| Release::new(subject, form, options))
    };
    subjects.flat_map(each).collect()
}

impl Subject {
    /// Shear modulus of the continuum that the paper's network stands for, N/m.
    fn shear_modulus(self) -> f64 {
        match self {
            Self::Rbc => 5.2e-6,
            Self::Ctc => 0.57e-6,
        }
    }
}

impl Release {
    /// A box some 1.6 times as long as the pulled cell and twice as wide as the cell at rest.
    fn new(subject: Subject, form: FormName, options: &Options) -> Self {
        let (spacing, size) = match subject {
            Subject::Rbc => (0.5, Vec3::new(24.0, 16.0, 16.0)),
            Subject::Ctc => (1.0, Vec3::new(34.0, 32.0, 32.0)),
        };
        Self {
            subject,
            form,
            spacing: options
                .resolution
                .unwrap_or(if options.smoke { 1.4 * spacing } else { spacing })
                * UM,
            size: size * UM,
            tau: options.tau,
            reynolds_scale: options.reynolds_scale,
            until: if options.smoke { RECOVERED.1 } else { RECOVERED.0 },
        }
    }

    /// Cell and formulas.
    pub fn name(&self) -> String {
        format!("{}_{}", self.subject.name(), self.form.name())
    }

    /// Viscosity of the fluid times the cell's radius over its shear modulus, s.
    fn viscous_time(&self) -> f64 {
        PLASMA.1 * 0.5 * self.subject.diameter() / self.subject.shear_modulus()
    }

    fn density(&self) -> f64 {
        PLASMA.0 * self.reynolds_scale
    }

    /// Pulls the cell, lets it go, and looks on. VTK files go to a folder of its name in `out`.
    ///
    /// # Errors
    /// The cell cannot be pulled, the scene cannot be built, or a file cannot be written; a fault on the way is in the
    /// recovery's message.
    pub fn run(&self, out: &Path) -> Result<Done, Box<dyn Error + Send + Sync>> {
        let clock = Instant::now();
        let (mut scene, rest) = self.scene()?;
        let start: Soa3 = scene.positions().iter().collect();
        let mut series = VtkSeries::new(&out.join(self.name()))?;
        let mut moments = Vec::new();
        let end = self.watch(&mut scene, rest, &mut moments, &mut series);
        series.write(&scene)?;
        Ok(Done {
            recovery: self.recovery(&scene, rest, start.view(), &moments, end),
            moments,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }

    /// The pulled cell in the middle of the box, free, and its size along the pull at rest (m).
    fn scene(&self) -> Result<(Scene, f64), Box<dyn Error + Send + Sync>> {
        let cell = self.subject.cell(self.form)?;
        let ends = self.subject.patches()[0].ends(cell.reference())?;
        let mut stretch = Stretch::new(cell.clone(), ends);
        stretch.pull(self.subject.release_force())?;
        let rest = extent(cell.reference()).x;

        let shape = [0, 1, 2].map(|a| (self.size[a] / self.spacing).round() as usize);
        let grid = Grid::new(shape, self.spacing, [true; 3]);
        let fluid = Fluid::new(grid, self.density(), PLASMA.1, Pace::Tau(self.tau))?;
        let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree));
        let shift = 0.5 * self.size - stretch.positions().mean();
        let body = scene.add_body(cell, &Isometry3::translation(shift.x, shift.y, shift.z))?;
        let pulled: Soa3 = stretch.positions().iter().map(|x| x + shift).collect();
        scene.set_body_positions(body, pulled.view())?;
        Ok((scene, rest))
    }

    fn watch(
        &self,
        scene: &mut Scene,
        rest: f64,
        moments: &mut Vec<Moment>,
        series: &mut VtkSeries,
    ) -> Result<(), RunError> {
        let whole = extent(scene.positions()).x - rest;
        let extension = |scene: &Scene| (extent(scene.positions()).x - rest) / whole;
        let mut frames = FRAMES.to_vec();
        let look = |scene: &Scene| {
            let size = extent(scene.positions());
            moments.push(Moment {
                cell: self.subject.name(),
                form: self.form.name(),
                time: scene.time(),
                axial: size.x,
                transverse: size.y,
                extension: extension(scene),
            });
            let due = frames.pop_if(|frame| extension(scene) <= *frame).is_some();
            if due || scene.steps() == 0 {
                series.write(scene)?;
            }
            Ok(())
        };
        Run::new()
            .observe(Schedule::Seconds(LOOK * self.viscous_time()), look)
            .until("recovered", |scene| extension(scene) < self.until)
            .until_time(LONGEST * self.viscous_time())
            .run(scene)?;
        Ok(())
    }

    fn recovery(
        &self,
        scene: &Scene,
        rest: f64,
        start: Soa3Ref<'_>,
        moments: &[Moment],
        end: Result<(), RunError>,
    ) -> Recovery {
        let x = scene.positions();
        let volume = |x| enclosed_volume(x, &scene.bodies()[0].triangles);
        let fit = fit(moments);
        Recovery {
            cell: self.subject.name(),
            form: self.form.name(),
            force: self.subject.release_force(),
            axial_rest: rest,
            axial_released: extent(start).x,
            axial_end: extent(x).x,
            time_constant: fit.map(|f| f.0),
            fit_error: fit.map(|f| f.1),
            time_to_tenth: moments.iter().find(|m| m.extension <= 0.1).map(|m| m.time),
            viscous_time: self.viscous_time(),
            time: scene.time(),
            steps: scene.steps(),
            volume_drift: volume(x) / volume(start) - 1.0,
            centre_drift: (x.mean() - start.mean()).norm(),
            spacing: self.spacing,
            time_step: Units::time_step_for(self.spacing, self.density(), PLASMA.1, self.tau),
            tau: self.tau,
            reynolds_scale: self.reynolds_scale,
            message: end.err().map_or(String::new(), |e| e.to_string()),
        }
    }
}

/// Size along x, y and z, m.
fn extent(x: Soa3Ref<'_>) -> Vec3 {
    let span = |a: &[f64]| {
        let high = a.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high - a.iter().copied().fold(f64::INFINITY, f64::min)
    };
    Vec3::new(span(x.x), span(x.y), span(x.z))
}

/// Time constant (s) and root mean square error of `ln extension = a - t/tau`, by least squares over the moments between
/// the shares of [`FIT`].
fn fit(moments: &[Moment]) -> Option<(f64, f64)> {
    let points: Vec<(f64, f64)> = moments
        .iter()
        .filter(|m| (FIT.1..=FIT.0).contains(&m.extension))
        .map(|m| (m.time, m.extension.ln()))
        .collect();
    let n = points.len() as f64;
    let (t, y) = points.iter().fold((0.0, 0.0), |(t, y), p| (t + p.0 / n, y + p.1 / n));
    let (tt, ty) = points.iter().fold((0.0, 0.0), |(tt, ty), p| {
        (tt + (p.0 - t).powi(2), ty + (p.0 - t) * (p.1 - y))
    });
    let slope = ty / tt;
    let square: f64 = points.iter().map(|p| (p.1 - y - slope * (p.0 - t)).powi(2)).sum();
    (points.len() > 2 && slope < 0.0).then(|| (-1.0 / slope, (square / n).sqrt()))
}
