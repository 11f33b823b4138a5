//! Many relaxation times.

use crate::model::Model;
use crate::models::basis::{populations19, raw19};
use crate::models::low::{PLANES, State};
use crate::real::Real;
use crate::stencil::D3Q19;

/// Rates of relaxation of the moments of [`Mrt`], per step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MrtRates {
    /// Shear stress: `1/tau`.
    pub shear: f64,
    /// Energy `e`; sets the bulk viscosity `2/9 (1/rate - 1/2)`.
    pub bulk: f64,
    /// Square of the energy, `epsilon`.
    pub energy_square: f64,
    /// Fourth-order companions of the stress, `pi_xx` and `pi_ww`.
    pub stress_square: f64,
    /// Energy flux `q`.
    pub flux: f64,
    /// The antisymmetric moments of third order, `m`.
    pub third: f64,
}

impl MrtRates {
    /// All rates equal: BGK.
    pub fn equal(tau: f64) -> Self {
        let rate = 1.0 / tau;
        Self {
            shear: rate,
            bulk: rate,
            energy_square: rate,
            stress_square: rate,
            flux: rate,
            third: rate,
        }
    }
}

/// Multiple-relaxation-time collision on D3Q19 (d'Humieres et al. 2002), with their orthogonal moments: `e = 19 c^2 - 30`,
/// `epsilon = (21 c^4 - 53 c^2 + 24)/2`, `q_x = (5 c^2 - 9) c_x`, `3 p_xx = 3 c_x^2 - c^2`, `p_ww = c_y^2 - c_z^2`,
/// `pi = (3 c^2 - 5) p`, `m_x = (c_y^2 - c_z^2) c_x`.
///
/// Each moment `m` becomes `m + S - s D` at its rate `s`, with `D = m + S/2 - m_eq` and the source `S`; equilibrium and source are
/// those of the second-order equilibrium and of Guo's force.
///
/// Of the even moments, let `E_a` be the departures `D` of the diagonal stress and `Q_a` those of `c_b^2 c_c^2` in the plane across
/// the axis `a`; `T` and `P` are their sums. The moments above are `T`, `21 P - 16 T` and, of what is left of `E` and `Q` without their
/// sums, `E` and `3 Q + 2 E`. So in a collision `E_a` loses `s_nu E_a + (s_e - s_nu)/3 T` and `Q_a` loses
/// `s_pi Q_a + 2/3 (s_pi - s_nu) E_a + (s_eps - s_pi)/3 P - (2/9 (s_pi - s_nu) + 16/63 (s_eps - s_e)) T`.
#[derive(Clone, Debug)]
pub struct Mrt {
    second: f64,
    shear: f64,
    stress_trace: f64,
    planes: f64,
    planes_stress: f64,
    planes_sum: f64,
    planes_trace: f64,
    third: f64,
    third_other: f64,
    velocity: f64,
    force: f64,
}

impl Mrt {
    /// With rates, and with or without the terms of second order in velocity and force.
    pub fn new(rates: MrtRates, inertia: bool) -> Self {
        let r = rates;
        Self {
            second: f64::from(u8::from(inertia)),
            shear: r.shear,
            stress_trace: (r.bulk - r.shear) / 3.0,
            planes: r.stress_square,
            planes_stress: 2.0 / 3.0 * (r.stress_square - r.shear),
            planes_sum: (r.energy_square - r.stress_square) / 3.0,
            planes_trace: -2.0 / 9.0 * (r.stress_square - r.shear) - 16.0 / 63.0 * (r.energy_square - r.bulk),
            third: 1.0 - 0.5 * (r.flux + r.third),
            third_other: 0.5 * (r.third - r.flux),
            velocity: r.flux / 3.0,
            force: (2.0 - r.flux) / 3.0,
        }
    }
}

impl Model<19> for Mrt {
    type Stencil = D3Q19;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; 19], force: [V; 3]) -> [V; 3] {
        let one = f[0];
        let (one_half, one_third) = (one.like(0.5), one.like(1.0 / 3.0));
        let mut raw = raw19(f);
        let momentum = raw.low.momentum;
        let state = State::new::<FORCE>(&raw.low, force, self.second);
        let (u, v, half) = (state.u, state.v, state.half);
        let [xx, yy, zz, ..] = state.stress;
        let trace = xx + yy + zz;
        // What of the stress comes from the velocity, less half the source, and half the source.
        let (mut carried, mut power) = (u, half);
        for a in 0..3 {
            if FORCE {
                power[a] = v[a] * (half[a] + half[a]);
                carried[a] = v[a].mul_add(u[a], -power[a]);
            } else {
                carried[a] = v[a] * u[a];
            }
        }
        // Those of `c_b^2 c_c^2` see the stress across: 1/3 (xx + yy + zz) - 1/2 aa.
        let offset = (carried[0] + carried[1] + carried[2]).mul_add(one_third, raw.low.density * one.like(1.0 / 9.0));
        let [xy, xz, yz] = raw.fourth;
        let mut planes = [yz, xz, xy];
        for a in 0..3 {
            planes[a] = carried[a].mul_add(one_half, planes[a] - offset);
        }
        let sum = planes[0] + planes[1] + planes[2];
        let common = sum.mul_add(one.like(self.planes_sum), trace * one.like(self.planes_trace));
        let isotropic = trace * one.like(self.stress_trace);
        let source = if FORCE {
            (power[0] + power[1] + power[2]) * one.like(2.0 / 3.0)
        } else {
            one
        };
        for a in 0..3 {
            let stress = state.stress[a];
            let mut second = raw.low.second[a] - stress.mul_add(one.like(self.shear), isotropic);
            let loss = stress.mul_add(
                one.like(self.planes_stress),
                planes[a].mul_add(one.like(self.planes), common),
            );
            let mut fourth = raw.fourth[2 - a] - loss;
            if FORCE {
                second = second + (power[a] + power[a]);
                fourth = fourth + (source - power[a]);
            }
            raw.low.second[a] = second;
            raw.fourth[2 - a] = fourth;
        }
        for (p, [a, b]) in PLANES.into_iter().enumerate() {
            let n = 3 + p;
            raw.low.second[n] = state.stress[n].neg_mul_add(one.like(self.shear), raw.low.second[n]);
            if FORCE {
                raw.low.second[n] = v[a].mul_add(force[b], v[b].mul_add(force[a], raw.low.second[n]));
            }
        }
        // Of `x y y` and `x z z` the sum goes with q, which is 5 times it less 4 momenta, and the difference is m.
        for a in 0..3 {
            let [b, c] = [raw.third[2 * a], raw.third[2 * a + 1]];
            let mut gain = u[a] * one.like(self.velocity);
            if FORCE {
                gain = half[a].mul_add(one.like(self.force), gain);
                raw.low.momentum[a] = raw.low.momentum[a] + force[a];
            }
            let (keep, mix) = (one.like(self.third), one.like(self.third_other));
            raw.third[2 * a] = b.mul_add(keep, c.mul_add(mix, gain));
            raw.third[2 * a + 1] = c.mul_add(keep, b.mul_add(mix, gain));
        }
        populations19(&raw, f);
        momentum
    }
}
