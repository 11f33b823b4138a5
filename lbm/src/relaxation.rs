//! Relaxation rates and what follows from them.

use crate::element::Precision;
use crate::isa::InstructionSet;
use crate::kernel::{Kernel, build};
use crate::trt::Trt;

/// How populations relax to equilibrium.
///
/// The equilibrium is the incompressible one (He and Luo 1997), `f_i = w_i (rho + 3 c.u + 4.5 (c.u)^2 - 1.5 u^2)` with
/// momentum `u` at unit reference density, so that a steady flow is free of divergence and a force on the fluid acts on
/// the density that was asked for.
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
}

impl Default for Collision {
    fn default() -> Self {
        Self::Trt { magic: 3.0 / 16.0 }
    }
}

impl Collision {
    /// `(tau+ - 1/2)(tau- - 1/2)`.
    pub fn magic(self, tau: f64) -> f64 {
        match self {
            Self::Bgk => (tau - 0.5).powi(2),
            Self::Trt { magic } => magic,
        }
    }

    /// Relaxation rate of the odd moments.
    pub fn odd_rate(self, tau: f64) -> f64 {
        1.0 / (0.5 + self.magic(tau) / (tau - 0.5))
    }

    /// Slip velocity at a flat wall with halfway bounce-back, `(16 magic - 3)/12`, in units in which the exact flow
    /// between plates `n` nodes apart is `y (n - y)` (Ginzburg and d'Humieres 2003). It is what a channel of `n` cells
    /// has too much (positive) in velocity everywhere; relative to the centre `4/n^2` times as much.
    pub fn wall_slip(self, tau: f64) -> f64 {
        (16.0 * self.magic(tau) - 3.0) / 12.0
    }

    /// The kernel for a relaxation time, with or without the terms of second order in velocity and force. The instruction
    /// set must be available.
    pub(crate) fn kernel(self, tau: f64, inertia: bool, isa: InstructionSet, precision: Precision) -> Box<dyn Kernel> {
        build(Trt::new(self, tau, inertia), isa, precision)
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
