//! Bodies in the fluid.

use crate::{Rigid, Soa3, Soa3Mut, Soa3Ref, StateError, StateReader, StateWriter};
use std::any::Any;

/// How the nodes of a body move.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Motion {
    /// Carried by the fluid: no slip.
    Advected,
    /// Newton's equation for each node, pulled along by friction against the fluid (the paper's coupling).
    Newton {
        /// Mass of a node, kg.
        node_mass: f64,
        /// Friction of a node against the fluid, kg/s.
        friction: f64,
    },
    /// Velocity is force over friction, without a fluid.
    Overdamped {
        /// Friction of a node, kg/s.
        friction: f64,
    },
    /// Held where it is; the fluid does not feel it.
    Frozen,
    /// As one piece with six degrees of freedom, no slip at its surface: [`ImmersedBody::rigid`].
    Rigid,
}

/// A body made of nodes and triangles, with its own internal forces.
pub trait ImmersedBody: Any + Send + Sync {
    /// What it is, for reports and tables.
    fn kind(&self) -> &str;

    /// Its nodes at rest about the origin, m.
    fn reference(&self) -> Soa3Ref<'_>;

    /// Its triangles, outward by the right hand; empty for a body of separate nodes.
    fn triangles(&self) -> &[[u32; 3]];

    /// How its nodes move.
    fn motion(&self) -> Motion {
        Motion::Advected
    }

    /// Adds its internal forces (N) at node positions `x` (m) and velocities `v` (m/s), on its own range. Not asked of rigid
    /// bodies.
    fn add_internal_forces(&mut self, x: Soa3Ref<'_>, v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>);

    /// Moves its nodes (`x`, m), which a step has just carried on, to where a constraint of its own holds, such as that of a
    /// constant volume. By default there is none. Not asked of rigid and frozen bodies.
    fn constrain(&mut self, _x: &mut Soa3Mut<'_>) {}

    /// Viscosity of the fluid inside of it over that of the fluid around, where it has one of its own.
    fn viscosity_ratio(&self) -> Option<f64> {
        None
    }

    /// Moves what its forces remember on by `time_step` (s), at whose end its nodes are at `x` (m). Called once a step, after
    /// the nodes have moved; not of rigid bodies. By default it remembers nothing.
    fn advance(&mut self, _x: Soa3Ref<'_>, _time_step: f64) {}

    /// Mass and drive of a body that moves as [`Motion::Rigid`].
    fn rigid(&self) -> Option<Rigid> {
        None
    }

    /// Where a rigid body at rest meets the fluid: points about `spacing` (m) apart on its surface shrunk by the factor
    /// `scale` about the origin. By default its nodes.
    fn markers(&self, _spacing: f64, scale: f64) -> Soa3 {
        self.reference().iter().map(|p| p * scale).collect()
    }

    /// Writes what it remembers from step to step beside the positions and velocities of its nodes, for
    /// [`crate::Scene::save`]. By default that is nothing.
    fn save(&self, _to: &mut StateWriter) {}

    /// Takes what [`ImmersedBody::save`] has written.
    ///
    /// # Errors
    /// [`StateError`].
    fn restore(&mut self, _from: &mut StateReader<'_>) -> Result<(), StateError> {
        Ok(())
    }

    /// Elastic energy at node positions `x` (m), J, where all of its laws have one.
    fn energy(&self, _x: Soa3Ref<'_>) -> Option<f64> {
        None
    }
}

/// Enclosed volume of a closed triangle mesh, m3.
pub fn enclosed_volume(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> f64 {
    let Some(first) = triangles.first() else {
        return 0.0;
    };
    let origin = x.get(first[0] as usize);
    let six: f64 = triangles
        .iter()
        .map(|&[a, b, c]| {
            let (a, b, c) = (
                x.get(a as usize) - origin,
                x.get(b as usize) - origin,
                x.get(c as usize) - origin,
            );
            a.dot(&b.cross(&c))
        })
        .sum();
    six / 6.0
}

/// Area of a triangle mesh, m2.
pub fn surface_area(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> f64 {
    triangles
        .iter()
        .map(|&[a, b, c]| {
            let a = x.get(a as usize);
            0.5 * (x.get(b as usize) - a).cross(&(x.get(c as usize) - a)).norm()
        })
        .sum()
}
