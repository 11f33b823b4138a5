//! The surface of a capsule of revolution, from its mesh.

use lbm_ibm::coupling::{Soa3Ref, Vec3};

/// Points of a surface of revolution, axial place and distance from the axis, in radii of the tube.
#[derive(Clone, Debug, Default)]
pub struct Meridian {
    points: Vec<[f64; 2]>,
    /// Least gap to the wall.
    pub film: f64,
    /// Axial extent.
    pub length: f64,
    /// Greatest departure of the widest ring from a circle.
    pub fold: f64,
}

/// How far a surface is from a profile, in radii of the tube.
#[derive(Clone, Copy, Debug)]
pub struct Distance {
    /// Root of the mean square.
    pub rms: f64,
    /// Largest.
    pub largest: f64,
}

/// The surface that a mesh stands for, `inset` outside of it, about the axis along x through `centre`, in a tube of `radius`
/// (m); rings are one `spacing` (m) wide.
pub fn meridian(
    x: Soa3Ref<'_>,
    triangles: &[[u32; 3]],
    centre: Vec3,
    inset: f64,
    radius: f64,
    spacing: f64,
) -> Meridian {
    let mut normals = vec![Vec3::zeros(); x.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| x.get(i as usize));
        let n = (b - a).cross(&(c - a));
        for i in t {
            normals[*i as usize] += n;
        }
    }
    let points: Vec<[f64; 2]> = normals
        .iter()
        .enumerate()
        .map(|(i, n)| {
            let p = x.get(i) + n.normalize() * inset - centre;
            [p.x / radius, p.y.hypot(p.z) / radius]
        })
        .collect();
    let rear = points.iter().fold(f64::INFINITY, |m, p| m.min(p[0]));
    let nose = points.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p[0]));
    let width = spacing / radius;
    let mut rings = vec![Vec::new(); ((nose - rear) / width) as usize + 1];
    for p in &points {
        rings[((p[0] - rear) / width) as usize].push(p[1]);
    }
    let (mut widest, mut fold) = (0.0, 0.0);
    for ring in rings.iter().filter(|r| !r.is_empty()) {
        // Without the nodes of a dimple behind the rim.
        let outermost = ring.iter().fold(0.0_f64, |m, r| m.max(*r));
        let outer: Vec<f64> = ring.iter().copied().filter(|r| *r > 0.8 * outermost).collect();
        let mean = outer.iter().sum::<f64>() / outer.len() as f64;
        if mean > widest {
            widest = mean;
            fold = outer.iter().fold(0.0_f64, |m, r| m.max((r - mean).abs()));
        }
    }
    Meridian {
        points: points.into_iter().map(|[z, r]| [z - nose, r]).collect(),
        film: 1.0 - widest,
        length: nose - rear,
        fold,
    }
}

impl Meridian {
    /// Distance from a profile, a line of axial places and radii, after the shift along the axis that makes it least; not a number
    /// without points.
    pub fn distance(&self, profile: &[[f64; 2]]) -> Distance {
        let mut shift = 0.0;
        let mut gaps: Vec<[f64; 2]> = Vec::new();
        for _ in 0..30 {
            gaps = self.points.iter().map(|p| gap([p[0] + shift, p[1]], profile)).collect();
            shift += gaps.iter().map(|g| g[0]).sum::<f64>() / gaps.len() as f64;
        }
        let squares: Vec<f64> = gaps.iter().map(|g| g[0] * g[0] + g[1] * g[1]).collect();
        Distance {
            rms: (squares.iter().sum::<f64>() / squares.len() as f64).sqrt(),
            largest: squares.iter().fold(0.0_f64, |m, s| m.max(*s)).sqrt(),
        }
    }
}

/// From a point to the nearest one of a line.
fn gap(p: [f64; 2], line: &[[f64; 2]]) -> [f64; 2] {
    let mut nearest = [f64::INFINITY; 2];
    for (a, b) in line.iter().zip(&line[1..]) {
        let along = [b[0] - a[0], b[1] - a[1]];
        let to = [p[0] - a[0], p[1] - a[1]];
        let square = along[0] * along[0] + along[1] * along[1];
        let t = ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0);
        let g = [t * along[0] - to[0], t * along[1] - to[1]];
        if g[0].hypot(g[1]) < nearest[0].hypot(nearest[1]) {
            nearest = g;
        }
    }
    nearest
}

#[cfg(test)]
mod tests {
    use super::*;
    use lbm_ibm::coupling::Soa3;
    use lbm_ibm::membrane::Mesh;
    use std::f64::consts::PI;

    #[test]
    fn a_sphere_is_half_a_circle() {
        let centre = Vec3::new(3.0, -2.0, 5.0);
        let mesh = Mesh::sphere(7.5, 2562).expect("a sphere");
        let x: Soa3 = mesh.nodes().iter().map(|p| p + centre).collect();
        let found = meridian(x.view(), mesh.triangles(), centre, 0.5, 10.0, 0.2);
        assert!((found.film - 0.2).abs() < 2e-3);
        assert!((found.length - 1.6).abs() < 2e-3);
        let circle = |radius: f64| -> Vec<[f64; 2]> {
            let angle = |n: i32| PI * f64::from(n) / 200.0;
            (0..=200)
                .map(|n| [radius * angle(n).cos(), radius * angle(n).sin()])
                .collect()
        };
        assert!(found.distance(&circle(0.8)).largest < 2e-3);
        assert!((found.distance(&circle(0.83)).rms - 0.03).abs() < 1e-3);
    }
}
