//! Triangulation of points on a sphere: the convex hull is the Delaunay triangulation.

use lbm_ibm_coupling::Vec3;
use std::collections::BTreeSet;

/// `n` points spread evenly over the unit sphere along a golden spiral.
pub(super) fn golden_spiral(n: usize) -> Vec<Vec3> {
    let turn = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..n)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / n as f64;
            let r = (1.0 - z * z).sqrt();
            let (s, c) = (turn * i as f64).sin_cos();
            Vec3::new(r * c, r * s, z)
        })
        .collect()
}

/// Triangles of the convex hull of points in convex position about the origin, outward; needs four points or more, the
/// first four not in a plane.
pub(super) fn convex_hull(points: &[Vec3]) -> Vec<[u32; 3]> {
    let p = |i: u32| points[i as usize];
    let sees = |[a, b, c]: [u32; 3], x: Vec3| (p(b) - p(a)).cross(&(p(c) - p(a))).dot(&(x - p(a))) > 0.0;

    let mut faces: Vec<[u32; 3]> = if sees([0, 1, 2], p(3)) {
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
    } else {
        vec![[0, 1, 2], [1, 0, 3], [2, 1, 3], [0, 2, 3]]
    };
    let mut seen = BTreeSet::new();
    for i in 4..points.len() as u32 {
        seen.clear();
        faces.retain(|&face| {
            let visible = sees(face, p(i));
            if visible {
                let [a, b, c] = face;
                seen.extend([(a, b), (b, c), (c, a)]);
            }
            !visible
        });
        // The horizon: sides of visible faces whose neighbour is not visible.
        let horizon = seen.iter().filter(|&&(a, b)| !seen.contains(&(b, a)));
        faces.extend(horizon.map(|&(a, b)| [a, b, i]));
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_of_n_points_has_2n_minus_4_triangles() {
        for n in [4, 5, 6, 7, 12, 50, 306] {
            let points = golden_spiral(n);
            let faces = convex_hull(&points);
            assert_eq!(faces.len(), 2 * n - 4, "{n} points");
            for f in &faces {
                let [a, b, c] = f.map(|i| points[i as usize]);
                assert!((b - a).cross(&(c - a)).dot(&a) > 0.0);
            }
        }
    }
}
