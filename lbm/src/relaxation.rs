//! Relaxation rates and what follows from them.

use crate::element::Precision;
use crate::error::LbmError;
use crate::isa::InstructionSet;
use crate::kernel::{Kernel, build, build_lean};
use crate::models::{CentralMoments, Mrt, MrtRates, RecursiveRegularised, Regularised, TwoRates};
use crate::stencil::{D2Q9, D3Q19, D3Q27};
use crate::trt::Trt;

/// The lattice velocities of a fluid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum VelocitySet {
    /// Nineteen in space: the fewest with which flow is isotropic. The default.
    #[default]
    D3Q19,
    /// Twenty-seven in space: 42 % more memory and time than nineteen, and errors that turn with the flow less.
    D3Q27,
    /// Nine in the plane of x and y, for flows that do not change along z: the grid has to be one node thick and periodic
    /// along z. Forces and velocities along z are ignored.
    D2Q9,
}

/// Rate of relaxation of the odd moments above the momentum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum OddRate {
    /// What makes `(tau - 1/2)(1/rate - 1/2)` equal to this number; 3/16 puts a flat wall exactly half way between nodes.
    Magic(f64),
    /// This rate per step, above 0 and below 2; 1 forgets them in every step and is stable at far smaller relaxation times.
    Rate(f64),
}

impl OddRate {
    /// The rate, per step.
    pub fn rate(self, tau: f64) -> f64 {
        match self {
            Self::Magic(magic) => 1.0 / (0.5 + magic / (tau - 0.5)),
            Self::Rate(rate) => rate,
        }
    }

    /// `(tau - 1/2)(1/rate - 1/2)`.
    pub fn magic(self, tau: f64) -> f64 {
        match self {
            Self::Magic(magic) => magic,
            Self::Rate(rate) => (tau - 0.5) * (1.0 / rate - 0.5),
        }
    }
}

/// How populations relax to equilibrium.
///
/// The equilibrium is the incompressible one (He and Luo 1997), `f_i = w_i (rho + 3 c.u + 4.5 (c.u)^2 - 1.5 u^2)` with
/// momentum `u` at unit reference density, so that a steady flow is free of divergence and a force on the fluid acts on
/// the density that was asked for. Collisions in the moving frame have higher orders of `u` besides.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Collision {
    /// One relaxation time (Bhatnagar, Gross and Krook 1954). Walls move with tau: see [`Collision::wall_slip`].
    Bgk,
    /// Two relaxation times (Ginzburg, Verhaeghe and d'Humieres 2008): tau for the even moments, and for the odd ones
    /// what makes `(tau+ - 1/2)(tau- - 1/2)` equal to `magic`.
    Trt {
        /// The magic number; 3/16 puts a flat wall exactly half way between nodes at every tau.
        magic: f64,
    },
    /// Multiple relaxation times on D3Q19 (d'Humieres et al. 2002), tau for the shear stress: [`models::Mrt`](crate::models::Mrt).
    Mrt {
        /// Rate of the energy, per step, above 0 and below 2: the bulk viscosity is `2/9 (1/bulk - 1/2)` in lattice units.
        bulk: f64,
        /// Rate of the fourth-order moments, above 0 and below 2.
        fourth: f64,
        /// Rate of the third-order moments.
        odd: OddRate,
    },
    /// All but density, momentum and stress forgotten in every step (Latt and Chopard 2006):
    /// [`models::Regularised`](crate::models::Regularised).
    Regularised,
    /// The same, higher moments rebuilt from the stress (Malaspinas 2015):
    /// [`models::RecursiveRegularised`](crate::models::RecursiveRegularised).
    RecursiveRegularised,
    /// Relaxation in the frame of the fluid (Geier et al. 2006, De Rosis and Coreixas 2020), tau for the shear stress, all above
    /// third order forgotten in every step: [`models::CentralMoments`](crate::models::CentralMoments).
    CentralMoments {
        /// Rate of the trace of the stress, per step, above 0 and below 2; 1 damps sound.
        bulk: f64,
        /// Rate of the third-order moments.
        odd: OddRate,
    },
}

