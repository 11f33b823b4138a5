//! A wall rule of a third party, by the public interface alone.

use lbm_ibm_coupling::{Bricks, Closure, Grid, Lattice, Plane, Union, Vec3};
use lbm_ibm_lbm::{Collision, CutLink, Drive, Fluid, LinkRule, Pace, Shares, WallRule};
use std::sync::Arc;

const SPACING: f64 = 1e-6;
const FORCE: f64 = 10.0;
const VISCOSITY: f64 = 1e-3;

/// The unified interpolation of Yu, Mei and Shyy (2003): what arrives at the wall and what comes from there are both found by
/// a straight line, `f_i(x) = ((1 - q) f*_o(y) + q f*_o(x) + q f*_i(x))/(1 + q)`.
#[derive(Debug)]
struct Unified;

impl LinkRule for Unified {
    fn shares(&self, link: &CutLink) -> Option<Shares> {
        let q = link.fraction;
        link.behind.then_some(Shares {
            arriving: (1.0 - q) / (1.0 + q),
            leaving: q / (1.0 + q),
            push: 1.0 / (1.0 + q),
        })
    }
}

/// Walls a cell's half from the nodes, wherever they are: by the shares, and by the simple path.
#[derive(Debug)]
struct Half {
    asks: bool,
}

impl LinkRule for Half {
    fn shares(&self, _link: &CutLink) -> Option<Shares> {
        Some(Shares::HALFWAY)
    }

    fn interpolates(&self) -> bool {
        self.asks
    }
}

/// Steady flow between plates a fraction `q` of a link from the outermost of `n` nodes, and another one that slides along with
/// `slide` (m/s) on the far side; the velocities between them, m/s.
fn plates(rule: impl LinkRule + 'static, n: usize, q: f64, force: f64, slide: f64) -> Vec<f64> {
    let (low, height) = ((2.5 - q) * SPACING, (n as f64 - 1.0 + 2.0 * q) * SPACING);
    let far = Plane::new(Vec3::y() * (low + height), -Vec3::y()).with_velocity(Vec3::z() * slide);
    let walls = Union::new().with(Plane::new(Vec3::y() * low, Vec3::y())).with(far);
    let grid = Grid::new([1, n + 4, 2], SPACING, [true; 3]);
    let bricks = Bricks::new(&grid);
    let mut fluid = Fluid::new(grid, 1e3, VISCOSITY, Pace::Tau(1.0))
        .unwrap()
        .with_collision(Collision::default())
        .unwrap()
        .with_wall_rule(rule)
        .with_drive(Drive::Force(Vec3::z() * force))
        .unwrap();
    fluid.set_walls(Some(Arc::new(walls)), 0.0).unwrap();
    for _ in 0..60 * n * n {
        fluid.advance(&bricks).unwrap();
    }
    let velocity = &fluid.macroscopic().unwrap().velocity[2];
    (0..n).map(|i| velocity[i + 2]).collect()
}

/// The user's rule has a linear shear exactly, wherever the wall is, and the parabola to second order.
#[test]
fn a_rule_of_ones_own_finds_the_wall() {
    for q in [0.15, 0.5, 0.85] {
        let (n, slide) = (8, 1e-3);
        let height = n as f64 - 1.0 + 2.0 * q;
        for (i, u) in plates(Unified, n, q, 0.0, slide).iter().enumerate() {
            let exact = slide * (i as f64 + q) / height;
            assert!((u - exact).abs() < 1e-8 * slide, "q {q}: {u} {exact}");
        }
        let off = |n: usize| {
            let height = n as f64 - 1.0 + 2.0 * q;
            let unit = FORCE * (height * SPACING).powi(2) / (8.0 * VISCOSITY);
            let all = plates(Unified, n, q, FORCE, 0.0);
            let errors = all.iter().enumerate().map(|(i, u)| {
                let y = (i as f64 + q) / height;
                (u / unit - 4.0 * y * (1.0 - y)).abs()
            });
            errors.fold(0.0, f64::max)
        };
        let order = (off(8) / off(16)).log2() / (16.0_f64 / 8.0).log2();
        assert!(order > 1.7, "q {q}: {order}");
    }
}

/// A link whose shares are halfway's is halfway's, to the last bit, and so is CLI on flat walls half way between nodes.
#[test]
fn a_rule_that_is_halfway_gives_halfway() {
    let bits = |u: Vec<f64>| u.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    let halfway = bits(plates(WallRule::Halfway, 6, 0.3, FORCE, 1e-3));
    assert_eq!(bits(plates(Half { asks: false }, 6, 0.3, FORCE, 1e-3)), halfway);
    let halfway = bits(plates(WallRule::Halfway, 6, 0.5, FORCE, 0.0));
    assert_eq!(bits(plates(Half { asks: true }, 6, 0.5, FORCE, 0.0)), halfway);
    assert_eq!(bits(plates(WallRule::default(), 6, 0.5, FORCE, 0.0)), halfway);
}

/// What a rule is told: fractions of the links, weights that go with the velocities, the relaxation time.
#[test]
fn a_rule_is_told_about_the_link() {
    #[derive(Debug)]
    struct Asks;
    impl LinkRule for Asks {
        fn shares(&self, link: &CutLink) -> Option<Shares> {
            assert!((0.0..=1.0).contains(&link.fraction) && link.tau == 0.9);
            let squares: i32 = link.velocity.iter().map(|c| c * c).sum();
            assert!((link.weight - [1.0 / 18.0, 1.0 / 36.0][squares as usize - 1]).abs() < 1e-15);
            None
        }
    }
    let grid = Grid::new([12; 3], SPACING, [true; 3]);
    let mut fluid = Fluid::new(grid, 1e3, VISCOSITY, Pace::Tau(0.9))
        .unwrap()
        .with_wall_rule(Asks);
    let ball = Closure::new(
        |x: Vec3| (x - Vec3::repeat(6.1) * SPACING).norm() - 3.3 * SPACING,
        1e-10,
    );
    let report = fluid.set_walls(Some(Arc::new(ball)), 0.0).unwrap();
    assert!(report.wall_links > 100 && report.uninterpolated_links == report.wall_links);
}
