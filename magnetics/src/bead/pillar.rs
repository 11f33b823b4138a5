//! Soft-magnetic posts that gather beads.

use super::{Bead, Magnetisation};
use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::{Soa3, Vec3};

/// A soft-magnetic pillar as a column of touching spheres that stay where they are.
///
/// The spheres answer to the field, and to beads, as beads do: append them to the beads of a problem, and hold them with
/// [`Overdamped::freeze`](crate::Overdamped::freeze). A column of spheres has two thirds of the volume of the cylinder about
/// it, so its moment is smaller: choose the radius that has the volume of the post, or measure.
///
/// ```
/// use lbm_ibm_coupling::{Soa3, UM, Vec3};
/// use lbm_ibm_magnetics::*;
///
/// // A bead beside a post of nickel (mu_r 100 here) in a field along the post.
/// let pillar = Pillar::new(Vec3::zeros(), Vec3::z(), 10.0 * UM, 40.0 * UM, Intrinsic::new(99.0)?)?;
/// let bead = Bead::new(1.4 * UM, 1400.0, Apparent::new(0.75)?)?;
/// let mut x: Soa3 = [Vec3::new(14.0, 0.0, 38.0) * UM].into_iter().collect();
/// let mut beads = vec![bead];
/// let held = pillar.append(&mut beads, &mut x);
/// let source = Uniform::new(Vec3::z() * 0.02);
/// let mut run = Overdamped::new(beads, x, source, MutualDipoles::new(), 1e-3)?;
/// held.for_each(|bead| run.freeze(bead));
/// let start = run.positions().get(0);
/// run.run_to(1e-3)?;
/// // The pole of the post pulls.
/// assert!(run.positions().get(0).x < start.x && run.positions().get(1) == Vec3::z() * 10.0 * UM);
/// # Ok::<(), MagneticsError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Pillar {
    bead: Bead,
    foot: Vec3,
    axis: Vec3,
    count: usize,
}

/// Density (kg/m3) of the column's spheres, which do not move.
const DENSITY: f64 = 8000.0;

impl Pillar {
    /// A column from `foot` (m, the middle of its base) along `axis` (of any length), of `radius` and `height` (m): as many
    /// whole spheres as come closest to the height, at least one.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the radius, the height or the length of the axis.
    pub fn new(
        foot: Vec3,
        axis: Vec3,
        radius: f64,
        height: f64,
        law: impl Into<Magnetisation>,
    ) -> Result<Self, MagneticsError> {
        positive("height of the pillar (m)", height)?;
        let length = positive("length of the pillar's axis", axis.norm())?;
        Ok(Self {
            bead: Bead::new(radius, DENSITY, law)?,
            foot,
            axis: axis / length,
            count: (0.5 * height / radius).round().max(1.0) as usize,
        })
    }

    /// Centres of its spheres, m, from the foot upwards.
    pub fn positions(&self) -> impl Iterator<Item = Vec3> + '_ {
        (0..self.count).map(|k| self.foot + self.axis * (self.bead.radius() * (2 * k + 1) as f64))
    }

    /// One of its spheres; all are equal.
    pub fn bead(&self) -> &Bead {
        &self.bead
    }

    /// Appends its spheres to beads and positions, and returns their numbers there.
    pub fn append(&self, beads: &mut Vec<Bead>, x: &mut Soa3) -> std::ops::Range<usize> {
        let first = beads.len();
        for position in self.positions() {
            beads.push(self.bead.clone());
            x.push(position);
        }
        first..beads.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Intrinsic;

    #[test]
    fn a_pillar_is_a_column_of_touching_spheres_on_its_foot() {
        let chi = Intrinsic::new(9.0).unwrap();
        let foot = Vec3::new(1.0, 2.0, 3.0);
        let pillar = Pillar::new(foot, Vec3::x() * 7.0, 0.5, 2.9, chi).unwrap();
        let x: Vec<_> = pillar.positions().collect();
        assert_eq!(x, [0.5, 1.5, 2.5].map(|d| foot + Vec3::x() * d));
        assert!(Pillar::new(foot, Vec3::zeros(), 0.5, 2.9, chi).is_err());
        assert!(Pillar::new(foot, Vec3::x(), -0.5, 2.9, chi).is_err());
        assert_eq!(
            Pillar::new(foot, Vec3::x(), 0.5, 0.1, chi).unwrap().positions().count(),
            1
        );
    }
}
