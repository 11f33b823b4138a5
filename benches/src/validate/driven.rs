//! What scenes of capsules share.

use super::capsule::scene::{DENSITY, H, VISCOSITY};
use lbm_ibm::coupling::{Grid, Guard, Scene, SceneError, Vec3};
use lbm_ibm::lbm::{Drive, Fluid, LbmError, Pace};

/// A box along x about a tube along its middle.
#[derive(Clone, Copy, Debug)]
pub struct TubeBox {
    /// Grid nodes along each axis.
    pub shape: [usize; 3],
}

impl TubeBox {
    /// Of so many nodes along a tube of so many spacings' radius.
    pub fn new(length: usize, radius: f64) -> Self {
        let across = 2 * (radius + 1.5) as usize;
        Self {
            shape: [length, across, across],
        }
    }

    /// Its middle, m.
    pub fn centre(&self) -> Vec3 {
        Vec3::from(self.shape.map(|n| 0.5 * n as f64 * H))
    }

    /// A fluid without inertia in it, periodic and driven at a flux (m3/s), by what is solid too.
    ///
    /// # Errors
    /// What the fluid says of the numbers.
    pub fn fluid(&self, tau: f64, flux: f64) -> Result<Fluid, LbmError> {
        let section = (self.shape[1] * self.shape[2]) as f64 * H * H;
        let grid = Grid::new(self.shape, H, [true; 3]);
        Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))?
            .with_inertia(false)
            .with_drive(Drive::flux(0, flux / section))
    }
}

/// A guard that leaves the volume to the capsule.
pub fn guard() -> Guard {
    Guard {
        volume: f64::INFINITY,
        ..Guard::default()
    }
}

/// Force density along the axis, N/m3.
pub fn force(scene: &Scene) -> f64 {
    scene.fluid().map_or(0.0, |f| f.body_force().x)
}

/// Its mean over so many steps.
///
/// # Errors
/// What the scene finds.
pub fn mean_force(scene: &mut Scene, steps: usize) -> Result<f64, SceneError> {
    let mut sum = 0.0;
    for _ in 0..steps {
        scene.step()?;
        sum += force(scene);
    }
    Ok(sum / steps as f64)
}
