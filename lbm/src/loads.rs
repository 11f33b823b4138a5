//! Force and torque of the fluid on walls, by the momentum that the links exchange.

use crate::d3q19::{C, Q};
use crate::fluid::Fluid;
use lbm_ibm_coupling::{Boundary, Vec3, Wrench};

impl Fluid {
    /// Momentum exchange (Ladd 1994) of the last step, summed over the links of each part: a link along c hands the wall
    /// -c (in + out), at the place where it meets the wall half way. Populations are stored less their weights, so the force
    /// is that of the pressure about the rest state.
    pub(crate) fn momentum_exchange(&self, walls: &dyn Boundary, t: f64, about: Vec3) -> Vec<Wrench> {
        let mut parts: Vec<Wrench> = Vec::new();
        let scale = 1.0 / self.force_scale();
        let mut links = self.links.walls.iter().zip(&self.links.directions);
        for row in &self.links.rows {
            for run in &self.links.runs[row.runs.clone()] {
                for x in run.clone() {
                    for i in 1..Q {
                        let [cx, cy, cz] = C[i].map(|c| c as isize);
                        let behind = [x as isize - cx, row.j as isize - cy, row.k as isize - cz];
                        if !self.mask.is_solid(behind[0], behind[1], behind[2]) {
                            continue;
                        }
                        let Some((link, direction)) = links.next() else {
                            return parts;
                        };
                        debug_assert_eq!(usize::from(*direction), i);
                        let exchanged = self.storage.get(link.ghost) + self.storage.get(link.home);
                        let c = Vec3::new(cx as f64, cy as f64, cz as f64);
                        let halfway = self.grid.position(x, row.j, row.k) - c * (0.5 * self.grid.spacing);
                        let part = walls.probe(self.grid.domain().wrap(halfway), t).part as usize;
                        if part >= parts.len() {
                            parts.resize(part + 1, Wrench::zero());
                        }
                        let force = c * (-exchanged * scale);
                        parts[part].force += force;
                        parts[part].torque += self.grid.domain().shortest(halfway - about).cross(&force);
                    }
                }
            }
        }
        parts
    }
}
