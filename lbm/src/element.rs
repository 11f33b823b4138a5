//! What a population is stored as.

/// How the populations are stored, and in what they are computed. They are stored less their weights, which keeps the fine
/// digits of a slow flow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Precision {
    /// 64 bits: 304 bytes read and written per node and step on D3Q19.
    #[default]
    F64,
    /// 32 bits, arithmetic as well: half the memory and time. The viscosity that a shear wave of 64 nodes shows is off by
    /// 8e-6, a channel of 8 nodes by 1.4e-6 of its greatest velocity.
    F32,
    /// 16 bits (IEEE half, scaled), arithmetic in 32: a quarter of the memory. A population keeps three digits, and roundings
    /// add up: the viscosity of the same wave is 3.4 to 4.4 % too low at amplitudes of 1e-2 to 1e-4 lattice units, the channel
    /// 0.4 % off. To look at a flow, not to measure it.
    F16,
}

impl Precision {
    /// Bytes of a stored population.
    pub fn bytes(self) -> usize {
        match self {
            Self::F64 => 8,
            Self::F32 => 4,
            Self::F16 => 2,
        }
    }
}

/// A stored population.
///
/// # Safety
/// All bits zero is the number 0.
pub unsafe trait Element: Copy + Send + Sync + 'static {
    /// The number.
    fn get(self) -> f64;
    /// The nearest to a number.
    fn near(value: f64) -> Self;
}

// SAFETY: as IEEE 754 has it.
unsafe impl Element for f64 {
    #[inline(always)]
    fn get(self) -> f64 {
        self
    }
    #[inline(always)]
    fn near(value: f64) -> Self {
        value
    }
}

// SAFETY: as IEEE 754 has it.
unsafe impl Element for f32 {
    #[inline(always)]
    fn get(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn near(value: f64) -> Self {
        value as Self
    }
}

/// A number times [`Half::SCALE`] as IEEE half: its greatest is 2, its least step 2^-39.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Half(pub u16);

impl Half {
    /// What a number is multiplied by.
    pub const SCALE: f32 = 32768.0;

    /// The number.
    #[inline(always)]
    pub fn to_f32(self) -> f32 {
        let bits = u32::from(self.0);
        let sign = (bits & 0x8000) << 16;
        let rest = bits & 0x7fff;
        let magnitude = if rest >= 0x7c00 {
            f32::from_bits(0x7f80_0000 | (rest & 0x3ff) << 13)
        } else {
            // The bits of a half, read as those of a single, are that half times 2^-112.
            f32::from_bits(rest << 13) * f32::from_bits((254 - 15) << 23)
        };
        f32::from_bits(magnitude.to_bits() | sign) * (1.0 / Self::SCALE)
    }

    /// The nearest to a number, ties to even; infinite from 2 on.
    #[inline(always)]
    pub fn from_f32(value: f32) -> Self {
        let bits = (value * Self::SCALE).to_bits();
        let sign = (bits >> 16) as u16 & 0x8000;
        let rest = bits & 0x7fff_ffff;
        let half = if rest > 0x7f80_0000 {
            0x7e00
        } else if rest >= 0x4780_0000 {
            0x7c00
        } else if rest < 0x3880_0000 {
            // Below the least normal half the step is 2^-24: adding 1/2 leaves the rounded multiple in the last bits.
            ((f32::from_bits(rest) + 0.5).to_bits() - 0.5_f32.to_bits()) as u16
        } else {
            let rounded = rest + 0xfff + (rest >> 13 & 1);
            ((rounded - (112 << 23)) >> 13) as u16
        };
        Self(half | sign)
    }
}

// SAFETY: as IEEE 754 has it.
unsafe impl Element for Half {
    #[inline(always)]
    fn get(self) -> f64 {
        f64::from(self.to_f32())
    }
    #[inline(always)]
    fn near(value: f64) -> Self {
        Self::from_f32(value as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_half_survives_the_way_there_and_back() {
        for bits in 0..=u16::MAX {
            let half = Half(bits);
            let value = half.to_f32();
            if value.is_nan() {
                assert!(Half::from_f32(value).to_f32().is_nan());
            } else {
                assert_eq!(Half::from_f32(value), half, "{value:e}");
            }
        }
    }

    #[test]
    fn numbers_between_halves_go_to_the_nearest_with_ties_to_even() {
        for bits in 0..0x7bff_u16 {
            let (low, high) = (Half(bits).to_f32(), Half(bits + 1).to_f32());
            let even = Half(bits + (bits & 1));
            assert_eq!(Half::from_f32(0.5 * (low + high)), even, "{bits}");
            assert_eq!(Half::from_f32(low + 0.49 * (high - low)), Half(bits));
            assert_eq!(Half::from_f32(-(low + 0.51 * (high - low))), Half((bits + 1) | 0x8000));
        }
        assert_eq!(Half::from_f32(2.0).to_f32(), f32::INFINITY);
        assert_eq!(Half(1).to_f32(), 2.0_f32.powi(-39));
    }
}
