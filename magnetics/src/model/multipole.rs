//! Near multipoles: beads in packed contact.

mod coupling;
mod solid;
mod system;

use super::near::{self, Interaction};
use super::operator::norm;
use super::{ErrorEstimate, Model, Problem, Solution};
use crate::MU0;
use crate::error::MagneticsError;
use coupling::{Field, Link, Shape};
use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::Complex;
use std::f64::consts::PI;
use system::{System, h_to_coefficients};

const MOST: usize = 70;

/// Linear beads with multipoles to a given order between near pairs, dipoles between far ones.
///
/// Outgoing solid harmonics of every bead are carried to its neighbours by the translation theorem; a sphere answers to the
/// incoming order l with l (mu - 1)/(l mu + l + 1). The system is Hermitian and positive definite for mu_r >= 1:
/// conjugate gradients (normal equations where a bead is diamagnetic). The truncated energy is stationary and the forces are
/// its gradient. Pairs farther apart need fewer orders for the same error and get fewer, in the ratio of their
/// bispherical coordinates. The source acts on the dipoles alone: what its second gradient does to quadrupoles is left out, (a/D)^2
/// of the source's force with D its scale.
///
/// Order 16, the default, has forces to 1e-4 at gaps of 0.1 radii, order 26 to 1e-7. At contact use
/// [`PairCorrected`](crate::PairCorrected) for chains, or a high order: the cost of a pair grows with its fourth power.
#[derive(Clone, Debug)]
pub struct Multipoles {
    order: usize,
    reach: f64,
    tolerance: f64,
    last: Vec<Complex<f64>>,
}

impl Default for Multipoles {
    fn default() -> Self {
        Self::new(16)
    }
}

impl Multipoles {
    /// Multipoles to `order`, from 1 (mutual dipoles) to 70, between pairs nearer than 8 mean radii, centre to centre.
    pub fn new(order: usize) -> Self {
        Self {
            order: order.clamp(1, MOST),
            reach: 8.0,
            tolerance: 1e-10,
            last: Vec::new(),
        }
    }

    /// Another reach, in the largest radius, centre to centre; beyond it beads are dipoles to each other.
    pub fn with_reach(mut self, reach: f64) -> Self {
        self.reach = reach.max(2.0);
        self
    }

    /// Another relative residual.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }
}

impl Model for Multipoles {
    fn name(&self) -> &'static str {
        "near multipoles"
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        let n = problem.beads.len();
        out.resize(n);
        if n == 0 {
            return Ok(());
        }
        if let Some(bead) = (0..n).find(|i| problem.beads[*i].permeability().is_none()) {
            return Err(MagneticsError::NotLinear {
                model: self.name(),
                bead,
            });
        }
        let unit = problem.largest_radius();
        let reach = self.reach * unit;
        let beads = problem.beads;
        let links = near::pairs(problem, reach)
            .iter()
            .map(|pair| Link::new(pair, [beads[pair.i].radius(), beads[pair.j].radius()], unit, self.order))
            .collect();
        let mut system = System {
            shapes: beads.iter().map(|b| Shape::new(b, unit, self.order)).collect(),
            links,
            far: Interaction::new(problem)?,
            far_distance: reach,
            unit,
            count: coupling::count(self.order),
            work: Field::default(),
        };
        let (outgoing, error) = self.magnetise(problem, &mut system)?;
        self.finish(problem, &mut system, &outgoing, out);
        out.error.residual = error.residual;
        out.error.iterations = error.iterations;
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
        let n = problem.beads.len();
        let zero = Complex::new(0.0, 0.0);
        let mut fixed = vec![zero; n * system.count];
        let mut applied = vec![zero; n * system.count];
        for (i, bead) in problem.beads.iter().enumerate() {
            let m = bead.response(Vec3::zeros()).moment / (4.0 * PI * system.unit.powi(2));
            let h = h_to_coefficients(system.far.field.get(i) / MU0, system.unit);
            let at = i * system.count;
            (fixed[at], fixed[at + 1]) = (Complex::new(m.z, 0.0), Complex::new(-m.x, m.y) / 2.0);
            (applied[at], applied[at + 1]) = (h[0], h[1]);
        }
        let of_fixed = system.incoming(&fixed);
        for (a, b) in applied.iter_mut().zip(&of_fixed) {
            *a += b;
        }
        let right = system.each(&applied, |shape, k, b| -b * shape.root[k] * shape.sign);
        if self.last.len() != right.len() {
            self.last = vec![zero; right.len()];
        }
        let diamagnetic = system.shapes.iter().any(|s| s.sign < 0.0);
        let mut y = std::mem::take(&mut self.last);
        let start = system.apply(&y, false);
        let mut r: Vec<_> = right.iter().zip(&start).map(|(b, a)| b - a).collect();
        let scale = system.dot(&right, &right).sqrt().max(f64::MIN_POSITIVE);
        let mut z = if diamagnetic { system.apply(&r, true) } else { r.clone() };
        let mut p = z.clone();
        let mut zz = system.dot(&z, &z);
        let mut made = 0;
        let mut residual = system.dot(&r, &r).sqrt() / scale;
        while residual > self.tolerance {
            if made >= 2000 {
                return Err(MagneticsError::NotConverged {
                    model: "near multipoles",
                    residual,
                    iterations: made,
                    tolerance: self.tolerance,
                });
            }
            let q = system.apply(&p, false);
            made += 1;
            let curvature = if diamagnetic {
                system.dot(&q, &q)
            } else {
                system.dot(&p, &q)
            };
            let alpha = zz / curvature;
            for k in 0..y.len() {
                y[k] += p[k] * alpha;
                r[k] -= q[k] * alpha;
            }
            residual = system.dot(&r, &r).sqrt() / scale;
            z = if diamagnetic { system.apply(&r, true) } else { r.clone() };
            let next = system.dot(&z, &z);
            for k in 0..p.len() {
                p[k] = z[k] + p[k] * (next / zz);
            }
            zz = next;
        }
        let mut outgoing = system.each(&y, |shape, k, y| y * shape.root[k]);
        for (o, f) in outgoing.iter_mut().zip(&fixed) {
            *o += f;
        }
        self.last = y;
        let error = ErrorEstimate {
            force: 0.0,
            residual,
            iterations: made,
        };
        Ok((outgoing, error))
    }

    fn finish(&self, problem: &Problem<'_>, system: &mut System<'_>, outgoing: &[Complex<f64>], out: &mut Solution) {
        let n = problem.beads.len();
        let count = system.count;
        out.moment = system.moments(outgoing);
        let scale = 4.0 * PI * MU0;
        // Far beads as dipoles, then the source.
        system.far.force_at(&out.moment, system.far_distance, &mut out.force);
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
        out.energy = 0.0;
        for (i, bead) in problem.beads.iter().enumerate() {
            let [b0, b1] = [into[i * count], into[i * count + 1]];
            let local = Vec3::new(b1.re, -b1.im, -b0.re) * (MU0 / system.unit);
            let own = system.far.field.get(i);
            let fixed = bead.response(Vec3::zeros()).moment;
            out.torque.set(i, fixed.cross(&(own + local)));
            let induced = out.moment.get(i) - fixed;
            out.energy -= 0.5 * induced.dot(&own) + fixed.dot(&own) + 0.5 * fixed.dot(&local);
        }
        out.error.force = missing.into_iter().fold(0.0, f64::max);
    }
}