impl Default for Collision {
    fn default() -> Self {
        Self::Trt { magic: 3.0 / 16.0 }
    }
}

impl Collision {
    /// [`Collision::Mrt`] with walls half way (odd moments at magic number 3/16) and the rates of d'Humieres et al. (2002) for
    /// the others: 1.19 and 1.4.
    pub fn mrt() -> Self {
        Self::Mrt {
            bulk: 1.19,
            fourth: 1.4,
            odd: OddRate::Magic(3.0 / 16.0),
        }
    }

    /// [`Collision::CentralMoments`] with rate 1 for the trace and the third order: the stable choice.
    pub fn central_moments() -> Self {
        Self::CentralMoments {
            bulk: 1.0,
            odd: OddRate::Rate(1.0),
        }
    }

    /// `(tau+ - 1/2)(tau- - 1/2)`: what decides where a flat wall lies.
    pub fn magic(self, tau: f64) -> f64 {
        match self {
            Self::Bgk => (tau - 0.5).powi(2),
            Self::Trt { magic } => magic,
            Self::Mrt { odd, .. } | Self::CentralMoments { odd, .. } => odd.magic(tau),
            Self::Regularised | Self::RecursiveRegularised => OddRate::Rate(1.0).magic(tau),
        }
    }

    /// Relaxation rate of the odd moments.
    pub fn odd_rate(self, tau: f64) -> f64 {
        OddRate::Magic(self.magic(tau)).rate(tau)
    }

    /// Slip velocity at a flat wall with halfway bounce-back, `(16 magic - 3)/12`, in units in which the exact flow
    /// between plates `n` nodes apart is `y (n - y)` (Ginzburg and d'Humieres 2003). It is what a channel of `n` cells
    /// has too much (positive) in velocity everywhere; relative to the centre `4/n^2` times as much.
    pub fn wall_slip(self, tau: f64) -> f64 {
        (16.0 * self.magic(tau) - 3.0) / 12.0
    }

    /// The relaxation time at which shear that oscillates or decays along an axis of the grid is right to fourth order in the spacing; none
    /// where there is none, as for a magic number below 1/8. The least where there are two.
    ///
    /// With `m = (tau+ - 1/2)(tau- - 1/2)` the characteristic equation of a plane shear wave `exp(i k x - s t)`, in lattice units, gives
    /// `s = nu k^2 (1 + 2/3 k^2 (1/8 + (tau - 1/2)^2/2 - m) + O(k^4))` on every velocity set: the errors of space and time cancel at
    /// `(tau - 1/2)^2 = 2 m - 1/4`. That is 0.854 for the default, and 1 for [`Collision::Bgk`]. It is the time step to take where the
    /// layer at an oscillating wall, `sqrt(2 nu/omega)`, is only a few spacings thick.
    ///
    /// ```
    /// # use lbm_ibm_lbm::Collision;
    /// let tau = Collision::default().tau_of_waves();
    /// assert!(tau.is_some_and(|tau| (tau - 0.8536).abs() < 1e-4));
    /// ```
    pub fn tau_of_waves(self) -> Option<f64> {
        let odd = match self {
            Self::Bgk => return Some(1.0),
            Self::Trt { magic } => OddRate::Magic(magic),
            Self::Mrt { odd, .. } | Self::CentralMoments { odd, .. } => odd,
            Self::Regularised | Self::RecursiveRegularised => OddRate::Rate(1.0),
        };
        let square = match odd {
            OddRate::Magic(magic) => 2.0 * magic - 0.25,
            // `(tau - 1/2)^2 - 2 b (tau - 1/2) + 1/4 = 0`; not a number if it has no root.
            OddRate::Rate(rate) => {
                let b = 1.0 / rate - 0.5;
                let root = (b * b - 0.25).sqrt();
                (b - root).powi(2)
            }
        };
        (square > 0.0).then(|| 0.5 + square.sqrt())
    }

