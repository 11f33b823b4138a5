//! Near multipoles: beads in packed contact.

mod bent;
pub(super) mod coupling;
mod solid;
pub(super) mod system;

use super::near::{self, Interaction};
use super::operator::norm;
use super::state::{restore_complex, save_complex};
use super::{ErrorEstimate, Model, MutualDipoles, Problem, Solution};
use crate::MU0;
use crate::error::{MagneticsError, within};
use bent::Bent;
use coupling::{Field, Link, Shape};
use lbm_ibm_coupling::nalgebra::Complex;
use lbm_ibm_coupling::{StateError, StateReader, StateWriter, Vec3};
use std::f64::consts::PI;
use system::System;

const MOST: usize = 70;
/// Up to so many beads all pairs have multipoles, unless a reach is given.
const FEW: usize = 100;
/// Reach for more beads, in the largest radius.
const REACH: f64 = 8.0;

/// Beads with multipoles to a given order between near pairs, dipoles between far ones.
///
/// Outgoing solid harmonics of every bead are carried to its neighbours by the translation theorem; a sphere answers to the
/// incoming order l with l (mu - 1)/(l mu + l + 1). The system is Hermitian and positive definite for mu_r >= 1:
/// conjugate gradients (normal equations where a bead is diamagnetic). The truncated energy is stationary and the forces are
/// its gradient. Pairs farther apart need fewer orders for the same error and get fewer, in the ratio of their
/// bispherical coordinates. The source acts on the dipoles alone: what its second gradient does to quadrupoles is left out, (a/D)^2
/// of the source's force with D its scale. Beads that saturate are first solved as mutual dipoles of their own law; what the
/// multipoles add is taken at the secant permeability of each in that local field, the change of which is in the gradient.
///
/// Order 18, the default, has forces to 1e-4 at gaps of 0.1 radii to mu_r 10, order 26 to 1e-7 at mu_r 4. At contact use
/// [`PairCorrected`](crate::PairCorrected) for chains, or a high order: the cost of a pair grows with its fourth power.
#[derive(Clone, Debug)]
pub struct Multipoles {
    order: usize,
    reach: Option<f64>,
    tolerance: f64,
    last: Vec<Complex<f64>>,
    dipoles: MutualDipoles,
}

impl Default for Multipoles {
    fn default() -> Self {
        Self::new(18)
    }
}

impl Multipoles {
    /// Multipoles to `order`, from 1 (mutual dipoles) to 70, between all pairs of up to 100 beads, and between pairs nearer
    /// than 8 of the largest radius, centre to centre, of more. What the farther pairs miss is in the estimate of error.
    /// Solving with any other order is a [`MagneticsError::Setting`].
    pub fn new(order: usize) -> Self {
        Self {
            order,
            reach: None,
            tolerance: 1e-10,
            last: Vec::new(),
            dipoles: MutualDipoles::new().with_tolerance(1e-10),
        }
    }

    /// Another reach, in the largest radius, centre to centre; beyond it beads are dipoles to each other. Solving with
    /// less than 2 is a [`MagneticsError::Setting`].
    pub fn with_reach(mut self, reach: f64) -> Self {
        self.reach = Some(reach);
        self
    }

    /// Another relative residual.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self.dipoles = self.dipoles.with_tolerance(tolerance);
        self
    }
}

