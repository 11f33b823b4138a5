//! The velocity that a kernel smooths away at an elastic surface.
//!
//! Along a surface that bears a tangential force `q` on its area the shear of the fluid jumps by `-q/mu`, and its velocity has a kink
//! there. A kernel rounds the kink off when it spreads the force and once more when it reads the velocity: at the surface
//! what is read lags behind by `s h q/mu`, with `s` the first moment of one half of the kernel folded with itself. That is
//! [`crate::Kernel::hydrodynamic_shift`], by which a surface at rest acts larger, and of the first order in the spacing. It is added to the
//! velocity of the nodes. Where the fluid inside does not deform, as in a rigid body or in a drop that is at rest in its frame, a surface
//! moved in by `s h` meets the same velocity; where it does, as in a cell that treads round in its membrane, only this is right.
//!
//! Along the normal velocity has no kink. Power is lost to it at a rate `s h q^2/mu` of area, never gained.

use lbm_ibm_coupling::{BodyInfo, Motion, Soa3, Soa3Mut, Soa3Ref, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A surface that the fluid carries.
#[derive(Clone, Debug)]
struct Body {
    range: Range<usize>,
    triangles: Arc<[[u32; 3]]>,
}

/// The slip of the nodes of all elastic surfaces.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slip {
    /// Slip length over the fluid's viscosity, m/(Pa s).
    ease: f64,
    bodies: Vec<Body>,
    /// Area vectors of the nodes, a third of those of the triangles around, m2.
    area: Vec<Vec3>,
    /// Slip velocity of the last forces, m/s.
    velocity: Soa3,
}

impl Slip {
    /// Takes the surfaces that the fluid carries, whose nodes slip by `ease` (m/(Pa s)) times the tangential force on their area.
    pub fn set_bodies(&mut self, bodies: &[BodyInfo], nodes: usize, ease: f64) {
        self.ease = ease;
        let bodies = bodies.iter().filter(|b| b.motion == Motion::Advected);
        self.bodies = bodies
            .map(|s| Body {
                range: s.range.clone(),
                triangles: s.triangles.clone(),
            })
            .collect();
        self.area.resize(nodes, Vec3::zeros());
        self.velocity.resize(nodes);
    }

    /// Takes the area vectors of nodes at `x` (m).
    pub fn place(&mut self, x: Soa3Ref<'_>) {
        for body in &self.bodies {
            areas(x, &body.triangles, body.range.start, &mut self.area);
        }
    }

    /// Takes the forces (N) of the nodes.
    pub fn spread(&mut self, force: Soa3Ref<'_>) {
        for i in self.bodies.iter().flat_map(|b| b.range.clone()) {
            self.velocity.set(i, slip(self.area[i], force.get(i)) * self.ease);
        }
    }

    /// Adds the slip to the velocities (m/s) of the nodes.
    pub fn carry(&self, mut velocity: Soa3Mut<'_>) {
        for i in self.bodies.iter().flat_map(|b| b.range.clone()) {
            velocity.add(i, self.velocity.get(i));
        }
    }
}

/// Tangential part of a force (N) over the area (m2) whose vector is given; none where there is no area.
fn slip(area: Vec3, force: Vec3) -> Vec3 {
    let square = area.norm_squared();
    if square > 0.0 {
        (force - area * (area.dot(&force) / square)) / square.sqrt()
    } else {
        Vec3::zeros()
    }
}

/// Sets the area vectors of the nodes of a surface, the first of which is `start`.
fn areas(x: Soa3Ref<'_>, triangles: &[[u32; 3]], start: usize, out: &mut [Vec3]) {
    for n in triangles.iter().flatten() {
        out[start + *n as usize] = Vec3::zeros();
    }
    for t in triangles {
        let t = t.map(|n| start + n as usize);
        let [a, b, c] = t.map(|n| x.get(n));
        let share = (b - a).cross(&(c - a)) / 6.0;
        t.iter().for_each(|&n| out[n] += share);
    }
}

/// Slip velocities (m/s) under forces (N) on the nodes of one surface at `x` (m), of `ease` (m/(Pa s)).
pub(crate) fn velocities<'a>(
    x: Soa3Ref<'_>,
    triangles: &[[u32; 3]],
    force: &'a Soa3,
    ease: f64,
) -> impl Iterator<Item = Vec3> + 'a {
    let mut area = vec![Vec3::zeros(); x.len()];
    areas(x, triangles, 0, &mut area);
    (0..force.len()).map(move |i| slip(area[i], force.get(i)) * ease)
}
