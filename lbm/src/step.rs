//! One time step of the populations, row by row.

use crate::collide::{FREE, PER_NODE, Places, Span, UNIFORM};
use crate::drive::Balance;
use crate::element::{Element, Half, Precision};
use crate::isa::InstructionSet;
use crate::kernel::Kernel;
use crate::links::{Link, Links, Row, RowLinks};
use crate::simd::MAX_LANES;
use crate::stencil::MAX_Q;
use crate::storage::Storage;
use crate::thermal::Thermal;
use lbm_ibm_coupling::{BRICK_EDGE, BRICK_NODES, Bricks, Inside, Noise};
use std::ops::Range;

/// Most nodes whose forces are gathered at a time.
const SEGMENT: usize = 16 * BRICK_EDGE;
/// Room for them and for what a vector reads beyond them.
const GATHERED: usize = SEGMENT + MAX_LANES;

/// Forces of the nodes of a stretch.
pub type Forces = [[f64; GATHERED]; 3];

/// All that a row needs to take a step.
pub struct Step<'a> {
    pub storage: &'a Storage,
    pub links: &'a Links,
    pub kernel: &'a dyn Kernel,
    /// What it was compiled for.
    pub isa: InstructionSet,
    /// Nodes inside of cells with a viscosity of their own, and the kernels of their levels from 1 on.
    pub inside: &'a Inside,
    pub levels: &'a [Box<dyn Kernel>],
    pub bricks: &'a Bricks,
    /// Lattice units of force, per N.
    pub force_scale: f64,
    /// Uniform force, lattice units.
    pub uniform: [f64; 3],
    /// Whether the balance of momentum is wanted.
    pub tally: bool,
    /// Fluctuations, and the noise of this step.
    pub thermal: Option<(&'a Thermal, Noise)>,
}

/// A run, and what will be collided after it: the places of its row, and its first node.
#[derive(Clone, Copy)]
pub struct Work<'a> {
    pub kernel: &'a dyn Kernel,
    pub places: &'a Places,
    pub next: (&'a Places, usize),
}

/// Places of the run at work and of the one after it.
pub struct Ahead {
    places: [Places; 2],
    /// Which of the two comes next.
    next: usize,
    /// What that is: a run, in an odd step or not.
    run: Option<(usize, bool)>,
}

impl Ahead {
    pub fn new() -> Self {
        Self {
            places: [[std::ptr::null_mut(); MAX_Q]; 2],
            next: 0,
            run: None,
        }
    }
}

