//! The ladder of magnetic models: error of a force against the time of a solve, rung by rung and order by order.

use super::{Chart, Row, Work, seconds_per_call};
use crate::Fault;
use crate::reference::{ReferenceError, Table};
use crate::speed::far_field::far_field;
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{
    Auto, Bead, FixedDipoles, Intrinsic, MU0, Model, Multipoles, MutualDipoles, PairCorrected, Problem, Solution,
    Uniform,
};

const RADIUS: f64 = 2e-6;
const FIELD: f64 = 0.05;
/// Unit of the tables' forces, N.
const FORCE: f64 = FIELD * FIELD * RADIUS * RADIUS / MU0;
/// Relative permeability of the beads.
const PERMEABILITY: f64 = 4.0;
/// Gaps between neighbours, in radii.
const GAPS: [f64; 2] = [0.01, 0.1];
/// Beads of a chain.
const LENGTH: f64 = 10.0;
/// Orders of multipoles, a point each; a quick run has the first ones.
const ORDERS: &[usize] = &[2, 4, 6, 8, 12, 16, 24];
const QUICK_ORDERS: usize = 4;
/// How much farther apart the beads are in every second solve: some motion between solves, which start from the last one.
const STRETCH: f64 = 1.0 + 5e-4;
/// Beads of the far field; a quick run has the first ones.
const COUNTS: &[usize] = &[2_000, 8_000, 40_000];
const QUICK_COUNTS: usize = 2;

/// Two beads.
pub const PAIRS: Chart = Chart {
    name: "pairs",
    title: "Force between two beads of permeability 4, the field along their line",
    cost: "cost of a solve, s",
    error: "relative error of the force",
    advice: "Auto, which is the pair correction for a pair: below 1e-6 at some five times the time of fixed dipoles, which \
             err by half and more. Multipoles are a hundred times dearer than it before they are near.",
    cases: |quick| compare(pairs()?, &ladder(quick, false), quick),
};

/// Straight chains.
pub const CHAINS: Chart = Chart {
    name: "chains",
    title: "Force on the end of a chain of 10 beads of permeability 4, the field along it",
    cost: "cost of a solve, s",
    error: "relative error of the force",
    advice: "Auto: 1 to 2 %, where dipoles of either kind err by 29 to 66 %. What has to be better than 1 % needs multipoles \
             of order 8 (gap of 0.1 radii) or 12 (0.01), at 70 to 260 times the time.",
    cases: |quick| compare(chains()?, &ladder(quick, false), quick),
};

/// Packed beads.
pub const CLUSTERS: Chart = Chart {
    name: "clusters",
    title: "Forces in a triangle of beads of permeability 4, 0.1 radii apart, the field in its plane",
    cost: "cost of a solve, s",
    error: "greatest error over the greatest force",
    advice: "Auto at its order, 8: 4e-4, ten times better than multipoles of that order at 1.4 times the time; order 6 for \
             1e-3. The pair correction alone errs by 6 % in a closed triangle. Below 1e-6 multipoles of order 24.",
    cases: |quick| compare(clusters()?, &ladder(quick, true), quick),
};

/// Many dipoles.
pub const FAR_FIELD: Chart = Chart {
    name: "far-field",
    title: "Forces and torques of all dipoles on all: direct sum and tree",
    cost: "cost of a sum, s",
    error: "rms error of the forces over their rms",
    advice: "The direct sum up to 2 000 beads, whose error is rounding; from 8 000 on a tree pays, at 40 000 it is \
             some ten times as fast with 1e-2, five with 1e-4 and two and a half with 1e-5.",
    cases: far,
};

/// Beads with the force on some, in units of the table.
struct Arrangement {
    case: String,
    x: Soa3,
    force: Vec<(usize, Vec3)>,
}

/// A rung of the ladder, with the greatest order of its multipoles.
struct Rung {
    curve: &'static str,
    order: usize,
    model: fn(usize) -> Box<dyn Model>,
}

