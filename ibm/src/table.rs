//! Which node hands how much to which marker: the weights between mesh and markers, both ways.

use crate::subdivision::Subdivision;
use crate::threads;
use crate::transfer::Node;
use lbm_ibm_coupling::Soa3Ref;
use std::ops::Range;

/// Weights between all nodes of a scene and their markers.
///
/// With linear shape functions `N` and lumped reference areas `a`, a node velocity is the mean over its patch,
/// `U0_j = sum_m W_mj u_m`, `W_mj = N_j(x_m) a_m / D_j`, `D_j = sum_m N_j(x_m) a_m`. On a curved patch this mean lies
/// inside the surface (by l^2 / 4R for edges l on a sphere R), so it is corrected towards the least-squares projection,
/// whose mass matrix is `M_ij = sum_m a_m N_i N_j`, by two terms of its Neumann series: `U = U0 + t + (t - C t)` with
/// `t = U0 - C U0`, `C = M / D`. Forces take the transposed path. On a sphere with edges of 0.29 R (0.58 R) a rotation then
/// errs by 0.25 % (0.4 %) instead of 2.4 % (8.5 %), and three times less fluid leaks.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    /// Nodes that a marker hangs on.
    pub parent: Vec<[u32; 3]>,
    /// Linear shape functions of those nodes at the marker.
    pub shape: Vec<[f64; 3]>,
    /// `W_mj` of those nodes.
    pub weight: Vec<[f64; 3]>,
    first_marker: Vec<u32>,
    markers: Vec<(u32, f64)>,
    first_neighbour: Vec<u32>,
    /// Node `j` of row `i`, `C_ij` and `C_ji`.
    neighbours: Vec<(u32, f64, f64)>,
    divided: bool,
    /// Every node is its own marker, in order.
    plain: bool,
}

/// Nodes per task.
const LEAF: usize = 2048;

