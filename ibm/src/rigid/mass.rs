//! Volume, centre and inertia of a closed mesh.

use super::RigidError;
use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::Matrix3;

/// A solid of unit density.
pub(super) struct Solid {
    pub volume: f64,
    pub centre: Vec3,
    /// About the centre.
    pub inertia: Matrix3<f64>,
}

impl Solid {
    /// From the tetrahedra between a node and each triangle: with corners 0, a, b, c the integral of `x x^T` is
    /// `V/20 (s s^T + a a^T + b b^T + c c^T)`, `s = a + b + c`.
    pub fn of(nodes: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        // From near by, lest digits are lost where the mesh is far from the origin.
        let origin = nodes.iter().sum::<Vec3>() / nodes.len().max(1) as f64;
        let (mut volume, mut first, mut second) = (0.0, Vec3::zeros(), Matrix3::zeros());
        for t in triangles {
            let [a, b, c] = t.map(|i| nodes[i as usize] - origin);
            let (v, s) = (a.dot(&b.cross(&c)) / 6.0, a + b + c);
            volume += v;
            first += s * (v / 4.0);
            second += (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose()) * (v / 20.0);
        }
        let centre = first / volume;
        let about = second - centre * centre.transpose() * volume;
        Self {
            volume,
            centre: origin + centre,
            inertia: Matrix3::identity() * about.trace() - about,
        }
    }
}

/// Each edge must have two triangles that run through it in opposite directions.
pub(super) fn check_closed(nodes: usize, triangles: &[[u32; 3]]) -> Result<(), RigidError> {
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for (n, t) in triangles.iter().enumerate() {
        if let Some(&node) = t.iter().find(|&&i| i as usize >= nodes) {
            return Err(RigidError::NoNode {
                triangle: n,
                node,
                nodes,
            });
        }
        let [a, b, c] = *t;
        edges.extend([(a, b), (b, c), (c, a)].map(|(i, j)| ([i.min(j), i.max(j)], i < j)));
    }
    edges.sort_unstable();
    for same in edges.chunk_by(|a, b| a.0 == b.0) {
        if same.len() != 2 || same[0].1 == same[1].1 {
            return Err(RigidError::Open {
                edge: same[0].0,
                triangles: same.len(),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box with edges 1, 2 and 3 and a corner far from the origin.
    fn brick() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corner = |i: usize| Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64 * 2.0, (i >> 2) as f64 * 3.0);
        let nodes = (0..8).map(|i| corner(i) + Vec3::new(5.0, -7.0, 11.0)).collect();
        let faces = [
            [0, 4, 6, 2],
            [1, 3, 7, 5],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 2, 3, 1],
            [4, 5, 7, 6],
        ];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        (nodes, triangles)
    }

    #[test]
    fn a_brick_weighs_what_it_should() {
        let (nodes, triangles) = brick();
        check_closed(nodes.len(), &triangles).expect("a closed box");
        let solid = Solid::of(&nodes, &triangles);
        assert!((solid.volume - 6.0).abs() < 1e-12);
        assert!((solid.centre - Vec3::new(5.5, -6.0, 12.5)).norm() < 1e-12);
        let exact = Matrix3::from_diagonal(&Vec3::new(4.0 + 9.0, 1.0 + 9.0, 1.0 + 4.0)) * 0.5;
        assert!((solid.inertia - exact).norm() < 1e-12);
    }

    #[test]
    fn an_open_box_is_refused() {
        let (nodes, mut triangles) = brick();
        triangles.pop();
        assert!(matches!(
            check_closed(nodes.len(), &triangles),
            Err(RigidError::Open { triangles: 1, .. })
        ));
        triangles.push([0, 1, 9]);
        assert!(matches!(
            check_closed(nodes.len(), &triangles),
            Err(RigidError::NoNode { node: 9, .. })
        ));
    }
}
