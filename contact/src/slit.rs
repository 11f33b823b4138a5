//! A wall with a slit across a flat channel.

use crate::{ContactError, Solid};
use lbm_ibm_coupling::{Plane, Union, Vec3};

/// A flat channel along x, floor at y = 0, without end in z, and across it a wall with a slit at mid-height.
///
/// Lengths in m. Parts: 0 floor, 1 ceiling, 2 the block below the slit, 3 the block above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlitChannel {
    /// Distance from floor to ceiling.
    pub height: f64,
    /// Height of the slit.
    pub gap: f64,
    /// Length of the slit along the flow.
    pub thickness: f64,
    /// Radius of the four edges of the slit.
    pub edge_radius: f64,
    /// Middle of the slit along x.
    pub position: f64,
}

impl SlitChannel {
    /// The walls.
    ///
    /// # Errors
    /// [`ContactError::NotPositive`], [`ContactError::GapTooWide`], [`ContactError::EdgeTooRound`].
    pub fn walls(&self) -> Result<Union, ContactError> {
        for (what, value) in [
            ("the height of the channel (m)", self.height),
            ("the gap of the slit (m)", self.gap),
            ("the thickness of the slit (m)", self.thickness),
            ("the edge radius of the slit (m)", self.edge_radius),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(ContactError::NotPositive { what, value });
            }
        }
        if self.gap >= self.height {
            return Err(ContactError::GapTooWide {
                gap: self.gap,
                height: self.height,
            });
        }
        if 2.0 * self.edge_radius > self.thickness {
            return Err(ContactError::EdgeTooRound {
                radius: self.edge_radius,
                thickness: self.thickness,
                needed: 2.0 * self.edge_radius,
            });
        }
        Ok(Union::new()
            .with(Plane::new(Vec3::zeros(), Vec3::y()))
            .with(Plane::new(Vec3::y() * self.height, -Vec3::y()).with_part(1))
            .with(self.block(-1.0).with_part(2))
            .with(self.block(1.0).with_part(3)))
    }

    /// The block above (`side` = 1) or below (-1) the slit; it reaches far into floor or ceiling, and far along z.
    fn block(&self, side: f64) -> Solid {
        let depth = 2.0 * self.height;
        let middle = 0.5 * self.height + side * 0.5 * (self.gap + depth);
        let size = Vec3::new(self.thickness, depth, 1e3 * self.height);
        Solid::rounded_box(Vec3::new(self.position, middle, 0.0), size, self.edge_radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::Boundary;

    const SLIT: SlitChannel = SlitChannel {
        height: 12e-6,
        gap: 4e-6,
        thickness: 5e-6,
        edge_radius: 1e-6,
        position: 20e-6,
    };

    #[test]
    fn the_gap_is_as_wide_as_it_says() {
        let walls = SLIT.walls().expect("a good slit");
        for z in [-3e-6, 40e-6] {
            let mid = walls.probe(Vec3::new(20e-6, 6e-6, z), 0.0);
            assert_relative_eq!(mid.distance, 2e-6, max_relative = 1e-9);
            let low = walls.probe(Vec3::new(20e-6, 4.5e-6, z), 0.0);
            assert_relative_eq!(low.distance, 0.5e-6, max_relative = 1e-9);
            assert_eq!(low.part, 2);
        }
        let upstream = walls.probe(Vec3::new(5e-6, 11e-6, 0.0), 0.0);
        assert_eq!(upstream.part, 1);
        assert_relative_eq!(upstream.distance, 1e-6, max_relative = 1e-9);
    }

    #[test]
    fn slits_that_cannot_be_are_refused() {
        let wide = SlitChannel { gap: 13e-6, ..SLIT };
        assert!(matches!(wide.walls().err(), Some(ContactError::GapTooWide { .. })));
        let round = SlitChannel {
            edge_radius: 3e-6,
            ..SLIT
        };
        assert!(matches!(round.walls().err(), Some(ContactError::EdgeTooRound { .. })));
        let none = SlitChannel { gap: 0.0, ..SLIT };
        assert!(matches!(none.walls().err(), Some(ContactError::NotPositive { .. })));
    }
}
