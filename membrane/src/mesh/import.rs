//! Meshes from files: STL, OBJ and VTK.

use super::{Mesh, positive};
use crate::MembraneError;
use lbm_ibm_coupling::{Soa3, Vec3};
use std::collections::HashMap;
use std::fmt::Display;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use vtkio::Vtk;
use vtkio::model::{DataSet, IOBuffer, Piece, VertexNumbers};

/// Node positions in the file's unit, and triangles.
type Soup = (Vec<[f64; 3]>, Vec<[u32; 3]>);

impl Mesh {
    /// A mesh from a file whose lengths are in `unit` (m; 1e-6 for a file in micrometres), by the ending of its name:
    /// `stl` (ASCII or binary), `obj` (polygons are cut into triangles), `vtk` (legacy), `vtp` and `vtu` (XML, not
    /// compressed).
    ///
    /// Nodes at the very same place are made one, since STL has three of its own for each triangle. STL and OBJ come in
    /// single precision. The file's triangles wind outwards by the right hand.
    ///
    /// # Errors
    /// [`MembraneError::Import`], and those of [`Mesh::new`]: an open surface, one that is not a manifold, mixed or
    /// inward winding, degenerate triangles.
    pub fn load(path: impl AsRef<Path>, unit: f64) -> Result<Self, MembraneError> {
        let path = path.as_ref();
        positive("the unit of length of a mesh file", unit)?;
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_lowercase();
        let soup = match ending.as_str() {
            "stl" => stl(path),
            "obj" => obj(path),
            "vtk" | "vtp" | "vtu" => vtk(path),
            _ => Err("its name ends in none of stl, obj, vtk, vtp, vtu; convert it to one of them".to_owned()),
        };
        let (points, triangles) = soup.map_err(|reason| MembraneError::Import {
            path: path.display().to_string(),
            reason,
        })?;
        let (nodes, triangles) = weld(&points, &triangles);
        Self::new(nodes.iter().map(|x| x * unit).collect(), triangles)
    }
}

/// What a reader says, as the reason of an error.
fn said(error: impl Display) -> String {
    error.to_string()
}

fn stl(path: &Path) -> Result<Soup, String> {
    let mut reader = BufReader::new(File::open(path).map_err(said)?);
    let mesh = stl_io::read_stl(&mut reader).map_err(said)?;
    let points = mesh
        .vertices
        .iter()
        .map(|v| [0, 1, 2].map(|k| f64::from(v[k])))
        .collect();
    let number = |i: usize| u32::try_from(i).map_err(said);
    let triangle = |f: &stl_io::IndexedTriangle| {
        let [a, b, c] = f.vertices;
        Ok([number(a)?, number(b)?, number(c)?])
    };
    Ok((points, mesh.faces.iter().map(triangle).collect::<Result<_, String>>()?))
}

fn obj(path: &Path) -> Result<Soup, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..Default::default()
    };
    // Materials say nothing of a shape, so a missing file of them is no error.
    let (models, _) = tobj::load_obj(path, &options).map_err(said)?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for model in &models {
        let first = points.len() as u32;
        points.extend(threes(&model.mesh.positions)?.map(|p| p.map(f64::from)));
        triangles.extend(threes(&model.mesh.indices)?.map(|t| t.map(|i| first + i)));
    }
    Ok((points, triangles))
}

fn vtk(path: &Path) -> Result<Soup, String> {
    let mut file = Vtk::import(path).map_err(said)?;
    file.load_all_pieces().map_err(said)?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    let mut take = |buffer: &IOBuffer, cells: VertexNumbers| {
        let first = points.len() as u32;
        let coordinates: Vec<f64> = buffer.cast_into().ok_or("its points are no numbers")?;
        points.extend(threes(&coordinates)?);
        for cell in cells_of(cells)? {
            let Ok([a, b, c]) = <[u32; 3]>::try_from(cell.as_slice()) else {
                return Err(format!(
                    "it has a cell of {} nodes; cut all cells into triangles",
                    cell.len()
                ));
            };
            triangles.push([first + a, first + b, first + c]);
        }
        Ok(())
    };
    match file.data {
        DataSet::PolyData { pieces, .. } => {
            for piece in pieces {
                let Piece::Inline(piece) = piece else { continue };
                let polygons = piece.polys.ok_or("it has no polygons")?;
                take(&piece.points, polygons)?;
            }
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            for piece in pieces {
                let Piece::Inline(piece) = piece else { continue };
                take(&piece.points, piece.cells.cell_verts)?;
            }
        }
        _ => return Err("it is neither polygon data nor an unstructured grid".to_owned()),
    }
    Ok((points, triangles))
}

/// The nodes of each cell.
fn cells_of(cells: VertexNumbers) -> Result<Vec<Vec<u32>>, String> {
    const TORN: &str = "its list of cells ends before its last cell";
    match cells {
        VertexNumbers::Legacy { vertices, .. } => {
            let (mut rest, mut out) = (vertices.as_slice(), Vec::new());
            while let Some((&count, tail)) = rest.split_first() {
                let (cell, tail) = tail.split_at_checked(count as usize).ok_or(TORN)?;
                out.push(cell.to_vec());
                rest = tail;
            }
            Ok(out)
        }
        VertexNumbers::XML { connectivity, offsets } => {
            let (mut start, mut out) = (0, Vec::new());
            for end in offsets.into_iter().map(|o| o as usize) {
                let cell = connectivity.get(start..end).ok_or(TORN)?;
                let numbers = cell.iter().map(|&i| u32::try_from(i).map_err(said));
                // Some files begin their offsets with a zero, which ends no cell.
                if end > start {
                    out.push(numbers.collect::<Result<_, _>>()?);
                }
                start = end;
            }
            Ok(out)
        }
    }
}

/// A list in threes.
fn threes<T: Copy>(values: &[T]) -> Result<impl Iterator<Item = [T; 3]> + '_, String> {
    let (threes, rest) = values.as_chunks::<3>();
    if !rest.is_empty() {
        return Err(format!("a list of threes has {} entries", values.len()));
    }
    Ok(threes.iter().copied())
}

/// Makes nodes at the very same place one, in the order in which triangles first name them.
fn weld(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> (Soa3, Vec<[u32; 3]>) {
    let mut seen = HashMap::new();
    let mut nodes = Soa3::default();
    let triangles = triangles.iter().map(|t| {
        t.map(|i| match points.get(i as usize) {
            // Adding zero makes one of the two zeros.
            Some(p) => *seen.entry(p.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                nodes.push(Vec3::from(*p));
                nodes.len() as u32 - 1
            }),
            None => u32::MAX,
        })
    });
    let triangles = triangles.collect();
    (nodes, triangles)
}
