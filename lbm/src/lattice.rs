//! The fluid as its neighbours see it.

use crate::drive::{Balance, Drive};
use crate::fluid::Fluid;
use crate::interpolate::{Interpolate, thin_balance};
use crate::links::{Links, Row};
use crate::mask::{Mask, NarrowGaps};
use crate::parallel;
use crate::reading::ReadBricks;
use crate::step::Step;
use crate::sweep::Sweep;
use lbm_ibm_coupling::{
    BRICK_NODES, Boundary, Bricks, FluidError, Grid, Inside, Lattice, Macroscopic, Noise, Vec3, WallReport, Wrench,
    on_widest,
};
use std::sync::Arc;

/// With fewer nodes a step is over before a second thread has woken up.
pub const FEW_NODES: usize = 8192;
/// Fraction of the mass that interpolated links have gained which they give back in a step.
pub const PAYBACK: f64 = 1.0 / 256.0;
/// Numbers of steps that a sweep may take.
const SWEEPS: [usize; 5] = [8, 6, 4, 3, 2];
/// Rows, or batches of packed nodes, that a thread takes at a time.
pub const PIECE: usize = 16;
/// Slots of bricks that a thread reads at a time.
const SLOTS: usize = 8;

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
        let shared = walls;
        let walls = shared.as_deref();
        let mut mask = Mask::new(&self.grid, walls, t)?.with_walled(self.faces.walled());
        let filled_nodes = match self.narrow {
            NarrowGaps::Filled => mask.fill_narrow(&self.grid, walls, t)?,
            NarrowGaps::Refused | NarrowGaps::Kept => 0,
        };
        let narrowest = mask.narrowest(&self.grid, walls, t, self.narrow)?;
        self.walls = (shared, t);
        self.replace_mask(mask);
        if let Some(fault) = self.links.openings.fault_without_balance() {
            return Err(FluidError::Other(Box::new(fault)));
        }
        Ok(WallReport {
            fluid_nodes: self.mask.fluid_nodes,
            solid_nodes: self.grid.len() - self.mask.fluid_nodes,
            wall_links: self.links.wall_links() - self.links.openings.links.len(),
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
        parallel::for_slots(&slots, velocity, SLOTS, |first, slots, to| {
            let force = [0, 1, 2].map(|a| &force[a][first * BRICK_NODES..][..slots.len() * BRICK_NODES]);
            on_widest(ReadBricks {
                fluid,
                slots,
                force,
                to,
            });
        });
        self.slots = slots;
    }

    fn advance(&mut self, bricks: &Bricks) -> Result<(), FluidError> {
        self.start_step();
        self.read_faces()?;
        self.collide(bricks);
        // SAFETY: all rows are done, and `self` is exclusive.
        unsafe { self.links.openings.write(&self.storage, self.odd) };
        self.interpolate();
        self.odd = !self.odd;
        self.steps += 1;
        self.balance(bricks)
    }

    /// Without bodies, under a given force and with walls that are half way between nodes, several steps are taken in one
    /// sweep over the memory: see [`Fluid::advance_by`].
    fn advance_many(&mut self, bricks: &Bricks, steps: usize) -> Result<(), FluidError> {
        let mut left = steps;
        while left > 0 {
            let now = self.sweep_steps(bricks, left);
            if now > 1 {
                self.sweep(bricks, now);
            } else {
                self.advance(bricks)?;
            }
            left -= now;
        }
        Ok(())
    }

    fn set_inside(&mut self, inside: &Inside) -> Result<(), FluidError> {
        self.take_inside(inside)
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

    /// Populations, parity, forces and counters; not the grid, the walls and the parameters, which the fluid that takes the
    /// state has to be built with. A run that goes on from it is the same to the last bit.
    fn save(&self) -> Option<Vec<u8>> {
        Some(self.state())
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), FluidError> {
        self.restore_state(state)
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
            let [j, k] = row.at();
            for run in row.runs() {
                let nodes = self.links.run(run);
                let start = (k * ny + j) * nx + nodes.start;
                let range = start..start + nodes.len();
                let [x, y, z] = all.velocity.each_mut().map(|v| &mut v[range.clone()]);
                let pressure = &mut all.pressure[range.clone()];
                self.moments(run, nodes, [pressure, x, y, z]);
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
    /// Takes several steps without bodies. Where the flow is driven by a force and walls are half way between nodes, up to
    /// eight steps go in one sweep over the memory, which is faster where the populations are larger than the caches; the
    /// result is the same to the last bit.
    ///
    /// # Errors
    /// [`FluidError::Diverged`] where the fluid notices.
    pub fn advance_by(&mut self, steps: usize) -> Result<(), FluidError> {
        let bricks = Bricks::new(&self.grid);
        self.advance_many(&bricks, steps)
    }

    /// The force of the next step becomes that of this one.
    fn start_step(&mut self) {
        self.at_rest = false;
        for force in &mut self.force {
            force[0] = force[1];
        }
    }

    pub(crate) fn step<'a>(&'a self, bricks: &'a Bricks) -> Step<'a> {
        Step {
            storage: &self.storage,
            links: &self.links,
            kernel: &*self.kernel,
            isa: self.isa,
            inside: &self.inner.inside,
            levels: &self.inner.kernels,
            bricks,
            force_scale: self.force_scale(),
            uniform: self.force.map(|f| f[0]),
            tally: self.drive.is_flux(),
            thermal: self.thermal.as_ref().map(|t| (t, Noise::new(t.seed, self.steps))),
        }
    }

    /// Steps that the next sweep can take, `most` at most.
    fn sweep_steps(&self, bricks: &Bricks, most: usize) -> usize {
        let simple = bricks.is_empty()
            && self.inner.inside.is_empty()
            && !self.drive.is_flux()
            && self.thermal.is_none()
            && self.links.cuts.is_empty()
            && !self.links.marks.interpolate()
            && self.links.thin.is_empty()
            && self.links.openings.links.is_empty()
            && self.links.openings.fault.is_none()
            && self.mask.fluid_nodes >= FEW_NODES;
        let [_, ny, nz] = self.grid.shape;
        let fits = |steps: &usize| *steps <= most && Sweep::fits([ny, nz], *steps);
        if simple {
            SWEEPS.into_iter().find(fits).unwrap_or(1)
        } else {
            1
        }
    }

    /// Several steps in one sweep.
    fn sweep(&mut self, bricks: &Bricks, steps: usize) {
        self.start_step();
        let [_, py, pz] = self.grid.periodic;
        let [_, ny, nz] = self.grid.shape;
        let populations = self.storage.velocities().q() * self.storage.precision().bytes();
        let sweep = Sweep {
            step: self.step(bricks),
            odd: self.odd,
            steps,
            shape: [ny, nz],
            periodic: [py, pz],
            row_bytes: self.mask.fluid_nodes.div_ceil(self.links.rows.len()) * populations,
        };
        // SAFETY: `self` is exclusive, and `sweep_steps` has asked for the rest.
        unsafe { sweep.run() };
        self.odd ^= steps % 2 == 1;
        self.steps += steps as u64;
        self.bodies = [0.0; 3];
        self.flow = None;
    }

    /// Sends populations back from walls that are not half way or thinner than a cell.
    fn interpolate(&mut self) {
        let Links { cuts, thin, marks, .. } = &self.links;
        if cuts.is_empty() && thin.is_empty() && marks.is_empty() {
            return;
        }
        let mut more = std::mem::take(&mut self.more);
        let pass = self.pass(self.odd);
        parallel::for_pieces(more.len() < FEW_NODES, &mut more, FEW_NODES, |first, more| {
            // SAFETY: all nodes are done, and nothing is written.
            unsafe { self.links.marks.find(pass, first, more) }
        });
        let (odd, shrink) = (pass.odd, pass.shrink);
        self.more = more;
        let Links { cuts, thin, .. } = &self.links;
        let interpolate = Interpolate {
            storage: &self.storage,
            links: &self.links,
            odd,
            shrink,
        };
        if self.links.packed.is_none() {
            parallel::for_pieces(cuts.len() < FEW_NODES, &mut self.balances, PIECE, |first, balances| {
                // SAFETY: all rows are done, each is worked on once, and `self` is exclusive.
                unsafe { interpolate.rows(first, balances) }
            });
        }
        parallel::for_pieces(
            thin.len() < FEW_NODES,
            &mut self.exchanged,
            FEW_NODES,
            |first, exchanged| {
                // SAFETY: as above, of walls.
                unsafe { interpolate.thin(first, exchanged) }
            },
        );
        if !self.more.is_empty() {
            self.add_marks(0..self.balances.len());
        }
        let gained = self.balances.iter().map(|b| b.gained).sum::<f64>();
        let gained = gained + thin_balance(&self.links.thin, &self.exchanged, self.storage.velocities()).gained;
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
        sum.add(&thin_balance(
            &self.links.thin,
            &self.exchanged,
            self.storage.velocities(),
        ));
        let faces = self.links.openings.momentum(self.storage.velocities());
        (0..3).for_each(|a| sum.walls[a] += faces[a]);
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
        let [j, k] = row.at();
        let pieces = row.runs().flat_map(|run| {
            let nodes = self.links.run(run);
            let end = nodes.end;
            nodes
                .step_by(PIECE)
                .map(move |start| (run, start..(start + PIECE).min(end)))
        });
        let mut moments = [[0.0; PIECE]; 4];
        for (run, nodes) in pieces {
            self.moments(run, nodes.clone(), moments.each_mut().map(|m| m.as_mut_slice()));
            for i in 0..nodes.len() {
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
                    node: [nodes.start + i, j, k],
                    step: self.steps,
                    what,
                });
            }
        }
        None
    }
}
