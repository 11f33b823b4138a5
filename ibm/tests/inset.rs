//! Markers inside an elastic surface: what the transposed path keeps, and how large the body acts.

use lbm_ibm_coupling::{BodyInfo, Bricks, Exchange, ExchangeError, Grid, Motion, Soa3, Vec3};
use lbm_ibm_ibm::stokes::surface_radius;
use lbm_ibm_ibm::{DeltaExchange, Kernel};

mod mesh;

const H: f64 = 0.5;

/// An uneven spheroid about the middle of a grid of 24 nodes, its semi-axes in spacings, and its triangles.
fn spheroid(axes: [f64; 3]) -> (Soa3, Vec<[u32; 3]>) {
    let (unit, triangles) = mesh::icosphere(8);
    let middle = Vec3::new(12.13, 12.29, 12.41) * H;
    let bumps = |v: &Vec3| 1.0 + 0.1 * v.x * v.y - 0.07 * v.z;
    let x = unit
        .iter()
        .map(|v| middle + bumps(&v) * H * Vec3::new(axes[0] * v.x, axes[1] * v.y, axes[2] * v.z))
        .collect();
    (x, triangles)
}

fn placed(kernel: Kernel, x: &Soa3, triangles: &[[u32; 3]]) -> Result<(DeltaExchange, Bricks, Grid), ExchangeError> {
    let grid = Grid::new([24; 3], H, [true; 3]);
    let mut bricks = Bricks::new(&grid);
    let mut exchange = DeltaExchange::new(kernel).with_elastic_inset(true);
    let body = BodyInfo {
        id: 3,
        kind: "test".into(),
        range: 0..x.len(),
        triangles: triangles.into(),
        motion: Motion::Advected,
    };
    exchange.set_bodies(&[body], x.view(), &grid)?;
    exchange.place(x.view(), &mut bricks)?;
    Ok((exchange, bricks, grid))
}

/// Calls `visit` with the slot, the number in it and the position of each node of the bricks in use.
fn nodes(bricks: &Bricks, grid: &Grid, mut visit: impl FnMut(usize, Vec3)) {
    for slot in 0..bricks.len() {
        let [x, y, z] = bricks.brick(slot).map(|b| 8 * b);
        for i in 0..512 {
            visit(512 * slot + i, grid.position(x + i % 8, y + i / 8 % 8, z + i / 64));
        }
    }
}

#[test]
fn power_force_and_torque_are_kept_and_a_turning_fluid_turns_the_body() {
    let (x, triangles) = spheroid([5.0, 4.0, 6.0]);
    for kernel in [
        Kernel::TwoPoint,
        Kernel::RomaThree,
        Kernel::PeskinFour,
        Kernel::SixPoint,
    ] {
        let (mut exchange, mut bricks, grid) = placed(kernel, &x, &triangles).expect("a smooth body");
        let spin = Vec3::new(0.3, -0.7, 0.4);
        let flow = |p: Vec3| spin.cross(&(p - Vec3::repeat(3.0))) + Vec3::new(1.0, 2.0, -0.5);
        let mut at = Vec::new();
        nodes(&bricks, &grid, |i, p| at.push((i, p)));
        for &(i, p) in &at {
            let u = flow(p);
            for a in 0..3 {
                bricks.velocity_mut()[a][i] = u[a];
            }
        }
        let mut u = Soa3::zeros(x.len());
        exchange.interpolate(&bricks, u.view_mut());
        // The table between markers and nodes keeps a rotation to 0.4 % of the speed.
        let error = u
            .iter()
            .zip(x.iter())
            .map(|(u, x)| (u - flow(x)).norm())
            .fold(0.0, f64::max);
        assert!(error < 5e-3 * spin.norm() * 6.0 * H, "{kernel:?}: {error}");

        let force: Soa3 = x
            .iter()
            .map(|x| Vec3::new(1.3, 2.7, 3.1).map(|a| (a * (x.x + 1.7 * x.y)).sin()))
            .collect();
        bricks.clear_force();
        exchange.spread(force.view(), &mut bricks);
        let (mut power, mut net, mut torque) = (0.0, Vec3::zeros(), Vec3::zeros());
        for &(i, p) in &at {
            let f = Vec3::new(bricks.force()[0][i], bricks.force()[1][i], bricks.force()[2][i]);
            power += f.dot(&flow(p));
            net += f;
            torque += p.cross(&f);
        }
        let given: f64 = force.iter().zip(u.iter()).map(|(f, u)| f.dot(&u)).sum();
        let size: f64 = force.iter().map(|f| f.norm()).sum();
        assert!(
            (power - given).abs() < 1e-12 * size * 4.0,
            "{kernel:?}: {power} {given}"
        );
        assert!((net - force.iter().sum::<Vec3>()).norm() < 1e-12 * size);
        let exact: Vec3 = x.iter().zip(force.iter()).map(|(x, f)| x.cross(&f)).sum();
        assert!(
            (torque - exact).norm() < 5e-3 * size * 3.0 * H,
            "{kernel:?}: {torque} {exact}"
        );
    }
}

#[test]
fn a_sphere_acts_as_large_as_it_is() {
    let (unit, triangles) = mesh::icosphere(8);
    let x: Soa3 = unit.iter().map(|v| Vec3::new(24.13, 24.29, 24.41) + 4.0 * v).collect();
    for kernel in [Kernel::TwoPoint, Kernel::PeskinFour, Kernel::SixPoint] {
        let a = surface_radius(kernel, true, x.view(), &triangles, 48).expect("a sphere in the box");
        let plain = surface_radius(kernel, false, x.view(), &triangles, 48).expect("a sphere in the box");
        println!("{kernel:?}: {a:.4}, without {plain:.4}");
        assert!((a / 4.0 - 1.0).abs() < 0.01, "{kernel:?}: {a}");
        assert!(plain / 4.0 > 1.05);
    }
}

#[test]
fn an_edge_sharper_than_the_depth_is_an_error() {
    let (x, triangles) = spheroid([5.0, 5.0, 0.3]);
    let error = placed(Kernel::SixPoint, &x, &triangles)
        .map(|_| ())
        .expect_err("a sharp rim");
    assert!(matches!(error, ExchangeError::Fold { body: 3, .. }), "{error}");
}
