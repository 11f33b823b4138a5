//! Two relaxation times, and BGK as the case where they are one.

use crate::model::Model;
use crate::real::Real;
use crate::relaxation::Collision;
use crate::stencil::{D3Q19, Stencil};

const W_REST: f64 = D3Q19::W[0];
const W_AXIS: f64 = D3Q19::W[1];
const W_DIAGONAL: f64 = D3Q19::W[7];

/// Two-relaxation-time collision on D3Q19 with Guo's force.
///
/// With `s = f_i + f_-i`, `d = f_i - f_-i`, `u = sum c f + F/2`:
/// `f_i* = (1 - w+)/2 s + (1 - w-)/2 d + w_i [w+ (rho + 4.5 (c.u)^2 - 1.5 u^2) + (1 - w+/2) (9 (c.u)(c.F) - 3 u.F)
/// + 3 w- c.u + 3 (1 - w-/2) c.F]`, and the terms in `c` change sign for `-i`. With `A` and `B` linear in `u` and `F`
/// the bracket is `e + (c.A)(c.u) + c.B`.
#[derive(Clone, Debug)]
pub struct Trt {
    rest: f64,
    even: f64,
    odd: f64,
    density: f64,
    speed: f64,
    power: f64,
    even_velocity: f64,
    even_force: f64,
    odd_velocity: f64,
    odd_force: f64,
}

impl Trt {
    /// For a relaxation time, with or without the terms of second order in velocity and force.
    pub fn new(collision: Collision, tau: f64, inertia: bool) -> Self {
        let (even, odd) = (1.0 / tau, collision.odd_rate(tau));
        let second = if inertia { 1.0 } else { 0.0 };
        Self {
            rest: 1.0 - even,
            even: 0.5 * (1.0 - even),
            odd: 0.5 * (1.0 - odd),
            density: even,
            speed: second * 1.5 * even,
            power: second * 3.0 * (1.0 - 0.5 * even),
            even_velocity: second * 4.5 * even * W_DIAGONAL,
            even_force: second * 9.0 * (1.0 - 0.5 * even) * W_DIAGONAL,
            odd_velocity: 3.0 * odd * W_DIAGONAL,
            odd_force: 3.0 * (1.0 - 0.5 * odd) * W_DIAGONAL,
        }
    }
}

impl Model<19> for Trt {
    type Stencil = D3Q19;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; 19], force: [V; 3]) -> [V; 3] {
        let all = |value: f64| f[0].like(value);
        let (rest, even, odd) = (all(self.rest), all(self.even), all(self.odd));
        let (even_velocity, odd_velocity) = (all(self.even_velocity), all(self.odd_velocity));
        let (half, w_rest, w_axis, w_diagonal) = (all(0.5), all(W_REST), all(W_AXIS), all(W_DIAGONAL));
        let (in_density, in_speed, in_power) = (all(self.density), all(self.speed), all(self.power));
        let (even_force, odd_force) = (all(self.even_force), all(self.odd_force));
        let mut s = [f[0]; 9];
        let mut d = [f[0]; 9];
        for p in 0..9 {
            s[p] = f[2 * p + 1] + f[2 * p + 2];
            d[p] = f[2 * p + 1] - f[2 * p + 2];
        }
        let (density, momentum) = moments(f[0], &s, &d);
        let u: [V; 3] = if FORCE {
            std::array::from_fn(|a| force[a].mul_add(half, momentum[a]))
        } else {
            momentum
        };
        let uu = u[0].mul_add(u[0], u[1].mul_add(u[1], u[2] * u[2]));
        let mut e = uu.neg_mul_add(in_speed, density * in_density);
        let (a, b): ([V; 3], [V; 3]) = if FORCE {
            let uf = u[0].mul_add(force[0], u[1].mul_add(force[1], u[2] * force[2]));
            e = uf.neg_mul_add(in_power, e);
            let mix = |kv: V, kf: V| std::array::from_fn(|i| u[i].mul_add(kv, force[i] * kf));
            (mix(even_velocity, even_force), mix(odd_velocity, odd_force))
        } else {
            (u.map(|v| v * even_velocity), u.map(|v| v * odd_velocity))
        };
        let (e_axis, e_diagonal) = (e * w_axis, e * w_diagonal);
        f[0] = f[0].mul_add(rest, e * w_rest);
        let pair = |s: V, d: V, e: V, cu: V, ca: V, cb: V| {
            let plus = ca.mul_add(cu, s.mul_add(even, e));
            let minus = d.mul_add(odd, cb);
            [plus + minus, plus - minus]
        };
        for i in 0..3 {
            [f[2 * i + 1], f[2 * i + 2]] = pair(s[i], d[i], e_axis, u[i], a[i] + a[i], b[i] + b[i]);
        }
        for (p, [i, j]) in [(3, [0, 1]), (5, [0, 2]), (7, [1, 2])] {
            [f[2 * p + 1], f[2 * p + 2]] = pair(s[p], d[p], e_diagonal, u[i] + u[j], a[i] + a[j], b[i] + b[j]);
            let q = p + 1;
            [f[2 * q + 1], f[2 * q + 2]] = pair(s[q], d[q], e_diagonal, u[i] - u[j], a[i] - a[j], b[i] - b[j]);
        }
        momentum
    }
}

/// Density (less 1) and momentum from the sums and differences of the nine opposite pairs.
#[inline(always)]
fn moments<V: Real>(rest: V, s: &[V; 9], d: &[V; 9]) -> (V, [V; 3]) {
    let low = (s[0] + s[1]) + (s[2] + s[3]);
    let high = (s[4] + s[5]) + (s[6] + s[7]);
    let density = (low + high) + (s[8] + rest);
    let x = (d[0] + (d[3] + d[4])) + (d[5] + d[6]);
    let y = (d[1] + (d[3] - d[4])) + (d[7] + d[8]);
    let z = (d[2] + (d[5] - d[6])) + (d[7] - d[8]);
    (density, [x, y, z])
}
