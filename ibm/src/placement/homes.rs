//! Which brick each marker is in.

use super::LEAF;
use crate::axis::Axis;
use crate::threads;
use lbm_ibm_coupling::{BRICK_EDGE, Work, on_widest};

/// Markers at a time.
const BATCH: usize = 64;
/// Brick of a marker that is outside the grid.
pub const OUTSIDE: u32 = u32::MAX;

/// Where a marker is: the brick of the lower corner of its stencil, the corner in that brick (below zero at a wall),
/// and the remainders that the kernel turns into weights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Home {
    pub f: [f64; 3],
    pub brick: u32,
    pub corner: [i8; 3],
}

/// The grid as markers see it.
pub struct Spots<'a> {
    pub axes: &'a [Axis; 3],
    pub per_spacing: f64,
    pub support: usize,
    pub counts: [usize; 3],
}

/// Finds the homes of the markers from number `first` on, on several threads where there are many.
pub fn homes(out: &mut [Home], first: usize, position: &(impl Fn(usize) -> [f64; 3] + Sync), spots: &Spots<'_>) {
    if out.len() <= LEAF {
        return on_widest(Homes {
            out,
            first,
            position,
            spots,
        });
    }
    let half = out.len() / 2;
    let (a, b) = out.split_at_mut(half);
    threads::join(
        || homes(a, first, position, spots),
        || homes(b, first + half, position, spots),
    );
}

struct Homes<'a, P> {
    out: &'a mut [Home],
    first: usize,
    position: &'a P,
    spots: &'a Spots<'a>,
}

impl<P: Fn(usize) -> [f64; 3]> Work for Homes<'_, P> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Spots {
            axes,
            per_spacing,
            support,
            counts,
        } = *self.spots;
        for (n, out) in self.out.chunks_mut(BATCH).enumerate() {
            let first = self.first + n * BATCH;
            let mut x = [[0.0; BATCH]; 3];
            for l in 0..out.len() {
                let p = (self.position)(first + l);
                (x[0][l], x[1][l], x[2][l]) = (p[0], p[1], p[2]);
            }
            let mut lower = [[0i32; BATCH]; 3];
            let mut within = [true; BATCH];
            for a in 0..3 {
                for l in 0..BATCH {
                    let (corner, f) = axes[a].corner(x[a][l], per_spacing, support);
                    within[l] &= axes[a].holds(corner);
                    lower[a][l] = corner as i32;
                    x[a][l] = f;
                }
            }
            for (l, home) in out.iter_mut().enumerate() {
                let mut brick = [0; 3];
                home.brick = 0;
                for a in 0..3 {
                    if within[l] {
                        let corner = lower[a][l] as usize;
                        brick[a] = corner / BRICK_EDGE;
                        home.corner[a] = (corner % BRICK_EDGE) as i8;
                        home.f[a] = x[a][l];
                        continue;
                    }
                    // Across a period, at a wall, or outside.
                    let x = (self.position)(first + l)[a];
                    let Some((b, corner, f)) = axes[a].home(x, per_spacing, support) else {
                        home.brick = OUTSIDE;
                        break;
                    };
                    (brick[a], home.corner[a], home.f[a]) = (b, corner, f);
                }
                if home.brick != OUTSIDE {
                    home.brick = ((brick[2] * counts[1] + brick[1]) * counts[0] + brick[0]) as u32;
                }
            }
        }
    }
}