/// All models; `auto` with the multipoles that it has where contacts close triangles, else with none.
fn ladder(quick: bool, triangles: bool) -> Vec<Rung> {
    let rung = |curve, order, model| Rung { curve, order, model };
    let mut ladder = vec![
        rung("fixed dipoles", 1, |_| Box::new(FixedDipoles::new())),
        rung("mutual dipoles", 1, |_| Box::new(MutualDipoles::new())),
        rung("pair corrected", 1, |_| Box::new(PairCorrected::new())),
    ];
    let orders = if quick { &ORDERS[..QUICK_ORDERS] } else { ORDERS };
    if triangles {
        for &order in orders {
            ladder.push(rung("auto", order, |order| Box::new(Auto::new().with_order(order))));
        }
    } else {
        ladder.push(rung("auto", 1, |_| Box::new(Auto::new())));
    }
    for &order in orders {
        ladder.push(rung("multipoles", order, |order| Box::new(Multipoles::new(order))));
    }
    ladder
}

fn own(name: &str) -> Result<Table, ReferenceError> {
    Table::read(&Table::own_folder(), name)
}

/// Whether a number of a table is the one asked, which may have lost its last digits.
fn is(number: f64, asked: f64) -> bool {
    (number - asked).abs() <= 1e-9 * asked
}

/// Pairs of `two_sphere_force`.
fn pairs() -> Result<Vec<Arrangement>, Fault> {
    let mut arrangements = Vec::new();
    for row in own("two_sphere_force")?.rows() {
        let (mu, s) = (row.number("mu_r")?, row.number("s")?);
        let Some(gap) = GAPS.into_iter().find(|gap| is(s - 2.0, *gap)) else {
            continue;
        };
        if mu == PERMEABILITY {
            arrangements.push(Arrangement {
                case: format!("gap {gap}"),
                x: [Vec3::zeros(), Vec3::z() * (s * RADIUS)].into_iter().collect(),
                force: vec![(1, Vec3::z() * row.number("F_par")?)],
            });
        }
    }
    Ok(arrangements)
}

/// Chains of `bead_chain_tension`.
fn chains() -> Result<Vec<Arrangement>, Fault> {
    let mut arrangements = Vec::new();
    for row in own("bead_chain_tension")?.rows() {
        let (mu, gap, n) = (row.number("mu_r")?, row.number("gap_over_a")?, row.number("N")?);
        if mu == PERMEABILITY && n == LENGTH {
            let n = n as usize;
            arrangements.push(Arrangement {
                case: format!("gap {gap}"),
                x: (0..n).map(|k| Vec3::z() * (k as f64 * (2.0 + gap) * RADIUS)).collect(),
                force: vec![(n - 1, Vec3::z() * -row.number("tension_end")?)],
            });
        }
    }
    Ok(arrangements)
}

/// The triangle in the plane of the field, of `bead_cluster_force`.
fn clusters() -> Result<Vec<Arrangement>, Fault> {
    let mut triangle = Arrangement {
        case: String::new(),
        x: Soa3::default(),
        force: Vec::new(),
    };
    for row in own("bead_cluster_force")?.rows() {
        if row.text("config")? != "triangle in plane of field" || row.number("mu_r")? != PERMEABILITY {
            continue;
        }
        let vector = |columns: [&str; 3]| -> Result<Vec3, ReferenceError> {
            let [x, y, z] = columns.map(|c| row.number(c));
            Ok(Vec3::new(x?, y?, z?))
        };
        triangle.x.push(vector(["x", "y", "z"])? * RADIUS);
        let bead = triangle.force.len();
        triangle.force.push((bead, vector(["Fx", "Fy", "Fz"])?));
    }
    Ok(vec![triangle])
}

