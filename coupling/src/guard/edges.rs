//! Edges of a mesh that stretch too far, and triangles that turn over.

use super::Guard;
use crate::{BodyInfo, SceneError, Soa3Ref, Vec3};

/// An edge, what it is at rest, and the triangles that meet in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    nodes: [u32; 2],
    length: f64,
    /// The two triangles and the angle between their normals at rest (rad), where there are two.
    hinge: Option<([u32; 2], f64)>,
}

/// The edges of a mesh with nodes at rest at `x`.
pub(super) fn of(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> Vec<Edge> {
    let mut sides: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        sides.extend([(a, b), (b, c), (c, a)].map(|(i, j)| ([i.min(j), i.max(j)], t as u32)));
    }
    sides.sort_unstable();
    let edge = |group: &[([u32; 2], u32)]| {
        let nodes = group[0].0;
        let [a, b] = nodes.map(|i| x.get(i as usize));
        let pair = match *group {
            [(_, t), (_, u)] => Some([t, u]),
            _ => None,
        };
        Edge {
            nodes,
            length: (b - a).norm(),
            hinge: pair.map(|pair| (pair, angle(x, triangles, pair))),
        }
    };
    sides.chunk_by(|a, b| a.0 == b.0).map(edge).collect()
}

/// The angle between the normals of two triangles, rad.
fn angle(x: Soa3Ref<'_>, triangles: &[[u32; 3]], pair: [u32; 2]) -> f64 {
    let normal = |t: u32| -> Vec3 {
        let [a, b, c] = triangles[t as usize].map(|i| x.get(i as usize));
        (b - a).cross(&(c - a))
    };
    let [first, second] = pair.map(normal);
    first.cross(&second).norm().atan2(first.dot(&second))
}

impl Guard {
    /// Reports the first edge of a body that is too long or at which a triangle has turned over.
    pub(super) fn edges(&self, body: &BodyInfo, edges: &[Edge], x: Soa3Ref<'_>, step: u64) -> Result<(), SceneError> {
        for edge in edges {
            let [a, b] = edge.nodes.map(|i| x.get(i as usize));
            let stretch = (b - a).norm() / edge.length;
            if stretch > self.stretch {
                return Err(SceneError::StretchedEdge {
                    body: body.id,
                    kind: body.kind.clone(),
                    nodes: edge.nodes,
                    stretch,
                    limit: self.stretch,
                    step,
                });
            }
            let Some((triangles, rest)) = edge.hinge else { continue };
            let angle = angle(x, &body.triangles, triangles);
            if angle > self.fold && rest <= self.fold {
                return Err(SceneError::InvertedTriangle {
                    body: body.id,
                    kind: body.kind.clone(),
                    triangles,
                    degrees: angle.to_degrees(),
                    limit_degrees: self.fold.to_degrees(),
                    step,
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Motion, Soa3};

    /// A tent of four triangles over a square of side 2 m, its top at `top`.
    fn tent(top: [f64; 3]) -> Soa3 {
        let base = [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        base.into_iter().chain([top]).map(Vec3::from).collect()
    }

    fn look(x: &Soa3) -> Result<(), SceneError> {
        let triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        let guard = Guard::default();
        let edges = of(tent([0.0, 0.0, 0.3]).view(), &triangles);
        assert_eq!(edges.len(), 8);
        let body = BodyInfo {
            id: 3,
            kind: "tent".into(),
            range: 0..5,
            triangles: triangles.into(),
            motion: Motion::Advected,
        };
        guard.edges(&body, &edges, x.view(), 7)
    }

    #[test]
    fn a_triangle_that_turns_over_is_named() {
        look(&tent([0.0, 0.0, 0.3])).unwrap();
        look(&tent([0.9, 0.0, 0.1])).unwrap();
        // The top moves out over the side between nodes 1 and 2: triangle 1 turns over.
        let error = look(&tent([1.5, 0.0, 0.0])).unwrap_err();
        assert!(
            matches!(
                error,
                SceneError::InvertedTriangle {
                    body: 3,
                    triangles: [0, 1],
                    step: 7,
                    ..
                }
            ),
            "{error}"
        );
    }

    #[test]
    fn an_edge_that_stretches_too_far_is_named() {
        let error = look(&tent([0.0, 0.0, 20.0])).unwrap_err();
        assert!(
            matches!(error, SceneError::StretchedEdge { nodes: [0, 4], stretch, .. } if stretch > 10.0),
            "{error}"
        );
    }
}
