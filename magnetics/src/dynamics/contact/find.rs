//! Which contacts a step may close.

use super::solve::Site;
use super::{Constraint, Partner};
use crate::dynamics::system::BeadSystem;
use lbm_ibm_coupling::{Boundary, Probe, Soa3, Vec3};

/// Where a contact solve looks: gaps at `x` and `time`, positions that go from `base` on for `step` (s).
pub(in crate::dynamics) struct Look<'a> {
    pub x: &'a Soa3,
    pub time: f64,
    pub base: &'a Soa3,
    pub step: f64,
}

impl BeadSystem {
    /// All contacts with gaps below `reach` (m) between beads that can move, in a fixed order.
    pub(in crate::dynamics) fn find(&mut self, look: &Look<'_>, law: &Constraint, reach: f64) -> Vec<Site> {
        let mut sites = Vec::new();
        let frozen = self.frozen.clone();
        let shift = |i: usize| look.base.get(i) - look.x.get(i);
        self.for_close_pairs(look.x, reach, |i, j, r, gap| {
            if !(frozen[i] && frozen[j]) {
                let normal = r / r.norm();
                let ahead = gap + normal.dot(&(shift(i) - shift(j)));
                sites.push(Site::new(i, Partner::Bead(j), normal, [gap, ahead], law.friction));
            }
        });
        if let Some(walls) = &self.walls {
            for (i, bead) in self.beads.iter().enumerate().filter(|(i, _)| !frozen[*i]) {
                for probe in near_walls(walls.as_ref(), look.x.get(i), look.time, bead.radius(), reach) {
                    let gap = probe.distance - bead.radius();
                    let ahead = gap + probe.normal.dot(&shift(i));
                    let mut site = Site::new(
                        i,
                        Partner::Wall(probe.part),
                        probe.normal,
                        [gap, ahead],
                        law.wall_friction,
                    );
                    site.wall = probe.velocity;
                    sites.push(site);
                }
            }
        }
        sites.sort_by_key(Site::key);
        sites
    }
}

/// The nearest wall to a bead if its gap is below `reach`, and others that probes on the bead's surface find: their distance is
/// that of the plane they have there, kept when it is not below that of the nearest wall (so not for a pillar's far side).
fn near_walls(walls: &dyn Boundary, x: Vec3, time: f64, radius: f64, reach: f64) -> Vec<Probe> {
    let nearest = walls.probe(x, time);
    let mut out: Vec<Probe> = Vec::new();
    if nearest.distance - radius >= reach || !nearest.distance.is_finite() {
        return out;
    }
    out.push(nearest);
    let n = nearest.normal;
    let across = n.cross(&Vec3::ith(n.iamin(), 1.0)).normalize();
    let other = n.cross(&across);
    for to in [n, across, -across, other, -other] {
        let s = to * radius;
        let there = walls.probe(x + s, time);
        let distance = there.distance - there.normal.dot(&s);
        let known = out.iter().any(|p| p.normal.dot(&there.normal) > 0.9);
        if !known && distance - radius < reach && distance >= nearest.distance - 1e-9 * radius {
            out.push(Probe { distance, ..there });
        }
    }
    out
}
