//! Two magnetisable spheres in a homogeneous field, exactly.

mod system;
mod table;
mod truncated;

pub(crate) use table::{Fineness, Moments, PairTable};
pub(crate) use truncated::Truncated;

use crate::MU0;
use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::Vec3;
use system::System;

/// Two linear spheres, in a non-magnetic medium and a homogeneous field.
///
/// The potential is a sum of multipoles about both centres, coupled by the translation theorem of solid harmonics; sphere
/// i answers to the incoming order l with l (mu - 1)/(l mu + l + 1). Orders are added until forces and moments stand still.
///
/// ```
/// use lbm_ibm_magnetics::TwoSpheres;
///
/// // Touching spheres of permeability 2: force along the line over that of fixed dipoles, 1.45.
/// let pair = TwoSpheres::new([1.0, 1.0], [2.0, 2.0])?.solve(2.001)?;
/// assert!((pair.force_par + 0.44335).abs() < 1e-5);
/// # Ok::<(), lbm_ibm_magnetics::MagneticsError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSpheres {
    radius: [f64; 2],
    permeability: [f64; 2],
    tolerance: f64,
    most: usize,
}

/// Forces and moments of two spheres in a homogeneous field B0.
///
/// Forces (m2) times B0^2/mu0 are newtons, moments (m3) times B0/mu0 are A m2. Forces are on the second sphere: along the
/// line from the first to the second (negative is attraction), F_r = par cos^2 + perp sin^2 of the angle alpha between
/// line and field, and F_theta = tan sin(2 alpha) in the direction of growing alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairForce {
    /// Along the line, field parallel to it, m2.
    pub force_par: f64,
    /// Along the line, field normal to it, m2.
    pub force_perp: f64,
    /// Across the line over sin(2 alpha), m2: (M_perp - M_par)/(2 R), from the torque on the whole pair.
    pub force_tan: f64,
    /// Moments, field parallel to the line, m3.
    pub moment_par: [f64; 2],
    /// Moments, field normal to the line, m3.
    pub moment_perp: [f64; 2],
    /// Multipole orders used.
    pub order: usize,
    /// Relative change of forces and moments with the last orders.
    pub error: f64,
}

impl PairForce {
    /// Force (N) on the second sphere in the field `b` (T), `direction` a unit vector from the first to the second.
    pub fn force(&self, b: Vec3, direction: Vec3) -> Vec3 {
        let along = b.dot(&direction);
        let across = b - direction * along;
        let radial = self.force_par * along * along + self.force_perp * across.norm_squared();
        // theta-hat of growing alpha points away from the field's part across the line.
        (direction * radial - across * (2.0 * along * self.force_tan)) / MU0
    }

    /// Sum of both moments (m3) for the field parallel and normal to the line.
    pub fn total_moment(&self) -> [f64; 2] {
        [self.moment_par.iter().sum(), self.moment_perp.iter().sum()]
    }
}

impl TwoSpheres {
    /// Spheres of radii (m) and relative permeabilities.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`].
    pub fn new(radius: [f64; 2], permeability: [f64; 2]) -> Result<Self, MagneticsError> {
        for k in 0..2 {
            positive("radius of the sphere (m)", radius[k])?;
            positive("relative permeability", permeability[k])?;
        }
        Ok(Self {
            radius,
            permeability,
            tolerance: 1e-13,
            most: 2600,
        })
    }

    /// Stops when forces and moments change by less than `tolerance` (relative) with half as many orders again, or at
    /// `most` orders: what is left then is in [`PairForce::error`].
    pub fn with_limits(mut self, tolerance: f64, most: usize) -> Self {
        self.tolerance = tolerance;
        self.most = most;
        self
    }

    /// Forces and moments at the distance of centres `distance` (m).
    ///
    /// # Errors
    /// [`MagneticsError::Overlap`] where the spheres overlap.
    pub fn solve(&self, distance: f64) -> Result<PairForce, MagneticsError> {
        let contact = self.radius[0] + self.radius[1];
        let apart = distance >= contact * (1.0 - 1e-14);
        if !apart {
            return Err(MagneticsError::Overlap {
                first: 0,
                second: 1,
                depth: contact - distance,
            });
        }
        let mut order = 14;
        let mut last = self.at_order(distance, order);
        loop {
            let next = (order + order / 2).min(self.most.max(15));
            let mut now = self.at_order(distance, next);
            now.error = change(&last, &now);
            if now.error < self.tolerance || next >= self.most {
                return Ok(now);
            }
            (order, last) = (next, now);
        }
    }

    fn at_order(&self, distance: f64, order: usize) -> PairForce {
        let unit = self.radius[0];
        let spheres = self.radius.map(|a| a / unit);
        let system = |m: usize| System::new(spheres, self.permeability, distance / unit, order, m).solve();
        let (par, perp) = (system(0), system(1));
        let volume = unit.powi(3);
        let moment_par = par.moment.map(|m| m * volume);
        let moment_perp = perp.moment.map(|m| m * volume);
        PairForce {
            force_par: par.force * unit * unit,
            force_perp: perp.force * unit * unit,
            force_tan: (moment_perp.iter().sum::<f64>() - moment_par.iter().sum::<f64>()) / (2.0 * distance),
            moment_par,
            moment_perp,
            order,
            error: f64::INFINITY,
        }
    }
}

fn change(a: &PairForce, b: &PairForce) -> f64 {
    let relative = |a: f64, b: f64| if b == 0.0 { a.abs() } else { ((a - b) / b).abs() };
    [
        relative(a.force_par, b.force_par),
        relative(a.force_perp, b.force_perp),
        relative(a.moment_par[0], b.moment_par[0]),
        relative(a.moment_par[1], b.moment_par[1]),
        relative(a.moment_perp[0], b.moment_perp[0]),
        relative(a.moment_perp[1], b.moment_perp[1]),
    ]
    .into_iter()
    .fold(0.0, f64::max)
}
