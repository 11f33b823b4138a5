//! Mutual dipoles and, for near pairs, what the exact solution of two spheres has beyond them.

mod midpoints;
mod quadrupoles;

use super::multipole::coupling::relative_slope;
use super::mutual::finish;
use super::near::{Interaction, error_of_tree, pairs};
use super::operator::norm;
use super::state::{restore_list, save_list};
use super::strength::{Strengths, add_field};
use super::tables::{Tables, force_size};
use super::{Model, MutualDipoles, Problem, Solution};
use crate::MU0;
use crate::error::MagneticsError;
use crate::tree::{Summation, Tree, TreeReport};
use crate::two_sphere::{Fineness, Moments, Truncated};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, StateError, StateReader, StateWriter, Vec3};
use midpoints::Midpoints;
use quadrupoles::add_cross_terms;

/// Mutual dipoles plus the exact two-sphere correction.
///
/// Each pair nearer than the reach adds E = -(D_par (B.n)^2 + D_perp |B x n|^2)/(2 mu0), with D exact less mutual-dipole
/// moment of the lone pair ([`TwoSpheres`](crate::TwoSpheres), tabulated when a kind of pair is first met) and B the field
/// of source and other dipoles at the pair's midpoint. Forces are the full gradient: the pair force, the force on the
/// pair's extra moment in B, and what it does to the dipoles (one adjoint solve). The gradients of two neighbours at a third
/// bead, which cancel inside a chain, are taken together to the order of its quadrupole. Beads that saturate are dipoles of their
/// own law, and the correction is taken at their secant permeability in the local field, the mean of both; that is in the
/// gradient too. Good for pairs and open chains; where
/// contacts close a triangle the error grows to tens of per cent, and says so: use [`Auto`](crate::Auto) or
/// [`Multipoles`](crate::Multipoles) there.
#[derive(Clone, Debug)]
pub struct PairCorrected {
    dipoles: MutualDipoles,
    pub(super) tables: Tables,
    pub(super) reach: f64,
    adjoint: Soa3,
    report: Option<TreeReport>,
}

/// A pair with its extra moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extra {
    pub i: usize,
    pub j: usize,
    r: Vec3,
    pub distance: f64,
    /// What is added to the pair.
    pub d: Moments,
    /// The slope of that with the mean strength of both beads.
    d_strength: Moments,
    strength: f64,
    /// How much the pair counts in cross terms, and the slope of that.
    presence: (f64, f64),
    /// Weight of the correction towards the reach, and its slope.
    fade: (f64, f64),
    /// Part of the extra moment that is bead i's.
    share: f64,
    /// Field at the midpoint, T.
    field: Vec3,
    moment: Vec3,
}

impl Extra {
    /// Takes away what the multipoles of a pair have already, and turns their slopes with openness into those of that.
    pub fn subtract(&mut self, known: &mut Truncated) {
        let (w, dw) = self.fade;
        let b = known.beyond;
        self.d.par -= w * b.par;
        self.d.perp -= w * b.perp;
        self.d.par_slope -= w * b.par_slope + dw * b.par;
        self.d.perp_slope -= w * b.perp_slope + dw * b.perp;
        known.par_open = known.par_open.map(|v| w * v);
        known.perp_open = known.perp_open.map(|v| w * v);
    }

    /// Squares of the midpoint's field along and across the pair, over mu0: energies are -1/2 of these times moments (m3).
    pub fn field_squares(&self) -> [f64; 2] {
        let along = self.field.dot(&self.r) / self.distance;
        [along * along / MU0, (self.field.norm_squared() - along * along) / MU0]
    }
}

/// What the corrections leave to do.
pub(super) struct Applied {
    /// Field of the extra moments and of cross terms at the beads, T.
    pub back: Soa3,
    /// Estimated error of the force on each bead, N.
    pub off: Vec<f64>,
    /// Energy of each bead's cross terms, J, as if its share were one.
    pub cross: Vec<f64>,
    /// Slope of the energy with the strength of each bead, J.
    pub strength: Vec<f64>,
}

