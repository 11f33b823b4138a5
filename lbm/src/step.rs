//! One time step of the populations, row by row.

use crate::collide::{FREE, PER_NODE, Span, UNIFORM};
use crate::drive::Balance;
use crate::element::{Element, Half, Precision};
use crate::kernel::Kernel;
use crate::links::{Link, Links, Row};
use crate::simd::MAX_LANES;
use crate::storage::{Places, Storage};
use crate::thermal::Thermal;
use lbm_ibm_coupling::{BRICK_EDGE, BRICK_NODES, Bricks, Noise};
use std::ops::Range;

/// Most nodes whose forces are gathered at a time.
const SEGMENT: usize = 16 * BRICK_EDGE;
/// Room for them and for what a vector reads beyond them.
const GATHERED: usize = SEGMENT + MAX_LANES;

/// All that a row needs to take a step.
pub struct Step<'a> {
    pub storage: &'a Storage,
    pub links: &'a Links,
    pub kernel: &'a dyn Kernel,
    pub bricks: &'a Bricks,
    /// Lattice units of force, per N.
    pub force_scale: f64,
    /// Uniform force, lattice units.
    pub uniform: [f64; 3],
    /// Whether populations are in the neighbours.
    pub odd: bool,
    /// Whether the balance of momentum is wanted.
    pub tally: bool,
    /// Fluctuations, and the noise of this step.
    pub thermal: Option<(&'a Thermal, Noise)>,
}

/// Places of node 0 of a row, and the number of a node.
type Next<'a> = (&'a Places, usize);

