//! What is kept of interpolated links: the share of what arrives, and what a wall that swells would add.

use std::collections::HashMap;

/// So many different pairs are kept as they are, whatever their memory: a quarter of a megabyte.
const FEW: usize = 1 << 14;

/// Two numbers of each link, in the order of the links.
pub enum Terms {
    /// Each pair once, and of each link the number of its pair.
    Few { numbers: Vec<u16>, pairs: Vec<[f64; 2]> },
    /// Of each link both as multiples of units: the share to 2^-32 of the greatest one, under CLI as if the wall stood elsewhere by 5e-10
    /// of a link at most, the swelling to 2^-16.
    Many {
        shares: Vec<i32>,
        swells: Vec<i16>,
        units: [f64; 2],
    },
}

impl Default for Terms {
    fn default() -> Self {
        Self::new(&[])
    }
}

impl Terms {
    /// Keeps `pairs` in the least memory.
    pub fn new(pairs: &[[f64; 2]]) -> Self {
        let mut known = HashMap::new();
        let mut different = Vec::new();
        let mut numbers = Vec::with_capacity(pairs.len());
        for pair in pairs {
            let number = *known.entry(pair.map(f64::to_bits)).or_insert_with(|| {
                different.push(*pair);
                different.len() - 1
            });
            match u16::try_from(number) {
                Ok(number) => numbers.push(number),
                Err(_) => return Self::many(pairs),
            }
        }
        let few = Self::Few {
            numbers,
            pairs: different,
        };
        if known.len() <= FEW || few.bytes() <= (size_of::<i32>() + size_of::<i16>()) * pairs.len() {
            few
        } else {
            Self::many(pairs)
        }
    }

    fn many(pairs: &[[f64; 2]]) -> Self {
        let unit = |n: usize, most: f64| {
            let sizes = pairs.iter().map(|p| p[n].abs());
            // One that is not finite makes all so, and whoever checks the flow sees it.
            let greatest = sizes.clone().fold(0.0, f64::max) + 0.0 * sizes.sum::<f64>();
            if greatest == 0.0 { 1.0 } else { greatest / most }
        };
        let units = [unit(0, i32::MAX.into()), unit(1, i16::MAX.into())];
        let parts = |n: usize| pairs.iter().map(move |pair| (pair[n] / units[n]).round());
        Self::Many {
            shares: parts(0).map(|share| share as i32).collect(),
            swells: parts(1).map(|swell| swell as i16).collect(),
            units,
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Few { numbers, pairs } => size_of_val(&**numbers) + size_of_val(&**pairs),
            Self::Many { shares, swells, .. } => size_of_val(&**shares) + size_of_val(&**swells),
        }
    }

    /// Share and swelling of link `n`.
    #[inline(always)]
    pub fn of(&self, n: usize) -> [f64; 2] {
        match self {
            Self::Few { numbers, pairs } => pairs[usize::from(numbers[n])],
            Self::Many { shares, swells, units } => [f64::from(shares[n]) * units[0], f64::from(swells[n]) * units[1]],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Different numbers, of either sign and many sizes.
    fn pairs(count: usize, scale: f64) -> Vec<[f64; 2]> {
        let turn = |n: usize| (n as f64 * 0.618_033_988_749_895).fract() - 0.37;
        (0..count)
            .map(|n| [scale * turn(n), 0.3 * turn(7 * n).powi(3)])
            .collect()
    }

    #[test]
    fn few_pairs_are_kept_as_they_are() {
        let few = pairs(1000, 1.0);
        let links: Vec<_> = (0..9000).map(|n| few[7 * n % 1000]).collect();
        let terms = Terms::new(&links);
        assert!((0..9000).all(|n| terms.of(n) == links[n]));
        assert_eq!(terms.bytes(), 2 * 9000 + 16 * 1000);
    }

    #[test]
    fn what_is_not_finite_is_not_hidden() {
        for wrong in [f64::NAN, f64::INFINITY] {
            let mut links = pairs(70_000, 1.0);
            links[5][0] = wrong;
            assert!(!Terms::new(&links).of(9)[0].is_finite());
        }
    }

    #[test]
    fn many_pairs_are_kept_to_a_part_of_the_greatest() {
        for scale in [1.0, 1e-3, 1e200, 0.0] {
            let links = pairs(70_000, scale);
            let terms = Terms::new(&links);
            assert_eq!(terms.bytes(), 6 * links.len());
            let greatest = [0, 1].map(|i| links.iter().map(|l| l[i].abs()).fold(0.0, f64::max));
            for (n, link) in links.iter().enumerate() {
                for i in 0..2 {
                    let error = (terms.of(n)[i] - link[i]).abs();
                    assert!(error <= greatest[i] * [2.4e-10, 1.6e-5][i], "{n} {i} {error:e}");
                }
            }
        }
    }
}
