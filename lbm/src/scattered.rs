//! Collision of packed nodes in an odd step, most of their populations where they stand.

use crate::element::Element;
use crate::ferry::{BLOCKS, Parts, STRIDE, block_lanes};
use crate::model::Model;
use crate::simd::{Stored, prefetch};
use crate::stencil::opposite;

/// A whole batch of packed nodes. Of each population and block the fullest part is read and written where it stands, the others in a
/// [`Buffer`](crate::ferry::Buffer).
pub struct Scattered<'a> {
    /// Start of the memory.
    pub data: *mut u8,
    /// Place of population 0 of the first node; the other nodes follow.
    pub rest: *mut u8,
    /// Start of the buffer.
    pub buffer: *mut u8,
    /// The fullest parts.
    pub main: Parts<'a>,
    /// Sources of a batch that comes later, and how many nodes on it is.
    pub early: (&'a [u32], usize),
    /// Start and bytes of lists that come later still.
    pub lists: [(*const u8, usize); 4],
    /// Force on every node, lattice units.
    pub uniform: [f64; 3],
}

/// Collides the nodes; returns the sum of the momentum before collision, lattice units. Without `FORCE` there is none.
///
/// # Safety
/// The instruction set of `V` is there. The parts are those of whole blocks of such numbers, their lanes and the buffer's are valid, and no
/// other thread touches them.
#[inline(always)]
pub unsafe fn scattered<M, S, V, const Q: usize, const FORCE: bool>(model: &M, s: &Scattered) -> [f64; 3]
where
    M: Model<Q>,
    S: Element,
    V: Stored<S>,
{
    let lanes = block_lanes(size_of::<S>());
    let main = &s.main;
    assert!(main.sources.len() == (Q - 1) * BLOCKS && main.masks.len() == (Q - 1) * BLOCKS * lanes / 8);
    let (early, _) = s.early.0.as_chunks::<BLOCKS>();
    // SAFETY: the contract of this function is that of every call below; masks say which lanes there are, and there are as many sources
    // and masks as the assertion has it.
    unsafe {
        let uniform = [V::splat(s.uniform[0]), V::splat(s.uniform[1]), V::splat(s.uniform[2])];
        let mut sum = [V::splat(0.0); 3];
        for block in 0..BLOCKS {
            for part in 0..const { block_lanes(size_of::<S>()) / V::LANES } {
                let from = part * V::LANES;
                let x = block * lanes + from;
                let data = s.data.cast::<S>().wrapping_add(from);
                let rest = s.rest.cast::<S>().wrapping_add(x);
                let room = s.buffer.cast::<S>().wrapping_add(x);
                // Loops as short as these are unrolled, and populations stay in registers.
                let mut f = [V::load(rest); Q];
                for i in 1..Q {
                    f[i] = V::load(room.wrapping_byte_add(i * STRIDE));
                }
                for i in 1..Q {
                    let n = (i - 1) * BLOCKS + block;
                    let place = data.wrapping_add(*main.sources.get_unchecked(n) as usize);
                    f[i] = f[i].load_lanes(place, main.mask_unchecked(n, lanes) >> from);
                }
                // Among the loads these cost less than among the stores.
                if part == 0 {
                    prefetch(rest.wrapping_add(s.early.1));
                    for sources in early {
                        prefetch(data.wrapping_add(sources[block] as usize));
                    }
                    for (list, bytes) in s.lists {
                        prefetch(list.wrapping_add(bytes * block / BLOCKS));
                    }
                }
                let momentum = model.collide::<V, FORCE>(&mut f, uniform);
                f[0].store(rest);
                for i in 1..Q {
                    let n = (i - 1) * BLOCKS + block;
                    let place = data.wrapping_add(*main.sources.get_unchecked(n) as usize);
                    f[opposite(i)].store_lanes(place, main.mask_unchecked(n, lanes) >> from);
                }
                for i in 1..Q {
                    f[opposite(i)].store(room.wrapping_byte_add(i * STRIDE));
                }
                for a in 0..3 {
                    sum[a] = sum[a] + momentum[a];
                }
            }
        }
        [sum[0].sum(), sum[1].sum(), sum[2].sum()]
    }
}
