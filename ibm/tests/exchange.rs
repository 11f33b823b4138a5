//! Interpolation and spreading: adjoint, conservative, exact for linear fields, the same for any number of threads.

use lbm_ibm_coupling::{BodyInfo, Bricks, Exchange, ExchangeError, Grid, Motion, Soa3, Soa3Mut, Soa3Ref, Vec3};
use lbm_ibm_ibm::{DeltaExchange, Kernel, Markers};
use proptest::prelude::*;

mod mesh;

fn body(nodes: usize, triangles: &[[u32; 3]]) -> BodyInfo {
    BodyInfo {
        id: 7,
        kind: "test".into(),
        range: 0..nodes,
        triangles: triangles.into(),
        motion: Motion::Advected,
    }
}

/// An exchange with one body, placed.
fn placed(
    kernel: Kernel,
    grid: &Grid,
    x: Soa3Ref<'_>,
    triangles: &[[u32; 3]],
) -> Result<(DeltaExchange, Bricks), ExchangeError> {
    let mut bricks = Bricks::new(grid);
    let mut exchange = DeltaExchange::new(kernel);
    exchange.set_bodies(&[body(x.len(), triangles)], x, grid)?;
    exchange.place(x, &mut bricks)?;
    Ok((exchange, bricks))
}

/// Sets the velocity of all nodes of the bricks in use to a field of position.
fn fill(bricks: &mut Bricks, grid: &Grid, field: impl Fn(Vec3) -> Vec3) {
    for slot in 0..bricks.len() {
        let [bx, by, bz] = bricks.brick(slot).map(|b| 8 * b);
        for i in 0..512 {
            let u = field(grid.position(bx + i % 8, by + i / 8 % 8, bz + i / 64));
            for a in 0..3 {
                bricks.velocity_mut()[a][512 * slot + i] = u[a];
            }
        }
    }
}

fn interpolated(exchange: &mut DeltaExchange, bricks: &Bricks, nodes: usize) -> Soa3 {
    let mut u = Soa3::zeros(nodes);
    exchange.interpolate(bricks, u.view_mut());
    u
}

/// A field without any symmetry, for adjointness.
fn rough(x: Vec3) -> Vec3 {
    Vec3::new(1.3, 2.7, 3.1).map(|a| (a * (x.x + 1.7 * x.y + 2.3 * x.z)).sin())
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(&b)).sum()
}

fn power(bricks: &Bricks) -> f64 {
    let pair = |a: usize| {
        bricks.velocity()[a]
            .iter()
            .zip(bricks.force()[a])
            .map(|(u, f)| u * f)
            .sum::<f64>()
    };
    (0..3).map(pair).sum()
}

