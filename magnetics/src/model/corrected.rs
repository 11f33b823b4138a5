//! Mutual dipoles and, for near pairs, what the exact solution of two spheres has beyond them.

mod midpoints;
mod quadrupoles;

use super::mutual::finish;
use super::near::{Interaction, error_of_tree, pairs};
use super::operator::norm;
use super::tables::{Tables, force_size};
use super::{Model, MutualDipoles, Problem, Solution};
use crate::MU0;
use crate::error::MagneticsError;
use crate::tree::{Tree, TreeReport};
use crate::two_sphere::Fineness;
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Vec3};
use midpoints::Midpoints;
use quadrupoles::add_cross_terms;

/// The default rung: mutual dipoles plus the exact two-sphere correction.
///
/// Each pair nearer than the reach adds E = -(D_par (B.n)^2 + D_perp |B x n|^2)/(2 mu0), with D exact less mutual-dipole
/// moment of the lone pair ([`TwoSpheres`](crate::TwoSpheres), tabulated when a kind of pair is first met) and B the field
/// of source and other dipoles at the pair's midpoint. Forces are the full gradient: the pair force, the force on the
/// pair's extra moment in B, and what it does to the dipoles (one adjoint solve). The gradients of two neighbours at a third
/// bead, which cancel inside a chain, are taken together to the order of its quadrupole. Good for pairs and open chains; where
/// contacts close a triangle the error grows to tens of per cent, and says so: use
/// [`Multipoles`](crate::Multipoles) there.
#[derive(Clone, Debug)]
pub struct PairCorrected {
    dipoles: MutualDipoles,
    tables: Tables,
    reach: f64,
    adjoint: Soa3,
    report: Option<TreeReport>,
}

/// A pair with its extra moment.
#[derive(Clone, Copy, Debug)]
struct Extra {
    i: usize,
    j: usize,
    r: Vec3,
    distance: f64,
    table: usize,
    /// Part of the extra moment that is bead i's.
    share: f64,
    moment: Vec3,
}

impl Default for PairCorrected {
    fn default() -> Self {
        Self::new()
    }
}

impl PairCorrected {
    /// Pairs with a gap below 2 mean radii are corrected, the last quarter fading.
    pub fn new() -> Self {
        Self {
            dipoles: MutualDipoles::new(),
            tables: Tables::new(Fineness::FORCE, 2.0),
            reach: 2.0,
            adjoint: Soa3::default(),
            report: None,
        }
    }

    /// Another reach of the correction: greatest gap in mean radii. Cost grows with the pairs inside it.
    pub fn with_reach(mut self, reach: f64) -> Self {
        self.reach = reach;
        self.tables = Tables::new(Fineness::FORCE, reach);
        self
    }

    /// Another relative residual of the mutual dipoles.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.dipoles = self.dipoles.with_tolerance(tolerance);
        self
    }

    /// Sums by this tree, for any number of beads. Without it sums are direct up to 20 000 beads, and by
    /// [`Tree::new`] above.
    pub fn with_tree(mut self, tree: Tree) -> Self {
        self.dipoles = self.dipoles.with_tree(tree);
        self
    }

    /// Sums directly, for any number of beads.
    pub fn with_direct_sums(mut self) -> Self {
        self.dipoles = self.dipoles.with_direct_sums();
        self
    }

    /// What a tree did in the last solution; none if the sums were direct.
    pub fn tree_report(&self) -> Option<TreeReport> {
        self.report
    }

    fn near_pairs(&mut self, problem: &Problem<'_>) -> Result<Vec<Extra>, MagneticsError> {
        let reach = 2.0 * problem.largest_radius() + self.tables.reach_of(problem);
        let mut extras = Vec::new();
        for pair in pairs(problem, reach) {
            let (a, b) = (&problem.beads[pair.i], &problem.beads[pair.j]);
            let touching = a.radius() + b.radius();
            if pair.distance >= touching + self.reach * 0.5 * touching {
                continue;
            }
            if let Some((table, swapped)) = self.tables.of(a, b)? {
                let share = self.tables.get(table).share();
                extras.push(Extra {
                    i: pair.i,
                    j: pair.j,
                    r: pair.r,
                    distance: pair.distance,
                    table,
                    share: if swapped { 1.0 - share } else { share },
                    moment: Vec3::zeros(),
                });
            }
        }
        Ok(extras)
    }

    /// Adds the pairs' energy and direct forces, sets their extra moments, and returns the estimated error per bead.
    fn correct(&self, extras: &mut [Extra], field: &Soa3, out: &mut Solution, problem: &Problem<'_>) -> Vec<f64> {
        let closed = closed_contacts(problem.beads.len(), extras, problem);
        let mut off = vec![0.0; problem.beads.len()];
        for (k, pair) in extras.iter_mut().enumerate() {
            let d = self.tables.get(pair.table).correction(pair.distance);
            let (b, n) = (field.get(k), pair.r / pair.distance);
            let along = b.dot(&n);
            let across = b - n * along;
            out.energy -= 0.5 / MU0 * (d.par * along * along + d.perp * across.norm_squared());
            let radial = 0.5 * (d.par_slope * along * along + d.perp_slope * across.norm_squared());
            let force = (n * radial + across * ((d.par - d.perp) * along / pair.distance)) / MU0;
            out.force.add(pair.i, force);
            out.force.add(pair.j, -force);
            pair.moment = (n * (d.par * along) + across * d.perp) / MU0;
            let doubt = if closed[k] { 0.7 } else { 0.2 };
            let near = super::near::Pair {
                i: pair.i,
                j: pair.j,
                r: pair.r,
                distance: pair.distance,
            };
            let lone = force_size(&d, &near, b);
            off[pair.i] += doubt * lone;
            off[pair.j] += doubt * lone;
        }
        off
    }
}

