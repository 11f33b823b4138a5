//! Cartesian expansions: which terms there are, and which belong together.

/// Greatest order of an expansion.
pub(super) const MOST: usize = 10;
/// Terms of an expansion of the greatest order.
pub(super) const ALL: usize = count(MOST);

/// Multi-indices of degree `order` and below: (p + 1)(p + 2)(p + 3)/6.
pub(super) const fn count(order: usize) -> usize {
    (order + 1) * (order + 2) * (order + 3) / 6
}

/// The multi-indices (i, j, k) to some degree, by degree, and sums and differences of them.
#[derive(Clone, Debug)]
pub(super) struct Terms {
    pub order: usize,
    pub degree: Vec<usize>,
    /// Steps of the recurrences, one per index but the first.
    pub steps: Vec<Step>,
    /// For each index a, of degree n: the places of a + b for all b of degree up to order - n.
    sums: Vec<Vec<u16>>,
}

/// How the derivatives of 1/r and the powers of a vector follow from those of lower degree.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// The lower index and the axis by which it is lower, for powers divided by factorials; and 1/(exponent of that axis).
    pub lower: usize,
    pub axis: usize,
    pub inverse: f64,
    /// (2n - 1) i/n and the place of the index less one along each axis.
    pub one: [(f64, usize); 3],
    /// (n - 1) i (i - 1)/n and the place of the index less two along each axis.
    pub two: [(f64, usize); 3],
}

impl Terms {
    pub fn new(order: usize) -> Self {
        let mut index = Vec::with_capacity(count(order));
        for n in 0..=order {
            for i in (0..=n).rev() {
                for j in (0..=n - i).rev() {
                    index.push([i, j, n - i - j]);
                }
            }
        }
        let degree: Vec<usize> = index.iter().map(|a| a.iter().sum()).collect();
        let steps = index[1..].iter().map(|a| step(*a)).collect();
        let sums = index
            .iter()
            .zip(&degree)
            .map(|(a, n)| {
                let others = &index[..count(order - n)];
                let sum = |b: &[usize; 3]| place(std::array::from_fn(|c| a[c] + b[c])) as u16;
                others.iter().map(sum).collect()
            })
            .collect();
        Self {
            order,
            degree,
            steps,
            sums,
        }
    }

    /// Number of terms.
    pub fn len(&self) -> usize {
        self.degree.len()
    }

    /// The places of a + b for all b that stay within the order.
    #[inline(always)]
    pub fn sums(&self, a: usize) -> &[u16] {
        &self.sums[a]
    }
}

/// The place of a multi-index among all, by degree.
fn place([i, j, k]: [usize; 3]) -> usize {
    let n = i + j + k;
    let below = n * (n + 1) * (n + 2) / 6;
    let rest = n - i;
    below + rest * (rest + 1) / 2 + k
}

fn step(a: [usize; 3]) -> Step {
    let n = a.iter().sum::<usize>() as f64;
    let less = |axis: usize, by: usize| {
        let mut b = a;
        b[axis] = b[axis].saturating_sub(by);
        place(b)
    };
    let axis = (0..3).find(|c| a[*c] > 0).unwrap_or(0);
    let i = |c: usize| a[c] as f64;
    Step {
        lower: less(axis, 1),
        axis,
        inverse: 1.0 / i(axis),
        one: std::array::from_fn(|c| match a[c] {
            0 => (0.0, 0),
            _ => ((2.0 * n - 1.0) * i(c) / n, less(c, 1)),
        }),
        two: std::array::from_fn(|c| match a[c] {
            0 | 1 => (0.0, 0),
            _ => ((n - 1.0) * i(c) * (i(c) - 1.0) / n, less(c, 2)),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_up_and_sums_stay_within_the_order() {
        let terms = Terms::new(6);
        assert_eq!(terms.len(), count(6));
        let mut at = 0;
        for n in 0..=6 {
            for i in (0..=n).rev() {
                for j in (0..=n - i).rev() {
                    assert_eq!(place([i, j, n - i - j]), at);
                    at += 1;
                }
            }
        }
        for a in 0..terms.len() {
            assert_eq!(terms.sums(a).len(), count(6 - terms.degree[a]));
            assert_eq!(terms.sums(a)[0] as usize, a);
        }
        assert_eq!(terms.sums(1)[2] as usize, place([1, 1, 0]));
    }
}
