//! A row of chains at rest: its gap follows from the bias field.

use crate::device::{Device, PLASMA, RADIUS, ROW};
use lbm_ibm::coupling::{Soa3, Sphere, UM, Vec3};
use lbm_ibm::magnetics::{Auto, BeadSystem, MagneticsError, QuasiStatic, chain_gaps, find_chains};
use std::sync::Arc;

/// A row of chains.
#[derive(Clone, Debug)]
pub struct Row {
    /// Bead centres, m.
    pub centres: Soa3,
    /// Least gap between neighbouring chains, m.
    pub gap: f64,
    /// Number of chains.
    pub chains: usize,
}

impl Row {
    /// The row of beads at `centres`, m.
    pub fn new(device: &Device, centres: Soa3) -> Result<Self, MagneticsError> {
        let beads = device.beads()?;
        let chains = find_chains(&beads, centres.view(), 0.02 * RADIUS);
        let gaps = chain_gaps(&chains, &beads, centres.view(), 10.0 * RADIUS);
        Ok(Self {
            gap: gaps.into_iter().fold(f64::INFINITY, f64::min),
            chains: chains.len(),
            centres,
        })
    }

    /// The beads as spheres.
    pub fn spheres(&self) -> Vec<Sphere> {
        self.centres.iter().map(|c| Sphere::new(c, RADIUS)).collect()
    }
}

/// Upright chains side by side, `gap` (m) apart.
pub fn upright(gap: f64) -> Soa3 {
    let (chains, beads) = ROW;
    let middle = |i: usize, n: usize| i as f64 - 0.5 * (n as f64 - 1.0);
    let place = |c: usize, k: usize| {
        let y = (2.0 * RADIUS + gap) * middle(c, chains);
        // A hundredth of a micrometre between beads: they close in by themselves.
        Vec3::new(0.0, y, (2.0 * RADIUS + 0.01 * UM) * middle(k, beads))
    };
    (0..chains).flat_map(|c| (0..beads).map(move |k| place(c, k))).collect()
}

/// Where upright chains come to rest at a bias field (T), started from `gap` (m) apart.
pub fn at_rest(device: &Device, bias: f64, gap: f64) -> Result<Row, MagneticsError> {
    let system = BeadSystem::new(
        device.beads()?,
        upright(gap),
        device.source(Vec3::zeros(), bias)?,
        Auto::new(),
        PLASMA.1,
    )?;
    let mut rest = QuasiStatic::new(system.with_walls(Arc::new(Device::plates()))).with_tolerance(1e-6);
    rest.relax()?;
    Row::new(device, rest.positions().iter().collect())
}
