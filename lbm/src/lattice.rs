//! The fluid as its neighbours see it.

use crate::drive::{Balance, Drive};
use crate::fluid::Fluid;
use crate::interpolate::{Interpolate, thin_balance};
use crate::links::{Links, Row};
use crate::mask::Mask;
use crate::parallel;
use crate::simd::prefetch;
use crate::step::Step;
use lbm_ibm_coupling::{
    BRICK_EDGE, BRICK_NODES, Boundary, Bricks, FluidError, Grid, Lattice, Macroscopic, Vec3, WallReport, Work, Wrench,
    on_widest,
};
use std::sync::Arc;

/// With fewer nodes a step is over before a second thread has woken up.
const FEW_NODES: usize = 8192;
/// Fraction of the mass that interpolated links have gained which they give back in a step.
const PAYBACK: f64 = 1.0 / 256.0;
/// Rows that a thread takes at a time.
const PIECE: usize = 16;

impl Lattice for Fluid {
    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn time_step(&self) -> f64 {
        self.time_step
    }

    fn viscosity(&self) -> f64 {
        self.viscosity
    }

    fn density(&self) -> f64 {
        self.density
    }

    fn set_walls(&mut self, walls: Option<Arc<dyn Boundary>>, t: f64) -> Result<WallReport, FluidError> {
        let walls = walls.as_deref();
        let mut mask = Mask::new(&self.grid, walls, t)?;
        let filled_nodes = if self.fill_narrow {
            mask.fill_narrow(&self.grid, walls, t)?
        } else {
            0
        };
        let narrowest = mask.narrowest(&self.grid, walls, t)?;
        self.replace_mask(mask, walls, t);
        Ok(WallReport {
            fluid_nodes: self.mask.fluid_nodes,
            solid_nodes: self.grid.len() - self.mask.fluid_nodes,
            wall_links: self.links.walls.len(),
            narrowest,
            filled_nodes,
            uninterpolated_links: self.links.uninterpolated,
            thin_links: self.links.thin.len(),
            closed_gaps: self.links.closed_gaps,
        })
    }

    fn read_velocity(&mut self, bricks: &mut Bricks) {
        let mut slots = std::mem::take(&mut self.slots);
        slots.clear();
        slots.extend((0..bricks.len()).map(|s| (bricks.brick(s), bricks.rows(s))));
        let (velocity, force) = bricks.velocity_mut_and_force();
        let fluid = &*self;
        parallel::for_each_chunk(&slots, velocity, BRICK_NODES, |slot, brick, to| {
            let force = [0, 1, 2].map(|a| &force[a][slot * BRICK_NODES..][..BRICK_NODES]);
            on_widest(ReadBrick {
                fluid,
                brick: brick.0,
                rows: brick.1,
                force,
                to,
            });
        });
        self.slots = slots;
    }

    fn advance(&mut self, bricks: &Bricks) -> Result<(), FluidError> {
        self.at_rest = false;
        for force in &mut self.force {
            force[0] = force[1];
        }
        let step = Step {
            storage: &self.storage,
            links: &self.links,
            kernels: &self.kernels,
            coefficients: &self.coefficients,
            bricks,
            force_scale: self.force_scale(),
            uniform: self.force.map(|f| f[0]),
            odd: self.odd,
            tally: self.drive.is_flux(),
        };
        let few = self.mask.fluid_nodes < FEW_NODES;
        parallel::for_pieces(few, &mut self.balances, PIECE, |first, balances| {
            // SAFETY: each row is worked on once, and `self` is exclusive.
            unsafe { step.rows(first, balances) }
        });
        self.interpolate();
        self.odd = !self.odd;
        self.steps += 1;
        self.balance(bricks)
    }

    /// The force density of the last step; under flux control it follows the drag on walls and bodies at that instant.
    fn body_force(&self) -> Vec3 {
        let unit = self.density * self.grid.spacing / self.time_step.powi(2);
        Vec3::from(self.force.map(|f| f[0])) * unit
    }

