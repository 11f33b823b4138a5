//! Surface markers: each triangle of a mesh divided into `k x k` equal ones.

use lbm_ibm_coupling::{Soa3Ref, Work, on_widest};

/// An edge of a mesh, and a triangle that has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub ends: [u32; 2],
    pub triangle: u32,
}

/// Edges of a mesh, each once, in ascending order of their ends.
pub(crate) fn edges(triangles: &[[u32; 3]]) -> Vec<Edge> {
    let mut all: Vec<Edge> = Vec::with_capacity(3 * triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        all.extend([[a, b], [b, c], [c, a]].map(|[i, j]| Edge {
            ends: [i.min(j), i.max(j)],
            triangle: t as u32,
        }));
    }
    all.sort_unstable_by_key(|e| (e.ends, e.triangle));
    all.dedup_by_key(|e| e.ends);
    all
}

/// Length of the longest edge (m) and a triangle that has it.
pub(crate) fn longest_edge(x: Soa3Ref<'_>, edges: &[Edge]) -> (f64, usize) {
    let mut longest = (0.0, 0);
    for e in edges {
        let [i, j] = e.ends.map(|n| n as usize);
        let (dx, dy, dz) = (x.x[i] - x.x[j], x.y[i] - x.y[j], x.z[i] - x.z[j]);
        let square = dx * dx + dy * dy + dz * dz;
        if square > longest.0 {
            longest = (square, e.triangle as usize);
        }
    }
    (longest.0.sqrt(), longest.1)
}

/// Length of the longest edge, m.
pub(crate) fn longest(x: Soa3Ref<'_>, edges: &[Edge]) -> f64 {
    on_widest(Longest { x, edges })
}

struct Longest<'a> {
    x: Soa3Ref<'a>,
    edges: &'a [Edge],
}

impl Work for Longest<'_> {
    type Out = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        const LANES: usize = 8;
        let Soa3Ref { x, y, z } = self.x;
        let mut longest = [0.0; LANES];
        for edges in self.edges.chunks(LANES) {
            let mut d = [[0.0; LANES]; 3];
            for (l, e) in edges.iter().enumerate() {
                let [i, j] = e.ends.map(|n| n as usize);
                (d[0][l], d[1][l], d[2][l]) = (x[i] - x[j], y[i] - y[j], z[i] - z[j]);
            }
            for l in 0..LANES {
                let square = d[0][l] * d[0][l] + d[1][l] * d[1][l] + d[2][l] * d[2][l];
                longest[l] = if square > longest[l] { square } else { longest[l] };
            }
        }
        longest.into_iter().fold(0.0, f64::max).sqrt()
    }
}

/// Markers of one body: its nodes, then those inside edges, then those inside triangles. Marker `m` is at
/// `sum_p shape[m][p] x[parent[m][p]]`; parents beyond the first one, two or three have shape zero.
#[derive(Clone, Debug, Default)]
pub(crate) struct Subdivision {
    pub parent: Vec<[u32; 3]>,
    pub shape: Vec<[f64; 3]>,
    /// Lumped reference area, m2: a third of each small triangle around the marker.
    pub area: Vec<f64>,
}

impl Subdivision {
    /// Nodes alone, each its own marker.
    pub fn of_nodes(n: usize) -> Self {
        Self {
            parent: (0..n as u32).map(|i| [i; 3]).collect(),
            shape: vec![[1.0, 0.0, 0.0]; n],
            area: vec![0.0; n],
        }
    }

    /// Divides the edges of all triangles into `k` parts, areas from `reference` (m).
    pub fn of_surface(reference: Soa3Ref<'_>, triangles: &[[u32; 3]], edges: &[Edge], k: usize) -> Self {
        let n = reference.len();
        let mut out = Self::of_nodes(n);
        let part = |i: usize| i as f64 / k as f64;
        for e in edges {
            let [i, j] = e.ends;
            for t in 1..k {
                out.push([i, j, i], [part(k - t), part(t), 0.0]);
            }
        }
        for tri in triangles {
            let [a, b, c] = tri.map(|v| reference.get(v as usize));
            let third = (b - a).cross(&(c - a)).norm() / (6.0 * (k * k) as f64);
            for &v in tri {
                out.area[v as usize] += third;
            }
            for side in [[tri[0], tri[1]], [tri[1], tri[2]], [tri[2], tri[0]]] {
                let ends = [side[0].min(side[1]), side[0].max(side[1])];
                let Ok(e) = edges.binary_search_by_key(&ends, |e| e.ends) else {
                    continue;
                };
                for area in &mut out.area[n + e * (k - 1)..][..k - 1] {
                    *area += 3.0 * third;
                }
            }
            for i in 1..k {
                for j in 1..k - i {
                    out.push(*tri, [part(k - i - j), part(i), part(j)]);
                    if let Some(area) = out.area.last_mut() {
                        *area = 6.0 * third;
                    }
                }
            }
        }
        out
    }

    fn push(&mut self, parent: [u32; 3], shape: [f64; 3]) {
        self.parent.push(parent);
        self.shape.push(shape);
        self.area.push(0.0);
    }

    pub fn len(&self) -> usize {
        self.parent.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lbm_ibm_coupling::{Soa3, Vec3};

    #[test]
    fn markers_are_shared_and_carry_the_whole_area() {
        let x: Soa3 = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0), (2.0, 1.0)]
            .iter()
            .map(|&(x, y)| Vec3::new(x, y, 0.0))
            .collect();
        let triangles = [[0, 1, 2], [1, 3, 2]];
        let edges = edges(&triangles);
        assert_eq!(edges.len(), 5);
        assert!((longest_edge(x.view(), &edges).0 - 5.0_f64.sqrt()).abs() < 1e-15);
        for k in 1..6 {
            let s = Subdivision::of_surface(x.view(), &triangles, &edges, k);
            assert_eq!(s.len(), (k + 1) * (k + 1));
            assert!((s.area.iter().sum::<f64>() - 2.0).abs() < 1e-14);
            assert!(s.shape.iter().all(|n| (n.iter().sum::<f64>() - 1.0).abs() < 1e-15));
        }
    }
}
