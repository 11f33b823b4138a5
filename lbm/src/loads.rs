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

impl<'a> Loads<'a> {
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

    /// Links of the rows.
    fn add_rows(&mut self) {
        let fluid = self.fluid;
        let mut links = fluid.links.walls.iter().zip(&fluid.links.directions).enumerate();
        let mut open = fluid.links.openings.links.iter().map(|o| o.wall).peekable();
        for (node, i) in self.walls() {
            let Some((n, (link, direction))) = links.next() else {
                return;
            };
            debug_assert_eq!(usize::from(*direction), i);
            if open.next_if_eq(&n).is_some() {
                continue;
            }
            let fraction = fluid.links.fractions.get(n).copied().unwrap_or(0.5);
            let (ghost, home) = (fluid.storage.get(link.ghost), fluid.storage.get(link.home));
            // After an even step what goes out stands at home, after an odd one what returns.
            let exchanged = if fluid.odd { [home, ghost] } else { [ghost, home] };
            self.add(node, i, fraction, exchanged);
        }
    }

    /// Links of packed nodes: what returns waits in the one place of a link, and what went out is that without what was added.
    fn add_packed(&mut self) {
        let Fluid {
            links, storage, more, ..
        } = self.fluid;
        let (marks, surface) = (&links.marks, self.fluid.surface());
        let pass = self.fluid.pass(!self.fluid.odd);
        let interpolates = self.fluid.wall_rule.interpolates();
        let mut mark = 0;
        for (node, i) in self.walls() {
            let [x, j, k] = node.map(|n| n as isize);
            let number = storage.place(0, x, j, k) as usize;
            let returning = storage.get(storage.arrays()[i] + number);
            let mut added = 0.0;
            if mark < marks.len() && marks.link(mark) == (number, i) {
                // SAFETY: nobody writes, for the fluid is shared.
                added = unsafe { marks.added(pass, mark, more) };
                mark += 1;
            }
            let fraction = if interpolates {
                surface.meeting(node, i).fraction
            } else {
                0.5
            };
            self.add(node, i, fraction, [returning - added, returning]);
        }
    }

    /// Nodes beside walls, each with the populations that come back to it, in the order of links.
    fn walls(&self) -> impl Iterator<Item = ([usize; 3], usize)> + use<'a> {
        let Fluid {
            links, storage, mask, ..
        } = self.fluid;
        let nodes = links.rows.iter().flat_map(move |row| {
            let [j, k] = row.at();
            links.nodes(row).map(move |x| [x, j, k])
        });
        nodes.flat_map(move |node| {
            (1..storage.velocities().q())
                .filter(move |&i| {
                    let c = storage.velocities().c(i);
                    let [x, y, z] = std::array::from_fn(|a| node[a] as isize - c[a] as isize);
                    mask.is_solid(x, y, z)
                })
                .map(move |i| (node, i))
        })
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
        if self.links.packed.is_some() {
            loads.add_packed();
        } else {
            loads.add_rows();
        }
        for (sides, exchanged) in self.links.thin.iter().zip(&self.exchanged) {
            for (side, exchanged) in sides.iter().zip(exchanged) {
                loads.add(side.node, side.cut.direction, side.fraction, *exchanged);
            }
        }
        loads.parts
    }
}
