//! Thermal motion against Einstein and Boltzmann. Bounds are four standard errors.

mod scene;

use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Noise, Plane, Soa3, Vec3};
use lbm_ibm_magnetics::*;
use std::f64::consts::PI;
use std::sync::Arc;

const VISCOSITY: f64 = 1e-3;
const A: f64 = 1e-6;
const TEMPERATURE: f64 = 300.0;
const KT: f64 = BOLTZMANN * TEMPERATURE;
const DIFFUSION: f64 = KT / (6.0 * PI * VISCOSITY * A);

fn still() -> Uniform {
    Uniform::new(Vec3::zeros())
}

fn beads(n: usize, density: f64) -> Vec<Bead> {
    vec![Bead::new(A, density, Intrinsic::new(1.0).unwrap()).unwrap(); n]
}

#[test]
fn free_beads_spread_as_six_d_t() {
    let (n, steps, h) = (400, 50, 1e-2);
    let x: Soa3 = (0..n)
        .map(|i| Vec3::new((i % 20) as f64, (i / 20) as f64, 0.0) * 20.0 * A)
        .collect();
    let system = BeadSystem::new(beads(n, 1500.0), x.clone(), still(), FixedDipoles::new(), VISCOSITY).unwrap();
    let mut run = Brownian::new(system, TEMPERATURE, h, 11).unwrap();
    for _ in 0..steps {
        run.advance().unwrap();
    }
    let square: f64 = (0..n)
        .map(|i| (run.positions().get(i) - x.get(i)).norm_squared())
        .sum::<f64>()
        / n as f64;
    let ratio = square / (6.0 * DIFFUSION * steps as f64 * h);
    println!("mean square displacement over 6 D t: {ratio}");
    // The variance of a sum of three squares is 2/3 of its mean squared.
    assert!((ratio - 1.0).abs() < 4.0 * (2.0 / 3.0 / n as f64).sqrt(), "{ratio}");
}

#[test]
fn heavy_beads_over_a_wall_keep_the_barometric_distribution() {
    // kT over weight is half a micrometre: the mobility changes tenfold over the layer.
    let (n, layer, h, steps) = (400, 0.5e-6, 2e-3, 1500);
    let weight = KT / layer;
    let volume = 4.0 / 3.0 * PI * A.powi(3);
    let gravity = Vec3::z() * (-weight / (500.0 * volume));
    let start = Noise::new(5, 0);
    let x: Soa3 = (0..n)
        .map(|i| {
            // Exponential gaps: half the sum of two squares of normal numbers.
            let g = start.normal(i as u64);
            let gap = 0.5 * (g.x * g.x + g.y * g.y) * layer;
            Vec3::new((i % 20) as f64 * 50.0 * A, (i / 20) as f64 * 50.0 * A, A + gap)
        })
        .collect();
    let system = BeadSystem::new(beads(n, 1500.0), x, still(), FixedDipoles::new(), VISCOSITY)
        .unwrap()
        .with_gravity(gravity, 1000.0)
        .with_walls(Arc::new(Plane::new(Vec3::zeros(), Vec3::z())))
        .with_wall_drag(WallDrag::BevanPrieve)
        .with_contact(Constraint::frictionless());
    let mut run = Brownian::new(system, TEMPERATURE, h, 3).unwrap();
    let (mut mean, mut square, mut count) = (0.0, 0.0, 0.0);
    for step in 0..steps {
        run.advance().unwrap();
        if step >= steps / 2 && step % 10 == 0 {
            for x in run.positions().iter() {
                let gap = (x.z - A) / layer;
                mean += gap;
                square += gap * gap;
                count += 1.0;
            }
        }
    }
    let (mean, square) = (mean / count, square / count);
    println!("mean gap over kT/W {mean}, mean square {square} (2)");
    // Standard errors of 400 independent beads: 1 and sqrt(20) over 20.
    assert!((mean - 1.0).abs() < 4.0 / (n as f64).sqrt(), "{mean}");
    assert!((square - 2.0).abs() < 4.0 * (20.0 / n as f64).sqrt(), "{square}");
}

/// Pulls beads of moment m along z to the centre with the spring `k`: F = (grad B)^T m.
struct Trap {
    k: f64,
    m: f64,
}

impl FieldSource for Trap {
    fn field(&self, _x: Vec3, _t: f64) -> Vec3 {
        Vec3::zeros()
    }
    fn gradient(&self, x: Vec3, _t: f64) -> Matrix3<f64> {
        let mut g = Matrix3::zeros();
        g.set_row(2, &(x.transpose() * (-self.k / self.m)));
        g
    }
}

#[test]
fn a_pair_in_a_trap_has_the_boltzmann_distances_with_hydrodynamic_interaction() {
    let (k, m) = (KT / (A * A), 1e-22);
    let law = Repulsion {
        strength: 10.0 * KT / A,
        range: 0.2 * A,
    };
    // Weight of the distance r: r^2 exp(-(k r^2/4 + strength range exp(-(r - 2a)/range))/kT).
    let (mut norm, mut first, mut second) = (0.0, 0.0, 0.0);
    for i in 0..100_000 {
        let r = (i as f64 + 0.5) * 1e-4;
        let u = 0.25 * r * r + 10.0 * 0.2 * (-(r - 2.0) / 0.2).exp();
        let w = r * r * (-u).exp();
        norm += w;
        first += w * r;
        second += w * r * r;
    }
    let (first, second) = (first / norm, second / norm);
    for mobility in [PairMobility::RotnePrager, PairMobility::Squeeze] {
        let x: Soa3 = [Vec3::x() * -1.4 * A, Vec3::x() * 1.4 * A].into_iter().collect();
        let moments: Soa3 = [Vec3::z() * m; 2].into_iter().collect();
        let model = FixedDipoles::new().with_moments(moments);
        let system = BeadSystem::new(beads(2, 1500.0), x, Trap { k, m }, model, VISCOSITY)
            .unwrap()
            .with_pair_mobility(mobility)
            .with_contact(law);
        let relax = A * A / DIFFUSION;
        let mut run = Brownian::new(system, TEMPERATURE, 3e-3 * relax, 17).unwrap();
        let (blocks, block) = (60, 600);
        let (mut sums, mut squares) = (Vec::new(), Vec::new());
        for _ in 0..blocks {
            let (mut s, mut q) = (0.0, 0.0);
            for _ in 0..block {
                run.advance().unwrap();
                let r = (run.positions().get(1) - run.positions().get(0)).norm() / A;
                s += r / block as f64;
                q += r * r / block as f64;
            }
            sums.push(s);
            squares.push(q);
        }
        for (values, expected) in [(&sums, first), (&squares, second)] {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let error = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt();
            println!("{mobility:?}: {mean} +- {error}, Boltzmann {expected}");
            assert!(
                (mean - expected).abs() < 4.0 * error,
                "{mobility:?} {mean} +- {error} {expected}"
            );
            assert!(error < 0.06 * expected);
        }
    }
}
