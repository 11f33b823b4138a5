//! A homogeneous field.

use super::FieldSource;
use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::Matrix3;

/// A homogeneous field, the same everywhere, that may change in time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Uniform {
    /// B for all time.
    Constant {
        /// Flux density, T.
        field: Vec3,
    },
    /// From one value to another, linear in time, constant before and after.
    Ramp {
        /// Flux density up to `start`, T.
        from: Vec3,
        /// Flux density from `start + duration` on, T.
        to: Vec3,
        /// When the ramp begins, s.
        start: f64,
        /// How long it takes, s; zero is a switch.
        duration: f64,
    },
    /// B(t) = bias + cosine cos(2 pi f t) + sine sin(2 pi f t).
    Rotating {
        /// Flux density that stays, T.
        bias: Vec3,
        /// Amplitude in phase, T.
        cosine: Vec3,
        /// Amplitude a quarter turn later, T.
        sine: Vec3,
        /// Frequency f, Hz.
        frequency: f64,
    },
}

impl Uniform {
    /// A constant field (T).
    pub fn new(field: Vec3) -> Self {
        Self::Constant { field }
    }

    /// Flux density (T) at time `t` (s).
    pub fn at(&self, t: f64) -> Vec3 {
        match *self {
            Self::Constant { field } => field,
            Self::Ramp {
                from,
                to,
                start,
                duration,
            } => {
                let s = if t >= start + duration {
                    1.0
                } else if t <= start {
                    0.0
                } else {
                    (t - start) / duration
                };
                from * (1.0 - s) + to * s
            }
            Self::Rotating {
                bias,
                cosine,
                sine,
                frequency,
            } => {
                let (s, c) = (std::f64::consts::TAU * frequency * t).sin_cos();
                bias + cosine * c + sine * s
            }
        }
    }
}

impl FieldSource for Uniform {
    fn field(&self, _x: Vec3, t: f64) -> Vec3 {
        self.at(t)
    }

    fn gradient(&self, _x: Vec3, _t: f64) -> Matrix3<f64> {
        Matrix3::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn ramps_and_turns_pass_through_their_values() {
        let ramp = Uniform::Ramp {
            from: Vec3::zeros(),
            to: Vec3::z() * 0.05,
            start: 1.0,
            duration: 2.0,
        };
        assert_eq!(ramp.at(0.0), Vec3::zeros());
        assert_relative_eq!(ramp.at(2.0).z, 0.025);
        assert_relative_eq!(ramp.at(9.0).z, 0.05);
        let switch = Uniform::Ramp {
            from: Vec3::zeros(),
            to: Vec3::x(),
            start: 1.0,
            duration: 0.0,
        };
        assert_eq!(switch.at(0.999).x, 0.0);
        assert_eq!(switch.at(1.0).x, 1.0);
        let turning = Uniform::Rotating {
            bias: Vec3::z(),
            cosine: Vec3::x(),
            sine: Vec3::y(),
            frequency: 2.0,
        };
        assert_relative_eq!(turning.at(0.125), Vec3::new(0.0, 1.0, 1.0), epsilon = 1e-15);
    }
}
