//! Cells of healthy blood, and a capsule.

use super::{Outline, Preset};
use crate::{Disc, Material, Sheet};

/// A human red blood cell, calibrated to optical tweezers.
///
/// Pulled by beads that hold its rim over 2 um ([`Load::Beads`](crate::stretch::Load::Beads)), its axial diameter is
/// inside the bars of Mills et al. 2004 from 16 to 193 pN, the transverse one from 88 pN, with 400 nodes as with 642.
/// The modulus of the whole area and that of the volume are penalties: they hold area and volume within 0.3 % at 193
/// pN, the real area modulus is 200 to 500 mN/m.
pub const RED_CELL: Preset = Preset {
    kind: "red cell",
    outline: Outline::Disc(Disc {
        diameter: 7.82e-6,
        volume: 94e-18,
        area: 135e-12,
        thickness: 2.58e-6,
    }),
    material: Material {
        sheet: Sheet::WormLikeChain(0.42),
        shear: 4e-6,
        dilation: 13e-6,
        bending: 2e-19,
        area: 3e-3,
        volume: 3e3,
        tension: 0.0,
    },
    nodes: 642,
    source: "shape: Evans and Fung, Microvasc. Res. 4, 335, 1972 (7.82 um, 94 um3, 135 um2); shear modulus 4 uN/m: Hochmuth \
             and Hampel, J. Rheol. 23, 669, 1979; extension and dilation: fitted to the optical tweezers of Mills et al. 2004 \
             and Suresh et al. 2005 as digitised by the authors of HemoCell; form of the springs: Fedosov et \
             al., Biophys. J. 98, 2215, 2010; bending 2e-19 J: usual value, UNVERIFIED",
};

/// A passive human neutrophil as a liquid drop with cortical tension.
///
/// The weak sheet (a twentieth of the tension) keeps the nodes apart and is no property of the cell. The inside is
/// about 1e5 times as viscous as water: what flows slowly is not in this membrane.
pub const NEUTROPHIL: Preset = Preset {
    kind: "neutrophil",
    outline: Outline::Sphere(8.4e-6),
    material: Material {
        sheet: Sheet::NeoHookean,
        shear: 1.5e-6,
        dilation: 4.5e-6,
        bending: 1e-18,
        area: 0.0,
        volume: 3e3,
        tension: 30e-6,
    },
    nodes: 642,
    source: "tension 30 uN/m (Hochmuth, J. Biomech. 33, 15, 2000; 35 uN/m in Evans and Yeung, Biophys. J. 56, 151, 1989); \
             diameter 8.4 um and bending 1e-18 J (Zhelev et al., Biophys. J. 67, 696, 1994): UNVERIFIED",
};

/// A passive human lymphocyte, likewise.
pub const LYMPHOCYTE: Preset = Preset {
    kind: "lymphocyte",
    outline: Outline::Sphere(7.0e-6),
    material: Material {
        tension: 35e-6,
        shear: 1.75e-6,
        dilation: 5.25e-6,
        ..NEUTROPHIL.material
    },
    nodes: 642,
    source: "diameter 7 um and tension 35 uN/m, taken like a neutrophil's: UNVERIFIED",
};

/// A resting human platelet: an oblate of 3 by 0.9 um.
pub const PLATELET: Preset = Preset {
    kind: "platelet",
    outline: Outline::Ellipsoid([3e-6, 3e-6, 0.9e-6]),
    material: Material {
        sheet: Sheet::Skalak,
        shear: 30e-6,
        dilation: 90e-6,
        bending: 2e-19,
        area: 1e-3,
        volume: 3e3,
        tension: 0.0,
    },
    nodes: 300,
    source: "shear modulus 30 uN/m from micropipettes (Haga et al., Ann. Biomed. Eng. 26, 268, 1998), size 3 by 0.9 um: UNVERIFIED",
};

/// A spherical capsule with a neo-Hookean membrane and nothing else, as in studies of capsules in shear flow: scale
/// its shear modulus to the capillary number mu gamma a/G that is wanted.
pub const CAPSULE: Preset = Preset {
    kind: "capsule",
    outline: Outline::Sphere(8e-6),
    material: Material {
        sheet: Sheet::NeoHookean,
        shear: 5e-6,
        dilation: 15e-6,
        bending: 0.0,
        area: 0.0,
        volume: 0.0,
        tension: 0.0,
    },
    nodes: 642,
    source: "a model, no cell: neo-Hookean with an area modulus of 3 G (Barthes-Biesel et al., J. Fluid Mech. 460, 211, 2002)",
};