impl Step<'_> {
    /// Collides and streams rows from number `first` on, one for each of `balances`.
    ///
    /// # Safety
    /// No two threads may work on the same row, and nothing else may touch the populations meanwhile. Every place is
    /// used by one row alone: see [`crate::links`].
    pub unsafe fn rows(&self, first: usize, balances: &mut [Balance]) {
        let rows = &self.links.rows[first..];
        let places_of = |row: &Row| self.storage.places(row.j, row.k, self.odd);
        let mut places = places_of(&rows[0]);
        for (n, balance) in balances.iter_mut().enumerate() {
            let row = &rows[n];
            // Behind the last row there is nothing to fetch; the row itself does no harm.
            let next = rows.get(n + 1).unwrap_or(row);
            let next_places = places_of(next);
            // SAFETY: as for this function.
            *balance = unsafe { self.row(row, &places, (&next_places, self.links.runs[next.runs.start].start)) };
            places = next_places;
        }
    }

    unsafe fn row(&self, row: &Row, places: &Places, next_row: Next) -> Balance {
        let mut balance = Balance::default();
        let touched = !self.bricks.is_empty() && (0..self.bricks.counts()[0]).any(|b| self.slot(b, row).is_some());
        let runs = &self.links.runs[row.runs.clone()];
        for (n, run) in runs.iter().enumerate() {
            let next = runs.get(n + 1).map_or(next_row, |run| (places, run.start));
            if touched {
                // SAFETY: the places of this run are ours.
                unsafe { self.touched_run(row, run, places, next, &mut balance) };
            } else {
                // SAFETY: the places of this run are ours.
                unsafe { self.span(run.clone(), places, next, None, &mut balance) };
            }
        }
        if let Some((thermal, noise)) = &self.thermal {
            for run in runs {
                // SAFETY: the places of this run are ours.
                unsafe { thermal.agitate(self.storage, noise, places, [row.j, row.k], run.clone()) };
            }
        }
        // SAFETY: ghosts and homes of this row are ours.
        unsafe {
            match self.storage.precision() {
                Precision::F64 => self.pass_links::<f64>(row, &mut balance),
                Precision::F32 => self.pass_links::<f32>(row, &mut balance),
                Precision::F16 => self.pass_links::<Half>(row, &mut balance),
            }
        }
        balance
    }

    fn slot(&self, brick: usize, row: &Row) -> Option<usize> {
        self.bricks.slot([brick, row.j / BRICK_EDGE, row.k / BRICK_EDGE])
    }

    /// Divides a run into stretches in bricks and stretches beside them.
    #[inline(never)]
    unsafe fn touched_run(&self, row: &Row, run: &Range<usize>, places: &Places, next: Next, balance: &mut Balance) {
        let mut force = [[0.0; GATHERED]; 3];
        let mut x = run.start;
        while x < run.end {
            let in_brick = self.slot(x / BRICK_EDGE, row).is_some();
            let mut end = (x / BRICK_EDGE + 1) * BRICK_EDGE;
            while end < run.end
                && self.slot(end / BRICK_EDGE, row).is_some() == in_brick
                && (!in_brick || end + BRICK_EDGE - x <= SEGMENT)
            {
                end += BRICK_EDGE;
            }
            let part = x..end.min(run.end);
            x = part.end;
            let next = if x < run.end { (places, x) } else { next };
            let gathered = in_brick.then(|| {
                self.gather(row, &part, &mut force, balance);
                &force
            });
            // SAFETY: the places of this run are ours.
            unsafe { self.span(part, places, next, gathered, balance) };
        }
    }

    /// Forces of the nodes `part` of a row, lattice units.
    fn gather(&self, row: &Row, part: &Range<usize>, force: &mut [[f64; GATHERED]; 3], balance: &mut Balance) {
        let within = (row.k % BRICK_EDGE * BRICK_EDGE + row.j % BRICK_EDGE) * BRICK_EDGE;
        // One sum for each place in a brick, so that no addition waits for the one before.
        let mut sums = [[0.0; BRICK_EDGE]; 3];
        let mut x = part.start;
        while x < part.end {
            let end = ((x / BRICK_EDGE + 1) * BRICK_EDGE).min(part.end);
            let Some(slot) = self.slot(x / BRICK_EDGE, row) else {
                return;
            };
            let from = slot * BRICK_NODES + within + x % BRICK_EDGE;
            for a in 0..3 {
                let source = &self.bricks.force()[a][from..][..end - x];
                let target = &mut force[a][x - part.start..][..end - x];
                for ((to, f), sum) in target.iter_mut().zip(source).zip(&mut sums[a]) {
                    let f = f * self.force_scale;
                    *sum += f;
                    *to = f + self.uniform[a];
                }
            }
            x = end;
        }
        for a in 0..3 {
            balance.bodies[a] += sums[a].iter().sum::<f64>();
        }
    }

    /// Collides the nodes `part`, with the force on each if there is one.
    #[inline(always)]
    unsafe fn span(
        &self,
        part: Range<usize>,
        places: &Places,
        next: Next,
        force: Option<&[[f64; GATHERED]; 3]>,
        balance: &mut Balance,
    ) {
        let kind = match force {
            Some(_) => PER_NODE,
            None if self.uniform == [0.0; 3] => FREE,
            None => UNIFORM,
        };
        let span = Span {
            data: self.storage.data(),
            places,
            start: part.start,
            len: part.len(),
            next: (next.0, next.1),
            uniform: self.uniform,
            force: force.map_or([std::ptr::null(); 3], |f| [f[0].as_ptr(), f[1].as_ptr(), f[2].as_ptr()]),
        };
        // SAFETY: the places are those of nodes of this row, the gathered forces are as many as the nodes with room for a
        // vector, and the kernel was built for this processor and precision.
        let momentum = unsafe { self.kernel.collide(&span, kind, self.tally) };
        for a in 0..3 {
            balance.momentum[a] += momentum[a];
        }
    }

    /// Home to ghost after an even step, ghost to home after an odd one.
    unsafe fn pass_links<S: Element>(&self, row: &Row, balance: &mut Balance) {
        let data = self.storage.data().cast::<S>();
        let velocities = self.storage.velocities();
        let ends = |link: &Link| {
            if self.odd {
                (link.ghost, link.home)
            } else {
                (link.home, link.ghost)
            }
        };
        let walls = &self.links.walls[row.walls.clone()];
        let pushes = self.links.pushes.get(row.walls.clone());
        let wraps = if self.odd {
            &self.links.wraps_in[row.wraps_in.clone()]
        } else {
            &self.links.wraps_out[row.wraps_out.clone()]
        };
        for link in walls {
            let (from, to) = ends(link);
            // SAFETY: both places belong to this row.
            unsafe { *data.add(to) = *data.add(from) };
        }
        for (link, push) in walls.iter().zip(pushes.unwrap_or_default()) {
            let (_, to) = ends(link);
            // SAFETY: the place belongs to this row.
            unsafe { *data.add(to) = S::near((*data.add(to)).get() + push) };
        }
        if self.tally {
            for (link, direction) in walls.iter().zip(&self.links.directions[row.walls.clone()]) {
                let (from, to) = ends(link);
                // SAFETY: both places belong to this row.
                let exchanged = unsafe { (*data.add(from)).get() + (*data.add(to)).get() };
                for a in 0..3 {
                    balance.walls[a] += f64::from(velocities.c(usize::from(*direction))[a]) * exchanged;
                }
            }
        }
        for link in wraps {
            let (from, to) = ends(link);
            // SAFETY: both places belong to this row.
            unsafe { *data.add(to) = *data.add(from) };
        }
    }
}
