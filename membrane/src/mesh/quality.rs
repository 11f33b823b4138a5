//! How even a mesh is.

use super::Mesh;
use std::fmt;

/// Evenness of a mesh, with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Quality {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of triangles.
    pub triangles: usize,
    /// Shortest edge, m.
    pub edge_min: f64,
    /// Mean edge, m.
    pub edge_mean: f64,
    /// Longest edge, m.
    pub edge_max: f64,
    /// Standard deviation of the edge lengths over their mean.
    pub edge_spread: f64,
    /// Standard deviation of the triangle areas over their mean.
    pub area_spread: f64,
    /// Least angle of any triangle, rad.
    pub least_angle: f64,
    /// Enclosed volume, m3.
    pub volume: f64,
    /// Surface area, m2.
    pub area: f64,
}

impl Quality {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let x = |i: u32| mesh.nodes.get(i as usize);
        let lengths: Vec<f64> = mesh
            .edges
            .iter()
            .map(|e| (x(e.nodes[1]) - x(e.nodes[0])).norm())
            .collect();
        let mut areas = Vec::with_capacity(mesh.triangles.len());
        let mut least_angle = f64::INFINITY;
        for &abc in mesh.triangles() {
            let [a, b, c] = abc.map(x);
            areas.push(0.5 * (b - a).cross(&(c - a)).norm());
            for (p, q, r) in [(a, b, c), (b, c, a), (c, a, b)] {
                least_angle = least_angle.min((q - p).angle(&(r - p)));
            }
        }
        let (edge_mean, edge_spread) = mean_and_spread(&lengths);
        let (_, area_spread) = mean_and_spread(&areas);
        Self {
            nodes: mesh.nodes.len(),
            triangles: mesh.triangles.len(),
            edge_min: lengths.iter().copied().fold(f64::INFINITY, f64::min),
            edge_mean,
            edge_max: lengths.iter().copied().fold(0.0, f64::max),
            edge_spread,
            area_spread,
            least_angle,
            volume: mesh.volume(),
            area: mesh.area(),
        }
    }
}

fn mean_and_spread(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n;
    (mean, variance.sqrt() / mean)
}

impl fmt::Display for Quality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "mesh of {} nodes, {} triangles", self.nodes, self.triangles)?;
        writeln!(
            f,
            "  volume {:.2} um3, area {:.2} um2",
            self.volume * 1e18,
            self.area * 1e12
        )?;
        writeln!(
            f,
            "  edges {:.4} to {:.4} um, mean {:.4}, spread {:.1} %",
            self.edge_min * 1e6,
            self.edge_max * 1e6,
            self.edge_mean * 1e6,
            self.edge_spread * 100.0
        )?;
        write!(
            f,
            "  triangle areas' spread {:.1} %, least angle {:.1} degrees",
            self.area_spread * 100.0,
            self.least_angle.to_degrees()
        )
    }
}
