//! Meshes from files: the same surface from every format, and typed errors for broken ones.
#![cfg(feature = "import")]

use lbm_ibm_membrane::{MembraneError, Mesh};
use std::fmt::Write;
use std::path::PathBuf;

const UM: f64 = 1e-6;

fn file(name: &str, text: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn sphere() -> Mesh {
    Mesh::sphere(4.0, 100).unwrap()
}

fn stl(mesh: &Mesh, skip: usize) -> String {
    let mut text = "solid cell\n".to_owned();
    for t in &mesh.triangles()[skip..] {
        text += "facet normal 0 0 0\nouter loop\n";
        for &i in t {
            let x = mesh.nodes().get(i as usize);
            writeln!(text, "vertex {} {} {}", x.x, x.y, x.z).unwrap();
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid cell\n"
}

fn obj(mesh: &Mesh) -> String {
    let mut text = String::new();
    for x in mesh.nodes().iter() {
        writeln!(text, "v {} {} {}", x.x, x.y, x.z).unwrap();
    }
    for [a, b, c] in mesh.triangles() {
        writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap();
    }
    text
}

fn points(mesh: &Mesh) -> String {
    mesh.nodes()
        .iter()
        .map(|x| format!("{} {} {}\n", x.x, x.y, x.z))
        .collect()
}

fn legacy(mesh: &Mesh) -> String {
    let (n, m) = (mesh.nodes().len(), mesh.triangles().len());
    let cells: String = mesh
        .triangles()
        .iter()
        .map(|[a, b, c]| format!("3 {a} {b} {c}\n"))
        .collect();
    format!(
        "# vtk DataFile Version 3.0\ncell\nASCII\nDATASET POLYDATA\nPOINTS {n} double\n{}POLYGONS {m} {}\n{cells}",
        points(mesh),
        4 * m
    )
}

fn xml(mesh: &Mesh) -> String {
    let (n, m) = (mesh.nodes().len(), mesh.triangles().len());
    let cells: String = mesh
        .triangles()
        .iter()
        .map(|[a, b, c]| format!("{a} {b} {c} "))
        .collect();
    let offsets: String = (1..=m).map(|k| format!("{} ", 3 * k)).collect();
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n<PolyData>\n\
         <Piece NumberOfPoints=\"{n}\" NumberOfPolys=\"{m}\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"ascii\">{}</DataArray></Points>\n<Polys><DataArray type=\"Int64\" Name=\"connectivity\" \
         format=\"ascii\">{cells}</DataArray><DataArray type=\"Int64\" Name=\"offsets\" \
         format=\"ascii\">{offsets}</DataArray></Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n",
        points(mesh)
    )
}

#[test]
fn every_format_gives_the_same_surface() {
    let mesh = sphere();
    let files = [
        file("sphere.stl", &stl(&mesh, 0)),
        file("sphere.obj", &obj(&mesh)),
        file("sphere.vtk", &legacy(&mesh)),
        file("sphere.vtp", &xml(&mesh)),
    ];
    for path in files {
        let read = Mesh::load(&path, UM).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_eq!(
            (read.nodes().len(), read.triangles().len()),
            (100, 196),
            "{}",
            path.display()
        );
        // STL and OBJ in single precision.
        assert!(
            (read.volume() / (mesh.volume() * 1e-18) - 1.0).abs() < 1e-6,
            "{}",
            path.display()
        );
        assert!((read.area() / (mesh.area() * 1e-12) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn a_polygon_becomes_triangles_and_a_binary_stl_is_read() {
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let mesh = Mesh::load(file("cube.obj", cube), UM).unwrap();
    assert_eq!((mesh.nodes().len(), mesh.triangles().len()), (8, 12));
    assert!((mesh.volume() / 1e-18 - 1.0).abs() < 1e-6);

    let mut bytes = vec![0_u8; 80];
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for t in mesh.triangles() {
        bytes.extend([0_u8; 12]);
        for &i in t {
            let x = mesh.nodes().get(i as usize) / UM;
            x.iter().for_each(|&c| bytes.extend((c as f32).to_le_bytes()));
        }
        bytes.extend([0_u8; 2]);
    }
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("cube.stl");
    std::fs::write(&path, bytes).unwrap();
    let again = Mesh::load(&path, UM).unwrap();
    assert_eq!((again.nodes().len(), again.triangles().len()), (8, 12));
}

#[test]
fn broken_files_say_what_is_wrong() {
    let mesh = sphere();
    let open = Mesh::load(file("open.stl", &stl(&mesh, 1)), UM).unwrap_err();
    assert!(matches!(open, MembraneError::OpenMesh { open_edges: 3, .. }), "{open}");

    let inward: String = obj(&mesh)
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            ["f", a, b, c] => format!("f {a} {c} {b}\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let error = Mesh::load(file("inward.obj", &inward), UM).unwrap_err();
    assert!(
        matches!(error, MembraneError::Inward { volume } if volume < 0.0),
        "{error}"
    );

    let [a, b, c] = mesh.triangles()[0];
    let twice = format!("{}f {} {} {}\n", obj(&mesh), a + 1, b + 1, c + 1);
    let error = Mesh::load(file("twice.obj", &twice), UM).unwrap_err();
    assert!(
        matches!(error, MembraneError::NotManifold { triangles: 3, .. }),
        "{error}"
    );

    for (name, text) in [
        (
            "quads.vtk",
            "# vtk DataFile Version 3.0\nq\nASCII\nDATASET POLYDATA\nPOINTS 4 double\n0 0 0 1 0 0 1 1 0 0 1 0\nPOLYGONS 1 5\n4 0 1 2 3\n",
        ),
        ("text.stl", "this is no mesh"),
        ("text.obj", "f 1 2 3\n"),
        ("text.vtp", "this is no mesh"),
        ("mesh.xyz", "0 0 0"),
    ] {
        let error = Mesh::load(file(name, text), UM).unwrap_err();
        assert!(matches!(error, MembraneError::Import { .. }), "{name}: {error}");
        assert!(error.to_string().contains(name), "{error}");
    }
    let error = Mesh::load("no/such/file.stl", UM).unwrap_err();
    assert!(matches!(error, MembraneError::Import { .. }), "{error}");
    assert!(matches!(
        Mesh::load("no/such/file.stl", 0.0),
        Err(MembraneError::NotPositive { .. })
    ));
}
