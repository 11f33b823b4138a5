//! Two beads in a homogeneous field: the exact pair and every rung.

use super::{FIELD, FORCE, MOMENT, RADIUS, bead, covers, orders_at, solve};
use crate::Fault;
use crate::reference::{Row, Table};
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{FixedDipoles, Model, Multipoles, MutualDipoles, PairCorrected, TwoSpheres, Uniform};
use std::f64::consts::PI;

/// Two spheres, lengths in a.
#[derive(Clone, Copy, PartialEq)]
struct Pair {
    radius: [f64; 2],
    permeability: [f64; 2],
}

/// A row of either table.
struct Line<'a> {
    row: &'a Row,
    pair: Pair,
    distance: f64,
}

/// What a quantity has to be: value, reference, what the error is relative to, gate or none.
struct Check(&'static str, f64, f64, f64, Option<f64>);

impl Line<'_> {
    /// Distance of the centres in mean radii.
    fn s(&self) -> f64 {
        2.0 * self.distance / (self.pair.radius[0] + self.pair.radius[1])
    }

    fn strongest(&self) -> f64 {
        self.pair.permeability[0].max(self.pair.permeability[1])
    }

    /// Force on the second sphere, in units of the table, field at `alpha` from the line, which is the z axis.
    fn force(&self, columns: [&str; 3], alpha: f64) -> Result<Vec3, Fault> {
        let [par, perp, tan] = columns.map(|c| self.row.number(c));
        let (sin, cos) = alpha.sin_cos();
        let tan = if sin * cos == 0.0 { 0.0 } else { tan? * 2.0 * sin * cos };
        Ok(Vec3::new(-tan, 0.0, par? * cos * cos + perp? * sin * sin))
    }
}

/// Equal spheres: see [`rows_of`].
pub fn two_sphere_force(table: &Table, effort: Effort) -> Outcome {
    let line = |row| -> Result<Line<'_>, Fault> {
        let mu = Row::number(row, "mu_r")?;
        Ok(Line {
            row,
            pair: Pair {
                radius: [1.0; 2],
                permeability: [mu; 2],
            },
            distance: row.number("s")?,
        })
    };
    let lines = table.rows().iter().map(line).collect::<Result<Vec<_>, Fault>>()?;
    rows_of(
        table,
        &lines,
        &["mu_r", "s"],
        ["m_par", "m_par", "m_perp", "m_perp"],
        effort,
    )
}

/// Unequal spheres: see [`rows_of`].
pub fn unequal_pair_force(table: &Table, effort: Effort) -> Outcome {
    let line = |row| -> Result<Line<'_>, Fault> {
        Ok(Line {
            row,
            pair: Pair {
                radius: [Row::number(row, "a1")?, row.number("a2")?],
                permeability: [row.number("mu1")?, row.number("mu2")?],
            },
            distance: row.number("R")?,
        })
    };
    let lines = table.rows().iter().map(line).collect::<Result<Vec<_>, Fault>>()?;
    let moments = ["m1_par", "m2_par", "m1_perp", "m2_perp"];
    rows_of(table, &lines, &["mu1", "mu2", "a1", "a2", "R"], moments, effort)
}

/// The exact pair to 1e-9, or where the table itself is worse than 1e-10 to thrice its own `conv`; fixed and mutual dipoles
/// to 1e-9; with the pair correction to 1e-4; multipoles to 1e-6 at gaps from 0.1 mean radii, and closer to mu_r 4 (not with `quick`).
/// Everywhere else, and for the dipoles against the exact force, the reported error covers the true one.
fn rows_of(table: &Table, lines: &[Line<'_>], key: &[&str], moments: [&str; 4], effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let mut kinds: Vec<(Pair, Vec<&Line<'_>>)> = Vec::new();
    for line in lines {
        match kinds.iter_mut().find(|(pair, _)| *pair == line.pair) {
            Some((_, of)) => of.push(line),
            None => kinds.push((line.pair, vec![line])),
        }
    }
    let computed = side_by_side(&kinds, |(_, of)| {
        let mut rungs = Rungs::new();
        of.iter()
            .map(|line| {
                let clock = std::time::Instant::now();
                let checks = rungs.checks(line, moments, effort)?;
                Ok((checks, clock.elapsed().as_secs_f64()))
            })
            .collect::<Result<Vec<_>, Fault>>()
    })?;
    for ((_, of), (rows, _)) in kinds.iter().zip(computed) {
        for (line, (checks, seconds)) in of.iter().zip(rows) {
            findings.begin_done(line.row.key(key), seconds);
            for Check(quantity, value, reference, scale, gate) in checks {
                match gate {
                    Some(gate) => findings.check_scaled(quantity, value, reference, scale, gate),
                    None => covers(&mut findings, quantity, value, scale),
                }
            }
        }
    }
    Ok(findings)
}

/// Force on the second bead, the error that the model reports of it, and both moments, in units of the table.
type Run = Result<(Vec3, f64, [Vec3; 2]), Fault>;

/// Models that keep their tables from row to row.
struct Rungs {
    fixed: FixedDipoles,
    mutual: MutualDipoles,
    corrected: PairCorrected,
    far: PairCorrected,
}

impl Rungs {
    fn new() -> Self {
        Self {
            fixed: FixedDipoles::new(),
            mutual: MutualDipoles::new().with_tolerance(1e-12),
            corrected: PairCorrected::new(),
            far: PairCorrected::new().with_reach(40.0),
        }
    }

