//! A red blood cell that is let go after a pull, in plasma.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::scenes::side_by_side;
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Grid, ImmersedBody, PN, Scene, Soa3, Soa3Ref, UM, Vec3, enclosed_volume};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Fluid, Pace};
use lbm_ibm::membrane::laws::Maxwell;
use lbm_ibm::membrane::presets;
use lbm_ibm::membrane::stretch::{Load, Patch, Stretch};

/// Blood plasma: density, kg/m3, and dynamic viscosity, Pa s.
const PLASMA: (f64, f64) = (1025.0, 1.2e-3);
/// Shear viscosity of the membrane, N s/m.
const VISCOSITY: f64 = 0.5e-6;
/// Shear modulus of the springs in line with it, over the membrane's own.
const SPRINGS: f64 = 20.0;
/// Pull before the release, on beads over a chord of 2 um at each end.
const FORCE: f64 = 31.0 * PN;
/// Edges of the periodic box, m.
const BOX: Vec3 = Vec3::new(18.0 * UM, 14.0 * UM, 10.0 * UM);
/// Share of the stretch from which the exponential is fitted.
const FROM: f64 = 0.8;
/// Shares of the stretch where the first part of the fit ends and the last one begins.
const PARTS: [f64; 2] = [0.5, 0.3];
/// Steps between two looks.
const EVERY: usize = 10;

/// A release, and how it is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Release {
    /// Whether the membrane is viscous.
    viscous: bool,
    /// Grid spacing, m.
    spacing: f64,
    /// Factor on the density.
    scale: f64,
    /// Relaxation time of the fluid.
    tau: f64,
    /// Nodes of the mesh.
    nodes: usize,
    /// Share of the stretch at which the run ends.
    until: f64,
}

/// The release of a quick run.
const QUICK: &[Release] = &[Release { until: 0.3, ..COARSE }];
/// Releases of a full run. Two differ by the scaling alone. At a spacing of 1 um a cell whose dimples are 0.9 um apart
/// cannot empty them, since both faces move with the same nodes of the fluid.
const FULL: &[Release] = &[
    FINE,
    Release {
        viscous: false,
        scale: 20.0,
        tau: 2.5,
        ..FINE
    },
    Release {
        spacing: 1.0 * UM,
        scale: 30.0,
        tau: 1.0,
        ..FINE
    },
    COARSE,
    Release {
        scale: 60.0,
        tau: 1.1,
        ..COARSE
    },
];
const FINE: Release = Release {
    viscous: true,
    spacing: 0.5 * UM,
    scale: 50.0,
    tau: 1.7,
    nodes: 642,
    until: 0.1,
};
const COARSE: Release = Release {
    spacing: 0.7 * UM,
    scale: 80.0,
    tau: 1.0,
    nodes: 400,
    ..FINE
};

/// What is left of it.
#[derive(Clone, Copy, Debug)]
struct Recovered {
    /// Time constant, s.
    time: f64,
    /// Root mean square of the logarithm's departure from the fit.
    error: f64,
    /// Time constants of the first and of the last part of the fit, down to and from [`PARTS`], s.
    parts: [f64; 2],
    /// Length over width at the release.
    released: f64,
    /// Relative change of the volume.
    drift: f64,
    /// Steps taken.
    steps: u64,
}

impl Release {
    /// Pulls the cell, lets it go, and looks on.
    ///
    /// What is left of the stretch by Hochmuth, Worthy and Evans (Biophys. J. 26, 101, 1979), with l the length over the width:
    /// `(l - l_rest)/(l + l_rest) (l_0 + l_rest)/(l_0 - l_rest)`, in a membrane of shear modulus mu and viscosity eta
    /// `exp(-t mu/eta)`.
    fn run(&self) -> Result<Recovered, Fault> {
        let preset = presets::RED_CELL.with_nodes(self.nodes);
        let elastic = preset.cell()?;
        let ends = Patch::Chord(2.0 * UM).ends(elastic.reference())?;
        let mut stretch = Stretch::new(elastic.clone(), Load::Beads(ends));
        stretch.pull(FORCE)?;
        let mesh = elastic.mesh().clone();
        let rest = slenderness(mesh.nodes());
        let shear = preset.material.shear;
        let mut cell = elastic;
        if self.viscous {
            cell = cell.with_law(Maxwell::new(&mesh, VISCOSITY, SPRINGS * shear)?);
            // Held until the springs have gone slack.
            cell.advance(stretch.positions(), 1e3 * VISCOSITY / (SPRINGS * shear));
        }
        let shape = [0, 1, 2].map(|a| (BOX[a] / self.spacing).round() as usize);
        let grid = Grid::new(shape, self.spacing, [true; 3]);
        let fluid = Fluid::new(grid, PLASMA.0 * self.scale, PLASMA.1, Pace::Tau(self.tau))?;
        let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree));
        let shift = 0.5 * BOX - stretch.positions().mean();
        let body = scene.add_body(cell, &Isometry3::translation(shift.x, shift.y, shift.z))?;
        let pulled: Soa3 = stretch.positions().iter().map(|x| x + shift).collect();
        scene.set_body_positions(body, pulled.view())?;

        let released = slenderness(scene.positions());
        let volume = |scene: &Scene| enclosed_volume(scene.positions(), mesh.triangles());
        let start = volume(&scene);
        let share = |l: f64| (l - rest) / (l + rest) * (released + rest) / (released - rest);
        let longest = 6.0 * VISCOSITY / shear;
        let mut points = Vec::new();
        while scene.time() < longest {
            for _ in 0..EVERY {
                scene.step()?;
            }
            let left = share(slenderness(scene.positions()));
            if left < self.until {
                break;
            }
            if left < FROM {
                points.push((scene.time(), left.ln()));
            }
        }
        let (time, error) = fit(&points);
        let early: Vec<_> = points.iter().copied().filter(|p| p.1 > PARTS[0].ln()).collect();
        let late: Vec<_> = points.iter().copied().filter(|p| p.1 < PARTS[1].ln()).collect();
        Ok(Recovered {
            time,
            error,
            parts: [fit(&early).0, fit(&late).0],
            released,
            drift: volume(&scene) / start - 1.0,
            steps: scene.steps(),
        })
    }
}

