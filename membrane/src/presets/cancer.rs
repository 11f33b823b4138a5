//! Breast cells and breast cancer cells, calibrated to the strains that the paper names.
//!
//! Where the force acts matters more than which cell it is: pulled at two patches (5 % of the nodes each) a cell needs
//! 2.8 to 3.1 times the shear modulus that it needs under the stress of an optical stretcher, for the same strain at
//! the same force on each half. The paper's cell was pulled at patches; the experiment was a stretcher.

use super::{CTC_DIAMETER, Outline, Preset};
use crate::{Material, Sheet};

/// The paper's force on each half of a cell in the optical stretcher, N: 105 pN at 800 mW, scaled to 600 mW.
pub const PAPER_FORCE: f64 = 105e-12 * 600.0 / 800.0;

/// What the six have in common. The strain at one force gives one modulus, the shear modulus; the area modulus of the
/// sheet is three times that, bending and volume are small and stiff.
const fn preset(kind: &'static str, shear: f64) -> Preset {
    Preset {
        kind,
        outline: Outline::Sphere(CTC_DIAMETER),
        material: Material {
            sheet: Sheet::Skalak,
            shear,
            dilation: 3.0 * shear,
            bending: 2e-19,
            area: 0.0,
            volume: 3e3,
            tension: 0.0,
        },
        nodes: 642,
        source: "strain at 600 mW: the paper after Guck et al., Biophys. J. 88, 3689, 2005; the force on each half the least \
                 of its 105 to 333 pN, scaled to the power; diameter: the paper; area modulus and bending are assumed",
    }
}

/// MCF-10: 10.5 % at [`PAPER_FORCE`] pulled at 5 % of the nodes at each end.
pub const MCF10: Preset = preset("MCF-10", 45.42e-6);
/// MCF-7: 21 %, likewise.
pub const MCF7: Preset = preset("MCF-7", 17.35e-6);
/// modMCF-7: 30 %, likewise.
pub const MOD_MCF7: Preset = preset("modMCF-7", 9.940e-6);
/// MCF-10: 10.5 % under the stress of an optical stretcher
/// ([`Load::CosineSquared`](crate::stretch::Load::CosineSquared)) that pulls each half by [`PAPER_FORCE`].
pub const MCF10_STRETCHER: Preset = preset("MCF-10", 15.95e-6);
/// MCF-7: 21 %, likewise.
pub const MCF7_STRETCHER: Preset = preset("MCF-7", 5.906e-6);
/// modMCF-7: 30 %, likewise.
pub const MOD_MCF7_STRETCHER: Preset = preset("modMCF-7", 3.250e-6);
