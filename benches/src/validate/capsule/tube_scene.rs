//! A capsule on the axis of a tube.

use super::Material;
use super::meridian::{Meridian, meridian};
use super::scene::{H, VISCOSITY};
use crate::Fault;
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Boundary, Closure, Grid, Guard, Scene, Soa3, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Drive, Fluid, Pace};
use lbm_ibm::membrane::{Cell, Mesh, laws};
use std::f64::consts::PI;
use std::sync::Arc;

/// Kernel of these cases.
const KERNEL: Kernel = Kernel::RomaThree;
/// Density of the fluid, kg/m3.
const DENSITY: f64 = 1e3;
/// Relaxation time.
const TAU: f64 = 2.0;
/// Greatest radius of the shape that a capsule starts from, in tube radii.
const FITS: f64 = 0.85;
/// Radii of the tube that the mean flow goes between two looks at velocity and pressure.
const LOOK: f64 = 0.5;
/// Changes of the velocity ratio and of the extra pressure between two looks, each over its value, below which they are steady.
const STEADY: [f64; 2] = [2e-4, 1e-3];
/// Looks after which a capsule that is not steady is given up.
const LOOKS: usize = 40;

/// A capsule in a tube, and how finely it is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    /// Its membrane.
    pub material: Material,
    /// Radius of the unstressed capsule over that of the tube.
    pub ratio: f64,
    /// Viscosity times mean velocity over shear modulus.
    pub capillary: f64,
    /// Radius of the tube in spacings.
    pub cells: f64,
    /// Period along the axis in radii of the tube.
    pub length: f64,
    /// Way of the mean flow in a step over the tube's radius.
    pub step: f64,
}

/// The steady state of a capsule in a tube.
#[derive(Clone, Debug)]
pub struct Settled {
    /// Velocity over the mean velocity.
    pub velocity: f64,
    /// Extra pressure drop in units of viscosity times mean velocity over the tube's radius.
    pub pressure: f64,
    /// Changes of both between the last two looks, over their values.
    pub drift: [f64; 2],
    /// Whether the drift is below what counts as steady.
    pub is_steady: bool,
    /// Radii of the tube that the mean flow has gone.
    pub way: f64,
    /// Radius of the tube that the empty flow has, over the one that it was built with.
    pub tube_radius: f64,
    /// Its surface, lengths in radii of the tube.
    pub meridian: Meridian,
}

/// A tube along x of `radius` (m).
fn wall(radius: f64, centre: Vec3) -> Arc<dyn Boundary> {
    let distance = move |x: Vec3| radius - (x.y - centre.y).hypot(x.z - centre.z);
    Arc::new(Closure::new(distance, 1e-3 * radius))
}

impl Tube {
    fn shape(&self, length: usize) -> [usize; 3] {
        let across = 2 * (self.cells + 1.5) as usize;
        [length, across, across]
    }

    fn fluid(&self, shape: [usize; 3], flux: f64) -> Result<Fluid, Fault> {
        let superficial = flux / ((shape[1] * shape[2]) as f64 * H * H);
        let fluid = Fluid::new(Grid::new(shape, H, [true; 3]), DENSITY, VISCOSITY, Pace::Tau(TAU))?;
        let mut fluid = fluid.with_inertia(false).with_drive(Drive::flux(0, superficial))?;
        let (radius, middle) = (self.cells * H, 0.5 * shape[1] as f64 * H);
        let fastest = 2.0 * flux / (PI * radius * radius);
        fluid.set_velocity(|x| {
            let r = (x.y - middle).hypot(x.z - middle) / radius;
            Vec3::x() * (fastest * (1.0 - r * r).max(0.0))
        });
        Ok(fluid)
    }

    fn scene(&self, length: usize, flux: f64) -> Result<(Scene, Vec3), Fault> {
        let shape = self.shape(length);
        let centre = Vec3::from(shape.map(|n| 0.5 * n as f64 * H));
        let guard = Guard {
            volume: f64::INFINITY,
            ..Guard::default()
        };
        let mut scene = Scene::with_fluid(self.fluid(shape, flux)?, DeltaExchange::new(KERNEL)).with_guard(guard);
        scene.set_walls(wall(self.cells * H, centre))?;
        Ok((scene, centre))
    }

