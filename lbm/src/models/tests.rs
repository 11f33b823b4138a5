//! What every collision has to keep.

use super::*;
use crate::model::Model;
use crate::stencil::{D2Q9, D3Q19, D3Q27, Stencil, moments};

/// Numbers in -1 to 1, the same in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn node<const Q: usize>(&mut self) -> [f64; Q] {
        std::array::from_fn(|_| 0.02 * self.roll())
    }

    /// A force that the stencil can take.
    fn force<S: Stencil<Q>, const Q: usize>(&mut self) -> [f64; 3] {
        std::array::from_fn(|a| 0.01 * self.roll() * if moves::<S, Q>(a) { 1.0 } else { 0.0 })
    }
}

fn moves<S: Stencil<Q>, const Q: usize>(axis: usize) -> bool {
    S::C.iter().any(|c| c[axis] != 0)
}

fn dot(c: [i32; 3], v: [f64; 3]) -> f64 {
    (0..3).map(|a| f64::from(c[a]) * v[a]).sum()
}

/// Second-order equilibrium, and what a force adds to it in a step (Guo), of population `i`.
fn second_order<S: Stencil<Q>, const Q: usize>(i: usize, density: f64, u: [f64; 3], force: [f64; 3]) -> [f64; 2] {
    let (cu, cf) = (dot(S::C[i], u), dot(S::C[i], force));
    let product = |a: [f64; 3], b: [f64; 3]| (0..3).map(|n| a[n] * b[n]).sum::<f64>();
    [
        S::W[i] * (density + 3.0 * cu + 4.5 * cu * cu - 1.5 * product(u, u)),
        S::W[i] * (3.0 * cf + 9.0 * cu * cf - 3.0 * product(u, force)),
    ]
}

/// All collisions by name, each on all of its stencils.
macro_rules! for_every_model {
    ($check:ident($tau:expr $(, $more:expr)*)) => {{
        let tau: f64 = $tau;
        let (w, magic) = (1.0 / tau, 1.0 / (0.5 + 3.0 / 16.0 / (tau - 0.5)));
        let mrt = MrtRates { bulk: 1.19, energy_square: 1.4, stress_square: 1.4, flux: magic, third: 1.3, shear: w };
        $check("trt9", &TwoRates::<D2Q9>::new(w, magic, true) $(, $more)*);
        $check("trt19", &TwoRates::<D3Q19>::new(w, magic, true) $(, $more)*);
        $check("trt27", &TwoRates::<D3Q27>::new(w, magic, true) $(, $more)*);
        $check("mrt", &Mrt::new(mrt, true) $(, $more)*);
        $check("regularised9", &Regularised::<D2Q9>::new(tau, true) $(, $more)*);
        $check("regularised19", &Regularised::<D3Q19>::new(tau, true) $(, $more)*);
        $check("regularised27", &Regularised::<D3Q27>::new(tau, true) $(, $more)*);
        $check("recursive9", &RecursiveRegularised::<D2Q9>::new(tau, true) $(, $more)*);
        $check("recursive19", &RecursiveRegularised::<D3Q19>::new(tau, true) $(, $more)*);
        $check("recursive27", &RecursiveRegularised::<D3Q27>::new(tau, true) $(, $more)*);
        $check("central9", &CentralMoments::<D2Q9>::new(tau, 1.1, magic, true) $(, $more)*);
        $check("central19", &CentralMoments::<D3Q19>::new(tau, 1.1, magic, true) $(, $more)*);
        $check("central27", &CentralMoments::<D3Q27>::new(tau, 1.1, magic, true) $(, $more)*);
    }};
}

#[test]
fn mass_is_kept_and_momentum_gains_the_force() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M) {
        let mut dice = Dice(1);
        for _ in 0..20 {
            let (before, force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
            for with in [false, true] {
                let mut f = before;
                let told = if with {
                    model.collide::<f64, true>(&mut f, force)
                } else {
                    model.collide::<f64, false>(&mut f, force)
                };
                let (density, momentum) = moments::<M::Stencil, f64, Q>(&before);
                let (density_after, after) = moments::<M::Stencil, f64, Q>(&f);
                assert!(
                    (density - density_after).abs() < 1e-15,
                    "{name}: {density} {density_after}"
                );
                for a in 0..3 {
                    assert!((told[a] - momentum[a]).abs() < 1e-15, "{name}");
                    let gain = if with { force[a] } else { 0.0 };
                    assert!((after[a] - momentum[a] - gain).abs() < 1e-15, "{name}: axis {a}");
                }
            }
        }
    }
    for_every_model!(check(0.63));
}

