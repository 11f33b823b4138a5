//! Data of the charts of the ladder of magnetic models: error against time, rung by rung and order by order.

use crate::Fault;
use crate::reference::{Row, Table};
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{
    Auto, Bead, FixedDipoles, Intrinsic, MU0, Model, Multipoles, MutualDipoles, PairCorrected, Problem, Solution,
    Uniform,
};
use std::path::Path;
use std::time::Instant;

const RADIUS: f64 = 2e-6;
const FIELD: f64 = 0.05;
/// Unit of the tables' forces, N.
const FORCE: f64 = FIELD * FIELD * RADIUS * RADIUS / MU0;
/// Orders of the multipoles that are charted.
const ORDERS: [usize; 7] = [2, 4, 6, 8, 12, 16, 24];
/// Solves of which the fastest counts.
const REPEATS: usize = 5;

/// One model on one arrangement.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// The arrangement: `mu_r 4, gap 0.1, N 10`.
    pub case: String,
    /// The model: `near multipoles`.
    pub rung: &'static str,
    /// Greatest order of its multipoles; 1 for dipoles.
    pub order: usize,
    /// Unknowns per bead, order (order + 2).
    pub unknowns: usize,
    /// Wall-clock seconds of the fastest of five solves that start from the solution.
    pub seconds: f64,
    /// Greatest error of a force over the greatest force.
    pub error: f64,
    /// The error that the model itself reports, over the same.
    pub reported: f64,
}

/// Beads with the force on each, in units of the table.
struct Arrangement {
    case: String,
    permeability: f64,
    x: Soa3,
    field: Vec3,
    /// Beads of which the force is known.
    force: Vec<(usize, Vec3)>,
}

/// Two equal beads of `two_sphere_force` in the reference `folder`, field along and across the line, at gaps up to a radius.
///
/// # Errors
/// Of the table, and of the models.
pub fn pairs(folder: &Path) -> Result<Vec<Point>, Fault> {
    let table = Table::read(folder, "two_sphere_force")?;
    let mut arrangements = Vec::new();
    for row in table.rows() {
        let (mu, s) = (row.number("mu_r")?, row.number("s")?);
        if !(2.01..=3.0).contains(&s) {
            continue;
        }
        for (name, field, column) in [("along", Vec3::z(), "F_par"), ("across", Vec3::x(), "F_perp")] {
            arrangements.push(Arrangement {
                case: format!("mu_r {mu}, gap {}, {name}", row.text("gap_over_a")?),
                permeability: mu,
                x: [Vec3::zeros(), Vec3::z() * (s * RADIUS)].into_iter().collect(),
                field,
                force: vec![(1, Vec3::z() * row.number(column)?)],
            });
        }
    }
    points(&arrangements)
}

/// The straight chains of `bead_chain_tension` in the reference `folder`; the force is that on the end bead.
///
/// # Errors
/// Of the table, and of the models.
pub fn chains(folder: &Path) -> Result<Vec<Point>, Fault> {
    let table = Table::read(folder, "bead_chain_tension")?;
    let chain = |row: &Row| -> Result<Arrangement, Fault> {
        let (mu, gap, n) = (
            row.number("mu_r")?,
            row.number("gap_over_a")?,
            row.number("N")? as usize,
        );
        Ok(Arrangement {
            case: format!("mu_r {mu}, gap {gap}, N {n}"),
            permeability: mu,
            x: (0..n).map(|k| Vec3::z() * (k as f64 * (2.0 + gap) * RADIUS)).collect(),
            field: Vec3::z(),
            force: vec![(n - 1, Vec3::z() * -row.number("tension_end")?)],
        })
    };
    points(&table.rows().iter().map(chain).collect::<Result<Vec<_>, Fault>>()?)
}