impl Step<'_> {
    /// Collides and streams rows from number `first` on, one for each of `balances`; `odd` says whether populations are in
    /// the neighbours.
    ///
    /// # Safety
    /// No two threads may work on the same row, and nothing else may touch the populations meanwhile. Every place is
    /// used by one row alone: see [`crate::links`].
    pub unsafe fn rows(&self, first: usize, balances: &mut [Balance], odd: bool) {
        let mut ahead = Ahead::new();
        for (n, balance) in balances.iter_mut().enumerate() {
            // Behind the last row there is nothing to fetch; the row itself does no harm.
            let next = (first + n + 1).min(self.links.rows.len() - 1);
            // SAFETY: as for this function.
            *balance = unsafe { self.row(first + n, odd, (next, odd), &mut ahead) };
        }
    }

    /// Collides and streams one row; `next` is likely to come after it, in an odd step or not.
    ///
    /// # Safety
    /// As for [`Step::rows`].
    #[inline]
    pub unsafe fn row(&self, row: usize, odd: bool, next: (usize, bool), ahead: &mut Ahead) -> Balance {
        let (row, links) = (&self.links.rows[row], &self.links.row_links[row]);
        let mut balance = Balance::default();
        let [j, k] = row.at();
        let (touched, inside) = (self.is_touched(row), self.inside.row(j, k));
        let (runs, next) = (row.runs(), (self.links.rows[next.0].runs().start, next.1));
        for run in runs.clone() {
            let next = if run + 1 < runs.end { (run + 1, odd) } else { next };
            let work = self.look_ahead((run, odd), next, ahead);
            // SAFETY: the places of this run are ours.
            unsafe { self.part(row, &self.links.run(run), touched, inside, work, &mut balance) };
        }
        // SAFETY: ghosts and homes of this row are ours.
        unsafe {
            match self.storage.precision() {
                Precision::F64 => self.pass_links::<f64>(links, odd, &mut balance),
                Precision::F32 => self.pass_links::<f32>(links, odd, &mut balance),
                Precision::F16 => self.pass_links::<Half>(links, odd, &mut balance),
            }
        }
        balance
    }

    /// Whether bodies touch a row.
    pub fn is_touched(&self, row: &Row) -> bool {
        !self.bricks.is_empty() && (0..self.bricks.counts()[0]).any(|b| self.slot(b, row).is_some())
    }

    /// Collides nodes of a run; `inside` are those of the row that are in cells, and their levels.
    ///
    /// # Safety
    /// The places are those of the row, and nobody else touches those of these nodes.
    #[inline(always)]
    pub unsafe fn part(
        &self,
        row: &Row,
        run: &Range<usize>,
        touched: bool,
        inside: ([usize; 2], &[u16]),
        work: Work,
        balance: &mut Balance,
    ) {
        let places = work.places;
        // SAFETY: the places of this run are the caller's.
        unsafe {
            if run.start < inside.0[1] && inside.0[0] < run.end {
                self.run_of_levels(row, run, inside, touched, work, balance);
            } else {
                self.run(row, run, touched, work, balance);
            }
        }
        if let Some((thermal, noise)) = &self.thermal {
            let at = row.at();
            // SAFETY: the places of this run are the caller's, and its nodes have collided.
            unsafe {
                match self.storage.precision() {
                    Precision::F64 => thermal.agitate::<f64>(noise, places, at, run.clone()),
                    Precision::F32 => thermal.agitate::<f32>(noise, places, at, run.clone()),
                    Precision::F16 => thermal.agitate::<Half>(noise, places, at, run.clone()),
                }
            }
        }
    }

    /// A run, with the one that is likely to come after it, each in an odd step or not.
    #[inline]
    fn look_ahead<'a>(&'a self, run: (usize, bool), after: (usize, bool), ahead: &'a mut Ahead) -> Work<'a> {
        let here = ahead.next;
        if ahead.run != Some(run) {
            self.links.pointers(run.0, run.1, self.storage, &mut ahead.places[here]);
        }
        self.links
            .pointers(after.0, after.1, self.storage, &mut ahead.places[1 - here]);
        ahead.next = 1 - here;
        ahead.run = Some(after);
        Work {
            kernel: self.kernel,
            places: &ahead.places[here],
            next: (&ahead.places[1 - here], self.links.run(after.0).start),
        }
    }

    /// Divides a run that passes cells into stretches of the same level.
    #[inline(never)]
    unsafe fn run_of_levels<'a>(
        &'a self,
        row: &Row,
        run: &Range<usize>,
        ([from, to], levels): ([usize; 2], &[u16]),
        touched: bool,
        mut work: Work<'a>,
        balance: &mut Balance,
    ) {
        let level = |x: usize| if (from..to).contains(&x) { levels[x - from] } else { 0 };
        let after = work.next;
        let mut x = run.start;
        while x < run.end {
            let here = level(x);
            let end = if x >= to {
                run.end
            } else {
                (x + 1..run.end).find(|&x| level(x) != here).unwrap_or(run.end)
            };
            work.kernel = match here {
                0 => self.kernel,
                n => &*self.levels[usize::from(n) - 1],
            };
            work.next = if end < run.end { (work.places, end) } else { after };
            // SAFETY: the places of this run are ours.
            unsafe { self.run(row, &(x..end), touched, work, balance) };
            x = end;
        }
    }

    /// Collides nodes of one level.
    #[inline(always)]
    unsafe fn run(&self, row: &Row, run: &Range<usize>, touched: bool, work: Work, balance: &mut Balance) {
        // SAFETY: the places of this run are the caller's.
        unsafe {
            if touched {
                self.touched_run(row, run, work, balance);
            } else {
                self.span(run.clone(), &work, None, balance);
            }
        }
    }

    /// The slot of a brick of which bodies touch this row.
    fn slot(&self, brick: usize, row: &Row) -> Option<usize> {
        let [j, k] = row.at();
        let slot = self.bricks.slot([brick, j / BRICK_EDGE, k / BRICK_EDGE])?;
        let bit = k % BRICK_EDGE * BRICK_EDGE + j % BRICK_EDGE;
        (self.bricks.rows(slot) >> bit & 1 == 1).then_some(slot)
    }

    /// Divides a run into stretches in bricks and stretches beside them.
    #[inline(never)]
    unsafe fn touched_run(&self, row: &Row, run: &Range<usize>, mut work: Work, balance: &mut Balance) {
        let (mut force, after) = ([[0.0; GATHERED]; 3], work.next);
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
            work.next = if x < run.end { (work.places, x) } else { after };
            let gathered = in_brick.then(|| {
                self.gather(row, &part, &mut force, balance);
                &force
            });
            // SAFETY: the places of this run are ours.
            unsafe { self.span(part, &work, gathered, balance) };
        }
    }

    /// Forces of the nodes `part` of a row, lattice units.
    fn gather(&self, row: &Row, part: &Range<usize>, force: &mut Forces, balance: &mut Balance) {
        let [j, k] = row.at().map(|n| n % BRICK_EDGE);
        let within = (k * BRICK_EDGE + j) * BRICK_EDGE;
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
    ///
    /// # Safety
    /// As for [`Step::part`], with room for a vector behind the forces.
    #[inline(always)]
    pub unsafe fn span(&self, part: Range<usize>, work: &Work, force: Option<&Forces>, balance: &mut Balance) {
        let kind = match force {
            Some(_) => PER_NODE,
            None if self.uniform == [0.0; 3] => FREE,
            None => UNIFORM,
        };
        let span = Span {
            places: work.places,
            start: part.start,
            len: part.len(),
            next: work.next,
            uniform: self.uniform,
            force: force.map_or([std::ptr::null(); 3], |f| [f[0].as_ptr(), f[1].as_ptr(), f[2].as_ptr()]),
        };
        // SAFETY: the places are those of nodes of this row, the gathered forces are as many as the nodes with room for a
        // vector, and the kernel was built for this processor and precision.
        let momentum = unsafe { work.kernel.collide(&span, kind, self.tally) };
        for a in 0..3 {
            balance.momentum[a] += momentum[a];
        }
    }

    /// Home to ghost after an even step, ghost to home after an odd one.
    unsafe fn pass_links<S: Element>(&self, row: &RowLinks, odd: bool, balance: &mut Balance) {
        let data = self.storage.data().cast::<S>();
        let ends = |link: &Link| {
            if odd {
                (link.ghost, link.home)
            } else {
                (link.home, link.ghost)
            }
        };
        let walls = &self.links.walls[row.walls.clone()];
        let pushes = self.links.pushes.get(row.walls.clone());
        let wraps = if odd {
            &self.links.wraps_in[row.wraps_in.clone()]
        } else {
            &self.links.wraps_out[row.wraps_out.clone()]
        };
        for link in walls.iter().chain(wraps) {
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
            let velocities = self.storage.velocities();
            for (link, direction) in walls.iter().zip(&self.links.directions[row.walls.clone()]) {
                // SAFETY: both places belong to this row.
                let exchanged = unsafe { (*data.add(link.ghost)).get() + (*data.add(link.home)).get() };
                for a in 0..3 {
                    balance.walls[a] += f64::from(velocities.c(usize::from(*direction))[a]) * exchanged;
                }
            }
        }
    }
}