/// All pairs inside `reach` mean radii of gap, with what is exact less mutual dipoles.
pub(super) fn near_pairs(
    tables: &mut Tables,
    reach: f64,
    problem: &Problem<'_>,
    strengths: &Strengths,
) -> Result<Vec<Extra>, MagneticsError> {
    let farthest = 2.0 * problem.largest_radius() + tables.reach_of(problem);
    let mut extras = Vec::new();
    for pair in pairs(problem, farthest) {
        let (a, b) = (&problem.beads[pair.i], &problem.beads[pair.j]);
        let touching = a.radius() + b.radius();
        // Beads at one place have no line between them.
        if pair.distance == 0.0 || pair.distance >= touching + reach * 0.5 * touching {
            continue;
        }
        if let Some((index, swapped)) = tables.of(a, b)? {
            let strength = 0.5 * (strengths.value[pair.i] + strengths.value[pair.j]);
            let (d, d_strength) = if strength < 1.0 {
                tables.weakened(index, pair.distance, strength)?
            } else {
                (tables.get(index).correction(pair.distance), Moments::default())
            };
            let table = tables.get(index);
            extras.push(Extra {
                i: pair.i,
                j: pair.j,
                r: pair.r,
                distance: pair.distance,
                d,
                d_strength,
                strength,
                presence: table.presence(pair.distance),
                fade: if pair.distance > touching {
                    table.presence(pair.distance)
                } else {
                    (1.0, 0.0)
                },
                share: if swapped { 1.0 - table.share() } else { table.share() },
                field: Vec3::zeros(),
                moment: Vec3::zeros(),
            });
        }
    }
    Ok(extras)
}

/// Adds energy and forces of all corrections to those of the dipoles `out.moment`, but for what they do to the dipoles.
/// `open` is the share of each bead's cross terms.
pub(super) fn apply(
    problem: &Problem<'_>,
    extras: &mut [Extra],
    how: Summation,
    open: &[f64],
    strengths: &Strengths,
    out: &mut Solution,
) -> Applied {
    let mut midpoints = Midpoints::new(problem, extras, how);
    let gradient: Vec<Matrix3<f64>> = midpoints.source_gradient();
    let field = midpoints.field(problem, extras, &out.moment);
    let off = add_pairs(extras, &field, out, problem);
    // The extra moments in the field at the midpoints, shared by both beads; what they do to the dipoles.
    let mut back = Soa3::default();
    let pull = midpoints.forces(problem, extras, &out.moment, &mut back, &mut out.force);
    for (k, pair) in extras.iter().enumerate() {
        let half = 0.5 * (pull.get(k) + gradient[k].tr_mul(&pair.moment));
        out.force.add(pair.i, half);
        out.force.add(pair.j, half);
    }
    let (m, f) = (&out.moment, &mut out.force);
    let cross = add_cross_terms(problem, extras, open, &strengths.value, m, &mut back, f);
    out.energy += cross.iter().zip(open).map(|(e, open)| e * open).sum::<f64>();
    let mut strength = vec![0.0; open.len()];
    for pair in extras.iter() {
        let [along, across] = pair.field_squares();
        let slope = -0.25 * (along * pair.d_strength.par + across * pair.d_strength.perp);
        strength[pair.i] += slope;
        strength[pair.j] += slope;
    }
    for (i, slope) in strength.iter_mut().enumerate() {
        *slope += open[i] * cross[i] * relative_slope(&problem.beads[i], strengths.value[i], 2);
    }
    Applied {
        back,
        off,
        cross,
        strength,
    }
}

/// Gives both beads of each pair their shares of its extra moment.
pub(super) fn add_moments(extras: &[Extra], out: &mut Solution) {
    for pair in extras {
        out.moment.add(pair.i, pair.moment * pair.share);
        out.moment.add(pair.j, pair.moment * (1.0 - pair.share));
    }
}

/// Greatest error (N) of the force on a bead: what is known of near pairs, and the leading order of what lies beyond.
pub(super) fn greatest(off: &[f64], reach: f64, problem: &Problem<'_>, out: &Solution) -> f64 {
    let far = reach + 2.0;
    let tail = |mu: f64| 50.0 * (mu - 1.0).abs() / (2.0 * mu + 3.0) / far.powi(5);
    off.iter()
        .enumerate()
        .map(|(i, off)| off + tail(problem.beads[i].initial_permeability()) * out.force.get(i).norm())
        .fold(out.error.residual * norm(&out.force), f64::max)
}

