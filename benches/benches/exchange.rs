//! Exchange between a fluid and ten spheres of 642 nodes, on one thread: per kernel, markers on the surface.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lbm_ibm::coupling::{BodyInfo, Bricks, Exchange, Grid, Motion, Soa3, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::membrane::Mesh;
use lbm_ibm_benches::scenes::one_thread;
use std::time::Duration;

const SPHERES: usize = 10;

/// Spheres of 4 grid spacings here and there in a periodic cube.
fn spheres() -> (Vec<BodyInfo>, Soa3) {
    let mesh = Mesh::sphere(4.0, 642).expect("a good sphere");
    let (mut x, mut bodies) = (Soa3::default(), Vec::new());
    for id in 0..SPHERES {
        let at = |n: usize| 64.0 * ((id * n) as f64 * 0.618_033_988_749_894_9).fract();
        let centre = Vec3::new(at(1), at(3), at(7));
        bodies.push(BodyInfo {
            id: id as u32,
            kind: "sphere".into(),
            range: x.len()..x.len() + mesh.nodes().len(),
            triangles: mesh.triangles().into(),
            motion: Motion::Advected,
        });
        mesh.nodes().iter().for_each(|p| x.push(centre + p));
    }
    (bodies, x)
}

fn exchange(c: &mut Criterion) {
    let grid = Grid::new([64; 3], 1.0, [true; 3]);
    let (bodies, x) = spheres();
    for pass in ["place", "interpolate", "spread"] {
        let mut group = c.benchmark_group(pass);
        group
            .sample_size(15)
            .measurement_time(Duration::from_secs(1))
            .warm_up_time(Duration::from_millis(300));
        for kernel in Kernel::ALL {
            let mut exchange = DeltaExchange::new(kernel);
            let mut bricks = Bricks::new(&grid);
            exchange.set_bodies(&bodies, x.view(), &grid).expect("a wide grid");
            exchange.place(x.view(), &mut bricks).expect("a periodic box");
            let mut u = Soa3::zeros(x.len());
            group.throughput(Throughput::Elements(exchange.marker_count() as u64));
            group.bench_function(format!("{kernel:?}"), |b| match pass {
                "place" => b.iter(|| exchange.place(x.view(), &mut bricks).expect("a periodic box")),
                "interpolate" => b.iter(|| exchange.interpolate(&bricks, u.view_mut())),
                _ => b.iter(|| exchange.spread(x.view(), &mut bricks)),
            });
        }
        group.finish();
    }
}

fn on_one_thread(c: &mut Criterion) {
    one_thread().expect("no pool before this one");
    exchange(c);
}

criterion_group!(benches, on_one_thread);
criterion_main!(benches);
