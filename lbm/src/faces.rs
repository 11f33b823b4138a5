//! What stands at the faces of the grid that are not periodic.

use crate::error::LbmError;
use crate::fluid::Fluid;
use lbm_ibm_coupling::{Grid, Vec3};
use std::fmt;
use std::sync::Arc;

/// Which end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Where the coordinate is least.
    Low,
    /// Where it is greatest.
    High,
}

impl Side {
    /// 1 at the low end, -1 at the high one: the inward normal along the axis.
    pub(crate) fn inward(self) -> isize {
        match self {
            Self::Low => 1,
            Self::High => -1,
        }
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Low => "low",
            Self::High => "high",
        })
    }
}

/// A velocity (m/s) by place (m).
type Profile = Arc<dyn Fn(Vec3) -> Vec3 + Send + Sync>;

/// What stands at a face of the grid, half a spacing from the outermost nodes.
///
/// Where two faces meet, the first of wall, velocity, pressure, convective and symmetry holds on the edge; walls of the scene
/// hold where they meet a face.
///
/// - Velocity and flux: bounce-back that adds `6 w_i c_i.u`, as at a sliding wall. The inflow is what was asked for to
///   rounding. Over the first cells the profile adapts itself, by a part in `h^2`.
/// - Pressure: anti-bounce-back with the part of second order of Ginzburg, Verhaeghe and d'Humieres (2008),
///   `-f*_o + 2 e+(p, u) + (2 - 1/tau)(f+ - e+)`, the last two terms taken half way along the face, between the node and the one
///   from beside which the population would come. A developed flow without inertia passes it exactly.
/// - Convective: `(f_i(x, t) + l f_i(x - n, t + 1))/(1 + l)`, `l` the speed in cells per step (Lou, Guo and Shi 2013), and a
///   pull of 1/1000 a step of the mean density on the face towards the rest state, so that the mass stays bounded.
/// - Symmetry: what goes out comes back mirrored. The half of a flow is the same as the whole, to rounding.
#[derive(Clone, Default)]
#[non_exhaustive]
pub enum Face {
    /// A wall at rest, or whatever wall of the scene is nearest to it.
    #[default]
    Wall,
    /// A velocity, m/s, by place on the face, m.
    Velocity(Profile),
    /// A flux into the box, m3/s (negative: out of it), with the profile of a developed flow in the cross-section of the
    /// fluid at this face.
    Flux(f64),
    /// A pressure about the rest state, Pa.
    Pressure(f64),
    /// Flow leaves the box, and what it carries goes with a speed normal to the face, m/s.
    Convective(f64),
    /// A plane of symmetry, or one that the fluid slips along.
    Symmetry,
}

impl Face {
    /// A velocity, m/s, by place on the face, m.
    pub fn velocity(profile: impl Fn(Vec3) -> Vec3 + Send + Sync + 'static) -> Self {
        Self::Velocity(Arc::new(profile))
    }

    /// Which face holds where two meet: the greater.
    pub(crate) fn rank(&self) -> usize {
        match self {
            Self::Symmetry => 0,
            Self::Convective(_) => 1,
            Self::Pressure(_) => 2,
            Self::Velocity(_) | Self::Flux(_) => 3,
            Self::Wall => 4,
        }
    }

    /// Whether the mass of the fluid may change through it by itself.
    pub(crate) fn is_free(&self) -> bool {
        matches!(self, Self::Pressure(_) | Self::Convective(_))
    }

    fn number(&self) -> Option<(&'static str, f64)> {
        match self {
            Self::Flux(flux) => Some(("flux", *flux)),
            Self::Pressure(pressure) => Some(("pressure", *pressure)),
            Self::Convective(speed) => Some(("convective speed", *speed)),
            Self::Wall | Self::Velocity(_) | Self::Symmetry => None,
        }
    }
}

impl fmt::Debug for Face {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self, self.number()) {
            (_, Some((name, value))) => write!(f, "{name} {value}"),
            (Self::Velocity(_), _) => f.write_str("velocity"),
            (Self::Symmetry, _) => f.write_str("symmetry"),
            _ => f.write_str("wall"),
        }
    }
}

