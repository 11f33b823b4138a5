//! A nucleus linked to its cell: momentum, energy, and that it comes back to the middle.

use lbm_ibm_coupling::nalgebra::Isometry3;
use lbm_ibm_coupling::{BodyInfo, Domain, ForceField, Loads, Motion, Scene, Soa3, Vec3, View};
use lbm_ibm_membrane::nucleus::NucleusLinks;
use lbm_ibm_membrane::{Material, MembraneError, Mesh, Sheet};
use std::sync::Arc;

const STIFFNESS: f64 = 1e-6;

fn meshes() -> (Arc<Mesh>, Arc<Mesh>) {
    let sphere = |radius, nodes| Arc::new(Mesh::sphere(radius, nodes).unwrap());
    (sphere(8e-6, 200), sphere(4e-6, 80))
}

/// The two bodies one after the other, the nucleus first, and their nodes deformed.
fn squeezed(cell: &Mesh, nucleus: &Mesh) -> (Vec<BodyInfo>, Soa3) {
    let (n, m) = (nucleus.nodes().len(), cell.nodes().len());
    let info = |id, range, mesh: &Mesh| BodyInfo {
        id,
        kind: "membrane".into(),
        range,
        triangles: mesh.triangles().into(),
        motion: Motion::Advected,
    };
    let bend = |x: Vec3| Vec3::new(1.3 * x.x + 3e4 * x.y * x.y, 0.7 * x.y, x.z + 0.2 * x.x);
    let x = nucleus.nodes().iter().chain(cell.nodes().iter()).map(bend).collect();
    (vec![info(9, 0..n, nucleus), info(4, n..n + m, cell)], x)
}

fn view<'a>(bodies: &'a [BodyInfo], x: &'a Soa3, domain: &'a Domain) -> View<'a> {
    View {
        x: x.view(),
        v: x.view(),
        bodies,
        domain,
        time: 0.0,
        time_step: 1.0,
        step: 0,
    }
}

#[test]
fn links_keep_force_and_torque_and_follow_their_energy() {
    let (cell, nucleus) = meshes();
    let (bodies, mut x) = squeezed(&cell, &nucleus);
    let domain = Domain::unbounded();
    let mut links = NucleusLinks::new((4, &cell), (9, &nucleus), STIFFNESS).unwrap();
    let mut loads = Loads::new(x.len(), 2);
    links.add_loads(&view(&bodies, &x, &domain), &mut loads);
    let f = loads.node.clone();
    let size: f64 = f.iter().map(|f| f.norm()).sum();
    let torque: Vec3 = x.iter().zip(f.iter()).map(|(x, f)| x.cross(&f)).sum();
    let moment: f64 = x.iter().zip(f.iter()).map(|(x, f)| x.norm() * f.norm()).sum();
    assert!(size > 0.0 && f.iter().sum::<Vec3>().norm() < 1e-12 * size && torque.norm() < 1e-12 * moment);
    let step = 1e-10;
    for i in (0..x.len()).step_by(11) {
        let at = x.get(i);
        let mut energy = |side: f64| {
            x.set(i, at + Vec3::new(side * step, 0.0, 0.0));
            links.energy(&view(&bodies, &x, &domain)).unwrap()
        };
        let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
        x.set(i, at);
        assert!((f.x[i] + slope).abs() < 1e-6 * size, "node {i}");
    }
    // With the nucleus gone nothing pulls on the cell.
    let mut alone = Loads::new(x.len(), 1);
    links.add_loads(&view(&bodies[1..], &x, &domain), &mut alone);
    assert!(alone.node.iter().all(|f| f == Vec3::zeros()));
}

#[test]
fn a_nucleus_comes_back_to_the_middle_and_moves_no_centre() {
    let (outer, inner) = meshes();
    let sheet = |shear: f64| Material {
        shear,
        dilation: 3.0 * shear,
        volume: 50.0,
        ..Material::none(Sheet::NeoHookean)
    };
    let motion = Motion::Overdamped { friction: 1e-8 };
    let cell = sheet(10e-6).cell("cell", outer.clone()).unwrap().with_motion(motion);
    let nucleus = sheet(40e-6).cell("nucleus", inner.clone()).unwrap().with_motion(motion);
    let mut scene = Scene::without_fluid(2e-5).unwrap();
    let cell = scene.add_body(cell, &Isometry3::identity()).unwrap();
    let nucleus = scene
        .add_body(nucleus, &Isometry3::translation(1e-6, 0.0, 0.0))
        .unwrap();
    scene.add_field(NucleusLinks::new((cell, &outer), (nucleus, &inner), STIFFNESS).unwrap());
    let centre = |scene: &Scene, id| scene.body_positions(id).unwrap().mean().x;
    let middle = |scene: &Scene| scene.positions().mean().x;
    let before = middle(&scene);
    // A node of the nucleus moves with k/(friction) d/3 or so: its mean way back takes some 3 friction/k.
    for _ in 0..10_000 {
        scene.step().unwrap();
    }
    let apart = centre(&scene, nucleus) - centre(&scene, cell);
    println!("the nucleus is {:.3} um from the middle", apart * 1e6);
    assert!(apart.abs() < 0.02e-6, "{apart:e}");
    assert!(
        (middle(&scene) - before).abs() < 1e-12 * 1e-6 + 1e-15,
        "{:e}",
        middle(&scene) - before
    );
}

#[test]
fn a_nucleus_larger_than_its_cell_is_refused() {
    let (cell, nucleus) = meshes();
    let large = nucleus.as_ref().clone().scaled(3.0).unwrap();
    let error = NucleusLinks::new((0, &cell), (1, &large), STIFFNESS).unwrap_err();
    assert!(matches!(error, MembraneError::NucleusOutside { .. }), "{error}");
    assert!(NucleusLinks::new((0, &cell), (1, &nucleus), -1.0).is_err());
}
