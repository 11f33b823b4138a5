//! Sums over all dipoles: the arithmetic under every rung.
//!
//! For a target at `x` with moment `m` and sources `j` with r = x - x_j (all without the factor mu0/(4 pi)):
//! field = sum 3 (m_j.r) r/r^5 - m_j/r^3, force = 3 sum r^-5 [(m_j.r) m + (m.r) m_j + (m.m_j - 5 (m.r)(m_j.r)/r^2) r].
//! Sources within the near distance, the target itself among them, are left out: the caller adds them by [`Overlap`].

#[cfg(target_arch = "x86_64")]
mod avx512;
mod both;
pub(crate) mod lanes;
mod overlap;
mod portable;

pub(crate) use overlap::Overlap;

use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::ops::Range;

/// Lanes of the widest kernel; arrays are padded to a multiple of it.
const LANES: usize = 8;
/// Targets that one task takes.
const BLOCK: usize = 64;

/// Dipoles as sources, padded with dipoles of no moment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sources {
    x: [Vec<f64>; 3],
    m: [Vec<f64>; 3],
}

/// What a target gets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sum {
    pub field: Vec3,
    pub force: Vec3,
}

impl Sum {
    pub fn zero() -> Self {
        Self {
            field: Vec3::zeros(),
            force: Vec3::zeros(),
        }
    }
}

/// Which sums are wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Want {
    Field,
    Force,
    Both,
}

impl Sources {
    pub fn set_positions(&mut self, x: Soa3Ref<'_>) {
        pad(&mut self.x, x);
    }

    pub fn set_moments(&mut self, m: Soa3Ref<'_>) {
        pad(&mut self.m, m);
    }

    /// Takes the dipoles of some ranges of `x` and `m`.
    pub fn collect(&mut self, x: &Soa3, m: &Soa3, ranges: impl Iterator<Item = Range<usize>>) {
        let (to_x, to_m) = (&mut self.x, &mut self.m);
        to_x.iter_mut().chain(to_m.iter_mut()).for_each(Vec::clear);
        for range in ranges {
            for (to, from) in to_x.iter_mut().zip([&x.x, &x.y, &x.z]) {
                to.extend_from_slice(&from[range.clone()]);
            }
            for (to, from) in to_m.iter_mut().zip([&m.x, &m.y, &m.z]) {
                to.extend_from_slice(&from[range.clone()]);
            }
        }
        let padded = to_x[0].len().next_multiple_of(LANES);
        to_x.iter_mut()
            .chain(to_m.iter_mut())
            .for_each(|c| c.resize(padded, 0.0));
    }
}

/// Calls `f` with each piece of work and some scratch; the pieces are shared between threads.
pub(crate) fn each<T: Send, S>(
    work: Vec<T>,
    scratch: impl Fn() -> S + Sync + Send,
    f: impl Fn(&mut S, T) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        work.into_par_iter().for_each_init(scratch, f);
        return;
    }
    let mut scratch = scratch();
    work.into_iter().for_each(|w| f(&mut scratch, w));
}

fn pad(to: &mut [Vec<f64>; 3], from: Soa3Ref<'_>) {
    let padded = from.len().next_multiple_of(LANES);
    for (to, from) in to.iter_mut().zip([from.x, from.y, from.z]) {
        to.clear();
        to.extend_from_slice(from);
        to.resize(padded, 0.0);
    }
}

