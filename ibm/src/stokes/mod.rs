//! A spectral periodic Stokes flow, and what it tells about kernels and meshes: the measurements behind
//! [`crate::Kernel::marker_radius`] and [`crate::Kernel::hydrodynamic_shift`], and the leak of a mesh.

mod fft;
mod measure;

pub use measure::{Leak, kernel_radius, leak, periodic_radius, sphere_radius, surface_radius};

use fft::Fourier;
use lbm_ibm_coupling::nalgebra::Complex;
use lbm_ibm_coupling::{BRICK_EDGE, BRICK_NODES, Bricks, Grid, Vec3};
use std::f64::consts::PI;

/// Steady Stokes flow in a periodic cube, on a collocated grid, by Fourier series:
/// `u(k) = (1 - k k / k^2) f(k) / (mu k^2)`, no mean flow.
#[derive(Clone, Debug)]
pub struct PeriodicStokes {
    grid: Grid,
    viscosity: f64,
    forward: Fourier,
    backward: Fourier,
}

impl PeriodicStokes {
    /// A cube of `n` nodes of `spacing` (m) along each edge, with dynamic `viscosity` (Pa s). Quick where `n` has small
    /// prime factors.
    pub fn new(n: usize, spacing: f64, viscosity: f64) -> Self {
        Self {
            grid: Grid::new([n; 3], spacing, [true; 3]),
            viscosity,
            forward: Fourier::new(n, -1.0),
            backward: Fourier::new(n, 1.0),
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Edge of the cube, m.
    pub fn length(&self) -> f64 {
        self.grid.shape[0] as f64 * self.grid.spacing
    }

    /// Velocity (m/s) at all nodes, x fastest, under the force (N) at each.
    ///
    /// # Panics
    /// If an array doesn't have one value per node.
    pub fn solve(&self, force: &[Vec<f64>; 3]) -> [Vec<f64>; 3] {
        let n = self.grid.shape[0];
        let mut field: [Vec<Complex<f64>>; 3] = [0, 1, 2].map(|a| {
            assert_eq!(force[a].len(), self.grid.len(), "one force per node");
            let mut f: Vec<_> = force[a].iter().map(|&f| Complex::new(f, 0.0)).collect();
            self.forward.transform_cube(&mut f);
            f
        });
        let wave = |j: usize| 2.0 * PI / self.length() * (j as f64 - if 2 * j < n { 0.0 } else { n as f64 });
        // Force per node to force density, and the scale of the two transforms.
        let scale = 1.0 / (self.grid.spacing.powi(3) * self.grid.len() as f64 * self.viscosity);
        for i in 0..self.grid.len() {
            let k = Vec3::new(wave(i % n), wave(i / n % n), wave(i / (n * n)));
            let square = k.norm_squared();
            let f = [field[0][i], field[1][i], field[2][i]];
            let along = f[0] * k.x + f[1] * k.y + f[2] * k.z;
            for a in 0..3 {
                field[a][i] = match i {
                    0 => Complex::default(),
                    _ => (f[a] - along * (k[a] / square)) * (scale / square),
                };
            }
        }
        field.map(|mut u| {
            self.backward.transform_cube(&mut u);
            u.iter().map(|u| u.re).collect()
        })
    }

    /// The flow under the forces in `bricks`, at all nodes, m/s.
    pub fn respond(&self, bricks: &Bricks) -> [Vec<f64>; 3] {
        let mut force = [0, 1, 2].map(|_| vec![0.0; self.grid.len()]);
        self.for_each_node(bricks, |from, to| {
            for a in 0..3 {
                force[a][to] = bricks.force()[a][from];
            }
        });
        self.solve(&force)
    }

    /// Fills the velocity of the bricks in use from a field at all nodes, m/s.
    pub fn fill(&self, field: &[Vec<f64>; 3], bricks: &mut Bricks) {
        let mut pairs = Vec::new();
        self.for_each_node(bricks, |to, from| pairs.push((to, from)));
        for a in 0..3 {
            for &(to, from) in &pairs {
                bricks.velocity_mut()[a][to] = field[a][from];
            }
        }
    }

    /// Calls `act` with the index in the bricks and on the grid of each node of the bricks in use.
    fn for_each_node(&self, bricks: &Bricks, mut act: impl FnMut(usize, usize)) {
        let n = self.grid.shape[0];
        for slot in 0..bricks.len() {
            let corner = bricks.brick(slot).map(|b| b * BRICK_EDGE);
            for i in 0..BRICK_NODES {
                let [x, y, z] = [
                    corner[0] + i % BRICK_EDGE,
                    corner[1] + i / BRICK_EDGE % BRICK_EDGE,
                    corner[2] + i / (BRICK_EDGE * BRICK_EDGE),
                ];
                if x < n && y < n && z < n {
                    act(slot * BRICK_NODES + i, (z * n + y) * n + x);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_force_drives_a_sine_flow_and_a_gradient_none() {
        let (n, h, mu) = (12, 0.5, 2.0);
        let stokes = PeriodicStokes::new(n, h, mu);
        let k = 2.0 * PI / (n as f64 * h);
        let sine: Vec<f64> = (0..n * n * n).map(|i| (k * h * (i / n % n) as f64).sin()).collect();
        let zero = vec![0.0; n * n * n];
        let along = stokes.solve(&[sine.clone(), zero.clone(), zero.clone()]);
        let across = stokes.solve(&[zero.clone(), sine.clone(), zero]);
        for i in 0..n * n * n {
            let exact = sine[i] / (h * h * h * mu * k * k);
            assert!((along[0][i] - exact).abs() < 1e-13);
            assert!(along[1][i].abs() < 1e-13 && across[1][i].abs() < 1e-13);
        }
    }
}
