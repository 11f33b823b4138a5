//! Straight chains and packed clusters of equal beads.

use super::{FIELD, FORCE, MOMENT, RADIUS, bead, covers, orders_at, solve, vector};
use crate::Fault;
use crate::reference::{Row, Table};
use crate::scenes::side_by_side;
use crate::validate::{Effort, Findings, Outcome};
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{
    Auto, Bead, FixedDipoles, Model, Multipoles, MutualDipoles, PairCorrected, Solution, Uniform,
};
use std::f64::consts::PI;
use std::time::Instant;

/// Tensions and moments of a straight chain, in units of the table.
struct Chain {
    mid: f64,
    end: f64,
    m_mid: f64,
    m_end: f64,
    estimate: f64,
}

impl Chain {
    fn of(model: &mut dyn Model, permeability: f64, gap: f64, n: usize) -> Result<Self, Fault> {
        let x: Soa3 = (0..n).map(|k| Vec3::z() * (k as f64 * (2.0 + gap) * RADIUS)).collect();
        let beads = vec![bead(1.0, permeability)?; n];
        let out = solve(model, &beads, &x, &Uniform::new(Vec3::z() * FIELD))?;
        let pull = |i: usize| -out.force.get(i).z / FORCE;
        Ok(Self {
            mid: (n.div_ceil(2)..n).map(pull).sum(),
            end: pull(n - 1),
            m_mid: out.moment.get(n / 2).z / MOMENT,
            m_end: out.moment.get(n - 1).z / MOMENT,
            estimate: out.error.force / FORCE,
        })
    }
}

/// What the rungs find for a row: fixed, mutual, corrected, multipoles where not too slow.
type Rungs = (Chain, Chain, Chain, Option<Chain>);

/// Dipoles to 1e-8 of their own columns. With the pair correction, tensions and moments within 5 % to mu_r 4; beyond, and for
/// every rung, the error of the force on the end bead is covered by the reported one.
pub fn bead_chain_tension(table: &Table, effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    // Rows of one permeability share models, which keep their tables.
    let mut kinds: Vec<(f64, Vec<usize>)> = Vec::new();
    for (k, row) in table.rows().iter().enumerate() {
        let mu = row.number("mu_r")?;
        match kinds.iter_mut().find(|(of, _)| *of == mu) {
            Some((_, rows)) => rows.push(k),
            None => kinds.push((mu, vec![k])),
        }
    }
    let computed = side_by_side(&kinds, |(mu, rows)| -> Result<Vec<(Rungs, f64)>, Fault> {
        let mut fixed = FixedDipoles::new();
        let mut mutual = MutualDipoles::new().with_tolerance(1e-12);
        let mut corrected = PairCorrected::new();
        let one = |k: &usize| -> Result<(Rungs, f64), Fault> {
            let (clock, row) = (Instant::now(), &table.rows()[*k]);
            let (gap, n) = (row.number("gap_over_a")?, row.number("N")? as usize);
            let of = |model: &mut dyn Model| Chain::of(model, *mu, gap, n);
            let many = if effort.quick { 3 } else { 20 };
            let order = orders_at(2.0 + gap, if effort.quick { 20 } else { 40 });
            let multipoles = (n <= many).then(|| of(&mut Multipoles::new(order)));
            let found = (
                of(&mut fixed)?,
                of(&mut mutual)?,
                of(&mut corrected)?,
                multipoles.transpose()?,
            );
            Ok((found, clock.elapsed().as_secs_f64()))
        };
        rows.iter().map(one).collect()
    })?;
    let places = kinds.iter().flat_map(|(_, rows)| rows);
    let mut found: Vec<_> = places.zip(computed.into_iter().flat_map(|(of, _)| of)).collect();
    found.sort_by_key(|(k, _)| **k);
    for (k, ((fixed, mutual, corrected, multipoles), seconds)) in found {
        let row = &table.rows()[*k];
        findings.begin_done(row.key(&["mu_r", "gap_over_a", "N"]), seconds);
        for (quantity, value, column) in [
            ("fixed dipoles, mid", fixed.mid, "tension_mid_FD"),
            ("fixed dipoles, end", fixed.end, "tension_end_FD"),
            ("mutual dipoles, mid", mutual.mid, "tension_mid_MD"),
            ("mutual dipoles, end", mutual.end, "tension_end_MD"),
            ("mutual dipoles, m mid", mutual.m_mid, "m_mid_MD"),
        ] {
            findings.check(quantity, value, row.number(column)?, 1e-8);
        }
        let open = row.number("mu_r")? <= 4.0;
        for (quantity, value, column) in [
            ("pair correction, mid", corrected.mid, "tension_mid"),
            ("pair correction, end", corrected.end, "tension_end"),
            ("pair correction, m mid", corrected.m_mid, "m_mid"),
            ("pair correction, m end", corrected.m_end, "m_end"),
        ] {
            let reference = row.number(column)?;
            match open {
                true => findings.check(quantity, value, reference, 0.05),
                false => findings.report(quantity, value, reference, reference.abs()),
            }
        }
        let end = row.number("tension_end")?;
        for (quantity, chain) in [
            ("fixed dipoles, end in its estimate", Some(&fixed)),
            ("mutual dipoles, end in its estimate", Some(&mutual)),
            ("pair correction, end in its estimate", Some(&corrected)),
            ("multipoles, end in its estimate", multipoles.as_ref()),
        ] {
            if let Some(chain) = chain {
                // The reference has ten digits and its own error.
                let reported = chain.estimate + end.abs() * (1e-9 + row.number("conv")?);
                covers(&mut findings, quantity, (chain.end - end).abs(), reported);
            }
        }
    }
    Ok(findings)
}

