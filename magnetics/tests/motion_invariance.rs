//! The gap between two chains of linear beads does not know how strong the sheets are.

mod scene;

use lbm_ibm_coupling::{Plane, Soa3, Union, Vec3};
use lbm_ibm_magnetics::*;
use scene::RADIUS;
use std::sync::Arc;

const HALF: f64 = 15e-6;
const BEADS: usize = 4;

/// Gap (m) between two chains that stand on the lower plate between the sheets, and what is left of the forces.
fn gap(bead: &Bead, density: f64, bias: f64, model: impl Model + 'static) -> f64 {
    let sheets = SheetPair::opposite(Vec3::zeros(), [100e-6, 50e-6], 120e-6, density).unwrap();
    let source = Sum::new().with(sheets).with(Uniform::new(Vec3::z() * bias));
    let plates = Union::new()
        .with(Plane::new(Vec3::z() * -HALF, Vec3::z()).with_part(0))
        .with(Plane::new(Vec3::z() * HALF, -Vec3::z()).with_part(1));
    let chain = |side: f64| (0..BEADS).map(move |k| Vec3::new(side * 14e-6, 0.0, -HALF + (2 * k + 1) as f64 * RADIUS));
    let x: Soa3 = chain(-1.0).chain(chain(1.0)).collect();
    let system = BeadSystem::new(vec![bead.clone(); 2 * BEADS], x, source, model, 1e-3)
        .unwrap()
        .with_walls(Arc::new(plates));
    let mut rest = QuasiStatic::new(system);
    let found = rest.relax().unwrap();
    assert!(found.residual <= 1e-9);
    let chains = find_chains(rest.system().beads(), rest.positions(), 1e-3 * RADIUS);
    assert_eq!(chains.len(), 2);
    chain_gaps(&chains, rest.system().beads(), rest.positions(), 1e-3)[0]
}

#[test]
fn the_gap_depends_on_the_bias_over_the_density_alone() {
    let linear = &scene::beads(1, RADIUS, 4.0)[0];
    let dipoles = || MutualDipoles::new().with_tolerance(1e-12);
    for ratio in [0.0, 0.3] {
        let gaps = [0.01, 0.1, 1.0].map(|d| gap(linear, d, ratio * d, dipoles()));
        println!("bias/density {ratio}: gaps {gaps:?}");
        for g in &gaps[1..] {
            assert!((g / gaps[0] - 1.0).abs() < 1e-6, "{gaps:?}");
        }
    }
    // Saturation breaks it.
    let law = Saturation::new(SaturationShape::FroehlichKennelly, Intrinsic::new(3.0).unwrap(), 2e4).unwrap();
    let saturating = Bead::new(RADIUS, 1500.0, law).unwrap();
    let [weak, strong] = [0.01, 0.5].map(|d| gap(&saturating, d, 0.0, dipoles()));
    println!("saturating: {weak} {strong}");
    assert!((strong / weak - 1.0).abs() > 1e-3, "{weak} {strong}");
}
