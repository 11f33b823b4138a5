//! Nodes and markers of rigid surfaces.

use crate::subdivision::{Subdivision, edges, longest_edge};
use lbm_ibm_coupling::{CellList, Domain, Soa3, Soa3Ref, Vec3};
use std::f64::consts::TAU;

/// Unit sphere of `10 parts^2 + 2` nodes: an icosahedron with its edges cut into `parts`, blown up.
pub(super) fn icosphere(parts: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for a in [-1.0, 1.0] {
        for b in [-g, g] {
            corners.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
        }
    }
    let near = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 2.1;
    let (mut nodes, mut triangles): (Vec<Vec3>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    let faces = (0..12).flat_map(|a| (a + 1..12).flat_map(move |b| (b + 1..12).map(move |c| [a, b, c])));
    for [a, b, c] in faces.filter(|&[a, b, c]| near(a, b) && near(b, c) && near(c, a)) {
        let outward = corners[a].dot(&corners[b].cross(&corners[c])) > 0.0;
        let [p, q, r] = if outward { [a, b, c] } else { [a, c, b] }.map(|i| corners[i]);
        let mut at = |i: usize, j: usize| -> u32 {
            let v = (p + ((q - p) * i as f64 + (r - p) * j as f64) / parts as f64).normalize();
            let known = nodes.iter().position(|n| (n - v).norm() < 1e-9);
            known.unwrap_or_else(|| {
                nodes.push(v);
                nodes.len() - 1
            }) as u32
        };
        for i in 0..parts {
            for j in 0..parts - i {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < parts {
                    triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    (nodes, triangles)
}

/// Steps of the tables over the polar and the azimuthal angle.
const POLAR: usize = 400;
const AZIMUTH: usize = 96;

/// Markers `spacing` (m) apart on an ellipsoid of semi-axes `axes` (m), about one to each `spacing^2`.
///
/// A sphere has a golden spiral. Any other ellipsoid has rings about the axis whose two others are most alike: they have
/// its three planes of symmetry, or a body that tumbles would slowly leave its orbit.
pub(super) fn ellipsoid_markers(axes: [f64; 3], spacing: f64) -> Soa3 {
    let [a, b, c] = axes;
    if a == b && b == c {
        return spiral(a, spacing);
    }
    let unlike = |pole: usize| (axes[(pole + 1) % 3] / axes[(pole + 2) % 3]).ln().abs();
    let pole = (0..3).min_by(|p, q| unlike(*p).total_cmp(&unlike(*q))).unwrap_or(2);
    let turned = [1, 2, 0].map(|k| axes[(pole + k) % 3]);
    let mut markers = Soa3::default();
    for x in rings(turned, spacing) {
        let mut at = Vec3::zeros();
        for (k, value) in [1, 2, 0].into_iter().zip(x) {
            at[(pole + k) % 3] = value;
        }
        markers.push(at);
    }
    markers
}

/// A golden spiral on a sphere, one marker to each `spacing^2`.
fn spiral(radius: f64, spacing: f64) -> Soa3 {
    let count = (2.0 * TAU * (radius / spacing).powi(2)).round().max(12.0) as usize;
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (s, c) = (TAU * (golden * i as f64).fract()).sin_cos();
            let rho = (1.0 - z * z).sqrt();
            Vec3::new(rho * c, rho * s, z) * radius
        })
        .collect()
}

/// Rings about the last axis, `spacing` apart along the mean meridian, with a multiple of four markers each, `spacing` apart
/// along the ring.
fn rings([a, b, c]: [f64; 3], spacing: f64) -> Vec<[f64; 3]> {
    let across = (a * b).sqrt();
    let meridian = cumulative(POLAR, 0.5 * TAU, |t| (across * t.cos()).hypot(c * t.sin()));
    let around = cumulative(AZIMUTH, TAU, |p| (a * p.sin()).hypot(b * p.cos()));
    let count = (meridian[POLAR] / spacing).round().max(3.0);
    let mut markers = Vec::new();
    for i in 0..count as usize {
        let t = quantile(&meridian, 0.5 * TAU, (i as f64 + 0.5) / count);
        let n = 4.0 * (0.25 * around[AZIMUTH] * t.sin() / spacing).round().max(1.0);
        for j in 0..n as usize {
            let p = quantile(&around, TAU, (j as f64 + 0.5) / n);
            markers.push([a * t.sin() * p.cos(), b * t.sin() * p.sin(), c * t.cos()]);
        }
    }
    markers
}

/// Integral of `f` from 0 to each of `n` equal parts of `length`, by the midpoint rule.
fn cumulative(n: usize, length: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let step = length / n as f64;
    let mut sum = vec![0.0];
    for i in 0..n {
        sum.push(sum[i] + step * f((i as f64 + 0.5) * step));
    }
    sum
}

/// Where a cumulative integral reaches a fraction of its end.
fn quantile(sum: &[f64], length: f64, fraction: f64) -> f64 {
    let n = sum.len() - 1;
    let target = fraction * sum[n];
    let i = sum.partition_point(|s| *s <= target).clamp(1, n) - 1;
    (i as f64 + (target - sum[i]) / (sum[i + 1] - sum[i])) * length / n as f64
}

/// Markers about `spacing` (m) apart on a closed mesh shrunk by `scale`: its triangles divided finely, then thinned, the first
/// of any two markers closer than 0.8 spacings staying.
pub(super) fn mesh_markers(nodes: Soa3Ref<'_>, triangles: &[[u32; 3]], spacing: f64, scale: f64) -> Soa3 {
    let moved: Soa3 = nodes.iter().map(|x| x * scale).collect();
    let edges = edges(triangles);
    let parts = (longest_edge(moved.view(), &edges).0 / (0.25 * spacing))
        .ceil()
        .clamp(1.0, 64.0) as usize;
    let fine = Subdivision::of_surface(moved.view(), triangles, &edges, parts);
    let points: Soa3 = fine
        .parent
        .iter()
        .zip(&fine.shape)
        .map(|(parent, shape)| (0..3).map(|p| moved.get(parent[p] as usize) * shape[p]).sum())
        .collect();
    thinned(&points, 0.8 * spacing)
}

/// The points of which none is closer to an earlier one that stays than `least`.
fn thinned(points: &Soa3, least: f64) -> Soa3 {
    let mut list = CellList::new();
    list.build(points.view(), &Domain::unbounded(), least);
    let mut close: Vec<Vec<u32>> = vec![Vec::new(); points.len()];
    list.for_each_pair(|i, j| {
        if (points.get(i) - points.get(j)).norm() < least {
            close[i.max(j)].push(i.min(j) as u32);
        }
    });
    let mut stays = vec![true; points.len()];
    for i in 0..points.len() {
        stays[i] = !close[i].iter().any(|&j| stays[j as usize]);
    }
    (0..points.len()).filter(|&i| stays[i]).map(|i| points.get(i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of every point to its nearest neighbour.
    fn nearest(x: &Soa3) -> Vec<f64> {
        let others = |i: usize| (0..x.len()).filter(move |&j| j != i);
        (0..x.len())
            .map(|i| {
                others(i)
                    .map(|j| (x.get(i) - x.get(j)).norm())
                    .fold(f64::INFINITY, f64::min)
            })
            .collect()
    }

    #[test]
    fn markers_lie_evenly_on_the_surface() {
        let x = ellipsoid_markers([4.0; 3], 1.0);
        assert!(x.iter().all(|p| (p.norm() - 4.0).abs() < 1e-12));
        assert!((x.len() as f64 - 2.0 * TAU * 16.0).abs() <= 1.0);
        for axes in [[4.0, 4.0, 4.0], [3.0, 3.0, 9.0], [8.0, 8.0, 2.0], [3.0, 5.0, 8.0]] {
            let x = ellipsoid_markers(axes, 1.0);
            let gaps = nearest(&x);
            let least = gaps.iter().copied().fold(f64::INFINITY, f64::min);
            let greatest = gaps.iter().copied().fold(0.0, f64::max);
            assert!(least > 0.6 && greatest < 1.3, "{axes:?}: {least} to {greatest}");
        }
    }

    #[test]
    fn markers_of_a_spheroid_have_its_planes_of_symmetry() {
        for axes in [[9.0, 3.0, 3.0], [3.0, 8.0, 3.0], [8.0, 8.0, 2.0], [3.0, 5.0, 8.0]] {
            let x = ellipsoid_markers(axes, 1.0);
            for a in 0..3 {
                let mirrored = |p: Vec3| {
                    let mut q = p;
                    q[a] = -q[a];
                    x.iter().any(|r| (r - q).norm() < 1e-9)
                };
                assert!(x.iter().all(mirrored), "{axes:?}, axis {a}");
            }
            let outside = |p: Vec3| (0..3).map(|a| (p[a] / axes[a]).powi(2)).sum::<f64>() - 1.0;
            assert!(x.iter().all(|p| outside(p).abs() < 1e-12));
        }
    }

    #[test]
    fn a_mesh_finer_or_coarser_than_the_grid_has_markers_as_far_apart() {
        for parts in [2, 12] {
            let (nodes, triangles) = icosphere(parts);
            let nodes: Soa3 = nodes.iter().map(|p| p * 5.0).collect();
            let x = mesh_markers(nodes.view(), &triangles, 1.0, 0.94);
            let gaps = nearest(&x);
            assert!(gaps.iter().all(|g| (0.79..1.3).contains(g)), "{gaps:?}");
            assert!(x.iter().all(|p| p.norm() < 4.71));
        }
    }
}
