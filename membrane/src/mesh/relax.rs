//! Evens out a triangulation on a surface: springs of equal rest length along the edges, diagonals swapped where that
//! makes better triangles, nodes brought back onto the surface (Persson and Strang, SIAM Rev. 46, 329, 2004).

use super::topology::{Edge, edges};
use crate::MembraneError;
use lbm_ibm_coupling::Vec3;
use std::collections::BTreeSet;

/// Rest length of the springs over the mean edge: above 1, so that nodes push each other apart.
const REST: f64 = 1.15;
/// Share of the spring forces that a sweep applies.
const STEP: f64 = 0.15;
/// Sweeps between two rounds of swaps.
const SWAP_EVERY: usize = 4;
/// Most rounds of swaps at the end (on a curved surface a swap may undo another).
const LAST_SWAPS: usize = 20;

/// Moves `nodes` on the surface given by `project` (the point of the surface near a point) for `sweeps` sweeps.
pub(super) fn relax(
    nodes: &mut [Vec3],
    triangles: &mut [[u32; 3]],
    project: impl Fn(Vec3) -> Vec3,
    sweeps: usize,
) -> Result<(), MembraneError> {
    let mut links = edges(triangles)?;
    let mut push = vec![Vec3::zeros(); nodes.len()];
    for sweep in 0..sweeps {
        if sweep % SWAP_EVERY == 0 {
            swap_diagonals(nodes, triangles, &mut links)?;
        }
        let vectors = links
            .iter()
            .map(|e| nodes[e.nodes[1] as usize] - nodes[e.nodes[0] as usize]);
        let rest = REST * vectors.clone().map(|d| d.norm()).sum::<f64>() / links.len() as f64;
        push.fill(Vec3::zeros());
        for (e, d) in links.iter().zip(vectors) {
            let f = d * (STEP * (rest / d.norm() - 1.0));
            push[e.nodes[0] as usize] -= f;
            push[e.nodes[1] as usize] += f;
        }
        for (x, f) in nodes.iter_mut().zip(&push) {
            *x = project(*x + f);
        }
    }
    for _ in 0..LAST_SWAPS {
        if !swap_diagonals(nodes, triangles, &mut links)? {
            break;
        }
    }
    Ok(())
}

/// Swaps the diagonal of each pair of triangles where the two angles opposite to it exceed pi together (Delaunay), once
/// per triangle; says whether any was swapped.
fn swap_diagonals(nodes: &[Vec3], triangles: &mut [[u32; 3]], links: &mut Vec<Edge>) -> Result<bool, MembraneError> {
    let x = |i: u32| nodes[i as usize];
    let normal = |[a, b, c]: [u32; 3]| (x(b) - x(a)).cross(&(x(c) - x(a)));
    let mut present: BTreeSet<[u32; 2]> = links.iter().map(|e| e.nodes).collect();
    let mut touched = vec![false; triangles.len()];
    let mut swapped = false;
    for e in links.iter() {
        let ([a, b], [c, d], [t, u]) = (e.nodes, e.opposite, e.triangles.map(|t| t as usize));
        let diagonal = [c.min(d), c.max(d)];
        if touched[t] || touched[u] || present.contains(&diagonal) {
            continue;
        }
        let angles = (x(a) - x(c)).angle(&(x(b) - x(c))) + (x(a) - x(d)).angle(&(x(b) - x(d)));
        let (first, second) = ([c, d, b], [d, c, a]);
        let old = normal([a, b, c]).normalize() + normal([b, a, d]).normalize();
        let upright = normal(first).dot(&old) > 0.0 && normal(second).dot(&old) > 0.0;
        if angles > std::f64::consts::PI + 1e-9 && upright {
            triangles[t] = first;
            triangles[u] = second;
            (touched[t], touched[u], swapped) = (true, true, true);
            present.remove(&e.nodes);
            present.insert(diagonal);
        }
    }
    if swapped {
        *links = edges(triangles)?;
    }
    Ok(swapped)
}