    /// Refuses rates with which populations grow, and what the velocities cannot do.
    pub(crate) fn check(self, tau: f64, set: VelocitySet) -> Result<(), LbmError> {
        let inside = |name: &'static str, value: f64| {
            if value > 0.0 && value < 2.0 {
                Ok(())
            } else {
                Err(LbmError::Rate { name, value })
            }
        };
        let magic = self.magic(tau);
        if !(magic.is_finite() && magic > 0.0) {
            return Err(LbmError::NotPositive {
                name: "magic number",
                value: magic,
            });
        }
        match self {
            Self::Mrt { bulk, fourth, odd } => {
                inside("bulk", bulk)?;
                inside("fourth-order", fourth)?;
                inside("odd", odd.rate(tau))?;
            }
            Self::CentralMoments { bulk, odd } => {
                inside("bulk", bulk)?;
                inside("odd", odd.rate(tau))?;
            }
            _ => {}
        }
        match (self, set) {
            (Self::Mrt { .. }, VelocitySet::D3Q27 | VelocitySet::D2Q9) => Err(LbmError::NotOnThisSet {
                collision: "Mrt",
                set: format!("{set:?}"),
            }),
            _ => Ok(()),
        }
    }

    /// The kernel for a relaxation time, with or without the terms of second order in velocity and force. The instruction
    /// set must be available, and the collision have passed [`Collision::check`].
    pub(crate) fn kernel(
        self,
        set: VelocitySet,
        tau: f64,
        inertia: bool,
        isa: InstructionSet,
        precision: Precision,
    ) -> Box<dyn Kernel> {
        use VelocitySet as V;
        let (rate, odd) = (1.0 / tau, self.odd_rate(tau));
        macro_rules! on {
            ($set:expr, $model:ident($($argument:expr),*)) => {
                match $set {
                    V::D3Q19 => build_lean($model::<D3Q19>::new($($argument),*), isa, precision),
                    V::D3Q27 => build_lean($model::<D3Q27>::new($($argument),*), isa, precision),
                    V::D2Q9 => build_lean($model::<D2Q9>::new($($argument),*), isa, precision),
                }
            };
        }
        match (self, set) {
            (Self::Bgk | Self::Trt { .. }, V::D3Q19) => build(Trt::new(self, tau, inertia), isa, precision),
            (Self::Bgk | Self::Trt { .. }, V::D3Q27) => {
                build_lean(TwoRates::<D3Q27>::new(rate, odd, inertia), isa, precision)
            }
            (Self::Bgk | Self::Trt { .. }, V::D2Q9) => {
                build_lean(TwoRates::<D2Q9>::new(rate, odd, inertia), isa, precision)
            }
            (Self::Mrt { bulk, fourth, .. }, _) => {
                let rates = MrtRates {
                    shear: rate,
                    bulk,
                    energy_square: fourth,
                    stress_square: fourth,
                    flux: odd,
                    third: odd,
                };
                build_lean(Mrt::new(rates, inertia), isa, precision)
            }
            (Self::Regularised, set) => on!(set, Regularised(tau, inertia)),
            (Self::RecursiveRegularised, V::D3Q19) => {
                build_lean(RecursiveRegularised::<D3Q19>::new(tau, inertia), isa, precision)
            }
            // On these it is the same as central moments with these rates.
            (Self::RecursiveRegularised, set) => on!(set, CentralMoments(tau, rate, 1.0, inertia)),
            (Self::CentralMoments { bulk, .. }, set) => on!(set, CentralMoments(tau, bulk, odd, inertia)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bgk_is_trt_with_one_rate() {
        for tau in [0.51, 0.8, 3.0] {
            assert!((Collision::Bgk.odd_rate(tau) - 1.0 / tau).abs() < 1e-14);
        }
    }

    #[test]
    fn the_default_magic_number_has_no_slip() {
        assert_eq!(Collision::default().wall_slip(4.0), 0.0);
        assert!((Collision::Bgk.wall_slip(2.0) - 2.75).abs() < 1e-12);
    }
}
