//! Random numbers that depend on nothing but their place: seed, step and index.

use crate::Vec3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Words of a stream that belong to one index.
const WORDS: u128 = 16;

/// Normal numbers that are a function of (seed, step, index): the same for any order of use and any number of threads.
///
/// The step is the stream of ChaCha8 under the seed's key, the index the place in the stream; uniform numbers become normal ones
/// by Box and Muller (1958).
#[derive(Clone, Debug)]
pub struct Noise {
    step: ChaCha8Rng,
}

impl Noise {
    /// The numbers of one step.
    pub fn new(seed: u64, step: u64) -> Self {
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        generator.set_stream(step);
        Self { step: generator }
    }

    /// Three independent normal numbers, mean 0 and variance 1, of one index (a bead, a node, a bond).
    pub fn normal(&self, index: u64) -> Vec3 {
        let mut generator = self.step.clone();
        generator.set_word_pos(u128::from(index) * WORDS);
        let [x, y] = pair(&mut generator);
        let [z, _] = pair(&mut generator);
        Vec3::new(x, y, z)
    }

    /// Fills `to` with independent normal numbers of one index: those of number `index` of pieces of this length, of which a step
    /// has one after the other.
    pub fn fill(&self, index: u64, to: &mut [f64]) {
        let mut generator = self.step.clone();
        let words = 4 * to.len().div_ceil(2) as u128;
        generator.set_word_pos(u128::from(index) * words);
        for two in to.chunks_mut(2) {
            let pair = pair(&mut generator);
            two.copy_from_slice(&pair[..two.len()]);
        }
    }
}

/// Two independent normal numbers, of four words of the stream.
fn pair(generator: &mut ChaCha8Rng) -> [f64; 2] {
    // In (0, 1]: 53 bits.
    let mut uniform = || ((generator.next_u64() >> 11) as f64 + 1.0) / (1u64 << 53) as f64;
    let (radius, angle) = ((-2.0 * uniform().ln()).sqrt(), std::f64::consts::TAU * uniform());
    [radius * angle.cos(), radius * angle.sin()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_normal_and_independent_and_depend_on_their_place_alone() {
        let n = 20_000u64;
        let draw = |seed: u64, step: u64, index: u64| Noise::new(seed, step).normal(index);
        let (mut sum, mut square, mut fourth, mut next) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros(), 0.0);
        let first = Noise::new(3, 8);
        for i in 0..n {
            let v = first.normal(i);
            sum += v;
            square += v.component_mul(&v);
            fourth += v.map(|c| c.powi(4));
            next += v.dot(&first.normal(i + 1)) / 3.0 + v.dot(&draw(3, 9, i)) + v.x * v.y;
        }
        let n = n as f64;
        assert!((sum / n).amax() < 4.0 / n.sqrt());
        assert!(square.map(|s| (s / n - 1.0).abs()).amax() < 4.0 * (2.0 / n).sqrt());
        assert!(fourth.map(|s| (s / n - 3.0).abs()).amax() < 4.0 * (96.0 / n).sqrt());
        // Variances 1/3, 3 and 1.
        assert!((next / n).abs() < 4.0 * (4.4 / n).sqrt());
        assert_eq!(draw(3, 8, 17), first.normal(17));
        assert_ne!(draw(4, 8, 17), first.normal(17));
    }

    #[test]
    fn pieces_of_a_step_follow_each_other() {
        let noise = Noise::new(5, 2);
        let mut all = [0.0; 18];
        noise.fill(0, &mut all);
        let mut piece = [0.0; 6];
        for index in 0..3 {
            noise.fill(index as u64, &mut piece);
            assert_eq!(piece, all[6 * index..][..6]);
        }
        let mut odd = [0.0; 5];
        noise.fill(0, &mut odd);
        assert_eq!(odd, all[..5]);
    }
}
