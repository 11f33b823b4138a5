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

/// The pace of the study, half and twice its scaling, from which the transit without scaling follows.
const PACES: [Pace; 3] = [pace(1.0, 60.0), pace(1.0, 30.0), pace(1.0, 120.0)];

/// A cell at a gap, and the spacings of its curves.
struct Case {
    subject: Subject,
    name: &'static str,
    /// um.
    gap: f64,
    /// Spacings (um) of each pace.
    curves: &'static [(Pace, &'static [f64])],
    /// Spacing (um) at which all of [`PACES`] are there, and the two finest ones of the last of these.
    common: f64,
    finest: [f64; 2],
}

const CASES: &[Case] = &[
    Case {
        subject: Subject::RbcEdge,
        name: "red cell",
        gap: 4.0,
        curves: &[
            (PACES[0], &[2.0 / 3.0, 0.5, 0.4]),
            (PACES[1], &[0.8, 2.0 / 3.0, 0.5]),
            (PACES[2], &[0.5, 0.4, 1.0 / 3.0]),
            (pace(1.0, 15.0), &[1.0, 0.8, 2.0 / 3.0]),
            (pace(0.75, 60.0), &[0.8, 2.0 / 3.0, 0.5]),
            (pace(2.0, 30.0), &[2.0 / 3.0, 0.5, 0.4]),
        ],
        common: 0.5,
        finest: [0.4, 1.0 / 3.0],
    },
    Case {
        subject: Subject::Ctc,
        name: "tumour cell",
        gap: 12.0,
        curves: &[
            (PACES[0], &[4.0 / 3.0, 1.0, 0.8]),
            (PACES[1], &[2.0, 4.0 / 3.0, 1.0]),
            (PACES[2], &[1.0, 0.8, 2.0 / 3.0]),
            (pace(1.0, 15.0), &[2.0, 4.0 / 3.0]),
            (pace(0.75, 60.0), &[4.0 / 3.0, 1.0]),
            (pace(2.0, 30.0), &[4.0 / 3.0, 1.0, 0.8]),
        ],
        common: 1.0,
        finest: [0.8, 2.0 / 3.0],
    },
];

/// Cells through the slit of the gap study.
pub const GAP: Chart = Chart {
    name: "gap",
    title: "Transit of a red cell (4 µm) and a tumour cell (12 µm) through a slit",
    cost: "cost of the transit, s",
    error: "relative error of the transit time",
    advice: "",
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
            let spacings = spacings.iter().filter(|h| !quick || **h >= 1.6 * of.common);
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

/// The transit time (s) on an infinitely fine grid without scaling of the Reynolds number: the two finest runs extrapolated
/// by the first order, and what halving the scaling does at a coarser one taken off to zero. In a quick run the finest run.
fn limit(case: usize, passed: &[(&Job, Passed)], quick: bool) -> f64 {
    let of = &CASES[case];
    let transit = |pace: Pace, spacing: f64| {
        let found = passed
            .iter()
            .find(|(j, _)| j.case == case && j.pace == pace && j.spacing == spacing);
        found.map_or(f64::NAN, |(_, run)| run.transit)
    };
    if quick {
        let of = passed.iter().filter(|(j, _)| j.case == case);
        return of
            .min_by(|a, b| a.0.spacing.total_cmp(&b.0.spacing))
            .map_or(f64::NAN, |(_, run)| run.transit);
    }
    let [coarse, fine] = of.finest;
    let [study, half, twice] = PACES.map(|pace| transit(pace, of.common));
    let at_twice =
        transit(PACES[2], fine) + (transit(PACES[2], fine) - transit(PACES[2], coarse)) * fine / (coarse - fine);
    at_twice + (2.0 * half - study) - twice
}
