//! The device without a cell: what the criteria for passing and being stuck refer to.

use crate::device::Device;
use lbm_ibm::coupling::{Run, Scene};
use std::error::Error;

/// Flow in the empty device at the given flux.
#[derive(Clone, Debug)]
pub struct Empty {
    /// Pressure drop over the period, Pa.
    pub pressure_drop: f64,
    /// Part of it that the slit adds to a channel without one, Pa.
    pub slit_pressure_drop: f64,
    /// Time of the undisturbed fluid on the axis from the cell's first touch of the entry plane to its passing, s.
    pub transit: f64,
    /// Time of the undisturbed fluid on the axis from one cell radius before the entry plane to that plane, s.
    pub entry: f64,
}

impl Empty {
    /// Runs the fluid alone, four nodes wide, until the pressure drop is steady to one part in a million.
    pub fn of(device: &Device) -> Result<Self, Box<dyn Error>> {
        let mut scene = device.channel(4.0 * device.spacing)?;
        let drop = |scene: &Scene| scene.fluid().map_or(0.0, |f| f.body_force().x) * device.length;
        let (mut last, mut steady) = (f64::NAN, 0);
        Run::new()
            .until("steady", |scene| {
                if !scene.steps().is_multiple_of(100) {
                    return false;
                }
                let now = drop(scene);
                steady = if (now / last - 1.0).abs() < 1e-6 { steady + 1 } else { 0 };
                last = now;
                steady == 3
            })
            .until_step(200_000)
            .run(&mut scene)?;
        let axis = axis_velocity(&scene, device)?;
        let radius = 0.5 * device.subject.diameter();
        let viscosity = scene.fluid().map_or(0.0, |f| f.viscosity());
        let smooth = 12.0 * viscosity * device.velocity / device.height.powi(2) * device.length;
        Ok(Self {
            pressure_drop: drop(&scene),
            slit_pressure_drop: drop(&scene) - smooth,
            transit: travel(&axis, device.spacing, device.entry - radius, device.exit + 2.0 * radius),
            entry: travel(&axis, device.spacing, device.entry - radius, device.entry),
        })
    }
}

/// Velocity along x on the axis, one value per node.
fn axis_velocity(scene: &Scene, device: &Device) -> Result<Vec<f64>, Box<dyn Error>> {
    let fluid = scene.fluid().ok_or("the empty device has no fluid")?;
    let fields = fluid.macroscopic().ok_or("the fluid does not show its velocity")?;
    let [nx, ny, _] = fluid.grid().shape;
    let row = |j: usize| &fields.velocity[0][j * nx..(j + 1) * nx];
    let middle = (device.height / device.spacing / 2.0 - 0.5, ny - 1);
    let (low, high) = (
        row(middle.0.floor() as usize),
        row((middle.0.ceil() as usize).min(middle.1)),
    );
    Ok(low.iter().zip(high).map(|(a, b)| 0.5 * (a + b)).collect())
}

/// Time to travel from `from` to `to` (m) at the velocities of the nodes passed.
fn travel(axis: &[f64], spacing: f64, from: f64, to: f64) -> f64 {
    let first = (from / spacing).round() as usize;
    let last = (to / spacing).round() as usize;
    axis.iter()
        .cycle()
        .skip(first)
        .take(last - first)
        .map(|u| spacing / u)
        .sum()
}