    /// Radius (m) of the tube by its empty flow: `R^4 = 8 mu Q/(pi f)`.
    fn empty(&self, flux: f64) -> Result<f64, Fault> {
        let (mut scene, _) = self.scene(4, flux)?;
        let diffusion = self.cells * self.cells / ((TAU - 0.5) / 3.0);
        for _ in 0..(2.0 * diffusion) as usize {
            scene.step()?;
        }
        Ok((8.0 * VISCOSITY * flux / (PI * force(&scene))).powf(0.25))
    }

    /// Runs it until velocity and extra pressure are steady.
    ///
    /// # Errors
    /// What the scene finds.
    pub fn settle(&self) -> Result<Settled, Fault> {
        let dt = (TAU - 0.5) / 3.0 * H * H * DENSITY / VISCOSITY;
        let flux = PI * (self.cells * H).powi(2) * self.step * self.cells * H / dt;
        let radius = self.empty(flux)?;
        let mean = flux / (PI * radius * radius);
        let length = (self.length * self.cells).round() as usize;
        let (mut scene, centre) = self.scene(length, flux)?;
        let inset = KERNEL.hydrodynamic_shift() * H;
        let size = self.ratio * radius;
        let nodes = (4.0 * PI * (size / H).powi(2) / 0.9) as usize;
        let mesh = Arc::new(Mesh::sphere(size - inset, nodes)?);
        let shear = VISCOSITY * mean / self.capillary;
        let cell = Cell::new("capsule", mesh.clone());
        let cell = match self.material {
            Material::NeoHookean => cell.with_law(laws::NeoHookean::new(&mesh, shear)?),
            Material::Skalak(ratio) => cell.with_law(laws::Skalak::new(&mesh, shear, ratio)?),
        };
        let pose = Isometry3::translation(centre.x, centre.y, centre.z);
        let id = scene.add_body(cell.with_constant_volume(), &pose)?;
        let narrow = (FITS / self.ratio).min(1.0);
        let start: Soa3 = mesh
            .nodes()
            .iter()
            .map(|x| centre + Vec3::new(x.x / (narrow * narrow), narrow * x.y, narrow * x.z))
            .collect();
        scene.set_body_positions(id, start.view())?;
        let steps = (LOOK / self.step).round() as usize;
        let window = steps as f64 * scene.time_step();
        let mut last: Option<[f64; 2]> = None;
        let mut drift = [f64::INFINITY; 2];
        let mut found = [0.0; 2];
        let mut looks = 0;
        while looks < LOOKS && drift.iter().zip(STEADY).any(|(d, s)| d.abs() > s) {
            let before = scene.positions().mean().x;
            let mut driving = 0.0;
            for _ in 0..steps {
                scene.step()?;
                driving += force(&scene) / steps as f64;
            }
            let velocity = (scene.positions().mean().x - before) / window / mean;
            let drop = (driving - 8.0 * VISCOSITY * mean / (radius * radius)) * length as f64 * H;
            found = [velocity, drop * radius / (VISCOSITY * mean)];
            if let Some(last) = last {
                drift = [0, 1].map(|i| found[i] / last[i] - 1.0);
            }
            last = Some(found);
            looks += 1;
            eprintln!("{:?} {looks} {found:?} {drift:?}", self);
        }
        Ok(Settled {
            velocity: found[0],
            pressure: found[1],
            drift,
            is_steady: drift.iter().zip(STEADY).all(|(d, s)| d.abs() <= s),
            way: looks as f64 * steps as f64 * self.step,
            tube_radius: radius / (self.cells * H),
            meridian: meridian(scene.positions(), mesh.triangles(), centre, inset, radius, H),
        })
    }
}

/// Force density along the axis, N/m3.
fn force(scene: &Scene) -> f64 {
    scene.fluid().map_or(0.0, |f| f.body_force().x)
}
