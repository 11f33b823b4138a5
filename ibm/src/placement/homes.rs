//! Which brick each marker is in.

use super::LEAF;
use crate::axis::Axis;
use crate::threads;
use lbm_ibm_coupling::{BRICK_EDGE, Work, on_widest};

/// Markers at a time.
const BATCH: usize = 64;
/// Nodes along each edge of a brick.
const EDGE: u32 = BRICK_EDGE as u32;
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

impl Spots<'_> {
    /// Home of a marker (m) anywhere: across a period, at a wall, or outside.
    fn home(&self, x: [f64; 3]) -> Home {
        let (mut home, mut brick) = (Home::default(), [0; 3]);
        for a in 0..3 {
            let Some(found) = self.axes[a].home(x[a], self.per_spacing, self.support) else {
                home.brick = OUTSIDE;
                return home;
            };
            (brick[a], home.corner[a], home.f[a]) = found;
        }
        home.brick = ((brick[2] * self.counts[1] + brick[1]) * self.counts[0] + brick[0]) as u32;
        home
    }
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
        let [row, rows] = [counts[0], counts[1]].map(|n| n as u32);
        for (n, out) in self.out.chunks_mut(BATCH).enumerate() {
            let first = self.first + n * BATCH;
            let mut x = [[0.0; BATCH]; 3];
            for l in 0..out.len() {
                let p = (self.position)(first + l);
                (x[0][l], x[1][l], x[2][l]) = (p[0], p[1], p[2]);
            }
            let (mut lower, mut f) = ([[0i32; BATCH]; 3], [[0.0; BATCH]; 3]);
            let mut within = [true; BATCH];
            for a in 0..3 {
                for l in 0..BATCH {
                    let (corner, remainder) = axes[a].corner(x[a][l], per_spacing, support);
                    within[l] &= axes[a].holds(corner);
                    lower[a][l] = corner as i32;
                    f[a][l] = remainder;
                }
            }
            let (mut brick, mut local) = ([0u32; BATCH], [0u32; BATCH]);
            for l in 0..BATCH {
                let corner = [0, 1, 2].map(|a| lower[a][l] as u32);
                let [x, y, z] = corner.map(|c| c / EDGE);
                brick[l] = z.wrapping_mul(rows).wrapping_add(y).wrapping_mul(row).wrapping_add(x);
                let [x, y, z] = corner.map(|c| c % EDGE);
                local[l] = x | y << 8 | z << 16;
            }
            for (l, home) in out.iter_mut().enumerate().take(BATCH) {
                let [x, y, z, _] = local[l].to_le_bytes().map(|c| c as i8);
                *home = Home {
                    f: [f[0][l], f[1][l], f[2][l]],
                    brick: brick[l],
                    corner: [x, y, z],
                };
            }
            for (l, home) in out.iter_mut().enumerate().take(BATCH) {
                if !within[l] {
                    *home = self.spots.home((self.position)(first + l));
                }
            }
        }
    }
}
