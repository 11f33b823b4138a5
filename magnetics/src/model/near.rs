//! Pairs of beads that are close, and what dipoles do to each other.

use super::Problem;
use crate::MU0;
use crate::error::MagneticsError;
use crate::kernel::{self, Overlap, Want};
use crate::tree::{DipoleSums, Summation, TreeReport};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{CellList, Domain, Soa3, Soa3Ref, Vec3};

/// mu0/(4 pi).
pub(super) const FACTOR: f64 = MU0 / (4.0 * std::f64::consts::PI);

/// Two beads, `r` from j to i.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub i: usize,
    pub j: usize,
    pub r: Vec3,
    pub distance: f64,
}

/// All pairs closer than `reach` (m), in a fixed order.
pub(super) fn pairs(problem: &Problem<'_>, reach: f64) -> Vec<Pair> {
    let x = problem.positions;
    let mut out = Vec::new();
    if x.len() < 2 {
        return out;
    }
    let mut cells = CellList::new();
    cells.build(x, &Domain::unbounded(), reach);
    cells.for_each_pair(|i, j| {
        let r = x.get(i) - x.get(j);
        let distance = r.norm();
        if distance < reach {
            out.push(Pair { i, j, r, distance });
        }
    });
    out
}

/// The operator of all dipoles on each other, and the source's field on them.
pub(super) struct Interaction<'a> {
    problem: Problem<'a>,
    near: Vec<Pair>,
    sums: DipoleSums,
    /// What a tree did in the last forces.
    pub report: Option<TreeReport>,
    /// The source's field, T.
    pub field: Soa3,
    /// The source's gradient, T/m.
    pub gradient: Vec<Matrix3<f64>>,
}

impl<'a> Interaction<'a> {
    /// With direct sums.
    pub fn new(problem: &Problem<'a>) -> Result<Self, MagneticsError> {
        Self::summed(problem, &Summation::Direct)
    }

    /// With sums as they are asked for.
    pub fn summed(problem: &Problem<'a>, how: &Summation) -> Result<Self, MagneticsError> {
        // Beyond contact: equal beads that touch are all within, whichever way their distance rounds. At the distance itself a
        // pair would be counted twice or not at all.
        let near_distance = 2.001 * problem.largest_radius();
        let mut field = Soa3::default();
        let mut gradient = Vec::new();
        let (x, t) = (problem.positions, problem.time);
        problem.source.fields_and_gradients(x, t, &mut field, &mut gradient);
        let finite = |i: usize| field.get(i).iter().chain(gradient[i].iter()).all(|v| v.is_finite());
        if let Some(bead) = (0..x.len()).find(|i| !finite(*i)) {
            return Err(MagneticsError::NotFinite { what: "field", bead });
        }
        Ok(Self {
            problem: *problem,
            near: pairs(problem, near_distance),
            sums: DipoleSums::new(x, None, near_distance, how.tree(x.len())),
            report: None,
            field,
            gradient,
        })
    }

    fn overlap(&self, pair: &Pair) -> Overlap {
        let radius = |i: usize| self.problem.beads[i].radius();
        Overlap::balls(radius(pair.i), radius(pair.j), pair.distance)
    }

    /// Field (T) of all moments `m` (A m2) at each other bead.
    pub fn induced_field(&mut self, m: Soa3Ref<'_>, out: &mut Soa3) {
        self.sums.sums(m, m, Want::Field, out, &mut Soa3::default());
        self.add_near_field(m, out);
        scale(out, FACTOR);
    }

    /// Field (T) and force (N) of the moments `m` (A m2) on each other.
    pub fn field_and_force(&mut self, m: Soa3Ref<'_>, field: &mut Soa3, force: &mut Soa3) {
        self.sums.sums(m, m, Want::Both, field, force);
        self.report = self.sums.report(&[[m, m]], force);
        self.add_near_field(m, field);
        self.add_near_force(m, m, force);
        scale(field, FACTOR);
        scale(force, FACTOR);
    }

