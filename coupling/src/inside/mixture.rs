//! The viscosity of a node that is partly inside.

use super::LEVELS;
use std::f64::consts::PI;

/// Least viscosity of a node over the lower of the two.
const LEAST: f64 = 0.5;
/// Halvings of the interval in which the bend is.
const HALVINGS: usize = 40;

/// Viscosity over that around by the share inside, `1 + (l - 1)(s - b sin(2 pi s))`. Its mean over all shares is that of both viscosities whatever
/// the bend `b`, which makes the mean of its inverse that of their inverses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mixture {
    ratio: f64,
    bend: f64,
}

impl Mixture {
    /// For a viscosity inside of `ratio` times that around.
    pub fn new(ratio: f64) -> Self {
        let of = |bend: f64| Self { ratio, bend };
        let inverse = 0.5 * (1.0 + 1.0 / ratio);
        // The more it is bent, the greater the mean of the inverse.
        let (mut low, mut high) = (0.0, 0.5);
        for _ in 0..HALVINGS {
            let bend = 0.5 * (low + high);
            let it = of(bend);
            if it.least() > LEAST * ratio.min(1.0) && it.mean_inverse() < inverse {
                low = bend;
            } else {
                high = bend;
            }
        }
        of(low)
    }

    /// Viscosity over that around at a share of so many levels.
    pub fn ratio(&self, level: u16) -> f64 {
        let share = f64::from(level) / f64::from(LEVELS);
        let bent = if level == LEVELS {
            1.0
        } else {
            share - self.bend * (2.0 * PI * share).sin()
        };
        1.0 + (self.ratio - 1.0) * bent
    }

    fn least(&self) -> f64 {
        (0..=LEVELS)
            .map(|level| self.ratio(level))
            .fold(f64::INFINITY, f64::min)
    }

    /// Mean of the inverse over all shares.
    fn mean_inverse(&self) -> f64 {
        let ends = 0.5 * (1.0 + 1.0 / self.ratio);
        let between: f64 = (1..LEVELS).map(|level| 1.0 / self.ratio(level)).sum();
        (ends + between) / f64::from(LEVELS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_means_are_those_of_the_two_viscosities() {
        for ratio in [0.2, 0.5, 2.0, 5.0] {
            let it = Mixture::new(ratio);
            let mean: f64 = (0..LEVELS).map(|n| 0.5 * (it.ratio(n) + it.ratio(n + 1))).sum();
            assert!((mean / f64::from(LEVELS) - 0.5 * (1.0 + ratio)).abs() < 1e-12);
            let inverse = 0.5 * (1.0 + 1.0 / ratio);
            assert!((it.mean_inverse() / inverse - 1.0).abs() < 1e-9, "{ratio} {it:?}");
            assert_eq!((it.ratio(0), it.ratio(LEVELS)), (1.0, ratio));
        }
    }

    #[test]
    fn a_node_is_never_much_less_viscous_than_both() {
        for ratio in [0.05, 0.2, 5.0, 20.0, 100.0] {
            let it = Mixture::new(ratio);
            assert!(it.least() >= LEAST * ratio.min(1.0), "{ratio} {it:?}");
            // Half of what straight mixing errs by at the least.
            let exact = 0.5 * (1.0 + 1.0 / ratio);
            let straight = Mixture { ratio, bend: 0.0 };
            let gain = (exact - it.mean_inverse()) / (exact - straight.mean_inverse());
            assert!((-1e-6..0.7).contains(&gain), "{ratio}: {gain}");
        }
    }
}
