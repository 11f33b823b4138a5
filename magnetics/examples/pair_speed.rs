//! Nanoseconds per ordered pair of each sum, one thread: `cargo run --release --example pair_speed`.

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;
use std::time::Instant;

fn main() -> Result<(), MagneticsError> {
    let count: usize = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(10_000);
    let side = (count as f64).cbrt().ceil() as usize;
    let x: Soa3 = (0..count)
        .map(|k| Vec3::new((k % side) as f64, (k / side % side) as f64, (k / side / side) as f64) * 12e-6)
        .collect();
    let beads = vec![Bead::new(2e-6, 1500.0, Intrinsic::new(1.0)?)?; count];
    let source = Uniform::new(Vec3::z() * 0.05);
    let problem = Problem::new(&beads, x.view(), &source, 0.0)?;
    let mut out = Solution::new();
    let mut moment = Soa3::default();
    FixedDipoles::new().solve(&problem, &mut out)?;
    moment.clone_from(&out.moment);
    let pairs = (count * count) as f64;
    for torque in [false, true] {
        let best = (0..7)
            .map(|_| {
                let start = Instant::now();
                dipole_forces(x.view(), moment.view(), torque, &mut out);
                start.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min);
        let what = if torque { "force and torque" } else { "force" };
        println!("{what}: {:.3} ns per ordered pair", best / pairs * 1e9);
    }
    let sheets = SheetPair::opposite(Vec3::zeros(), [100e-6, 50e-6], 120e-6, 1.0)?;
    let (mut b, mut g) = (Soa3::default(), Vec::new());
    let points: Soa3 = (0..100_000).map(|k| chained(k, 100_000, 0.0) * 0.05).collect();
    let start = Instant::now();
    sheets.fields_and_gradients(points.view(), 0.0, &mut b, &mut g);
    let time = start.elapsed().as_secs_f64() / points.len() as f64;
    println!("pair of sheets, field and gradient: {:.1} ns per point", time * 1e9);
    let mut models: [Box<dyn Model>; 3] = [
        Box::new(FixedDipoles::new()),
        Box::new(MutualDipoles::new()),
        Box::new(PairCorrected::new()),
    ];
    // Chains of ten beads with gaps of 0.05 radii; between the two solves every bead moves by up to 1e-3 radii.
    for model in &mut models {
        for shift in [0.0, 2e-9] {
            let x: Soa3 = (0..count).map(|k| chained(k, count, shift)).collect();
            let problem = Problem::new(&beads, x.view(), &source, 0.0)?;
            let start = Instant::now();
            model.solve(&problem, &mut out)?;
            let time = start.elapsed().as_secs_f64() * 1e3;
            let warm = if shift > 0.0 { "warm" } else { "cold, with its tables" };
            println!(
                "{}: {time:.2} ms, {} iterations, {warm}",
                model.name(),
                out.error.iterations
            );
        }
    }
    Ok(())
}

fn chained(k: usize, count: usize, shift: f64) -> Vec3 {
    let side = ((count / 10) as f64).sqrt().ceil() as usize;
    let (chain, link) = (k / 10, k % 10);
    let move_by = Vec3::new((k as f64).sin(), (k as f64 * 1.7).sin(), (k as f64 * 2.3).sin()) * shift;
    let foot = Vec3::new((chain % side) as f64, (chain / side) as f64, 0.0) * 12e-6;
    foot + Vec3::z() * (link as f64 * 4.1e-6) + move_by
}
