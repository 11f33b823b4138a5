//! The model that needs no thought: pair correction, and multipoles where contacts close triangles.

mod activity;

use super::corrected::{Extra, add_moments, apply, greatest, near_pairs};
use super::multipole::coupling::{Field, Link, Shape, count};
use super::multipole::system::System;
use super::near::{Interaction, pairs};
use super::state::{restore_complex, save_complex};
use super::strength::{Strengths, add_bilinear};
use super::{Model, PairCorrected, Problem, Solution};
use crate::MU0;
use crate::bead::Bead;
use crate::error::{MagneticsError, within};
use crate::tree::Summation;
use crate::two_sphere::Truncated;
use activity::{Activity, falling};
use lbm_ibm_coupling::nalgebra::Complex;
use lbm_ibm_coupling::{Soa3, StateError, StateReader, StateWriter, Vec3};
use std::f64::consts::PI;

const NAME: &str = "automatic";
/// Centre distances, in the largest radius, up to which multipoles count fully, and from which they do not.
const REACH: [f64; 2] = [4.5, 6.0];

/// The default model: picks the rung bead by bead.
///
/// Pairs and open chains are those of [`PairCorrected`]. Beads in contacts that close a triangle, gaps below 0.5 mean radii,
/// answer with multipoles to the given order besides; what these orders still miss of a near pair, exact less truncated, is
/// added as in the pair correction. Between gaps of 0.5 and 0.8 the multipoles open smoothly, so the energy is one smooth
/// function of the positions, overlaps left aside, and the forces are its gradient. Where no triangle closes the cost is that of [`PairCorrected`]. If any bead
/// saturates, all have the pair correction alone, whose estimate of error is then large in packed contacts; use
/// [`Multipoles`](crate::Multipoles) there.
///
/// ```
/// use lbm_ibm_coupling::{Soa3, Vec3};
/// use lbm_ibm_magnetics::*;
///
/// let bead = Bead::new(2e-6, 1500.0, Intrinsic::new(1.0)?)?;
/// let x: Soa3 = [[0.0, 0.0, 0.0], [0.0, 0.0, 4.2e-6], [3.637e-6, 0.0, 2.1e-6]].into_iter().map(Vec3::from).collect();
/// let (beads, source) = (vec![bead; 3], Uniform::new(Vec3::z() * 0.05));
/// let mut solution = Solution::new();
/// Auto::new().solve(&Problem::new(&beads, x.view(), &source, 0.0)?, &mut solution)?;
/// // Fx of the third bead in units of mu0 H0^2 a^2, from multipoles to order 40: -0.09058.
/// let unit = 0.05f64.powi(2) * 4e-12 / MU0;
/// assert!((solution.force.get(2).x / unit + 0.09058).abs() < 3e-4);
/// # Ok::<(), MagneticsError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Auto {
    corrected: PairCorrected,
    order: usize,
    tolerance: f64,
    last: Vec<Complex<f64>>,
    last_back: Vec<Complex<f64>>,
}

impl Default for Auto {
    fn default() -> Self {
        Self::new()
    }
}

/// The energy's slopes with the openness of each bead, J.
struct Slopes(Vec<f64>);

impl Auto {
    /// Multipoles to order 8 where contacts are closed, solved to a relative residual of 1e-7.
    pub fn new() -> Self {
        Self {
            corrected: PairCorrected::new(),
            order: 8,
            tolerance: 1e-7,
            last: Vec::new(),
            last_back: Vec::new(),
        }
    }

    /// Another order of the multipoles, from 2 to 40: errors of packed contacts fall with it, the cost there grows with its
    /// fourth power. Solving with any other is a [`MagneticsError::Setting`].
    pub fn with_order(mut self, order: usize) -> Self {
        self.order = order;
        self
    }

