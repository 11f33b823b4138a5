//! VTK files: fluid, bodies and walls, and the time series that ParaView opens.

use super::OutputError;
use crate::coupling::{Lattice, Scene, Soa3Ref, Sphere};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use vtkio::model::{
    Attribute, Attributes, ByteOrder, DataSet, Extent, ImageDataPiece, Piece, PolyDataPiece, Version, VertexNumbers,
    Vtk,
};

/// A series of moments: for each a fluid file (`.vti`) and a file of all bodies (`.vtp`), and two collections
/// (`fluid.pvd`, `bodies.pvd`) that ParaView opens. Lengths in m, velocities in m/s, pressure in Pa, forces in N.
pub struct VtkSeries {
    folder: PathBuf,
    frames: Vec<(f64, usize)>,
}

impl VtkSeries {
    /// A series in `folder`, which is made.
    ///
    /// # Errors
    /// [`OutputError`] with the folder.
    pub fn new(folder: &Path) -> Result<Self, OutputError> {
        std::fs::create_dir_all(folder).map_err(|e| OutputError::at(folder, e))?;
        Ok(Self {
            folder: folder.to_owned(),
            frames: Vec::new(),
        })
    }

    /// Adds the present moment of a scene. The collections are whole after each call.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn write(&mut self, scene: &Scene) -> Result<(), OutputError> {
        let frame = self.frames.len();
        self.frames.push((scene.time(), frame));
        if let Some(fluid) = scene.fluid() {
            write_fluid(&self.folder.join(format!("fluid_{frame:04}.vti")), fluid)?;
            self.collect("fluid", "vti")?;
        }
        write_bodies(&self.folder.join(format!("bodies_{frame:04}.vtp")), scene)?;
        self.collect("bodies", "vtp")
    }

    fn collect(&self, what: &str, extension: &str) -> Result<(), OutputError> {
        collect(&self.folder, &self.frames, what, extension)
    }
}

fn collect(folder: &Path, frames: &[(f64, usize)], what: &str, extension: &str) -> Result<(), OutputError> {
    let path = folder.join(format!("{what}.pvd"));
    let mut text =
        String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n");
    for (time, frame) in frames {
        writeln!(
            text,
            "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{what}_{frame:04}.{extension}\"/>"
        )
        .map_err(|e| OutputError::at(&path, e))?;
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    std::fs::write(&path, text).map_err(|e| OutputError::at(&path, e))
}

/// A series of moments of beads without a fluid: points with their radius and whatever else is given, one file each
/// (`beads_0000.vtp`, ...), and the collection `beads.pvd`. In ParaView, glyphs of spheres scaled by `radius`.
pub struct BeadSeries {
    folder: PathBuf,
    frames: Vec<(f64, usize)>,
}

impl BeadSeries {
    /// A series in `folder`, which is made.
    ///
    /// # Errors
    /// [`OutputError`] with the folder.
    pub fn new(folder: &Path) -> Result<Self, OutputError> {
        std::fs::create_dir_all(folder).map_err(|e| OutputError::at(folder, e))?;
        Ok(Self {
            folder: folder.to_owned(),
            frames: Vec::new(),
        })
    }

    /// Adds the beads at `time` (s), with `vectors` by name, one entry per bead.
    ///
    /// # Errors
    /// [`OutputError`] with the path.
    pub fn write(&mut self, time: f64, beads: &[Sphere], vectors: &[(&str, Soa3Ref<'_>)]) -> Result<(), OutputError> {
        let frame = self.frames.len();
        self.frames.push((time, frame));
        let mut point =
            vec![Attribute::scalars("radius", 1).with_data(beads.iter().map(|b| b.radius).collect::<Vec<_>>())];
        point.extend(
            vectors
                .iter()
                .map(|(name, v)| Attribute::vectors(*name).with_data(interleave(*v))),
        );
        let n = beads.len() as u64;
        let data = DataSet::inline(PolyDataPiece {
            points: beads
                .iter()
                .flat_map(|b| [b.centre.x, b.centre.y, b.centre.z])
                .collect::<Vec<_>>()
                .into(),
            verts: Some(VertexNumbers::XML {
                connectivity: (0..n).collect(),
                offsets: (1..=n).collect(),
            }),
            lines: None,
            polys: None,
            strips: None,
            data: Attributes {
                point,
                cell: Vec::new(),
            },
        });
        export(&self.folder.join(format!("beads_{frame:04}.vtp")), data)?;
        collect(&self.folder, &self.frames, "beads", "vtp")
    }
}

fn interleave(a: Soa3Ref<'_>) -> Vec<f64> {
    a.iter().flat_map(|p| [p.x, p.y, p.z]).collect()
}

/// Writes the signed distance from the walls (m, positive in the fluid) on the fluid's grid: its zero contour is the
/// wall. Does nothing in a scene without fluid or walls.
///
/// # Errors
/// [`OutputError`] with the path.
pub fn write_walls(path: &Path, scene: &Scene) -> Result<(), OutputError> {
    let (Some(fluid), Some(walls)) = (scene.fluid(), scene.walls()) else {
        return Ok(());
    };
    let grid = fluid.grid();
    let [nx, ny, nz] = grid.shape;
    let mut distance = Vec::with_capacity(grid.len());
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                distance.push(walls.probe(grid.position(i, j, k), scene.time()).distance as f32);
            }
        }
    }
    image(
        path,
        fluid,
        vec![Attribute::scalars("wall_distance", 1).with_data(distance)],
    )
}