/// A sphere across all faces of a periodic grid whose last bricks are short, edges of 2 grid spacings.
fn sphere(grid: &Grid, shift: Vec3) -> (Soa3, Vec<[u32; 3]>) {
    let (unit, triangles) = mesh::icosphere(3);
    (unit.iter().map(|v| shift + 5.0 * grid.spacing * v).collect(), triangles)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    #[test]
    fn adjoint_and_conservative(points in prop::collection::vec(prop::array::uniform3(-30.0..50.0_f64), 1..80)) {
        // Short last bricks of one and two nodes; 5 nodes, in one brick.
        for shape in [[17, 26, 12], [9, 5, 33], [8, 16, 4]] {
            let grid = Grid::new(shape, 0.5, [true; 3]).with_origin(Vec3::new(-1.0, 2.0, 0.3));
            let x: Soa3 = points.iter().map(|&p| Vec3::from(p)).collect();
            let f: Soa3 = x.iter().map(|x| rough(x * 3.3)).collect();
            let narrowest = shape.into_iter().min().unwrap_or(0);
            for kernel in Kernel::ALL.into_iter().filter(|k| k.support() <= narrowest) {
                let (mut exchange, mut bricks) = placed(kernel, &grid, x.view(), &[])?;
                fill(&mut bricks, &grid, rough);
                let u = interpolated(&mut exchange, &bricks, x.len());
                exchange.spread(f.view(), &mut bricks);
                let scale = dot(&f, &f).sqrt() * dot(&u, &u).sqrt();
                prop_assert!((dot(&f, &u) - power(&bricks)).abs() < 1e-12 * scale, "{kernel:?}");
                let lost = bricks.total_force() - f.iter().sum::<Vec3>();
                prop_assert!(lost.norm() < 1e-13 * f.iter().map(|f| f.norm()).sum::<f64>().max(1.0));
            }
        }
    }

    #[test]
    fn adjoint_on_surfaces(shift in prop::array::uniform3(-20.0..20.0_f64)) {
        let grid = Grid::new([17, 26, 33], 0.5, [true; 3]);
        let (x, triangles) = sphere(&grid, Vec3::from(shift));
        let f: Soa3 = x.iter().map(rough).collect();
        for kernel in Kernel::ALL {
            let (mut exchange, mut bricks) = placed(kernel, &grid, x.view(), &triangles)?;
            fill(&mut bricks, &grid, rough);
            let u = interpolated(&mut exchange, &bricks, x.len());
            exchange.spread(f.view(), &mut bricks);
            let scale = dot(&f, &f).sqrt() * dot(&u, &u).sqrt();
            prop_assert!((dot(&f, &u) - power(&bricks)).abs() < 1e-12 * scale, "{kernel:?}");
            let lost = bricks.total_force() - f.iter().sum::<Vec3>();
            prop_assert!(lost.norm() < 1e-13 * f.iter().map(|f| f.norm()).sum::<f64>());
        }
    }

    #[test]
    fn whole_cells_change_nothing(cells in prop::array::uniform3(-40_i32..40), at in prop::array::uniform3(0.0..8.0_f64)) {
        // A spacing of a power of two and dyadic positions: the shift is exact.
        let grid = Grid::new([16, 24, 16], 0.25, [true; 3]);
        let at = Vec3::from(at).map(|a| (a * 1024.0).round() / 1024.0);
        let there = at + Vec3::from(cells.map(f64::from)) * grid.spacing;
        for kernel in Kernel::ALL {
            let stencils = |x: Vec3| {
                let x: Soa3 = [x].into_iter().collect();
                let (mut exchange, mut bricks) = placed(kernel, &grid, x.view(), &[]).expect("a periodic grid");
                exchange.spread(Soa3 { x: vec![1.0], y: vec![0.0], z: vec![0.0] }.view(), &mut bricks);
                let mut weights: Vec<f64> = bricks.force()[0].iter().copied().filter(|w| *w != 0.0).collect();
                weights.sort_by(f64::total_cmp);
                weights
            };
            prop_assert_eq!(stencils(at), stencils(there));
        }
    }
}

#[test]
fn linear_fields_are_exact_at_single_nodes() {
    let grid = Grid::new([24; 3], 0.5, [false; 3]);
    let x: Soa3 = (0..200)
        .map(|i| (rough(Vec3::repeat(i as f64)) * 3.0).add_scalar(6.0))
        .collect();
    let linear = |x: Vec3| Vec3::new(1.0 + x.y, 2.0 * x.x - x.z, 0.3 * x.z + x.x);
    for kernel in Kernel::ALL {
        let (mut exchange, mut bricks) = placed(kernel, &grid, x.view(), &[]).expect("nodes inside");
        fill(&mut bricks, &grid, linear);
        let u = interpolated(&mut exchange, &bricks, x.len());
        let error = x
            .iter()
            .zip(u.iter())
            .map(|(x, u)| (linear(x) - u).norm())
            .fold(0.0, f64::max);
        assert!(kernel == Kernel::CosineFour || error < 1e-12, "{kernel:?}: {error}");
        fill(&mut bricks, &grid, |_| Vec3::new(1.0, -2.0, 3.0));
        let u = interpolated(&mut exchange, &bricks, x.len());
        assert!(u.iter().all(|u| (u - Vec3::new(1.0, -2.0, 3.0)).norm() < 1e-13));
    }
}

