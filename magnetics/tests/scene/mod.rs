//! Beads, clusters and finite differences that the tests share. Units of the reference tables: a, H0, mu0 H0^2 a^2.

#![allow(dead_code)] // every test binary compiles this module and uses a part of it

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;

pub const RADIUS: f64 = 2e-6;
pub const FIELD: f64 = 0.05;
pub const FORCE: f64 = FIELD * FIELD * RADIUS * RADIUS / MU0;

pub mod units {
    use super::*;
    pub const MOMENT: f64 = 4.0 * std::f64::consts::PI * RADIUS * RADIUS * RADIUS * FIELD / MU0;
}

pub fn beads(n: usize, radius: f64, mu: f64) -> Vec<Bead> {
    vec![Bead::new(radius, 1500.0, Intrinsic::new(mu - 1.0).unwrap()).unwrap(); n]
}

/// A face-centred block of `n`^3 cells' corners and faces, neighbours `spacing` radii apart, tilted against the axes.
pub fn cluster(n: usize, spacing: f64) -> Soa3 {
    let edge = spacing * RADIUS * std::f64::consts::FRAC_1_SQRT_2;
    let turn = lbm_ibm_coupling::nalgebra::Rotation3::from_euler_angles(0.3, 0.4, 0.2);
    let mut x = Soa3::default();
    for i in 0..n {
        for j in 0..n {
            for k in 0..n {
                if (i + j + k) % 2 == 0 {
                    x.push(turn * Vec3::new(i as f64, j as f64, k as f64) * edge);
                }
            }
        }
    }
    x
}

pub fn solve(model: &mut dyn Model, beads: &[Bead], x: &Soa3, source: &dyn FieldSource) -> Solution {
    let mut out = Solution::new();
    let problem = Problem::new(beads, x.view(), source, 0.0).unwrap();
    model.solve(&problem, &mut out).unwrap();
    out
}

/// Greatest difference between the forces and the fourth-order difference of the energy, over the greatest force.
pub fn energy_gradient(model: &mut dyn Model, beads: &[Bead], x: &Soa3, source: &dyn FieldSource) -> f64 {
    let force = solve(model, beads, x, source).force;
    let largest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let h = 2e-3 * RADIUS;
    let mut worst: f64 = 0.0;
    for i in 0..x.len() {
        for a in 0..3 {
            let mut energy = |s: f64| {
                let mut y = x.clone();
                y.add(i, Vec3::ith(a, s * h));
                solve(model, beads, &y, source).energy
            };
            let slope = (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * h);
            worst = worst.max((force.get(i)[a] + slope).abs() / largest);
        }
    }
    worst
}