fn write_fluid(path: &Path, fluid: &dyn Lattice) -> Result<(), OutputError> {
    let Some(fields) = fluid.macroscopic() else {
        return Ok(());
    };
    let [u, v, w] = &fields.velocity;
    let velocity: Vec<f32> = (0..u.len())
        .flat_map(|i| [u[i] as f32, v[i] as f32, w[i] as f32])
        .collect();
    let pressure: Vec<f32> = fields.pressure.iter().map(|p| *p as f32).collect();
    image(
        path,
        fluid,
        vec![
            Attribute::vectors("velocity").with_data(velocity),
            Attribute::scalars("pressure", 1).with_data(pressure),
            Attribute::scalars("solid", 1).with_data(fields.solid),
        ],
    )
}

/// The nodes of the grid are the cells of the image.
fn image(path: &Path, fluid: &dyn Lattice, cell: Vec<Attribute>) -> Result<(), OutputError> {
    let grid = fluid.grid();
    let n = grid.shape.map(|n| n as i32);
    let extent = Extent::Ranges([0..=n[0], 0..=n[1], 0..=n[2]]);
    let data = DataSet::ImageData {
        extent: extent.clone(),
        origin: [grid.origin.x as f32, grid.origin.y as f32, grid.origin.z as f32],
        spacing: [grid.spacing as f32; 3],
        meta: None,
        pieces: vec![Piece::Inline(Box::new(ImageDataPiece {
            extent,
            data: Attributes {
                point: Vec::new(),
                cell,
            },
        }))],
    };
    export(path, data)
}

fn write_bodies(path: &Path, scene: &Scene) -> Result<(), OutputError> {
    let (x, v, force) = (scene.positions(), scene.velocities(), scene.loads().node.view());
    let mut connectivity = Vec::new();
    let mut body = Vec::new();
    for info in scene.bodies() {
        let start = info.range.start as u64;
        connectivity.extend(info.triangles.iter().flatten().map(|&i| start + u64::from(i)));
        body.extend(std::iter::repeat_n(info.id, info.range.len()));
    }
    let offsets = (1..=connectivity.len() as u64 / 3).map(|t| 3 * t).collect();
    let data = DataSet::inline(PolyDataPiece {
        points: interleave(x).into(),
        verts: None,
        lines: None,
        polys: Some(VertexNumbers::XML { connectivity, offsets }),
        strips: None,
        data: Attributes {
            point: vec![
                Attribute::vectors("velocity").with_data(interleave(v)),
                Attribute::vectors("force").with_data(interleave(force)),
                Attribute::scalars("body", 1).with_data(body),
            ],
            cell: Vec::new(),
        },
    });
    export(path, data)
}

fn export(path: &Path, data: DataSet) -> Result<(), OutputError> {
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data,
        file_path: None,
    };
    vtk.export(path).map_err(|e| OutputError::at(path, e.to_string()))
}
