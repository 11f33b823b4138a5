//! Newton's method for the place of rest, closed contacts as equations.

use super::QuasiStatic;
use crate::dynamics::contact::{Constraint, ContactLaw, Look, Partner, Site};
use crate::error::MagneticsError;
use lbm_ibm_coupling::nalgebra::{DMatrix, DVector, SVD};
use lbm_ibm_coupling::{Soa3, Vec3};

/// Iterations before going downhill again.
const ITERATIONS: usize = 30;
/// Step of the differences for the Jacobian, in radii.
const DIFFERENCE: f64 = 1e-5;
/// Singular values of the Jacobian that count as zero, over the greatest.
const SLACK: f64 = 1e-9;
/// Farthest that a bead may go in all, in radii.
const FARTHEST: f64 = 1.0;
/// Gaps that count as closed or as entered, in radii.
const CLOSED: f64 = 1e-9;
/// Gaps that are nearly closed, in radii.
const NEAR: f64 = 1e-2;

impl QuasiStatic {
    /// Tries to put the beads at rest, with the contacts that push as closed, then with all that are nearly closed; iterations
    /// and residual, or none and the beads where they were.
    pub(super) fn polish(&mut self) -> Result<Option<(usize, f64)>, MagneticsError> {
        let near = NEAR * self.run.system().smallest_radius();
        let [pushing, all] = [0.0, near].map(|gap| self.run.system().contacts.closer_than(gap));
        let more = all.len() > pushing.len();
        Ok(match self.newton(pushing)? {
            None if more => self.newton(all)?,
            found => found,
        })
    }

    fn newton(&mut self, mut active: Vec<Site>) -> Result<Option<(usize, f64)>, MagneticsError> {
        let ContactLaw::Constraint(law) = self.run.system().contact else {
            return Ok(None);
        };
        let free: Vec<usize> = (0..self.run.positions().len())
            .filter(|i| !self.run.system().frozen[*i])
            .collect();
        let size = self.run.system().smallest_radius();
        let (scale, start) = (self.scale(), self.run.system().x.clone());
        let drag = self.run.system().mobility.stokes(size);
        let mut x = start.clone();
        for iteration in 0..ITERATIONS {
            active = self.place(&x, &law, active, size);
            let w = self.velocity(&x, &active)?;
            let left = free.iter().map(|i| w.get(*i).norm()).fold(0.0, f64::max) * drag / scale;
            let open = active.iter().map(|s| s.gap.abs()).fold(0.0, f64::max) / size;
            let pushing = active.iter().all(|s| s.force.dot(&s.normal) >= 0.0);
            if left <= self.tolerance && open <= CLOSED {
                // A contact that must pull is none; the place without it may be a ridge, which going downhill decides.
                if !pushing {
                    return Ok(None);
                }
                self.run.rest_at(x, active)?;
                return Ok(Some((iteration, left)));
            }
            let n = 3 * free.len();
            let mut matrix = DMatrix::zeros(n + active.len(), n + active.len());
            for (a, i) in free.iter().enumerate() {
                for axis in 0..3 {
                    // Central: forces bend at contact, and both beads of a pair must see the same slope.
                    let [ahead, behind] = [DIFFERENCE, -DIFFERENCE].map(|by| {
                        let mut there = x.clone();
                        there.add(*i, Vec3::ith(axis, by * size));
                        let turned: Vec<Site> = active.iter().map(|s| turned(s, &there)).collect();
                        self.velocity(&there, &turned)
                    });
                    let (ahead, behind) = (ahead?, behind?);
                    for (b, j) in free.iter().enumerate() {
                        let slope = (ahead.get(*j) - behind.get(*j)) * (0.5 * drag / scale / DIFFERENCE);
                        matrix.fixed_view_mut::<3, 1>(3 * b, 3 * a + axis).copy_from(&slope);
                    }
                }
            }
            let mut right = DVector::zeros(n + active.len());
            for (b, j) in free.iter().enumerate() {
                right
                    .fixed_rows_mut::<3>(3 * b)
                    .copy_from(&(w.get(*j) * (-drag / scale)));
            }
            let time = self.run.time();
            let mobility = self.run.system_mut().stage(x.clone(), time)?.mobility;
            for (k, s) in active.iter().enumerate() {
                right[n + k] = -s.gap / size;
                let mut push = Soa3::zeros(x.len());
                mobility.kick(s.bead, s.normal * drag, &mut push);
                if let Partner::Bead(other) = s.with {
                    mobility.kick(other, s.normal * -drag, &mut push);
                }
                for (b, j) in free.iter().enumerate() {
                    matrix.fixed_view_mut::<3, 1>(3 * b, n + k).copy_from(&push.get(*j));
                    let sign = f64::from(u8::from(s.bead == *j)) - f64::from(u8::from(s.with == Partner::Bead(*j)));
                    matrix
                        .fixed_view_mut::<1, 3>(n + k, 3 * b)
                        .copy_from(&(s.normal.transpose() * sign));
                }
            }
            // The shortest of the best steps, for free beads may have directions without any stiffness.
            let singular = SVD::new(matrix, true, true);
            let least = SLACK * singular.singular_values.max();
            let Some(step) = singular
                .solve(&right, least)
                .ok()
                .filter(|s| s.iter().all(|c| c.is_finite()))
            else {
                return Ok(None);
            };
            for (b, j) in free.iter().enumerate() {
                x.add(*j, step.fixed_rows::<3>(3 * b).into_owned() * size);
            }
            for (k, s) in active.iter_mut().enumerate() {
                s.force += s.normal * (step[n + k] * scale);
            }
            if free
                .iter()
                .any(|i| (x.get(*i) - start.get(*i)).norm() > FARTHEST * size)
            {
                return Ok(None);
            }
        }
        Ok(None)
    }

    /// The contacts at `x`: those known, pushing or not, and those that beads have entered.
    fn place(&mut self, x: &Soa3, law: &Constraint, active: Vec<Site>, size: f64) -> Vec<Site> {
        let look = Look {
            x,
            time: self.run.time(),
            base: x,
            step: 1.0,
        };
        let mut found = self.run.system_mut().find(&look, law, 0.1 * size);
        found.retain_mut(|s| {
            let alike = active.iter().filter(|a| a.key() == s.key());
            let same = alike.max_by(|a, b| a.normal.dot(&s.normal).total_cmp(&b.normal.dot(&s.normal)));
            let Some(old) = same.filter(|a| a.normal.dot(&s.normal) > 0.7) else {
                return s.gap < -CLOSED * size;
            };
            s.force = s.normal * old.force.dot(&old.normal);
            true
        });
        found
    }

    /// Velocities of the beads at `x` with the forces of the contacts, m/s.
    fn velocity(&mut self, x: &Soa3, active: &[Site]) -> Result<Soa3, MagneticsError> {
        let time = self.run.time();
        let stage = self.run.system_mut().stage(x.clone(), time)?;
        let mut v = stage.velocity;
        for s in active {
            stage.mobility.kick(s.bead, s.force, &mut v);
            if let Partner::Bead(other) = s.with {
                stage.mobility.kick(other, -s.force, &mut v);
            }
        }
        Ok(v)
    }
}

/// A contact of two beads as it is at `x`; one with a wall as it was.
fn turned(s: &Site, x: &Soa3) -> Site {
    let mut s = s.clone();
    if let Partner::Bead(other) = s.with {
        let r = x.get(s.bead) - x.get(other);
        let push = s.force.dot(&s.normal);
        s.normal = r / r.norm();
        s.force = s.normal * push;
    }
    s
}
