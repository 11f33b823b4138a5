//! Capsules, elastic spheres filled with fluid, in a shear flow and in a tube, against boundary integrals.

mod contrast;
mod meridian;
pub(crate) mod scene;
mod shape;
mod shear;
pub(crate) mod steady;
mod tube;
mod tube_scene;

pub use contrast::capsule_shear_contrast;
pub use shear::{capsule_shear, capsule_volume};
pub use tube::{capsule_tube, capsule_tube_profile};

/// What a membrane is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Material {
    /// Neo-Hookean.
    NeoHookean,
    /// Skalak's, by its area ratio C.
    Skalak(f64),
}
