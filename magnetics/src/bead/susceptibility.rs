//! Two susceptibilities that data sheets mix up.

use crate::error::MagneticsError;

/// Susceptibility of the material, M/H with H the field *inside*: mu_r = 1 + chi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intrinsic(f64);

/// Slope M/H of a bead with H the field *applied*, as data sheets and magnetometers give it: chi/(1 + chi/3) of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apparent(f64);

impl Intrinsic {
    /// An intrinsic susceptibility.
    ///
    /// # Errors
    /// [`MagneticsError::Susceptibility`] unless it is finite and above -1.
    pub fn new(chi: f64) -> Result<Self, MagneticsError> {
        if chi.is_finite() && chi > -1.0 {
            Ok(Self(chi))
        } else {
            Err(MagneticsError::Susceptibility {
                kind: "intrinsic",
                value: chi,
                low: -1.0,
                high: f64::INFINITY,
            })
        }
    }

    /// Its value.
    pub fn value(self) -> f64 {
        self.0
    }
}

impl Apparent {
    /// An apparent susceptibility.
    ///
    /// # Errors
    /// [`MagneticsError::Susceptibility`] unless it lies between -3/2 and 3: no sphere has another.
    pub fn new(slope: f64) -> Result<Self, MagneticsError> {
        if slope > -1.5 && slope < 3.0 {
            Ok(Self(slope))
        } else {
            Err(MagneticsError::Susceptibility {
                kind: "apparent",
                value: slope,
                low: -1.5,
                high: 3.0,
            })
        }
    }

    /// Its value.
    pub fn value(self) -> f64 {
        self.0
    }
}

impl From<Apparent> for Intrinsic {
    fn from(a: Apparent) -> Self {
        Self(a.0 / (1.0 - a.0 / 3.0))
    }
}

impl From<Intrinsic> for Apparent {
    fn from(i: Intrinsic) -> Self {
        Self(i.0 / (1.0 + i.0 / 3.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn each_is_the_other_and_bad_values_are_named() {
        let a = Apparent::new(1.2).unwrap();
        assert_relative_eq!(Intrinsic::from(a).value(), 2.0, max_relative = 1e-14);
        assert_relative_eq!(Apparent::from(Intrinsic::from(a)).value(), 1.2, max_relative = 1e-14);
        assert!(Intrinsic::new(-1.0).is_err() && Intrinsic::new(f64::NAN).is_err());
        assert!(Apparent::new(3.0).is_err() && Apparent::new(f64::NAN).is_err());
    }
}
