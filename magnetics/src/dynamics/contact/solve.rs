//! The forces of contacts, by successive over-relaxation with projection.

use super::{BeadContact, Constraint, Look, Partner};
use crate::dynamics::mobility::Mobility;
use crate::dynamics::system::BeadSystem;
use crate::error::MagneticsError;
use lbm_ibm_coupling::{Soa3, Vec3};
use std::f64::consts::PI;

/// Over-relaxation of normal forces, in the first sweeps.
const RELAXATION: f64 = 1.5;
/// Sweeps after which normal forces are relaxed by one.
const PATIENCE: usize = 500;
/// Sweeps between looks at whether beads still move.
const LOOK: usize = 20;

/// A contact that a step may close.
#[derive(Clone, Debug)]
pub(in crate::dynamics) struct Site {
    pub bead: usize,
    pub with: Partner,
    pub normal: Vec3,
    /// Gap where it was looked for, m.
    pub gap: f64,
    /// Gap from which the step goes on, to first order, m.
    ahead: f64,
    friction: f64,
    /// Velocity of the wall, m/s.
    pub wall: Vec3,
    /// Force on the bead, N.
    pub force: Vec3,
    /// Relative velocity before contact, along the normal, m/s.
    pub approach: f64,
    compliance: [f64; 2],
}

impl Site {
    pub fn new(bead: usize, with: Partner, normal: Vec3, [gap, ahead]: [f64; 2], friction: f64) -> Self {
        Self {
            bead,
            with,
            normal,
            gap,
            ahead,
            friction,
            wall: Vec3::zeros(),
            force: Vec3::zeros(),
            approach: 0.0,
            compliance: [0.0; 2],
        }
    }

    fn other(&self) -> Option<usize> {
        match self.with {
            Partner::Bead(j) => Some(j),
            Partner::Wall(_) => None,
        }
    }

    /// The beads that touch.
    pub fn beads(&self) -> impl Iterator<Item = usize> {
        std::iter::once(self.bead).chain(self.other())
    }

    pub fn key(&self) -> (usize, Partner) {
        (self.bead, self.with)
    }

    /// Time until it closes with the mean of its approach and that of the closed contact `then`, s.
    pub fn time_to_close(&self, then: &Site) -> f64 {
        let mean = -0.5 * (self.approach + then.approach);
        if self.gap <= 0.0 { 0.0 } else { self.gap / mean.max(0.0) }
    }

    pub fn is_closed(&self) -> bool {
        self.force.dot(&self.normal) > 0.0
    }
}

/// The contacts of the last solve, where the next one starts.
#[derive(Clone, Debug, Default)]
pub(in crate::dynamics) struct Contacts {
    pub sites: Vec<Site>,
    pub reported: Vec<BeadContact>,
    /// Deepest overlap at the end of the last step, m.
    pub overlap: f64,
}

impl Contacts {
    /// The contacts that push, and those with gaps below `gap` (m).
    pub fn closer_than(&self, gap: f64) -> Vec<Site> {
        self.sites
            .iter()
            .filter(|s| s.is_closed() || s.gap < gap)
            .cloned()
            .collect()
    }

    /// Reports the contacts at the end of a step; `closed_at` is the time (s) at which
    /// one that `is_closed` and is new has closed.
    pub fn accept(
        &mut self,
        sites: Vec<Site>,
        overlap: f64,
        is_closed: impl Fn(&Site) -> bool,
        closed_at: impl Fn(&Site) -> f64,
    ) {
        let report = |s: &Site| {
            let old = self
                .reported
                .binary_search_by_key(&(s.bead, s.with), |c| (c.bead, c.with));
            let normal_force = s.force.dot(&s.normal);
            BeadContact {
                bead: s.bead,
                with: s.with,
                normal: s.normal,
                gap: s.gap,
                normal_force,
                friction: s.force - s.normal * normal_force,
                since: old.map_or_else(|_| closed_at(s), |k| self.reported[k].since),
            }
        };
        self.reported = sites.iter().filter(|s| is_closed(s)).map(report).collect();
        self.sites = sites;
        self.overlap = overlap;
    }
}

/// Velocities under contact, and angular ones where beads roll.
struct Moving<'a> {
    v: &'a mut Soa3,
    spin: Soa3,
    /// Angular mobility of each bead times its radius, 1/(8 pi eta a^2); zero for beads that do not turn.
    turn: Vec<f64>,
    radius: Vec<f64>,
    mobility: &'a Mobility,
}

