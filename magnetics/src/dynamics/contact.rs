//! Contact between beads and with walls.

mod find;
mod solve;

pub(super) use find::Look;
pub(super) use solve::{Contacts, Site};

use lbm_ibm_coupling::Vec3;

/// A force that keeps beads apart: strength exp(-gap/range), between beads and from walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsion {
    /// Force at contact, N.
    pub strength: f64,
    /// Gap over which it falls by e, m.
    pub range: f64,
}

/// Contact as a constraint: no bead enters another or a wall, and Coulomb friction holds or drags what touches.
///
/// In a step of length c each contact has gap + c vn >= 0, a normal force that pushes only and only at a closed gap, and a
/// friction of at most the coefficient times it, against the sliding velocity. The forces come from successive
/// over-relaxation of all contacts in a fixed order, started from the last step's, until
/// a sweep moves no bead by more than 1e-4 of the step's motion without contact, or 1e-6 radii. The step has no stiffness limit
/// of contact. In a rigid cluster with more contacts than it needs the motion is determined but not each force.
///
/// Unless they roll, beads do not turn in contact (their friction is that of sliding without rotation, as for beads whose
/// moment is held by the field); linear beads are free to turn, and then they roll with the mobility 1/(8 pi eta a^3) of a
/// lone sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// Friction coefficient between beads.
    pub friction: f64,
    /// Friction coefficient between beads and walls.
    pub wall_friction: f64,
    /// Whether beads roll.
    pub rolling: bool,
    /// Greatest overlap left after a step, in radii of the smallest bead; a step that leaves more is made again, shorter.
    pub overlap: f64,
    /// Most sweeps over all contacts in one solve.
    pub sweeps: usize,
}

impl Default for Constraint {
    /// Friction 0.2 everywhere, an assumed figure: measure it for your beads. No rolling, overlap 1e-4, 20000 sweeps.
    fn default() -> Self {
        Self {
            friction: 0.2,
            wall_friction: 0.2,
            rolling: false,
            overlap: 1e-4,
            sweeps: 20_000,
        }
    }
}

impl Constraint {
    /// Without friction.
    pub fn frictionless() -> Self {
        Self {
            friction: 0.0,
            wall_friction: 0.0,
            ..Self::default()
        }
    }
}

/// What keeps beads apart.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ContactLaw {
    /// A constraint with friction.
    Constraint(Constraint),
    /// A soft force, whose stiffness limits the step; no friction.
    Repulsion(Repulsion),
    /// Nothing: beads pass through each other and through walls.
    None,
}

impl Default for ContactLaw {
    fn default() -> Self {
        Self::Constraint(Constraint::default())
    }
}

impl From<Constraint> for ContactLaw {
    fn from(c: Constraint) -> Self {
        Self::Constraint(c)
    }
}

impl From<Repulsion> for ContactLaw {
    fn from(r: Repulsion) -> Self {
        Self::Repulsion(r)
    }
}

/// What a bead touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Partner {
    /// Another bead, of a higher number.
    Bead(usize),
    /// A part of the walls.
    Wall(u32),
}

/// A closed contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeadContact {
    /// The bead.
    pub bead: usize,
    /// What it touches.
    pub with: Partner,
    /// Unit vector from what it touches to the bead.
    pub normal: Vec3,
    /// Gap between the surfaces, m; negative is the residual overlap.
    pub gap: f64,
    /// Force along the normal on the bead, N, positive.
    pub normal_force: f64,
    /// Friction on the bead, N.
    pub friction: Vec3,
    /// Time since when it is closed, s.
    pub since: f64,
}