/// What is wrong with the faces of a grid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FaceError {
    /// There are three axes.
    #[error("there is no axis {axis}: use 0, 1 or 2")]
    NoAxis {
        /// Axis that was asked for.
        axis: usize,
    },
    /// A periodic axis has no faces.
    #[error("axis {axis} is periodic and has no faces: make the grid's axis not periodic, or leave its faces alone")]
    Periodic {
        /// Axis.
        axis: usize,
    },
    /// Too few nodes behind an open face.
    #[error("axis {axis} has {nodes} node(s): behind an open face there have to be two or more")]
    Shallow {
        /// Axis.
        axis: usize,
        /// Nodes along it.
        nodes: usize,
    },
    /// A velocity at a face is not finite.
    #[error("the velocity at the {side} face of axis {axis} is {value} m/s at ({}, {}, {}) m, it must be finite", at[0], at[1], at[2])]
    Velocity {
        /// Axis.
        axis: usize,
        /// Which end.
        side: Side,
        /// Component that is not, m/s.
        value: f64,
        /// Place, m.
        at: [f64; 3],
    },
    /// A velocity at a face is faster than the method can carry.
    #[error(
        "the velocity at the {side} face of axis {axis} is {speed} m/s, a Mach number of {mach:.3} where {limit} is the limit: use a time step of at most {time_step:.3e} s at this spacing"
    )]
    TooFast {
        /// Axis.
        axis: usize,
        /// Which end.
        side: Side,
        /// Greatest speed, m/s.
        speed: f64,
        /// Its Mach number.
        mach: f64,
        /// Greatest that is accepted.
        limit: f64,
        /// Longest time step that would do, s.
        time_step: f64,
    },
    /// A flux is asked for through a face without fluid.
    #[error(
        "no fluid touches the {side} face of axis {axis}, through which {flux} m3/s should pass: open the walls there"
    )]
    NoOpening {
        /// Axis.
        axis: usize,
        /// Which end.
        side: Side,
        /// Flux that was asked for, m3/s.
        flux: f64,
    },
    /// All faces say how much goes in and out, and it is not the same.
    #[error(
        "{flux} m3/s more flow in than out, and no face lets the rest go: give one face a pressure or make it convective, or make the fluxes equal"
    )]
    Unbalanced {
        /// What flows in too much, m3/s.
        flux: f64,
    },
}

/// The faces of a grid: by axis, low end and high end.
#[derive(Clone, Debug, Default)]
pub struct Faces(pub [[Face; 2]; 3]);

impl Faces {
    /// The face at an end of an axis.
    pub fn at(&self, axis: usize, side: Side) -> &Face {
        &self.0[axis][side as usize]
    }

    /// Whether any is not a wall.
    pub fn any_open(&self) -> bool {
        self.0.iter().flatten().any(|f| !matches!(f, Face::Wall))
    }

    /// Which faces are walls.
    pub fn walled(&self) -> [[bool; 2]; 3] {
        self.0
            .each_ref()
            .map(|ends| ends.each_ref().map(|f| matches!(f, Face::Wall)))
    }

    /// All that can be said against a face without the walls.
    pub fn check(grid: &Grid, axis: usize, face: &Face) -> Result<(), LbmError> {
        let Some(&periodic) = grid.periodic.get(axis) else {
            return Err(FaceError::NoAxis { axis }.into());
        };
        if let Some((name, value)) = face.number() {
            if !value.is_finite() {
                return Err(LbmError::NotFinite { name, value });
            }
            if matches!(face, Face::Convective(_)) && value <= 0.0 {
                return Err(LbmError::NotPositive { name, value });
            }
        }
        match face {
            Face::Wall => Ok(()),
            _ if periodic => Err(FaceError::Periodic { axis }.into()),
            Face::Symmetry => Ok(()),
            _ if grid.shape[axis] < 2 => Err(FaceError::Shallow {
                axis,
                nodes: grid.shape[axis],
            }
            .into()),
            _ => Ok(()),
        }
    }

    /// The faces by which the link from a node to `node - c` leaves the grid.
    pub fn crossed(&self, grid: &Grid, node: [usize; 3], c: [isize; 3]) -> [Option<Side>; 3] {
        std::array::from_fn(|a| {
            if grid.periodic[a] {
                return None;
            }
            match node[a] as isize - c[a] {
                -1 => Some(Side::Low),
                s if s == grid.shape[a] as isize => Some(Side::High),
                _ => None,
            }
        })
    }
}

impl Fluid {
    /// What stands at a face of the grid; see [`Fluid::set_face`].
    ///
    /// # Errors
    /// As for [`Fluid::set_face`].
    pub fn with_face(mut self, axis: usize, side: Side, face: Face) -> Result<Self, LbmError> {
        self.set_face(axis, side, face)?;
        Ok(self)
    }

    /// Changes what stands at the face at an end of an axis (0 to 2) that is not periodic, at any time; [`Face::Wall`] by
    /// default. The flow goes on as it is. Links are found anew, so a face that varies in every step costs more than the step.
    ///
    /// # Errors
    /// [`LbmError::NotFinite`] and [`LbmError::NotPositive`] for the numbers of a face; [`LbmError::Face`] for an axis that has no such face, a
    /// velocity that is not finite or too fast, a flux through a face without fluid. That what goes in and out is not the
    /// same, with no face to let the rest go, is an error of the next step, for more faces may be to come.
    pub fn set_face(&mut self, axis: usize, side: Side, face: Face) -> Result<(), LbmError> {
        Faces::check(&self.grid, axis, &face)?;
        self.grid.open[axis][side as usize] = !matches!(face, Face::Wall);
        self.faces.0[axis][side as usize] = face;
        self.mask.walled = self.faces.walled();
        self.relink();
        match self.links.openings.fault_without_balance() {
            Some(fault) => Err(fault.into()),
            None => Ok(()),
        }
    }

    /// What stands at the face at an end of an axis (0 to 2); none if there is no such axis.
    pub fn face(&self, axis: usize, side: Side) -> Option<&Face> {
        self.faces.0.get(axis).map(|ends| &ends[side as usize])
    }

    /// What flowed into the box through the open face at an end of an axis (0 to 2) in the last step, m3/s.
    pub fn inflow(&self, axis: usize, side: Side) -> f64 {
        self.links.openings.mass((axis, side as usize)) * self.velocity_unit() * self.grid.spacing.powi(2)
    }
}
