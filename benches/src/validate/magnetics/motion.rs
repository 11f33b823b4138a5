//! Overdamped pairs against closed forms and quadratures, chains in flow, and drag near walls.

use super::{FIELD, RADIUS, bead, chains_at_rest};
use crate::Fault;
use crate::reference::{ReferenceError, Row, Table};
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{
    Apparent, Bead, FixedDipoles, MU0, Model, Overdamped, PairCorrected, PairMobility, Uniform, parallel_drag,
    perpendicular_drag, squeeze_mobility,
};
use std::f64::consts::PI;

const VISCOSITY: f64 = 1e-3;
/// Greatest relative error of a time, a place or an angle.
const GATE: f64 = 5e-3;

/// Drag of a sphere normal to a wall and along it, the latter by the greater of Faxen's terms and the near limit.
pub fn sphere_wall_drag(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    for row in table.rows() {
        findings.begin(row.key(&["gap_over_a"]));
        let gap = row.number("gap_over_a")?;
        findings.check("normal", perpendicular_drag(gap), row.number("perp_brenner")?, 1e-8);
        let along = row.number("par_faxen5")?.max(row.number("par_near")?);
        findings.check("along", parallel_drag(gap), along, 1e-8);
    }
    Ok(findings)
}

/// The rows of one case, and the text that says what it is.
struct Motion<'a> {
    case: &'a str,
    says: String,
    rows: Vec<&'a Row>,
}

/// Times, places, angles, contact forces and critical loads within 0.5 %.
pub fn bead_dynamics(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let mut cases: Vec<Motion<'_>> = Vec::new();
    for row in table.rows() {
        let case = row.text("case")?;
        if !cases.iter().any(|c| c.case == case) {
            let (says, rows) = (String::new(), Vec::new());
            cases.push(Motion { case, says, rows });
        }
        if let Some(of) = cases.iter_mut().find(|c| c.case == case) {
            if of.says.is_empty() && row.text("model_and_units")? != "same" {
                of.says = row.text("model_and_units")?.to_owned();
            }
            of.rows.push(row);
        }
    }
    // A table of some rows only may lack the one that says what the case is.
    let own = Table::read(&Table::own_folder(), table.name())?;
    for case in cases.iter_mut().filter(|c| c.says.is_empty()) {
        for row in own
            .rows()
            .iter()
            .filter(|r| r.text("case").is_ok_and(|c| c == case.case))
        {
            let says = row.text("model_and_units")?;
            if case.says.is_empty() && says != "same" {
                case.says = says.to_owned();
            }
        }
    }
    let computed = side_by_side(&cases, |case| case.compute())?;
    for (case, (values, seconds)) in cases.iter().zip(computed) {
        for (k, (row, value)) in case.rows.iter().zip(values).enumerate() {
            let spent = if k == 0 { seconds } else { 0.0 };
            findings.begin_done(row.key(&["part", "case"]), spent);
            let reference = row.number("value")?;
            // A quantity whose reference is zero is the start itself.
            let scale = if reference == 0.0 { 1.0 } else { reference.abs() };
            findings.check_scaled(row.text("quantity")?, value, reference, scale, GATE);
        }
    }
    Ok(findings)
}

/// The number behind `name=` in a text, `name` a word of its own.
fn number_in(text: &str, name: &str) -> Option<f64> {
    let pattern = format!("{name}=");
    let own_word = |at: &usize| !text[..*at].ends_with(|c: char| c.is_alphanumeric());
    let at = text.match_indices(&pattern).map(|(at, _)| at).find(own_word)?;
    leading(&text[at + pattern.len()..])
}

/// The number that a text begins with.
fn leading(text: &str) -> Option<f64> {
    let end = text
        .find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)))
        .unwrap_or(text.len());
    text[..end].parse().ok()
}

