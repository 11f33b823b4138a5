//! How nodes move, and what they hand to the fluid.

use crate::{BodyInfo, Loads, Motion, Soa3};

/// The force (N) of every node on the fluid: all of it where the fluid carries the node, the friction where the node
/// obeys Newton's equation, none otherwise.
pub(super) fn force_on_fluid(
    bodies: &[BodyInfo],
    loads: &Loads,
    velocity: &Soa3,
    fluid_velocity: &Soa3,
    on_fluid: &mut Soa3,
) {
    for body in bodies {
        for i in body.range.clone() {
            let force = match body.motion {
                Motion::Advected => loads.node.get(i),
                Motion::Newton { friction, .. } => (velocity.get(i) - fluid_velocity.get(i)) * friction,
                Motion::Overdamped { .. } | Motion::Frozen | Motion::Rigid => continue,
            };
            on_fluid.set(i, force);
        }
    }
}

/// Moves every node by one step of `dt` (s). Newton's equation by the symplectic Euler rule: first the velocity, then
/// the position with the new velocity.
pub(super) fn advance(bodies: &[BodyInfo], loads: &Loads, fluid_velocity: &Soa3, dt: f64, x: &mut Soa3, v: &mut Soa3) {
    for body in bodies {
        for i in body.range.clone() {
            let velocity = match body.motion {
                Motion::Advected => fluid_velocity.get(i),
                Motion::Newton { node_mass, friction } => {
                    let drag = (fluid_velocity.get(i) - v.get(i)) * friction;
                    v.get(i) + (loads.node.get(i) + drag) * (dt / node_mass)
                }
                Motion::Overdamped { friction } => loads.node.get(i) / friction,
                Motion::Frozen | Motion::Rigid => continue,
            };
            v.set(i, velocity);
            x.add(i, velocity * dt);
        }
    }
}
