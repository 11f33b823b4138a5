//! Rays along x through a closed surface.

use crate::{Grid, Soa3Ref};

/// Parts of a grid spacing to which coordinates across the rays are rounded.
const FINE: f64 = 65536.0;

/// The share of each node's cube that is inside one body, in the box of nodes around it.
#[derive(Clone, Debug, Default)]
pub struct Caster {
    /// First node of the box, and its nodes; the box may reach beyond the grid.
    first: [i64; 3],
    size: [usize; 3],
    /// What begins to be inside at a node and goes on behind it.
    begins: Vec<f64>,
}

impl Caster {
    /// Casts `rays` by `rays` rays through each node's cube against the triangles of a body whose node 0 is at `offset` of
    /// `x` (m).
    pub fn cast(&mut self, grid: &Grid, x: Soa3Ref<'_>, triangles: &[[u32; 3]], offset: usize, rays: usize) {
        // Positions in grid spacings, such that node i fills the space from i to i + 1.
        let at = |i: u32| (x.get(offset + i as usize) - grid.origin) / grid.spacing;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &i in triangles.iter().flatten() {
            let p = at(i);
            for a in 0..3 {
                low[a] = low[a].min(p[a]);
                high[a] = high[a].max(p[a]);
            }
        }
        if triangles.is_empty() || low.iter().chain(&high).any(|v| !v.is_finite()) {
            self.size = [0; 3];
            return;
        }
        self.first = low.map(|v| v.floor() as i64);
        // A place more along the rays, for what ends in the last node.
        self.size =
            std::array::from_fn(|a| (high[a].floor() as i64 - self.first[a]) as usize + 1 + usize::from(a == 0));
        self.begins.clear();
        self.begins.resize(self.size.iter().product(), 0.0);
        let origin = self.first.map(|v| v as f64);
        for triangle in triangles {
            let corners = triangle.map(|i| {
                let p = at(i);
                Corner {
                    node: i,
                    x: p.x - origin[0],
                    flat: [1, 2].map(|a| ((p[a] - origin[a]) * FINE).round() as i64),
                }
            });
            self.meet(corners, rays);
        }
    }

    /// Counts the rays that meet a triangle.
    fn meet(&mut self, corners: [Corner; 3], rays: usize) {
        let [a, b, c] = corners;
        let area = cross(a.flat, b.flat, c.flat);
        if area == 0 {
            return;
        }
        let weight = 1.0 / (rays * rays) as f64;
        // Into the body where the outward normal looks against the rays.
        let sign = if area > 0 { -weight } else { weight };
        let pitch = FINE / rays as f64;
        let span = |axis: usize| {
            let of = corners.map(|p| p.flat[axis]);
            let (low, high) = (of[0].min(of[1]).min(of[2]), of[0].max(of[1]).max(of[2]));
            // Rays pass the middles of equal parts of a node's face.
            let first = (low as f64 / pitch - 0.5).ceil().max(0.0) as usize;
            let last = (high as f64 / pitch - 0.5).floor();
            first..(last + 1.0).max(0.0) as usize
        };
        for s in span(1) {
            for r in span(0) {
                let ray = [r, s].map(|n| ((n as f64 + 0.5) * pitch).round() as i64);
                let sides = [(a, b), (b, c), (c, a)].map(|(p, q)| left_of(p, q, ray));
                if sides != [area > 0; 3] {
                    continue;
                }
                let (u, v) = (
                    cross(b.flat, c.flat, ray) as f64 / area as f64,
                    cross(c.flat, a.flat, ray) as f64 / area as f64,
                );
                let x = (u * a.x + v * b.x + (1.0 - u - v) * c.x).max(0.0);
                let i = (x as usize).min(self.size[0] - 2);
                let behind = x - i as f64;
                let row =
                    ((s / rays).min(self.size[2] - 1) * self.size[1] + (r / rays).min(self.size[1] - 1)) * self.size[0];
                self.begins[row + i] += sign * (1.0 - behind);
                self.begins[row + i + 1] += sign * behind;
            }
        }
    }

    /// Hands out every node of the box with the share of it that is inside.
    pub fn for_each(&self, mut take: impl FnMut([i64; 3], f64)) {
        let [nx, ny, _] = self.size;
        for (row, begins) in self
            .begins
            .chunks(nx.max(1))
            .enumerate()
            .take(self.size[1] * self.size[2])
        {
            let (j, k) = (self.first[1] + (row % ny) as i64, self.first[2] + (row / ny) as i64);
            let mut share = 0.0;
            for (i, begin) in (self.first[0]..).zip(begins) {
                share += begin;
                take([i, j, k], share);
            }
        }
    }
}

/// A corner of a triangle: its node, its place along the rays in spacings, and that across them in fine units.
#[derive(Clone, Copy)]
struct Corner {
    node: u32,
    x: f64,
    flat: [i64; 2],
}

/// Twice the signed area of a flat triangle.
fn cross(a: [i64; 2], b: [i64; 2], p: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// Whether a point lies to the left of the line from `p` to `q`: the same for both triangles at an edge, one way round and
/// the other. A point on the line is taken to be a little to the right and by less upwards of its place.
fn left_of(p: Corner, q: Corner, ray: [i64; 2]) -> bool {
    let (a, b) = if p.node < q.node { (p, q) } else { (q, p) };
    let side = match cross(a.flat, b.flat, ray) {
        0 if b.flat[1] != a.flat[1] => a.flat[1] - b.flat[1],
        0 => b.flat[0] - a.flat[0],
        side => side,
    };
    (side > 0) == (p.node < q.node)
}
