//! Many relaxation times.

use crate::model::Model;
use crate::models::basis::{populations19, raw19};
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
/// Each moment `m` becomes `m + s (m_eq - m) + (1 - s/2) m_source` at its rate `s`, equilibrium and source being those of the
/// second-order equilibrium and of Guo's force.
#[derive(Clone, Debug)]
pub struct Mrt {
    rates: MrtRates,
    second: f64,
}

impl Mrt {
    /// With rates, and with or without the terms of second order in velocity and force.
    pub fn new(rates: MrtRates, inertia: bool) -> Self {
        Self {
            rates,
            second: f64::from(u8::from(inertia)),
        }
    }
}

impl Model<19> for Mrt {
    type Stencil = D3Q19;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; 19], force: [V; 3]) -> [V; 3] {
        let all = |value: f64| f[0].like(value);
        let mut raw = raw19(f);
        let momentum = raw.first;
        let [half, second, two_thirds] = [0.5, self.second, 2.0 / 3.0].map(all);
        let u: [V; 3] = if FORCE {
            std::array::from_fn(|a| force[a].mul_add(half, momentum[a]))
        } else {
            momentum
        };
        let v = u.map(|u| u * second);
        // What a moment x of second order in the velocity, x(u, u) at equilibrium, gains at a rate s: with the source 2 x(u, F) it
        // is s (x(u, u) - x) + (2 - s) x(u, F).
        let relax = |rate: f64, moment: V, square: V, power: V| {
            let gain = (square - moment) * all(rate);
            if FORCE {
                power.mul_add(all(2.0 - rate), gain)
            } else {
                gain
            }
        };
        let square: [V; 3] = std::array::from_fn(|a| v[a] * u[a]);
        let power: [V; 3] = if FORCE {
            std::array::from_fn(|a| v[a] * force[a])
        } else {
            square
        };
        let total = |x: &[V; 3]| x[0] + x[1] + x[2];
        let axial = |x: &[V; 3]| (x[0] + x[0]) - (x[1] + x[2]);
        let r = &self.rates;
        // Even moments, of the rest of which the density is taken.
        let [xx, yy, zz, ..] = raw.second;
        let [f_xy, f_xz, f_yz] = raw.fourth;
        let trace = xx + yy + zz - raw.density;
        let planes = f_xy + f_xz + f_yz - raw.density * all(1.0 / 3.0);
        // e is 19 trace, epsilon -16 trace + 21 planes; at equilibrium planes are u u / 2.
        let trace_gain = relax(r.bulk, trace, total(&square), total(&power));
        let epsilon = |trace: V, planes: V| trace.neg_mul_add(all(16.0), planes * all(21.0));
        let [uu, uf] = [total(&square), total(&power)];
        let epsilon_gain = relax(
            r.energy_square,
            epsilon(trace, planes),
            epsilon(uu, uu * half),
            epsilon(uf, uf * half),
        );
        let planes_gain = trace_gain.mul_add(all(16.0), epsilon_gain) * all(1.0 / 21.0);
        // The planes' share of p is `(pi + 2 p) / 3`; at equilibrium pi is -p/2.
        let split = |p: [V; 2]| {
            let [stress, planes] = p;
            planes * all(3.0) - (stress + stress)
        };
        let stress_pair = |stress: V, planes: V, square: V, power: V| {
            let gain = relax(r.shear, stress, square, power);
            let ghost = relax(
                r.stress_square,
                split([stress, planes]),
                -(square * half),
                -(power * half),
            );
            [gain, (gain + gain + ghost) * all(1.0 / 3.0)]
        };
        let [axial_gain, axial_planes] = stress_pair(
            (xx + xx) - (yy + zz),
            f_xy + f_xz - (f_yz + f_yz),
            axial(&square),
            axial(&power),
        );
        let [cross_gain, cross_planes] = stress_pair(yy - zz, f_xy - f_xz, square[1] - square[2], power[1] - power[2]);
        // Back to moments of one axis or plane.
        let [third, sixth] = [1.0 / 3.0, 1.0 / 6.0].map(all);
        let apart = |total: V, axial: V, cross: V| {
            let rest = axial.neg_mul_add(sixth, total * third);
            [
                (total + axial) * third,
                cross.mul_add(half, rest),
                cross.neg_mul_add(half, rest),
            ]
        };
        let gains = apart(trace_gain, axial_gain, cross_gain);
        for a in 0..3 {
            raw.second[a] = raw.second[a] + gains[a];
        }
        // The planes yz, xy, xz stand to their total and differences as the axes do, with the axial one reversed.
        let [yz, xy, xz] = apart(planes_gain, -axial_planes, cross_planes);
        raw.fourth = [f_xy + xy, f_xz + xz, f_yz + yz];
        for (n, [a, b]) in [[0, 1], [0, 2], [1, 2]].into_iter().enumerate() {
            let carried = if FORCE {
                (v[a] * force[b] + v[b] * force[a]) * half
            } else {
                u[b]
            };
            raw.second[3 + n] = raw.second[3 + n] + relax(r.shear, raw.second[3 + n], v[a] * u[b], carried);
        }
        // Odd moments. With d = x y y + x z z, 2/3 u at equilibrium, q is 5 d - 4 j: that j gains all of F and its part of the
        // source alone leaves d as if it had the rate of q.
        for a in 0..3 {
            let [b, c] = [raw.third[2 * a], raw.third[2 * a + 1]];
            let (d, m) = (b + c, b - c);
            let mut gain = u[a].mul_add(two_thirds, -d) * all(r.flux);
            if FORCE {
                gain = force[a].mul_add(all((2.0 - r.flux) / 3.0), gain);
                raw.first[a] = raw.first[a] + force[a];
            }
            let gain = gain * half;
            let other = m * all(-0.5 * r.third);
            raw.third[2 * a] = b + (gain + other);
            raw.third[2 * a + 1] = c + (gain - other);
        }
        populations19(&raw, f);
        momentum
    }
}
