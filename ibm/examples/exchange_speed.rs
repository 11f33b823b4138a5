//! Time of placing, interpolating and spreading per marker and step, spheres in a periodic box: bare nodes, and meshes
//! whose surface carries the markers.
//!
//! `cargo run --release -p lbm-ibm-ibm --example exchange_speed`; one thread with `RAYON_NUM_THREADS=1`.

use lbm_ibm_coupling::{BodyInfo, Bricks, Exchange, ExchangeError, Grid, Motion, Soa3, Vec3};
use lbm_ibm_ibm::{DeltaExchange, Kernel, Markers};
use std::time::{Duration, Instant};

#[path = "../tests/mesh/mod.rs"]
mod mesh;

const SPHERES: usize = 50;
const STEPS: usize = 100;

fn main() -> Result<(), ExchangeError> {
    let grid = Grid::new([64; 3], 1.0, [true; 3]);
    let (unit, triangles) = mesh::icosphere(8);
    let nodes = unit.len();
    let (mut x, mut bodies) = (Soa3::default(), Vec::new());
    for id in 0..SPHERES {
        let at = |n: usize| 64.0 * ((id * n) as f64 * 0.618_033_988_749_894_9).fract();
        let centre = Vec3::new(at(1), at(3), at(7));
        bodies.push(BodyInfo {
            id: id as u32,
            kind: "sphere".into(),
            range: x.len()..x.len() + nodes,
            triangles: triangles.as_slice().into(),
            motion: Motion::Advected,
        });
        unit.iter().for_each(|v| x.push(centre + 6.0 * v));
    }
    println!("{SPHERES} spheres of {nodes} nodes, radius 6 cells, 64^3 nodes; least ns per marker and step");
    println!("kernel       markers   place interpolate  spread     sum");
    for markers in [Markers::Nodes, Markers::default()] {
        for kernel in Kernel::ALL {
            let mut exchange = DeltaExchange::new(kernel).with_markers(markers);
            exchange.set_bodies(&bodies, x.view(), &grid)?;
            let least = measure(&mut exchange, &x, &grid)?;
            let ns = least.map(|t| t.as_nanos() as f64 / exchange.marker_count() as f64);
            let (name, count, sum) = (format!("{kernel:?}"), exchange.marker_count(), ns.iter().sum::<f64>());
            println!(
                "{name:12} {count:7} {:7.1} {:11.1} {:7.1} {sum:7.1}",
                ns[0], ns[1], ns[2]
            );
        }
    }
    Ok(())
}

/// Least time of each of the three passes.
fn measure(exchange: &mut DeltaExchange, x: &Soa3, grid: &Grid) -> Result<[Duration; 3], ExchangeError> {
    let mut bricks = Bricks::new(grid);
    let mut u = Soa3::zeros(x.len());
    let mut least = [Duration::MAX; 3];
    for _ in 0..STEPS {
        let start = Instant::now();
        exchange.place(x.view(), &mut bricks)?;
        let placed = Instant::now();
        exchange.interpolate(&bricks, u.view_mut());
        let interpolated = Instant::now();
        exchange.spread(x.view(), &mut bricks);
        let passes = [placed - start, interpolated - placed, interpolated.elapsed()];
        least = [0, 1, 2].map(|i| least[i].min(passes[i]));
    }
    Ok(least)
}
