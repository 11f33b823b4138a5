//! Which instruction set runs the kernels.

use crate::collide::{FREE, PER_NODE, Span, UNIFORM, read, span};
use crate::d3q19::Q;
#[cfg(target_arch = "x86_64")]
use crate::simd::{Avx2, Avx512};
use crate::simd::{Pair, Simd};

/// Instruction set of the kernels. Results are the same to the last bit only on the same one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum InstructionSet {
    /// Plain Rust; any processor.
    Portable,
    /// Four numbers at a time, x86-64 with AVX2 and FMA.
    Avx2,
    /// Eight numbers at a time, x86-64 with AVX-512F.
    Avx512,
}

impl InstructionSet {
    /// The widest that this processor has.
    pub fn best() -> Self {
        [Self::Avx512, Self::Avx2]
            .into_iter()
            .find(|isa| isa.is_available())
            .unwrap_or(Self::Portable)
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => is_x86_feature_detected!("avx512f"),
            #[cfg(not(target_arch = "x86_64"))]
            _ => false,
        }
    }
}

type Collide = unsafe fn(&Span) -> [f64; 3];
type Read = unsafe fn(&[*mut f64; Q], usize, [*mut f64; 4]);

/// The kernels of one instruction set. Their contracts are those of [`span`] and [`read`], less the instruction set.
#[derive(Clone, Copy)]
pub struct Kernels {
    /// By force ([`FREE`], [`UNIFORM`], [`PER_NODE`]), without and with the sum of momentum.
    pub collide: [[Collide; 2]; 3],
    /// Density and momentum.
    pub read: Read,
}

impl Kernels {
    /// The kernels of `isa`, if this processor has it.
    pub fn new(isa: InstructionSet) -> Option<Self> {
        if !isa.is_available() {
            return None;
        }
        Some(match isa {
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => Self {
                collide: [
                    [span_avx512::<FREE, false>, span_avx512::<FREE, true>],
                    [span_avx512::<UNIFORM, false>, span_avx512::<UNIFORM, true>],
                    [span_avx512::<PER_NODE, false>, span_avx512::<PER_NODE, true>],
                ],
                read: read_avx512,
            },
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => Self {
                collide: [
                    [span_avx2::<FREE, false>, span_avx2::<FREE, true>],
                    [span_avx2::<UNIFORM, false>, span_avx2::<UNIFORM, true>],
                    [span_avx2::<PER_NODE, false>, span_avx2::<PER_NODE, true>],
                ],
                read: read_avx2,
            },
            _ => Self::portable::<Pair>(),
        })
    }

    /// The kernels of the widest instruction set of this processor.
    pub fn best() -> Self {
        Self::new(InstructionSet::best()).unwrap_or_else(Self::portable::<Pair>)
    }

    fn portable<V: Simd>() -> Self {
        Self {
            collide: [
                [span::<V, FREE, false>, span::<V, FREE, true>],
                [span::<V, UNIFORM, false>, span::<V, UNIFORM, true>],
                [span::<V, PER_NODE, false>, span::<V, PER_NODE, true>],
            ],
            read: read::<V>,
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
unsafe fn span_avx512<const FORCE: u8, const TALLY: bool>(s: &Span) -> [f64; 3] {
    // SAFETY: AVX-512F is enabled, the rest is the caller's contract.
    unsafe { span::<Avx512, FORCE, TALLY>(s) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f")]
unsafe fn read_avx512(places: &[*mut f64; Q], len: usize, to: [*mut f64; 4]) {
    // SAFETY: AVX-512F is enabled, the rest is the caller's contract.
    unsafe { read::<Avx512>(places, len, to) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn span_avx2<const FORCE: u8, const TALLY: bool>(s: &Span) -> [f64; 3] {
    // SAFETY: AVX2 and FMA are enabled, the rest is the caller's contract.
    unsafe { span::<Avx2, FORCE, TALLY>(s) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn read_avx2(places: &[*mut f64; Q], len: usize, to: [*mut f64; 4]) {
    // SAFETY: AVX2 and FMA are enabled, the rest is the caller's contract.
    unsafe { read::<Avx2>(places, len, to) }
}