    /// Force (N) of the moments `m` (A m2) on each other.
    pub fn force(&mut self, m: Soa3Ref<'_>, force: &mut Soa3) {
        self.sums.sums(m, m, Want::Force, &mut Soa3::default(), force);
        self.report = self.sums.report(&[[m, m]], force);
        self.add_near_force(m, m, force);
        scale(force, FACTOR);
    }

    /// Force (N) of the moments `by` on the moments `on` (A m2).
    pub fn force_by(&mut self, on: Soa3Ref<'_>, by: Soa3Ref<'_>, force: &mut Soa3) {
        self.sums.sums(on, by, Want::Force, &mut Soa3::default(), force);
        self.add_near_force(on, by, force);
        scale(force, FACTOR);
    }

    /// Force (N) of the moments `m` (A m2) on each other and, to first order, what changes with them by `change`: that of m
    /// and the change on m, and of m on the change.
    pub fn force_with_change(&mut self, m: Soa3Ref<'_>, change: Soa3Ref<'_>, force: &mut Soa3) {
        let all: Soa3 = m.iter().zip(change.iter()).map(|(m, c)| m + c).collect();
        self.sums.force_with_change(m, change, all.view(), force);
        self.report = self.sums.report(&[[m, all.view()], [change, m]], force);
        self.add_near_force(m, all.view(), force);
        self.add_near_force(change, m, force);
        scale(force, FACTOR);
    }

    fn add_near_field(&self, m: Soa3Ref<'_>, out: &mut Soa3) {
        for pair in &self.near {
            let balls = self.overlap(pair);
            out.add(pair.i, balls.field(m.get(pair.j), pair.r));
            out.add(pair.j, balls.field(m.get(pair.i), pair.r));
        }
    }

    fn add_near_force(&self, on: Soa3Ref<'_>, by: Soa3Ref<'_>, force: &mut Soa3) {
        for pair in &self.near {
            let balls = self.overlap(pair);
            let (i, j) = (pair.i, pair.j);
            force.add(i, balls.force(on.get(i), by.get(j), pair.r));
            force.add(j, balls.force(on.get(j), by.get(i), -pair.r));
        }
    }

    /// Adds the source's force (grad B)^T m to `force`.
    pub fn add_source_force(&self, m: Soa3Ref<'_>, force: &mut Soa3) {
        for i in 0..m.len() {
            force.add(i, self.gradient[i].tr_mul(&m.get(i)));
        }
    }

    /// The beads' centres, m.
    pub fn positions(&self) -> Soa3Ref<'a> {
        self.problem.positions
    }

    /// Force (N) of the moments `m` on each other, pairs within `near` (m) left out.
    pub fn force_at(&mut self, m: &Soa3, near: f64, out: &mut Soa3) {
        let sources = self.sums.sources(m.view());
        let x = self.problem.positions;
        kernel::sums(sources, x, m.view(), near, Want::Force, &mut Soa3::default(), out);
        scale(out, FACTOR);
    }

    /// Field (T) of the moments `m` at other points than the beads, those within `near` (m) left out.
    pub fn field_at(&mut self, points: Soa3Ref<'_>, m: Soa3Ref<'_>, near: f64, out: &mut Soa3) {
        let sources = self.sums.sources(m);
        kernel::sums(sources, points, points, near, Want::Field, out, &mut Soa3::default());
        scale(out, FACTOR);
    }
}

/// Greatest error (N) of any bead's force that a tree may bring: some times the rms of its error.
pub(super) fn error_of_tree(report: Option<TreeReport>, force: &Soa3) -> f64 {
    const LARGEST: f64 = 5.0;
    let squares: f64 = force.iter().map(|f| f.norm_squared()).sum();
    report.map_or(0.0, |r| {
        LARGEST * r.rms_error * (squares / force.len().max(1) as f64).sqrt()
    })
}

pub(super) fn scale(v: &mut Soa3, factor: f64) {
    for component in [&mut v.x, &mut v.y, &mut v.z] {
        component.iter_mut().for_each(|c| *c *= factor);
    }
}
