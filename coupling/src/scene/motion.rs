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
        let range = body.range.clone();
        match body.motion {
            Motion::Advected => {
                let (to, from) = (on_fluid.slice_mut(range.clone()), loads.node.slice(range));
                to.x.copy_from_slice(from.x);
                to.y.copy_from_slice(from.y);
                to.z.copy_from_slice(from.z);
            }
            Motion::Newton { friction, .. } => {
                for i in range {
                    on_fluid.set(i, (velocity.get(i) - fluid_velocity.get(i)) * friction);
                }
            }
            Motion::Overdamped { .. } | Motion::Frozen | Motion::Rigid => {}
        }
    }
}

/// Moves every node by one step of `dt` (s). Newton's equation by the symplectic Euler rule: first the velocity, then
/// the position with the new velocity.
pub(super) fn advance(bodies: &[BodyInfo], loads: &Loads, fluid_velocity: &Soa3, dt: f64, x: &mut Soa3, v: &mut Soa3) {
    for body in bodies {
        if body.motion == Motion::Advected {
            let (x, v) = (x.slice_mut(body.range.clone()), v.slice_mut(body.range.clone()));
            let u = fluid_velocity.slice(body.range.clone());
            for (x, v, u) in [(x.x, v.x, u.x), (x.y, v.y, u.y), (x.z, v.z, u.z)] {
                v.copy_from_slice(u);
                x.iter_mut().zip(u).for_each(|(x, u)| *x += u * dt);
            }
            continue;
        }
        for i in body.range.clone() {
            let velocity = match body.motion {
                Motion::Newton { node_mass, friction } => {
                    let drag = (fluid_velocity.get(i) - v.get(i)) * friction;
                    v.get(i) + (loads.node.get(i) + drag) * (dt / node_mass)
                }
                Motion::Overdamped { friction } => loads.node.get(i) / friction,
                Motion::Advected | Motion::Frozen | Motion::Rigid => continue,
            };
            v.set(i, velocity);
            x.add(i, velocity * dt);
        }
    }
}