/// The stress relaxes at the rate that gives the viscosity, to the second-order equilibrium, with Guo's source.
#[test]
fn shear_stress_relaxes_at_its_rate_with_the_source_of_guo() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M, rate: f64) {
        let mut dice = Dice(2);
        for _ in 0..20 {
            let (before, force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
            let mut f = before;
            model.collide::<f64, true>(&mut f, force);
            let (density, momentum) = moments::<M::Stencil, f64, Q>(&before);
            let u = std::array::from_fn(|a| momentum[a] + 0.5 * force[a]);
            let expected: [f64; Q] = std::array::from_fn(|i| {
                let [e, s] = second_order::<M::Stencil, Q>(i, density, u, force);
                before[i] + rate * (e - before[i]) + (1.0 - 0.5 * rate) * s
            });
            let c = M::Stencil::C;
            for [a, b] in [[0, 1], [0, 2], [1, 2]] {
                if !moves::<M::Stencil, Q>(b) {
                    continue;
                }
                let shear = |f: &[f64; Q]| (0..Q).map(|i| f[i] * f64::from(c[i][a] * c[i][b])).sum::<f64>();
                let normal = |f: &[f64; Q]| {
                    let part = |i: usize| f64::from(c[i][a] * c[i][a] - c[i][b] * c[i][b]);
                    (0..Q).map(|i| f[i] * part(i)).sum::<f64>()
                };
                assert!((shear(&f) - shear(&expected)).abs() < 1e-15, "{name}: {a}{b}");
                assert!((normal(&f) - normal(&expected)).abs() < 2e-15, "{name}: {a}{a}-{b}{b}");
            }
        }
    }
    for_every_model!(check(0.7, 1.0 / 0.7));
}

#[test]
fn equilibrium_is_left_alone() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M, at_once: &[&str]) {
        let mut dice = Dice(3);
        let u = dice.force::<M::Stencil, Q>().map(|v| 10.0 * v);
        let mut f: [f64; Q] = std::array::from_fn(|i| second_order::<M::Stencil, Q>(i, 0.01, u, [0.0; 3])[0]);
        if !at_once.iter().any(|n| name.starts_with(n)) {
            // Their equilibrium has higher orders; it is what a uniform flow comes to.
            for _ in 0..400 {
                model.collide::<f64, false>(&mut f, [0.0; 3]);
            }
            let high = |i: usize| second_order::<M::Stencil, Q>(i, 0.01, u, [0.0; 3])[0];
            assert!((0..Q).all(|i| (f[i] - high(i)).abs() < 4.0 * 0.1_f64.powi(3)), "{name}");
        }
        let mut after = f;
        model.collide::<f64, false>(&mut after, [0.0; 3]);
        assert!((0..Q).all(|i| (f[i] - after[i]).abs() < 1e-15), "{name}");
    }
    for_every_model!(check(0.6, &["trt", "mrt", "regularised"]));
}

/// The populations after collision, turned, are those of the turned populations: all 48 symmetries of the cube.
#[test]
fn no_direction_is_preferred() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M) {
        let c = M::Stencil::C;
        let mut dice = Dice(4);
        let (before, force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
        let mut after = before;
        model.collide::<f64, true>(&mut after, force);
        for order in [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]] {
            for signs in 0..8 {
                let sign = |a: usize| 1 - 2 * (signs >> a & 1);
                let turn = |c: [i32; 3]| -> [i32; 3] { std::array::from_fn(|a| c[order[a]] * sign(a)) };
                let to: Option<Vec<usize>> = c.iter().map(|v| c.iter().position(|w| *w == turn(*v))).collect();
                let Some(to) = to else { continue };
                let mut turned = [0.0; Q];
                for i in 0..Q {
                    turned[to[i]] = before[i];
                }
                let force = std::array::from_fn(|a| force[order[a]] * f64::from(sign(a)));
                model.collide::<f64, true>(&mut turned, force);
                for i in 0..Q {
                    assert!(
                        (turned[to[i]] - after[i]).abs() < 1e-16,
                        "{name}: {order:?} {signs} {i}"
                    );
                }
            }
        }
    }
    for_every_model!(check(0.55));
}

