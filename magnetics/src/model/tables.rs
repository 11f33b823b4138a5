//! Pair tables for the kinds of beads that a problem has.

use super::Problem;
use super::near::Pair;
use super::strength::weakened;
use crate::MU0;
use crate::bead::Bead;
use crate::error::MagneticsError;
use crate::two_sphere::{Fineness, Moments, PairTable};
use lbm_ibm_coupling::Vec3;
use std::collections::HashMap;

/// Tables by kind of pair, made when first met.
#[derive(Clone, Debug)]
pub(super) struct Tables {
    fineness: Fineness,
    reach: f64,
    order: Vec<PairTable>,
    known: HashMap<[u64; 4], usize>,
    /// Tables of the same pair at the strengths of `weak_strength`, by index of its own.
    weak: HashMap<usize, Vec<PairTable>>,
}

/// Strengths at which weakened pairs are tabulated, but for the last, which is one.
const WEAK: usize = 8;

fn weak_strength(k: usize) -> f64 {
    (k as f64 / WEAK as f64).max(0.02)
}

impl Tables {
    /// Tables to a gap of `reach` mean radii of each pair.
    pub fn new(fineness: Fineness, reach: f64) -> Self {
        Self {
            fineness,
            reach,
            order: Vec::new(),
            known: HashMap::new(),
            weak: HashMap::new(),
        }
    }

    /// The greatest gap (m) that any pair's table covers.
    pub fn reach_of(&self, problem: &Problem<'_>) -> f64 {
        self.reach * problem.largest_radius()
    }

    /// The table of a pair and whether its first sphere is the pair's second bead; none where a bead is not induced.
    pub fn of(&mut self, a: &Bead, b: &Bead) -> Result<Option<(usize, bool)>, MagneticsError> {
        let kind = |bead: &Bead| (bead.radius(), bead.initial_permeability());
        let (mut one, mut two) = (kind(a), kind(b));
        if one.1 == 1.0 || two.1 == 1.0 {
            return Ok(None);
        }
        let swapped = one > two;
        if swapped {
            (one, two) = (two, one);
        }
        let key = [one.0, one.1, two.0, two.1].map(f64::to_bits);
        let index = match self.known.get(&key) {
            Some(index) => *index,
            None => {
                let reach = self.reach * 0.5 * (one.0 + two.0);
                let table = PairTable::new([one.0, two.0], [one.1, two.1], reach, self.fineness)?;
                self.order.push(table);
                self.known.insert(key, self.order.len() - 1);
                self.order.len() - 1
            }
        };
        Ok(Some((index, swapped)))
    }

    pub fn get(&self, index: usize) -> &PairTable {
        &self.order[index]
    }

    /// What is exact less mutual dipoles at `distance` (m) where the polarisabilities of both spheres are `strength` of their
    /// own, and its slope with that: t^3 times a cubic through four tabulated strengths, for the leading term has three
    /// polarisabilities.
    pub fn weakened(
        &mut self,
        index: usize,
        distance: f64,
        strength: f64,
    ) -> Result<(Moments, Moments), MagneticsError> {
        let full = &self.order[index];
        if !self.weak.contains_key(&index) {
            let (radius, permeability) = full.spheres();
            let reach = full.reach();
            let table = |k| {
                let weak = permeability.map(|mu| weakened(mu, weak_strength(k)));
                PairTable::new(radius, weak, reach, self.fineness)
            };
            let tables = (0..WEAK).map(table).collect::<Result<_, _>>()?;
            self.weak.insert(index, tables);
        }
        let weak = &self.weak[&index];
        let at = |k: isize| -> [f64; 4] {
            let k = k.clamp(0, WEAK as isize) as usize;
            let (d, t) = if k == WEAK {
                (full.correction(distance), 1.0)
            } else {
                (weak[k].correction(distance), weak_strength(k))
            };
            [d.par, d.perp, d.par_slope, d.perp_slope].map(|v| v / t.powi(3))
        };
        let (t, n) = (strength, WEAK as f64);
        let k = ((t * n) as isize).clamp(0, WEAK as isize - 1);
        let u = t * n - k as f64;
        let [before, low, high, after] = [at(k - 1), at(k), at(k + 1), at(k + 2)];
        let (mut value, mut slope) = ([0.0; 4], [0.0; 4]);
        for c in 0..4 {
            // Slopes at the nodes by differences, one-sided at the ends.
            let d0 = if k == 0 {
                high[c] - low[c]
            } else {
                0.5 * (high[c] - before[c])
            };
            let d1 = if k + 1 == WEAK as isize {
                high[c] - low[c]
            } else {
                0.5 * (after[c] - low[c])
            };
            let c2 = 3.0 * (high[c] - low[c]) - 2.0 * d0 - d1;
            let c3 = 2.0 * (low[c] - high[c]) + d0 + d1;
            let v = low[c] + u * (d0 + u * (c2 + u * c3));
            let dv = n * (d0 + u * (2.0 * c2 + u * 3.0 * c3));
            value[c] = t.powi(3) * v;
            slope[c] = 3.0 * t * t * v + t.powi(3) * dv;
        }
        let moments = |[par, perp, par_slope, perp_slope]: [f64; 4]| Moments {
            par,
            perp,
            par_slope,
            perp_slope,
        };
        Ok((moments(value), moments(slope)))
    }
}

/// Size (N) of the force that the moments `m` of a pair stand for, in the field `b` (T).
pub(super) fn force_size(m: &Moments, pair: &Pair, b: Vec3) -> f64 {
    let n = pair.r / pair.distance;
    let along = b.dot(&n);
    let across = (b - n * along).norm();
    let radial = 0.5 * (m.par_slope.abs() * along * along + m.perp_slope.abs() * across * across);
    (radial + (m.par - m.perp).abs() / pair.distance * along.abs() * across) / MU0
}
