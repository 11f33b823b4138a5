//! Capsules, elastic spheres filled with fluid, in a shear flow and in a tube, against boundary integrals.

mod contrast;
mod scene;
mod shape;
mod shear;
mod steady;

pub use contrast::capsule_shear_contrast;
pub use shear::{capsule_shear, capsule_volume};

/// What a membrane is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Material {
    /// Neo-Hookean.
    NeoHookean,
    /// Skalak's, by its area ratio C.
    Skalak(f64),
}
