//! The recovery of a cell in plasma at rest, once the pull has ceased.

use crate::options::{FormName, Options, Subject};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Grid, ImmersedBody, Run, Scene, Schedule, Soa3, Soa3Ref, UM, Units, Vec3, enclosed_volume};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Fluid, Pace};
use lbm_ibm::membrane::stretch::Stretch;
use lbm_ibm::output::VtkSeries;
use serde::Serialize;
use std::error::Error;
use std::path::Path;
use std::time::Instant;

/// Blood plasma: density, kg/m3, and dynamic viscosity, Pa s.
const PLASMA: (f64, f64) = (1025.0, 1.2e-3);
/// Shares of the extension between which the exponential is fitted.
const FIT: (f64, f64) = (0.8, 0.1);
/// Share of the extension at which the cell counts as recovered.
const RECOVERED: f64 = 0.05;
/// Shares of the extension at which VTK files are written, beside the start and the end.
const FRAMES: [f64; 3] = [0.2, 0.5, 0.8];

/// A cell that is let go.
#[derive(Clone, Debug)]
pub struct Release {
    /// The cell.
    pub subject: Subject,
    /// The formulas.
    pub form: FormName,
    spacing: f64,
    size: [f64; 3],
    tau: f64,
    reynolds_scale: f64,
    /// Shear modulus of the continuum that the paper's network stands for, N/m.
    shear_modulus: f64,
    radius: f64,
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
    /// Size along the pull at the release, m.
    pub axial_pulled: f64,
    /// Size across the pull at the release, m.
    pub transverse_pulled: f64,
    /// Size along the pull at rest, m.
    pub axial_rest: f64,
    /// Size along the pull at the end, m.
    pub axial_end: f64,
    /// Time constant of the exponential, s; none where too little of the recovery was seen.
    pub time_constant: Option<f64>,
    /// Root mean square of the fit's error in the logarithm of the extension.
    pub fit_error: Option<f64>,
    /// Viscosity times radius over shear modulus, s.
    pub viscous_time: f64,
    /// Time simulated, s.
    pub time: f64,
    /// Steps taken.
    pub steps: u64,
    /// Change of the volume from release to end, relative.
    pub volume_drift: f64,
    /// Way of the centre from release to end, m.
    pub drift: f64,
    /// Grid spacing, m.
    pub spacing: f64,
    /// Time step, s.
    pub time_step: f64,
    /// Relaxation time of the fluid.
    pub tau: f64,
    /// Factor on the density.
    pub reynolds_scale: f64,
    /// Why the run failed, where it did.
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

impl Release {
    /// A cell in a periodic box some 1.5 times as long as it when pulled and twice as wide.
    pub fn new(subject: Subject, form: FormName, options: &Options) -> Self {
        let coarse = if options.smoke { 2.0 } else { 1.0 };
        let (spacing, size, scale, shear_modulus, radius) = match subject {
            Subject::Rbc => (0.5, [24.0, 16.0, 16.0], 4.0, 5.2e-6, 4.0),
            Subject::Ctc => (1.0, [36.0, 32.0, 32.0], 40.0, 0.57e-6, 8.0),
        };
        Self {
            subject,
            form,
            spacing: spacing * coarse * UM,
            size: size.map(|s| s * UM),
            tau: options.tau,
            reynolds_scale: options.reynolds_scale.unwrap_or(scale),
            shear_modulus,
            radius: radius * UM,
        }
    }

    /// Time in which viscosity lets the membrane go: that of the fluid times radius over shear modulus, s.
    fn viscous_time(&self) -> f64 {
        PLASMA.1 * self.radius / self.shear_modulus
    }

    /// The run: pulls the cell, lets it go, and looks on. VTK files go to `folder`.
    pub fn run(&self, folder: &Path) -> Result<Done, Box<dyn Error>> {
        let clock = Instant::now();
        let cell = self.subject.cell(self.form)?;
        let force = self.subject.release_force();
        let ends = self.subject.patch().ends(cell.reference())?;
        let mut stretch = Stretch::new(cell.clone(), ends);
        let pulled = stretch.pull(force)?;
        let rest = size(cell.reference());

        let nodes = self.size.map(|s| (s / self.spacing).round() as usize);
        let centre = Vec3::from(self.size) * 0.5;
        let density = PLASMA.0 * self.reynolds_scale;
        let fluid = Fluid::new(
            Grid::new(nodes, self.spacing, [true; 3]),
            density,
            PLASMA.1,
            Pace::Tau(self.tau),
        )?;
        let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree));
        let triangles = cell.triangles().to_vec();
        let body = scene.add_body(cell, &Isometry3::from_parts(centre.into(), Default::default()))?;
        let middle = stretch.positions().mean();
        let start: Soa3 = stretch.positions().iter().map(|x| x - middle + centre).collect();
        scene.set_body_positions(body, start.view())?;

        let mut moments = Vec::new();
        let mut series = VtkSeries::new(folder)?;
        let mut frames = FRAMES.to_vec();
        let extension = |axial: f64| (axial - rest.x) / (pulled.axial - rest.x);
        let end = Run::new()
            .observe(Schedule::Seconds(0.01 * self.viscous_time()), |scene| {
                let now = size(scene.positions());
                moments.push(Moment {
                    cell: self.subject.name(),
                    form: self.form.name(),
                    time: scene.time(),
                    axial: now.x,
                    transverse: now.y,
                    extension: extension(now.x),
                });
                let passed = frames.last().is_some_and(|f| extension(now.x) <= *f);
                if passed {
                    frames.pop();
                }
                if passed || scene.steps() == 0 {
                    series.write(scene)?;
                }
                Ok(())
            })
            .until("recovered", |scene| extension(size(scene.positions()).x) < RECOVERED)
            .until_time(20.0 * self.viscous_time())
            .run(&mut scene);
        series.write(&scene)?;

        let fit = fit(&moments);
        let units = Units::time_step_for(self.spacing, density, PLASMA.1, self.tau);
        let recovery = Recovery {
            cell: self.subject.name(),
            form: self.form.name(),
            force,
            axial_pulled: pulled.axial,
            transverse_pulled: pulled.transverse,
            axial_rest: rest.x,
            axial_end: size(scene.positions()).x,
            time_constant: fit.map(|f| f.0),
            fit_error: fit.map(|f| f.1),
            viscous_time: self.viscous_time(),
            time: scene.time(),
            steps: scene.steps(),
            volume_drift: enclosed_volume(scene.positions(), &triangles) / enclosed_volume(start.view(), &triangles)
                - 1.0,
            drift: (scene.positions().mean() - centre).norm(),
            spacing: self.spacing,
            time_step: units,
            tau: self.tau,
            reynolds_scale: self.reynolds_scale,
            message: end.err().map_or(String::new(), |e| e.to_string()),
        };
        Ok(Done {
            recovery,
            moments,
            seconds: clock.elapsed().as_secs_f64(),
        })
    }
}

/// Extent along x, y and z, m.
fn size(x: Soa3Ref<'_>) -> Vec3 {
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
        .filter(|m| m.extension <= FIT.0 && m.extension >= FIT.1)
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
