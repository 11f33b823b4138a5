//! Static stretch: the shape of a cell whose ends are pulled apart, without a fluid.
//!
//! Equal forces act on a patch of nodes at each end, +F along x at the one and -F at the other, as in optical tweezers.
//! The rest shape is found by damped dynamics (FIRE: Bitzek et al., Phys. Rev. Lett. 97, 170201, 2006), which needs forces
//! only: the laws of 2011 have no energy to minimise. They do not keep momentum either, so the net force and torque are
//! taken off all nodes evenly, as the friction of a fluid or a holder would; the residual is what is left.
//!
//! How far to go matters: the last modes to come to rest are the softest, the bending of a red blood cell's cross-section.
//! Stopped at 1e-13 N, the paper's cell is 2 to 7 % too wide and up to 18 % too thin; the default of 1e-15 N is within
//! 0.03 % of 1e-17 N in the axial diameter and 0.4 % in the other two.

mod patch;

pub use patch::{Ends, Patch};

use crate::laws::take_off;
use crate::mesh::extent;
use crate::{Cell, MembraneError};
use lbm_ibm_coupling::{ImmersedBody, Soa3, Soa3Ref, Vec3, enclosed_volume, surface_area};

/// Greatest force (N) left on a node of a cell at rest, unless [`Stretch::with_tolerance`] says otherwise.
pub const TOLERANCE: f64 = 1e-15;
/// Most iterations of one equilibrium, unless [`Stretch::with_iterations`] says otherwise.
pub const ITERATIONS: usize = 30_000;

/// A cell at rest under end forces.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Shape {
    /// End force, N.
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

/// Pulls a copy of `cell` at rest by `force` (N) at each end.
///
/// # Errors
/// [`MembraneError::NoEquilibrium`].
pub fn pull(cell: &Cell, ends: &Ends, force: f64) -> Result<Shape, MembraneError> {
    Stretch::new(cell.clone(), ends.clone()).pull(force)
}

/// A cell held at its ends, which keeps its shape from one force to the next: for a curve of size against force.
#[derive(Clone, Debug)]
pub struct Stretch {
    cell: Cell,
    ends: Ends,
    tolerance: f64,
    iterations: usize,
    time_step: f64,
    x: Soa3,
    v: Soa3,
    f: Soa3,
}

impl Stretch {
    /// A cell at rest, not pulled yet.
    pub fn new(cell: Cell, ends: Ends) -> Self {
        let x: Soa3 = cell.reference().iter().collect();
        let n = x.len();
        let mut stretch = Self {
            cell,
            ends,
            tolerance: TOLERANCE,
            iterations: ITERATIONS,
            time_step: 0.0,
            x,
            v: Soa3::zeros(n),
            f: Soa3::zeros(n),
        };
        stretch.time_step = 1.0 / stretch.stiffness().sqrt();
        stretch
    }

    /// With another greatest force (N) left on a node.
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// With another limit of iterations.
    pub fn with_iterations(mut self, iterations: usize) -> Self {
        self.iterations = iterations;
        self
    }

    /// Node positions now, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.x.view()
    }

    /// Lets the cell come to rest under `force` (N) at each end, from the shape it has.
    ///
    /// # Errors
    /// [`MembraneError::NoEquilibrium`].
    pub fn pull(&mut self, force: f64) -> Result<Shape, MembraneError> {
        const MIXING: f64 = 0.1;
        let n = self.x.len();
        self.v.fill(0.0);
        let (mut mixing, mut step, mut downhill) = (MIXING, 0.2 * self.time_step, 0);
        let (mut residual, mut done) = (f64::INFINITY, 0);
        for iteration in 0..self.iterations {
            let net_force = self.forces(force);
            residual = self
                .f
                .iter()
                .map(|f| f.norm())
                .fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a });
            if residual < self.tolerance {
                return Ok(self.shape(force, residual, net_force, iteration));
            }
            done = iteration + 1;
            if !residual.is_finite() {
                break;
            }
            let dot = |a: &Soa3, b: &Soa3| (0..n).map(|i| a.get(i).dot(&b.get(i))).sum::<f64>();
            let power = dot(&self.f, &self.v);
            if power > 0.0 {
                let ratio = mixing * (dot(&self.v, &self.v) / dot(&self.f, &self.f)).sqrt();
                for i in 0..n {
                    self.v.set(i, self.v.get(i) * (1.0 - mixing) + self.f.get(i) * ratio);
                }
                downhill += 1;
                if downhill > 5 {
                    step = (1.1 * step).min(self.time_step);
                    mixing *= 0.99;
                }
            } else {
                self.v.fill(0.0);
                (mixing, step, downhill) = (MIXING, 0.5 * step, 0);
            }
            for i in 0..n {
                self.v.add(i, self.f.get(i) * step);
                self.x.add(i, self.v.get(i) * step);
            }
        }
        Err(MembraneError::NoEquilibrium {
            force,
            residual,
            tolerance: self.tolerance,
            iterations: done,
        })
    }

    /// Fills in the forces under the end force, free of net force and torque; returns the internal net force, N.
    fn forces(&mut self, force: f64) -> f64 {
        self.f.fill(0.0);
        self.cell
            .add_internal_forces(self.x.view(), self.v.view(), &mut self.f.view_mut());
        let net = self.f.iter().sum::<Vec3>().norm();
        for (nodes, sign) in [(&self.ends.plus, 1.0), (&self.ends.minus, -1.0)] {
            for &i in nodes {
                self.f.x[i as usize] += sign * force / nodes.len() as f64;
            }
        }
        take_off(self.x.view(), &mut self.f);
        net
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
        let rest = self.x.clone();
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
                self.x.set(i, rest.get(i) + p.get(i) * (small / norm));
            }
            self.forces(0.0);
            p = self.f.iter().map(|f| -f / small).collect();
            stiffness = p.iter().map(|p| p.norm_squared()).sum::<f64>().sqrt();
        }
        self.x = rest;
        stiffness
    }
}
