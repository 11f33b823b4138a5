//! The collisions of the scan.

use super::{Limit, Linear, limit};
use lbm_ibm::lbm::models::{CentralMoments, Mrt, MrtRates, RecursiveRegularised, Regularised, TwoRates};
use lbm_ibm::lbm::{D2Q9, D3Q19, D3Q27, Model, OddRate};

/// Relaxation times of the reference file.
pub const TAUS: [f64; 12] = [0.5005, 0.501, 0.505, 0.51, 0.52, 0.55, 0.6, 0.7, 0.8, 1.0, 1.5, 2.0];

/// What is asked of a collision at a relaxation time.
trait Ask<R> {
    fn of<M: Model<Q>, const Q: usize>(&self, model: &M) -> R;
}

/// A collision by its name, which the reference file uses as well.
pub struct Case {
    /// Its name.
    pub name: &'static str,
    kind: Kind,
}

#[derive(Clone, Copy)]
enum Kind {
    Bgk19,
    Trt19(f64),
    Regularised19,
    Mrt1,
    Mrt,
    Recursive19,
    Central19,
    Bgk27,
    Trt27,
    Recursive27,
    Central27,
    Central27Magic,
    Bgk9,
    Trt9,
    Recursive9,
    Central9,
}

const fn case(name: &'static str, kind: Kind) -> Case {
    Case { name, kind }
}

/// All of them; those of the reference file first, on D3Q19.
pub const CASES: &[Case] = &[
    case("BGK", Kind::Bgk19),
    case("TRT316", Kind::Trt19(3.0 / 16.0)),
    case("TRT14", Kind::Trt19(0.25)),
    case("REG", Kind::Regularised19),
    case("MRT1", Kind::Mrt1),
    case("MRT", Kind::Mrt),
    case("RR", Kind::Recursive19),
    case("CM", Kind::Central19),
    case("BGK27", Kind::Bgk27),
    case("TRT27", Kind::Trt27),
    case("RR27", Kind::Recursive27),
    case("CM27", Kind::Central27),
    case("CM27_316", Kind::Central27Magic),
    case("BGK9", Kind::Bgk9),
    case("TRT9", Kind::Trt9),
    case("RR9", Kind::Recursive9),
    case("CM9", Kind::Central9),
];

impl Case {
    /// The case of a name.
    pub fn named(name: &str) -> Option<&'static Self> {
        CASES.iter().find(|c| c.name == name)
    }

    /// The collision about a velocity, lattice units.
    pub fn about(&self, tau: f64, u: [f64; 3]) -> Linear {
        struct About([f64; 3]);
        impl Ask<Linear> for About {
            fn of<M: Model<Q>, const Q: usize>(&self, model: &M) -> Linear {
                Linear::new(model, self.0)
            }
        }
        self.ask(tau, &About(u))
    }

    /// The same with the equilibrium of the reference file: [`Linear::compressible`].
    pub fn compressible_about(&self, tau: f64, u: [f64; 3]) -> Linear {
        struct About([f64; 3]);
        impl Ask<Linear> for About {
            fn of<M: Model<Q>, const Q: usize>(&self, model: &M) -> Linear {
                Linear::compressible(model, self.0)
            }
        }
        self.ask(tau, &About(u))
    }

    /// Greatest stable velocity along a direction of [`super::FLOWS`].
    pub fn limit(&self, tau: f64, flow: usize) -> Limit {
        limit(|u| self.about(tau, u), flow)
    }

    /// The same with the equilibrium of the reference file.
    pub fn compressible_limit(&self, tau: f64, flow: usize) -> Limit {
        limit(|u| self.compressible_about(tau, u), flow)
    }

    fn ask<R>(&self, tau: f64, ask: &impl Ask<R>) -> R {
        let rate = 1.0 / tau;
        let odd = |magic: f64| OddRate::Magic(magic).rate(tau);
        match self.kind {
            Kind::Bgk19 => ask.of(&TwoRates::<D3Q19>::new(rate, rate, true)),
            Kind::Trt19(magic) => ask.of(&TwoRates::<D3Q19>::new(rate, odd(magic), true)),
            Kind::Regularised19 => ask.of(&Regularised::<D3Q19>::new(tau, true)),
            // The file's moments are orthogonal under the weights: with the trace and all above the stress at rate 1 that is this.
            Kind::Mrt1 => ask.of(&Regularised::<D3Q19>::new(tau, true).with_bulk(1.0)),
            Kind::Mrt => {
                let odd = odd(3.0 / 16.0);
                let rates = MrtRates {
                    shear: rate,
                    bulk: 1.19,
                    energy_square: 1.4,
                    stress_square: 1.4,
                    flux: odd,
                    third: odd,
                };
                ask.of(&Mrt::new(rates, true))
            }
            Kind::Recursive19 => ask.of(&RecursiveRegularised::<D3Q19>::new(tau, true)),
            Kind::Central19 => ask.of(&CentralMoments::<D3Q19>::new(tau, 1.0, 1.0, true)),
            Kind::Bgk27 => ask.of(&TwoRates::<D3Q27>::new(rate, rate, true)),
            Kind::Trt27 => ask.of(&TwoRates::<D3Q27>::new(rate, odd(3.0 / 16.0), true)),
            Kind::Recursive27 => ask.of(&RecursiveRegularised::<D3Q27>::new(tau, true)),
            Kind::Central27 => ask.of(&CentralMoments::<D3Q27>::new(tau, 1.0, 1.0, true)),
            Kind::Central27Magic => ask.of(&CentralMoments::<D3Q27>::new(tau, 1.0, odd(3.0 / 16.0), true)),
            Kind::Bgk9 => ask.of(&TwoRates::<D2Q9>::new(rate, rate, true)),
            Kind::Trt9 => ask.of(&TwoRates::<D2Q9>::new(rate, odd(3.0 / 16.0), true)),
            Kind::Recursive9 => ask.of(&RecursiveRegularised::<D2Q9>::new(tau, true)),
            Kind::Central9 => ask.of(&CentralMoments::<D2Q9>::new(tau, 1.0, 1.0, true)),
        }
    }
}
