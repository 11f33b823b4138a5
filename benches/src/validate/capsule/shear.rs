//! A capsule in a simple shear flow.

use super::Material;
use super::scene::Capsule;
use super::steady::{Steady, capsule, key, material, steady, unbounded};
use crate::Fault;
use crate::reference::Table;
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use std::collections::BTreeMap;

/// Edge of the box in radii, and of the larger one that tells what the box does.
const BOXES: [f64; 2] = [6.0, 9.0];
/// Radius in grid spacings at which the effect of the box is found: at 4 spacings a capsule feels 3.0 % in a box of 6 radii that
/// does 2.6 % to one of 6 spacings.
const COARSE: f64 = 6.0;
/// Capillary numbers whose rows are run in full, for each law.
const FULL: &[(&str, &[f64])] = &[("NH", &[0.05, 0.1, 0.2, 0.3, 0.6]), ("SK", &[0.1, 0.3, 0.6, 1.5])];
/// Rows for which a fine grid is run too, and a coarser one for the order.
const FINE: &[(&str, f64)] = &[("NH", 0.1), ("SK", 0.3)];
/// Radii in grid spacings of their runs, each twice the next; other rows have the middle one.
const FINER: [f64; 3] = [16.0, 8.0, 4.0];
/// Law that resists little compression, and the capillary number up to which its membrane is compressed, so that without bending it
/// wrinkles.
const WRINKLES: (&str, f64) = ("NH", 0.1);
/// Stiffness of the hinges, over shear modulus times radius squared, of two more runs of it on each grid. They keep it smooth, as the
/// reference is, and make it a little stiffer: what is linear in them is taken off.
const HINGES: [f64; 2] = [5e-4, 1e-3];
/// Share of the usual step that a membrane bears whose nodes slip.
const SLIPPING: f64 = 0.7;
/// Nodes of one more mesh on the finest grid.
const FEW: usize = 642;
/// Row of a quick run.
const QUICK: (&str, f64) = ("NH", 0.1);

/// What the file says of a law and a capillary number.
struct Truth {
    law: String,
    material: Material,
    capillary: f64,
    deformation: f64,
    angle: f64,
    width: f64,
    /// Tank-treading period times the shear rate, where the file has it.
    period: Option<f64>,
}

impl Truth {
    /// Whether fine grids and the order are asked for.
    fn is_fine(&self) -> bool {
        FINE.contains(&(self.law.as_str(), self.capillary))
    }

    fn wrinkles(&self) -> bool {
        self.law == WRINKLES.0 && self.capillary <= WRINKLES.1
    }

    /// Whether the nodes of its usual runs slip, or lie inside the surface. Fine grids would need short steps for slip.
    fn slips(&self) -> bool {
        !self.is_fine() && !self.wrinkles()
    }

    /// Radii in spacings of its runs in full.
    fn radii(&self) -> &'static [f64] {
        if self.is_fine() { &FINER } else { &FINER[1..2] }
    }
}

/// One run: which truth, radius in spacings, edge of the box in radii, stiffness of the hinges, nodes if not the usual ones, and
/// whether these slip.
#[derive(Clone, Copy)]
struct Job {
    truth: usize,
    radius: f64,
    size: f64,
    bending: f64,
    nodes: Option<usize>,
    slip: bool,
}

/// The runs of a truth.
fn jobs(truth: usize, of: &Truth, quick: bool) -> Vec<Job> {
    let job = |radius, size| Job {
        truth,
        radius,
        size,
        bending: 0.0,
        nodes: None,
        slip: of.slips(),
    };
    let mut jobs = BOXES.map(|size| job(COARSE, size)).to_vec();
    if quick {
        return jobs;
    }
    jobs.extend(of.radii().iter().map(|&radius| job(radius, BOXES[0])));
    if of.wrinkles() {
        let hinged = |&radius: &f64| {
            HINGES.map(|bending| Job {
                bending,
                ..job(radius, BOXES[0])
            })
        };
        jobs.extend(of.radii().iter().flat_map(hinged));
        if of.is_fine() {
            jobs.push(Job {
                nodes: Some(FEW),
                ..job(FINER[0], BOXES[0])
            });
        }
    }
    if !of.slips() {
        jobs.push(Job {
            slip: true,
            ..job(FINER[1], BOXES[0])
        });
    }
    jobs
}

/// The rows of the file, the finest of each law and capillary number.
fn truths(table: &Table) -> Result<Vec<Truth>, Fault> {
    let mut all: Vec<Truth> = Vec::new();
    for row in table.rows() {
        let (law, capillary) = (row.text("law")?.to_owned(), row.number("Ca")?);
        let period = Some(row.number("tt_period_gdot")?).filter(|p| p.is_finite());
        let same = all.iter().position(|t| t.law == law && t.capillary == capillary);
        let period = period.or(same.and_then(|i| all[i].period));
        let truth = Truth {
            material: material(row)?,
            law,
            capillary,
            deformation: row.number("D")?,
            angle: row.number("theta_deg")?,
            width: row.number("W_over_a")?,
            period,
        };
        match same {
            Some(i) => all[i] = truth,
            None => all.push(truth),
        }
    }
    Ok(all)
}

