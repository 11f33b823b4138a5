//! Bad input ends in a typed error whose message has the number and the remedy.

use lbm_ibm::contact::SlitChannel;
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{FluidError, Grid, Lattice, Scene, SceneError, Soa3, UM, Vec3};
use lbm_ibm::ibm::DeltaExchange;
use lbm_ibm::lbm::{Fluid, LbmError, Pace};
use lbm_ibm::membrane::{Form, MembraneError, Mesh, presets};
use lbm_ibm_benches::scenes::{channel, plasma, slit_walls};
use std::sync::Arc;

/// Asserts that a message holds every one of the words.
fn says(error: &impl std::error::Error, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
}

#[test]
fn an_open_mesh() {
    let sphere = Mesh::sphere(4.0 * UM, 100).expect("a good sphere");
    let nodes: Soa3 = sphere.nodes().iter().collect();
    let error = Mesh::new(nodes, sphere.triangles()[1..].to_vec()).expect_err("a hole");
    assert!(
        matches!(error, MembraneError::OpenMesh { open_edges: 3, .. }),
        "{error:?}"
    );
    says(&error, &["3 edges", "add the missing triangles"]);
}

#[test]
fn a_relaxation_time_of_one_half_or_less() {
    let grid = || Grid::new([8; 3], UM, [true; 3]);
    for tau in [0.5, 0.3] {
        let error = plasma(grid(), tau, 1.0).expect_err("no viscosity");
        assert!(matches!(error, LbmError::RelaxationTime { .. }), "{error:?}");
        says(
            &error,
            &[&format!("relaxation time is {tau}"), "use a time step of at least"],
        );
    }
    let error = Fluid::new(grid(), 1025.0, 1.2e-3, Pace::TimeStep(1e-12)).expect_err("too small a step");
    assert!(matches!(error, LbmError::RelaxationTime { .. }), "{error:?}");
    says(&error, &["0.50000", "use a time step of at least"]);
}

#[test]
fn a_gap_of_one_cell() {
    let slit = SlitChannel {
        height: 13.0 * UM,
        gap: 1.0 * UM,
        thickness: 6.0 * UM,
        edge_radius: 1.0 * UM,
        position: 16.0 * UM,
    };
    let walls = Arc::new(slit.walls().expect("a good slit"));
    let grid = Grid::new([32, 13, 8], UM, [true, false, true]);
    let mut fluid = plasma(grid, 1.0, 1.0).expect("a good fluid");
    let error = fluid.set_walls(Some(walls.clone()), 0.0).expect_err("one cell");
    assert!(matches!(error, FluidError::NarrowGap { cells: 1, .. }), "{error:?}");
    says(&error, &["1 cell", "use a spacing of at most"]);
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Default::default()));
    let error = scene.set_walls(walls).expect_err("one cell");
    assert!(
        matches!(error, SceneError::Fluid(FluidError::NarrowGap { .. })),
        "{error:?}"
    );
}

#[test]
fn a_cell_in_a_wall() {
    let grid = Grid::new([40, 24, 20], UM, [true, false, true]);
    let fluid = plasma(grid, 1.0, 20.0).expect("a good fluid");
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Default::default()));
    scene.set_walls(slit_walls().expect("good walls")).expect("a wide gap");
    let cell = presets::ctc_paper(Form::Corrected).expect("a good cell");
    let pose = Isometry3::translation(20.0 * UM, 12.0 * UM, 10.0 * UM);
    let error = scene.add_body(cell.clone(), &pose).expect_err("16 um in 12 um");
    assert!(
        matches!(
            error,
            SceneError::BodyInWall {
                body: 0,
                nodes: 306,
                ..
            }
        ),
        "{error:?}"
    );
    says(&error, &["of 306 nodes", "place it farther from the wall"]);
    assert!(scene.bodies().is_empty());
    let pose = Isometry3::translation(8.5 * UM, 12.0 * UM, 10.0 * UM);
    scene.add_body(cell, &pose).expect("room before the slit");
}

#[test]
fn a_time_step_over_a_limit() {
    let cell = presets::rbc_paper(Form::Corrected).expect("a good cell");
    let mut scene = channel(cell, 8.0 * UM, UM, 10e-6, 40.0).expect("a good scene");
    let error = scene.step().expect_err("a stiff cell");
    assert!(matches!(error, SceneError::TimeStep { .. }), "{error:?}");
    says(
        &error,
        &["1.000e-5 s", "limit of", "elasticity of body 0 (rbc)", "use a smaller"],
    );
    assert_eq!(scene.steps(), 0);
}

#[test]
fn a_sphere_of_three_nodes_and_a_mesh_without_a_place() {
    let error = Mesh::sphere(UM, 3).expect_err("three nodes");
    says(&error, &["3 nodes", "at least 4"]);
    let nodes: Soa3 = [Vec3::x(), Vec3::y(), Vec3::z() * f64::NAN].into_iter().collect();
    let error = Mesh::new(nodes, vec![[0, 1, 2]]).expect_err("not finite");
    says(&error, &["node 2"]);
}
