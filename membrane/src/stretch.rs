//! Static stretch: the shape of a cell that is pulled along x, without a fluid.
//!
//! Equal forces act on a patch of nodes at each end, +F along x at the one and -F at the other, as in optical
//! tweezers, or a stress on the surface as in an optical stretcher ([`Load`]). The rest shape is found by damped
//! dynamics ([`Fire`]), which needs forces only: the laws of 2011 have no energy to minimise. They do not keep
//! momentum either, so the net force and torque are taken off all nodes evenly, as the friction of a fluid or a holder
//! would; the residual is what is left.
//!
//! How far to go matters: the last modes to come to rest are the softest, the bending of a red blood cell's
//! cross-section. Stopped at 1e-13 N, the paper's cell is 2 to 7 % too wide and up to 18 % too thin; the default of
//! 1e-15 N is within 0.03 % of 1e-17 N in the axial diameter and 0.4 % in the other two.

mod load;
mod patch;

pub use load::Load;
pub use patch::{Ends, Patch};

use crate::fire::Fire;
use crate::laws::take_off;
use crate::mesh::extent;
use crate::{Cell, MembraneError};
use lbm_ibm_coupling::{ImmersedBody, Soa3, Soa3Ref, Vec3, enclosed_volume, surface_area};

/// Greatest force (N) left on a node of a cell at rest, unless [`Stretch::with_tolerance`] says otherwise.
pub const TOLERANCE: f64 = 1e-15;
/// Most iterations of one equilibrium, unless [`Stretch::with_iterations`] says otherwise.
pub const ITERATIONS: usize = 30_000;

/// A cell at rest under a pull.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// Force on each half, N.
    pub force: f64,
    /// Size along the pull (x), m.
    pub axial: f64,
    /// Size across the pull along y, m: the transverse diameter of a disc in the plane of x and y.
    pub transverse: f64,
    /// Size across the pull along z, m: the thickness of such a disc.
    pub thickness: f64,
    /// Area over the area at rest.
    pub area_ratio: f64,
    /// Volume over the volume at rest.
    pub volume_ratio: f64,
    /// Greatest force left on a node, N.
    pub residual: f64,
    /// Sum of the internal forces (N), zero for laws that keep momentum: it was taken off all nodes evenly.
    pub net_force: f64,
    /// Iterations done.
    pub iterations: usize,
}

/// Pulls a copy of `cell` at rest by `force` (N) on each half.
///
/// # Errors
/// [`MembraneError::NoEquilibrium`].
pub fn pull(cell: &Cell, load: impl Into<Load>, force: f64) -> Result<Shape, MembraneError> {
    Stretch::new(cell.clone(), load).pull(force)
}

/// A cell that is pulled, and keeps its shape from one force to the next: for a curve of size against force.
#[derive(Clone, Debug)]
pub struct Stretch {
    cell: Cell,
    load: Load,
    fire: Fire,
    /// Radius of the sphere of the cell's volume at rest, m.
    radius: f64,
    still: Soa3,
    x: Soa3,
}

impl Stretch {
    /// A cell at rest, not pulled yet.
    pub fn new(cell: Cell, load: impl Into<Load>) -> Self {
        let x: Soa3 = cell.reference().iter().collect();
        let mut stretch = Self {
            load: load.into(),
            fire: Fire {
                tolerance: TOLERANCE,
                iterations: ITERATIONS,
                time_step: 0.0,
            },
            radius: (0.75 / std::f64::consts::PI * cell.mesh().volume()).cbrt(),
            still: Soa3::zeros(x.len()),
            cell,
            x,
        };
        stretch.fire.time_step = 1.0 / stretch.stiffness().sqrt();
        stretch
    }

    /// With another greatest force (N) left on a node.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.fire.tolerance = tolerance;
        self
    }

    /// With another limit of iterations.
    pub fn with_iterations(mut self, iterations: usize) -> Self {
        self.fire.iterations = iterations;
        self
    }

    /// Node positions now, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.x.view()
    }

    /// Lets the cell come to rest under `force` (N) on each half, from the shape it has.
    ///
    /// # Errors
    /// [`MembraneError::NoEquilibrium`].
    pub fn pull(&mut self, force: f64) -> Result<Shape, MembraneError> {
        let Self {
            cell,
            load,
            fire,
            radius,
            still,
            x,
        } = self;
        let mut net_force = 0.0;
        let rest = fire.rest(x, |x, f| {
            net_force = forces(cell, load, force, *radius, x, still.view(), f);
        });
        if rest.settled {
            return Ok(self.shape(force, rest.residual, net_force, rest.iterations - 1));
        }
        Err(MembraneError::NoEquilibrium {
            force,
            residual: rest.residual,
            tolerance: self.fire.tolerance,
            iterations: rest.iterations,
        })
    }

    fn shape(&self, force: f64, residual: f64, net_force: f64, iterations: usize) -> Shape {
        let size = extent(self.x.view());
        let (triangles, mesh) = (self.cell.triangles(), self.cell.mesh());
        Shape {
            force,
            axial: size.x,
            transverse: size.y,
            thickness: size.z,
            area_ratio: surface_area(self.x.view(), triangles) / mesh.area(),
            volume_ratio: enclosed_volume(self.x.view(), triangles) / mesh.volume(),
            residual,
            net_force,
            iterations,
        }
    }

    /// Greatest stiffness of the cell at rest (N/m), by power iteration on differences of forces.
    fn stiffness(&mut self) -> f64 {
        let n = self.x.len();
        let rest = &self.x;
        let (mut moved, mut f) = (rest.clone(), Soa3::zeros(n));
        let small = 1e-6 * extent(rest.view()).max();
        // Any start will do that is not orthogonal to the stiffest mode; radial plus uneven is not.
        let mut p: Soa3 = rest
            .iter()
            .enumerate()
            .map(|(i, x)| x / x.norm().max(small) + Vec3::new(0.3, -0.2, 0.1) * ((7 * i % 11) as f64 - 5.0))
            .collect();
        let mut stiffness = 0.0;
        for _ in 0..40 {
            let norm = p.iter().map(|p| p.norm_squared()).sum::<f64>().sqrt();
            for i in 0..n {
                moved.set(i, rest.get(i) + p.get(i) * (small / norm));
            }
            f.fill(0.0);
            forces(
                &mut self.cell,
                &self.load,
                0.0,
                self.radius,
                moved.view(),
                self.still.view(),
                &mut f,
            );
            p = f.iter().map(|f| -f / small).collect();
            stiffness = p.iter().map(|p| p.norm_squared()).sum::<f64>().sqrt();
        }
        stiffness
    }
}

/// Fills in the forces under a pull, free of net force and torque; returns the internal net force, N.
fn forces(cell: &mut Cell, load: &Load, force: f64, radius: f64, x: Soa3Ref<'_>, v: Soa3Ref<'_>, f: &mut Soa3) -> f64 {
    cell.add_internal_forces(x, v, &mut f.view_mut());
    let net = f.iter().sum::<Vec3>().norm();
    load.add(x, cell.triangles(), force, radius, f);
    take_off(x, f);
    net
}