impl Table {
    /// Weights for `nodes` nodes of which each body has a range and a subdivision.
    pub fn new<'a>(nodes: usize, bodies: impl Iterator<Item = (Range<usize>, &'a Subdivision)>) -> Self {
        let mut table = Self::default();
        let mut area = Vec::new();
        for (range, s) in bodies {
            let start = range.start as u32;
            table.parent.extend(s.parent.iter().map(|p| p.map(|n| start + n)));
            table.shape.extend_from_slice(&s.shape);
            area.extend_from_slice(&s.area);
            table.divided |= s.len() > range.len();
        }
        let mut lumped = vec![0.0; nodes];
        for m in 0..area.len() {
            for p in 0..3 {
                lumped[table.parent[m][p] as usize] += table.shape[m][p] * area[m];
            }
        }
        let share = |m: usize, p: usize, parent: &[u32; 3], shape: &[f64; 3]| {
            let d = lumped[parent[p] as usize];
            match d > 0.0 {
                true => shape[p] * area[m] / d,
                // A node without area is its own marker.
                false => f64::from(u8::from(shape[p] == 1.0)),
            }
        };
        table.weight = (0..area.len())
            .map(|m| [0, 1, 2].map(|p| share(m, p, &table.parent[m], &table.shape[m])))
            .collect();
        table.plain = !table.divided && table.parent.iter().map(|p| p[0]).eq(0..nodes as u32);
        table.list_markers(nodes);
        if table.divided {
            table.list_neighbours(nodes, &lumped);
        }
        table
    }

    fn list_markers(&mut self, nodes: usize) {
        let weighted = |m: usize| {
            let (parent, weight) = (self.parent[m], self.weight[m]);
            (0..3)
                .filter(move |&p| weight[p] != 0.0)
                .map(move |p| (parent[p] as usize, weight[p]))
        };
        let mut next = vec![0; nodes + 1];
        for (node, _) in (0..self.weight.len()).flat_map(weighted) {
            next[node + 1] += 1;
        }
        for n in 0..nodes {
            next[n + 1] += next[n];
        }
        let first = next.clone();
        let mut markers = vec![(0, 0.0); next[nodes] as usize];
        for m in 0..self.weight.len() {
            for (node, w) in weighted(m) {
                markers[next[node] as usize] = (m as u32, w);
                next[node] += 1;
            }
        }
        (self.first_marker, self.markers) = (first, markers);
    }

    fn list_neighbours(&mut self, nodes: usize, lumped: &[f64]) {
        self.first_neighbour.push(0);
        for i in 0..nodes {
            let mut row: Vec<(u32, f64)> = Vec::new();
            for &(m, w) in self.markers_of(i) {
                let (parent, shape) = (self.parent[m as usize], self.shape[m as usize]);
                for p in (0..3).filter(|&p| shape[p] != 0.0) {
                    match row.iter_mut().find(|(n, _)| *n == parent[p]) {
                        Some((_, c)) => *c += w * shape[p],
                        None => row.push((parent[p], w * shape[p])),
                    }
                }
            }
            row.sort_unstable_by_key(|&(n, _)| n);
            let ratio = |n: u32| match lumped[n as usize] > 0.0 {
                true => lumped[i] / lumped[n as usize],
                false => 1.0,
            };
            self.neighbours.extend(row.iter().map(|&(n, c)| (n, c, c * ratio(n))));
            self.first_neighbour.push(self.neighbours.len() as u32);
        }
    }

    /// Whether every node is its own marker, in order.
    pub fn is_plain(&self) -> bool {
        self.plain
    }

    /// Number of markers.
    pub fn len(&self) -> usize {
        self.parent.len()
    }

    /// Position of a marker, m, at node positions `x`, m.
    #[inline(always)]
    pub fn position(&self, m: usize, x: Soa3Ref<'_>) -> [f64; 3] {
        if self.plain {
            return [x.x[m], x.y[m], x.z[m]];
        }
        let (n, [a, b, c]) = (self.parent[m].map(|n| n as usize), self.shape[m]);
        let at = |v: &[f64]| a * v[n[0]] + b * v[n[1]] + c * v[n[2]];
        [at(x.x), at(x.y), at(x.z)]
    }

    /// Force on a marker of the node forces that [`Table::to_markers`] gives.
    #[inline(always)]
    pub fn marker_force(&self, m: usize, force: &[[f64; 3]]) -> Node {
        if self.plain {
            let [x, y, z] = force[m];
            return Node([x, y, z, 0.0]);
        }
        let ([i, j, k], [a, b, c]) = (self.parent[m].map(|n| force[n as usize]), self.weight[m]);
        let at = |axis: usize| a * i[axis] + b * j[axis] + c * k[axis];
        Node([at(0), at(1), at(2), 0.0])
    }

    fn markers_of(&self, node: usize) -> &[(u32, f64)] {
        &self.markers[self.first_marker[node] as usize..self.first_marker[node + 1] as usize]
    }

    fn neighbours_of(&self, node: usize) -> &[(u32, f64, f64)] {
        &self.neighbours[self.first_neighbour[node] as usize..self.first_neighbour[node + 1] as usize]
    }

    /// Node velocities of marker velocities `u(m)`; `scratch` is kept between calls.
    pub fn to_nodes(&self, u: impl Fn(usize) -> [f64; 3] + Sync, out: [&mut [f64]; 3], scratch: &mut Scratch) {
        if self.plain {
            return threads::rows(out, 1, 0, LEAF, &|first, [x, y, z]| {
                for i in 0..x.len() {
                    [x[i], y[i], z[i]] = u(first + i);
                }
            });
        }
        let nodes = out[0].len();
        scratch.resize(nodes);
        threads::fill(&mut scratch.plain, 0, LEAF, &|j| {
            self.markers_of(j).iter().fold([0.0; 3], |s, &(m, w)| {
                let v = u(m as usize);
                [s[0] + w * v[0], s[1] + w * v[1], s[2] + w * v[2]]
            })
        });
        let velocity = self.corrected(scratch, |&(n, c, _)| (n, c));
        threads::rows(out, 1, 0, LEAF, &|first, [x, y, z]| {
            for i in 0..x.len() {
                [x[i], y[i], z[i]] = velocity[first + i];
            }
        });
    }

    /// Node forces as [`Table::weight`] is to divide them among the markers.
    pub fn to_markers<'a>(&self, force: Soa3Ref<'_>, scratch: &'a mut Scratch) -> &'a [[f64; 3]] {
        scratch.resize(force.len());
        threads::fill(&mut scratch.plain, 0, LEAF, &|j| [force.x[j], force.y[j], force.z[j]]);
        self.corrected(scratch, |&(n, _, c)| (n, c))
    }

    /// Two terms of the Neumann series: `v + t + (t - C t)` with `t = v - C v`.
    fn corrected<'a>(
        &self,
        scratch: &'a mut Scratch,
        entry: impl Fn(&(u32, f64, f64)) -> (u32, f64) + Sync,
    ) -> &'a [[f64; 3]] {
        let Scratch { plain, term, sum } = scratch;
        if !self.divided {
            return plain;
        }
        let remainder = |v: &[[f64; 3]], j: usize| {
            let mut out = v[j];
            for e in self.neighbours_of(j) {
                let (n, c) = entry(e);
                for a in 0..3 {
                    out[a] -= c * v[n as usize][a];
                }
            }
            out
        };
        threads::fill(term, 0, LEAF, &|j| remainder(plain, j));
        threads::fill(sum, 0, LEAF, &|j| {
            let last = remainder(term, j);
            [0, 1, 2].map(|a| plain[j][a] + term[j][a] + last[a])
        });
        sum
    }
}

/// Node vectors between the passes of a [`Table`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Scratch {
    plain: Vec<[f64; 3]>,
    term: Vec<[f64; 3]>,
    sum: Vec<[f64; 3]>,
}

impl Scratch {
    fn resize(&mut self, nodes: usize) {
        for v in [&mut self.plain, &mut self.term, &mut self.sum] {
            v.resize(nodes, [0.0; 3]);
        }
    }
}
