//! Where links meet walls, and walls that pass between nodes.

use crate::mask::{FACING, Mask};
use crate::parallel;
use crate::rim::Rim;
use crate::stencil::{Velocities, opposite};
use lbm_ibm_coupling::{Boundary, Grid, Vec3};

/// Greatest cosine between the normals at the two cuts of a link that passes a thin wall. Where it grazes a curved wall or a
/// square edge the normals are closer.
const BACK_TO_BACK: f64 = -0.5;
/// Depth, in spacings, of the middle of the part of a link that is in a wall, from which on the link does not pass: links that
/// graze a round wall of 2 spacings' radius are never so deep, those across a square edge are.
const DEEP: f64 = 0.13;
/// How far before a cut its normal is taken, as a fraction of the link.
const BEFORE: f64 = 1e-3;

/// The walls as links meet them.
pub struct Surface<'a> {
    pub grid: &'a Grid,
    pub walls: Option<&'a dyn Boundary>,
    pub t: f64,
    /// Lattice unit of velocity, m/s.
    pub velocity_unit: f64,
    pub velocities: Velocities,
}

/// Where a link from a fluid node meets a wall.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// As a fraction of the link.
    pub fraction: f64,
    /// `6 w_i c_i.u_wall`.
    pub push: f64,
    /// The same of a wall that would move into the fluid by one lattice unit of velocity; not negative.
    pub swell: f64,
}

/// Walls between nodes.
#[derive(Default)]
pub struct Between {
    /// Links from a fluid node against a direction to another one, with a wall between them or the rim of one; those without a
    /// rim do not pass.
    pub thin: Vec<([usize; 3], usize, Option<Rim>)>,
    /// Links along the axes between two solid nodes, with a gap between them.
    pub closed_gaps: usize,
}

