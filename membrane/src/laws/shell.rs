//! Springs, hinges, areas and volume of a closed surface in two passes: one over the edges, which finds two numbers for each
//! and adds no forces, and one over the triangles.
//!
//! A hinge pushes the nodes of each of its triangles along the normal of that triangle, and a spring lies along a side of both.
//! So a triangle needs no more than the moments and tensions of its three edges. With its corners x_j, the edge vectors
//! e_j opposite to them (in one sense of turning), its area vector N/2 and the moments M_k of the hinges over the lengths of
//! their edges, the hinges' force on corner j is N (e_j . W)/N^2 with W = sum of M_k e_k: the gradients of the three angles. The
//! edges sum to zero, and so do these forces.

use super::batch::{BATCH, Lanes, ZERO, at, cross, dot, gather, minus, scatter, sum};
use super::bending::Angles;
use super::edges::Fold;
use super::elements::{Elements, numbers};
use super::stretching::tension;
use super::triangles::Tensions;
use crate::Mesh;
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, Work, on_widest};
use std::cell::RefCell;
use std::sync::Arc;

thread_local! {
    /// Of every edge: the moment of its hinge over its length (N), and its tension over its length (N/m). Kept by thread and not by
    /// cell, so that all cells use the same memory, which stays in cache.
    static FOUND: RefCell<Vec<[f64; 2]>> = const { RefCell::new(Vec::new()) };
}

/// The edges of every triangle, the one opposite to its first corner first.
pub(super) fn sides(mesh: &Mesh) -> Arc<[[u32; 3]]> {
    let mut sides = vec![[0; 3]; mesh.triangles().len()];
    for (number, edge) in mesh.edges().iter().enumerate() {
        for (t, opposite) in edge.triangles.into_iter().zip(edge.opposite) {
            for (side, corner) in sides[t as usize].iter_mut().zip(mesh.triangles()[t as usize]) {
                if corner == opposite {
                    *side = number as u32;
                }
            }
        }
    }
    sides.into()
}

/// A surface and what it is made of.
pub(super) struct Shell<'a> {
    /// In the order of the edges, with angles (rad) and lengths (m) at rest.
    pub hinges: &'a Elements<4, 2>,
    /// With areas at rest, m2.
    pub triangles: &'a Elements<3, 1>,
    /// The edges of each triangle.
    pub sides: &'a [[u32; 3]],
    /// Modulus of the springs, N.
    pub stretching: f64,
    pub bending: Angles,
}

impl Shell<'_> {
    /// Adds all forces (N) at nodes `x` (m): those of springs and hinges, and the tensions and the pressure that `tensions` gives
    /// for the area (m2) and the volume (m3) of the surface.
    pub fn add(&self, x: Soa3Ref<'_>, force: &mut Soa3Mut<'_>, tensions: impl FnOnce(f64, f64) -> Tensions) {
        FOUND.with_borrow_mut(|found| {
            found.resize(self.hinges.nodes().len(), [0.0; 2]);
            let (area, volume) = on_widest(Find { shell: self, x, found });
            on_widest(Collect {
                shell: self,
                x,
                found,
                tensions: tensions(area, volume),
                force,
            });
        });
    }
}

struct Find<'a> {
    shell: &'a Shell<'a>,
    x: Soa3Ref<'a>,
    found: &'a mut [[f64; 2]],
}

