//! Thermal fluctuations.

use crate::collide::Places;
use crate::element::Element;
use crate::error::LbmError;
use crate::kernel::Kernel;
use crate::stencil::{MAX_Q, opposite};
use lbm_ibm_coupling::Noise;
use lbm_ibm_coupling::nalgebra::DMatrix;
use std::ops::Range;

/// Boltzmann's constant, J/K.
const BOLTZMANN: f64 = 1.380_649e-23;
/// Greatest thermal velocity of a node, by the speed of sound, at which the fluctuations are small.
const WARMEST: f64 = 0.2;
/// Share of the populations' variance that counts as none.
const NONE: f64 = 1e-12;

/// Noise that keeps a fluid at a temperature.
///
/// In a fluid at rest at temperature T the populations of a node are independent, with variance `w_i mu`, `mu = 3 kT` in lattice
/// units (Duenweg, Schiller and Ladd 2007). Divided by the root of their weights all have the variance `mu`, and streaming and
/// bounce-back, which only move them, keep that. The collision, linear about rest, turns them by a matrix `L` and takes away
/// `mu (1 - L L^T)` of their covariance; noise of just that covariance puts it back, on every moment but mass and momentum. For one
/// relaxation rate w a moment it is the noise of Adhikari et al. (2005), of variance `mu w (2 - w)`.
#[derive(Clone, Debug)]
pub struct Thermal {
    /// K.
    pub temperature: f64,
    pub seed: u64,
    /// Unit of kT, J.
    energy: f64,
    shape: [usize; 3],
    /// What each independent number adds to each population, population by population.
    shares: Vec<f64>,
    modes: usize,
}

impl Thermal {
    /// At `temperature` (K), a unit of energy (J) being that of the lattice.
    ///
    /// # Errors
    /// [`LbmError::NotPositive`], [`LbmError::TooHot`], [`LbmError::NotThermal`].
    pub fn new(
        temperature: f64,
        seed: u64,
        energy: f64,
        shape: [usize; 3],
        kernel: &dyn Kernel,
    ) -> Result<Self, LbmError> {
        if !(temperature.is_finite() && temperature >= 0.0) {
            return Err(LbmError::NotPositive {
                name: "temperature",
                value: temperature,
            });
        }
        let variance = 3.0 * BOLTZMANN * temperature / energy;
        let mach = variance.sqrt();
        if mach > WARMEST {
            return Err(LbmError::TooHot { mach, limit: WARMEST });
        }
        let velocities = kernel.velocities();
        let q = velocities.q();
        let root = |i: usize| velocities.weight(i).sqrt();
        let derivative = kernel.derivative();
        let turn = DMatrix::from_fn(q, q, |i, j| derivative[i * q + j] * root(j) / root(i));
        let lost = DMatrix::identity(q, q) - &turn * turn.transpose();
        let parts = lost.symmetric_eigen();
        let least = parts.eigenvalues.min();
        if least < -1e-9 {
            return Err(LbmError::NotThermal { least });
        }
        let kept: Vec<usize> = (0..q).filter(|m| parts.eigenvalues[*m] > NONE).collect();
        let share =
            |i: usize, m: usize| root(i) * parts.eigenvectors[(i, m)] * (variance * parts.eigenvalues[m]).sqrt();
        Ok(Self {
            temperature,
            seed,
            energy,
            shape,
            shares: (0..q)
                .flat_map(|i| kept.iter().map(move |m| (i, *m)))
                .map(|(i, m)| share(i, m))
                .collect(),
            modes: kept.len(),
        })
    }

    /// The same for another collision.
    ///
    /// # Errors
    /// [`LbmError::NotThermal`].
    pub fn of(&self, kernel: &dyn Kernel) -> Result<Self, LbmError> {
        Self::new(self.temperature, self.seed, self.energy, self.shape, kernel)
    }

    /// Adds to the collided populations of the nodes `run` of row (`j`, `k`).
    ///
    /// # Safety
    /// The places are those of the row, its nodes have collided and not been passed on, and nothing else touches them.
    pub unsafe fn agitate<S: Element>(&self, noise: &Noise, places: &Places, [j, k]: [usize; 2], run: Range<usize>) {
        let mut numbers = [0.0; MAX_Q];
        let numbers = &mut numbers[..self.modes];
        let [nx, ny, _] = self.shape;
        for x in run {
            noise.fill(((k * ny + j) * nx + x) as u64, numbers);
            for (i, shares) in self.shares.chunks_exact(self.modes).enumerate() {
                let more: f64 = shares.iter().zip(&*numbers).map(|(s, n)| s * n).sum();
                let place = places[opposite(i)].cast::<S>().wrapping_add(x);
                // SAFETY: the place is this node's own.
                unsafe { *place = S::near((*place).get() + more) };
            }
        }
    }
}
