//! What a fluid's nodes do: the collision, its lattice velocities, precision and temperature.

use crate::drive::Drive;
use crate::element::Precision;
use crate::error::LbmError;
use crate::fluid::Fluid;
use crate::kernel::build_lean;
use crate::model::Model;
use crate::relaxation::{Collision, VelocitySet};
use crate::stable;
use crate::stencil::Velocities;
use crate::storage::Storage;
use crate::thermal::Thermal;

impl Fluid {
    /// Another collision than TRT with magic number 3/16.
    ///
    /// # Errors
    /// [`LbmError::NotPositive`] for the magic number, [`LbmError::Rate`] for another rate, [`LbmError::NotOnThisSet`],
    /// [`LbmError::Unstable`] if the fluid is driven by a flux too fast for it, [`LbmError::NotThermal`].
    pub fn with_collision(mut self, collision: Collision) -> Result<Self, LbmError> {
        collision.check(self.tau, self.velocity_set)?;
        self.collision = Some(collision);
        self.rebuild();
        self.settle()?;
        Ok(self)
    }

    /// Other lattice velocities than [`VelocitySet::D3Q19`]. A fluid in motion comes to rest.
    ///
    /// # Errors
    /// [`LbmError::NotOnThisSet`], [`LbmError::NotPlane`], [`LbmError::GridTooLarge`].
    pub fn with_velocity_set(mut self, set: VelocitySet) -> Result<Self, LbmError> {
        let collision = self.collision.unwrap_or_default();
        collision.check(self.tau, set)?;
        let kernel = collision.kernel(set, self.tau, self.inertia, self.isa, self.storage.precision());
        self.admit(kernel.velocities())?;
        (self.collision, self.velocity_set) = (Some(collision), set);
        self.set_kernel(kernel, self.storage.precision());
        self.settle()?;
        Ok(self)
    }

    /// Whether the grid suits lattice velocities.
    fn admit(&self, velocities: Velocities) -> Result<(), LbmError> {
        let (nodes, periodic) = (self.grid.shape[2], self.grid.periodic[2]);
        let plane = (0..velocities.q()).all(|i| velocities.c(i)[2] == 0);
        if plane && (nodes != 1 || !periodic) {
            return Err(LbmError::NotPlane { nodes, periodic });
        }
        if !Storage::fits(self.grid.shape, velocities) {
            return Err(LbmError::GridTooLarge { shape: self.grid.shape });
        }
        Ok(())
    }

    /// The lattice velocities; none where the model is one's own.
    pub fn velocity_set(&self) -> Option<VelocitySet> {
        self.collision.map(|_| self.velocity_set)
    }

    /// A collision model of one's own. Its viscosity should be [`Fluid::lattice_viscosity`]; what depends on the collision
    /// beyond that, such as [`Fluid::wall_slip`], is then unknown, and [`Fluid::with_inertia`] changes nothing.
    /// [`Fluid::with_velocity_set`] goes back to a built-in one.
    ///
    /// # Errors
    /// [`LbmError::GridTooLarge`], [`LbmError::NotPlane`].
    pub fn with_model<M: Model<Q>, const Q: usize>(mut self, model: M) -> Result<Self, LbmError> {
        let kernel = build_lean(model, self.isa, self.storage.precision());
        self.admit(kernel.velocities())?;
        self.collision = None;
        self.set_kernel(kernel, self.storage.precision());
        self.settle()?;
        Ok(self)
    }

    /// Thermal fluctuations at `temperature` (K): momentum and stress of the nodes have the fluctuations of a fluid at rest at this
    /// temperature (Adhikari et al. 2005, Duenweg, Schiller and Ladd 2007), from numbers that depend on `seed`, step and node alone.
    /// It starts without them; a wave comes to its own within a few of its times of decay, `1/(nu k^2)`. Costs several times
    /// the step.
    ///
    /// # Errors
    /// [`LbmError::NotPositive`] for the temperature, [`LbmError::TooHot`]; [`LbmError::NotThermal`], here or where the collision is
    /// changed after this.
    pub fn with_temperature(mut self, temperature: f64, seed: u64) -> Result<Self, LbmError> {
        let energy = self.density * self.grid.spacing.powi(3) * self.velocity_unit().powi(2);
        self.thermal = Some(Thermal::new(temperature, seed, energy, self.grid.shape, &*self.kernel)?);
        Ok(self)
    }

    /// Temperature of the fluctuations, K; 0 without.
    pub fn temperature(&self) -> f64 {
        self.thermal.as_ref().map_or(0.0, |t| t.temperature)
    }

    /// What a change of the collision brings with it: other noise, another limit of stability.
    fn settle(&mut self) -> Result<(), LbmError> {
        self.check_flux(&self.drive)?;
        if let Some(thermal) = &self.thermal {
            self.thermal = Some(thermal.of(&*self.kernel)?);
        }
        Ok(())
    }

    /// How the populations are stored, [`Precision::F64`] by default.
    pub fn with_precision(mut self, precision: Precision) -> Self {
        let kernel = self.kernel.rebuilt(self.isa, precision);
        self.set_kernel(kernel, precision);
        self
    }

    /// How the populations are stored.
    pub fn precision(&self) -> Precision {
        self.storage.precision()
    }

    /// Makes the kernel anew from the collision.
    pub(crate) fn rebuild(&mut self) {
        if let Some(collision) = self.collision {
            let precision = self.storage.precision();
            let kernel = collision.kernel(self.velocity_set, self.tau, self.inertia, self.isa, precision);
            self.set_kernel(kernel, precision);
        }
    }

    /// Greatest velocity (m/s) of a uniform flow in which no wave grows, by the eigenvalues of the linearised collision (the least
    /// of flow along an axis, a face diagonal and a space diagonal); none where it was not computed: for rates, and models, of
    /// one's own, and without inertia, where there is no limit. Walls and shear may lower it.
    ///
    /// `cargo run --release -p lbm-ibm-benches --bin stability` computes the table that it is interpolated in.
    pub fn stable_speed(&self) -> Option<f64> {
        let collision = self.collision.filter(|_| self.inertia)?;
        let limit = stable::limit(collision, self.velocity_set, self.tau)?;
        Some(limit * self.velocity_unit())
    }

    /// Refuses a flux that is faster than any stable flow.
    pub(crate) fn check_flux(&self, drive: &Drive) -> Result<(), LbmError> {
        let (Drive::Flux(target), Some(stable)) = (drive, self.stable_speed()) else {
            return Ok(());
        };
        let speed = target.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
        if speed > stable {
            return Err(LbmError::Unstable {
                speed,
                stable,
                tau: self.tau,
            });
        }
        Ok(())
    }
}