/// Length along x over width along y.
fn slenderness(x: Soa3Ref<'_>) -> f64 {
    let span = |a: &[f64]| {
        a.iter().copied().fold(f64::NEG_INFINITY, f64::max) - a.iter().copied().fold(f64::INFINITY, f64::min)
    };
    span(x.x) / span(x.y)
}

/// Time constant of `y = a - t/tau` by least squares, and the root mean square of what is left; not a number without points.
fn fit(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let (t, y) = points.iter().fold((0.0, 0.0), |(t, y), p| (t + p.0 / n, y + p.1 / n));
    let (tt, ty) = points.iter().fold((0.0, 0.0), |(tt, ty), p| {
        (tt + (p.0 - t).powi(2), ty + (p.0 - t) * (p.1 - y))
    });
    let slope = ty / tt;
    let square: f64 = points.iter().map(|p| (p.1 - y - slope * (p.0 - t)).powi(2)).sum();
    (-1.0 / slope, (square / n).sqrt())
}

/// The red cell preset with a membrane viscosity of 0.5 uN s/m, stretched by 31 pN and let go in plasma: its recovery is fitted by
/// an exponential, whose time is eta_m/mu_s within 10 % where the fluid between the faces is resolved. The fluid's own
/// share is the time without membrane viscosity. The density is scaled up; another scaling changes the time by less than 1 %.
pub fn rbc_relaxation(effort: Effort) -> Outcome {
    let mut findings = Findings::of("rbc_relaxation");
    let releases = if effort.quick { QUICK } else { FULL };
    findings.left_out = FULL.len() - releases.len();
    let found = side_by_side(releases, Release::run)?;
    let shear = presets::RED_CELL.material.shear;
    let (exact, solid) = (VISCOSITY / shear, VISCOSITY / shear * (1.0 + 1.0 / SPRINGS));
    for (release, (recovered, seconds)) in releases.iter().zip(&found) {
        let row = [
            ("eta_m_uNsm", if release.viscous { VISCOSITY * 1e6 } else { 0.0 }),
            ("dx_um", release.spacing / UM),
            ("density_scale", release.scale),
            ("fit_to", release.until),
        ];
        findings.begin_done(row.map(|(k, v)| (k.to_owned(), format!("{v:.1}"))).into(), *seconds);
        let time = "time constant (ms)";
        let of = |other: &Release| {
            let at = releases.iter().position(|r| r == other)?;
            Some(found[at].0.time)
        };
        if !release.viscous {
            findings.report(time, recovered.time * 1e3, 0.0, exact * 1e3);
        } else if release.spacing > 0.75 * UM {
            findings.report(time, recovered.time * 1e3, exact * 1e3, exact * 1e3);
        } else {
            findings.check(time, recovered.time * 1e3, exact * 1e3, 0.1);
        }
        if let Some(other) =
            of(&COARSE).filter(|_| *release != COARSE && release.spacing == COARSE.spacing && release.viscous)
        {
            findings.check_scaled("change by the scaling", recovered.time / other - 1.0, 0.0, 1.0, 0.01);
        }
        let share = releases
            .iter()
            .zip(&found)
            .find(|(r, _)| !r.viscous && r.spacing == release.spacing);
        if let Some((_, (fluid, _))) = share.filter(|_| release.viscous) {
            let less = recovered.time - fluid.time;
            findings.report("less the fluid's share (ms)", less * 1e3, solid * 1e3, solid * 1e3);
        }
        for (name, part) in ["from 0.8 to 0.5 alone (ms)", "from 0.3 on alone (ms)"]
            .iter()
            .zip(recovered.parts)
        {
            if part.is_finite() {
                findings.report(name, part * 1e3, recovered.time * 1e3, recovered.time * 1e3);
            }
        }
        findings.report("rms of the logarithm from the fit", recovered.error, 0.0, 1.0);
        findings.report("length over width at the release", recovered.released, 1.0, 1.0);
        findings.check_scaled("volume drift", recovered.drift, 0.0, 1.0, 1e-3);
        findings.report("steps", recovered.steps as f64, 0.0, 1.0);
    }
    Ok(findings)
}