    /// Another relative residual.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.corrected = self.corrected.with_tolerance(tolerance);
        self.tolerance = tolerance;
        self
    }

    fn system<'a>(&self, problem: &Problem<'a>, activity: &Activity) -> Result<System<'a>, MagneticsError> {
        let (unit, beads) = (problem.largest_radius(), problem.beads);
        let open = &activity.value;
        let mut links = Vec::new();
        for pair in pairs(problem, REACH[1] * unit) {
            if open[pair.i] > 0.0 || open[pair.j] > 0.0 {
                let width = (REACH[1] - REACH[0]) * unit;
                let weight = falling((pair.distance - REACH[0] * unit) / width, width);
                let radius = [beads[pair.i].radius(), beads[pair.j].radius()];
                if weight.0 > 0.0 {
                    links.push(Link::beyond_dipoles(&pair, radius, unit, self.order, weight));
                }
            }
        }
        let shape = |(i, bead): (usize, &Bead)| {
            let mut shape = Shape::new(bead, unit, self.order);
            for root in &mut shape.root[2..] {
                *root *= open[i].sqrt();
            }
            shape
        };
        Ok(System {
            shapes: beads.iter().enumerate().map(shape).collect(),
            links,
            far: Interaction::new(problem)?,
            far_distance: None,
            unit,
            count: count(self.order),
            work: Field::default(),
        })
    }

    /// The near pairs: what the open multipoles miss of them, and the slopes of that with the openness of both beads.
    fn remainders(
        &mut self,
        problem: &Problem<'_>,
        open: &[f64],
        strengths: &Strengths,
    ) -> Result<(Vec<Extra>, Vec<Truncated>), MagneticsError> {
        let mut extras = near_pairs(&mut self.corrected.tables, self.corrected.reach, problem, strengths)?;
        let mut known = Vec::with_capacity(extras.len());
        for pair in &mut extras {
            let (i, j) = (pair.i, pair.j);
            let mut found = Truncated::default();
            if open[i] > 0.0 || open[j] > 0.0 {
                let beads = [&problem.beads[i], &problem.beads[j]];
                let permeability = beads.map(|b| b.initial_permeability());
                let radius = beads.map(|b| b.radius());
                found = Truncated::new(radius, permeability, pair.distance, self.order, [open[i], open[j]]);
                pair.subtract(&mut found);
            }
            known.push(found);
        }
        Ok((extras, known))
    }
}

impl Model for Auto {
    fn name(&self) -> &'static str {
        NAME
    }

    fn save(&self, to: &mut StateWriter) {
        self.corrected.save(to);
        save_complex(&self.last, to);
        save_complex(&self.last_back, to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.corrected.restore(from)?;
        restore_complex(&mut self.last, from)?;
        restore_complex(&mut self.last_back, from)
    }

    fn solve(&mut self, problem: &Problem<'_>, out: &mut Solution) -> Result<(), MagneticsError> {
        within("order of the multipoles", self.order as f64, 2.0, 40.0)?;
        let activity = Activity::of(problem);
        let linear = problem.beads.iter().all(|b| b.permeability().is_some());
        if activity.is_none() || !linear {
            return self.corrected.solve(problem, out);
        }
        let n = problem.beads.len();
        out.resize(n);
        let mut system = self.system(problem, &activity)?;
        let plain: Vec<Shape> = problem
            .beads
            .iter()
            .map(|b| Shape::new(b, system.unit, self.order))
            .collect();
        let (fixed, right) = system.right(problem);
        let (residual, iterations) = system.solve(&right, &mut self.last, self.tolerance, NAME)?;
        let mut outgoing = system.each(&self.last, |shape, k, y| y * shape.root[k]);
        for (o, f) in outgoing.iter_mut().zip(&fixed) {
            *o += f;
        }
        out.error.residual = residual;
        out.error.iterations = iterations;
        let into = finish(problem, &mut system, &outgoing, out);
        let energy = 4.0 * PI * MU0 * system.unit;
        let mut slopes = Slopes(vec![0.0; n]);
        slopes.add(&system, &plain, -0.5 * energy, &into, &into);
        let open: Vec<f64> = activity.value.iter().map(|v| 1.0 - v).collect();
        let strengths = Strengths::linear(n);
        let (mut extras, known) = self.remainders(problem, &activity.value, &strengths)?;
        let applied = apply(problem, &mut extras, Summation::Direct, &open, &strengths, out);
        for (pair, known) in extras.iter().zip(&known) {
            let [along, across] = pair.field_squares();
            for (s, bead) in [pair.i, pair.j].into_iter().enumerate() {
                slopes.0[bead] += 0.5 * (along * known.par_open[s] + across * known.perp_open[s]);
            }
        }
        for (slope, cross) in slopes.0.iter_mut().zip(&applied.cross) {
            *slope -= cross;
        }
        // What the corrections do to the multipoles.
        let mut by_back = vec![Complex::new(0.0, 0.0); outgoing.len()];
        system.add_field(&applied.back, &mut by_back);
        let right = system.answers(&by_back);
        let (_, more) = system.solve(&right, &mut self.last_back, self.tolerance.sqrt(), NAME)?;
        out.error.iterations += more;
        let induced = system.each(&self.last_back, |shape, k, y| y * shape.root[k]);
        let into_induced = add_response(problem, &mut system, &outgoing, &induced, &applied.back, out);
        slopes.add(&system, &plain, -energy, &into, &into_induced);
        activity.add_forces(&slopes.0, &mut out.force);
        add_moments(&extras, out);
        out.error.force = greatest(&applied.off, self.corrected.reach, problem, out);
        Ok(())
    }
}

