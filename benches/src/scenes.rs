//! Scenes that cases, tests and timings share: the paper's cells in plasma.

use crate::Fault;
use lbm_ibm::contact::{CellRepulsion, ContactError, SlitChannel, SoftSphere, WallRepulsion};
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Boundary, Grid, Guard, Scene, UM, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Drive, Fluid, LbmError, Pace};
use lbm_ibm::membrane::{Cell, Form, Material, Mesh, Moduli, Sheet, presets};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Density of blood plasma, kg/m3.
const DENSITY: f64 = 1025.0;
/// Its dynamic viscosity, Pa s.
const VISCOSITY: f64 = 1.2e-3;
/// Mean velocity of the paper's channel, m/s.
pub const SPEED: f64 = 460.0 * UM;

/// Blood plasma on a grid, its density times `scale`, the declared scaling of the Reynolds number.
///
/// # Errors
/// What the fluid says of the numbers.
pub fn plasma(grid: Grid, tau: f64, scale: f64) -> Result<Fluid, LbmError> {
    Fluid::new(grid, DENSITY * scale, VISCOSITY, Pace::Tau(tau))
}

/// Runs `work` on a pool of so many threads.
///
/// # Errors
/// Those of the pool and of the work.
pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> Result<T, Fault> + Send) -> Result<T, Fault> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?
        .install(work)
}

/// Gives the whole program one thread.
///
/// # Errors
/// There is a pool already.
pub fn one_thread() -> Result<(), rayon::ThreadPoolBuildError> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()
}

/// Does `work` on every item, as many at a time as there are cores, each on one thread; results in the order of the items,
/// with the seconds of each.
///
/// # Errors
/// The first one of the work.
pub fn side_by_side<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> Result<R, Fault> + Sync,
) -> Result<Vec<(R, f64)>, Fault> {
    let next = AtomicUsize::new(0);
    let worker = || -> Result<Vec<(usize, R, f64)>, Fault> {
        let mut done = Vec::new();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(i) else { return Ok(done) };
            let clock = Instant::now();
            let result = on_threads(1, || work(item))?;
            done.push((i, result, clock.elapsed().as_secs_f64()));
        }
    };
    let cores = std::thread::available_parallelism()?.get();
    let mut all = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        let mut all = Vec::new();
        for thread in threads {
            all.extend(thread.join().map_err(|_| "a worker has panicked")??);
        }
        Ok::<_, Fault>(all)
    })?;
    all.sort_by_key(|(i, ..)| *i);
    Ok(all.into_iter().map(|(_, result, seconds)| (result, seconds)).collect())
}

/// A slit 12 um high across a channel of 24 um.
///
/// # Errors
/// None that is expected.
pub fn slit_walls() -> Result<Arc<dyn Boundary>, ContactError> {
    let slit = SlitChannel {
        height: 24.0 * UM,
        gap: 12.0 * UM,
        thickness: 6.0 * UM,
        edge_radius: 1.0 * UM,
        position: 20.0 * UM,
    };
    Ok(Arc::new(slit.walls()?))
}

/// A tumour cell at the mouth of a slit, on a grid of 1 um, fluid, walls and contact included.
///
/// # Errors
/// None that is expected.
pub fn slit() -> Result<Scene, Fault> {
    let grid = Grid::new([40, 24, 20], UM, [true, false, true]);
    let fluid = plasma(grid, 1.0, 80.0)?.with_drive(Drive::flux(0, SPEED))?;
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Default::default()));
    scene.set_walls(slit_walls()?)?;
    let pose = Isometry3::translation(10.6 * UM, 12.0 * UM, 10.0 * UM);
    scene.add_body(presets::ctc_paper(Form::Corrected)?, &pose)?;
    scene.add_field(WallRepulsion::new(slit_walls()?, SoftSphere::paper_wall()));
    Ok(scene)
}

/// A cell in the middle of a channel between plates 1.5 diameters apart, a periodic box of 2 by 2 diameters, driven at
/// the paper's mean velocity. The density is `scale` times the true one.
///
/// # Errors
/// What fluid and exchange say of the numbers.
pub fn channel(cell: Cell, diameter: f64, spacing: f64, time_step: f64, scale: f64) -> Result<Scene, Fault> {
    let cells = |diameters: f64| (diameters * diameter / spacing).round() as usize;
    let shape = [cells(2.0), cells(1.5), cells(2.0)];
    let grid = Grid::new(shape, spacing, [true, false, true]);
    let fluid = Fluid::new(grid, DENSITY * scale, VISCOSITY, Pace::TimeStep(time_step))?;
    let fluid = fluid.with_drive(Drive::flux(0, SPEED))?;
    // A cell without a volume law may lose more than the guard allows by default, and the paper's local area modulus is
    // too small to keep the flow from shearing triangles to slivers.
    let guard = Guard {
        volume: f64::INFINITY,
        triangle: 0.0,
        stretch: f64::INFINITY,
        fold: std::f64::consts::PI,
        ..Guard::default()
    };
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Default::default())).with_guard(guard);
    let middle = Vec3::from(shape.map(|n| 0.5 * n as f64 * spacing));
    scene.add_body(cell, &Isometry3::translation(middle.x, middle.y, middle.z))?;
    Ok(scene)
}

