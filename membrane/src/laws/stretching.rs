//! Neo-Hookean springs along the edges.

use super::Law;
use super::edges;
use super::elements::{Elements, length};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// Nodes and weights of Gauss-Legendre quadrature of five points on [-1, 1].
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];
/// Panels of the quadrature of the energy.
const PANELS: usize = 8;

/// Springs along the edges: F = ks kappa(l) (L - L0)/L0 towards the other node, l = L/L0,
/// kappa(l) = (l^0.5 + l^-2.5)/(l + l^-3) (Dupin et al. 2007, eq. 19; ks in N).
///
/// Keeps force and torque. Energy: the sum over edges of ks L0 times the integral of kappa(l) (l - 1) from 1 to l.
#[derive(Clone, Debug)]
pub struct Stretching {
    springs: Elements<2, 1>,
    modulus: f64,
}

impl Stretching {
    /// Springs at rest on `mesh`, with `modulus` ks in N.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, modulus: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            springs: Elements::springs(mesh),
            modulus: positive("the stretching modulus", modulus)?,
        })
    }

    pub(super) fn modulus(&self) -> f64 {
        self.modulus
    }
}

/// Tension (N) of a spring by its length and that at rest, as numerator and denominator.
#[inline(always)]
pub(super) fn tension(modulus: f64, length: f64, rest: f64) -> (f64, f64) {
    let l = length / rest;
    let cube = l * l * l;
    (modulus * l.sqrt() * (1.0 + cube) * (l - 1.0), 1.0 + cube * l)
}

/// kappa(l) = (l^0.5 + l^-2.5)/(l + l^-3), its fraction cleared.
#[inline]
fn kappa(l: f64) -> f64 {
    let cube = l * l * l;
    l.sqrt() * (1.0 + cube) / (1.0 + cube * l)
}

impl Law for Stretching {
    fn name(&self) -> &str {
        "stretching"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let modulus = self.modulus;
        let pull = |length: f64, rest: f64| {
            let (above, below) = tension(modulus, length, rest);
            above / (below * length)
        };
        edges::pull(&self.springs, x, force, pull);
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let spring = |(ends, [rest]): ([u32; 2], [f64; 1])| {
            let l = length(x, ends) / rest;
            let half = 0.5 * (l - 1.0) / PANELS as f64;
            let panel = |k: usize| {
                let middle = 1.0 + half * (2 * k + 1) as f64;
                let at = |(node, weight): (f64, f64)| {
                    let u = middle + half * node;
                    weight * kappa(u) * (u - 1.0)
                };
                half * GAUSS.map(at).iter().sum::<f64>()
            };
            self.modulus * rest * (0..PANELS).map(panel).sum::<f64>()
        };
        Some(self.springs.iter().map(spring).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::kappa;

    #[test]
    fn kappa_is_the_published_ratio() {
        for l in [0.4_f64, 0.9, 1.0, 1.3, 2.7] {
            let published = (l.powf(0.5) + l.powf(-2.5)) / (l + l.powi(-3));
            assert!((kappa(l) / published - 1.0).abs() < 1e-14, "{l}");
        }
    }
}
