//! Worm-like chains along the edges.

use super::elements::{Elements, length};
use super::{Law, edges};
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};

/// Extension at rest over the contour length, unless [`WormLikeChain::with_extension`] says otherwise.
const EXTENSION: f64 = 1.0 / 2.2;
/// Power of the repulsion.
const POWER: i32 = 2;

/// A network of worm-like chains with a power-law repulsion along the edges (Fedosov, Caswell and Karniadakis,
/// Biophys. J. 98, 2215, 2010): a spring of length L pulls with a (1/(4 (1 - u)^2) - 1/4 + u) - b/L^2, u = L/Lmax.
///
/// Each spring is at rest at its length L0 in the mesh, with contour length Lmax = L0/u0 (u0 = 1/2.2), which gives b
/// from a. The shear modulus G of a network of equilateral triangles gives a: G = sqrt(3)/4 k with the spring's
/// stiffness at rest k = (a/L0) (u0/(2 (1 - u0)^3) + u0 + 2 g), g = 1/(4 (1 - u0)^2) - 1/4 + u0. It resists dilation
/// with an area modulus of 2 G; local and global area laws add to that.
///
/// F = -dE/dx; keeps force and torque. From the contour length on the force is infinite, which ends a run.
#[derive(Clone, Debug)]
pub struct WormLikeChain {
    springs: Elements<2, 1>,
    stiffness: f64,
    extension: f64,
}

impl WormLikeChain {
    /// Springs at rest on `mesh` that make a membrane of `shear` modulus G in N/m.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, shear: f64) -> Result<Self, MembraneError> {
        Ok(Self {
            springs: Elements::springs(mesh),
            stiffness: 4.0 * positive("the shear modulus", shear)? / 3.0_f64.sqrt(),
            extension: EXTENSION,
        })
    }

    /// The same with another extension u0 at rest over the contour length, between 0 and 1: the nearer to 1, the sooner
    /// the membrane stiffens.
    ///
    /// # Errors
    /// [`MembraneError::OutOfRange`].
    pub fn with_extension(mut self, extension: f64) -> Result<Self, MembraneError> {
        if !(extension > 0.0 && extension < 1.0) {
            return Err(MembraneError::OutOfRange {
                what: "the extension of a worm-like chain at rest over its contour length",
                value: extension,
                low: 0.0,
                high: 1.0,
            });
        }
        self.extension = extension;
        Ok(self)
    }

    /// a/L0 of the springs, N/m, and g.
    fn scale(&self) -> (f64, f64) {
        let u = self.extension;
        let g = chain(u);
        let slope = u * (0.5 / (1.0 - u).powi(3) + 1.0) + f64::from(POWER) * g;
        (self.stiffness / slope, g)
    }
}

/// Pull of a chain over a: 1/(4 (1 - u)^2) - 1/4 + u; infinite from u = 1 on.
#[inline(always)]
fn chain(u: f64) -> f64 {
    let free = (1.0 - u).max(0.0);
    0.25 / (free * free) - 0.25 + u
}

impl Law for WormLikeChain {
    fn name(&self) -> &str {
        "worm-like chains"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let (scale, g) = self.scale();
        let extension = self.extension;
        edges::pull(&self.springs, x, force, |length, rest| {
            let l = length / rest;
            scale * rest * (chain(extension * l) - g / (l * l)) / length
        });
    }

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        let (scale, g) = self.scale();
        let u0 = self.extension;
        // Integral of the chain's pull over u, and that of the repulsion over l.
        let well = |l: f64| {
            let u = u0 * l;
            let free = (1.0 - u).max(0.0);
            (u * u * (3.0 - 2.0 * u) / (4.0 * free)) / u0 + g / l
        };
        let spring = |(ends, [rest]): ([u32; 2], [f64; 1])| {
            let l = length(x, ends) / rest;
            scale * rest * rest * (well(l) - well(1.0))
        };
        Some(self.springs.iter().map(spring).sum())
    }
}