impl Surface<'_> {
    /// `c_i` as a vector, lattice units.
    fn velocity(&self, i: usize) -> Vec3 {
        Vec3::from(self.velocities.c(i).map(f64::from))
    }

    /// Halfway along the link from `node` against direction `i`.
    pub fn halfway(&self, node: [usize; 3], i: usize) -> Meeting {
        let [x, j, k] = node;
        let at = self.grid.position(x, j, k) - self.velocity(i) * (0.5 * self.grid.spacing);
        self.at(0.5, at, i)
    }

    /// Where the link from the fluid `node` against direction `i` meets the wall: half way at a face of the grid, and where
    /// the wall cannot be found.
    ///
    /// A link that leaves the box by a periodic face may meet a wall on either side of it.
    pub fn meeting(&self, node: [usize; 3], i: usize) -> Meeting {
        let (a, b) = self.ends(node, i);
        let home = self.grid.domain().wrap(b);
        let mut first = self.first_cut(a, b);
        if home != b {
            let beyond = self.first_cut(a + (home - b), home);
            first = [first, beyond].into_iter().flatten().min_by(|p, q| p.0.total_cmp(&q.0));
        }
        match first {
            Some((fraction, at)) if fraction <= 0.5 || self.in_grid(node, i).is_some() => self.at(fraction, at, i),
            _ => self.halfway(node, i),
        }
    }

    /// Where the link meets the wall if the scene is mirrored at the open faces by which the link leaves the grid;
    /// `mirrored` is its direction beyond them. Half way where there is no wall to be seen.
    pub fn mirrored_meeting(&self, node: [usize; 3], i: usize, mirrored: usize) -> Meeting {
        let (a, b) = self.ends(node, i);
        let middle = 0.5 * (a + b);
        if let Some((s, at)) = self.first_cut(a, middle) {
            return self.at(0.5 * s, at, i);
        }
        let end = middle - self.velocity(mirrored) * (0.5 * self.grid.spacing);
        match self.first_cut(middle, end) {
            Some((s, at)) => self.at(0.5 + 0.5 * s, at, mirrored),
            None => self.halfway(node, i),
        }
    }

    /// Whether the link from the fluid `node` against direction `i` meets a wall within its first half, the middle included.
    pub fn meets_by_half_way(&self, node: [usize; 3], i: usize) -> bool {
        let (a, b) = self.ends(node, i);
        self.first_cut(a, b).is_some_and(|(fraction, _)| fraction < 0.5 + 1e-6)
    }

    /// Fraction and place of the cut, if there is a wall to be seen.
    fn first_cut(&self, a: Vec3, b: Vec3) -> Option<(f64, Vec3)> {
        let walls = self.walls?;
        if walls.probe(a, self.t).distance <= 0.0 {
            return None;
        }
        let s = walls.cut(a, b, self.t)?.clamp(0.0, 1.0);
        Some((s, a + (b - a) * s))
    }

    fn at(&self, fraction: f64, at: Vec3, i: usize) -> Meeting {
        let push = |velocity: Vec3| 6.0 * self.velocities.weight(i) * self.velocities.along(i, velocity.into());
        let probe = self.walls.map(|w| w.probe(at, self.t));
        Meeting {
            fraction,
            push: probe.map_or(0.0, |p| push(p.velocity / self.velocity_unit)),
            swell: probe.map_or(0.0, |p| push(p.normal).max(0.0)),
        }
    }

    /// Both ends of the link from `node` against direction `i`, the far one beyond the box if need be.
    fn ends(&self, [x, j, k]: [usize; 3], i: usize) -> (Vec3, Vec3) {
        let a = self.grid.position(x, j, k);
        (a, a - self.velocity(i) * self.grid.spacing)
    }

    /// The node at the far end of the link from `node` against direction `i`; none beyond a closed face.
    pub fn in_grid(&self, node: [usize; 3], i: usize) -> Option<[usize; 3]> {
        let mut at = [0; 3];
        for a in 0..3 {
            let (n, s) = (
                self.grid.shape[a] as isize,
                node[a] as isize - self.velocities.c(i)[a] as isize,
            );
            if !self.grid.periodic[a] && !(0..n).contains(&s) {
                return None;
            }
            at[a] = s.rem_euclid(n) as usize;
        }
        Some(at)
    }

    /// Finds walls that pass between two fluid nodes and gaps that pass between two solid ones, near the walls.
    pub fn between(&self, mask: &Mask) -> Between {
        let [nx, ny, nz] = self.grid.shape;
        let mut found = Between::default();
        let Some(walls) = self.walls else { return found };
        let rows: Vec<[usize; 2]> = (0..nz).flat_map(|k| (0..ny).map(move |j| [j, k])).collect();
        let parts = parallel::map(&rows, |&[j, k]| {
            let mut part = Between::default();
            for x in (0..nx).filter(|&x| mask.is_close([x, j, k])) {
                let node = [x, j, k];
                // One direction of each opposite pair.
                for i in (1..self.velocities.q()).step_by(2) {
                    let Some(far) = self.in_grid(node, i) else { continue };
                    match (mask.is_solid_at(node), mask.is_solid_at(far)) {
                        (false, false) if mask.is_close(far) => {
                            let cut = self.thin_cut(walls, node, far, i);
                            let rim = self.rim(walls, node, far, i, cut);
                            if cut.is_some() || rim.is_some() {
                                part.thin.push((node, i, rim));
                            }
                        }
                        (true, true) if i < 7 && self.is_closed_gap(walls, node, far, i) => part.closed_gaps += 1,
                        _ => {}
                    }
                }
            }
            part
        });
        for part in parts {
            found.thin.extend(part.thin);
            found.closed_gaps += part.closed_gaps;
        }
        found
    }

    /// Where a link between two fluid nodes, taken from each end, meets walls that turn their backs on each other, or is deep in a wall on
    /// its way: fractions of its length.
    fn thin_cut(&self, walls: &dyn Boundary, node: [usize; 3], far: [usize; 3], i: usize) -> Option<[f64; 2]> {
        let cut = |node, i| {
            let (a, b) = self.ends(node, i);
            let s = walls.cut(a, b, self.t)?;
            Some((s, walls.probe(a + (b - a) * (s - BEFORE).max(0.0), self.t).normal))
        };
        let (first, near) = cut(node, i)?;
        let (last, beyond) = cut(far, opposite(i))?;
        let (a, b) = self.ends(node, i);
        let middle = a + (b - a) * (0.5 * (1.0 + first - last));
        let deep = || walls.probe(middle, self.t).distance < -DEEP * self.grid.spacing;
        (beyond.dot(&near) < BACK_TO_BACK || deep()).then_some([first, last])
    }

    /// The rim of a thin wall near which the link passes or is cut; the link may leave the box by a periodic face.
    fn rim(
        &self,
        walls: &dyn Boundary,
        node: [usize; 3],
        far: [usize; 3],
        i: usize,
        cut: Option<[f64; 2]>,
    ) -> Option<Rim> {
        let find = |(a, b), side: usize| match cut {
            Some(cut) => self.is_cut_at_rim(walls, a, b, cut[side]),
            None => self.passes_rim(walls, a, b),
        };
        let ends = self.ends(node, i);
        let found = find(ends, 0);
        let back = self.ends(far, opposite(i));
        match back.0 == ends.1 {
            true => found,
            false => found.or_else(|| find(back, 1)),
        }
    }

    /// Whether two solid nodes belong to walls that face each other across a gap.
    fn is_closed_gap(&self, walls: &dyn Boundary, node: [usize; 3], far: [usize; 3], i: usize) -> bool {
        let probe = |[x, j, k]: [usize; 3]| walls.probe(self.grid.position(x, j, k), self.t);
        let (near, far) = (probe(node), probe(far));
        let facing = near.normal.dot(&self.velocity(i)) < -FACING && far.normal.dot(&self.velocity(i)) > FACING;
        let filled = near.distance > 0.0 || far.distance > 0.0;
        facing && !filled && -near.distance - far.distance < (1.0 - BEFORE) * self.grid.spacing
    }
}
