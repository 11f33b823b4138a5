//! Capsules, elastic spheres filled with fluid, in a shear flow and in a tube, against boundary integrals.

mod scene;
mod shape;
mod shear;

pub use shear::capsule_shear;

/// What a membrane is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Material {
    /// Neo-Hookean.
    NeoHookean,
    /// Skalak's, by its area ratio C.
    Skalak(f64),
}
