//! Whether beads may be taken as without inertia.

use super::system::BeadSystem;
use lbm_ibm_coupling::Soa3;

/// Greatest Reynolds and Stokes number at which motion counts as overdamped.
const LIMIT: f64 = 0.1;

/// How fast the beads have been: overdamped motion needs both numbers small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Regime {
    /// Greatest Reynolds number of a bead so far, rho |v - u| a/eta.
    pub reynolds: f64,
    /// Greatest Stokes number of a bead so far, 2/9 rho_bead |v - u| a/eta.
    pub stokes: f64,
    /// The first bead of which one of them exceeded 0.1, and when.
    pub exceeded: Option<Exceeded>,
}

/// The first bead that was too fast for overdamped motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exceeded {
    /// Which bead.
    pub bead: usize,
    /// When, s.
    pub time: f64,
}

impl Regime {
    /// Whether inertia is nothing: both numbers at most 0.1.
    pub fn is_overdamped(&self) -> bool {
        self.reynolds <= LIMIT && self.stokes <= LIMIT
    }

    pub(super) fn note(&mut self, system: &BeadSystem, velocity: &Soa3, time: f64) {
        for (i, bead) in system.beads.iter().enumerate() {
            if system.frozen[i] {
                continue;
            }
            let u = system.flow.velocity(system.x.get(i), time);
            let slip = (velocity.get(i) - u).norm() * bead.radius() / system.mobility.viscosity;
            let (reynolds, stokes) = (system.density * slip, 2.0 / 9.0 * bead.density() * slip);
            if reynolds.max(stokes) > LIMIT && self.exceeded.is_none() {
                self.exceeded = Some(Exceeded { bead: i, time });
            }
            self.reynolds = self.reynolds.max(reynolds);
            self.stokes = self.stokes.max(stokes);
        }
    }
}
