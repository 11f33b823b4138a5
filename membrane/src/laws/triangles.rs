//! One pass over all triangles: tensions along them and a pressure across them.

use super::batch::{BATCH, ZERO, at, cross, dot, gather, minus, scatter, sum};
use super::elements::{Elements, numbers};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, Work, on_widest};

/// What each triangle does to its nodes.
pub(super) struct Tensions {
    /// A modulus (N/m): the tension grows with the triangle's own strain. Without areas at rest it means nothing.
    pub local: f64,
    /// The same tension in all, N/m.
    pub global: f64,
    /// Pressure outwards, Pa.
    pub pressure: f64,
}

/// Adds the forces (N) of `tensions` on nodes at `x` (m); triangles come with their areas at rest (m2) or with nothing.
pub(super) fn add<const K: usize>(
    x: Soa3Ref<'_>,
    triangles: &Elements<3, K>,
    tensions: &Tensions,
    force: &mut Soa3Mut<'_>,
) {
    on_widest(Pass {
        x,
        triangles,
        tensions,
        force,
    });
}

/// Area (m2) and enclosed volume (m3) of a closed mesh with nodes at `x` (m).
pub(super) fn measure(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> (f64, f64) {
    on_widest(Measure { x, triangles })
}

struct Pass<'a, 'f, const K: usize> {
    x: Soa3Ref<'a>,
    triangles: &'a Elements<3, K>,
    tensions: &'a Tensions,
    force: &'a mut Soa3Mut<'f>,
}

impl<const K: usize> Work for Pass<'_, '_, K> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Tensions {
            local,
            global,
            pressure,
        } = *self.tensions;
        let (mut corners, mut forces) = ([ZERO; 3], [ZERO; 3]);
        for (triangles, rest) in self.triangles.batches() {
            gather(self.x, triangles, &mut corners);
            let rest = numbers(rest);
            for i in 0..BATCH {
                let [a, b, c] = [0, 1, 2].map(|p| at(&corners[p], i));
                let normal = cross(minus(b, a), minus(c, a));
                let size = dot(normal, normal).sqrt();
                let own = rest.first().map_or(0.0, |rest| local * (0.5 * size / rest[i] - 1.0));
                let tension = global + own;
                // The gradient of the area with respect to a node is n x (edge opposite to it)/2.
                // A triangle without an area has no plane to be tense in.
                let half = if size > 0.0 { 0.5 * tension / size } else { 0.0 };
                let n = normal.map(|v| v * half);
                let (first, second) = (cross(minus(c, b), n), cross(minus(a, c), n));
                for k in 0..3 {
                    let push = normal[k] * (pressure / 6.0);
                    forces[0][k][i] = first[k] + push;
                    forces[1][k][i] = second[k] + push;
                    forces[2][k][i] = push - first[k] - second[k];
                }
            }
            scatter(&forces, triangles, self.force);
        }
    }
}

struct Measure<'a> {
    x: Soa3Ref<'a>,
    triangles: &'a [[u32; 3]],
}

impl Work for Measure<'_> {
    type Out = (f64, f64);

    #[inline(always)]
    fn run(self) -> (f64, f64) {
        let Some(first) = self.triangles.first() else {
            return (0.0, 0.0);
        };
        // About a point of the cell, for a cell far from the origin has a small volume and large moments.
        let origin = self.x.get(first[0] as usize);
        let origin = [origin.x, origin.y, origin.z];
        let mut corners = [ZERO; 3];
        let (mut sizes, mut cones) = ([0.0; BATCH], [0.0; BATCH]);
        let (mut area, mut volume) = (0.0, 0.0);
        for triangles in self.triangles.chunks(BATCH) {
            gather(self.x, triangles, &mut corners);
            for i in 0..BATCH {
                let [a, b, c] = [0, 1, 2].map(|p| at(&corners[p], i));
                let normal = cross(minus(b, a), minus(c, a));
                sizes[i] = dot(normal, normal).sqrt();
                cones[i] = dot(minus(a, origin), normal);
            }
            area += sum(&sizes, triangles.len());
            volume += sum(&cones, triangles.len());
        }
        (0.5 * area, volume / 6.0)
    }
}