/// The beads of one arrangement and permeability.
struct Cluster<'a> {
    rows: Vec<&'a Row>,
    x: Soa3,
    beads: Vec<Bead>,
    largest: f64,
    closest: f64,
}

impl<'a> Cluster<'a> {
    /// The clusters of a table: rows of the same configuration and permeability.
    fn all(table: &'a Table) -> Result<Vec<Self>, Fault> {
        let mut groups: Vec<((&str, &str), Vec<&Row>)> = Vec::new();
        for row in table.rows() {
            let key = (row.text("config")?, row.text("mu_r")?);
            match groups.iter_mut().find(|(k, _)| *k == key) {
                Some((_, rows)) => rows.push(row),
                None => groups.push((key, vec![row])),
            }
        }
        groups.into_iter().map(|(_, rows)| Self::new(rows)).collect()
    }

    fn new(rows: Vec<&'a Row>) -> Result<Self, Fault> {
        let mut x = Soa3::default();
        let mut largest: f64 = 0.0;
        for row in &rows {
            x.push(vector(row, ["x", "y", "z"])? * RADIUS);
            largest = largest.max(vector(row, ["Fx", "Fy", "Fz"])?.norm());
        }
        let mut closest = f64::INFINITY;
        for i in 0..x.len() {
            for j in 0..i {
                closest = closest.min((x.get(i) - x.get(j)).norm() / RADIUS);
            }
        }
        let beads = vec![bead(1.0, rows[0].number("mu_r")?)?; rows.len()];
        Ok(Self {
            rows,
            x,
            beads,
            largest,
            closest,
        })
    }

    fn solve(&self, model: &mut dyn Model) -> Result<Solution, Fault> {
        solve(model, &self.beads, &self.x, &Uniform::new(Vec3::z() * FIELD))
    }

    /// Greatest error of a force against three columns, in units of the table.
    fn off(&self, out: &Solution, columns: [&str; 3]) -> Result<f64, Fault> {
        let mut off: f64 = 0.0;
        for (i, row) in self.rows.iter().enumerate() {
            off = off.max((out.force.get(i) / FORCE - vector(row, columns)?).norm());
        }
        Ok(off)
    }
}

