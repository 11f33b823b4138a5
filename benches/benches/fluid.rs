//! Steps of the bare fluid on one thread, 64^3 nodes.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lbm_ibm::coupling::{Bricks, Closure, Grid, Lattice, UM, Vec3};
use lbm_ibm::lbm::{Collision, Drive, Fluid};
use lbm_ibm_benches::scenes::{one_thread, plasma};
use std::sync::Arc;
use std::time::Duration;

const N: usize = 64;

fn cube() -> Fluid {
    let grid = Grid::new([N; 3], UM, [true; 3]);
    plasma(grid, 0.8, 1.0).expect("a good fluid")
}

/// A tube along x that fills the cube.
fn tube() -> Fluid {
    let half = 0.5 * N as f64 * UM;
    let wall = Closure::new(move |x: Vec3| half - (x.y - half).hypot(x.z - half), 1e-9);
    let mut fluid = cube();
    fluid.set_walls(Some(Arc::new(wall)), 0.0).expect("a wide tube");
    fluid
}

fn steps(c: &mut Criterion) {
    let force = Drive::Force(Vec3::x());
    let driven = |fluid: Fluid, drive: Drive| fluid.with_drive(drive).expect("a good drive");
    let bgk = cube().with_collision(Collision::Bgk).expect("a good collision");
    let cases = [
        ("periodic, TRT", cube(), false),
        ("periodic, BGK", bgk, false),
        ("uniform force", driven(cube(), force), false),
        ("flux control", driven(cube(), Drive::flux(0, 1e-3)), false),
        ("force on every node", cube(), true),
        ("tube, uniform force", driven(tube(), force), false),
        ("tube, flux control", driven(tube(), Drive::flux(0, 1e-3)), false),
    ];
    let mut group = c.benchmark_group("two steps of the fluid");
    group
        .sample_size(15)
        .measurement_time(Duration::from_secs(2))
        .warm_up_time(Duration::from_millis(500));
    for (name, mut fluid, everywhere) in cases {
        let mut bricks = Bricks::new(fluid.grid());
        if everywhere {
            (0..bricks.counts().iter().product()).for_each(|b| bricks.want(b));
            bricks.commit();
        }
        group.throughput(Throughput::Elements(2 * fluid.fluid_nodes() as u64));
        group.bench_function(name, |b| {
            b.iter(|| {
                fluid.advance(&bricks).expect("a stable flow");
                fluid.advance(&bricks).expect("a stable flow");
            });
        });
    }
    group.finish();
}

fn velocity(c: &mut Criterion) {
    let mut fluid = cube();
    let mut bricks = Bricks::new(fluid.grid());
    (0..bricks.counts().iter().product()).for_each(|b| bricks.want(b));
    bricks.commit();
    let mut group = c.benchmark_group("velocity of every node");
    group
        .sample_size(15)
        .measurement_time(Duration::from_secs(1))
        .warm_up_time(Duration::from_millis(300));
    group.throughput(Throughput::Elements(N.pow(3) as u64));
    group.bench_function("read", |b| b.iter(|| fluid.read_velocity(&mut bricks)));
    group.finish();
}

fn on_one_thread(c: &mut Criterion) {
    one_thread().expect("no pool before this one");
    steps(c);
    velocity(c);
}

criterion_group!(benches, on_one_thread);
criterion_main!(benches);
