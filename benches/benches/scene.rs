//! Contact between cells and with walls, and whole time steps, on one thread.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lbm_ibm::contact::{CellRepulsion, SoftSphere, WallRepulsion};
use lbm_ibm::coupling::{ForceField, Loads, Scene, View};
use lbm_ibm_benches::scenes::{crowd, one_thread, slit, slit_walls};
use std::time::Duration;

/// What a field sees of a scene.
fn view(scene: &Scene) -> View<'_> {
    View {
        x: scene.positions(),
        v: scene.velocities(),
        bodies: scene.bodies(),
        domain: scene.domain(),
        time: scene.time(),
        time_step: scene.time_step(),
        step: scene.steps(),
    }
}

fn contact(c: &mut Criterion) {
    let (slit, crowd) = (slit().expect("a good scene"), crowd(48, 64).expect("a good scene"));
    let wall = |reach: f64| {
        let law = SoftSphere::from_nanonewton_micrometre(1e-4, 1.2, reach).expect("a good law");
        WallRepulsion::new(slit_walls().expect("good walls"), law)
    };
    let cells = |reach: f64| {
        let law = SoftSphere::from_nanonewton_micrometre(5e-3, 2.0, reach).expect("a good law");
        CellRepulsion::new(law)
    };
    let mut fields: [(&str, Box<dyn ForceField>, &Scene); 4] = [
        ("a cell and walls, far", Box::new(wall(0.1)), &slit),
        ("a cell and walls, all nodes within reach", Box::new(wall(30.0)), &slit),
        ("64 cells, none in touch", Box::new(cells(0.3)), &crowd),
        ("64 cells, all in touch", Box::new(cells(5.0)), &crowd),
    ];
    let mut group = c.benchmark_group("contact");
    group
        .sample_size(10)
        .measurement_time(Duration::from_secs(1))
        .warm_up_time(Duration::from_millis(300));
    for (name, field, scene) in &mut fields {
        let mut loads = Loads::new(scene.positions().len(), scene.bodies().len());
        group.throughput(Throughput::Elements(scene.positions().len() as u64));
        group.bench_function(*name, |b| b.iter(|| field.add_loads(&view(scene), &mut loads)));
    }
    group.finish();
}

fn steps(c: &mut Criterion) {
    let mut scenes = [
        ("tumour cell in a slit, 19200 nodes", slit().expect("a good scene")),
        ("8 spheres of 642 nodes in 32^3", crowd(32, 8).expect("a good scene")),
        ("no cell in 32^3", crowd(32, 0).expect("a good scene")),
    ];
    let mut group = c.benchmark_group("time step");
    group
        .sample_size(15)
        .measurement_time(Duration::from_secs(2))
        .warm_up_time(Duration::from_millis(500));
    for (name, scene) in &mut scenes {
        group.bench_function(*name, |b| b.iter(|| scene.step().expect("a scene that runs")));
    }
    group.finish();
}

fn on_one_thread(c: &mut Criterion) {
    one_thread().expect("no pool before this one");
    contact(c);
    steps(c);
}

criterion_group!(benches, on_one_thread);
criterion_main!(benches);