impl Work for Find<'_> {
    type Out = (f64, f64);

    #[inline(always)]
    fn run(self) -> (f64, f64) {
        let Shell {
            hinges,
            stretching,
            bending,
            ..
        } = self.shell;
        let Some(&[first, ..]) = hinges.nodes().first() else {
            return (0.0, 0.0);
        };
        // About a point of the cell, for a cell far from the origin has a small volume and large moments.
        let origin = self.x.get(first as usize);
        let origin = [origin.x, origin.y, origin.z];
        let mut corners = [ZERO; 4];
        let (mut moments, mut tensions) = ([0.0; BATCH], [0.0; BATCH]);
        let (mut sizes, mut cones) = ([0.0; BATCH], [0.0; BATCH]);
        let (mut area, mut volume) = (0.0, 0.0);
        for ((hinges, rest), found) in hinges.batches().zip(self.found.chunks_mut(BATCH)) {
            gather(self.x, hinges, &mut corners);
            let [angle, rest] = numbers(rest);
            for i in 0..BATCH {
                let [a, b, c, d] = [0, 1, 2, 3].map(|p| at(&corners[p], i));
                let (edge, c, d) = (minus(b, a), minus(c, a), minus(d, a));
                let (first, second) = (cross(edge, c), cross(d, edge));
                let length = dot(edge, edge).sqrt();
                // first x second = -edge (d . first).
                let moment = bending.moment(-length * dot(d, first), dot(first, second), [angle[i]]);
                let (above, below) = tension(*stretching, length, rest[i]);
                let per = 1.0 / (below * length);
                (moments[i], tensions[i]) = (moment * (below * per), above * per);
                sizes[i] = dot(first, first).sqrt() + dot(second, second).sqrt();
                cones[i] = dot(minus(a, origin), [0, 1, 2].map(|k| first[k] + second[k]));
            }
            for (i, found) in found.iter_mut().enumerate().take(BATCH) {
                *found = [moments[i], tensions[i]];
            }
            area += sum(&sizes, hinges.len());
            volume += sum(&cones, hinges.len());
        }
        // Every triangle is part of three hinges.
        (area / 6.0, volume / 18.0)
    }
}

struct Collect<'a, 'f> {
    shell: &'a Shell<'a>,
    x: Soa3Ref<'a>,
    found: &'a [[f64; 2]],
    tensions: Tensions,
    force: &'a mut Soa3Mut<'f>,
}

impl Work for Collect<'_, '_> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Tensions {
            local,
            global,
            pressure,
        } = self.tensions;
        let (mut corners, mut forces) = ([ZERO; 3], [ZERO; 3]);
        let (mut moments, mut pulls): ([Lanes; 3], [Lanes; 3]) = (ZERO, ZERO);
        let sides = self.shell.sides.chunks(BATCH);
        for ((triangles, rest), sides) in self.shell.triangles.batches().zip(sides) {
            gather(self.x, triangles, &mut corners);
            for (i, sides) in sides.iter().enumerate().take(BATCH) {
                for k in 0..3 {
                    [moments[k][i], pulls[k][i]] = self.found[sides[k] as usize];
                }
            }
            let [rest] = numbers(rest);
            for i in 0..BATCH {
                let [a, b, c] = [0, 1, 2].map(|p| at(&corners[p], i));
                let edges = [minus(c, b), minus(a, c), minus(b, a)];
                let normal = cross(edges[2], edges[0]);
                let square = dot(normal, normal);
                let size = square.sqrt();
                let tension = global + local * (0.5 * size / rest[i] - 1.0);
                // A triangle without an area has no plane to be tense in or to turn.
                let per = if square > 0.0 { 1.0 / square } else { 0.0 };
                // The gradient of the area with respect to a node is n x (edge opposite to it)/2.
                let along = normal.map(|n| n * (0.5 * tension * size * per));
                let push = normal.map(|n| n * (pressure / 6.0));
                let turn = [0, 1, 2].map(|a| (0..3).map(|k| moments[k][i] * edges[k][a]).sum::<f64>() * per);
                // The triangle on the other side of an edge pulls along it as well.
                let pull = [0, 1, 2].map(|k| edges[k].map(|e| e * (0.5 * pulls[k][i])));
                for j in 0..3 {
                    let bend = dot(edges[j], turn);
                    let (across, next, last) = (cross(edges[j], along), pull[(j + 1) % 3], pull[(j + 2) % 3]);
                    for a in 0..3 {
                        forces[j][a][i] = across[a] + push[a] + normal[a] * bend + (last[a] - next[a]);
                    }
                }
            }
            scatter(&forces, triangles, self.force);
        }
    }
}
