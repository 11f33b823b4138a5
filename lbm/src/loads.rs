//! Force and torque of the fluid on walls, by the momentum that the links exchange.

use crate::fluid::Fluid;
use lbm_ibm_coupling::{Boundary, Vec3, Wrench};

/// Sums what links exchange, part by part.
struct Loads<'a> {
    fluid: &'a Fluid,
    walls: &'a dyn Boundary,
    t: f64,
    about: Vec3,
    parts: Vec<Wrench>,
}

impl Loads<'_> {
    /// A link of `node` against direction `i`, cut at a fraction of its length, with the outgoing and the returning
    /// population.
    fn add(&mut self, [x, j, k]: [usize; 3], i: usize, fraction: f64, [outgoing, returning]: [f64; 2]) {
        let Fluid { grid, .. } = self.fluid;
        let c = Vec3::from(self.fluid.storage.velocities().c(i).map(f64::from));
        let at = grid.position(x, j, k) - c * (fraction * grid.spacing);
        let probe = self.walls.probe(grid.domain().wrap(at), self.t);
        let part = probe.part as usize;
        if part >= self.parts.len() {
            self.parts.resize(part + 1, Wrench::zero());
        }
        let scale = 1.0 / self.fluid.force_scale();
        let moved = probe.velocity * ((returning - outgoing) / self.fluid.velocity_unit());
        let force = c * (-(outgoing + returning) * scale) + moved * scale;
        self.parts[part].force += force;
        self.parts[part].torque += grid.domain().shortest(at - self.about).cross(&force);
    }
}

impl Fluid {
    /// Momentum exchange of the last step, summed over the links of each part: a link along c, whose wall moves with u, hands
    /// the wall `(-c - u) out - (c - u) in` at the place where it meets the wall (Ladd 1994; Galilean invariant by the terms
    /// in u, Wen et al. 2014). Populations are stored less their weights, so the force is that of the pressure about the
    /// rest state.
    pub(crate) fn momentum_exchange(&self, walls: &dyn Boundary, t: f64, about: Vec3) -> Vec<Wrench> {
        let mut loads = Loads {
            fluid: self,
            walls,
            t,
            about,
            parts: Vec::new(),
        };
        let mut links = self.links.walls.iter().zip(&self.links.directions).enumerate();
        let mut open = self.links.openings.links.iter().map(|o| o.wall).peekable();
        for row in &self.links.rows {
            for x in self.links.runs[row.runs.clone()].iter().cloned().flatten() {
                for i in 1..self.storage.velocities().q() {
                    let [cx, cy, cz] = self.storage.velocities().c(i).map(|c| c as isize);
                    let behind = [x as isize - cx, row.j as isize - cy, row.k as isize - cz];
                    if !self.mask.is_solid(behind[0], behind[1], behind[2]) {
                        continue;
                    }
                    let Some((n, (link, direction))) = links.next() else {
                        return loads.parts;
                    };
                    debug_assert_eq!(usize::from(*direction), i);
                    if open.next_if_eq(&n).is_some() {
                        continue;
                    }
                    let fraction = self.links.fractions.get(n).copied().unwrap_or(0.5);
                    let (ghost, home) = (self.storage.get(link.ghost), self.storage.get(link.home));
                    // After an even step what goes out stands at home, after an odd one what returns.
                    let exchanged = if self.odd { [home, ghost] } else { [ghost, home] };
                    loads.add([x, row.j, row.k], i, fraction, exchanged);
                }
            }
        }
        for (sides, exchanged) in self.links.thin.iter().zip(&self.exchanged) {
            for (side, exchanged) in sides.iter().zip(exchanged) {
                loads.add(side.node, side.cut.direction, side.fraction, *exchanged);
            }
        }
        loads.parts
    }
}
