//! The scene: tube, throat, fluid and capsule.

use super::wall::Throat;
use super::watch::{Passed, Watch};
use crate::Fault;
use crate::validate::capsule::scene::{DENSITY, H, VISCOSITY};
use crate::validate::driven::{TubeBox, force, guard};
use lbm_ibm::contact::{SoftSphere, WallRepulsion};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Guard, Scene, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::membrane::{Cell, Mesh, laws};
use std::f64::consts::PI;
use std::sync::Arc;

/// The narrowest kernel, for the film: once a node is one spacing away from the wall, it reads no solid node. The nodes lie on the
/// surface and slip.
const KERNEL: Kernel = Kernel::TwoPoint;
/// Viscosity times mean velocity in the throat over shear modulus.
const CAPILLARY: f64 = 0.1;
/// Density times mean velocity in the throat times radius of the capsule over viscosity. There is no convective term: it is a
/// measure of how fast momentum diffuses.
const REYNOLDS: f64 = 0.5;
/// Relaxation time.
const TAU: f64 = 1.0;
/// Area ratio C of the Skalak membrane.
const AREA_RATIO: f64 = 1.0;
/// Bending stiffness over shear modulus times squared radius: a membrane without any folds where it is compressed.
const BENDING: f64 = 0.01;
/// Area of the unstressed surface for each node, in squared spacings: edges are a little over a spacing long on every grid, so that what
/// the kernel does between nodes, which shows in the film, falls off with the spacing too. One mesh for all grids gave no order.
pub const NODE_AREA: f64 = 1.0;
/// Radius of the tube, half of the throat's straight part, period, and the place of the capsule at the start before the middle
/// of the throat, in radii of the capsule.
const TUBE: f64 = 2.0;
const HALF: f64 = 1.0;
const PERIOD: f64 = 8.0;
const START: f64 = 3.6;
/// Distance of a node from the wall, in spacings, at which contact begins.
const CONTACT: f64 = 0.5;
/// Way of the throat's mean flow between two looks, in radii of the capsule.
const LOOK: f64 = 0.02;

/// A capsule that is driven through a throat, and how finely it is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Radius of the unstressed capsule over that of the throat.
    pub ratio: f64,
    /// Radius of the throat in spacings.
    pub cells: f64,
    /// Area for each node of its mesh, in squared spacings.
    pub node_area: f64,
}

impl Passage {
    /// Radius of the capsule, m.
    fn radius(&self) -> f64 {
        self.ratio * self.cells * H
    }

    /// Mean velocity in the throat, m/s.
    fn velocity(&self) -> f64 {
        REYNOLDS * VISCOSITY / (DENSITY * self.radius())
    }

    /// The device in its box.
    fn throat(&self, tube: TubeBox) -> Throat {
        let a = self.radius();
        Throat {
            centre: tube.centre(),
            tube: TUBE * a,
            lip: TUBE * a - self.cells * H,
            half: HALF * a,
        }
    }

    /// Tube, throat and fluid, driven at its flux, every section with its own parabola.
    fn device(&self) -> Result<(Scene, Throat), Fault> {
        let a = self.ratio * self.cells;
        let tube = TubeBox::new((PERIOD * a).round() as usize, TUBE * a);
        let throat = self.throat(tube);
        let flux = PI * (self.cells * H).powi(2) * self.velocity();
        let mut fluid = tube.fluid(TAU, flux)?;
        fluid.set_velocity(|x| {
            let radius = throat.radius(x.x);
            let r = (x.y - throat.centre.y).hypot(x.z - throat.centre.z) / radius;
            Vec3::x() * (2.0 * flux / (PI * radius * radius) * (1.0 - r * r).max(0.0))
        });
        let guard = Guard { depth: H, ..guard() };
        let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(KERNEL).with_elastic_slip(true)).with_guard(guard);
        scene.set_walls(Arc::new(throat))?;
        Ok((scene, throat))
    }

    /// Lets the empty device come to rest, puts the capsule into it and drives it through.
    ///
    /// # Errors
    /// What the scene finds.
    pub fn run(&self) -> Result<Passed, Fault> {
        let (mut scene, throat) = self.device()?;
        let (a, velocity) = (self.radius(), self.velocity());
        let diffusion = throat.tube * throat.tube * DENSITY / VISCOSITY;
        let steps = (diffusion / scene.time_step()) as usize;
        for _ in 0..steps {
            scene.step()?;
        }
        let empty = force(&scene);
        let nodes = (4.0 * PI * (a / H).powi(2) / self.node_area) as usize;
        let mesh = Arc::new(Mesh::sphere(a, nodes)?);
        let shear = VISCOSITY * velocity / CAPILLARY;
        let bending = BENDING * shear * a * a;
        let cell = Cell::new("capsule", mesh.clone())
            .with_law(laws::Skalak::new(&mesh, shear, AREA_RATIO)?)
            .with_law(laws::KantorNelson::new(
                &mesh,
                laws::KantorNelson::modulus_for(bending),
            )?)
            .with_constant_volume();
        let start = throat.centre - Vec3::x() * (START * a);
        let id = scene.add_body(cell, &Isometry3::translation(start.x, start.y, start.z))?;
        // A node that is pressed in as deep as it may be feels the membrane's tension on its share of the surface.
        let law = SoftSphere::new(1.0, 1.0, CONTACT * H)?;
        let law = law.scaled(shear * H / law.force(0.5 * CONTACT * H));
        scene.add_field(WallRepulsion::new(Arc::new(throat), law));
        let mut watch = Watch::new(&throat, &mesh, id, [a, velocity]);
        let window = (LOOK * a / (velocity * scene.time_step())).ceil() as usize;
        watch.follow(&mut scene, window, empty)
    }
}
