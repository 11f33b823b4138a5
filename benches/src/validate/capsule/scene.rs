//! A capsule between sliding plates.

use super::Material;
use super::shape::{Ellipsoid, ellipsoid};
use crate::Fault;
use crate::validate::driven::guard;
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Elasticity, Grid, Lattice, Plane, Scene, Union, Vec3, enclosed_volume};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Fluid, Pace};
use lbm_ibm::membrane::{Cell, MembraneError, Mesh, laws};
use std::f64::consts::PI;
use std::sync::Arc;

/// Grid spacing, m.
pub const H: f64 = 1e-6;
/// Density of the fluid, kg/m3.
pub const DENSITY: f64 = 1e3;
/// Viscosity of the fluid, Pa s.
pub const VISCOSITY: f64 = 1e-3;
/// Greatest sine of the angle between the plane of shear and the arm of a node that is taken to be in it.
const NEAR_PLANE: f64 = 0.1;
/// Steps between two looks at the nodes that go round.
const LOOK_EVERY: usize = 10;

/// A capsule in a shear flow, and how finely it is computed.
#[derive(Clone, Copy, Debug)]
pub struct Capsule {
    /// Its membrane.
    pub material: Material,
    /// Stiffness of the hinges between its triangles over shear modulus times radius squared.
    pub bending: f64,
    /// Capillary number, viscosity times shear rate times radius over shear modulus (a drop: over tension).
    pub capillary: f64,
    /// Radius in grid spacings.
    pub radius: f64,
    /// Semi-axes at rest over the radius: in the plane of shear, and along the vorticity.
    pub axes: [f64; 3],
    /// Angle of the first one with the flow at the start, degrees.
    pub angle: f64,
    /// Edge of the box in radii: between the plates, along the flow and across.
    pub size: [f64; 3],
    /// Shear rate times time step.
    pub strain_per_step: f64,
    /// Relaxation time of the fluid around.
    pub tau: f64,
    /// Viscosity inside over that around.
    pub ratio: f64,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// How it meets the fluid.
    pub kernel: Kernel,
    /// How far the nodes lie inside the surface that they stand for, in grid spacings.
    pub inset: f64,
    /// Whether the nodes slip by what the kernel takes off the kink of the velocity.
    pub slip: bool,
    /// Whether its volume is held.
    pub holds_volume: bool,
    /// How its forces follow the motion within a step.
    pub elasticity: Elasticity,
}

/// The scene of a [`Capsule`].
pub struct Sheared {
    /// Fluid, plates and capsule.
    pub scene: Scene,
    /// Shear rate, 1/s.
    pub rate: f64,
    /// Radius, m.
    pub radius: f64,
    /// Factor from the mesh to the surface that it stands for.
    pub scale: f64,
    /// Viscosity inside over the one outside.
    pub ratio: f64,
}

impl Capsule {
    /// The cell: its mesh lies inside its surface by the inset.
    fn cell(&self, rate: f64) -> Result<Cell, MembraneError> {
        let radius = self.radius * H;
        let meshed = radius - self.inset * H;
        let mesh = Arc::new(if self.axes == [1.0; 3] {
            Mesh::sphere(meshed, self.nodes)?
        } else {
            Mesh::ellipsoid(Vec3::from(self.axes.map(|a| a * radius - self.inset * H)), self.nodes)?
        });
        let shear = VISCOSITY * rate * radius / self.capillary;
        let cell = Cell::new("capsule", mesh.clone()).with_viscosity_ratio(self.ratio)?;
        let mut cell = self.material.around(cell, &mesh, shear)?;
        if self.bending > 0.0 {
            cell = cell.with_law(laws::Bending::new(&mesh, self.bending * shear * radius * radius)?);
        }
        Ok(if self.holds_volume {
            cell.with_constant_volume()
        } else {
            cell
        })
    }