    fn checks(&mut self, line: &Line<'_>, moments: [&str; 4], effort: Effort) -> Result<Vec<Check>, Fault> {
        let mut checks = Vec::new();
        let row = line.row;
        let reference_error = row.number("conv")?;
        let exact_gate = if reference_error > 1e-10 {
            3.0 * reference_error
        } else {
            1e-9
        };
        let exact = TwoSpheres::new(line.pair.radius, line.pair.permeability)?.solve(line.distance)?;
        let unit = 4.0 * PI;
        for (quantity, value, column) in [
            ("F_par", exact.force_par, "F_par"),
            ("F_perp", exact.force_perp, "F_perp"),
            ("F_tan", exact.force_tan, "F_tan"),
            ("m1 par", exact.moment_par[0] / unit, moments[0]),
            ("m2 par", exact.moment_par[1] / unit, moments[1]),
            ("m1 perp", exact.moment_perp[0] / unit, moments[2]),
            ("m2 perp", exact.moment_perp[1] / unit, moments[3]),
        ] {
            let reference = row.number(column)?;
            checks.push(Check(quantity, value, reference, reference.abs(), Some(exact_gate)));
        }
        let beads = [
            bead(line.pair.radius[0], line.pair.permeability[0])?,
            bead(line.pair.radius[1], line.pair.permeability[1])?,
        ];
        let x: Soa3 = [Vec3::zeros(), Vec3::z() * (line.distance * RADIUS)]
            .into_iter()
            .collect();
        let mut run = |model: &mut dyn Model, alpha: f64| -> Run {
            let (sin, cos) = alpha.sin_cos();
            let source = Uniform::new(Vec3::new(sin, 0.0, cos) * FIELD);
            let out = solve(model, &beads, &x, &source)?;
            let moments = [out.moment.get(0) / MOMENT, out.moment.get(1) / MOMENT];
            Ok((out.force.get(1) / FORCE, out.error.force / FORCE, moments))
        };
        let exact = ["F_par", "F_perp", "F_tan"];
        for (alpha, names) in [(0.0, ["F_par_FD", "F_par_MD"]), (0.5 * PI, ["F_perp_FD", "F_perp_MD"])] {
            let truth = line.force(exact, alpha)?;
            let models: [(&mut dyn Model, &str); 2] = [
                (&mut self.fixed, "fixed dipoles, error in its estimate"),
                (&mut self.mutual, "mutual dipoles, error in its estimate"),
            ];
            for ((model, in_estimate), name) in models.into_iter().zip(names) {
                let (force, estimate, _) = run(model, alpha)?;
                let reference = row.number(name)?;
                let quantity = if name.ends_with("FD") {
                    "fixed dipoles"
                } else {
                    "mutual dipoles"
                };
                checks.push(Check(quantity, force.z, reference, reference.abs(), Some(1e-9)));
                checks.push(Check(in_estimate, (force - truth).norm(), 0.0, estimate, None));
            }
        }
        if row.number("F_tan_MD").is_ok() {
            let (force, ..) = run(&mut self.mutual, 0.25 * PI)?;
            let reference = row.number("F_tan_MD")?;
            checks.push(Check(
                "mutual dipoles, F_tan",
                -force.x,
                reference,
                reference.abs(),
                Some(1e-9),
            ));
        }
        let trusted = reference_error <= 1e-6 && exact_gate <= 1e-9;
        for alpha in [0.0, 0.5 * PI, 0.7] {
            let truth = line.force(exact, alpha)?;
            let (force, ..) = run(&mut self.far, alpha)?;
            let off = (force - truth).norm();
            if trusted {
                checks.push(Check(
                    "pair correction to any distance",
                    off,
                    0.0,
                    truth.norm(),
                    Some(1e-4),
                ));
            }
            let (force, estimate, _) = run(&mut self.corrected, alpha)?;
            let quantity = "pair correction, error in its estimate";
            checks.push(Check(quantity, (force - truth).norm(), 0.0, estimate, None));
        }
        self.multipoles(line, moments, effort, &mut run, &mut checks)?;
        Ok(checks)
    }

    fn multipoles(
        &self,
        line: &Line<'_>,
        moments: [&str; 4],
        effort: Effort,
        run: &mut dyn FnMut(&mut dyn Model, f64) -> Run,
        checks: &mut Vec<Check>,
    ) -> Result<(), Fault> {
        let apart = line.s() >= 2.1 - 1e-9;
        let gated = apart || line.strongest() <= 4.0 && !effort.quick;
        let most = if gated {
            70
        } else if effort.quick {
            12
        } else {
            40
        };
        let mut model = Multipoles::new(orders_at(line.s(), most))
            .with_tolerance(1e-13)
            .with_reach(100.0);
        for (alpha, axis, names) in [
            (0.0, 2, [moments[0], moments[1]]),
            (0.5 * PI, 0, [moments[2], moments[3]]),
        ] {
            let truth = line.force(["F_par", "F_perp", "F_tan"], alpha)?;
            let (force, estimate, found) = run(&mut model, alpha)?;
            let off = (force - truth).norm();
            if gated {
                checks.push(Check("multipoles", off, 0.0, truth.norm(), Some(1e-6)));
                for (m, name) in found.iter().zip(names) {
                    let reference = line.row.number(name)?;
                    checks.push(Check(
                        "multipoles, moment",
                        m[axis],
                        reference,
                        reference.abs(),
                        Some(1e-6),
                    ));
                }
            }
            // The reference has twelve digits, and solving costs a few more.
            let reported = estimate + 1e-10 * truth.norm();
            checks.push(Check("multipoles, error in its estimate", off, 0.0, reported, None));
        }
        Ok(())
    }
}
