//! The reference for tests: mutual dipoles of linear beads by a dense factorisation.

use super::Problem;
use super::near::Interaction;
use crate::error::MagneticsError;
use lbm_ibm_coupling::nalgebra::{DMatrix, DVector};
use lbm_ibm_coupling::{Soa3, Vec3};

/// Moments (A m2) of mutually magnetised linear or remanent beads, by LU factorisation of the 3N x 3N system: the
/// reference against which iterations are held. Cost grows as N^3.
///
/// # Errors
/// [`MagneticsError::NotLinear`], [`MagneticsError::NotFinite`].
pub fn dense_moments(problem: &Problem<'_>) -> Result<Soa3, MagneticsError> {
    let n = problem.beads.len();
    if let Some(bead) = (0..n).find(|i| problem.beads[*i].permeability().is_none()) {
        return Err(MagneticsError::NotLinear {
            model: "the dense reference",
            bead,
        });
    }
    let mut dipoles = Interaction::new(problem)?;
    let at_rest: Soa3 = problem.beads.iter().map(|b| b.response(Vec3::zeros()).moment).collect();
    let slope: Vec<f64> = problem.beads.iter().map(|b| b.response(Vec3::zeros()).across).collect();
    // m - p G m = m0 + p B, with p the polarisability and m0 the remanent moment.
    let mut a = DMatrix::identity(3 * n, 3 * n);
    let mut field = Soa3::default();
    for j in 0..3 * n {
        let mut unit = Soa3::zeros(n);
        unit.set(j / 3, Vec3::ith(j % 3, 1.0));
        dipoles.induced_field(unit.view(), &mut field);
        for i in 0..3 * n {
            a[(i, j)] -= slope[i / 3] * field.get(i / 3)[i % 3];
        }
    }
    let b = DVector::from_fn(3 * n, |i, _| {
        at_rest.get(i / 3)[i % 3] + slope[i / 3] * dipoles.field.get(i / 3)[i % 3]
    });
    let m = a.lu().solve(&b).ok_or(MagneticsError::NotFinite {
        what: "moment",
        bead: 0,
    })?;
    Ok((0..n)
        .map(|i| Vec3::new(m[3 * i], m[3 * i + 1], m[3 * i + 2]))
        .collect())
}