/// Which of the pairs have a third bead near both: gaps below 0.6 mean radii.
fn closed_contacts(n: usize, extras: &[Extra], problem: &Problem<'_>) -> Vec<bool> {
    let tight = |p: &Extra| p.distance < 1.3 * (problem.beads[p.i].radius() + problem.beads[p.j].radius());
    let mut neighbours = vec![Vec::new(); n];
    for pair in extras.iter().filter(|p| tight(p)) {
        neighbours[pair.i].push(pair.j);
        neighbours[pair.j].push(pair.i);
    }
    extras
        .iter()
        .map(|p| neighbours[p.i].iter().any(|k| *k != p.j && neighbours[p.j].contains(k)))
        .collect()
}

impl Model for PairCorrected {
    fn name(&self) -> &'static str {
        "mutual dipoles with pair correction"
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let n = problem.beads.len();
        if let Some(bead) = (0..n).find(|i| problem.beads[*i].permeability().is_none()) {
            return Err(MagneticsError::NotLinear {
                model: self.name(),
                bead,
            });
        }
        let mut dipoles = Interaction::summed(problem, &self.dipoles.summation())?;
        out.resize(n);
        out.error = self.dipoles.magnetise(problem, &mut dipoles, &mut out.moment)?;
        out.force.fill(0.0);
        finish(problem, &dipoles, self.dipoles.local_field(), out);
        let mut extras = self.near_pairs(problem)?;
        let mut force = Soa3::default();
        let mut off = vec![0.0; n];
        if !extras.is_empty() {
            let mut midpoints = Midpoints::new(problem, &extras, self.dipoles.summation());
            let gradient: Vec<Matrix3<f64>> = midpoints.source_gradient();
            let field = midpoints.field(problem, &extras, &out.moment);
            off = self.correct(&mut extras, &field, out, problem);
            // The extra moments in the field at the midpoints, shared by both beads; what they do to the dipoles.
            let mut back = Soa3::default();
            let pull = midpoints.forces(problem, &extras, &out.moment, &mut back, &mut out.force);
            for (k, pair) in extras.iter().enumerate() {
                let half = 0.5 * (pull.get(k) + gradient[k].tr_mul(&pair.moment));
                out.force.add(pair.i, half);
                out.force.add(pair.j, half);
            }
            let (tables, m) = (&self.tables, &out.moment);
            out.energy += add_cross_terms(problem, &extras, tables, m, &mut back, &mut out.force);
            // What the extra moments induce, and the forces of that.
            let (induced, iterations) = self.dipoles.respond(problem, &mut dipoles, &back, &mut self.adjoint);
            out.error.iterations += iterations;
            let remanent: Soa3 = problem.beads.iter().map(|b| b.response(Vec3::zeros()).moment).collect();
            if norm(&remanent) > 0.0 {
                let mut field = Soa3::default();
                dipoles.induced_field(induced.view(), &mut field);
                for i in 0..n {
                    out.torque.add(i, remanent.get(i).cross(&(field.get(i) + back.get(i))));
                }
            }
            dipoles.force_with_change(out.moment.view(), induced.view(), &mut force);
            for i in 0..n {
                out.moment.add(i, induced.get(i));
            }
            dipoles.add_source_force(induced.view(), &mut out.force);
            for pair in &extras {
                out.moment.add(pair.i, pair.moment * pair.share);
                out.moment.add(pair.j, pair.moment * (1.0 - pair.share));
            }
        } else {
            dipoles.force(out.moment.view(), &mut force);
        }
        force.iter().enumerate().for_each(|(i, f)| out.force.add(i, f));
        self.report = dipoles.report;
        let far = self.reach + 2.0;
        let tail = |mu: f64| 50.0 * (mu - 1.0).abs() / (2.0 * mu + 3.0) / far.powi(5);
        out.error.force = (0..n)
            .map(|i| off[i] + tail(problem.beads[i].initial_permeability()) * out.force.get(i).norm())
            .fold(out.error.residual * norm(&out.force), f64::max)
            + error_of_tree(self.report, &force);
        Ok(())
    }
}
