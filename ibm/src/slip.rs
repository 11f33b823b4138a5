//! The velocity that a kernel smooths away at an elastic surface.
//!
//! Along a surface that bears a tangential force `q` on its area the shear stress of the fluid jumps by `-q`, and its velocity has a kink
//! there. A kernel rounds the kink off when it spreads the force and once more when it reads the velocity: at the surface
//! what is read lags behind by `s h q/mu`, with `s` the first moment of one half of the kernel folded with itself. That is
//! [`crate::Kernel::hydrodynamic_shift`], by which a surface at rest acts larger, and of the first order in the spacing. It is added to the
//! velocity of the nodes. Where the fluid inside does not deform, as in a rigid body or in a drop that is at rest in its frame, a surface
//! moved in by `s h` meets the same velocity; where it does, as in a cell that treads round in its membrane, only this is right.
//!
//! Along the normal velocity has no kink. Power is lost to it at a rate `s h q^2/mu` of area, never gained.
//!
//! With another viscosity inside the force meets a fluid that is of both viscosities over the width of the kernel, and the markers have to
//! sit deeper in the one of more viscosity: see [`Layer`] and [`Parallel`].

mod layer;
mod parallel;

use self::layer::Layer;
use self::parallel::Parallel;
use crate::kernel::Kernel;
use lbm_ibm_coupling::{BodyInfo, ExchangeError, Motion, Soa3, Soa3Mut, Soa3Ref, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A surface that the fluid carries.
#[derive(Clone, Debug)]
struct Body {
    range: Range<usize>,
    triangles: Arc<[[u32; 3]]>,
    /// Slip length over the fluid's viscosity, m/(Pa s).
    ease: f64,
}

/// The slip of the nodes of all elastic surfaces, and their markers where another viscosity is inside.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slip {
    bodies: Vec<Body>,
    /// Area vectors of the nodes, a third of those of the triangles around, m2.
    area: Vec<Vec3>,
    /// Slip velocity of the last forces, m/s.
    velocity: Soa3,
    parallel: Parallel,
}

/// What a fluid does to nodes that slip: its viscosity (Pa s), and that of the bodies with another one inside over it, by number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Viscosities<'a> {
    pub around: f64,
    pub inside: &'a [(u32, f64)],
}

impl Viscosities<'_> {
    fn ratio(&self, body: u32) -> f64 {
        let own = self.inside.iter().find(|(id, _)| *id == body);
        own.map_or(1.0, |(_, ratio)| *ratio)
    }
}

/// Slip length over viscosity, m/(Pa s), of a surface with a fluid of `ratio` times the `viscosity` (Pa s) around inside, on a grid of `spacing` (m).
pub(crate) fn ease(kernel: Kernel, ratio: f64, spacing: f64, viscosity: f64) -> f64 {
    Layer::of(kernel, ratio).slip * spacing / viscosity
}

impl Slip {
    /// Takes the surfaces that the fluid carries.
    ///
    /// # Errors
    /// [`ExchangeError::NoViscosity`].
    pub fn set_bodies(
        &mut self,
        bodies: &[BodyInfo],
        nodes: usize,
        kernel: Kernel,
        spacing: f64,
        viscosity: Viscosities<'_>,
    ) -> Result<(), ExchangeError> {
        self.bodies.clear();
        self.parallel = Parallel::default();
        for s in bodies
            .iter()
            .filter(|b| b.motion == Motion::Advected && !b.triangles.is_empty())
        {
            let around = viscosity.around;
            if !(around.is_finite() && around > 0.0) {
                return Err(ExchangeError::NoViscosity {
                    body: s.id,
                    viscosity: around,
                });
            }
            let layer = Layer::of(kernel, viscosity.ratio(s.id));
            self.bodies.push(Body {
                range: s.range.clone(),
                triangles: s.triangles.clone(),
                ease: layer.slip * spacing / around,
            });
            if layer.depth != 0.0 {
                self.parallel
                    .add(s.id, s.range.clone(), s.triangles.clone(), layer.depth * spacing);
            }
        }
        self.area.resize(nodes, Vec3::zeros());
        self.velocity.resize(nodes);
        self.parallel.resize(nodes);
        Ok(())
    }

    /// Takes the area vectors of nodes at `x` (m); returns where their markers are.
    ///
    /// # Errors
    /// [`ExchangeError::Fold`].
    pub fn place<'a>(&'a mut self, x: Soa3Ref<'a>) -> Result<Soa3Ref<'a>, ExchangeError> {
        for body in &self.bodies {
            areas(x, &body.triangles, body.range.start, &mut self.area);
        }
        self.parallel.place(x)
    }

    /// Takes the forces (N) of the nodes, and returns those of the markers.
    pub fn spread<'a>(&'a mut self, force: Soa3Ref<'a>) -> Soa3Ref<'a> {
        for body in &self.bodies {
            for i in body.range.clone() {
                self.velocity.set(i, slip(self.area[i], force.get(i)) * body.ease);
            }
        }
        self.parallel.spread(force)
    }

    /// Makes velocities (m/s) of the nodes of those of the markers.
    pub fn carry(&mut self, mut velocity: Soa3Mut<'_>) {
        self.parallel.carry(&mut velocity);
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
