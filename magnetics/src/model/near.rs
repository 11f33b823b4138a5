//! Pairs of beads that are close, and what dipoles do to each other.

use super::Problem;
use crate::MU0;
use crate::error::MagneticsError;
use crate::kernel::{self, Overlap, Sources, Want};
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
    near_distance: f64,
    sources: Sources,
    /// The source's field, T.
    pub field: Soa3,
    /// The source's gradient, T/m.
    pub gradient: Vec<Matrix3<f64>>,
}

impl<'a> Interaction<'a> {
    pub fn new(problem: &Problem<'a>) -> Result<Self, MagneticsError> {
        // Beyond contact: equal beads that touch are all within, whichever way their distance rounds. At the distance itself a
        // pair would be counted twice or not at all.
        let near_distance = 2.001 * problem.largest_radius();
        let mut sources = Sources::default();
        sources.set_positions(problem.positions);
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
            near_distance,
            sources,
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
        self.sources.set_moments(m);
        let x = self.problem.positions;
        let near = self.near_distance;
        kernel::sums(&self.sources, x, m, near, Want::Field, out, &mut Soa3::default());
        for pair in &self.near {
            let balls = self.overlap(pair);
            out.add(pair.i, balls.field(m.get(pair.j), pair.r));
            out.add(pair.j, balls.field(m.get(pair.i), pair.r));
        }
        scale(out, FACTOR);
    }

    /// Field (T) and force (N) of all moments `by` on each moment `on` (A m2).
    pub fn field_and_force(&mut self, on: Soa3Ref<'_>, by: Soa3Ref<'_>, field: &mut Soa3, force: &mut Soa3) {
        self.sources.set_moments(by);
        let x = self.problem.positions;
        let near = self.near_distance;
        kernel::sums(&self.sources, x, on, near, Want::Both, field, force);
        for pair in &self.near {
            let balls = self.overlap(pair);
            let (i, j) = (pair.i, pair.j);
            field.add(i, balls.field(by.get(j), pair.r));
            field.add(j, balls.field(by.get(i), pair.r));
            force.add(i, balls.force(on.get(i), by.get(j), pair.r));
            force.add(j, balls.force(on.get(j), by.get(i), -pair.r));
        }
        scale(field, FACTOR);
        scale(force, FACTOR);
    }

    /// Force (N) of all moments `by` on each moment `on` (A m2).
    pub fn force(&mut self, on: Soa3Ref<'_>, by: Soa3Ref<'_>, force: &mut Soa3) {
        self.sources.set_moments(by);
        let x = self.problem.positions;
        let near = self.near_distance;
        kernel::sums(&self.sources, x, on, near, Want::Force, &mut Soa3::default(), force);
        for pair in &self.near {
            let balls = self.overlap(pair);
            let (i, j) = (pair.i, pair.j);
            force.add(i, balls.force(on.get(i), by.get(j), pair.r));
            force.add(j, balls.force(on.get(j), by.get(i), -pair.r));
        }
        scale(force, FACTOR);
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
        self.sources.set_moments(m.view());
        let x = self.problem.positions;
        kernel::sums(&self.sources, x, m.view(), near, Want::Force, &mut Soa3::default(), out);
        scale(out, FACTOR);
    }

    /// Field (T) of the moments `m` at other points than the beads, those within `near` (m) left out.
    pub fn field_at(&mut self, points: Soa3Ref<'_>, m: Soa3Ref<'_>, near: f64, out: &mut Soa3) {
        self.sources.set_moments(m);
        kernel::sums(
            &self.sources,
            points,
            points,
            near,
            Want::Field,
            out,
            &mut Soa3::default(),
        );
        scale(out, FACTOR);
    }
}

fn scale(v: &mut Soa3, factor: f64) {
    for component in [&mut v.x, &mut v.y, &mut v.z] {
        component.iter_mut().for_each(|c| *c *= factor);
    }
}