    /// Puts it in the middle between plates that slide past each other.
    ///
    /// # Errors
    /// What fluid and exchange say of the numbers.
    pub fn sheared(&self) -> Result<Sheared, Fault> {
        let cells = |radii: f64| (radii * self.radius).round() as usize;
        let [x, y, z] = self.size.map(cells);
        // A layer of solid nodes behind each plate.
        let shape = [x, y + 2, z];
        let grid = Grid::new(shape, H, [true; 3]);
        let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(self.tau))?.with_inertia(false);
        let rate = self.strain_per_step / fluid.time_step();
        let middle = Vec3::from(shape.map(|n| 0.5 * n as f64 * H));
        let half = 0.5 * y as f64 * H;
        fluid.set_velocity(|x| Vec3::x() * (rate * (x.y - middle.y)));
        let mut scene =
            Scene::with_fluid(fluid, DeltaExchange::new(self.kernel).with_elastic_slip(self.slip)).with_guard(guard());
        let walls = Union::new()
            .with(Plane::new(Vec3::y() * (middle.y - half), Vec3::y()).with_velocity(-Vec3::x() * (rate * half)))
            .with(Plane::new(Vec3::y() * (middle.y + half), -Vec3::y()).with_velocity(Vec3::x() * (rate * half)));
        scene.set_walls(Arc::new(walls))?;
        scene.set_elasticity(self.elasticity);
        let pose = Isometry3::new(middle, Vec3::z() * self.angle.to_radians());
        scene.add_body(self.cell(rate)?, &pose)?;
        Ok(Sheared {
            scene,
            rate,
            radius: self.radius * H,
            scale: self.radius / (self.radius - self.inset),
            ratio: self.ratio,
        })
    }
}

impl Sheared {
    /// Shear rate times time.
    pub fn strain(&self) -> f64 {
        self.rate * self.scene.time()
    }

    /// Goes on to a strain.
    ///
    /// # Errors
    /// What the scene finds.
    pub fn run_to(&mut self, strain: f64) -> Result<(), Fault> {
        while self.strain() < strain {
            self.scene.step()?;
        }
        Ok(())
    }

    /// Volume of the fluid that is taken to be inside over that of the surface, less one.
    pub fn inside_error(&self) -> f64 {
        match self.scene.inside() {
            Some(inside) if !inside.is_empty() => inside.volume() * H.powi(3) / self.volume() - 1.0,
            _ => 0.0,
        }
    }

    /// Volume, m3.
    pub fn volume(&self) -> f64 {
        enclosed_volume(self.scene.positions(), &self.scene.bodies()[0].triangles)
    }

    /// Its shape now.
    pub fn shape(&self) -> Ellipsoid {
        let info = &self.scene.bodies()[0];
        ellipsoid(self.scene.positions(), &info.triangles)
    }

    /// Mean time in which the nodes near the plane of shear go half way round from now on, times the shear rate, and the
    /// greatest relative error of the volume inside on the way.
    ///
    /// # Errors
    /// What the scene finds.
    pub fn half_turn(&mut self) -> Result<(f64, f64), Fault> {
        let middle = self.scene.positions().mean();
        let near = |x: Vec3| {
            let arm = x - middle;
            arm.z.abs() < NEAR_PLANE * arm.norm()
        };
        let x = self.scene.positions();
        let mut points: Vec<Turning> = (0..x.len())
            .filter(|&i| near(x.get(i)))
            .map(|node| Turning {
                node,
                angle: polar(x.get(node) - middle),
                turned: 0.0,
                end: None,
            })
            .collect();
        let start = self.strain();
        let mut before = start;
        let mut inside = 0.0_f64;
        while points.iter().any(|p| p.end.is_none()) {
            for _ in 0..LOOK_EVERY {
                self.scene.step()?;
            }
            let now = self.strain();
            let middle = self.scene.positions().mean();
            for p in &mut points {
                let angle = polar(self.scene.positions().get(p.node) - middle);
                // The flow turns clockwise.
                let turn = wrapped(p.angle - angle);
                if p.end.is_none() && p.turned + turn >= PI {
                    p.end = Some(before + (now - before) * (PI - p.turned) / turn);
                }
                p.turned += turn;
                p.angle = angle;
            }
            before = now;
            inside = inside.max(self.inside_error().abs());
        }
        let times = points.iter().filter_map(|p| p.end).map(|end| end - start);
        Ok((times.sum::<f64>() / points.len() as f64, inside))
    }
}

/// A node on its way round.
struct Turning {
    node: usize,
    angle: f64,
    /// Angle gone so far.
    turned: f64,
    /// Strain at which it has gone half way.
    end: Option<f64>,
}

fn polar(arm: Vec3) -> f64 {
    arm.y.atan2(arm.x)
}

/// An angle brought into [-pi, pi].
fn wrapped(angle: f64) -> f64 {
    angle - 2.0 * PI * (angle / (2.0 * PI)).round()
}
