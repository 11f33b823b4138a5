//! Fluid of another viscosity inside of cells.

use crate::fluid::{Fluid, LEAST_TAU};
use crate::kernel::Kernel;
use lbm_ibm_coupling::{FluidError, Inside};

/// The nodes inside of cells, and kernels for them.
///
/// A node's relaxation time is that of its viscosity; with two relaxation times the magic number stays, so that a steady flow
/// depends on the ratio of the viscosities and not on the relaxation times. Nodes of one level in a row are collided
/// together, by a kernel of their own: in rows that no cell touches nothing is asked, and the collision itself knows nothing
/// of it.
#[derive(Default)]
pub struct Inner {
    pub inside: Inside,
    /// Of the levels from 1 on.
    pub kernels: Vec<Box<dyn Kernel>>,
}

impl Fluid {
    /// Takes the nodes inside of cells for the next step, and makes the kernels that they need.
    ///
    /// # Errors
    /// [`FluidError::OneViscosity`].
    pub(crate) fn take_inside(&mut self, inside: &Inside) -> Result<(), FluidError> {
        if self.thermal.is_some() && !inside.is_empty() {
            return Err(FluidError::OneViscosity {
                why: "it fluctuates with the noise of one relaxation time; leave the temperature out".to_owned(),
            });
        }
        let known = self.inner.kernels.len() + 1;
        for level in known..inside.level_count() {
            let tau = 0.5 + (self.tau - 0.5) * inside.ratio(level as u16);
            let Some(collision) = self.collision else {
                return Err(FluidError::OneViscosity {
                    why: "its collision model is the user's, made for one relaxation time; use a built-in collision"
                        .to_owned(),
                });
            };
            if tau < LEAST_TAU {
                return Err(FluidError::OneViscosity {
                    why: format!(
                        "the relaxation time inside would be {tau:.5}, below {LEAST_TAU}; use a longer time step"
                    ),
                });
            }
            let kernel = collision.kernel(self.velocity_set, tau, self.inertia, self.isa, self.storage.precision());
            self.inner.kernels.push(kernel);
        }
        self.inner.inside.copy_from(inside);
        Ok(())
    }

    /// Forgets kernels that were made for another collision.
    pub(crate) fn forget_inside(&mut self) {
        self.inner = Inner::default();
    }
}
