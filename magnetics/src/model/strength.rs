//! How strongly beads that saturate still answer.

use super::{Problem, near::Interaction};
use lbm_ibm_coupling::{Soa3, Vec3};

/// The secant polarisability of each bead in its local field over that at vanishing field, from 0 to 1; what two spheres or
/// multipoles have beyond dipoles is taken at the permeability that this stands for. A table that steepens counts as its
/// first slope.
pub(super) struct Strengths {
    /// One per bead.
    pub value: Vec<f64>,
    /// Slopes with the local field, 1/T.
    slope: Vec<Vec3>,
}

impl Strengths {
    /// In the local fields `local` (T).
    pub fn of(problem: &Problem<'_>, local: &Soa3) -> Self {
        let (mut value, mut slope) = (Vec::new(), Vec::new());
        for (i, bead) in problem.beads.iter().enumerate() {
            let h = local.get(i);
            let (now, first) = (bead.response(h), bead.response(Vec3::zeros()).across);
            let strength = if bead.permeability().is_some() || first <= 0.0 {
                1.0
            } else {
                now.across / first
            };
            let bends = strength < 1.0 && h.norm() > 0.0;
            value.push(strength.min(1.0));
            slope.push(if bends {
                now.direction * ((now.along - now.across) / (first * h.norm()))
            } else {
                Vec3::zeros()
            });
        }
        Self { value, slope }
    }

    /// All as at vanishing field.
    pub fn linear(beads: usize) -> Self {
        Self {
            value: vec![1.0; beads],
            slope: vec![Vec3::zeros(); beads],
        }
    }

    pub fn is_linear(&self) -> bool {
        self.value.iter().all(|t| *t == 1.0)
    }

    /// The moments (A m2) at the beads that stand for an energy whose slopes with the strengths are `energy` (J): minus its
    /// derivatives with the local fields.
    pub fn moments(&self, energy: &[f64]) -> Soa3 {
        self.slope.iter().zip(energy).map(|(s, e)| s * -e).collect()
    }
}

/// The permeability of a sphere whose polarisability is `strength` of that of `permeability`.
pub(super) fn weakened(permeability: f64, strength: f64) -> f64 {
    let p = strength * (permeability - 1.0) / (permeability + 2.0);
    (1.0 + 2.0 * p) / (1.0 - p)
}

/// Adds to `back` (T) the field of the moments `extra` (A m2) at the beads.
pub(super) fn add_field(dipoles: &mut Interaction<'_>, extra: &Soa3, back: &mut Soa3) {
    let mut work = Soa3::default();
    dipoles.induced_field(extra.view(), &mut work);
    for i in 0..work.len() {
        back.add(i, work.get(i));
    }
}

/// Adds the forces (N) between the moments `a` and `b`, and of the source on `b`.
pub(super) fn add_bilinear(dipoles: &mut Interaction<'_>, a: &Soa3, b: &Soa3, out: &mut Soa3) {
    let mut work = Soa3::default();
    for (on, by) in [(a, b), (b, a)] {
        dipoles.force_by(on.view(), by.view(), &mut work);
        for i in 0..work.len() {
            out.add(i, work.get(i));
        }
    }
    dipoles.add_source_force(b.view(), out);
}
