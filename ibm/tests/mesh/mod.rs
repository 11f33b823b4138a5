//! A geodesic sphere.

use lbm_ibm_coupling::{Soa3, Vec3};

/// Unit sphere of `10 parts^2 + 2` nodes: an icosahedron with its edges cut into `parts`, blown up.
pub fn icosphere(parts: usize) -> (Soa3, Vec<[u32; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for a in [-1.0, 1.0] {
        for b in [-g, g] {
            corners.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)]);
        }
    }
    let near = |a: usize, b: usize| (corners[a] - corners[b]).norm() < 2.1;
    let mut x = Soa3::default();
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if !(near(a, b) && near(b, c) && near(c, a)) {
                    continue;
                }
                let outward = corners[a].dot(&corners[b].cross(&corners[c])) > 0.0;
                let [p, q, r] = if outward { [a, b, c] } else { [a, c, b] }.map(|i| corners[i]);
                let mut at = |i: usize, j: usize| -> u32 {
                    let v = (p + ((q - p) * i as f64 + (r - p) * j as f64) / parts as f64).normalize();
                    let known = (0..x.len()).find(|&n| (x.get(n) - v).norm() < 1e-9);
                    known.unwrap_or_else(|| {
                        x.push(v);
                        x.len() - 1
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
        }
    }
    (x, triangles)
}