/// Membrane of the spheres of a [`Crowd`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Sphere {
    /// The paper's four moduli.
    #[default]
    Moduli,
    /// Skalak's law and bending, with the shear modulus and bending stiffness of the four moduli's continuum.
    Skalak,
}

/// Elastic spheres of 642 nodes and 8 um in a cube, on a grid of 1 um, under a uniform force.
#[derive(Clone, Copy, Debug)]
pub struct Crowd {
    /// Nodes along each edge of the cube.
    pub size: usize,
    /// Spheres.
    pub count: usize,
    /// How they meet the fluid.
    pub kernel: Kernel,
    /// Their membrane.
    pub law: Sphere,
    /// Whether walls close the cube; else it is periodic.
    pub closed: bool,
    /// Whether spheres repel each other.
    pub contact: bool,
}

impl Crowd {
    /// A periodic cube of `size` um with `count` spheres that repel each other.
    pub fn new(size: usize, count: usize) -> Self {
        Self {
            size,
            count,
            kernel: Kernel::default(),
            law: Sphere::default(),
            closed: false,
            contact: true,
        }
    }

    /// Grid and fluid alone.
    ///
    /// # Errors
    /// None that is expected.
    pub fn fluid(&self) -> Result<Fluid, Fault> {
        let fluid = plasma(Grid::new([self.size; 3], UM, [!self.closed; 3]), 0.9, 80.0)?;
        Ok(fluid.with_drive(Drive::Force(Vec3::x() * 1e3))?)
    }

    /// The shape of each sphere at rest, and its laws.
    ///
    /// # Errors
    /// None that is expected.
    pub fn sphere(&self) -> Result<Cell, Fault> {
        let mesh = Arc::new(Mesh::sphere(4.0 * UM, 642)?);
        Ok(match self.law {
            Sphere::Moduli => {
                let moduli = Moduli::CTC_PAPER.for_edge(1.75 * UM, mesh.mean_edge());
                moduli.cell("sphere", mesh, Form::Corrected)?
            }
            Sphere::Skalak => Material {
                shear: 0.57e-6,
                dilation: 1.71e-6,
                bending: 1.9e-19,
                ..Material::none(Sheet::Skalak)
            }
            .cell("sphere", mesh)?,
        })
    }

    /// Where each sphere is put.
    ///
    /// # Errors
    /// [`Fault`] where the spheres do not fit.
    pub fn poses(&self) -> Result<Vec<Isometry3<f64>>, Fault> {
        let per_edge = (1..).find(|n: &usize| n.pow(3) >= self.count).unwrap_or(1);
        let pitch = self.size as f64 * UM / per_edge as f64;
        if pitch < 9.0 * UM {
            return Err(format!(
                "{} spheres of 8 um do not fit into {} um: use at most {}",
                self.count,
                self.size,
                (self.size / 9).pow(3)
            )
            .into());
        }
        let pose = |i: usize| {
            let at = [i % per_edge, i / per_edge % per_edge, i / (per_edge * per_edge)];
            let [x, y, z] = at.map(|c| (c as f64 + 0.5) * pitch);
            Isometry3::translation(x, y, z)
        };
        Ok((0..self.count).map(pose).collect())
    }

    /// The whole scene.
    ///
    /// # Errors
    /// [`Fault`] where the spheres do not fit.
    pub fn scene(&self) -> Result<Scene, Fault> {
        let poses = self.poses()?;
        let mut scene = Scene::with_fluid(self.fluid()?, DeltaExchange::new(self.kernel));
        let sphere = self.sphere()?;
        for pose in poses {
            scene.add_body(sphere.clone(), &pose)?;
        }
        if self.contact {
            // At the paper's full strength this contact would set the time step, to less than a microsecond.
            scene.add_field(CellRepulsion::new(SoftSphere::paper_cell().scaled(0.01)));
        }
        Ok(scene)
    }
}

/// [`Crowd::new`] as a scene.
///
/// # Errors
/// [`Fault`] where the spheres do not fit.
pub fn crowd(n: usize, count: usize) -> Result<Scene, Fault> {
    Crowd::new(n, count).scene()
}