/// The clusters of `bead_cluster_force` in the reference `folder`.
///
/// # Errors
/// Of the table, and of the models.
pub fn clusters(folder: &Path) -> Result<Vec<Point>, Fault> {
    let table = Table::read(folder, "bead_cluster_force")?;
    let mut arrangements: Vec<Arrangement> = Vec::new();
    for row in table.rows() {
        let case = format!("{}, mu_r {}", row.text("config")?, row.text("mu_r")?);
        if !arrangements.iter().any(|a| a.case == case) {
            arrangements.push(Arrangement {
                case: case.clone(),
                permeability: row.number("mu_r")?,
                x: Soa3::default(),
                field: Vec3::z(),
                force: Vec::new(),
            });
        }
        let vector = |columns: [&str; 3]| -> Result<Vec3, Fault> {
            let [x, y, z] = columns.map(|c| row.number(c));
            Ok(Vec3::new(x?, y?, z?))
        };
        if let Some(of) = arrangements.iter_mut().find(|a| a.case == case) {
            of.x.push(vector(["x", "y", "z"])? * RADIUS);
            of.force.push((of.force.len(), vector(["Fx", "Fy", "Fz"])?));
        }
    }
    points(&arrangements)
}

/// All models and the orders of their multipoles.
fn rungs() -> Vec<(usize, Box<dyn Model>)> {
    let mut rungs: Vec<(usize, Box<dyn Model>)> = vec![
        (1, Box::new(FixedDipoles::new())),
        (1, Box::new(MutualDipoles::new())),
        (1, Box::new(PairCorrected::new())),
    ];
    for order in ORDERS {
        rungs.push((order, Box::new(Auto::new().with_order(order))));
        rungs.push((order, Box::new(Multipoles::new(order))));
    }
    rungs
}

fn points(arrangements: &[Arrangement]) -> Result<Vec<Point>, Fault> {
    let mut points = Vec::new();
    // Models outlive the arrangements, which share their tables.
    let mut rungs = rungs();
    for of in arrangements {
        let chi = Intrinsic::new(of.permeability - 1.0)?;
        let beads = vec![Bead::new(RADIUS, 1500.0, chi)?; of.x.len()];
        let source = Uniform::new(of.field * FIELD);
        let problem = Problem::new(&beads, of.x.view(), &source, 0.0)?;
        for (order, model) in &mut rungs {
            points.push(point(of, &problem, *order, &mut **model)?);
        }
    }
    Ok(points)
}

fn point(of: &Arrangement, problem: &Problem<'_>, order: usize, model: &mut dyn Model) -> Result<Point, Fault> {
    let mut out = Solution::new();
    model.solve(problem, &mut out)?;
    let mut seconds = f64::INFINITY;
    for _ in 0..REPEATS {
        let clock = Instant::now();
        model.solve(problem, &mut out)?;
        seconds = seconds.min(clock.elapsed().as_secs_f64());
    }
    let largest = of.force.iter().map(|(_, f)| f.norm()).fold(0.0, f64::max);
    let off = |(i, f): &(usize, Vec3)| (out.force.get(*i) / FORCE - f).norm() / largest;
    Ok(Point {
        case: of.case.clone(),
        rung: model.name(),
        order,
        unknowns: order * (order + 2),
        seconds,
        error: of.force.iter().map(off).fold(0.0, f64::max),
        reported: out.error.force / FORCE / largest,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_have_every_rung_and_the_reported_error_covers_the_true_one() {
        let points = clusters(&Table::own_folder()).unwrap();
        assert!(!points.is_empty() && points.len().is_multiple_of(rungs().len()));
        for point in &points {
            assert!(point.seconds > 0.0 && point.error < point.reported + 1e-10, "{point:?}");
        }
        let worst = |rung: &str, order: usize| {
            let of = points.iter().filter(|p| p.rung == rung && p.order == order);
            of.map(|p| p.error).fold(0.0, f64::max)
        };
        assert!(worst("near multipoles", 16) < 1e-4 && worst("fixed dipoles", 1) > 0.3);
    }
}
