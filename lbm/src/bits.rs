//! A list of flags, a bit each.

/// Flags by number.
pub struct Bits(Vec<u64>);

impl Bits {
    /// So many flags, all set or none.
    pub fn new(len: usize, set: bool) -> Self {
        Self(vec![if set { u64::MAX } else { 0 }; len.div_ceil(64)])
    }

    /// Flag number `n`.
    #[inline]
    pub fn get(&self, n: usize) -> bool {
        self.0[n / 64] >> (n % 64) & 1 == 1
    }

    /// Sets flag number `n`, or clears it.
    pub fn put(&mut self, n: usize, set: bool) {
        let bit = 1 << (n % 64);
        if set {
            self.0[n / 64] |= bit;
        } else {
            self.0[n / 64] &= !bit;
        }
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flag_is_its_own() {
        for set in [false, true] {
            let mut bits = Bits::new(130, set);
            for n in [0, 63, 64, 129] {
                bits.put(n, !set);
            }
            bits.put(63, set);
            let changed: Vec<usize> = (0..130).filter(|n| bits.get(*n) != set).collect();
            assert_eq!(changed, [0, 64, 129]);
            assert_eq!(bits.bytes(), 24);
        }
    }
}
