//! Two relaxation times on any stencil.

use crate::model::Model;
use crate::real::Real;
use crate::stencil::{Stencil, each_pair, moments};
use std::marker::PhantomData;

/// Two-relaxation-time collision (Ginzburg, Verhaeghe and d'Humieres 2008) with Guo's force on any stencil, BGK where both rates
/// are one.
///
/// With `s = f_i + f_-i`, `d = f_i - f_-i`, `u = sum c f + F/2`:
/// `f_i* = (1 - w+)/2 s + (1 - w-)/2 d + w_i [w+ (rho + 4.5 (c.u)^2 - 1.5 u^2) + (1 - w+/2) (9 (c.u)(c.F) - 3 u.F)
/// + 3 w- c.u + 3 (1 - w-/2) c.F]`, and the terms in `c` change sign for `-i`.
#[derive(Clone, Debug)]
pub struct TwoRates<S> {
    even: f64,
    odd: f64,
    second: f64,
    stencil: PhantomData<S>,
}

impl<S> TwoRates<S> {
    /// With the rates (per step) of the even moments, `1/tau`, and of the odd ones; with or without the terms of second order in
    /// velocity and force.
    pub fn new(even: f64, odd: f64, inertia: bool) -> Self {
        Self {
            even,
            odd,
            second: f64::from(u8::from(inertia)),
            stencil: PhantomData,
        }
    }
}

/// Whether a stencil moves along an axis.
const fn moves<S: Stencil<Q>, const Q: usize>(axis: usize) -> bool {
    let mut i = 0;
    while i < Q {
        if S::C[i][axis] != 0 {
            return true;
        }
        i += 1;
    }
    false
}

/// `a . b`.
#[inline(always)]
fn dot<V: Real>(a: &[V; 3], b: &[V; 3]) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// `c . v` for a velocity that is known when this is compiled.
#[inline(always)]
fn along<V: Real>(c: [i32; 3], v: &[V; 3]) -> V {
    let mut sum: Option<V> = None;
    for a in 0..3 {
        sum = match (c[a], sum) {
            (1, None) => Some(v[a]),
            (-1, None) => Some(-v[a]),
            (1, Some(s)) => Some(s + v[a]),
            (-1, Some(s)) => Some(s - v[a]),
            (_, s) => s,
        };
    }
    sum.unwrap_or(v[0].like(0.0))
}

impl<S: Stencil<Q> + Clone + Send + Sync, const Q: usize> Model<Q> for TwoRates<S> {
    type Stencil = S;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; Q], force: [V; 3]) -> [V; 3] {
        let one = f[0];
        let (density, momentum) = moments::<S, V, Q>(f);
        let half = one.like(0.5);
        let mut force = force;
        let mut u = momentum;
        if FORCE {
            for a in 0..3 {
                if !const { [moves::<S, Q>(0), moves::<S, Q>(1), moves::<S, Q>(2)] }[a] {
                    force[a] = one.like(0.0);
                }
                u[a] = force[a].mul_add(half, u[a]);
            }
        }
        let mut e = dot(&u, &u).neg_mul_add(one.like(self.second * 1.5 * self.even), density * one.like(self.even));
        let (mut a, mut b) = (u, u);
        for i in 0..3 {
            a[i] = u[i] * one.like(self.second * 4.5 * self.even);
            b[i] = u[i] * one.like(3.0 * self.odd);
        }
        if FORCE {
            let source = self.second * (1.0 - 0.5 * self.even);
            e = dot(&u, &force).neg_mul_add(one.like(3.0 * source), e);
            for i in 0..3 {
                a[i] = force[i].mul_add(one.like(9.0 * source), a[i]);
                b[i] = force[i].mul_add(one.like(3.0 * (1.0 - 0.5 * self.odd)), b[i]);
            }
        }
        f[0] = f[0].mul_add(one.like(1.0 - self.even), e * one.like(S::W[0]));
        let (keep_even, keep_odd) = (one.like(0.5 * (1.0 - self.even)), one.like(0.5 * (1.0 - self.odd)));
        each_pair!(Q, i, {
            let (c, w) = (S::C[i], one.like(S::W[i]));
            let (s, d) = (f[i] + f[i + 1], f[i] - f[i + 1]);
            let plus = s.mul_add(keep_even, w * along(c, &a).mul_add(along(c, &u), e));
            let minus = d.mul_add(keep_odd, w * along(c, &b));
            (f[i], f[i + 1]) = (plus + minus, plus - minus);
        });
        momentum
    }
}
