use super::*;
use crate::stokes::PeriodicStokes;
use crate::{DeltaExchange, Kernel, Markers};
use approx::assert_relative_eq;
use lbm_ibm_coupling::{BodyInfo, Bricks, Exchange, Soa3Mut};

/// Springs along the edges of a mesh.
struct Net {
    x: Soa3,
    triangles: Vec<[u32; 3]>,
    links: Vec<(usize, usize, f64)>,
    stiffness: f64,
    motion: Motion,
}

impl Net {
    fn new(x: Soa3, triangles: Vec<[u32; 3]>, pairs: &[(usize, usize)], motion: Motion) -> Self {
        let links = pairs
            .iter()
            .map(|&(i, j)| (i, j, (x.get(i) - x.get(j)).norm()))
            .collect();
        Self {
            x,
            triangles,
            links,
            stiffness: 3.0,
            motion,
        }
    }

    /// A square sheet of `n * n` nodes `edge` apart.
    fn sheet(n: usize, edge: f64) -> Self {
        let corner = Vec3::new(6.2, 6.4, 11.7);
        let x = (0..n * n)
            .map(|i| corner + edge * Vec3::new((i % n) as f64, (i / n) as f64, 0.0))
            .collect();
        let (mut triangles, mut pairs) = (Vec::new(), Vec::new());
        for i in (0..n * (n - 1)).filter(|i| (i + 1) % n != 0) {
            let [a, b, c, d] = [i, i + 1, i + n, i + n + 1].map(|i| i as u32);
            triangles.extend([[a, b, d], [a, d, c]]);
            pairs.extend([(i, i + 1), (i, i + n), (i, i + n + 1)]);
        }
        Self::new(x, triangles, &pairs, Motion::Advected)
    }
}

impl ImmersedBody for Net {
    fn kind(&self) -> &str {
        "net"
    }
    fn reference(&self) -> Soa3Ref<'_> {
        self.x.view()
    }
    fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    fn motion(&self) -> Motion {
        self.motion
    }
    fn add_internal_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for &(i, j, length) in &self.links {
            let d = x.get(j) - x.get(i);
            let f = d * (self.stiffness * (1.0 - length / d.norm()));
            force.add(i, f);
            force.add(j, -f);
        }
    }
}

fn pair(distance: f64, motion: Motion) -> Net {
    let x = [Vec3::zeros(), Vec3::new(0.6, 0.0, 0.8) * distance]
        .into_iter()
        .collect();
    Net::new(x, Vec::new(), &[(0, 1)], motion)
}

#[test]
fn two_nodes_and_a_spring() {
    let (a, mu, r) = (0.5, 2.0, 1.7);
    let mut body = pair(r, Motion::Advected);
    let x = body.x.clone();
    let rate = largest_rate(&mut body, x.view(), 1e-5, |f| rpy(x.view(), f, a, mu)).expect("a stiff body");
    // Relative motion along the line of centres.
    let mobility = (1.0 - 1.5 * a / r + (a / r).powi(3)) / (6.0 * PI * mu * a);
    assert_relative_eq!(rate, 2.0 * body.stiffness * mobility, max_relative = 1e-6);
    let dt = stable_step(&mut body, x.view(), a, mu, 1e-5).expect("a stiff body");
    assert_relative_eq!(dt, CARRIED * 2.0 / rate, max_relative = 1e-6);
}

#[test]
fn other_motions() {
    let (m, xi, r) = (0.3, 0.7, 1.0);
    let mut body = pair(r, Motion::Overdamped { friction: xi });
    let x = body.x.clone();
    let k = 2.0 * body.stiffness;
    let dt = stable_step(&mut body, x.view(), 0.1, 1.0, 1e-5).expect("a stiff body");
    assert_relative_eq!(dt, SAFETY * 2.0 * xi / k, max_relative = 1e-6);
    body.motion = Motion::Newton {
        node_mass: m,
        friction: xi,
    };
    let dt = stable_step(&mut body, x.view(), 0.1, 1.0, 1e-5).expect("a stiff body") / SAFETY;
    assert_relative_eq!(k * dt * dt + 2.0 * xi * dt, 4.0 * m, max_relative = 1e-6);
    body.stiffness = 0.0;
    let dt = stable_step(&mut body, x.view(), 0.1, 1.0, 1e-5).expect("friction alone") / SAFETY;
    assert_relative_eq!(dt, 2.0 * m / xi, max_relative = 1e-12);
    body.motion = Motion::Frozen;
    assert_eq!(stable_step(&mut body, x.view(), 0.1, 1.0, 1e-5), None);
}

