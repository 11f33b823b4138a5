//! Where a cell is held.

use crate::MembraneError;
use lbm_ibm_coupling::{Soa3Ref, Vec3};

/// Which nodes at an end of a cell are held.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Patch {
    /// This share of all nodes: those farthest out.
    Fraction(f64),
    /// Those beyond a chord of this length (m) of the circle whose diameter is the size of the cell along the pull: a
    /// bead that touches a red blood cell's rim over 2 um holds `Chord(2e-6)`.
    Chord(f64),
    /// Those nearer than this (m) to the outermost point of the long axis: the contact of a bead of twice this width.
    Within(f64),
}

/// The nodes held at the two ends of a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ends {
    /// Pulled along -x.
    pub minus: Vec<u32>,
    /// Pulled along +x.
    pub plus: Vec<u32>,
}

impl Patch {
    /// The patches at the two ends along x of a cell with nodes at `x` (m).
    ///
    /// # Errors
    /// [`MembraneError::EmptyPatch`].
    pub fn ends(self, x: Soa3Ref<'_>) -> Result<Ends, MembraneError> {
        Ok(Ends {
            minus: self.nodes(x, -Vec3::x())?,
            plus: self.nodes(x, Vec3::x())?,
        })
    }

    /// The nodes of the patch at the end of a cell towards `direction` (a unit vector), in ascending order.
    ///
    /// # Errors
    /// [`MembraneError::EmptyPatch`].
    pub fn nodes(self, x: Soa3Ref<'_>, direction: Vec3) -> Result<Vec<u32>, MembraneError> {
        let reach: Vec<f64> = x.iter().map(|x| x.dot(&direction)).collect();
        let mut order: Vec<u32> = (0..reach.len() as u32).collect();
        order.sort_by(|&i, &j| reach[j as usize].total_cmp(&reach[i as usize]));
        let count = match self {
            Self::Fraction(share) => (share * reach.len() as f64).round() as usize,
            Self::Chord(chord) => {
                let far = |i: Option<&u32>| i.map_or(0.0, |&i| reach[i as usize]);
                let (top, bottom) = (far(order.first()), far(order.last()));
                let (middle, radius) = (0.5 * (top + bottom), 0.5 * (top - bottom));
                let depth = (radius * radius - 0.25 * chord * chord).max(0.0).sqrt();
                reach.iter().filter(|&&r| r - middle > depth).count()
            }
            Self::Within(distance) => {
                let far = order.first().map_or(0.0, |&i| reach[i as usize]);
                let tip = x.mean() + direction * (far - x.mean().dot(&direction));
                let from = |i: u32| (x.get(i as usize) - tip).norm();
                order.sort_by(|&i, &j| from(i).total_cmp(&from(j)));
                order.iter().filter(|&&i| from(i) <= distance).count()
            }
        };
        order.truncate(count);
        order.sort_unstable();
        if order.is_empty() {
            return Err(MembraneError::EmptyPatch {
                what: format!("{self:?}"),
            });
        }
        Ok(order)
    }
}
