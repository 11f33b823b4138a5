//! A collision model, compiled for one instruction set and one precision, behind one object.

use crate::collide::{FREE, PER_NODE, Span, UNIFORM, lean_span, read, span, whole_span};
use crate::element::{Element, Half, Precision};
use crate::isa::InstructionSet;
use crate::model::Model;
use crate::scattered::{Scattered, scattered};
#[cfg(target_arch = "x86_64")]
use crate::simd::{F32x8, F32x16, F64x4, F64x8};
use crate::simd::{Lanes, Stored};
use crate::stencil::Velocities;
use std::marker::PhantomData;

/// Collides and reads spans.
pub trait Kernel: Send + Sync {
    /// Collides a span under a kind of force ([`FREE`], [`UNIFORM`], [`PER_NODE`]); returns the sum of the momentum before
    /// collision (lattice units) where `tally` is set, else anything.
    ///
    /// # Safety
    /// As for [`span`], less the instruction set. The numbers have the precision of this kernel.
    unsafe fn collide(&self, span: &Span, force: u8, tally: bool) -> [f64; 3];

    /// Collides a batch of packed nodes in an odd step under [`FREE`] or [`UNIFORM`] force; returns as [`Kernel::collide`] does.
    ///
    /// # Safety
    /// As for [`scattered`], less the instruction set. The numbers have the precision of this kernel.
    unsafe fn collide_scattered(&self, batch: &Scattered, force: u8, tally: bool) -> [f64; 3];

    /// Writes density (less 1) and momentum, lattice units, of the nodes of a span to `to`.
    ///
    /// # Safety
    /// As for [`read`], less the instruction set. The numbers have the precision of this kernel.
    unsafe fn read(&self, span: &Span, to: [*mut f64; 4]);

    /// The stencil.
    fn velocities(&self) -> Velocities;

    /// The derivative of the collided populations by those before, about rest, row after row.
    fn derivative(&self) -> Vec<f64>;

    /// The same model with another instruction set, which must be available, or another precision.
    fn rebuilt(&self, isa: InstructionSet, precision: Precision) -> Box<dyn Kernel>;
}

/// The kernel of a model, a function for each kind of force. The instruction set must be available.
pub fn build<M: Model<Q>, const Q: usize>(model: M, isa: InstructionSet, precision: Precision) -> Box<dyn Kernel> {
    compiled::<M, false, Q>(model, isa, precision)
}

/// The kernel of a model, one function for all kinds of force: a tenth of the code, for what is seldom used. Where bandwidth binds it
/// is as fast. The instruction set must be available.
pub fn build_lean<M: Model<Q>, const Q: usize>(model: M, isa: InstructionSet, precision: Precision) -> Box<dyn Kernel> {
    compiled::<M, true, Q>(model, isa, precision)
}

fn compiled<M: Model<Q>, const LEAN: bool, const Q: usize>(
    model: M,
    isa: InstructionSet,
    precision: Precision,
) -> Box<dyn Kernel> {
    assert!(isa.is_available());
    match (isa, precision) {
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx512, Precision::F64) => Built::<M, f64, F64x8, Avx512, LEAN, Q>::boxed(model),
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx512, Precision::F32) => Built::<M, f32, F32x16, Avx512, LEAN, Q>::boxed(model),
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx512, Precision::F16) => Built::<M, Half, F32x16, Avx512, LEAN, Q>::boxed(model),
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx2, Precision::F64) => Built::<M, f64, F64x4, Avx2, LEAN, Q>::boxed(model),
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx2, Precision::F32) => Built::<M, f32, F32x8, Avx2, LEAN, Q>::boxed(model),
        #[cfg(target_arch = "x86_64")]
        (InstructionSet::Avx2, Precision::F16) => Built::<M, Half, F32x8, Avx2, LEAN, Q>::boxed(model),
        (_, Precision::F64) => Built::<M, f64, Lanes<f64, 2>, Plain, LEAN, Q>::boxed(model),
        (_, Precision::F32) => Built::<M, f32, Lanes<f32, 4>, Plain, LEAN, Q>::boxed(model),
        (_, Precision::F16) => Built::<M, Half, Lanes<f32, 4>, Plain, LEAN, Q>::boxed(model),
    }
}

