//! Which nodes are near each other.

use crate::{Domain, Soa3Ref, Vec3};

/// A cell list: nodes sorted into boxes at least as wide as a cut-off, periodic where the domain is.
#[derive(Clone, Debug, Default)]
pub struct CellList {
    shape: [usize; 3],
    width: Vec3,
    origin: Vec3,
    periodic: [bool; 3],
    start: Vec<u32>,
    node: Vec<u32>,
    cell: Vec<u32>,
}

impl CellList {
    /// An empty list.
    pub fn new() -> Self {
        Self::default()
    }

    /// Sorts nodes at `x` (m) into boxes at least `cutoff` (m) wide. Allocates only while it grows.
    pub fn build(&mut self, x: Soa3Ref<'_>, domain: &Domain, cutoff: f64) {
        self.lay_out(x, domain, cutoff);
        let cells = self.shape.iter().product::<usize>();
        self.start.clear();
        self.start.resize(cells + 1, 0);
        self.cell.clear();
        for i in 0..x.len() {
            let c = self.cell_of(domain.wrap(x.get(i)));
            let c = self.linear(c) as u32;
            self.cell.push(c);
            self.start[c as usize + 1] += 1;
        }
        for c in 0..cells {
            self.start[c + 1] += self.start[c];
        }
        self.node.clear();
        self.node.resize(x.len(), 0);
        for i in (0..x.len()).rev() {
            let c = self.cell[i] as usize;
            self.start[c + 1] -= 1;
            self.node[self.start[c + 1] as usize] = i as u32;
        }
        // The fill has turned every end into the start of the same cell; shift back.
        self.start.remove(0);
        self.start.push(x.len() as u32);
    }

    fn lay_out(&mut self, x: Soa3Ref<'_>, domain: &Domain, cutoff: f64) {
        let (mut lo, mut hi) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for p in x.iter() {
            let p = domain.wrap(p);
            lo = lo.inf(&p);
            hi = hi.sup(&p);
        }
        let most = (2.0 * (x.len() as f64).cbrt()).ceil().max(1.0);
        for a in 0..3 {
            self.periodic[a] = domain.periodic[a];
            let (origin, size) = if domain.periodic[a] {
                (domain.origin[a], domain.size[a])
            } else {
                (lo[a], (hi[a] - lo[a]).max(cutoff))
            };
            self.origin[a] = if origin.is_finite() { origin } else { 0.0 };
            let size = if size.is_finite() { size } else { cutoff };
            let n = (size / cutoff).floor().clamp(1.0, most);
            self.shape[a] = n as usize;
            self.width[a] = size / n;
        }
    }

    fn cell_of(&self, x: Vec3) -> [usize; 3] {
        std::array::from_fn(|a| {
            let c = (x[a] - self.origin[a]) / self.width[a];
            (c.max(0.0) as usize).min(self.shape[a] - 1)
        })
    }

    fn linear(&self, c: [usize; 3]) -> usize {
        (c[2] * self.shape[1] + c[1]) * self.shape[0] + c[0]
    }

    /// Calls `pair(i, j)` once for every pair of nodes in the same or adjoining boxes, in a fixed order; all pairs
    /// closer than the cut-off are among them.
    pub fn for_each_pair(&self, mut pair: impl FnMut(usize, usize)) {
        let [nx, ny, nz] = self.shape;
        for cz in 0..nz {
            for cy in 0..ny {
                for cx in 0..nx {
                    let here = self.linear([cx, cy, cz]);
                    if self.members(here).is_empty() {
                        continue;
                    }
                    let (around, count) = self.around([cx, cy, cz]);
                    for &i in self.members(here) {
                        for &there in &around[..count] {
                            for &j in self.members(there) {
                                if i < j {
                                    pair(i as usize, j as usize);
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    fn members(&self, cell: usize) -> &[u32] {
        &self.node[self.start[cell] as usize..self.start[cell + 1] as usize]
    }

    /// The different boxes that adjoin one, itself included.
    fn around(&self, c: [usize; 3]) -> ([usize; 27], usize) {
        let mut out = [0; 27];
        let mut count = 0;
        for dz in -1..=1 {
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let step = [dx, dy, dz];
                    let there = std::array::from_fn(|a| self.shifted(c[a], step[a], a));
                    if let [Some(x), Some(y), Some(z)] = there {
                        let cell = self.linear([x, y, z]);
                        if !out[..count].contains(&cell) {
                            out[count] = cell;
                            count += 1;
                        }
                    }
                }
            }
        }
        (out, count)
    }

    fn shifted(&self, c: usize, step: isize, axis: usize) -> Option<usize> {
        let n = self.shape[axis] as isize;
        let to = c as isize + step;
        if self.periodic[axis] {
            Some(to.rem_euclid(n) as usize)
        } else {
            (0..n).contains(&to).then_some(to as usize)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Soa3;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn finds_each_close_pair_once(
            points in prop::collection::vec(prop::array::uniform3(-3.0..7.0f64), 2..60),
            periodic in prop::array::uniform3(any::<bool>()),
            cutoff in 0.2..1.5f64,
        ) {
            let domain = Domain { origin: Vec3::zeros(), size: Vec3::new(4.0, 3.0, 5.0), periodic };
            let x: Soa3 = points.into_iter().map(Vec3::from).collect();
            let mut list = CellList::new();
            list.build(x.view(), &domain, cutoff);
            let mut found = Vec::new();
            list.for_each_pair(|i, j| found.push((i, j)));
            let all = found.len();
            found.sort_unstable();
            found.dedup();
            prop_assert_eq!(all, found.len());
            for i in 0..x.len() {
                for j in i + 1..x.len() {
                    if domain.shortest(x.get(i) - x.get(j)).norm() < cutoff {
                        prop_assert!(found.binary_search(&(i, j)).is_ok());
                    }
                }
            }
        }
    }
}
