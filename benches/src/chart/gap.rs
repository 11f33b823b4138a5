//! Cells through a slit: resolution, relaxation time and scaling of the Reynolds number against the transit time.

use super::{Chart, Row, Work, seconds_per_call};
use crate::Fault;
use crate::gap_study::device::Device;
use crate::gap_study::options::{Options, Subject};
use crate::scenes::side_by_side;
use clap::Parser;
use lbm_ibm::coupling::{Scene, SceneError, UM};

/// The slit of the study with lengths that are whole numbers of every spacing below: 4 um thick, a narrower channel and a
/// shorter way to the slit.
const THICKNESS: f64 = 4.0;
const WIDTH: f64 = 1.5;
const START: f64 = 1.0;

/// Relaxation time and scaling of the Reynolds number: a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pace {
    tau: f64,
    scale: f64,
}

const fn pace(tau: f64, scale: f64) -> Pace {
    Pace { tau, scale }
}

/// A run: pace and spacing (um).
type Point = (Pace, f64);

/// A cell at a gap, and the spacings of its curves.
struct Case {
    subject: Subject,
    name: &'static str,
    /// um.
    gap: f64,
    /// Spacings (um) of each pace.
    curves: &'static [(Pace, &'static [f64])],
    /// Two points at one spacing: what the scaling of the Reynolds number does.
    scalings: [Point; 2],
    /// A coarse and a fine point: what the spacing does.
    spacings: [Point; 2],
}

/// Spacings of two thirds and four thirds of a micrometre.
const TWO_THIRDS: f64 = 2.0 / 3.0;
const FOUR_THIRDS: f64 = 4.0 / 3.0;

const CASES: &[Case] = &[
    Case {
        subject: Subject::RbcEdge,
        name: "red cell",
        gap: 4.0,
        curves: &[
            (pace(1.0, 15.0), &[1.0, 0.8]),
            (pace(1.0, 30.0), &[TWO_THIRDS]),
            (pace(1.0, 60.0), &[0.5]),
            (pace(1.0, 120.0), &[0.5, 0.4]),
            (pace(0.75, 60.0), &[0.8, TWO_THIRDS]),
            (pace(1.5, 10.0), &[TWO_THIRDS]),
        ],
        scalings: [(pace(1.0, 60.0), 0.5), (pace(1.0, 120.0), 0.5)],
        spacings: [(pace(1.0, 30.0), TWO_THIRDS), (pace(1.0, 120.0), 0.4)],
    },
    Case {
        subject: Subject::Ctc,
        name: "tumour cell",
        gap: 12.0,
        curves: &[
            (pace(1.0, 15.0), &[2.0, FOUR_THIRDS]),
            (pace(1.0, 30.0), &[FOUR_THIRDS]),
            (pace(1.0, 60.0), &[1.0, 0.8]),
            (pace(0.75, 60.0), &[FOUR_THIRDS]),
            (pace(1.5, 10.0), &[FOUR_THIRDS]),
        ],
        scalings: [(pace(1.0, 15.0), FOUR_THIRDS), (pace(1.0, 30.0), FOUR_THIRDS)],
        spacings: [(pace(1.0, 30.0), FOUR_THIRDS), (pace(1.0, 60.0), 0.8)],
    },
];

/// Cells through the slit of the gap study.
pub const GAP: Chart = Chart {
    name: "gap",
    title: "Transit of a red cell (4 µm) and a tumour cell (12 µm) through a slit",
    cost: "cost of the transit, s",
    error: "relative error of the transit time",
    advice: "The longest step that the scene accepts, by scaling the Reynolds number: on one grid transits agree within 0.2 % for every \
              relaxation time and scaling. The time belongs to the grid: 10 spacings in a red cell's gap leave 4 %.",
    cases: transits,
};

/// A cell that has passed.
struct Passed {
    scene: Scene,
    /// From the nose's meeting the slit to the tail's being a radius behind it, s.
    transit: f64,
}

/// Greatest or least x of the nodes.
fn end(scene: &Scene, greatest: bool) -> f64 {
    let x = scene.positions().x.iter().copied();
    if greatest {
        x.fold(f64::NEG_INFINITY, f64::max)
    } else {
        x.fold(f64::INFINITY, f64::min)
    }
}

/// Steps until the nose or the tail reaches `place` (m); the time at which it did, s.
fn reach(scene: &mut Scene, nose: bool, place: f64, latest: f64) -> Result<f64, Fault> {
    let mut before = end(scene, nose);
    loop {
        scene.step()?;
        let now = end(scene, nose);
        if now >= place {
            return Ok(scene.time() - scene.time_step() * (now - place) / (now - before));
        }
        if scene.time() > latest {
            return Err(format!("the cell has not passed in {latest} s").into());
        }
        before = now;
    }
}

