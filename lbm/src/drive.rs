//! What drives the flow.

use crate::error::LbmError;
use lbm_ibm_coupling::{Grid, Vec3};

/// How fast flux control closes on its target: the fraction of the missing momentum that is made up in a step.
const GAIN: f64 = 0.5;

/// What drives the flow.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Drive {
    /// A uniform force density, N/m3: minus a pressure gradient. Over a period of length L it stands for a pressure drop
    /// of force density times L.
    Force(Vec3),
    /// The superficial velocity to hold along each axis (m/s; `None` leaves an axis alone): the uniform force density
    /// that does so is found in every step.
    Flux([Option<f64>; 3]),
}

impl Default for Drive {
    fn default() -> Self {
        Self::Force(Vec3::zeros())
    }
}

impl Drive {
    /// A superficial velocity along one axis (0 to 2), m/s.
    pub fn flux(axis: usize, velocity: f64) -> Self {
        Self::Flux(std::array::from_fn(|a| (a == axis).then_some(velocity)))
    }

    /// Whether the force has to be found.
    pub(crate) fn is_flux(&self) -> bool {
        matches!(self, Self::Flux(_))
    }

    pub(crate) fn check(&self, grid: &Grid) -> Result<(), LbmError> {
        let values = match self {
            Self::Force(f) => [Some(f.x), Some(f.y), Some(f.z)],
            Self::Flux(v) => *v,
        };
        let name = if self.is_flux() {
            "superficial velocity"
        } else {
            "force density"
        };
        for (axis, value) in values.into_iter().enumerate() {
            let Some(value) = value else { continue };
            if !value.is_finite() {
                return Err(LbmError::NotFinite { name, value });
            }
            if self.is_flux() && !grid.periodic[axis] {
                return Err(LbmError::ClosedAxis { axis, velocity: value });
            }
        }
        Ok(())
    }
}

/// Momentum of all fluid nodes in one step, and mass, lattice units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Balance {
    /// Before collision.
    pub momentum: [f64; 3],
    /// What the bodies' forces add.
    pub bodies: [f64; 3],
    /// What walls add.
    pub walls: [f64; 3],
    /// Mass that interpolated links add.
    pub gained: f64,
}

impl Balance {
    /// Adds another part of the fluid.
    pub fn add(&mut self, other: &Self) {
        for a in 0..3 {
            self.momentum[a] += other.momentum[a];
            self.bodies[a] += other.bodies[a];
            self.walls[a] += other.walls[a];
        }
        self.gained += other.gained;
    }

    /// Momentum after the step along `axis`, `drive` being what the uniform force has added.
    pub fn after(&self, axis: usize, drive: f64) -> f64 {
        self.momentum[axis] + drive + self.bodies[axis] + self.walls[axis]
    }

    /// What the uniform force should add in the next step, so that the momentum at half a step of force becomes
    /// `target`.
    ///
    /// It balances what walls and bodies have just taken, which alone would hold the momentum, and makes up for a part
    /// of what is missing: `D = -R + g (T - P - (D + B)/2)`, solved for `D`.
    pub fn next_drive(&self, axis: usize, drive: f64, target: f64) -> f64 {
        let loss = self.bodies[axis] + self.walls[axis];
        let missing = target - self.after(axis, drive) - 0.5 * self.bodies[axis];
        (GAIN * missing - loss) / (1.0 + 0.5 * GAIN)
    }
}
