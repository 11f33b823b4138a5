//! Collision models other than the default one, each for any of the stencils that it can do, written once for every
//! instruction set and precision.

mod basis;
mod central;
mod low;
mod mrt;
mod regularised;
mod shift;
#[cfg(test)]
mod tests;
mod two_rates;

pub use basis::Basis;
pub use central::CentralMoments;
pub use mrt::{Mrt, MrtRates};
pub use regularised::{RecursiveRegularised, Regularised, StressAlone};
pub use two_rates::TwoRates;
