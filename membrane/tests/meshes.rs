//! Generated meshes: closed, even, of the asked size, the same on every run.

use lbm_ibm_coupling::Vec3;
use lbm_ibm_membrane::{Disc, MembraneError, Mesh, Spacing};

#[test]
fn spheres_of_any_number_of_nodes() {
    for nodes in [4, 5, 6, 8, 12, 42, 306, 1000] {
        let mesh = Mesh::sphere(8e-6, nodes).unwrap();
        let q = mesh.quality();
        assert_eq!((q.triangles, mesh.edges().len()), (2 * nodes - 4, 3 * nodes - 6));
        assert!(mesh.nodes().iter().all(|x| (x.norm() / 8e-6 - 1.0).abs() < 1e-12));
        if nodes >= 42 {
            assert!(q.edge_spread < 0.1 && q.least_angle.to_degrees() > 38.0, "{q}");
        }
    }
}

#[test]
fn discs_of_any_number_of_nodes() {
    for nodes in [60, 150, 400, 642] {
        for spacing in [Spacing::Spiral, Spacing::Even] {
            let mesh = Disc::RBC_PAPER.mesh(nodes, spacing).unwrap();
            let q = mesh.quality();
            println!("{spacing:?} {q}");
            assert_eq!(q.triangles, 2 * nodes - 4);
            assert!(
                (q.volume / 96.56e-18 - 1.0).abs() < 0.01 && (q.area / 137.58e-12 - 1.0).abs() < 0.01,
                "{q}"
            );
            assert!(
                q.edge_spread < 0.2 && q.least_angle.to_degrees() > 30.0,
                "{spacing:?} {q}"
            );
        }
    }
}

#[test]
fn an_ellipsoid_has_its_volume() {
    let mesh = Mesh::ellipsoid(Vec3::new(6e-6, 5e-6, 3e-6), 600).unwrap();
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 90e-18;
    assert!((mesh.volume() / volume - 1.0).abs() < 0.02);
    assert!(mesh.quality().edge_spread < 0.15, "{}", mesh.quality());
}

#[test]
fn the_same_mesh_every_time() {
    let build = || Disc::RBC_PAPER.mesh(200, Spacing::Even).unwrap();
    let (a, b) = (build(), build());
    assert_eq!(a.triangles(), b.triangles());
    assert!(a.nodes().iter().eq(b.nodes().iter()));
}

#[test]
fn what_cannot_be_meshed_says_why() {
    assert!(matches!(
        Mesh::sphere(1e-6, 3),
        Err(MembraneError::TooFewNodes { nodes: 3, least: 4, .. })
    ));
    assert!(matches!(
        Mesh::sphere(-1.0, 100),
        Err(MembraneError::NotPositive { .. })
    ));
    let ball = Disc {
        volume: 300e-18,
        ..Disc::RBC_PAPER
    };
    let error = ball.mesh(100, Spacing::Spiral).unwrap_err();
    assert!(matches!(error, MembraneError::NoSuchDisc { .. }), "{error}");
}