impl Moving<'_> {
    /// Velocity of the bead's surface at the contact relative to what it touches.
    fn relative(&self, s: &Site) -> Vec3 {
        let rim = |i: usize, sign: f64| self.spin.get(i).cross(&(s.normal * (sign * self.radius[i])));
        let own = self.v.get(s.bead) + rim(s.bead, -1.0);
        match s.other() {
            Some(j) => own - self.v.get(j) - rim(j, 1.0),
            None => own - s.wall,
        }
    }

    fn kick(&mut self, s: &Site, f: Vec3) {
        self.mobility.kick(s.bead, f, self.v);
        // A force f at arm -a n turns bead i by -n x f; minus it at arm a n turns bead j the same way.
        let torque = -s.normal.cross(&f);
        self.spin.add(s.bead, torque * self.turn[s.bead]);
        if let Some(j) = s.other() {
            self.mobility.kick(j, -f, self.v);
            self.spin.add(j, torque * self.turn[j]);
        }
    }

    /// Normal and greatest tangential velocity per force.
    fn compliance(&self, s: &Site) -> [f64; 2] {
        let m = self.mobility.relative(s.bead, s.other());
        let n = s.normal;
        let normal = n.dot(&(m * n));
        let rim = |i: usize| self.turn[i] * self.radius[i];
        let turn = rim(s.bead) + s.other().map_or(0.0, rim);
        // The trace of the tangential block bounds its greatest value.
        [normal, m.trace() - normal + turn]
    }
}

impl BeadSystem {
    /// Adds to the velocities `v` (m/s) what contacts do in a step of `look.step` from `look.base`; returns all
    /// contacts that were looked at.
    ///
    /// # Errors
    /// [`MagneticsError::Contact`] when the sweeps do not suffice.
    pub(in crate::dynamics) fn constrain(
        &mut self,
        law: &Constraint,
        look: &Look<'_>,
        mobility: &Mobility,
        v: &mut Soa3,
    ) -> Result<Vec<Site>, MagneticsError> {
        let n = v.len();
        let fastest = v.iter().map(|v| v.norm()).fold(0.0, f64::max);
        let moved = (0..n)
            .map(|i| (look.base.get(i) - look.x.get(i)).norm())
            .fold(0.0, f64::max);
        let smallest = self.smallest_radius();
        let reach = 2.5 * (look.step * fastest + moved) + 1e-3 * smallest;
        let mut sites = self.find(look, law, reach);
        if sites.is_empty() {
            return Ok(sites);
        }
        let radius: Vec<f64> = self.beads.iter().map(|b| b.radius()).collect();
        let viscosity = self.mobility.viscosity;
        let turn = |i: usize| {
            let turns = law.rolling && !self.frozen[i];
            if turns {
                1.0 / (8.0 * PI * viscosity * radius[i].powi(2))
            } else {
                0.0
            }
        };
        let mut moving = Moving {
            turn: (0..n).map(turn).collect(),
            spin: Soa3::zeros(n),
            radius,
            mobility,
            v,
        };
        let last = &self.contacts.sites;
        for s in &mut sites {
            s.compliance = moving.compliance(s);
            s.approach = moving.relative(s).dot(&s.normal);
        }
        for s in &mut sites {
            if let Ok(k) = last.binary_search_by_key(&s.key(), Site::key) {
                let push = last[k].force.dot(&last[k].normal);
                let drag = last[k].force - last[k].normal * push;
                s.force = s.normal * push + (drag - s.normal * s.normal.dot(&drag));
                moving.kick(s, s.force);
            }
        }
        let allowed = (1e-4 * look.step * fastest).clamp(1e-12 * smallest, 1e-6 * smallest);
        let mut change = f64::INFINITY;
        let mut earlier = moving.v.clone();
        for sweep in 0..law.sweeps {
            let relaxation = if sweep < PATIENCE { RELAXATION } else { 1.0 };
            change = 0.0;
            for s in &mut sites {
                change = f64::max(change, relax(s, &mut moving, look.step, relaxation));
            }
            if change <= allowed {
                return Ok(sites);
            }
            // In a rigid cluster with more contacts than it needs, gaps that do not fit together to the last digits let the forces
            // drift for ever while the beads stand still: then the motion is found, and what gap is left is reported.
            if sweep % LOOK == LOOK - 1 {
                let moved = (0..n)
                    .map(|i| (moving.v.get(i) - earlier.get(i)).norm())
                    .fold(0.0, f64::max);
                if moved * look.step <= allowed && change <= 0.1 * law.overlap * smallest {
                    return Ok(sites);
                }
                earlier.clone_from(moving.v);
            }
        }
        Err(MagneticsError::Contact {
            contacts: sites.len(),
            sweeps: law.sweeps,
            residual: change,
            allowed,
        })
    }
}

/// One relaxation of one contact; returns how far it moves the beads, m.
fn relax(s: &mut Site, moving: &mut Moving<'_>, step: f64, relaxation: f64) -> f64 {
    let n = s.normal;
    let [normal, across] = s.compliance;
    if normal <= 0.0 {
        return 0.0;
    }
    let velocity = moving.relative(s);
    let push = s.force.dot(&n);
    let excess = velocity.dot(&n) + s.ahead / step;
    if push == 0.0 && excess >= 0.0 {
        return 0.0;
    }
    let next = (push - relaxation * excess / normal).max(0.0);
    let mut drag = s.force - n * push;
    moving.kick(s, n * (next - push));
    let mut change = (next - push).abs() * normal;
    if s.friction > 0.0 {
        let velocity = moving.relative(s);
        let sliding = velocity - n * velocity.dot(&n);
        let mut held = drag - sliding / across;
        let most = s.friction * next;
        if held.norm() > most {
            held *= most / held.norm();
        }
        moving.kick(s, held - drag);
        change = change.max((held - drag).norm() * across);
        drag = held;
    }
    s.force = n * next + drag;
    change * step
}
