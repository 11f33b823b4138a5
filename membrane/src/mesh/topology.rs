//! Edges of a mesh, and whether it is closed.

use crate::MembraneError;
use lbm_ibm_coupling::Soa3;

/// Least area of a triangle over the square of its longest edge (an equilateral triangle has 0.43).
const LEAST_AREA: f64 = 1e-6;

/// An edge and the two triangles that meet in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Its nodes; the first triangle winds from the first to the second, the second triangle back.
    pub nodes: [u32; 2],
    /// The two triangles.
    pub triangles: [u32; 2],
    /// The node of each triangle opposite to the edge.
    pub opposite: [u32; 2],
}

/// Nodes are finite and used, triangles name nodes that exist and have an area.
pub(super) fn check_nodes(nodes: &Soa3, triangles: &[[u32; 3]]) -> Result<(), MembraneError> {
    if let Some(node) = nodes.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
        return Err(MembraneError::NotFinite { node });
    }
    let mut used = vec![false; nodes.len()];
    for (triangle, abc) in triangles.iter().enumerate() {
        for &node in abc {
            *used.get_mut(node as usize).ok_or(MembraneError::NoSuchNode {
                triangle,
                node,
                nodes: nodes.len(),
            })? = true;
        }
        let [a, b, c] = abc.map(|i| nodes.get(i as usize));
        let edge = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        if area <= LEAST_AREA * edge * edge {
            return Err(MembraneError::DegenerateTriangle { triangle, area, edge });
        }
    }
    match used.iter().position(|u| !u) {
        Some(node) => Err(MembraneError::LooseNode { node }),
        None => Ok(()),
    }
}

/// One side of a triangle: its end nodes in ascending order, the triangle, the opposite node, and whether the triangle
/// winds along it in ascending order.
type Side = ([u32; 2], u32, u32, bool);

/// The edges of a closed, oriented surface, in ascending order of node numbers.
pub(super) fn edges(triangles: &[[u32; 3]]) -> Result<Vec<Edge>, MembraneError> {
    let mut sides: Vec<Side> = Vec::with_capacity(3 * triangles.len());
    for (t, &[a, b, c]) in triangles.iter().enumerate() {
        for (i, j, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
            sides.push(([i.min(j), i.max(j)], t as u32, opposite, i < j));
        }
    }
    sides.sort_unstable();
    let groups = || sides.chunk_by(|a, b| a.0 == b.0);

    let mut open = groups().filter(|g| g.len() == 1);
    if let Some(first) = open.next() {
        return Err(MembraneError::OpenMesh {
            open_edges: 1 + open.count(),
            first: first[0].0,
        });
    }
    groups()
        .map(|group| match *group {
            [(nodes, t, c, true), (_, u, d, false)] | [(nodes, u, d, false), (_, t, c, true)] => Ok(Edge {
                nodes,
                triangles: [t, u],
                opposite: [c, d],
            }),
            [(edge, t, ..), (_, u, ..)] => Err(MembraneError::MixedWinding {
                edge,
                triangles: [t, u],
            }),
            _ => Err(MembraneError::NotManifold {
                edge: group[0].0,
                triangles: group.len(),
            }),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use crate::{MembraneError, Mesh};
    use lbm_ibm_coupling::{Soa3, Vec3};

    fn tetrahedron() -> (Soa3, Vec<[u32; 3]>) {
        let nodes = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let nodes = nodes.iter().map(|&[x, y, z]| Vec3::new(x, y, z)).collect();
        (nodes, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    }

    #[test]
    fn a_tetrahedron_is_closed() {
        let (nodes, triangles) = tetrahedron();
        let mesh = Mesh::new(nodes, triangles).unwrap();
        assert_eq!(mesh.edges().len(), 6);
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-15);
        for edge in mesh.edges() {
            let [a, b] = edge.nodes;
            let first = mesh.triangles()[edge.triangles[0] as usize];
            let winds =
                (0..3).any(|k| first[k] == a && first[(k + 1) % 3] == b && first[(k + 2) % 3] == edge.opposite[0]);
            assert!(winds, "{edge:?} in {first:?}");
        }
    }

    #[test]
    fn a_hole_is_named() {
        let (nodes, mut triangles) = tetrahedron();
        triangles.pop();
        let error = Mesh::new(nodes, triangles).unwrap_err();
        assert_eq!(
            error,
            MembraneError::OpenMesh {
                open_edges: 3,
                first: [1, 2]
            }
        );
        let text = error.to_string();
        assert!(
            text.contains("3 edges") && text.contains("add the missing triangles"),
            "{text}"
        );
    }

    #[test]
    fn bad_input_is_a_typed_error() {
        let (nodes, triangles) = tetrahedron();
        let inward = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert!(matches!(
            Mesh::new(nodes.clone(), inward),
            Err(MembraneError::Inward { .. })
        ));

        let mut mixed = triangles.clone();
        mixed[3].swap(0, 1);
        assert!(matches!(
            Mesh::new(nodes.clone(), mixed),
            Err(MembraneError::MixedWinding { .. })
        ));

        let mut twice = triangles.clone();
        twice.push([1, 2, 3]);
        assert!(matches!(
            Mesh::new(nodes.clone(), twice),
            Err(MembraneError::NotManifold { .. })
        ));

        let mut missing = triangles.clone();
        missing[0][0] = 9;
        assert!(matches!(
            Mesh::new(nodes.clone(), missing),
            Err(MembraneError::NoSuchNode { node: 9, nodes: 4, .. })
        ));

        let mut flat = nodes.clone();
        flat.set(3, Vec3::new(0.5, 0.5, 0.0));
        assert!(matches!(
            Mesh::new(flat, triangles.clone()),
            Err(MembraneError::DegenerateTriangle { triangle: 3, .. })
        ));

        let mut loose = nodes.clone();
        loose.push(Vec3::zeros());
        assert!(matches!(
            Mesh::new(loose, triangles.clone()),
            Err(MembraneError::LooseNode { node: 4 })
        ));

        let mut lost = nodes;
        lost.set(2, Vec3::new(f64::NAN, 0.0, 0.0));
        assert!(matches!(
            Mesh::new(lost, triangles),
            Err(MembraneError::NotFinite { node: 2 })
        ));
    }
}