/// Every rung on every arrangement.
fn compare(arrangements: Vec<Arrangement>, ladder: &[Rung], quick: bool) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    for of in &arrangements {
        let beads = of.beads()?;
        let field = Uniform::new(Vec3::z() * FIELD);
        let moved: Soa3 = of.x.iter().map(|x| x * STRETCH).collect();
        let here = Problem::new(&beads, of.x.view(), &field, 0.0)?;
        let there = Problem::new(&beads, moved.view(), &field, 0.0)?;
        let mut solvers: Vec<_> = ladder
            .iter()
            .map(|r| (r, (r.model)(r.order), Solution::new()))
            .collect();
        let mut works: Vec<Work<'_>> = Vec::new();
        for (_, model, out) in &mut solvers {
            works.push(Box::new(|| {
                model.solve(&there, out)?;
                Ok(model.solve(&here, out)?)
            }));
        }
        let costs = seconds_per_call(quick, &mut works)?;
        drop(works);
        for ((rung, _, out), cost) in solvers.iter().zip(costs) {
            let curve = match of.case.as_str() {
                "" => rung.curve.to_owned(),
                case => format!("{}, {case}", rung.curve),
            };
            rows.push(Row {
                case: of.case.clone(),
                curve,
                label: if rung.order > 1 {
                    format!("order {}", rung.order)
                } else {
                    rung.curve.into()
                },
                cost_s: 0.5 * cost,
                updates: (of.x.len() * rung.order * (rung.order + 2)) as f64,
                error: of.error(out),
            });
        }
    }
    Ok(rows)
}

impl Arrangement {
    fn beads(&self) -> Result<Vec<Bead>, Fault> {
        Ok(vec![
            Bead::new(RADIUS, 1500.0, Intrinsic::new(PERMEABILITY - 1.0)?)?;
            self.x.len()
        ])
    }

    /// Greatest of the known forces, in units of the table.
    fn largest(&self) -> f64 {
        self.force.iter().map(|(_, f)| f.norm()).fold(0.0, f64::max)
    }

    /// Greatest error of a force over the greatest force.
    fn error(&self, found: &Solution) -> f64 {
        let off = |(i, f): &(usize, Vec3)| (found.force.get(*i) / FORCE - f).norm();
        self.force.iter().map(off).fold(0.0, f64::max) / self.largest()
    }
}

/// The direct sum and trees.
fn far(quick: bool) -> Result<Vec<Row>, Fault> {
    let counts = if quick { &COUNTS[..QUICK_COUNTS] } else { COUNTS };
    let rows = far_field(counts, if quick { 0.05 } else { 1.0 })?;
    // Each curve ends with the direct sum.
    let (direct, mut ordered): (Vec<_>, Vec<_>) = rows.into_iter().partition(|row| row.label == "direct");
    ordered.extend(direct);
    let row = |of: crate::speed::far_field::Row| Row {
        case: of.n.to_string(),
        curve: format!("{} beads", of.n),
        label: of.label,
        cost_s: of.seconds,
        updates: (of.n * (of.n - 1)) as f64,
        error: of.rms_error,
    };
    Ok(ordered.into_iter().map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rung_reports_an_error_that_covers_the_true_one() {
        let field = Uniform::new(Vec3::z() * FIELD);
        let all = [pairs().unwrap(), chains().unwrap(), clusters().unwrap()];
        assert_eq!(all.each_ref().map(Vec::len), [2, 2, 1]);
        for of in all.iter().flatten() {
            let beads = of.beads().unwrap();
            let problem = Problem::new(&beads, of.x.view(), &field, 0.0).unwrap();
            for rung in ladder(false, true) {
                let mut out = Solution::new();
                (rung.model)(rung.order).solve(&problem, &mut out).unwrap();
                let (error, told) = (of.error(&out), out.error.force / FORCE / of.largest());
                let what = format!("{}, {} {}: {error:e} {told:e}", of.case, rung.curve, rung.order);
                assert!(error < told + 1e-8, "{what}");
                match (rung.curve, rung.order) {
                    ("fixed dipoles", _) => assert!(error > 0.3, "{what}"),
                    ("multipoles", 24) => assert!(error < 2e-4, "{what}"),
                    ("pair corrected" | "auto", 8..) if of.x.len() == 2 => assert!(error < 1e-6, "{what}"),
                    _ => {}
                }
            }
        }
    }
}