#[test]
fn with_equal_rates_it_is_bgk() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M, rate: f64) {
        let mut dice = Dice(5);
        for _ in 0..10 {
            let (before, force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
            let (density, momentum) = moments::<M::Stencil, f64, Q>(&before);
            let u = std::array::from_fn(|a| momentum[a] + 0.5 * force[a]);
            let expected: [f64; Q] = std::array::from_fn(|i| {
                let [e, s] = second_order::<M::Stencil, Q>(i, density, u, force);
                before[i] + rate * (e - before[i]) + (1.0 - 0.5 * rate) * s
            });
            let mut f = before;
            model.collide::<f64, true>(&mut f, force);
            for i in 0..Q {
                assert!((f[i] - expected[i]).abs() < 1e-16, "{name}: {i}");
            }
        }
    }
    let w = 1.0 / 0.8;
    check("trt9", &TwoRates::<D2Q9>::new(w, w, true), w);
    check("trt19", &TwoRates::<D3Q19>::new(w, w, true), w);
    check("trt27", &TwoRates::<D3Q27>::new(w, w, true), w);
    check("mrt", &Mrt::new(MrtRates::equal(0.8), true), w);
    // With tau 1 all that these discard would vanish anyway.
    check("regularised9", &Regularised::<D2Q9>::new(1.0, true), 1.0);
    check("regularised19", &Regularised::<D3Q19>::new(1.0, true), 1.0);
    check("regularised27", &Regularised::<D3Q27>::new(1.0, true), 1.0);
}

/// At tau 1 the node becomes the Maxwellian, which on these stencils is a product of one for each axis, moved by the force.
#[test]
fn models_in_the_moving_frame_have_the_product_as_equilibrium() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M) {
        let mut dice = Dice(6);
        let (before, force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
        let (density, momentum) = moments::<M::Stencil, f64, Q>(&before);
        let u: [f64; 3] = std::array::from_fn(|a| momentum[a] + 0.5 * force[a]);
        let product = |i: usize, u: [f64; 3]| {
            let axis = |a: usize| match M::Stencil::C[i][a] {
                0 => 2.0 / 3.0 - u[a] * u[a],
                c => 0.5 * (1.0 / 3.0 + u[a] * u[a] + f64::from(c) * u[a]),
            };
            (0..3).filter(|a| moves::<M::Stencil, Q>(*a)).map(axis).product::<f64>()
        };
        let mut f = before;
        model.collide::<f64, true>(&mut f, force);
        for i in 0..Q {
            let w = M::Stencil::W[i];
            // Half of F . d/du by a difference: the product is of second order in each component.
            let source: f64 = (0..3)
                .map(|a| {
                    let moved = |by: f64| product(i, std::array::from_fn(|b| u[b] + if a == b { by } else { 0.0 }));
                    0.25 * force[a] * (moved(1.0) - moved(-1.0))
                })
                .sum();
            let expected = w * density + product(i, u) - w + source;
            assert!((f[i] - expected).abs() < 1e-15, "{name}: {i} {} {expected}", f[i]);
        }
    }
    check("central9", &CentralMoments::<D2Q9>::new(1.0, 1.0, 1.0, true));
    check("central27", &CentralMoments::<D3Q27>::new(1.0, 1.0, 1.0, true));
    check("recursive9", &RecursiveRegularised::<D2Q9>::new(1.0, true));
    check("recursive27", &RecursiveRegularised::<D3Q27>::new(1.0, true));
}

/// Central moments of third order, summed over the velocities, relax at their rate.
#[test]
fn third_order_relaxes_in_the_moving_frame() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M, rate: f64) {
        let mut dice = Dice(7);
        let (before, force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
        let (density, momentum) = moments::<M::Stencil, f64, Q>(&before);
        let u: [f64; 3] = std::array::from_fn(|a| momentum[a] + 0.5 * force[a]);
        let mut after = before;
        model.collide::<f64, true>(&mut after, force);
        // At unit density, without the part that stays at rest.
        let central = |f: &[f64; Q], axes: [usize; 3]| -> f64 {
            let one = |i: usize| {
                let w = M::Stencil::W[i];
                let relative = |a: usize| f64::from(M::Stencil::C[i][a]) - u[a];
                let cube: f64 = axes.iter().map(|a| relative(*a)).product();
                // Hermite: less 1/3 of the first order where an axis is there twice.
                let lower = if axes[1] == axes[2] {
                    relative(axes[0]) / 3.0
                } else {
                    0.0
                };
                (f[i] + w - w * density) * (cube - lower)
            };
            (0..Q).map(one).sum()
        };
        for axes in [
            [0, 1, 1],
            [0, 2, 2],
            [1, 0, 0],
            [1, 2, 2],
            [2, 0, 0],
            [2, 1, 1],
            [0, 1, 2],
        ] {
            let whole = Q == 27 || axes != [0, 1, 2];
            if !whole || axes.iter().any(|a| !moves::<M::Stencil, Q>(*a)) {
                continue;
            }
            let (old, new) = (central(&before, axes), central(&after, axes));
            assert!((new - (1.0 - rate) * old).abs() < 1e-15, "{name}: {axes:?} {old} {new}");
        }
    }
    check("central9", &CentralMoments::<D2Q9>::new(0.6, 1.2, 0.7, true), 0.7);
    check("central19", &CentralMoments::<D3Q19>::new(0.6, 1.2, 0.7, true), 0.7);
    check("central27", &CentralMoments::<D3Q27>::new(0.6, 1.2, 0.7, true), 0.7);
    check("recursive9", &RecursiveRegularised::<D2Q9>::new(0.6, true), 1.0);
    check("recursive19", &RecursiveRegularised::<D3Q19>::new(0.6, true), 1.0);
    check("recursive27", &RecursiveRegularised::<D3Q27>::new(0.6, true), 1.0);
}

