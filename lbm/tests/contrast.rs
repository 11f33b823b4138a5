//! Another viscosity inside of cells: layers and a sphere against analytic flow.

use lbm_ibm_coupling::{BodyInfo, Bricks, Grid, Inside, Lattice, Motion, Soa3, Vec3};
use lbm_ibm_lbm::{Drive, Fluid, Pace};

/// A closed box of two triangles a face, between corners (m).
fn slab(low: Vec3, high: Vec3) -> (Soa3, BodyInfo) {
    let pick = |bit: bool, a: usize| if bit { high[a] } else { low[a] };
    let x: Soa3 = (0..8)
        .map(|n| Vec3::new(pick(n & 1 > 0, 0), pick(n & 2 > 0, 1), pick(n & 4 > 0, 2)))
        .collect();
    let quads = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let body = BodyInfo {
        id: 0,
        kind: "slab".into(),
        range: 0..8,
        triangles: triangles.into(),
        motion: Motion::Advected,
    };
    (x, body)
}

/// Velocity (m/s) by row across a channel of `n` nodes with a layer of `ratio` times the viscosity over nodes `from` to `to`
/// (a fraction of a node counts by its share), under a uniform force density of 1 N/m3.
fn layered(n: usize, [from, to]: [f64; 2], ratio: f64) -> (Vec<f64>, f64) {
    let h = 1e-6;
    let grid = Grid::new([5, n, 4], h, [true, false, true]);
    let fluid = Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(1.2))
        .expect("a fluid")
        .with_inertia(false);
    let mut fluid = fluid.with_drive(Drive::Force(Vec3::x())).expect("a force");
    let (x, body) = slab(Vec3::new(0.0, from * h, 0.0), Vec3::new(5.0 * h, to * h, 4.0 * h));
    let mut inside = Inside::new(&grid);
    inside.find(&grid, x.view(), std::iter::once((&body, ratio)));
    let bricks = Bricks::new(&grid);
    fluid.set_inside(&inside).expect("a fluid with two viscosities");
    for _ in 0..(40 * n * n) {
        fluid.advance(&bricks).expect("a step");
    }
    let all = fluid.macroscopic().expect("fields");
    ((0..n).map(|j| all.velocity[0][5 * j]).collect(), h)
}

#[test]
fn layers_of_two_viscosities_share_the_stress() {
    let (n, half) = (20, 4.0);
    for ratio in [0.2, 5.0, 20.0] {
        // The stress is the distance from the middle, whatever the viscosity: u = (H^2 - c^2)/2mu + (c^2 - y^2)/(2 ratio mu).
        let (u, h) = layered(n, [10.0 - half, 10.0 + half], ratio);
        for (j, u) in u.iter().enumerate() {
            let y = (j as f64 - 9.5).abs();
            let parabola = |from: f64, to: f64| (to * to - from * from) * h * h / 2e-3;
            let exact = if y > half {
                parabola(y, 10.0)
            } else {
                parabola(half, 10.0) + parabola(y, half) / ratio
            };
            let error = (u - exact).abs() / parabola(0.0, 10.0);
            assert!(error < 2e-3, "ratio {ratio}, row {j}: {u:e} {exact:e} {error:e}");
        }
    }
}

#[test]
fn the_same_viscosity_inside_changes_nothing() {
    let (with, _) = layered(12, [3.2, 7.7], 1.0);
    let (without, _) = layered(12, [20.0, 21.0], 1.0);
    for (a, b) in with.iter().zip(&without) {
        assert!((a - b).abs() < 1e-12 * b.abs(), "{a:e} {b:e}");
    }
}

#[test]
fn a_viscosity_that_cannot_be_is_refused() {
    let grid = Grid::new([8, 8, 8], 1e-6, [true; 3]);
    let mut fluid = Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(0.6)).expect("a fluid");
    let (x, body) = slab(Vec3::repeat(2e-6), Vec3::repeat(6e-6));
    let mut inside = Inside::new(&grid);
    inside.find(&grid, x.view(), std::iter::once((&body, 1e-3)));
    let error = fluid.set_inside(&inside).expect_err("too thin a fluid").to_string();
    assert!(error.contains("0.50010"), "{error}");
}

#[test]
fn a_fluid_that_fluctuates_refuses_a_second_viscosity() {
    let h = 1e-6;
    let grid = Grid::new([6, 6, 6], h, [true; 3]);
    let fluid = Fluid::new(grid.clone(), 1e3, 1e-3, Pace::Tau(1.0)).expect("a fluid");
    let mut fluid = fluid.with_temperature(300.0, 1).expect("a warm fluid");
    let (x, body) = slab(Vec3::repeat(1.0 * h), Vec3::repeat(5.0 * h));
    let mut inside = Inside::new(&grid);
    inside.find(&grid, x.view(), std::iter::once((&body, 5.0)));
    let error = fluid.set_inside(&inside).expect_err("two viscosities");
    assert!(error.to_string().contains("temperature"), "{error}");
}