/// Adds the pairs' energy and direct forces, sets their fields and extra moments, and returns the estimated error per bead.
fn add_pairs(extras: &mut [Extra], field: &Soa3, out: &mut Solution, problem: &Problem<'_>) -> Vec<f64> {
    let closed = closed_contacts(problem.beads.len(), extras, problem);
    let mut off = vec![0.0; problem.beads.len()];
    for (k, pair) in extras.iter_mut().enumerate() {
        let d = pair.d;
        let (b, n) = (field.get(k), pair.r / pair.distance);
        let along = b.dot(&n);
        let across = b - n * along;
        out.energy -= 0.5 / MU0 * (d.par * along * along + d.perp * across.norm_squared());
        let radial = 0.5 * (d.par_slope * along * along + d.perp_slope * across.norm_squared());
        let force = (n * radial + across * ((d.par - d.perp) * along / pair.distance)) / MU0;
        out.force.add(pair.i, force);
        out.force.add(pair.j, -force);
        pair.field = b;
        pair.moment = (n * (d.par * along) + across * d.perp) / MU0;
        // A secant permeability stands for a field inside that is not homogeneous.
        let doubt = if closed[k] { 0.7 } else { 0.2 } + 0.8 * (1.0 - pair.strength);
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

    fn save(&self, to: &mut StateWriter) {
        self.dipoles.save(to);
        save_list(&self.adjoint, to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.dipoles.restore(from)?;
        restore_list(&mut self.adjoint, from)
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let n = problem.beads.len();
        let mut dipoles = Interaction::summed(problem, &self.dipoles.summation())?;
        out.resize(n);
        out.error = self.dipoles.magnetise(problem, &mut dipoles, &mut out.moment)?;
        out.force.fill(0.0);
        finish(problem, &dipoles, self.dipoles.local_field(), out);
        let local: Soa3 = self.dipoles.local_field().iter().collect();
        let strengths = Strengths::of(problem, &local);
        let mut extras = near_pairs(&mut self.tables, self.reach, problem, &strengths)?;
        let mut off = vec![0.0; n];
        let mut force = Soa3::default();
        if extras.is_empty() {
            dipoles.force(out.moment.view(), &mut force);
        } else {
            let applied = apply(
                problem,
                &mut extras,
                self.dipoles.summation(),
                &vec![1.0; n],
                &strengths,
                out,
            );
            let mut back = applied.back;
            off = applied.off;
            let mut beyond = Soa3::zeros(n);
            if !strengths.is_linear() {
                beyond = strengths.moments(&applied.strength);
                add_field(&mut dipoles, &beyond, &mut back);
            }
            // What the extra moments induce, and the forces of that.
            let (induced, iterations) = self
                .dipoles
                .respond(problem, &mut dipoles, &local, &back, &mut self.adjoint);
            out.error.iterations += iterations;
            let remanent: Soa3 = problem.beads.iter().map(|b| b.response(Vec3::zeros()).moment).collect();
            if norm(&remanent) > 0.0 {
                let mut field = Soa3::default();
                dipoles.induced_field(induced.view(), &mut field);
                for i in 0..n {
                    out.torque.add(i, remanent.get(i).cross(&(field.get(i) + back.get(i))));
                }
            }
            let change: Soa3 = induced.iter().zip(beyond.iter()).map(|(a, b)| a + b).collect();
            dipoles.force_with_change(out.moment.view(), change.view(), &mut force);
            dipoles.add_source_force(change.view(), &mut out.force);
            for (i, more) in change.iter().enumerate() {
                out.moment.add(i, more);
            }
            add_moments(&extras, out);
        }
        force.iter().enumerate().for_each(|(i, f)| out.force.add(i, f));
        self.report = dipoles.report;
        out.error.force = greatest(&off, self.reach, problem, out) + error_of_tree(self.report, &force);
        Ok(())
    }
}
