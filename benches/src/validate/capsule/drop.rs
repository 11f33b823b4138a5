//! Drops of another viscosity in a shear flow, against the deformation of Taylor and Cox.

use super::Material;
use super::images::strain_of_images;
use super::scene::Capsule;
use super::steady::{capsule, key};
use crate::Fault;
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use lbm_ibm::ibm::Kernel;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Edge of the box in radii.
const SIZE: f64 = 6.0;
/// Viscosity ratios, capillary numbers and radii in spacings. The more viscous a drop, the longer it settles.
const DROPS: &[(f64, f64, &[f64])] = &[
    (5.0, 0.02, &RADII),
    (1.0, 0.02, &RADII),
    (0.2, 0.05, &RADII),
    (20.0, 0.02, COARSE),
];
/// Radii in spacings, each 1.5 times the next.
const RADII: [f64; 3] = [12.0, 8.0, 16.0 / 3.0];
/// Those of the most viscous drop, and of a quick run.
const COARSE: &[f64] = &[8.0, 16.0 / 3.0];
/// Viscosity ratios of a quick run.
const QUICK: [f64; 2] = [5.0, 0.2];
/// Relaxation time around drops that are less viscous than the fluid there.
const THIN_TAU: f64 = 3.0;
/// Such a drop settles in no less than so many times in which momentum diffuses over its radius.
const SLOW: f64 = 2.5;
/// Difference of Taylor's deformation and Cox's up to which both gate.
const ALIKE: f64 = 0.01;
/// Relaxation times after which the shape is read: a later one has more of the mesh's distortion.
const SETTLED: f64 = 6.0;
/// Nodes of the mesh over the squared radius in spacings: edges are 0.63 spacings long.
const NODES: f64 = 36.0;

/// One run: viscosity ratio, capillary number and radius in spacings.
#[derive(Clone, Copy)]
struct Job {
    ratio: f64,
    capillary: f64,
    radius: f64,
}

impl Job {
    /// Time in which the deformation settles, times the shear rate: viscosity times radius over tension,
    /// `(19 l + 16)(2 l + 3)/(40 (l + 1))`.
    fn relaxation(&self) -> f64 {
        let l = self.ratio;
        self.capillary * (19.0 * l + 16.0) * (2.0 * l + 3.0) / (40.0 * (l + 1.0))
    }

    /// Taylor's deformation, `Ca (19 l + 16)/(16 l + 16)` (Proc. R. Soc. A 146, 501, 1934), for little Ca and l Ca.
    fn taylor(&self) -> f64 {
        self.capillary * (19.0 * self.ratio + 16.0) / (16.0 * self.ratio + 16.0)
    }

    /// Cox's deformation, for little Ca or large l (J. Fluid Mech. 37, 601, 1969):
    /// `5 (19 l + 16)/(4 (l + 1) sqrt((20/Ca)^2 + (19 l)^2))`. The vorticity turns a viscous drop away from the strain before it is drawn out.
    fn cox(&self) -> f64 {
        let l = self.ratio;
        5.0 * (19.0 * l + 16.0) / (4.0 * (l + 1.0) * (20.0 / self.capillary).hypot(19.0 * l))
    }

    /// How much faster the drop is strained in the box than in an unbounded flow, by its stresslet.
    fn crowding(&self) -> f64 {
        let stresslet = 2.0 * PI / 3.0 * (5.0 * self.ratio + 2.0) / (self.ratio + 1.0);
        1.0 + 2.0 * stresslet * strain_of_images(1.0) / SIZE.powi(3)
    }

    fn run(&self) -> Result<Found, Fault> {
        let usual = capsule(Material::Tension, self.capillary, self.ratio, self.radius, SIZE);
        let thin = Capsule {
            tau: THIN_TAU,
            strain_per_step: self.relaxation() * (THIN_TAU - 0.5) / (3.0 * SLOW * self.radius * self.radius),
            ..usual
        };
        let capsule = Capsule {
            nodes: (NODES * self.radius * self.radius) as usize,
            kernel: Kernel::TwoPoint,
            // Tension acts along the normal alone, so that the tangential velocity has no kink for the kernel to blunt.
            inset: 0.0,
            slip: false,
            ..if self.ratio < 1.0 { thin } else { usual }
        };
        let mut sheared = capsule.sheared()?;
        let mut inside = 0.0_f64;
        for n in 1..=6 {
            sheared.run_to(SETTLED / 6.0 * f64::from(n) * self.relaxation())?;
            inside = inside.max(sheared.inside_error().abs());
        }
        let shape = sheared.shape();
        Ok(Found {
            deformation: shape.deformation() / self.crowding(),
            boxed: shape.deformation(),
            angle: shape.angle,
            inside,
        })
    }
}

