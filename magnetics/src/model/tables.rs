//! Pair tables for the kinds of beads that a problem has.

use super::Problem;
use super::near::Pair;
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
}

impl Tables {
    /// Tables to a gap of `reach` mean radii of each pair.
    pub fn new(fineness: Fineness, reach: f64) -> Self {
        Self {
            fineness,
            reach,
            order: Vec::new(),
            known: HashMap::new(),
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
}

/// Size (N) of the force that the moments `m` of a pair stand for, in the field `b` (T).
pub(super) fn force_size(m: &Moments, pair: &Pair, b: Vec3) -> f64 {
    let n = pair.r / pair.distance;
    let along = b.dot(&n);
    let across = (b - n * along).norm();
    let radial = 0.5 * (m.par_slope.abs() * along * along + m.perp_slope.abs() * across * across);
    (radial + (m.par - m.perp).abs() / pair.distance * along.abs() * across) / MU0
}