/// Sums of all sources at every target, in place in `field` and `force` where wanted.
pub(crate) fn sums(
    sources: &Sources,
    x: Soa3Ref<'_>,
    m: Soa3Ref<'_>,
    near: f64,
    want: Want,
    field: &mut Soa3,
    force: &mut Soa3,
) {
    let n = x.len();
    let near2 = near * near;
    let block = |first: usize| -> [Sum; BLOCK] {
        let mut out = [Sum::zero(); BLOCK];
        let last = (first + BLOCK).min(n);
        for (o, i) in out.iter_mut().zip(first..last) {
            let moment = if want == Want::Field { Vec3::zeros() } else { m.get(i) };
            *o = one(sources, x.get(i), moment, near2, want);
        }
        out
    };
    if want != Want::Force {
        field.resize(n);
    }
    if want != Want::Field {
        force.resize(n);
    }
    let mut store = |first: usize, sums: &[Sum]| {
        for (i, sum) in (first..n).zip(sums) {
            if want != Want::Force {
                field.set(i, sum.field);
            }
            if want != Want::Field {
                force.set(i, sum.force);
            }
        }
    };
    #[cfg(feature = "parallel")]
    if n > BLOCK && rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        let blocks: Vec<_> = (0..n.div_ceil(BLOCK))
            .into_par_iter()
            .map(|b| block(b * BLOCK))
            .collect();
        for (b, sums) in blocks.iter().enumerate() {
            store(b * BLOCK, sums);
        }
        return;
    }
    for first in (0..n).step_by(BLOCK) {
        store(first, &block(first));
    }
}

/// Sum of the forces of `by` on the moments `on` and of `also_by` on `also_on`, in place in `force`; `by` and `also_by` have
/// the same positions.
pub(crate) fn two_forces(
    [by, also_by]: [&Sources; 2],
    x: Soa3Ref<'_>,
    [on, also_on]: [Soa3Ref<'_>; 2],
    near: f64,
    force: &mut Soa3,
) {
    let near2 = near * near;
    let mut out = vec![Vec3::zeros(); x.len()];
    each(
        out.chunks_mut(BLOCK).enumerate().collect(),
        || (),
        |_, (block, out)| {
            for (o, i) in out.iter_mut().zip(block * BLOCK..) {
                *o = lanes::run(both::Both {
                    by,
                    also_by,
                    x: x.get(i),
                    on: on.get(i),
                    also_on: also_on.get(i),
                    near2,
                });
            }
        },
    );
    force.resize(x.len());
    out.iter().enumerate().for_each(|(i, f)| force.set(i, *f));
}

/// Sums of all sources at one target.
pub(crate) fn one(sources: &Sources, x: Vec3, m: Vec3, near2: f64, want: Want) -> Sum {
    #[cfg(target_arch = "x86_64")]
    {
        if std::arch::is_x86_feature_detected!("avx512f") {
            return avx512::one(sources, x, m, near2, want);
        }
        if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
            return portable::one_avx2(sources, x, m, near2, want);
        }
    }
    portable::one(sources, x, m, near2, want)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn every_kernel_has_the_sum_of_the_plain_formula() {
        let mut seed = 3u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let mut vectors = |scale: f64| -> Soa3 {
            (0..37)
                .map(|_| Vec3::new(random(), random(), random()) * scale)
                .collect()
        };
        let (x, m) = (vectors(1e-4), vectors(1e-12));
        let mut sources = Sources::default();
        sources.set_positions(x.view());
        sources.set_moments(m.view());
        let near = 1e-5f64;
        for i in 0..37 {
            let mut plain = Sum::zero();
            for j in 0..37 {
                let r = x.get(i) - x.get(j);
                if r.norm() < near {
                    continue;
                }
                let pair = Overlap::point(r.norm());
                plain.field += pair.field(m.get(j), r);
                plain.force += pair.force(m.get(i), m.get(j), r);
            }
            let mut all = vec![portable::one(&sources, x.get(i), m.get(i), near * near, Want::Both)];
            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx512f") {
                all.push(avx512::one(&sources, x.get(i), m.get(i), near * near, Want::Both));
                let force = avx512::one(&sources, x.get(i), m.get(i), near * near, Want::Force).force;
                assert_relative_eq!(force, plain.force, epsilon = 1e-13 * plain.force.norm());
                let field = avx512::one(&sources, x.get(i), m.get(i), near * near, Want::Field).field;
                assert_relative_eq!(field, plain.field, epsilon = 1e-13 * plain.field.norm());
            }
            for sum in all {
                assert_relative_eq!(sum.field, plain.field, epsilon = 1e-13 * plain.field.norm());
                assert_relative_eq!(sum.force, plain.force, epsilon = 1e-13 * plain.force.norm());
            }
        }
    }
}