/// What a run gives: deformation without the box and in it, inclination (degrees), greatest error of the volume inside.
struct Found {
    deformation: f64,
    boxed: f64,
    angle: f64,
    inside: f64,
}

fn name(job: &Job, radius: &str) -> BTreeMap<String, String> {
    key(&[
        ("lambda", job.ratio.to_string()),
        ("Ca", job.capillary.to_string()),
        ("R_over_h", radius.to_owned()),
    ])
}

/// Drops of 0.2 to 20 times the viscosity (of 5 and 0.2 times in a quick run): the deformation, the effect of the box taken off by the
/// images of the drop's stresslet, is within 3 % of Cox's, and of Taylor's where the two are alike, at 12 spacings a radius and
/// extrapolated from the two finest grids. The kernel blunts what the tension does, and the mesh has corners: both fall off with
/// the squared spacing over radius. The volume of the fluid inside follows the surface within 1e-3.
pub fn drop_shear(effort: Effort) -> Outcome {
    let mut findings = Findings::of("drop_shear");
    let drops = DROPS.iter().filter(|d| !effort.quick || QUICK.contains(&d.0));
    let series: Vec<Vec<Job>> = drops
        .map(|&(ratio, capillary, radii)| {
            let radii = if effort.quick { COARSE } else { radii };
            let job = |&radius| Job {
                ratio,
                capillary,
                radius,
            };
            radii.iter().map(job).collect()
        })
        .collect();
    let mut found = side_by_side(&series.concat(), Job::run)?.into_iter();
    for jobs in &series {
        let found: Vec<_> = found.by_ref().take(jobs.len()).collect();
        let exact = jobs[0].cox();
        for (job, (found, seconds)) in jobs.iter().zip(&found) {
            findings.begin_done(name(job, &format!("{:.3}", job.radius)), *seconds);
            let gate = (job.radius == RADII[0]).then_some(0.03);
            compare(&mut findings, job, found.deformation, gate);
            findings.report("D in the box", found.boxed, exact, exact);
            // While the shape settles, the vorticity turns it.
            let angle = 45.0 - 0.5 * job.relaxation().atan().to_degrees();
            findings.report("inclination (degrees)", found.angle, angle, 45.0);
            findings.check_scaled("volume inside", found.inside, 0.0, 1.0, 1e-3);
        }
        let [fine, coarse] = [0, 1].map(|n| (jobs[n].radius.powi(-2), found[n].0.deformation));
        let limit = fine.1 + (fine.1 - coarse.1) * fine.0 / (coarse.0 - fine.0);
        findings.begin_done(name(&jobs[0], "extrapolated"), 0.0);
        compare(&mut findings, &jobs[0], limit, Some(0.03));
        if let [fine, middle, coarse] = &found[..] {
            let d = |f: &(Found, f64)| f.0.deformation;
            let steps = (d(coarse) - d(middle)) / (d(middle) - d(fine));
            findings.report("order in h", steps.ln() / (RADII[0] / RADII[1]).ln(), 2.0, 2.0);
        }
    }
    Ok(findings)
}

/// Holds a deformation against Cox's, and against Taylor's where that gates too.
fn compare(findings: &mut Findings, job: &Job, deformation: f64, gate: Option<f64>) {
    let (cox, taylor) = (job.cox(), job.taylor());
    let mut hold = |name: &str, exact: f64, gate: Option<f64>| match gate {
        Some(gate) => findings.check(name, deformation, exact, gate),
        None => findings.report(name, deformation, exact, exact),
    };
    hold("D", cox, gate);
    hold(
        "D against Taylor's",
        taylor,
        gate.filter(|_| taylor / cox - 1.0 < ALIKE),
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cox's deformation is Taylor's for little Ca and `5/(4 l)` for very viscous drops.
    #[test]
    fn the_limits_of_the_deformation() {
        let job = |ratio, capillary| Job {
            ratio,
            capillary,
            radius: 8.0,
        };
        let slow = job(5.0, 1e-4);
        assert!((slow.cox() / slow.taylor() - 1.0).abs() < 1e-6);
        let viscous = job(1e4, 1.0);
        assert!((viscous.cox() * 1e4 / 1.25 - 1.0).abs() < 1e-3);
    }
}