impl Motion<'_> {
    fn compute(&self) -> Result<Vec<f64>, Fault> {
        if self.case == "mobility" {
            return self.rows.iter().map(|row| mobility(row)).collect();
        }
        match self.rows[0].text("part")? {
            "b" => return self.approach(),
            "c" => return chains_at_rest::values(&self.rows),
            _ => {}
        }
        if self.says.contains("aligned") {
            return self.aligned();
        }
        if self.case.starts_with("oblique") {
            return self.oblique();
        }
        if self.case.starts_with("perpendicular") {
            return self.perpendicular();
        }
        Err(self.unknown("case").into())
    }

    fn unknown(&self, column: &str) -> ReferenceError {
        self.rows[0].unknown(column)
    }

    fn says(&self, name: &str) -> Result<f64, ReferenceError> {
        number_in(&self.says, name).ok_or_else(|| self.unknown("model_and_units"))
    }

    /// Two beads of given moments, nose to tail: contact after 2 pi^2 eta a (r0^5 - d^5)/(5 mu0 m^2).
    fn aligned(&self) -> Result<Vec<f64>, Fault> {
        let (viscosity, a, m) = (self.says("eta")?, self.says("a")?, self.says("m")?);
        let (d, ratio) = (2.0 * a, self.says("r0")?);
        let field = Vec3::z() * (m * MU0 / (4.0 / 3.0 * PI * a.powi(3)));
        let run = || -> Result<Pair, Fault> {
            let of = Bead::new(a, 1500.0, Apparent::new(1.0)?)?;
            let start = Vec3::z() * (ratio * d);
            let run = Overdamped::new(
                vec![of; 2],
                [Vec3::zeros(), start].into_iter().collect(),
                Uniform::new(field),
                FixedDipoles::new().with_moments([Vec3::z() * m; 2].into_iter().collect()),
                viscosity,
            )?;
            Ok(Pair(run.with_steps(1e-6, f64::INFINITY)))
        };
        let contact = 2.0 * PI * PI * viscosity * a * ((ratio * d).powi(5) - d.powi(5)) / (5.0 * MU0 * m * m);
        let mut values = Vec::new();
        for row in &self.rows {
            let mut pair = run()?;
            let quantity = row.text("quantity")?;
            if let Some(part) = quantity.strip_prefix("r_over_d_at_").and_then(leading) {
                pair.0.run_to(part * contact)?;
                values.push(pair.apart().norm() / d);
            } else if quantity.starts_with("t_contact") {
                values.push(pair.reach(d)?.0);
            } else {
                return Err(row.unknown("quantity").into());
            }
        }
        Ok(values)
    }

    fn oblique(&self) -> Result<Vec<f64>, Fault> {
        let named = |name: &str| number_in(self.case, name).ok_or_else(|| self.unknown("case"));
        let mut pair = Pair::at(
            named("x0")?,
            named("alpha0")?,
            2.0,
            FixedDipoles::new(),
            PairMobility::None,
        )?;
        let (time, apart) = pair.reach(2.0 * RADIUS)?;
        let value = |row: &&Row| match row.text("quantity")? {
            "t_contact_over_t0" => Ok(time / t0(2.0)?),
            "contact_angle_rad" => Ok(apart.x.atan2(apart.z)),
            _ => Err(row.unknown("quantity").into()),
        };
        self.rows.iter().map(value).collect()
    }

    fn perpendicular(&self) -> Result<Vec<f64>, Fault> {
        let start = self.says.find("from ").and_then(|at| leading(&self.says[at + 5..]));
        let start = start.ok_or_else(|| self.unknown("model_and_units"))?;
        let mut pair = Pair::at(start, 0.5 * PI, 2.0, FixedDipoles::new(), PairMobility::None)?;
        pair.0.run_to(self.says("t")? * t0(2.0)?)?;
        let value = |row: &&Row| match row.text("quantity")? {
            "r_over_a" => Ok(pair.apart().norm() / RADIUS),
            _ => Err(row.unknown("quantity").into()),
        };
        self.rows.iter().map(value).collect()
    }

    /// An aligned pair from far to near: times in t0.
    fn approach(&self) -> Result<Vec<f64>, Fault> {
        let (forces, hydrodynamics) = self.case.split_once(';').ok_or_else(|| self.unknown("case"))?;
        let mobility = match hydrodynamics.trim() {
            "no HI" => PairMobility::None,
            "Rotne-Prager" => PairMobility::RotnePrager,
            "exact squeeze" | "exact two-sphere squeeze" => PairMobility::Squeeze,
            _ => return Err(self.unknown("case").into()),
        };
        let (permeability, model): (f64, Box<dyn Model>) = match number_in(forces, "mu_r") {
            Some(mu) => (mu, Box::new(PairCorrected::new().with_reach(12.0))),
            None if forces == "fixed dipole" => (2.0, Box::new(FixedDipoles::new())),
            None => return Err(self.unknown("case").into()),
        };
        let start = self.says("r/a")?;
        let mut pair = Pair::at(start, 0.0, permeability, model, mobility)?;
        let mut order = Vec::new();
        for (k, row) in self.rows.iter().enumerate() {
            let at = number_in(row.text("quantity")?, "r/a").ok_or_else(|| row.unknown("quantity"))?;
            order.push((k, at));
        }
        order.sort_by(|a, b| b.1.total_cmp(&a.1));
        let mut values = vec![0.0; order.len()];
        for (k, at) in order {
            if at < start {
                values[k] = pair.reach(at * RADIUS)?.0 / t0(permeability)?;
            }
        }
        Ok(values)
    }
}