/// Nodes turn with the fluid though their markers lie inside the sphere: edges of 0.58, 0.29 and 0.15 R.
#[test]
fn coarse_surfaces_turn_with_the_fluid() {
    let grid = Grid::new([24; 3], 1.0, [false; 3]);
    let centre = Vec3::new(12.1, 11.8, 12.3);
    let omega = Vec3::new(0.3, -0.2, 0.9);
    for (parts, allowed) in [(2, 6e-3), (4, 4e-3), (8, 1e-3)] {
        let (unit, triangles) = mesh::icosphere(parts);
        let x: Soa3 = unit.iter().map(|v| centre + 6.0 * v).collect();
        let (mut exchange, mut bricks) =
            placed(Kernel::RomaThree, &grid, x.view(), &triangles).expect("a sphere inside");
        fill(&mut bricks, &grid, |x| omega.cross(&(x - centre)));
        let u = interpolated(&mut exchange, &bricks, x.len());
        let slip = |(x, u): (Vec3, Vec3)| (omega.cross(&(x - centre)) - u).norm() / (6.0 * omega.norm());
        let worst = x.iter().zip(u.iter()).map(slip).fold(0.0, f64::max);
        assert!(worst < allowed, "{worst} with {parts} parts");
    }
}

#[cfg(feature = "parallel")]
/// Forces on the grid and velocities at the nodes of some spheres.
fn spread_and_interpolate() -> (Vec<f64>, Soa3) {
    let grid = Grid::new([41, 40, 33], 0.5, [true; 3]);
    let (unit, triangles) = mesh::icosphere(6);
    let n = unit.len();
    let (mut x, mut bodies) = (Soa3::default(), Vec::new());
    for id in 0..6 {
        let centre = Vec3::new(2.3, 3.1, 1.7) * f64::from(id);
        unit.iter().for_each(|v| x.push(centre + 3.0 * v));
        let range = id as usize * n..(id as usize + 1) * n;
        bodies.push(BodyInfo {
            id,
            range,
            ..body(n, &triangles)
        });
    }
    let f: Soa3 = x.iter().map(rough).collect();
    let mut bricks = Bricks::new(&grid);
    let mut exchange = DeltaExchange::new(Kernel::PeskinFour);
    exchange
        .set_bodies(&bodies, x.view(), &grid)
        .expect("a grid wide enough");
    exchange.place(x.view(), &mut bricks).expect("a periodic grid");
    fill(&mut bricks, &grid, rough);
    let u = interpolated(&mut exchange, &bricks, x.len());
    exchange.spread(f.view(), &mut bricks);
    (bricks.force().concat(), u)
}

#[cfg(feature = "parallel")]
#[test]
fn same_bits_for_any_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(spread_and_interpolate)
    };
    let one = on(1);
    assert!(one.0.iter().any(|f| *f != 0.0));
    for threads in [2, 3, 4] {
        assert_eq!(one, on(threads), "{threads} threads");
    }
}

#[test]
fn a_stretched_body_is_divided_more_finely_until_it_tears() {
    let grid = Grid::new([64; 3], 1.0, [true; 3]);
    let (unit, triangles) = mesh::icosphere(3);
    let scaled = |s: f64| -> Soa3 { unit.iter().map(|v| s * v).collect() };
    let x = scaled(4.0);
    let mut bricks = Bricks::new(&grid);
    let most = Markers::Surface {
        max_gap: 1.0,
        max_division: 6,
    };
    let mut exchange = DeltaExchange::new(Kernel::RomaThree).with_markers(most);
    exchange
        .set_bodies(&[body(x.len(), &triangles)], x.view(), &grid)
        .expect("a grid wide enough");
    let division = |e: &DeltaExchange| e.divisions().next().expect("one body");
    let before = (division(&exchange).1, exchange.marker_count());
    exchange.place(scaled(4.5).view(), &mut bricks).expect("small gaps");
    assert_eq!((division(&exchange).1, exchange.marker_count()), before);
    exchange.place(scaled(9.0).view(), &mut bricks).expect("more markers");
    let (id, k) = division(&exchange);
    assert!(id == 7 && k > before.0 && exchange.marker_count() == 10 * 9 * k * k + 2);
    fill(&mut bricks, &grid, |_| Vec3::x());
    let u = interpolated(&mut exchange, &bricks, x.len());
    assert!(u.x.iter().all(|u| (u - 1.0).abs() < 1e-12));
    let torn = exchange.place(scaled(20.0).view(), &mut bricks);
    let Err(ExchangeError::MarkerGap {
        body: 7,
        triangle,
        gap_in_cells,
        limit,
    }) = torn
    else {
        panic!("{torn:?}");
    };
    assert!(triangle < triangles.len() && gap_in_cells > limit && limit == 1.2);
    let mut nodes = DeltaExchange::new(Kernel::RomaThree).with_markers(Markers::Nodes);
    nodes
        .set_bodies(&[body(x.len(), &triangles)], x.view(), &grid)
        .expect("a grid wide enough");
    nodes
        .place(scaled(20.0).view(), &mut bricks)
        .expect("nodes alone know no gap");
    assert_eq!(nodes.marker_count(), x.len());
}

