//! Capsules, elastic spheres filled with fluid, in a shear flow and in a tube, against boundary integrals.

mod contrast;
mod drop;
mod images;
mod keller_skalak;
mod meridian;
pub(crate) mod scene;
pub(super) mod shape;
mod shear;
pub(crate) mod steady;
mod tube;
mod tube_scene;

pub use contrast::capsule_shear_contrast;
pub use drop::drop_shear;
pub use keller_skalak::keller_skalak_period;
pub use shear::{capsule_shear, capsule_volume};
pub use tube::{capsule_tube, capsule_tube_profile};

use lbm_ibm::membrane::{Cell, MembraneError, Mesh, laws};

/// What a membrane is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Material {
    /// Neo-Hookean.
    NeoHookean,
    /// Skalak's, by its area ratio C.
    Skalak(f64),
    /// A surface of constant tension, that of a drop; its capillary number is by that tension.
    Tension,
}

impl Material {
    /// Gives a cell this membrane on its mesh: the shear modulus, for a drop the tension, in N/m.
    fn around(self, cell: Cell, mesh: &Mesh, modulus: f64) -> Result<Cell, MembraneError> {
        Ok(match self {
            Self::NeoHookean => cell.with_law(laws::NeoHookean::new(mesh, modulus)?),
            Self::Skalak(ratio) => cell.with_law(laws::Skalak::new(mesh, modulus, ratio)?),
            // The nodes bear the pressure, 2 T/R, so that the fluid, which yields a little, does not.
            Self::Tension => cell
                .with_law(laws::CorticalTension::new(mesh, modulus)?)
                .with_law(laws::Pressure::new(
                    mesh,
                    modulus * mesh.area() / (1.5 * mesh.volume()),
                )?),
        })
    }
}
