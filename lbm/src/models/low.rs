//! Moments of a node up to third order, and what departs from equilibrium in them.

use crate::real::Real;

/// Raw moments `sum f c c..` of populations less their weights, to second order.
#[derive(Clone, Copy)]
pub struct Low<V> {
    /// Density, about 1, less 1.
    pub density: V,
    pub momentum: [V; 3],
    /// xx, yy, zz, xy, xz, yz.
    pub second: [V; 6],
}

/// Moments of third order: xyy, xzz, yxx, yzz, zxx, zyy, xyz.
pub type Third<V> = [V; 7];

/// Axes of the moments of second order off the diagonal, by place less 3.
pub const PLANES: [[usize; 2]; 3] = [[0, 1], [0, 2], [1, 2]];

/// The moments of third order `a b b`: a, b, and the place of `ab` among those of second order.
pub const THIRDS: [[usize; 3]; 6] = [[0, 1, 3], [0, 2, 4], [1, 0, 3], [1, 2, 5], [2, 0, 4], [2, 1, 5]];

/// A node before collision.
pub struct State<V> {
    pub density: V,
    /// Velocity: momentum with half the force.
    pub u: [V; 3],
    /// The velocity of the terms of second order and above: zero in a Stokes flow.
    pub v: [V; 3],
    /// Half the force.
    pub half: [V; 3],
    /// Departure of the stress from equilibrium, `sum f c c - rho/3 - u u + (u F + F u)/2`: the central moments of second
    /// order less 1/3, at unit reference density.
    pub stress: [V; 6],
}

impl<V: Real> State<V> {
    /// From the moments; `second` is 1, or 0 in a Stokes flow.
    #[inline(always)]
    pub fn new<const FORCE: bool>(low: &Low<V>, force: [V; 3], second: f64) -> Self {
        let zero = low.density.like(0.0);
        let one_half = zero.like(0.5);
        let j = low.momentum;
        let (mut u, mut half) = (j, [zero; 3]);
        if FORCE {
            for a in 0..3 {
                half[a] = force[a] * one_half;
                u[a] = j[a] + half[a];
            }
        }
        let scale = zero.like(second);
        let v = [u[0] * scale, u[1] * scale, u[2] * scale];
        let pressure = low.density * zero.like(1.0 / 3.0);
        let mut stress = low.second;
        for a in 0..3 {
            let carried = if FORCE { u[a] - (half[a] + half[a]) } else { u[a] };
            stress[a] = v[a].neg_mul_add(carried, stress[a] - pressure);
        }
        for (p, [a, b]) in PLANES.into_iter().enumerate() {
            stress[3 + p] = v[a].neg_mul_add(j[b], stress[3 + p]);
            if FORCE {
                stress[3 + p] = v[b].mul_add(half[a], stress[3 + p]);
            }
        }
        Self {
            density: low.density,
            u,
            v,
            half,
            stress,
        }
    }

    /// Relaxes the stress, its trace at a rate of its own.
    #[inline(always)]
    pub fn relax_stress(&mut self, shear: f64, bulk: f64, axes: usize) {
        let one = self.density;
        let [x, y, z, ..] = self.stress;
        let trace = if axes == 3 { x + y + z } else { x + y };
        let more = trace * one.like((shear - bulk) / axes as f64);
        let keep = one.like(1.0 - shear);
        for a in 0..6 {
            self.stress[a] = if a < axes {
                self.stress[a].mul_add(keep, more)
            } else {
                self.stress[a] * keep
            };
        }
    }
}
