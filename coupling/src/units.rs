//! SI units by name, and the numbers that tell whether a resolution is sane.

use std::fmt;

/// One micrometre, m.
pub const UM: f64 = 1e-6;
/// One millimetre, m.
pub const MM: f64 = 1e-3;
/// One microsecond, s.
pub const US: f64 = 1e-6;
/// One millisecond, s.
pub const MS: f64 = 1e-3;
/// One piconewton, N.
pub const PN: f64 = 1e-12;
/// One nanonewton, N.
pub const NN: f64 = 1e-9;

/// What a scene is about, in SI: the scales that [`Units::report`] turns into dimensionless numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Typical greatest velocity, m/s.
    pub velocity: f64,
    /// Length for the Reynolds number, m.
    pub length: f64,
    /// Narrowest opening, m.
    pub gap: f64,
    /// Shear modulus of the softest membrane, N/m; zero where there is none.
    pub shear_modulus: f64,
}

/// Spacing, time step and fluid of a lattice run, in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Node spacing, m.
    pub spacing: f64,
    /// Time step, s.
    pub time_step: f64,
    /// Density in the run, kg/m3.
    pub density: f64,
    /// Dynamic viscosity, Pa s.
    pub viscosity: f64,
    /// Factor by which `density` exceeds the true one (the declared scaling of the Reynolds number).
    pub reynolds_scale: f64,
}

impl Units {
    /// Units of a run at the true density.
    pub fn new(spacing: f64, time_step: f64, density: f64, viscosity: f64) -> Self {
        Self {
            spacing,
            time_step,
            density,
            viscosity,
            reynolds_scale: 1.0,
        }
    }

    /// The run's density is `scale` times the true one.
    pub fn with_reynolds_scale(mut self, scale: f64) -> Self {
        self.reynolds_scale = scale;
        self
    }

    /// Relaxation time tau = 1/2 + 3 nu dt/dx^2.
    pub fn relaxation_time(&self) -> f64 {
        0.5 + 3.0 * self.viscosity / self.density * self.time_step / self.spacing.powi(2)
    }

    /// The time step (s) of a relaxation time: dt = (tau - 1/2) dx^2 rho/(3 mu).
    pub fn time_step_for(spacing: f64, density: f64, viscosity: f64, relaxation_time: f64) -> f64 {
        (relaxation_time - 0.5) / 3.0 * spacing.powi(2) * density / viscosity
    }

    /// Velocity in spacings per step.
    pub fn lattice_velocity(&self, velocity: f64) -> f64 {
        velocity * self.time_step / self.spacing
    }

    /// Dimensionless numbers of a run, printable.
    pub fn report(&self, scales: Scales) -> UnitsReport {
        let reynolds = self.density * scales.velocity * scales.length / self.viscosity;
        UnitsReport {
            units: *self,
            relaxation_time: self.relaxation_time(),
            reynolds,
            true_reynolds: reynolds / self.reynolds_scale,
            mach: self.lattice_velocity(scales.velocity) * 3f64.sqrt(),
            capillary: (scales.shear_modulus > 0.0).then(|| self.viscosity * scales.velocity / scales.shear_modulus),
            nodes_per_gap: scales.gap / self.spacing,
        }
    }
}

/// The dimensionless numbers of a run; prints itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitsReport {
    /// The units it is about.
    pub units: Units,
    /// Relaxation time tau.
    pub relaxation_time: f64,
    /// Reynolds number of the run.
    pub reynolds: f64,
    /// Reynolds number of the true fluid.
    pub true_reynolds: f64,
    /// Mach number of the lattice, u/c_s.
    pub mach: f64,
    /// Capillary number mu U/G_s, where there is a membrane.
    pub capillary: Option<f64>,
    /// Nodes across the narrowest opening.
    pub nodes_per_gap: f64,
}

impl fmt::Display for UnitsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let u = &self.units;
        writeln!(f, "dx             {:.3} um", u.spacing / UM)?;
        writeln!(f, "dt             {:.4} us", u.time_step / US)?;
        writeln!(f, "tau            {:.3}", self.relaxation_time)?;
        writeln!(
            f,
            "Re             {:.2e} (true {:.2e})",
            self.reynolds, self.true_reynolds
        )?;
        writeln!(f, "Ma             {:.2e}", self.mach)?;
        if let Some(ca) = self.capillary {
            writeln!(f, "Ca             {ca:.2e}")?;
        }
        write!(f, "nodes per gap  {:.1}", self.nodes_per_gap)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn relaxation_time_and_step_are_inverse() {
        let dt = Units::time_step_for(0.5 * UM, 1025.0, 1.2e-3, 1.7);
        let units = Units::new(0.5 * UM, dt, 1025.0, 1.2e-3);
        assert_relative_eq!(units.relaxation_time(), 1.7, max_relative = 1e-14);
    }

    #[test]
    fn the_report_has_the_numbers_of_a_red_cell_in_plasma() {
        let units = Units::new(0.5 * UM, 1.0 * US, 20.0 * 1025.0, 1.2e-3).with_reynolds_scale(20.0);
        let report = units.report(Scales {
            velocity: 460.0 * UM,
            length: 12.0 * UM,
            gap: 2.0 * UM,
            shear_modulus: 5.2e-6,
        });
        assert_relative_eq!(report.true_reynolds, 0.004715, max_relative = 1e-9);
        assert_relative_eq!(report.reynolds, 0.0943, max_relative = 1e-9);
        assert_relative_eq!(report.capillary.expect("a membrane"), 0.10615, max_relative = 1e-4);
        assert!(report.to_string().contains("nodes per gap  4.0"));
    }
}