/// Multipoles to 1e-4 of the cluster's greatest force and moment at the default order and to 1e-7 at a high one, torques with
/// them; mutual dipoles to 1e-9 of their own columns; the error that any rung reports covers the true one.
pub fn bead_cluster_force(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    let clusters = Cluster::all(table)?;
    let computed = side_by_side(&clusters, |cluster| -> Result<[Solution; 6], Fault> {
        let high = orders_at(cluster.closest, 40).max(26);
        Ok([
            cluster.solve(&mut Multipoles::default())?,
            cluster.solve(&mut Multipoles::new(high).with_tolerance(1e-12))?,
            cluster.solve(&mut MutualDipoles::new().with_tolerance(1e-12))?,
            cluster.solve(&mut FixedDipoles::new())?,
            cluster.solve(&mut PairCorrected::new())?,
            cluster.solve(&mut Auto::new())?,
        ])
    })?;
    for (cluster, ([default, high, mutual, fixed, corrected, auto], seconds)) in clusters.iter().zip(computed) {
        findings.begin_done(cluster.rows[0].key(&["config", "mu_r"]), seconds);
        let (exact, dipoles) = (["Fx", "Fy", "Fz"], ["Fx_MD", "Fy_MD", "Fz_MD"]);
        let scale = cluster.largest;
        for (name, out, gate) in [("default order", &default, 1e-4), ("high order", &high, 1e-7)] {
            let quantity = |what: &str| format!("multipoles, {name}, {what}");
            findings.check_scaled(&quantity("force"), cluster.off(out, exact)?, 0.0, scale, gate);
            check_moments(&mut findings, cluster, out, &quantity, gate)?;
        }
        let off = cluster.off(&mutual, dipoles)?;
        findings.check_scaled("mutual dipoles, force", off, 0.0, scale, 1e-9);
        findings.report("automatic, force", cluster.off(&auto, exact)?, 0.0, scale);
        let off = cluster.off(&corrected, ["Fx_PC", "Fy_PC", "Fz_PC"])?;
        findings.report("pair correction, from the table's other form", off, 0.0, scale);
        for (quantity, out) in [
            ("multipoles, error in its estimate", &default),
            ("multipoles, high order, in its estimate", &high),
            ("automatic, error in its estimate", &auto),
            ("pair correction, error in its estimate", &corrected),
            ("mutual dipoles, error in its estimate", &mutual),
            ("fixed dipoles, error in its estimate", &fixed),
        ] {
            // The reference has thirteen digits and its own error.
            let reported = out.error.force / FORCE + scale * (1e-12 + cluster.rows[0].number("err")?);
            covers(&mut findings, quantity, cluster.off(out, exact)?, reported);
        }
    }
    Ok(findings)
}

/// Moments, each bead's own torque (none), and the torque on the cluster.
fn check_moments(
    findings: &mut Findings,
    cluster: &Cluster<'_>,
    out: &Solution,
    quantity: &dyn Fn(&str) -> String,
    gate: f64,
) -> Result<(), Fault> {
    let n = cluster.rows.len();
    let (mut off, mut largest, mut own) = (0.0f64, 0.0f64, 0.0f64);
    for (i, row) in cluster.rows.iter().enumerate() {
        let m = vector(row, ["mx", "my", "mz"])?;
        off = off.max((out.moment.get(i) / MOMENT - m).norm());
        largest = largest.max(m.norm());
        own = own.max((out.torque.get(i) / (FORCE * RADIUS) - vector(row, ["Tx", "Ty", "Tz"])?).norm());
    }
    findings.check_scaled(&quantity("moment"), off, 0.0, largest, gate);
    findings.check_scaled(&quantity("own torque"), own, 0.0, 4.0 * PI * largest, 1e-12);
    let centre = cluster.x.iter().sum::<Vec3>() / n as f64;
    let arm = cluster.x.iter().map(|x| (x - centre).norm()).fold(0.0, f64::max) / RADIUS;
    let torque: Vec3 = (0..n)
        .map(|i| (cluster.x.get(i) - centre).cross(&out.force.get(i)) / (FORCE * RADIUS))
        .sum();
    let expected = vector(cluster.rows[0], ["Tcx", "Tcy", "Tcz"])?;
    let error = (torque - expected).norm();
    findings.check_scaled(&quantity("torque of all"), error, 0.0, cluster.largest * arm, gate);
    Ok(())
}