struct Built<M, S, V, I, const LEAN: bool, const Q: usize> {
    model: M,
    kind: PhantomData<(S, V, I)>,
}

impl<M, S, V, I, const LEAN: bool, const Q: usize> Built<M, S, V, I, LEAN, Q>
where
    M: Model<Q>,
    S: Element,
    V: Stored<S> + Send + Sync + 'static,
    I: Enable,
{
    fn boxed(model: M) -> Box<dyn Kernel> {
        Box::new(Self {
            model,
            kind: PhantomData,
        })
    }
}

impl<M, S, V, I, const LEAN: bool, const Q: usize> Kernel for Built<M, S, V, I, LEAN, Q>
where
    M: Model<Q>,
    S: Element,
    V: Stored<S> + Send + Sync + 'static,
    I: Enable,
{
    unsafe fn collide(&self, span: &Span, force: u8, tally: bool) -> [f64; 3] {
        // SAFETY: the instruction set was asked for in `build`; the rest is the caller's contract.
        unsafe {
            // Only the functions of one branch are compiled.
            if LEAN {
                // Without vectors, and in 16 bits, speed is no concern.
                if !const { I::VECTORS && size_of::<S>() > 2 } || force != FREE || tally {
                    return I::lean_span::<M, S, V, Q>(&self.model, span);
                }
                let [head, whole, tail] = span.parts::<V>();
                for end in [head, tail] {
                    if end.len > 0 {
                        I::lean_span::<M, S, V, Q>(&self.model, &end);
                    }
                }
                I::whole_span::<M, S, V, Q>(&self.model, &whole);
                return [0.0; 3];
            }
            match (force, tally) {
                (FREE, false) => I::span::<M, S, V, Q, FREE, false>(&self.model, span),
                (PER_NODE, false) => I::span::<M, S, V, Q, PER_NODE, false>(&self.model, span),
                (PER_NODE, true) => I::span::<M, S, V, Q, PER_NODE, true>(&self.model, span),
                (_, false) => I::span::<M, S, V, Q, UNIFORM, false>(&self.model, span),
                (_, true) => I::span::<M, S, V, Q, UNIFORM, true>(&self.model, span),
            }
        }
    }

    unsafe fn collide_scattered(&self, batch: &Scattered, force: u8, tally: bool) -> [f64; 3] {
        // SAFETY: the instruction set was asked for in `build`; the rest is the caller's contract.
        unsafe {
            // The same arithmetic as that of the span, with a force or without.
            let lean = LEAN && (!const { I::VECTORS && size_of::<S>() > 2 } || tally);
            if lean || force != FREE {
                I::scattered::<M, S, V, Q, true>(&self.model, batch)
            } else {
                I::scattered::<M, S, V, Q, false>(&self.model, batch)
            }
        }
    }

    unsafe fn read(&self, span: &Span, to: [*mut f64; 4]) {
        // SAFETY: the instruction set was asked for in `build`; the rest is the caller's contract.
        unsafe { I::read::<M, S, V, Q>(span, to) }
    }

    fn velocities(&self) -> Velocities {
        Velocities::of::<M::Stencil, Q>()
    }

    fn derivative(&self) -> Vec<f64> {
        derivative(&self.model)
    }

    fn rebuilt(&self, isa: InstructionSet, precision: Precision) -> Box<dyn Kernel> {
        compiled::<M, LEAN, Q>(self.model.clone(), isa, precision)
    }
}

/// See [`Kernel::derivative`]: central differences, so small that what is not linear vanishes.
fn derivative<M: Model<Q>, const Q: usize>(model: &M) -> Vec<f64> {
    let step = 1e-6;
    let mut all = vec![0.0; Q * Q];
    for j in 0..Q {
        let moved = |by: f64| {
            let mut f = [0.0; Q];
            f[j] = by;
            model.collide::<f64, false>(&mut f, [0.0; 3]);
            f
        };
        let (high, low) = (moved(step), moved(-step));
        for i in 0..Q {
            all[i * Q + j] = (high[i] - low[i]) / (2.0 * step);
        }
    }
    all
}