#[test]
fn positions_outside_and_grids_too_small_are_errors() {
    let grid = Grid::new([16; 3], 1.0, [true, false, true]);
    let at = |x: f64, y: f64| -> Soa3 { [Vec3::new(x, y, 3.0)].into_iter().collect() };
    assert!(placed(Kernel::PeskinFour, &grid, at(-100.0, 0.0).view(), &[]).is_ok());
    assert!(placed(Kernel::PeskinFour, &grid, at(3.0, 16.0).view(), &[]).is_ok());
    for (x, y) in [
        (3.0, -0.01),
        (3.0, 16.01),
        (f64::NAN, 3.0),
        (3.0, f64::NAN),
        (f64::INFINITY, 3.0),
    ] {
        let outside = placed(Kernel::PeskinFour, &grid, at(x, y).view(), &[]);
        assert!(
            matches!(outside, Err(ExchangeError::OutsideGrid { body: 7, .. })),
            "{x} {y}"
        );
    }
    // Beyond a wall the fluid is at rest, beyond an open face nothing is known of it.
    let mut open = Grid::new([16; 3], 1.0, [true, false, true]);
    open.open[1] = [true, false];
    for (y, fits) in [(1.49, false), (1.51, true), (14.51, true), (15.9, true)] {
        let near = placed(Kernel::PeskinFour, &open, at(3.0, y).view(), &[]);
        assert_eq!(near.is_ok(), fits, "{y}");
        assert!(fits || matches!(near, Err(ExchangeError::OutsideGrid { body: 7, .. })));
    }
    open.open[1] = [false, true];
    for (y, fits) in [(0.1, true), (14.49, true), (14.51, false)] {
        assert_eq!(
            placed(Kernel::PeskinFour, &open, at(3.0, y).view(), &[]).is_ok(),
            fits,
            "{y}"
        );
    }
    let narrow = Grid::new([16, 16, 3], 1.0, [true; 3]);
    let small = placed(Kernel::PeskinFour, &narrow, at(1.0, 1.0).view(), &[]);
    assert!(matches!(
        small,
        Err(ExchangeError::GridTooSmall {
            axis: 2,
            nodes: 3,
            support: 4
        })
    ));
}

/// Nodes of the stencil behind a wall are at rest, and the force they would get is the wall's.
#[test]
fn the_wall_takes_its_share() {
    let grid = Grid::new([16; 3], 1.0, [false; 3]);
    let x: Soa3 = [Vec3::new(5.3, 0.0, 5.8)].into_iter().collect();
    for kernel in Kernel::ALL {
        let (mut exchange, mut bricks) = placed(kernel, &grid, x.view(), &[]).expect("a node on the wall");
        fill(&mut bricks, &grid, |_| Vec3::x());
        let mut u = Soa3::zeros(1);
        let Soa3 { x: ux, y, z } = &mut u;
        exchange.interpolate(&bricks, Soa3Mut { x: ux, y, z });
        assert!((u.x[0] - 0.5).abs() < 1e-14);
        exchange.spread(u.view(), &mut bricks);
        assert!((bricks.total_force().x - 0.25).abs() < 1e-14);
    }
}
