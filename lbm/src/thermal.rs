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
        let mut shares = vec![0.0; q * kept.len()];
        for (n, &m) in kept.iter().enumerate() {
            let size = (variance * parts.eigenvalues[m]).sqrt();
            let column: Vec<f64> = (0..q).map(|i| root(i) * parts.eigenvectors[(i, m)] * size).collect();
            // Mass and momentum get nothing: what rounding has left of them is taken out.
            let sum = |along: &dyn Fn(usize) -> f64| (0..q).map(|i| column[i] * along(i)).sum::<f64>();
            let mass = sum(&|_| 1.0);
            let momentum: [f64; 3] = std::array::from_fn(|a| sum(&|i| f64::from(velocities.c(i)[a])));
            for i in 0..q {
                let gained = velocities.weight(i) * (mass + 3.0 * velocities.along(i, momentum));
                shares[i * kept.len() + n] = column[i] - gained;
            }
        }
        Ok(Self {
            temperature,
            seed,
            energy,
            shape,
            shares,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Precision;
    use crate::isa::InstructionSet;
    use crate::relaxation::{Collision, OddRate, VelocitySet};

    /// A collision and its noise leave the covariance `w_i mu` of the populations as it is: each stress has kT/3, shear and normal,
    /// and each moment above its share, whatever its rate.
    #[test]
    fn every_moment_keeps_its_share_of_kt() {
        let central = |odd: OddRate| Collision::CentralMoments { bulk: 1.1, odd };
        for (collision, set) in [
            (Collision::Bgk, VelocitySet::D3Q19),
            (Collision::default(), VelocitySet::D3Q19),
            (Collision::default(), VelocitySet::D2Q9),
            (Collision::Regularised, VelocitySet::D3Q19),
            (Collision::RecursiveRegularised, VelocitySet::D3Q27),
            (central(OddRate::Magic(0.25)), VelocitySet::D3Q27),
            (central(OddRate::Rate(1.0)), VelocitySet::D2Q9),
        ] {
            let kernel = collision.kernel(set, 0.63, true, InstructionSet::Portable, Precision::F64);
            let energy = 1e-17;
            let thermal = Thermal::new(300.0, 1, energy, [1; 3], &*kernel).expect("small");
            let velocities = kernel.velocities();
            let q = velocities.q();
            let variance = 3.0 * BOLTZMANN * 300.0 / energy;
            let covariance = DMatrix::from_fn(q, q, |i, j| if i == j { variance * velocities.weight(i) } else { 0.0 });
            let turn = DMatrix::from_row_slice(q, q, &kernel.derivative());
            let shares = DMatrix::from_row_slice(q, thermal.modes, &thermal.shares);
            let after = &turn * &covariance * turn.transpose() + &shares * shares.transpose();
            assert!((after - &covariance).amax() < 1e-9 * variance, "{collision:?} {set:?}");
            let axes = if set == VelocitySet::D2Q9 { 2 } else { 3 };
            assert_eq!(thermal.modes, q - 1 - axes, "{collision:?} {set:?}");
            // Mass and momentum get nothing.
            for column in shares.column_iter() {
                let moved = |a: usize| -> f64 { (0..q).map(|i| column[i] * f64::from(velocities.c(i)[a])).sum() };
                assert!(column.sum().abs() < 1e-16 && (0..3).all(|a| moved(a).abs() < 1e-16));
            }
            let shear: f64 = (0..q)
                .map(|i| covariance[(i, i)] * f64::from(velocities.c(i)[0] * velocities.c(i)[1]).powi(2))
                .sum();
            assert!((shear / (variance / 9.0) - 1.0).abs() < 1e-12);
        }
    }
}