fn mobility(row: &Row) -> Result<f64, Fault> {
    let quantity = row.text("quantity")?;
    let x = number_in(quantity, "r/a").ok_or_else(|| row.unknown("quantity"))?;
    match quantity.split("_at_").next() {
        Some("exact_squeeze") => Ok(squeeze_mobility(x)),
        Some("rotne_prager") => {
            // The velocity of approach under opposite forces: here the field's pull, over that without interaction.
            let speed = |mobility| -> Result<f64, Fault> {
                let mut pair = Pair::at(x, 0.0, 2.0, FixedDipoles::new(), mobility)?;
                pair.0.advance(1e-9 * t0(2.0)?)?;
                Ok(pair.0.velocities().get(1).z)
            };
            Ok(speed(PairMobility::RotnePrager)? / speed(PairMobility::None)?)
        }
        _ => Err(row.unknown("quantity").into()),
    }
}

/// t0 = 2 pi^2 eta a^6/(mu0 m^2), m the moment of a lone bead.
fn t0(permeability: f64) -> Result<f64, Fault> {
    let m = bead(1.0, permeability)?.response(Vec3::z() * FIELD).moment.z;
    Ok(2.0 * PI * PI * VISCOSITY * RADIUS.powi(6) / (MU0 * m * m))
}

/// Two beads under way.
struct Pair(Overdamped);

impl Pair {
    /// `x` radii between centres, at `alpha` from the field.
    fn at(
        x: f64,
        alpha: f64,
        permeability: f64,
        model: impl Model + 'static,
        mobility: PairMobility,
    ) -> Result<Self, Fault> {
        let second = Vec3::new(alpha.sin(), 0.0, alpha.cos()) * (x * RADIUS);
        let places: Soa3 = [Vec3::zeros(), second].into_iter().collect();
        let beads = vec![bead(1.0, permeability)?; 2];
        let run = Overdamped::new(beads, places, Uniform::new(Vec3::z() * FIELD), model, VISCOSITY)?;
        Ok(Self(run.with_pair_mobility(mobility).with_steps(1e-6, f64::INFINITY)))
    }

    fn apart(&self) -> Vec3 {
        self.0.positions().get(1) - self.0.positions().get(0)
    }

    /// Goes on until the centres are `distance` (m) apart; time (s) and vector between them there, linear in the last step.
    fn reach(&mut self, distance: f64) -> Result<(f64, Vec3), Fault> {
        for _ in 0..1_000_000 {
            let (before, from) = (self.0.time(), self.apart());
            let was = from.norm();
            if was <= distance {
                return Ok((before, from));
            }
            self.0.advance(f64::INFINITY)?;
            let now = self.apart().norm();
            if now <= distance * (1.0 + 1e-9) {
                let s = ((was - distance) / (was - now)).min(1.0);
                return Ok((before + s * (self.0.time() - before), from + (self.apart() - from) * s));
            }
        }
        Err(format!("the pair does not come to {distance:e} m in a million steps").into())
    }
}
