//! Collision in the frame of the fluid.

use crate::model::Model;
use crate::models::basis::Basis;
use crate::models::low::State;
use crate::models::shift::{Central, third_before};
use crate::real::Real;
use std::marker::PhantomData;

/// Relaxation of central moments on any built-in stencil.
///
/// The idea is of Geier, Greiner and Korvink (2006); on D3Q19 see De Rosis and Coreixas (2020). The moments are central
/// Hermite ones (Coreixas, Chopard and Latt 2019), `sum f_i H_n(c_i - u)`: a Maxwellian has none above order 0, and a force
/// adds to order 1 alone. The shear stress relaxes at `1/tau`, its trace and the third order at rates of their own, and the
/// fourth order and above vanishes in every step, which to first order in what departs from equilibrium is the cumulant
/// collision of Geier et al. (2015) with these rates. The equilibrium has all orders in the velocity that the stencil can
/// hold, so that on D3Q27 the viscosity does not depend on the frame but for the error of third order in the velocity.
#[derive(Clone, Debug)]
pub struct CentralMoments<S> {
    shear: f64,
    bulk: f64,
    third: f64,
    second: f64,
    stencil: PhantomData<S>,
}

impl<S> CentralMoments<S> {
    /// For a relaxation time (time steps), the rates (per step) of the trace of the stress and of the moments of third order, and
    /// with or without inertia: without, the frame is at rest.
    pub fn new(tau: f64, bulk: f64, third: f64, inertia: bool) -> Self {
        Self {
            shear: 1.0 / tau,
            bulk,
            third,
            second: f64::from(u8::from(inertia)),
            stencil: PhantomData,
        }
    }
}

impl<S: Basis<Q>, const Q: usize> Model<Q> for CentralMoments<S> {
    type Stencil = S;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; Q], force: [V; 3]) -> [V; 3] {
        let (low, third) = S::low(f);
        let mut state = State::new::<FORCE>(&low, force, self.second);
        let keep = state.density.like(1.0 - self.third);
        let mut third = third_before::<V, FORCE>(&low, &third, &state);
        for t in &mut third {
            *t = *t * keep;
        }
        state.relax_stress(self.shear, self.bulk, S::AXES);
        *f = S::central::<V, FORCE>(&Central::new(state, third));
        low.momentum
    }
}
