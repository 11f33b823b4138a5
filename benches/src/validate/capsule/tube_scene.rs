//! A capsule on the axis of a tube.

use super::Material;
use super::meridian::{Meridian, meridian};
use super::scene::{DENSITY, H, VISCOSITY};
use crate::Fault;
use crate::validate::driven::{TubeBox, force, guard, mean_force};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Boundary, Probe, Scene, Soa3, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::membrane::{Cell, Mesh, laws};
use std::f64::consts::PI;
use std::sync::Arc;

/// Relaxation time.
const TAU: f64 = 2.0;
/// Velocity of the frame in mean velocities: a capsule that hardly moves on the grid has a steady flow around it, without the
/// inertia and the compression that a moving one has in a fluid of finite diffusion and speed of sound. Fluid inside walls
/// is at rest and not at the frame's velocity, so that no kernel may reach into the wall.
const FRAME: f64 = 1.25;
/// Greatest radius of the shape that a capsule starts from, in tube radii.
const FITS: f64 = 0.85;
/// Radii of the tube that the mean flow goes between two looks at velocity and pressure.
const LOOK: f64 = 0.5;
/// Changes of the velocity ratio and of the extra pressure between two looks, each over its value, below which they are steady.
const STEADY: [f64; 2] = [2e-4, 1e-3];
/// Area of the capsule for each of its nodes, in squared spacings.
const NODE_AREA: f64 = 1.8;
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
    /// Stiffness of the hinges between its triangles over shear modulus times radius squared.
    pub bending: f64,
    /// Radius of the tube in spacings.
    pub cells: f64,
    /// Period along the axis in radii of the tube.
    pub length: f64,
    /// Way of the mean flow in a step over the tube's radius.
    pub step: f64,
    /// Whether its nodes lie on the surface and slip, else inside of it by the kernel's shift.
    pub slip: bool,
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
    /// Radii of the tube that the mean flow has gone.
    pub way: f64,
    /// What ended the run before it was steady, such as a membrane that folds.
    pub ended_by: Option<String>,
    /// Radius of the tube that the empty flow has, over the one that it was built with.
    pub tube_radius: f64,
    /// Its surface, lengths in radii of the tube.
    pub meridian: Meridian,
}

/// A tube along x whose wall slides.
struct Wall {
    radius: f64,
    centre: Vec3,
    velocity: Vec3,
}

impl Boundary for Wall {
    fn probe(&self, x: Vec3, _t: f64) -> Probe {
        let arm = Vec3::new(0.0, x.y - self.centre.y, x.z - self.centre.z);
        Probe {
            velocity: self.velocity,
            ..Probe::at_rest(
                self.radius - arm.norm(),
                -arm.try_normalize(0.0).unwrap_or_else(Vec3::zeros),
            )
        }
    }
}

impl Tube {
    /// With slip the narrowest kernel errs least.
    fn kernel(&self) -> Kernel {
        if self.slip { Kernel::TwoPoint } else { Kernel::RomaThree }
    }

    /// The fluid of a tube `length` spacings long in the frame that moves with [`FRAME`], and the wall to put around it.
    fn scene(&self, length: usize, flux: f64) -> Result<(Scene, Wall), Fault> {
        let tube = TubeBox::new(length, self.cells);
        let centre = tube.centre();
        let radius = self.cells * H;
        let mean = flux / (PI * radius * radius);
        let wall = Wall {
            radius,
            centre,
            velocity: -Vec3::x() * (FRAME * mean),
        };
        // Every fluid node carries the velocity of the frame.
        let place = |n: usize| (n as f64 + 0.5) * H;
        let nodes = (0..tube.shape[1])
            .flat_map(|j| (0..tube.shape[2]).map(move |k| Vec3::new(centre.x, place(j), place(k))))
            .filter(|x| wall.probe(*x, 0.0).distance > 0.0)
            .count();
        let mut fluid = tube.fluid(TAU, flux - FRAME * mean * nodes as f64 * H * H)?;
        fluid.set_velocity(|x| {
            let r = (x.y - centre.y).hypot(x.z - centre.z) / radius;
            Vec3::x() * (mean * (2.0 * (1.0 - r * r).max(0.0) - FRAME))
        });
        let scene = Scene::with_fluid(fluid, DeltaExchange::new(self.kernel()).with_elastic_slip(self.slip))
            .with_guard(guard());
        Ok((scene, wall))
    }

    /// Radius (m) of the tube by its empty flow: `R^4 = 8 mu Q/(pi f)`.
    fn empty(&self, flux: f64) -> Result<f64, Fault> {
        let (mut scene, wall) = self.scene(4, flux)?;
        scene.set_walls(Arc::new(wall))?;
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
        let built = flux / (PI * (self.cells * H).powi(2));
        let length = (self.length * self.cells).round() as usize;
        let (mut scene, wall) = self.scene(length, flux)?;
        let centre = wall.centre;
        let inset = if self.slip {
            0.0
        } else {
            self.kernel().hydrodynamic_shift() * H
        };
        let size = self.ratio * radius;
        let nodes = (4.0 * PI * (size / H).powi(2) / NODE_AREA) as usize;
        let mesh = Arc::new(Mesh::sphere(size - inset, nodes)?);
        let shear = VISCOSITY * mean / self.capillary;
        let cell = Cell::new("capsule", mesh.clone());
        let mut cell = self.material.around(cell, &mesh, shear)?;
        if self.bending > 0.0 {
            cell = cell.with_law(laws::Bending::new(&mesh, self.bending * shear * size * size)?);
        }
        let pose = Isometry3::translation(centre.x, centre.y, centre.z);
        let id = scene.add_body(cell.with_constant_volume(), &pose)?;
        let narrow = (FITS / self.ratio).min(1.0);
        let start: Soa3 = mesh
            .nodes()
            .iter()
            .map(|x| centre + Vec3::new(x.x / (narrow * narrow), narrow * x.y, narrow * x.z))
            .collect();
        scene.set_body_positions(id, start.view())?;
        scene.set_walls(Arc::new(wall))?;
        let steps = (LOOK / self.step).round() as usize;
        let window = steps as f64 * scene.time_step();
        let mut found = Settled {
            velocity: f64::NAN,
            pressure: f64::NAN,
            drift: [f64::INFINITY; 2],
            way: 0.0,
            ended_by: None,
            tube_radius: radius / (self.cells * H),
            meridian: Meridian::default(),
        };
        for _ in 0..LOOKS {
            let before = scene.positions().mean().x;
            let driving = match mean_force(&mut scene, steps) {
                Ok(force) => force,
                Err(fault) => {
                    found.ended_by = Some(fault.to_string());
                    break;
                }
            };
            let velocity = ((scene.positions().mean().x - before) / window + FRAME * built) / mean;
            let drop = (driving - 8.0 * VISCOSITY * mean / (radius * radius)) * length as f64 * H;
            let pressure = drop * radius / (VISCOSITY * mean);
            found.drift = [velocity / found.velocity - 1.0, pressure / found.pressure - 1.0];
            found.velocity = velocity;
            found.pressure = pressure;
            found.way += steps as f64 * self.step;
            found.meridian = meridian(scene.positions(), mesh.triangles(), centre, inset, radius, H);
            if found.is_steady() {
                break;
            }
        }
        Ok(found)
    }
}

impl Settled {
    /// Whether velocity and pressure have come to rest.
    pub fn is_steady(&self) -> bool {
        self.ended_by.is_none() && self.drift.iter().zip(STEADY).all(|(d, s)| d.abs() <= s)
    }
}
