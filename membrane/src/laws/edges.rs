//! One pass over all edges: what pulls along them, and what bends the surface at them.

use super::batch::{BATCH, ZERO, at, cross, dot, gather, minus, scatter};
use super::elements::{Elements, numbers};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, Work, on_widest};

/// Adds the forces (N) of springs at nodes `x` (m): `pull(length, rest)` of each, its tension (N) over its length (m).
pub(super) fn pull(springs: &Elements<2, 1>, x: Soa3Ref<'_>, force: &mut Soa3Mut<'_>, pull: impl Fn(f64, f64) -> f64) {
    on_widest(Springs {
        springs,
        x,
        force,
        pull,
    });
}

/// What hinges do. The angle is that by which the normals of the two triangles differ, in (-pi, pi], positive where the
/// cell is convex.
pub(super) trait Fold<const K: usize> {
    /// Minus the derivative of the energy by the angle inside the cell, which is pi less the angle: J. `sin` and `cos` are
    /// those of the angle times the same positive number.
    fn moment(&self, sin: f64, cos: f64, rest: [f64; K]) -> f64;
}

/// Adds the forces (N) of hinges at nodes `x` (m).
pub(super) fn fold<const K: usize>(
    hinges: &Elements<4, K>,
    x: Soa3Ref<'_>,
    force: &mut Soa3Mut<'_>,
    law: &impl Fold<K>,
) {
    on_widest(Hinges { hinges, x, force, law });
}

struct Springs<'a, 'f, P> {
    springs: &'a Elements<2, 1>,
    x: Soa3Ref<'a>,
    force: &'a mut Soa3Mut<'f>,
    pull: P,
}

impl<P: Fn(f64, f64) -> f64> Work for Springs<'_, '_, P> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let (mut ends, mut forces) = ([ZERO; 2], [ZERO; 2]);
        for (springs, rest) in self.springs.batches() {
            gather(self.x, springs, &mut ends);
            let [rest] = numbers(rest);
            for i in 0..BATCH {
                let d = minus(at(&ends[1], i), at(&ends[0], i));
                let f = (self.pull)(dot(d, d).sqrt(), rest[i]);
                for a in 0..3 {
                    forces[0][a][i] = d[a] * f;
                    forces[1][a][i] = -(d[a] * f);
                }
            }
            scatter(&forces, springs, self.force);
        }
    }
}

struct Hinges<'a, 'f, const K: usize, L> {
    hinges: &'a Elements<4, K>,
    x: Soa3Ref<'a>,
    force: &'a mut Soa3Mut<'f>,
    law: &'a L,
}

impl<const K: usize, L: Fold<K>> Work for Hinges<'_, '_, K, L> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let (mut corners, mut forces) = ([ZERO; 4], [ZERO; 4]);
        for (hinges, rest) in self.hinges.batches() {
            gather(self.x, hinges, &mut corners);
            let rest = numbers(rest);
            for i in 0..BATCH {
                let [a, b, c, d] = [0, 1, 2, 3].map(|p| at(&corners[p], i));
                let rest = std::array::from_fn(|k| rest[k][i]);
                let (edge, c, d) = (minus(b, a), minus(c, a), minus(d, a));
                let (first, second) = (cross(edge, c), cross(d, edge));
                let square = dot(edge, edge);
                let length = square.sqrt();
                // first x second = -edge (d . first).
                let moment = self.law.moment(-length * dot(d, first), dot(first, second), rest);
                // The angle inside grows as an opposite node goes outwards, by one over its height; where the foot of the
                // height lies along the edge tells how the edge's nodes share the reaction.
                let strength = moment * length;
                let (ff, ss) = (dot(first, first), dot(second, second));
                let (u, v) = (strength / ff, strength / ss);
                let per_square = 1.0 / square;
                let (p, q) = (dot(c, edge) * per_square, dot(d, edge) * per_square);
                for k in 0..3 {
                    let (f, g) = (first[k] * u, second[k] * v);
                    forces[0][k][i] = f * (p - 1.0) + g * (q - 1.0);
                    forces[1][k][i] = -(f * p) - g * q;
                    forces[2][k][i] = f;
                    forces[3][k][i] = g;
                }
            }
            scatter(&forces, hinges, self.force);
        }
    }
}
