//! Chains at rest in flow, held together by contact alone: part c of `bead_dynamics`.

use super::{FIELD, RADIUS, bead};
use crate::Fault;
use crate::reference::{ReferenceError, Row};
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{BeadSystem, FixedDipoles, Flow, QuasiStatic, Uniform, contact_force};
use std::f64::consts::PI;

const VISCOSITY: f64 = 1e-3;
const D: f64 = 2.0 * RADIUS;
/// Most steps downhill to a place of rest.
const STEPS: usize = 20_000;
/// Relative change of a critical load that ends its search.
const SETTLED: f64 = 1e-5;

/// The values of rows of one case, which are those of a chain under growing load.
pub(super) fn values(rows: &[&Row]) -> Result<Vec<f64>, Fault> {
    let chain = Chain::of(rows.first().ok_or("a case has no rows")?)?;
    let mut values = vec![0.0; rows.len()];
    let mut loads = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        match row.text("quantity")? {
            "critical_load" | "g_break" => values[k] = chain.critical()?,
            quantity => {
                let at = quantity.split_once("_at_load=");
                let (name, load) = at.ok_or_else(|| row.unknown("quantity"))?;
                let load: f64 = load.parse().map_err(|_| row.unknown("quantity"))?;
                loads.push((k, name, load));
            }
        }
    }
    loads.sort_by(|a, b| a.2.total_cmp(&b.2));
    let mut state = chain.straight()?;
    for (k, name, load) in loads {
        chain.go_to(&mut state, load)?;
        values[k] = state.value(name).ok_or_else(|| rows[k].unknown("quantity"))?;
    }
    Ok(values)
}

/// A chain along the field z, in a flow along x.
struct Chain {
    n: usize,
    /// Whether the first bead is held; else the flow is at rest in the middle.
    pinned: bool,
    /// A flow that grows along z, or a uniform one.
    shear: bool,
}

/// A chain at rest.
struct State {
    load: f64,
    x: Soa3,
    /// Least force of its contacts, over that of a lone touching pair of dipoles; zero if one is open.
    least: f64,
}

impl Chain {
    /// What the case of a row says: `pinned chain of 10 in uniform flow`, `free pair in shear u=gamma z`.
    fn of(row: &Row) -> Result<Self, ReferenceError> {
        let unknown = || row.unknown("case");
        let (body, flow) = row.text("case")?.split_once(" in ").ok_or_else(unknown)?;
        let (held, what) = body.split_once(' ').ok_or_else(unknown)?;
        let n = match (what, what.strip_prefix("chain of ")) {
            ("pair", _) => 2,
            (_, Some(n)) => n.trim().parse().map_err(|_| unknown())?,
            _ => return Err(unknown()),
        };
        let chain = Self {
            n,
            pinned: held == "pinned",
            shear: flow.starts_with("shear"),
        };
        let known = ["pinned", "free"].contains(&held) && (chain.shear || flow == "uniform flow");
        // A free chain in a uniform flow has no rest: it goes with the flow.
        if known && n >= 2 && (chain.pinned || chain.shear) {
            Ok(chain)
        } else {
            Err(unknown())
        }
    }

    /// A load near the critical one: its moment about the middle of the free chain, or the pin, is that of F0 at the length.
    fn scale(&self) -> f64 {
        let n = self.n as f64;
        match (self.pinned, self.shear) {
            (true, false) => 1.0 / n,
            (true, true) => 2.0 / (n * n),
            (false, _) => 8.0 / (n * n),
        }
    }

    /// Without load.
    fn straight(&self) -> Result<State, Fault> {
        let middle = if self.pinned { 0.0 } else { 0.5 * (self.n - 1) as f64 };
        let mut state = State {
            load: 0.0,
            x: (0..self.n).map(|k| Vec3::z() * ((k as f64 - middle) * D)).collect(),
            least: 0.0,
        };
        self.rest(&mut state, 0.0)?;
        Ok(state)
    }

    /// Goes on to a load in steps: a chain that is put into a strong flow at once may part.
    fn go_to(&self, state: &mut State, load: f64) -> Result<(), Fault> {
        while state.load != load {
            let (step, left) = (0.35 * self.scale(), load - state.load);
            let next = if left.abs() > step {
                state.load + step.copysign(left)
            } else {
                load
            };
            self.rest(state, next)?;
        }
        Ok(())
    }

    /// Moves to where the chain rests under a load: drag on a bead over F0, in a shear flow of the velocity one diameter away.
    fn rest(&self, state: &mut State, load: f64) -> Result<(), Fault> {
        let of = bead(1.0, 2.0)?;
        let f0 = contact_force(RADIUS, of.response(Vec3::z() * FIELD).moment.z);
        let u = load * f0 / (6.0 * PI * VISCOSITY * RADIUS);
        let flow = if self.shear {
            Flow::shear(Vec3::zeros(), Vec3::x(), Vec3::z(), u / D)
        } else {
            Flow::uniform(Vec3::x() * u)
        };
        let mut system = BeadSystem::new(
            vec![of; self.n],
            state.x.clone(),
            Uniform::new(Vec3::z() * FIELD),
            FixedDipoles::new(),
            VISCOSITY,
        )?
        .with_flow(flow);
        if self.pinned {
            system = system.with_frozen([0]);
        }
        let mut rest = QuasiStatic::new(system).with_most_steps(STEPS);
        rest.relax()?;
        let least = rest
            .contacts()
            .iter()
            .map(|c| c.normal_force / f0)
            .fold(f64::INFINITY, f64::min);
        *state = State {
            load,
            x: rest.positions().iter().collect(),
            least: if rest.contacts().len() == self.n - 1 {
                least
            } else {
                0.0
            },
        };
        Ok(())
    }

    /// The load at which the least contact force is zero: it falls nearly with the square of the load, which is followed from
    /// below, for above it there is no place of rest.
    fn critical(&self) -> Result<f64, Fault> {
        let mut state = self.straight()?;
        let (mut square, mut least) = (0.0, state.least);
        self.go_to(&mut state, 0.35 * self.scale())?;
        let mut last = f64::INFINITY;
        for _ in 0..40 {
            let slope = (state.least - least) / (state.load.powi(2) - square);
            if slope.is_nan() || slope >= 0.0 {
                return Err(format!("the contacts of {} beads do not open as the load grows", self.n).into());
            }
            let zero = (state.load.powi(2) - state.least / slope).sqrt();
            if (zero - last).abs() <= SETTLED * zero {
                return Ok(zero);
            }
            (square, least, last) = (state.load.powi(2), state.least, zero);
            let part = if state.least > 0.3 { 0.6 } else { 0.8 };
            let next = state.load + part * (zero - state.load);
            self.go_to(&mut state, next)?;
        }
        Err(format!("the critical load of {} beads is not found: {last} at last", self.n).into())
    }
}

impl State {
    /// A quantity of the table.
    fn value(&self, name: &str) -> Option<f64> {
        let n = self.x.len();
        let tip = (self.x.get(n - 1) - self.x.get(0)) / D;
        let bond = |k: usize| {
            let along = self.x.get(k + 1) - self.x.get(k);
            along.x.atan2(along.z)
        };
        match name {
            "tip_x_over_d" => Some(tip.x),
            "tip_z_over_d" => Some(tip.z),
            "theta_first_bond_rad" => Some(bond(0)),
            "theta_middle_bond_rad" => Some(bond((n - 1) / 2)),
            "theta_last_bond_rad" => Some(bond(n - 2)),
            "min_contact_force_over_F0" => Some(self.least),
            _ => None,
        }
    }
}