fn run(truth: &Truth, job: Job, with_period: bool) -> Result<Steady, Fault> {
    let usual = capsule(truth.material, truth.capillary, 1.0, job.radius, job.size);
    let (share, inset) = if job.slip { (SLIPPING, 0.0) } else { (1.0, usual.inset) };
    let capsule = Capsule {
        bending: job.bending,
        slip: job.slip,
        inset,
        strain_per_step: share * usual.strain_per_step,
        nodes: job.nodes.unwrap_or(usual.nodes),
        ..usual
    };
    // The stiffer the membrane, the sooner it is settled; the box takes its time too.
    steady(&capsule, 5.0 + 8.0 * truth.capillary, with_period)
}

/// Capsules between sliding plates in boxes of 6 radii, the effect of the box taken off: the deformation within 3 % at 8
/// spacings a radius (6 in a quick run) and 1 % at 16, the inclination within 1 degree, the tank-treading period within 3 %.
/// The order in h is that of three grids in the same box. The nodes slip, or lie inside the capsule's surface by the kernel's
/// hydrodynamic shift: that is right for the flow around, and not for the fluid inside as it goes round.
///
/// The reference is smooth: its harmonics are of low degree and even. A neo-Hookean membrane without bending is compressed up to Ca 0.1
/// and wrinkles as short as mesh and grid let it, which takes compression and hence deformation off (on the finest grid, whose kernel no
/// longer smooths them, on any mesh) and turns the capsule. There D and inclination are gated as hinges of two stiffnesses leave them,
/// taken to none.
pub fn capsule_shear(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let all = truths(table)?;
    let wanted = |t: &Truth| {
        if effort.quick {
            (t.law.as_str(), t.capillary) == QUICK
        } else {
            FULL.iter()
                .any(|(law, list)| *law == t.law && list.contains(&t.capillary))
        }
    };
    let truths: Vec<_> = all.into_iter().filter(wanted).collect();
    findings.left_out = table.rows().len() - truths.len();
    let mut jobs: Vec<Job> = (0..truths.len())
        .flat_map(|n| jobs(n, &truths[n], effort.quick))
        .collect();
    // The longest first.
    jobs.sort_by(|a, b| (b.radius * b.size).total_cmp(&(a.radius * a.size)));
    let found = side_by_side(&jobs, |&job| {
        let truth = &truths[job.truth];
        let goes_round = !effort.quick && job.radius < 12.0 && job.bending == 0.0;
        run(truth, job, goes_round && truth.period.is_some())
    })?;
    for (number, truth) in truths.iter().enumerate() {
        let of = |job: &Job| job.truth == number;
        let runs = jobs.iter().zip(&found).filter(|(job, _)| of(job));
        let runs = Runs {
            truth,
            all: runs.map(|(job, (steady, seconds))| (*job, *steady, *seconds)).collect(),
        };
        runs.hold(&mut findings, effort.quick)?;
    }
    Ok(findings)
}

/// What was found of one truth.
struct Runs<'a> {
    truth: &'a Truth,
    all: Vec<(Job, Steady, f64)>,
}