impl Slopes {
    /// Adds `factor` times the product of what comes in at the orders from 2 on, weighted by how the beads would answer.
    fn add(&mut self, system: &System<'_>, plain: &[Shape], factor: f64, a: &[Complex<f64>], b: &[Complex<f64>]) {
        for (i, shape) in plain.iter().enumerate() {
            let at = i * system.count;
            let sum: f64 = (2..system.count)
                .map(|k| {
                    let (a, b) = (a[at + k], b[at + k]);
                    shape.weight[k] * shape.root[k].powi(2) * (a.re * b.re + a.im * b.im)
                })
                .sum();
            self.0[i] += factor * shape.sign * sum;
        }
    }
}

/// Forces, torques and energy of the outgoing coefficients; returns the incoming ones, without the source.
fn finish(
    problem: &Problem<'_>,
    system: &mut System<'_>,
    outgoing: &[Complex<f64>],
    out: &mut Solution,
) -> Vec<Complex<f64>> {
    out.moment = system.moments(outgoing);
    let mut field = Soa3::default();
    let m = out.moment.view();
    system.far.field_and_force(m, &mut field, &mut out.force);
    system.far.add_source_force(m, &mut out.force);
    add_link_forces(system, outgoing, outgoing, out);
    let into = system.incoming(outgoing);
    system.energy_and_torques(problem.beads, &into, out);
    into
}

/// Adds what the outgoing coefficients `by`, induced by the field `back` (T), do to forces, torques and moments.
fn add_response(
    problem: &Problem<'_>,
    system: &mut System<'_>,
    outgoing: &[Complex<f64>],
    by: &[Complex<f64>],
    back: &Soa3,
    out: &mut Solution,
) -> Vec<Complex<f64>> {
    let (moment, induced) = (system.moments(outgoing), system.moments(by));
    add_bilinear(&mut system.far, &moment, &induced, &mut out.force);
    add_link_forces(system, outgoing, by, out);
    add_link_forces(system, by, outgoing, out);
    let into = system.incoming(by);
    for (i, bead) in problem.beads.iter().enumerate() {
        let fixed = bead.response(Vec3::zeros()).moment;
        out.torque
            .add(i, fixed.cross(&(system.local_field(&into, i) + back.get(i))));
        out.moment.add(i, induced.get(i));
    }
    into
}

/// Adds the forces between the coefficients `on` of the first bead of each link and `by` of the second.
fn add_link_forces(system: &mut System<'_>, on: &[Complex<f64>], by: &[Complex<f64>], out: &mut Solution) {
    let (count, scale) = (system.count, 4.0 * PI * MU0);
    for link in &system.links {
        let (i, j) = (link.i * count, link.j * count);
        let (a, b) = (&on[i..i + count], &by[j..j + count]);
        let mut f = link.force(a, b, &mut system.work) * scale;
        if link.slope != 0.0 {
            // A link that fades pulls on its own weight.
            f -= link.direction * (link.slope * link.energy(a, b, &mut system.work) * scale * system.unit);
        }
        out.force.add(link.i, f);
        out.force.add(link.j, -f);
    }
}
