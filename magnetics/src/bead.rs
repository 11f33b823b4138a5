//! Beads: how large, how heavy, and how they answer to a field.

mod law;
mod pillar;
mod presets;
mod susceptibility;

pub use law::{Magnetisation, Saturation, SaturationShape, Table};
pub use pillar::Pillar;
pub use presets::{Preset, Sourced};
pub use susceptibility::{Apparent, Intrinsic};

use crate::MU0;
use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::Matrix3;

/// A magnetic bead.
#[derive(Clone, Debug, PartialEq)]
pub struct Bead {
    radius: f64,
    density: f64,
    law: Magnetisation,
}

/// The moment of a bead in a local field, and how it changes with the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// Moment, A m2.
    pub moment: Vec3,
    /// Differential polarisability along the field, dm/dB (A m2/T).
    pub along: f64,
    /// Differential polarisability across the field, m/B (A m2/T).
    pub across: f64,
    /// Unit vector along the field.
    pub direction: Vec3,
}

impl Response {
    /// dm_i/dB_j, A m2/T.
    pub fn polarisability(&self) -> Matrix3<f64> {
        let n = self.direction;
        Matrix3::identity() * self.across + n * n.transpose() * (self.along - self.across)
    }
}

impl Bead {
    /// A bead of `radius` (m), `density` (kg/m3) and magnetisation law.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the radius or the density.
    pub fn new(radius: f64, density: f64, law: impl Into<Magnetisation>) -> Result<Self, MagneticsError> {
        Ok(Self {
            radius: positive("radius of the bead (m)", radius)?,
            density: positive("density of the bead (kg/m3)", density)?,
            law: law.into(),
        })
    }

    /// Radius, m.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Density, kg/m3.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Magnetisation law.
    pub fn law(&self) -> &Magnetisation {
        &self.law
    }

    /// Volume, m3.
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius.powi(3)
    }

    /// Moment in the local field `b` (T), that is the field there without the bead's own.
    pub fn response(&self, b: Vec3) -> Response {
        let volume = self.volume();
        if let Magnetisation::Remanent(m) = self.law {
            return Response {
                moment: m * volume,
                along: 0.0,
                across: 0.0,
                direction: Vec3::zeros(),
            };
        }
        let strength = b.norm() / MU0;
        let (m, slope) = self.law.in_applied_field(strength);
        let direction = if strength > 0.0 { b / b.norm() } else { Vec3::zeros() };
        let across = if strength > 0.0 { m / strength } else { slope };
        Response {
            moment: direction * (m * volume),
            along: slope * volume / MU0,
            across: across * volume / MU0,
            direction,
        }
    }

    /// Work (J) to bring the bead to the moment that it has in the local field `b` (T): int B dm. Zero for a remanent bead.
    pub fn self_energy(&self, b: Vec3) -> f64 {
        MU0 * self.volume() * self.law.energy_density(b.norm() / MU0)
    }

    /// Relative permeability of a linear bead; 1 for a remanent one, none for one that saturates.
    pub fn permeability(&self) -> Option<f64> {
        match &self.law {
            Magnetisation::Linear(chi) => Some(1.0 + chi.value()),
            Magnetisation::Remanent(_) => Some(1.0),
            Magnetisation::Saturating(_) | Magnetisation::Table(_) => None,
        }
    }

    /// Relative permeability at vanishing field.
    pub fn initial_permeability(&self) -> f64 {
        1.0 + self.law.initial_susceptibility()
    }

    /// Weight less buoyancy in a fluid of density `fluid` (kg/m3) under gravity `g` (m/s2), N.
    pub fn buoyant_weight(&self, fluid: f64, g: Vec3) -> Vec3 {
        g * ((self.density - fluid) * self.volume())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn laws() -> Vec<Magnetisation> {
        let chi = Intrinsic::new(4.0).unwrap();
        vec![
            chi.into(),
            Saturation::new(SaturationShape::FroehlichKennelly, chi, 3e4)
                .unwrap()
                .into(),
            Saturation::new(SaturationShape::Langevin, chi, 3e4).unwrap().into(),
            Table::new(&[[0.0, 0.0], [5e3, 1.5e4], [2e4, 2.5e4], [1e5, 3e4]])
                .unwrap()
                .into(),
        ]
    }

    #[test]
    fn the_polarisability_is_the_derivative_of_the_moment_and_the_energy_its_integral() {
        for law in laws() {
            let bead = Bead::new(2e-6, 1500.0, law).unwrap();
            for strength in [1e-4, 3e-3, 2e-2, 0.1, 0.7] {
                let b = Vec3::new(0.6, 0.0, 0.8) * strength;
                let p = bead.response(b).polarisability();
                let h = 1e-6 * strength;
                for a in 0..3 {
                    let e = Vec3::ith(a, h);
                    let fd = (bead.response(b + e).moment - bead.response(b - e).moment) / (2.0 * h);
                    assert_relative_eq!(fd, p.column(a).into_owned(), epsilon = 1e-6 * p.norm());
                    let work = (bead.self_energy(b + e) - bead.self_energy(b - e)) / (2.0 * h);
                    assert_relative_eq!(work, b.dot(&fd), epsilon = 1e-6 * p.norm() * strength);
                }
            }
        }
    }

    #[test]
    fn apparent_and_intrinsic_susceptibility_give_the_moments_of_a_sphere() {
        // m = V 3 chi/(chi + 3) H.
        let b = Vec3::z() * 0.05;
        let one = Bead::new(5e-6, 1800.0, Intrinsic::new(1.0).unwrap()).unwrap();
        let same = Bead::new(5e-6, 1800.0, Apparent::new(0.75).unwrap()).unwrap();
        let expected = one.volume() * 0.75 * 0.05 / MU0;
        assert_relative_eq!(one.response(b).moment.z, expected, max_relative = 1e-14);
        assert_relative_eq!(same.response(b).moment.z, expected, max_relative = 1e-14);
    }

    #[test]
    fn laws_start_linear_and_end_saturated() {
        for law in laws().into_iter().skip(1) {
            let bead = Bead::new(1e-6, 1500.0, law).unwrap();
            let weak = bead.response(Vec3::z() * 1e-9).moment.z;
            let chi = bead.initial_permeability() - 1.0;
            let linear = bead.volume() * 3.0 * chi / (chi + 3.0) * 1e-9 / MU0;
            assert_relative_eq!(weak, linear, max_relative = 1e-5);
            let strong = bead.response(Vec3::z() * 1e4).moment.z / bead.volume();
            assert_relative_eq!(strong, 3e4, max_relative = 1e-4);
        }
    }

    #[test]
    fn a_remanent_bead_keeps_its_moment() {
        let bead = Bead::new(1e-6, 1500.0, Magnetisation::Remanent(Vec3::x() * 1e4)).unwrap();
        assert_eq!(bead.response(Vec3::z()), bead.response(Vec3::zeros()));
        assert!(Bead::new(0.0, 1500.0, Intrinsic::new(1.0).unwrap()).is_err());
    }
}
