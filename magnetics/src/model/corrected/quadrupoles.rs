//! What two neighbours do to the quadrupole of a third bead.
//!
//! A bead of radius a in the field gradient G answers with the energy -k |G|^2, k = 4 pi beta_2 a^5/(12 mu0), beta_2 =
//! 2 (mu - 1)/(2 mu + 3). The pair correction has it for each neighbour alone, sum |G_j|^2; inside of a chain the gradients of
//! both neighbours cancel, and the pairs alone are too strong. This adds the rest, -k w (|sum G_j|^2 - sum |G_j|^2). Higher
//! orders l have such terms too; in a straight chain they alternate in sign and at contact stand as (l+1)^2 (2l+4)/2^(2l+1),
//! so that their sum is w = 0.63 of the first.

use super::Extra;
use crate::MU0;
use crate::bead::Bead;
use crate::model::Problem;
use crate::model::near::FACTOR;
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Vec3};
use std::f64::consts::PI;

/// Sum of the cross terms of all orders over that of the quadrupole, straight chain at contact.
const ALL_ORDERS: f64 = 0.63;

/// Gradient at bead `on` of neighbour `by`, weighted.
struct Link {
    on: usize,
    by: usize,
    r: Vec3,
    weight: f64,
    slope: f64,
    gradient: Matrix3<f64>,
}

/// Adds the forces of the cross terms, and to `back` the field (T) that they are to each dipole; `open` is the share of each
/// bead's, `strength` that of its polarisability. Returns their energy (J) per bead, without the share.
pub(super) fn add_cross_terms(
    problem: &Problem<'_>,
    extras: &[Extra],
    open: &[f64],
    strength: &[f64],
    moment: &Soa3,
    back: &mut Soa3,
    force: &mut Soa3,
) -> Vec<f64> {
    let mut links = Vec::with_capacity(2 * extras.len());
    for pair in extras {
        let (weight, slope) = pair.presence;
        for (on, by, r) in [(pair.i, pair.j, pair.r), (pair.j, pair.i, -pair.r)] {
            links.push(Link {
                on,
                by,
                r,
                weight,
                slope,
                gradient: gradient(moment.get(by), r),
            });
        }
    }
    let n = problem.beads().len();
    let mut sum = vec![Matrix3::zeros(); n];
    for link in &links {
        sum[link.on] += link.gradient * link.weight;
    }
    let stiffness = |(bead, t): (&Bead, &f64)| {
        let p = t * polarisability(bead);
        ALL_ORDERS * 4.0 * PI / (12.0 * MU0) * 2.0 * 3.0 * p / (5.0 + p) * bead.radius().powi(5)
    };
    let stiffness: Vec<f64> = problem.beads().iter().zip(strength).map(stiffness).collect();
    let mut energy = vec![0.0; n];
    for link in &links {
        let own = link.gradient * link.weight;
        let rest = (sum[link.on] - own) * (2.0 * stiffness[link.on]);
        energy[link.on] -= 0.5 * rest.dot(&own);
        let rest = rest * open[link.on];
        let (r, m) = (link.r, moment.get(link.by));
        let (pull, field) = contract(&rest, m, r);
        let along = rest.dot(&link.gradient) * link.slope;
        let f = pull * link.weight + r * (along / r.norm().max(f64::MIN_POSITIVE));
        force.add(link.on, f);
        force.add(link.by, -f);
        back.add(link.by, field * link.weight);
    }
    energy
}

/// (mu - 1)/(mu + 2) at vanishing field; beta_2 is 2 times 3 p/(5 + p) of it.
fn polarisability(bead: &Bead) -> f64 {
    let mu = bead.initial_permeability();
    (mu - 1.0) / (mu + 2.0)
}

/// Derivatives (1/r d/dr)^k of 1/r, k = 2, 3, 4.
fn derivatives(r: Vec3) -> [f64; 3] {
    let i2 = 1.0 / r.norm_squared().max(f64::MIN_POSITIVE);
    let i5 = i2 * i2 * i2.sqrt();
    [3.0 * i5, -15.0 * i5 * i2, 105.0 * i5 * i2 * i2]
}

/// Gradient (T/m) at `r` (m) from a dipole `m` (A m2).
fn gradient(m: Vec3, r: Vec3) -> Matrix3<f64> {
    let [p2, p3, _] = derivatives(r);
    let mr = m.dot(&r);
    let mixed = m * r.transpose();
    (r * r.transpose() * (p3 * mr) + (Matrix3::identity() * mr + mixed + mixed.transpose()) * p2) * FACTOR
}

/// Derivatives of t : gradient(m, r) with r and with m, for t symmetric without trace.
fn contract(t: &Matrix3<f64>, m: Vec3, r: Vec3) -> (Vec3, Vec3) {
    let [p2, p3, p4] = derivatives(r);
    let tr = t * r;
    let (rtr, mr, mtr) = (r.dot(&tr), m.dot(&r), m.dot(&tr));
    let with_r = r * (p4 * rtr * mr + 2.0 * p3 * mtr) + (tr * (2.0 * mr) + m * rtr) * p3 + t * m * (2.0 * p2);
    let with_m = r * (p3 * rtr) + tr * (2.0 * p2);
    (with_r * FACTOR, with_m * FACTOR)
}