impl Model for Multipoles {
    fn name(&self) -> &'static str {
        "near multipoles"
    }

    fn save(&self, to: &mut StateWriter) {
        self.dipoles.save(to);
        save_complex(&self.last, to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.dipoles.restore(from)?;
        restore_complex(&mut self.last, from)
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        within("order of the multipoles", self.order as f64, 1.0, MOST as f64)?;
        if let Some(reach) = self.reach {
            within("reach of the multipoles, in radii,", reach, 2.0, f64::INFINITY)?;
        }
        let n = problem.beads.len();
        out.resize(n);
        if n == 0 {
            return Ok(());
        }
        let bent = Bent::of(&mut self.dipoles, problem)?;
        let unit = problem.largest_radius();
        let beads = problem.beads;
        let reach = match self.reach {
            Some(reach) => reach * unit,
            None if n <= FEW => f64::INFINITY,
            None => REACH * unit,
        };
        let reach = reach.min(extent(problem) + unit);
        let links = near::pairs(problem, reach)
            .iter()
            .map(|pair| Link::new(pair, [beads[pair.i].radius(), beads[pair.j].radius()], unit, self.order))
            .collect();
        let strength = |i: usize| bent.as_ref().map_or(1.0, |b| b.strengths.value[i]);
        let shape = |(i, bead)| Shape::weakened(bead, strength(i), unit, self.order);
        let mut system = System {
            shapes: beads.iter().enumerate().map(shape).collect(),
            links,
            far: Interaction::new(problem)?,
            far_distance: Some(reach),
            unit,
            count: coupling::count(self.order),
            work: Field::default(),
        };
        let (outgoing, error) = self.magnetise(problem, &mut system)?;
        let into = self.finish(problem, &mut system, &outgoing, out);
        out.error.residual = error.residual;
        out.error.iterations = error.iterations;
        if let Some(bent) = bent {
            bent.add(&mut self.dipoles, problem, &mut system, into, out);
        }
        out.error.force += error.residual * norm(&out.force);
        Ok(())
    }
}

impl Multipoles {
    fn magnetise(
        &mut self,
        problem: &Problem<'_>,
        system: &mut System<'_>,
    ) -> Result<(Vec<Complex<f64>>, ErrorEstimate), MagneticsError> {
        let (fixed, right) = system.right(problem);
        let (residual, made) = system.solve(&right, &mut self.last, self.tolerance, "near multipoles")?;
        let y = &self.last;
        let mut outgoing = system.each(y, |shape, k, y| y * shape.root[k]);
        for (o, f) in outgoing.iter_mut().zip(&fixed) {
            *o += f;
        }
        let error = ErrorEstimate {
            force: 0.0,
            residual,
            iterations: made,
        };
        Ok((outgoing, error))
    }

    fn finish(
        &self,
        problem: &Problem<'_>,
        system: &mut System<'_>,
        outgoing: &[Complex<f64>],
        out: &mut Solution,
    ) -> Vec<Complex<f64>> {
        let n = problem.beads.len();
        let count = system.count;
        out.moment = system.moments(outgoing);
        let scale = 4.0 * PI * MU0;
        // Far beads as dipoles, then the source.
        system
            .far
            .force_at(&out.moment, system.far_distance.unwrap_or(0.0), &mut out.force);
        system.far.add_source_force(out.moment.view(), &mut out.force);
        let mut missing = vec![0.0; n];
        for link in &system.links {
            let (i, j) = (link.i * count, link.j * count);
            let (a, b) = (&outgoing[i..i + count], &outgoing[j..j + count]);
            let f = link.force(a, b, &mut system.work) * scale;
            out.force.add(link.i, f);
            out.force.add(link.j, -f);
            let roots = [&system.shapes[link.i].root[..], &system.shapes[link.j].root[..]];
            let tail = link.tail(a, b, roots, &mut system.work) * scale;
            missing[link.i] += tail;
            missing[link.j] += tail;
        }
        let into = system.incoming(outgoing);
        system.energy_and_torques(problem.beads, &into, out);
        system.add_far_tail(outgoing, scale, &mut missing);
        out.error.force = missing.into_iter().fold(0.0, f64::max);
        into
    }
}

/// Diagonal (m) of the box about all centres.
fn extent(problem: &Problem<'_>) -> f64 {
    let x = problem.positions;
    let span = |c: &[f64]| {
        let (low, high) = c
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| (l.min(*c), h.max(*c)));
        high - low
    };
    Vec3::new(span(x.x), span(x.y), span(x.z)).norm()
}
