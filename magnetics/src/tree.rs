//! Sums over all dipoles by a tree.

mod boxes;
mod expansion;
mod expansions;
mod plan;
mod sums;
mod terms;

pub(crate) use sums::{DipoleSums, Summation};

use crate::error::{MagneticsError, within};

/// Order and opening that bring the rms force error below an accuracy: chosen on loose clouds of 2e4 and 5e4 beads of one size,
/// whose forces cancel in part.
const LADDER: [(f64, usize, f64); 5] = [
    (1e-2, 4, 0.6),
    (1e-3, 6, 0.5),
    (1e-4, 9, 0.5),
    (1e-5, 10, 0.4),
    (1e-6, 10, 0.33),
];
/// Beads in a leaf.
const LEAF: usize = 64;

/// A fast sum over dipoles: those nearby one by one, the others by expansions of the boxes that they are in.
///
/// Cost grows as N instead of N^2. Two boxes meet as a whole where the sum of their radii is at most the opening times the
/// distance of their centres and no two of their beads overlap; expansions are Cartesian, with all derivatives of 1/r up to the
/// order (Dehnen 2002, J. Comput. Phys. 179, 27). What meets is the same from both sides, so that the sum stays symmetric
/// in the moments, as conjugate gradients need, and forces are the gradient of the summed energy as long as no bead changes
/// its box. Results do not depend on the number of threads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tree {
    order: usize,
    opening: f64,
}

/// What a tree has done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TreeReport {
    /// Order of the expansions.
    pub order: usize,
    /// Sum of two boxes' radii over their distance, at most.
    pub opening: f64,
    /// Root mean square of the forces' error over that of the forces, held against the direct sum at 128 of the beads.
    pub rms_error: f64,
}

impl Default for Tree {
    fn default() -> Self {
        Self::new()
    }
}

impl Tree {
    /// A tree with an rms force error of about 1e-4.
    pub fn new() -> Self {
        Self { order: 9, opening: 0.5 }
    }

    /// Order and opening for another rms error of the forces over their rms, from 1e-6 up. It is what loose clouds have: the
    /// [`TreeReport`] says what came of it.
    ///
    /// # Errors
    /// [`MagneticsError::Setting`] unless it lies in [1e-6, 0.1].
    pub fn with_accuracy(self, accuracy: f64) -> Result<Self, MagneticsError> {
        within("accuracy of the tree", accuracy, 1e-6, 0.1)?;
        let rung = LADDER.iter().find(|rung| rung.0 <= accuracy * (1.0 + 1e-9));
        let (_, order, opening) = *rung.unwrap_or(&LADDER[LADDER.len() - 1]);
        Ok(Self { order, opening })
    }

    /// Another order of the expansions.
    ///
    /// # Errors
    /// [`MagneticsError::Setting`] unless it is from 3 to 10.
    pub fn with_order(mut self, order: usize) -> Result<Self, MagneticsError> {
        within("order of the tree", order as f64, 3.0, terms::MOST as f64)?;
        self.order = order;
        Ok(self)
    }

    /// Another opening: the sum of the radii of two boxes that meet as a whole, over the distance of their centres, at most.
    ///
    /// # Errors
    /// [`MagneticsError::Setting`] unless it lies in [0.1, 0.8].
    pub fn with_opening(mut self, opening: f64) -> Result<Self, MagneticsError> {
        self.opening = within("opening of the tree", opening, 0.1, 0.8)?;
        Ok(self)
    }
}