/// Runs a cell through the slit; none where the scene refuses the time step.
fn pass(case: &Case, pace: Pace, spacing: f64) -> Result<Option<Passed>, Fault> {
    let options = Options {
        resolution: Some(spacing),
        thickness: THICKNESS,
        width: WIDTH,
        start: START,
        tau: pace.tau,
        reynolds_scale: pace.scale,
        ..Options::try_parse_from(["gap_study"])?
    };
    let device = Device::new(case.subject, case.gap * UM, &options);
    let (mut scene, _) = device.scene(0.0).map_err(|e| e.to_string())?;
    match scene.prepare() {
        Err(SceneError::TimeStep { .. }) => return Ok(None),
        other => other?,
    }
    // Ten times as long as the undisturbed mean flow takes.
    let latest = 10.0 * device.length / device.velocity;
    let begin = reach(&mut scene, true, device.entry, latest)?;
    let behind = device.exit + 0.5 * device.subject.diameter();
    let transit = reach(&mut scene, false, behind, latest)? - begin;
    Ok(Some(Passed { scene, transit }))
}

/// One run of a case.
struct Job {
    case: usize,
    pace: Pace,
    spacing: f64,
}

fn transits(quick: bool) -> Result<Vec<Row>, Fault> {
    let mut jobs = Vec::new();
    for (case, of) in CASES.iter().enumerate() {
        for &(pace, spacings) in of.curves {
            let spacings = spacings.iter().filter(|h| !quick || of.gap / **h < 6.5);
            jobs.extend(spacings.map(|&spacing| Job { case, pace, spacing }));
        }
    }
    // The longest first: cells to the power of three, and steps.
    let work = |j: &Job| (CASES[j.case].gap / j.spacing).powi(5) / ((j.pace.tau - 0.5) * j.pace.scale);
    jobs.sort_by(|a, b| work(b).total_cmp(&work(a)));
    let done = side_by_side(&jobs, |j| {
        let of = &CASES[j.case];
        pass(of, j.pace, j.spacing).map_err(|e| format!("{} at {} um, {:?}: {e}", of.name, j.spacing, j.pace).into())
    })?;
    let mut passed: Vec<(&Job, Passed)> = Vec::new();
    for (job, (run, _)) in jobs.iter().zip(done) {
        match run {
            Some(run) => passed.push((job, run)),
            None => eprintln!(
                "{} at {} um, {:?}: the time step is refused",
                CASES[job.case].name, job.spacing, job.pace
            ),
        }
    }
    let place = |j: &Job| CASES[j.case].curves.iter().position(|(p, _)| *p == j.pace);
    passed.sort_by(|(a, _), (b, _)| {
        let order = a.case.cmp(&b.case).then(place(a).cmp(&place(b)));
        order.then(b.spacing.total_cmp(&a.spacing))
    });
    let exact: Vec<f64> = (0..CASES.len()).map(|case| limit(case, &passed, quick)).collect();

    let mut works: Vec<Work> = Vec::new();
    let mut steps = Vec::new();
    for (_, run) in &mut passed {
        let nodes = run.scene.fluid().map_or(0, |f| f.grid().len()) + run.scene.positions().len();
        steps.push((run.scene.steps() as f64, nodes as f64));
        // An even and an odd step.
        works.push(Box::new(|| {
            run.scene.step()?;
            Ok(run.scene.step()?)
        }));
    }
    let pairs = seconds_per_call(quick, &mut works)?;
    drop(works);
    let rows = passed
        .iter()
        .zip(pairs)
        .zip(steps)
        .map(|(((job, run), pair), (steps, nodes))| {
            let (of, Pace { tau, scale }) = (&CASES[job.case], job.pace);
            Row {
                case: of.name.into(),
                curve: format!("{}, tau {tau}, Re x{scale}", of.name),
                label: format!("{:.2} um, {:.2} ms", job.spacing, 1e3 * run.transit),
                cost_s: 0.5 * pair * steps,
                updates: (steps * nodes).round(),
                error: (run.transit / exact[job.case] - 1.0).abs(),
            }
        });
    Ok(rows.collect())
}

/// The transit time (s) on an infinitely fine grid without scaling of the Reynolds number, each effect taken to be of the first
/// order: that of the scaling from two runs on one grid, then that of the spacing from the finest run and one of some 1.7 times its
/// spacing, both freed of the scaling. In a quick run the finest one.
fn limit(case: usize, passed: &[(&Job, Passed)], quick: bool) -> f64 {
    let of = &CASES[case];
    let runs = || passed.iter().filter(|(j, _)| j.case == case);
    if quick {
        let finest = runs().min_by(|a, b| a.0.spacing.total_cmp(&b.0.spacing));
        return finest.map_or(f64::NAN, |(_, run)| run.transit);
    }
    let transit = |(pace, spacing): Point| {
        let found = runs().find(|(j, _)| j.pace == pace && j.spacing == spacing);
        found.map_or(f64::NAN, |(_, run)| run.transit)
    };
    let [low, high] = of.scalings;
    let per_scale = (transit(high) - transit(low)) / (high.0.scale - low.0.scale);
    let [coarse, fine] = of.spacings.map(|at| transit(at) - per_scale * at.0.scale);
    let [wide, narrow] = of.spacings.map(|(_, spacing)| spacing);
    fine + (fine - coarse) * narrow / (wide - narrow)
}