/// Functions compiled with the instructions of a set.
trait Enable: Send + Sync + 'static {
    /// Whether there are vectors.
    const VECTORS: bool;
    /// # Safety
    /// As for [`span`].
    unsafe fn span<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize, const FORCE: u8, const TALLY: bool>(
        model: &M,
        s: &Span,
    ) -> [f64; 3];
    /// # Safety
    /// As for [`lean_span`].
    unsafe fn lean_span<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(model: &M, s: &Span) -> [f64; 3];
    /// # Safety
    /// As for [`whole_span`].
    unsafe fn whole_span<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(model: &M, s: &Span);
    /// # Safety
    /// As for [`scattered`].
    unsafe fn scattered<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize, const FORCE: bool>(
        model: &M,
        s: &Scattered,
    ) -> [f64; 3];
    /// # Safety
    /// As for [`read`].
    unsafe fn read<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(s: &Span, to: [*mut f64; 4]);
}

macro_rules! enable {
    ($(#[$config:meta])* $name:ident, $vectors:literal $(, $features:literal)?) => {
        $(#[$config])*
        struct $name;

        $(#[$config])*
        impl Enable for $name {
            const VECTORS: bool = $vectors;

            #[inline]
            unsafe fn span<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize, const FORCE: u8, const TALLY: bool>(
                model: &M,
                s: &Span,
            ) -> [f64; 3] {
                $(#[target_feature(enable = $features)])?
                unsafe fn compiled<M, S, V, const Q: usize, const FORCE: u8, const TALLY: bool>(
                    model: &M,
                    s: &Span,
                ) -> [f64; 3]
                where
                    M: Model<Q>,
                    S: Element,
                    V: Stored<S>,
                {
                    // SAFETY: the instructions are enabled, the rest is the caller's contract.
                    unsafe { span::<M, S, V, Q, FORCE, TALLY>(model, s) }
                }
                // SAFETY: the caller's contract.
                unsafe { compiled::<M, S, V, Q, FORCE, TALLY>(model, s) }
            }

            #[inline]
            unsafe fn lean_span<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(model: &M, s: &Span) -> [f64; 3] {
                $(#[target_feature(enable = $features)])?
                unsafe fn compiled<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(model: &M, s: &Span) -> [f64; 3] {
                    // SAFETY: the instructions are enabled, the rest is the caller's contract.
                    unsafe { lean_span::<M, S, V, Q>(model, s) }
                }
                // SAFETY: the caller's contract.
                unsafe { compiled::<M, S, V, Q>(model, s) }
            }

            #[inline]
            unsafe fn whole_span<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(model: &M, s: &Span) {
                $(#[target_feature(enable = $features)])?
                unsafe fn compiled<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(model: &M, s: &Span) {
                    // SAFETY: the instructions are enabled, the rest is the caller's contract.
                    unsafe { whole_span::<M, S, V, Q>(model, s) }
                }
                // SAFETY: the caller's contract.
                unsafe { compiled::<M, S, V, Q>(model, s) }
            }

            #[inline]
            unsafe fn scattered<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize, const FORCE: bool>(
                model: &M,
                s: &Scattered,
            ) -> [f64; 3] {
                $(#[target_feature(enable = $features)])?
                unsafe fn compiled<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize, const FORCE: bool>(
                    model: &M,
                    s: &Scattered,
                ) -> [f64; 3] {
                    // SAFETY: the instructions are enabled, the rest is the caller's contract.
                    unsafe { scattered::<M, S, V, Q, FORCE>(model, s) }
                }
                // SAFETY: the caller's contract.
                unsafe { compiled::<M, S, V, Q, FORCE>(model, s) }
            }

            #[inline]
            unsafe fn read<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(s: &Span, to: [*mut f64; 4]) {
                $(#[target_feature(enable = $features)])?
                unsafe fn compiled<M: Model<Q>, S: Element, V: Stored<S>, const Q: usize>(s: &Span, to: [*mut f64; 4]) {
                    // SAFETY: the instructions are enabled, the rest is the caller's contract.
                    unsafe { read::<M, S, V, Q>(s, to) }
                }
                // SAFETY: the caller's contract.
                unsafe { compiled::<M, S, V, Q>(s, to) }
            }
        }
    };
}

enable!(Plain, false);
enable!(
    #[cfg(target_arch = "x86_64")]
    Avx2,
    true,
    "avx2,fma,f16c"
);
enable!(
    #[cfg(target_arch = "x86_64")]
    Avx512,
    true,
    "avx512f"
);
