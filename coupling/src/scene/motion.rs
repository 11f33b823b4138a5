//! How nodes move, and what they hand to the fluid.

use super::step::split;
use crate::threads::join;
use crate::{BodyInfo, Loads, Motion, Soa3, Soa3Mut};

/// Nodes per task.
const LEAF: usize = 4096;

/// Where to part `bodies`, which are of many nodes: the number of a body and that of its first node from the first of all.
fn middle(bodies: &[BodyInfo]) -> Option<(usize, usize)> {
    let (first, last) = (bodies.first()?.range.start, bodies.last()?.range.end);
    let half = bodies.len() / 2;
    (last - first > LEAF && half > 0).then(|| (half, bodies[half].range.start - first))
}

/// The force (N) of every node on the fluid: all of it where the fluid carries the node, the friction where the node
/// obeys Newton's equation, none otherwise. `on_fluid` has the nodes of these bodies alone.
pub(super) fn force_on_fluid(
    bodies: &[BodyInfo],
    loads: &Loads,
    velocity: &Soa3,
    fluid_velocity: &Soa3,
    mut on_fluid: Soa3Mut<'_>,
) {
    if let Some((half, node)) = middle(bodies) {
        let (left, right) = split(on_fluid, node);
        join(
            || force_on_fluid(&bodies[..half], loads, velocity, fluid_velocity, left),
            || force_on_fluid(&bodies[half..], loads, velocity, fluid_velocity, right),
        );
        return;
    }
    let first = bodies.first().map_or(0, |b| b.range.start);
    for body in bodies {
        let range = body.range.clone();
        match body.motion {
            Motion::Advected => {
                let from = loads.node.slice(range.clone());
                let to = range.start - first..range.end - first;
                on_fluid.x[to.clone()].copy_from_slice(from.x);
                on_fluid.y[to.clone()].copy_from_slice(from.y);
                on_fluid.z[to].copy_from_slice(from.z);
            }
            Motion::Newton { friction, .. } => {
                for i in range {
                    on_fluid.set(i - first, (velocity.get(i) - fluid_velocity.get(i)) * friction);
                }
            }
            Motion::Overdamped { .. } | Motion::Frozen | Motion::Rigid => {}
        }
    }
}

/// Moves every node by one step of `dt` (s). Newton's equation by the symplectic Euler rule: first the velocity, then
/// the position with the new velocity. `x` and `v` have the nodes of these bodies alone.
pub(super) fn advance(
    bodies: &[BodyInfo],
    loads: &Loads,
    fluid_velocity: &Soa3,
    dt: f64,
    mut x: Soa3Mut<'_>,
    mut v: Soa3Mut<'_>,
) {
    if let Some((half, node)) = middle(bodies) {
        let ((x, x_right), (v, v_right)) = (split(x, node), split(v, node));
        join(
            || advance(&bodies[..half], loads, fluid_velocity, dt, x, v),
            || advance(&bodies[half..], loads, fluid_velocity, dt, x_right, v_right),
        );
        return;
    }
    let first = bodies.first().map_or(0, |b| b.range.start);
    for body in bodies {
        if body.motion == Motion::Advected {
            let own = body.range.start - first..body.range.end - first;
            let u = fluid_velocity.slice(body.range.clone());
            for (x, v, u) in [
                (&mut *x.x, &mut *v.x, u.x),
                (&mut *x.y, &mut *v.y, u.y),
                (&mut *x.z, &mut *v.z, u.z),
            ] {
                v[own.clone()].copy_from_slice(u);
                x[own.clone()].iter_mut().zip(u).for_each(|(x, u)| *x += u * dt);
            }
            continue;
        }
        for i in body.range.clone() {
            let velocity = match body.motion {
                Motion::Newton { node_mass, friction } => {
                    let drag = (fluid_velocity.get(i) - v.get(i - first)) * friction;
                    v.get(i - first) + (loads.node.get(i) + drag) * (dt / node_mass)
                }
                Motion::Overdamped { friction } => loads.node.get(i) / friction,
                Motion::Advected | Motion::Frozen | Motion::Rigid => continue,
            };
            v.set(i - first, velocity);
            x.add(i - first, velocity * dt);
        }
    }
}