impl Runs<'_> {
    /// The usual run on a grid in a box.
    fn of(&self, radius: f64, size: f64) -> Result<&Steady, Fault> {
        self.hinged(radius, size, 0.0)
    }

    fn hinged(&self, radius: f64, size: f64, bending: f64) -> Result<&Steady, Fault> {
        let usual = |job: &Job| job.nodes.is_none() && job.slip == self.truth.slips();
        let is = |job: &Job| usual(job) && job.radius == radius && job.size == size && job.bending == bending;
        let found = self.all.iter().find(|(job, ..)| is(job));
        let missing = || format!("no run of {radius} spacings a radius in a box of {size} radii");
        Ok(&found.ok_or_else(missing)?.1)
    }

    /// Holds them against the truth.
    fn hold(&self, findings: &mut Findings, quick: bool) -> Result<(), Fault> {
        let truth = self.truth;
        let exact = truth.deformation;
        let (small, large) = (self.of(COARSE, BOXES[0])?, self.of(COARSE, BOXES[1])?);
        let [boxed, free] = unbounded(BOXES, [small.deformation, large.deformation]);
        let [angle_boxed, angle_free] = unbounded(BOXES, [small.angle, large.angle]);
        let crowding = free / boxed;
        for (job, steady, seconds) in self.all.iter().filter(|(j, ..)| j.size == BOXES[0]) {
            findings.begin_done(row(truth, job.radius), *seconds);
            let deformation = steady.deformation * crowding;
            let wrinkles = truth.wrinkles() && !quick;
            let with = match (job.nodes, job.bending) {
                (Some(nodes), _) => Some(format!("on {nodes} nodes")),
                (_, hinges) if hinges > 0.0 => Some(format!("with hinges of {hinges} G a2")),
                _ => (wrinkles && job.radius > 12.0).then(|| "without hinges".to_owned()),
            };
            if job.slip && !truth.slips() {
                findings.check("D, nodes that slip", deformation, exact, gate(job.radius));
                let angle = steady.angle + angle_free - angle_boxed;
                findings.report("inclination, nodes that slip", angle, truth.angle, 1.0);
                continue;
            }
            if let Some(with) = with {
                findings.report(&format!("D {with}"), deformation, exact, exact);
                findings.report(&format!("width {with}"), steady.width, truth.width, truth.width);
                continue;
            }
            if job.radius < 8.0 && !quick {
                findings.report("D", deformation, exact, exact);
                continue;
            }
            findings.check("D", deformation, exact, gate(job.radius));
            findings.report("D in the box", steady.deformation, exact, exact);
            let angle = steady.angle + angle_free - angle_boxed;
            if wrinkles {
                findings.report("inclination without hinges", angle, truth.angle, 1.0);
            } else {
                findings.check_scaled("inclination (degrees)", angle, truth.angle, 1.0, 1.0);
            }
            findings.report("width", steady.width, truth.width, truth.width);
            findings.report("change of D in the last strain unit", steady.drift, 0.0, exact);
            if let (Some(period), Some(exact)) = (steady.period, truth.period) {
                let [boxed, free] = unbounded(BOXES, [small.period.unwrap_or(period), large.period.unwrap_or(period)]);
                findings.check("tank-treading period", period * free / boxed, exact, 0.03);
                findings.report("tank-treading period in the box", period, exact, exact);
            }
        }
        if quick {
            return Ok(());
        }
        let mut series = Vec::new();
        for &radius in truth.radii() {
            let mut found = self.of(radius, BOXES[0])?.deformation * crowding;
            if truth.wrinkles() {
                let [one, two] = HINGES.map(|hinges| self.hinged(radius, BOXES[0], hinges));
                let (one, two) = (one?, two?);
                let without = |one: f64, two: f64| one + (one - two) * HINGES[0] / (HINGES[1] - HINGES[0]);
                found = without(one.deformation, two.deformation) * crowding;
                findings.begin_done(row(truth, radius), 0.0);
                let name = "D, hinges extrapolated to none";
                if radius < COARSE {
                    findings.report(name, found, exact, exact);
                } else {
                    findings.check(name, found, exact, gate(radius));
                    let angle = without(one.angle, two.angle) + angle_free - angle_boxed;
                    findings.check_scaled("inclination, hinges extrapolated", angle, truth.angle, 1.0, 1.0);
                    let width = without(one.width, two.width);
                    findings.report("width, hinges extrapolated", width, truth.width, truth.width);
                }
            }
            series.push(found);
        }
        let [fine, middle, coarse] = series[..] else {
            return Ok(());
        };
        findings.begin_done(row(truth, FINER[0]), 0.0);
        let order = ((coarse - middle) / (middle - fine)).abs().log2();
        findings.report("order in h", order, 2.0, 2.0);
        let limit = fine + (fine - middle) / 3.0;
        findings.report("D extrapolated by second order", limit, exact, exact);
        Ok(())
    }
}

/// Greatest error of the deformation at so many spacings a radius.
fn gate(radius: f64) -> f64 {
    if radius > 12.0 { 0.01 } else { 0.03 }
}

fn row(truth: &Truth, radius: f64) -> BTreeMap<String, String> {
    key(&[
        ("law", truth.law.clone()),
        ("Ca", truth.capillary.to_string()),
        ("R_over_h", radius.to_string()),
    ])
}

/// A capsule in shear for 100 strain units (10 in a quick run): its volume drifts by less than 0.1 % held, and by less than 1 %
/// free. What is left is the time step's: nodes step along the tangents of their paths.
pub fn capsule_volume(effort: Effort) -> Outcome {
    let mut findings = Findings::of("capsule_volume");
    let strain = if effort.quick { 10.0 } else { 100.0 };
    let found = side_by_side(&[true, false], |&holds_volume| {
        let capsule = Capsule {
            holds_volume,
            nodes: 642,
            strain_per_step: 2.5e-4,
            ..capsule(Material::NeoHookean, 0.1, 1.0, 4.0, 6.0)
        };
        let mut sheared = capsule.sheared()?;
        let start = sheared.volume();
        let mut drift = 0.0_f64;
        for n in 1..=20 {
            sheared.run_to(strain * f64::from(n) / 20.0)?;
            drift = drift.max((sheared.volume() / start - 1.0).abs());
        }
        Ok(drift)
    })?;
    for ((name, gate), (drift, seconds)) in [("held", 1e-3), ("free", 1e-2)].into_iter().zip(found) {
        findings.begin_done(
            key(&[("volume", name.to_owned()), ("strain", strain.to_string())]),
            seconds,
        );
        findings.check_scaled("greatest volume drift", drift, 0.0, 1.0, gate);
    }
    Ok(findings)
}