    fn superficial_velocity(&self) -> Vec3 {
        let flow = self.flow.unwrap_or_else(|| {
            let momentum = self.momentum();
            let nodes = self.mask.fluid_nodes as f64;
            let half = |a: usize| 0.5 * (nodes * self.force[a][0] + self.bodies[a]);
            std::array::from_fn(|a| (momentum[a] + half(a)) / self.grid.len() as f64)
        });
        Vec3::from(flow) * self.velocity_unit()
    }

    fn wall_loads(&self, walls: &dyn Boundary, t: f64, about: Vec3) -> Option<Vec<Wrench>> {
        Some(self.momentum_exchange(walls, t, about))
    }

    fn check(&self) -> Result<(), FluidError> {
        parallel::find_map_first(&self.links.rows, |row| self.check_row(row)).map_or(Ok(()), Err)
    }

    fn macroscopic(&self) -> Option<Macroscopic> {
        let [nx, ny, _] = self.grid.shape;
        let mut all = Macroscopic {
            velocity: std::array::from_fn(|_| vec![0.0; self.grid.len()]),
            pressure: vec![0.0; self.grid.len()],
            solid: vec![1; self.grid.len()],
        };
        let unit = self.velocity_unit();
        for row in &self.links.rows {
            for run in &self.links.runs[row.runs.clone()] {
                let start = (row.k * ny + row.j) * nx + run.start;
                let range = start..start + run.len();
                let [x, y, z] = all.velocity.each_mut().map(|v| &mut v[range.clone()]);
                let pressure = &mut all.pressure[range.clone()];
                self.moments(row.j, row.k, run.clone(), [pressure, x, y, z]);
                for p in &mut all.pressure[range.clone()] {
                    *p *= self.density * unit * unit / 3.0;
                }
                for a in 0..3 {
                    for v in &mut all.velocity[a][range.clone()] {
                        *v = (*v + 0.5 * self.force[a][0]) * unit;
                    }
                }
                all.solid[range].fill(0);
            }
        }
        Some(all)
    }
}

impl Fluid {
    /// Sends populations back from walls that are not half way or thinner than a cell.
    fn interpolate(&mut self) {
        let Links { cuts, thin, .. } = &self.links;
        if cuts.is_empty() && thin.is_empty() {
            return;
        }
        // Averaged over two steps, or it would feed what changes sign in every step.
        let owed = 0.5 * (self.owed[0] + self.owed[1]);
        let shrink = if self.links.swell > 0.0 {
            PAYBACK * owed / self.links.swell
        } else {
            0.0
        };
        let interpolate = Interpolate {
            storage: &self.storage,
            links: &self.links,
            odd: self.odd,
            shrink,
        };
        parallel::for_pieces(cuts.len() < FEW_NODES, &mut self.balances, PIECE, |first, balances| {
            // SAFETY: all rows are done, each is worked on once, and `self` is exclusive.
            unsafe { interpolate.rows(first, balances) }
        });
        parallel::for_pieces(
            thin.len() < FEW_NODES,
            &mut self.exchanged,
            FEW_NODES,
            |first, exchanged| {
                // SAFETY: as above, of walls.
                unsafe { interpolate.thin(first, exchanged) }
            },
        );
        let gained = self.balances.iter().map(|b| b.gained).sum::<f64>();
        let gained = gained + thin_balance(thin, &self.exchanged).gained;
        self.owed = [self.owed[0] + gained, self.owed[0]];
    }

    /// Sums what the rows have noted, in their order, and finds the force of the next step.
    fn balance(&mut self, bricks: &Bricks) -> Result<(), FluidError> {
        self.bodies = [0.0; 3];
        self.flow = None;
        if bricks.is_empty() && !self.drive.is_flux() {
            return Ok(());
        }
        let mut sum = Balance::default();
        for balance in &self.balances {
            sum.add(balance);
        }
        sum.add(&thin_balance(&self.links.thin, &self.exchanged));
        self.bodies = sum.bodies;
        let Drive::Flux(target) = self.drive else { return Ok(()) };
        let (nodes, all) = (self.mask.fluid_nodes as f64, self.grid.len() as f64);
        let mut flow = [0.0; 3];
        for a in 0..3 {
            let drive = self.force[a][0] * nodes;
            flow[a] = (sum.after(a, drive) + 0.5 * (drive + sum.bodies[a])) / all;
            if let Some(velocity) = target[a] {
                let target = velocity / self.velocity_unit() * all;
                self.force[a][1] = sum.next_drive(a, drive, target) / nodes;
            }
        }
        self.flow = Some(flow);
        if flow.iter().all(|v| v.is_finite()) {
            Ok(())
        } else {
            self.check()
        }
    }

