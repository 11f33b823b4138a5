//! Regularised collisions: of a node only density, momentum and stress are kept.

use crate::model::Model;
use crate::models::basis::Basis;
use crate::models::low::State;
use crate::models::shift::{Central, lattice_second};
use crate::real::Real;
use std::marker::PhantomData;

/// Regularised collision (Latt and Chopard 2006) on any built-in stencil.
///
/// With `P = sum (f_i - f_i^eq) c_i c_i + (u F + F u)/2` the node becomes `f_i* = f_i^eq + (1 - 1/tau) 9/2 w_i (c_i c_i - 1/3) : P +
/// S_i/2`, where `S_i` is Guo's source: all moments but density, momentum and stress are set to equilibrium. Flat walls move with
/// tau, as with [magic number](crate::Collision::magic) `(tau - 1/2)/2`.
pub type Regularised<S> = StressAlone<S, false>;

/// Recursive regularised collision (Malaspinas 2015) on any built-in stencil.
///
/// Like [`Regularised`], but moments of third order and above are those of a Chapman-Enskog expansion: with `a_2` the
/// departure of the stress, that of a Hermite moment with the indices `n` is `1/2 sum_ab a_ab d2(u^n)/du_a du_b`, such as
/// `a_xyy = u_x a_yy + 2 u_y a_xy`; the equilibrium is `u^n` and Guo's source `F . d(u^n)/du`. In a frame that moves with the
/// fluid this sets all central Hermite moments above second order to zero. On D3Q27 and D2Q9 all orders are kept, on D3Q19 the six
/// moments of third order. It stays stable at far higher Reynolds numbers than BGK; flat walls move with tau, as with magic number
/// `(tau - 1/2)/2`. Without inertia it is the same as [`Regularised`].
pub type RecursiveRegularised<S> = StressAlone<S, true>;

/// What [`Regularised`] and [`RecursiveRegularised`] are: the stress relaxes, and moments above it are forgotten on the lattice or in the
/// frame of the fluid.
#[derive(Clone, Debug)]
pub struct StressAlone<S, const RECURSIVE: bool> {
    shear: f64,
    bulk: f64,
    second: f64,
    stencil: PhantomData<S>,
}

impl<S, const RECURSIVE: bool> StressAlone<S, RECURSIVE> {
    /// For a relaxation time (time steps), with or without the terms of second order in velocity and force.
    pub fn new(tau: f64, inertia: bool) -> Self {
        Self {
            shear: 1.0 / tau,
            bulk: 1.0 / tau,
            second: f64::from(u8::from(inertia)),
            stencil: PhantomData,
        }
    }

    /// With a rate of its own (per step) for the trace of the stress: the bulk viscosity in space is `2/9 (1/bulk - 1/2)` in lattice units; 1
    /// damps sound. This is also a collision with many relaxation times of which all but that of the shear stress and this one are 1,
    /// with moments that are orthogonal under the weights.
    pub fn with_bulk(self, bulk: f64) -> Self {
        Self { bulk, ..self }
    }
}

impl<S: Basis<Q>, const RECURSIVE: bool, const Q: usize> Model<Q> for StressAlone<S, RECURSIVE> {
    type Stencil = S;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; Q], force: [V; 3]) -> [V; 3] {
        let (low, _) = S::low(f);
        let mut state = State::new::<FORCE>(&low, force, self.second);
        state.relax_stress(self.shear, self.bulk, S::AXES);
        *f = if RECURSIVE {
            let zero = state.density.like(0.0);
            S::recursive::<V, FORCE>(&Central::new(state, [zero; 7]))
        } else {
            let (momentum, second) = lattice_second::<V, FORCE>(&state.u, &state.v, &state.half, &state.stress);
            S::plain(state.density, momentum, second)
        };
        low.momentum
    }
}