/// Without inertia everything is linear.
#[test]
fn without_inertia_they_are_linear() {
    fn check<M: Model<Q>, const Q: usize>(name: &str, model: &M) {
        let mut dice = Dice(8);
        let (mut f, mut force) = (dice.node::<Q>(), dice.force::<M::Stencil, Q>());
        let mut twice = f.map(|v| 2.0 * v);
        model.collide::<f64, true>(&mut f, force);
        force = force.map(|v| 2.0 * v);
        model.collide::<f64, true>(&mut twice, force);
        assert!((0..Q).all(|i| (twice[i] - 2.0 * f[i]).abs() < 1e-15), "{name}");
    }
    check("trt", &TwoRates::<D3Q27>::new(1.4, 0.7, false));
    check(
        "mrt",
        &Mrt::new(
            MrtRates {
                flux: 0.3,
                ..MrtRates::equal(0.7)
            },
            false,
        ),
    );
    check("regularised", &Regularised::<D3Q19>::new(0.7, false));
    check("recursive", &RecursiveRegularised::<D3Q27>::new(0.7, false));
    check("central", &CentralMoments::<D3Q27>::new(0.7, 1.0, 0.4, false));
}

/// Each moment of d'Humieres et al. (2002), by its polynomial, relaxes at its own rate.
#[test]
fn mrt_relaxes_each_moment_at_its_rate() {
    let rates = MrtRates {
        shear: 1.7,
        bulk: 1.1,
        energy_square: 1.3,
        stress_square: 0.9,
        flux: 0.4,
        third: 1.9,
    };
    type Polynomial = fn([f64; 3]) -> f64;
    fn n(c: [f64; 3]) -> f64 {
        c.iter().map(|v| v * v).sum()
    }
    let moments_of: [(f64, Polynomial); 11] = [
        (rates.bulk, |c| 19.0 * n(c) - 30.0),
        (rates.energy_square, |c| {
            (21.0 * n(c).powi(2) - 53.0 * n(c) + 24.0) / 2.0
        }),
        (rates.flux, |c| (5.0 * n(c) - 9.0) * c[1]),
        (rates.shear, |c| 3.0 * c[0] * c[0] - n(c)),
        (rates.shear, |c| c[1] * c[1] - c[2] * c[2]),
        (rates.shear, |c| c[0] * c[2]),
        (rates.stress_square, |c| (3.0 * n(c) - 5.0) * (3.0 * c[0] * c[0] - n(c))),
        (rates.stress_square, |c| {
            (3.0 * n(c) - 5.0) * (c[1] * c[1] - c[2] * c[2])
        }),
        (rates.third, |c| (c[1] * c[1] - c[2] * c[2]) * c[0]),
        (rates.third, |c| (c[2] * c[2] - c[0] * c[0]) * c[1]),
        (rates.third, |c| (c[0] * c[0] - c[1] * c[1]) * c[2]),
    ];
    let mut dice = Dice(9);
    let (before, force) = (dice.node::<19>(), dice.force::<D3Q19, 19>());
    let mut after = before;
    Mrt::new(rates, true).collide::<f64, true>(&mut after, force);
    let (density, momentum) = moments::<D3Q19, f64, 19>(&before);
    let u = std::array::from_fn(|a| momentum[a] + 0.5 * force[a]);
    for (number, (rate, polynomial)) in moments_of.into_iter().enumerate() {
        let moment =
            |f: &dyn Fn(usize) -> f64| -> f64 { (0..19).map(|i| f(i) * polynomial(D3Q19::C[i].map(f64::from))).sum() };
        let target = |n: usize| moment(&|i| second_order::<D3Q19, 19>(i, density, u, force)[n]);
        let old = moment(&|i| before[i]);
        let expected = old + rate * (target(0) - old) + (1.0 - 0.5 * rate) * target(1);
        assert!((moment(&|i| after[i]) - expected).abs() < 1e-13, "moment {number}");
    }
}
