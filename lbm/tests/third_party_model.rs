//! What a third party writes to bring a collision, and lattice velocities, of its own: this file is a crate of its own and sees
//! only what is public.

use lbm_ibm_coupling::{Bricks, Grid, Lattice, Vec3};
use lbm_ibm_lbm::models::CentralMoments;
use lbm_ibm_lbm::{D3Q19, Drive, Fluid, InstructionSet, Model, Pace, Precision, Real, Stencil};
use std::f64::consts::TAU;

/// Fifteen velocities: rest, along the axes and to the corners.
#[derive(Clone)]
struct D3Q15;

impl Stencil<15> for D3Q15 {
    const C: [[i32; 3]; 15] = [
        [0, 0, 0],
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
        [1, 1, 1],
        [-1, -1, -1],
        [1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [-1, 1, -1],
        [1, -1, -1],
        [-1, 1, 1],
    ];
    const W: [f64; 15] = {
        let mut w = [1.0 / 72.0; 15];
        w[0] = 2.0 / 9.0;
        let mut i = 1;
        while i < 7 {
            w[i] = 1.0 / 9.0;
            i += 1;
        }
        w
    };
}

/// BGK on any velocities, written as in a textbook; nothing of it is known to the library.
#[derive(Clone)]
struct Textbook<S> {
    rate: f64,
    velocities: std::marker::PhantomData<S>,
}

impl<S> Textbook<S> {
    fn new(tau: f64) -> Self {
        Self {
            rate: 1.0 / tau,
            velocities: std::marker::PhantomData,
        }
    }
}

impl<S: Stencil<Q> + Clone + Send + Sync, const Q: usize> Model<Q> for Textbook<S> {
    type Stencil = S;

    #[inline(always)]
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; Q], force: [V; 3]) -> [V; 3] {
        let zero = f[0].like(0.0);
        let dot = |i: usize, v: &[V; 3]| {
            (0..3).fold(zero, |sum, a| match S::C[i][a] {
                1 => sum + v[a],
                -1 => sum - v[a],
                _ => sum,
            })
        };
        let (mut density, mut momentum) = (zero, [zero; 3]);
        for i in 0..Q {
            density = density + f[i];
            for a in 0..3 {
                momentum[a] = momentum[a] + f[i] * zero.like(f64::from(S::C[i][a]));
            }
        }
        let half = zero.like(0.5);
        let u: [V; 3] = std::array::from_fn(|a| {
            if FORCE {
                momentum[a] + force[a] * half
            } else {
                momentum[a]
            }
        });
        let product = |a: &[V; 3], b: &[V; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let [three, nine_halves, three_halves, nine] = [3.0, 4.5, 1.5, 9.0].map(|v| zero.like(v));
        for i in 0..Q {
            let (cu, w) = (dot(i, &u), zero.like(S::W[i]));
            let target = w * (density + three * cu + nine_halves * cu * cu - three_halves * product(&u, &u));
            f[i] = f[i] + zero.like(self.rate) * (target - f[i]);
            if FORCE {
                let cf = dot(i, &force);
                let source = w * (three * cf + nine * cu * cf - three * product(&u, &force));
                f[i] = f[i] + zero.like(1.0 - 0.5 * self.rate) * source;
            }
        }
        momentum
    }
}

fn water(shape: [usize; 3], periodic: [bool; 3], tau: f64) -> Fluid {
    Fluid::new(Grid::new(shape, 1e-6, periodic), 1e3, 1e-3, Pace::Tau(tau)).expect("a fluid")
}

/// Flow between plates: BGK's profile with its known slip, on velocities that the library has never seen.
#[test]
fn a_collision_and_velocities_of_ones_own_flow_between_plates() {
    let (n, tau) = (8, 0.9);
    for precision in [Precision::F64, Precision::F32] {
        let mut fluid = water([4, n, 4], [true, false, true], tau)
            .with_model(Textbook::<D3Q15>::new(tau))
            .expect("a fluid")
            .with_precision(precision)
            .with_drive(Drive::Force(Vec3::x() * 1e4))
            .expect("driven");
        let bricks = Bricks::new(fluid.grid());
        (0..6000).for_each(|_| fluid.advance(&bricks).expect("a step"));
        assert!(fluid.collision().is_none() && fluid.wall_slip().is_none() && fluid.velocity_set().is_none());
        let unit = 1e4 * 1e-12 / (2.0 * 1e-3);
        let slip = (16.0 * (tau - 0.5_f64).powi(2) - 3.0) / 12.0;
        let velocity = fluid.macroscopic().expect("fields").velocity;
        let gate = if precision == Precision::F64 { 1e-9 } else { 1e-4 };
        for j in 0..n {
            let y = j as f64 + 0.5;
            let (found, exact) = (velocity[0][4 * j] / unit, y * (n as f64 - y) + slip);
            assert!(
                (found / exact - 1.0).abs() < gate,
                "{precision:?}, node {j}: {found} {exact}"
            );
        }
    }
}

/// The same bits as the built-in one would have is too much to ask, the same flow is not.
#[test]
fn a_collision_of_ones_own_is_as_good_as_the_built_in_one() {
    let tau = 0.7;
    let swirl = |x: Vec3| {
        let [a, b] = [x.x, x.y].map(|v| TAU * v / 12e-6);
        Vec3::new(a.cos() * b.sin(), -a.sin() * b.cos(), 0.3 * a.sin()) * 5e-2
    };
    let run = |fluid: Fluid| {
        let mut fluid = fluid
            .with_drive(Drive::Force(Vec3::new(3e6, 0.0, 1e6)))
            .expect("driven");
        fluid.set_velocity(swirl);
        let bricks = Bricks::new(fluid.grid());
        (0..60).for_each(|_| fluid.advance(&bricks).expect("a step"));
        fluid.macroscopic().expect("fields").velocity
    };
    let built_in = run(water([12, 12, 5], [true, true, false], tau)
        .with_collision(lbm_ibm_lbm::Collision::Bgk)
        .expect("BGK"));
    for isa in [InstructionSet::Portable, InstructionSet::best()] {
        let own = water([12, 12, 5], [true, true, false], tau)
            .with_instruction_set(isa)
            .and_then(|f| f.with_model(Textbook::<D3Q19>::new(tau)))
            .expect("a fluid");
        let own = run(own);
        for (a, b) in own.iter().flatten().zip(built_in.iter().flatten()) {
            assert!((a - b).abs() < 1e-13, "{isa:?}: {a} {b}");
        }
    }
}

/// The library's own models can be had with rates that `Collision` does not offer.
#[test]
fn a_model_of_the_library_with_other_rates() {
    let tau = 0.8;
    let mut fluid = water([6, 6, 6], [true; 3], tau)
        .with_model(CentralMoments::<D3Q19>::new(tau, 1.3, 0.9, true))
        .expect("a fluid");
    fluid.set_velocity(|x| Vec3::z() * 1e-2 * (TAU * x.x / 6e-6).sin());
    let bricks = Bricks::new(fluid.grid());
    let top = |fluid: &Fluid| {
        fluid.macroscopic().expect("fields").velocity[2]
            .iter()
            .fold(0.0_f64, |m, v| m.max(*v))
    };
    let before = top(&fluid);
    (0..40).for_each(|_| fluid.advance(&bricks).expect("a step"));
    let decay = (before / top(&fluid)).ln() / 40.0;
    let exact = fluid.lattice_viscosity() * (TAU / 6.0).powi(2);
    assert!((decay / exact - 1.0).abs() < 0.06, "{decay} {exact}");
}