    fn check_row(&self, row: &Row) -> Option<FluidError> {
        const PIECE: usize = 64;
        let runs = &self.links.runs[row.runs.clone()];
        let pieces = runs.iter().flat_map(|run| {
            run.clone()
                .step_by(PIECE)
                .map(|start| start..(start + PIECE).min(run.end))
        });
        let mut moments = [[0.0; PIECE]; 4];
        for run in pieces {
            self.moments(
                row.j,
                row.k,
                run.clone(),
                moments.each_mut().map(|m| &mut m[..run.len()]),
            );
            for i in 0..run.len() {
                let [density, x, y, z] = [0, 1, 2, 3].map(|m| moments[m][i]);
                let mach = (3.0 * (x * x + y * y + z * z)).sqrt();
                let what = if !density.is_finite() || !mach.is_finite() {
                    "its populations are not finite".to_string()
                } else if mach > self.mach_limit {
                    format!("its Mach number is {mach:.3}, the limit is {}", self.mach_limit)
                } else {
                    continue;
                };
                return Some(FluidError::Diverged {
                    node: [run.start + i, row.j, row.k],
                    step: self.steps,
                    what,
                });
            }
        }
        None
    }
}

/// The velocity of the rows of a brick that are in use.
struct ReadBrick<'a> {
    fluid: &'a Fluid,
    brick: [usize; 3],
    rows: u64,
    force: [&'a [f64]; 3],
    to: [&'a mut [f64]; 3],
}

impl ReadBrick<'_> {
    /// Row of the grid that a row of the brick is.
    #[inline(always)]
    fn row(&self, bit: usize) -> (usize, usize) {
        let [_, y, z] = self.brick.map(|b| b * BRICK_EDGE);
        (y + bit % BRICK_EDGE, z + bit / BRICK_EDGE)
    }

    /// The next row that is in use and in the grid.
    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let [_, ny, nz] = self.fluid.grid.shape;
        while self.rows != 0 {
            let bit = self.rows.trailing_zeros() as usize;
            self.rows &= self.rows - 1;
            let (j, k) = self.row(bit);
            if j < ny && k < nz {
                return Some(bit);
            }
        }
        None
    }
}

impl Work for ReadBrick<'_> {
    type Out = ();

    #[inline(always)]
    fn run(mut self) {
        let fluid = self.fluid;
        let x = self.brick[0] * BRICK_EDGE;
        let end = (x + BRICK_EDGE).min(fluid.grid.shape[0]);
        let (unit, scale) = (fluid.velocity_unit(), fluid.force_scale());
        let mut moments = [[0.0; BRICK_EDGE]; 4];
        let mut ahead = [self.next(), self.next()];
        while let Some(bit) = ahead[0] {
            // Rows are short and far apart, so that the processor would not fetch the next ones by itself.
            ahead = [ahead[1], self.next()];
            if let Some((j, k)) = ahead[1].map(|bit| self.row(bit)) {
                for p in fluid.storage.places(j, k, fluid.odd) {
                    prefetch(p.wrapping_add(x));
                    prefetch(p.wrapping_add(x + BRICK_EDGE - 1));
                }
            }
            let (j, k) = self.row(bit);
            fluid.moments(j, k, x..end, moments.each_mut().map(|m| m.as_mut_slice()));
            let mut fluid_node = [0.0; BRICK_EDGE];
            for (f, solid) in fluid_node.iter_mut().zip(&fluid.mask.row(j, k)[x..end]) {
                *f = if *solid { 0.0 } else { unit };
            }
            let at = bit * BRICK_EDGE..(bit + 1) * BRICK_EDGE;
            for a in 0..3 {
                let force = &self.force[a][at.clone()];
                let to = &mut self.to[a][at.clone()];
                for i in 0..BRICK_EDGE {
                    let half = 0.5 * (force[i] * scale + fluid.force[a][0]);
                    to[i] = (moments[a + 1][i] + half) * fluid_node[i];
                }
            }
        }
    }
}
