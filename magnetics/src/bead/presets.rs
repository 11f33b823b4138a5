//! Commercial beads.

use super::{Apparent, Bead, Saturation, SaturationShape};
use crate::error::MagneticsError;

/// A value with the range in which the literature has it and where it is from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sourced {
    /// Value used.
    pub value: f64,
    /// Least and greatest value met.
    pub spread: [f64; 2],
    /// Where it is from, and how sure it is.
    pub source: &'static str,
}

/// A commercial bead: its numbers, each with spread and source.
///
/// The susceptibilities are the *apparent* slope of M against the applied field at low field. The literature disagrees:
/// treat a preset as a starting point, and measure your batch. No number here has been held against a document, and
/// [`Sourced::source`] says so of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Trade name.
    pub name: &'static str,
    /// Radius, m.
    pub radius: Sourced,
    /// Density, kg/m3.
    pub density: Sourced,
    /// Apparent susceptibility.
    pub susceptibility: Sourced,
    /// Saturation magnetisation, A/m, of the whole bead's volume.
    pub saturation: Sourced,
}

const RECALLED: &str =
    "UNVERIFIED: recalled from the manufacturer's product information, not checked against a document";
const LITERATURE: &str = "UNVERIFIED: recalled range of magnetometry in the literature, not checked against a document";
const SATURATION: &str = "UNVERIFIED: recalled mass magnetisation times density, after Fonnum et al. 2005, J. Magn. Magn. Mater. 293, \
                          41; not checked against it";

const fn sourced(value: f64, low: f64, high: f64, source: &'static str) -> Sourced {
    Sourced {
        value,
        spread: [low, high],
        source,
    }
}

impl Preset {
    /// All presets.
    pub const ALL: [Self; 4] = [
        Self::DYNABEADS_M450,
        Self::DYNABEADS_M280,
        Self::DYNABEADS_M270,
        Self::DYNABEADS_MYONE,
    ];

    /// Dynabeads M-450, 4.5 um. Every number is unverified, see its source.
    pub const DYNABEADS_M450: Self = Self {
        name: "Dynabeads M-450",
        radius: sourced(2.25e-6, 2.2e-6, 2.3e-6, RECALLED),
        density: sourced(1600.0, 1500.0, 1600.0, RECALLED),
        susceptibility: sourced(1.6, 1.0, 1.7, LITERATURE),
        saturation: sourced(31e3, 25e3, 35e3, SATURATION),
    };

    /// Dynabeads M-280, 2.8 um. Every number is unverified, see its source.
    pub const DYNABEADS_M280: Self = Self {
        name: "Dynabeads M-280",
        radius: sourced(1.4e-6, 1.38e-6, 1.42e-6, RECALLED),
        density: sourced(1400.0, 1300.0, 1800.0, RECALLED),
        susceptibility: sourced(0.75, 0.5, 0.9, LITERATURE),
        saturation: sourced(15e3, 12e3, 18e3, SATURATION),
    };

    /// Dynabeads M-270, 2.8 um. Every number is unverified, see its source.
    pub const DYNABEADS_M270: Self = Self {
        name: "Dynabeads M-270",
        radius: sourced(1.4e-6, 1.38e-6, 1.42e-6, RECALLED),
        density: sourced(1600.0, 1500.0, 1600.0, RECALLED),
        susceptibility: sourced(0.96, 0.7, 1.1, LITERATURE),
        saturation: sourced(21e3, 17e3, 24e3, SATURATION),
    };

    /// Dynabeads MyOne, 1.05 um. Every number is unverified, see its source.
    pub const DYNABEADS_MYONE: Self = Self {
        name: "Dynabeads MyOne",
        radius: sourced(0.525e-6, 0.5e-6, 0.55e-6, RECALLED),
        density: sourced(1800.0, 1700.0, 1800.0, RECALLED),
        susceptibility: sourced(1.4, 1.0, 1.5, LITERATURE),
        saturation: sourced(42e3, 35e3, 48e3, SATURATION),
    };

    /// A linear bead of the preset's values. Real ones saturate from 5 to 20 mT: see [`Preset::saturating`].
    ///
    /// # Errors
    /// None for the presets of this crate.
    pub fn bead(&self) -> Result<Bead, MagneticsError> {
        Bead::new(
            self.radius.value,
            self.density.value,
            Apparent::new(self.susceptibility.value)?,
        )
    }

    /// A bead of the preset's values whose magnetisation bends towards saturation.
    ///
    /// # Errors
    /// None for the presets of this crate.
    pub fn saturating(&self, shape: SaturationShape) -> Result<Bead, MagneticsError> {
        let slope = Apparent::new(self.susceptibility.value)?;
        let law = Saturation::new(shape, slope, self.saturation.value)?;
        Bead::new(self.radius.value, self.density.value, law)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lbm_ibm_coupling::Vec3;

    #[test]
    fn presets_are_within_their_own_spread_and_bend_where_beads_do() {
        for preset in Preset::ALL {
            for number in [preset.radius, preset.density, preset.susceptibility, preset.saturation] {
                assert!((number.spread[0]..=number.spread[1]).contains(&number.value));
            }
            let (linear, bent) = (
                preset.bead().unwrap(),
                preset.saturating(SaturationShape::Langevin).unwrap(),
            );
            let ratio = |b: f64| bent.response(Vec3::z() * b).moment.z / linear.response(Vec3::z() * b).moment.z;
            assert!(ratio(1e-4) > 0.999 && ratio(0.1) < 0.5, "{}", preset.name);
        }
    }
}
