//! Membrane laws: internal forces of a triangulated cell.
//!
//! Two forms of the paper's four moduli. `Paper2011`: the formulas of the software that the paper used (ESPResSo 3.x of
//! 2011 and 2012, after Dupin et al., Phys. Rev. E 75, 066707, 2007): [`Stretching`], [`Bending2011`], [`Area2011`] and
//! [`Volume`]. `Corrected`: [`Stretching`] and [`Volume`] as they are, for they derive from an energy, with
//! [`Bending`], [`LocalArea`] and [`GlobalArea`], the gradients of energies with the same response at small strain.
//!
//! Beside them stand laws of the physics of cells: [`NeoHookean`] and [`Skalak`] membranes with a strain energy in
//! their plane, shear as a network of [`WormLikeChain`]s, bending as [`KantorNelson`] or [`Helfrich`], the
//! [`CorticalTension`] of a leucocyte with the [`Pressure`] that it makes, and the viscosity of the membrane
//! ([`Viscosity`], and [`Maxwell`] for explicit steps).
//!
//! | law | net force | net torque | energy |
//! |---|---|---|---|
//! | [`Stretching`], [`Bending`], [`LocalArea`], [`GlobalArea`], [`Volume`], [`FourModuli`] | 0 | 0 | yes |
//! | [`NeoHookean`], [`Skalak`], [`WormLikeChain`], [`KantorNelson`], [`Helfrich`] | 0 | 0 | yes |
//! | [`CorticalTension`], [`Pressure`] | 0 | 0 | yes |
//! | [`Viscosity`], [`Maxwell`] | 0 | 0 | no, they take power |
//! | [`Bending2011`] | 0 | not 0 | no |
//! | [`Area2011`] | not 0 | not 0 | no |
//! | [`Balanced`] | 0 | 0 | no |

mod area;
mod area_2011;
mod balanced;
mod batch;
mod bending;
mod bending_2011;
mod cortical;
mod edges;
mod elements;
mod four_moduli;
mod helfrich;
mod hinge;
mod hyperelastic;
mod kantor_nelson;
mod maxwell;
mod neo_hookean;
mod pressure;
mod rigid;
mod shell;
mod skalak;
mod stretching;
mod triangles;
mod viscosity;
mod volume;
mod worm_like_chain;

pub use area::{GlobalArea, LocalArea};
pub use area_2011::{Area2011, Reach};
pub use balanced::Balanced;
pub use bending::Bending;
pub use bending_2011::Bending2011;
pub use cortical::CorticalTension;
pub use four_moduli::FourModuli;
pub use helfrich::Helfrich;
pub use kantor_nelson::KantorNelson;
pub use maxwell::Maxwell;
pub use neo_hookean::NeoHookean;
pub use pressure::Pressure;
pub use skalak::Skalak;
pub use stretching::Stretching;
pub use viscosity::Viscosity;
pub use volume::Volume;
pub use worm_like_chain::WormLikeChain;

pub(crate) use rigid::take_off;

use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, StateError, StateReader, StateWriter, Vec3};

/// An internal force law of a cell. Implement it to add one of your own:
///
/// ```
/// use lbm_ibm_coupling::{Soa3Mut, Soa3Ref};
/// use lbm_ibm_membrane::{Cell, Form, Law, presets};
///
/// /// Pulls every node towards the plane z = 0, stiffness in N/m.
/// #[derive(Clone)]
/// struct Flatten(f64);
///
/// impl Law for Flatten {
///     fn name(&self) -> &str {
///         "flatten"
///     }
///     fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
///         for (f, z) in force.z.iter_mut().zip(x.z) {
///             *f -= self.0 * z;
///         }
///     }
/// }
/// let cell = presets::rbc_paper(Form::Corrected)?.with_law(Flatten(1e-6));
/// # Ok::<(), lbm_ibm_membrane::MembraneError>(())
/// ```
pub trait Law: BoxedClone + Send + Sync {
    /// What it is called in reports.
    fn name(&self) -> &str;

    /// Adds its forces (N) at node positions `x` (m) and velocities `v` (m/s); all three of the mesh's length.
    fn add_forces(&mut self, x: Soa3Ref<'_>, v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>);

    /// Its energy at node positions `x` (m), J, if it has one; then the forces are minus its gradient.
    fn energy(&self, _x: Soa3Ref<'_>) -> Option<f64> {
        None
    }

    /// Moves what it remembers on by `time_step` (s), at whose end the nodes are at `x` (m). Called once a step, after
    /// the nodes have moved; forces may be asked for at any other positions in between. A law without memory has
    /// nothing to do.
    fn advance(&mut self, _x: Soa3Ref<'_>, _time_step: f64) {}

    /// Writes what it remembers, for [`lbm_ibm_coupling::Scene::save`]. A law without memory has nothing to write.
    fn save(&self, _to: &mut StateWriter) {}

    /// Takes what [`Law::save`] has written.
    ///
    /// # Errors
    /// [`StateError`].
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Ok(())
    }
}

/// Copies a boxed law; every [`Law`] that is `Clone` has it.
pub trait BoxedClone {
    /// A copy in a box.
    fn boxed_clone(&self) -> Box<dyn Law>;
}

impl<T: Law + Clone + 'static> BoxedClone for T {
    fn boxed_clone(&self) -> Box<dyn Law> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Law> {
    fn clone(&self) -> Self {
        // Through the reference, or the box itself would be the law that is copied.
        (**self).boxed_clone()
    }
}

/// The corners of a triangle, m.
#[inline]
pub(crate) fn corners(x: Soa3Ref<'_>, triangle: [u32; 3]) -> [Vec3; 3] {
    // Spelled out: through `map` the array goes by way of memory, at twice the cost of the whole law.
    let [a, b, c] = triangle;
    [x.get(a as usize), x.get(b as usize), x.get(c as usize)]
}

/// Twice the area vector of a triangle, m2: along its outward normal.
#[inline]
pub(crate) fn twice_area([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}
