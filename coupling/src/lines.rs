//! Numbers in whole cache lines.

/// Bytes of a cache line.
const LINE: usize = 64;
/// Numbers in one.
const NUMBERS: usize = LINE / size_of::<f64>();

/// Numbers of which the first is the first of a cache line: a row of a brick is then one line, not parts of two.
#[derive(Debug, Default)]
pub(crate) struct Lines {
    all: Vec<f64>,
    first: usize,
    len: usize,
}

impl Lines {
    /// Makes it `len` zeros; memory is kept.
    pub fn reset(&mut self, len: usize) {
        self.all.clear();
        self.all.resize(len + NUMBERS, 0.0);
        self.first = self.all.as_ptr().align_offset(LINE).min(NUMBERS);
        self.len = len;
    }

    pub fn numbers(&self) -> &[f64] {
        &self.all[self.first..][..self.len]
    }

    pub fn numbers_mut(&mut self) -> &mut [f64] {
        &mut self.all[self.first..][..self.len]
    }
}

impl Clone for Lines {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.reset(self.len);
        copy.numbers_mut().copy_from_slice(self.numbers());
        copy
    }
}

/// Asks the processor for the cache line where `item` begins, to have it at hand some hundred instructions later. It changes nothing
/// but the time that this takes to read or write; worth it where items are too far apart for the processor to see them coming.
#[inline(always)]
pub fn prefetch<T>(item: &T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch has no effect but on caches and never faults; SSE is part of x86-64.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(item).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = item;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_begin_at_a_line_and_copies_too() {
        let mut lines = Lines::default();
        for len in [0, 8, 512, 3 * 512] {
            lines.reset(len);
            lines
                .numbers_mut()
                .iter_mut()
                .enumerate()
                .for_each(|(i, x)| *x = i as f64);
            let copy = lines.clone();
            assert_eq!(copy.numbers(), lines.numbers());
            for lines in [&lines, &copy] {
                assert_eq!(lines.numbers().len(), len);
                assert_eq!(lines.numbers().as_ptr() as usize % LINE, 0);
            }
            copy.numbers().iter().for_each(prefetch);
        }
    }
}