#[test]
fn a_stiff_body_has_a_limit_in_proportion() {
    let mut sheet = Net::sheet(6, 1.0);
    let x = sheet.x.clone();
    let limit = stable_step(&mut sheet, x.view(), 0.6, 1.0, 1e-5).expect("a stiff body");
    sheet.stiffness *= 1e16;
    let stiff = stable_step(&mut sheet, x.view(), 0.6, 1.0, 1e-5).expect("a stiffer body");
    assert_relative_eq!(1e16 * stiff, limit, max_relative = 1e-6);
}

/// How much a small disturbance has grown after explicit steps.
fn growth(body: &mut Net, dt: f64, a: f64, mu: f64) -> f64 {
    let rest = body.x.clone();
    let mut x: Soa3 = (0..rest.len())
        .map(|i| rest.get(i) + Vec3::new((7.0 * i as f64).sin(), (5.0 * i as f64).cos(), 0.0) * 1e-7)
        .collect();
    let away = |x: &Soa3| {
        (0..x.len())
            .map(|i| (x.get(i) - rest.get(i)).norm())
            .fold(0.0, f64::max)
    };
    let before = away(&x);
    let zero = Soa3::zeros(x.len());
    for _ in 0..400 {
        let mut f = Soa3::zeros(x.len());
        body.add_internal_forces(x.view(), zero.view(), &mut f.view_mut());
        let u = rpy(x.view(), &f, a, mu);
        (0..x.len()).for_each(|i| x.add(i, u.get(i) * dt));
        if away(&x) > 1e3 * before {
            break;
        }
    }
    away(&x) / before
}

#[test]
fn explicit_steps_grow_above_the_limit_alone() {
    let (a, mu) = (0.6, 1.0);
    let mut sheet = Net::sheet(6, 1.0);
    let x = sheet.x.clone();
    let limit = stable_step(&mut sheet, x.view(), a, mu, 1e-5).expect("a stiff body") / CARRIED;
    assert!(growth(&mut sheet, 0.97 * limit, a, mu) < 2.0);
    assert!(growth(&mut sheet, 1.05 * limit, a, mu) > 100.0);
}

#[test]
fn the_estimate_holds_for_markers_on_a_grid() {
    let (n, mu) = (24, 1.3);
    let stokes = PeriodicStokes::new(n, 1.0, mu);
    for (kernel, edge) in [
        (Kernel::TwoPoint, 0.8),
        (Kernel::RomaThree, 2.5),
        (Kernel::PeskinFour, 1.5),
    ] {
        let mut sheet = Net::sheet(5, edge);
        let x = sheet.x.clone();
        let body = BodyInfo {
            id: 0,
            kind: "sheet".into(),
            range: 0..x.len(),
            triangles: sheet.triangles.clone().into(),
            motion: Motion::Advected,
        };
        let mut bricks = Bricks::new(stokes.grid());
        let mut exchange = DeltaExchange::new(kernel).with_markers(Markers::default());
        exchange
            .set_bodies(&[body], x.view(), stokes.grid())
            .expect("a grid wide enough");
        exchange.place(x.view(), &mut bricks).expect("markers in the grid");
        let rate = largest_rate(&mut sheet, x.view(), 1e-5, |f| {
            bricks.clear_force();
            exchange.spread(f.view(), &mut bricks);
            let field = stokes.respond(&bricks);
            stokes.fill(&field, &mut bricks);
            let mut u = Soa3::zeros(f.len());
            exchange.interpolate(&bricks, u.view_mut());
            u
        });
        let estimate = exchange
            .stable_step(&mut sheet, x.view(), mu, 1e6)
            .expect("a stiff body");
        let ratio = estimate * rate.expect("a stiff body") / 2.0;
        println!("{kernel:?}, edge {edge}: estimate over true limit {ratio:.3}");
        assert!((0.4..0.67).contains(&ratio), "{kernel:?}, edge {edge}: {ratio}");
    }
}
