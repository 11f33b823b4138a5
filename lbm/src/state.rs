//! Setting up and reading the populations.

use crate::collide::{Places, Span};
use crate::element::Precision;
use crate::ferry::{Buffer, Load};
use crate::fluid::Fluid;
use crate::kernel::Kernel;
use crate::maker::Maker;
use crate::mask::Mask;
use crate::packed::Packed;
use crate::stencil::{MAX_Q, Velocities, opposite};
use crate::storage::Storage;
use crate::surface::Surface;
use lbm_ibm_coupling::Vec3;
use std::ops::Range;

/// Nodes are packed from so many links along the axes into walls on, per node: in a tube of less than 23 nodes or a slit of less
/// than 9.
const WALLED: f64 = 0.22;

/// Whether nodes are better packed, as far as that depends on how they lie.
pub fn pays_to_pack(mask: &Mask, velocities: Velocities) -> bool {
    let walled = mask.wall_faces() as f64 / mask.fluid_nodes as f64;
    walled > WALLED && Storage::packs(mask.fluid_nodes, velocities)
}

/// Populations of a node.
type Populations = [f64; MAX_Q];

impl Fluid {
    /// Builds rows and links for the mask as it is.
    pub(crate) fn link(&mut self) {
        let surface = self.surface();
        let maker = Maker {
            tau: self.tau,
            density: self.density,
            mach_limit: self.mach_limit,
            ..Maker::new(surface, &self.mask, &self.storage, &*self.wall_rule, &self.faces)
        };
        self.links = maker.links();
        self.balances = vec![Default::default(); self.links.pieces()];
        self.more = vec![0.0; self.links.marks.kept()];
        self.slab = self.slab_size();
        self.shrink = 0.0;
        self.exchanged = vec![Default::default(); self.links.thin.len()];
        self.owed = [0.0; 2];
        self.flow = None;
    }

    /// The walls as links meet them.
    pub(crate) fn surface(&self) -> Surface<'_> {
        Surface {
            grid: &self.grid,
            walls: self.walls.0.as_deref(),
            t: self.walls.1,
            velocity_unit: self.velocity_unit(),
            velocities: self.storage.velocities(),
        }
    }

    /// Sets every fluid node from a velocity and its gradient (`[a][b]` = d u_b / d x_a) at a position, lattice units.
    pub(crate) fn populate(&mut self, field: impl Fn(Vec3) -> ([f64; 3], [[f64; 3]; 3])) {
        self.storage.clear();
        self.odd = false;
        self.at_rest = false;
        self.owed = [0.0; 2];
        self.flow = None;
        for row in &self.links.rows {
            let [j, k] = row.at();
            for x in self.links.nodes(row) {
                let (u, gradient) = field(self.grid.position(x, j, k));
                let momentum = std::array::from_fn(|a| u[a] - 0.5 * self.force[a][1]);
                for i in 0..self.storage.velocities().q() {
                    let population = self.population(i, u, momentum, &gradient);
                    // SAFETY: the node is in the grid, and `self` is exclusive.
                    unsafe {
                        self.storage
                            .write(self.storage.index(i, x as isize, j as isize, k as isize), population)
                    };
                }
            }
        }
    }

    /// Equilibrium less the weight, and `-3 w_i tau (c c - 1/3) : grad u`.
    fn population(&self, i: usize, u: [f64; 3], momentum: [f64; 3], gradient: &[[f64; 3]; 3]) -> f64 {
        let velocities = self.storage.velocities();
        let (weight, c) = (velocities.weight(i), velocities.c(i).map(f64::from));
        let (mut shear, mut divergence) = (0.0, 0.0);
        for a in 0..3 {
            divergence += gradient[a][a];
            for b in 0..3 {
                shear += c[a] * c[b] * gradient[a][b];
            }
        }
        let (cu, uu) = (velocities.along(i, u), u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        let second = if self.inertia { 4.5 * cu * cu - 1.5 * uu } else { 0.0 };
        weight * (3.0 * velocities.along(i, momentum) + second - 3.0 * self.tau * (shear - divergence / 3.0))
    }

    /// Takes a new mask; nodes that stay in the fluid keep their populations, others start at rest.
    pub(crate) fn replace_mask(&mut self, mask: Mask) {
        let kept = self.populations();
        self.mask = mask;
        self.renew(self.storage.velocities(), self.storage.precision(), &kept);
    }

    /// Builds rows and links anew where faces have changed, and takes other memory where packed nodes cannot have such faces.
    pub(crate) fn relink(&mut self) {
        if self.storage.is_packed() && self.faces.any_open() {
            let kept = self.populations();
            self.renew(self.storage.velocities(), self.storage.precision(), &kept);
        } else {
            self.link();
        }
    }

    /// Takes another kernel; the populations are kept if they are of the same stencil, else the fluid is at rest.
    pub(crate) fn set_kernel(&mut self, kernel: Box<dyn Kernel>, precision: Precision) {
        let velocities = kernel.velocities();
        self.kernel = kernel;
        self.forget_inside();
        let same = velocities == self.storage.velocities();
        if same && precision == self.storage.precision() {
            return;
        }
        self.at_rest |= !same;
        let kept = self.populations();
        self.renew(velocities, precision, &kept);
    }

    /// Takes new memory for the mask as it is, and sets the populations of nodes that are in the fluid; others are at rest.
    fn renew(&mut self, velocities: Velocities, precision: Precision, kept: &[([usize; 3], Populations)]) {
        let packed = !self.faces.any_open() && pays_to_pack(&self.mask, velocities);
        self.storage = Storage::new(&self.grid, &self.mask, velocities, precision, packed);
        self.odd = false;
        self.link();
        for ([x, j, k], populations) in kept {
            if self.mask.is_solid(*x as isize, *j as isize, *k as isize) {
                continue;
            }
            for i in 0..velocities.q() {
                let index = self.storage.index(i, *x as isize, *j as isize, *k as isize);
                // SAFETY: the node is in the fluid, and `self` is exclusive.
                unsafe { self.storage.write(index, populations[i]) };
            }
        }
    }

    /// All nodes with their populations; none if the fluid is at rest.
    fn populations(&self) -> Vec<([usize; 3], Populations)> {
        if self.at_rest {
            return Vec::new();
        }
        let mut kept = Vec::with_capacity(self.mask.fluid_nodes);
        for row in &self.links.rows {
            let [j, k] = row.at();
            for run in row.runs() {
                for x in self.links.run(run) {
                    let mut populations = [0.0; MAX_Q];
                    for i in 0..self.storage.velocities().q() {
                        // SAFETY: the node is in the grid, and nothing writes now.
                        populations[i] = unsafe { self.storage.read(self.incoming(run, i, x)) };
                    }
                    kept.push(([x, j, k], populations));
                }
            }
        }
        kept
    }

    /// Index of the incoming population `i` of node `x` of a run.
    pub(crate) fn incoming(&self, run: usize, i: usize, x: usize) -> usize {
        if let Some(packed) = &self.links.packed {
            let node = packed.starts[run] as usize + x - self.links.run(run).start;
            return match self.odd {
                true => packed.place(&self.storage, node, i),
                false => self.storage.arrays()[i] + node,
            };
        }
        let array = self.storage.arrays()[if self.odd { opposite(i) } else { i }];
        (array + x).wrapping_add_signed(self.links.places(run, self.odd)[i] as isize)
    }

    /// Density less 1 and momentum without force, lattice units, of the nodes `part` of a run, written to the start of
    /// `to`.
    pub(crate) fn moments(&self, run: usize, part: Range<usize>, to: [&mut [f64]; 4]) {
        let all = self.links.run(run);
        assert!(all.start <= part.start && part.end <= all.end && to.iter().all(|t| t.len() >= part.len()));
        let to = to.map(|t| t.as_mut_ptr());
        match &self.links.packed {
            Some(packed) if self.odd => {
                let first = packed.starts[run] as usize + (part.start - all.start);
                // SAFETY: as below.
                unsafe { self.packed_moments(packed, first..first + part.len(), to) }
            }
            _ => {
                let mut places = [std::ptr::null_mut(); MAX_Q];
                self.links.pointers(run, self.odd, &self.storage, &mut places);
                // SAFETY: the nodes are in the fluid, nothing writes to the populations now, and `to` has room.
                unsafe { self.read(&places, part, to) }
            }
        }
    }

    /// The moments of nodes at these places.
    ///
    /// # Safety
    /// The places are valid for the nodes, nothing writes there now, and `to` has room.
    pub(crate) unsafe fn read(&self, places: &Places, nodes: Range<usize>, to: [*mut f64; 4]) {
        let span = Span {
            places,
            start: nodes.start,
            len: nodes.len(),
            next: (places, nodes.start),
            uniform: [0.0; 3],
            force: [std::ptr::null(); 3],
        };
        // SAFETY: the caller's, and the kernel was chosen for this processor.
        unsafe { self.kernel.read(&span, to) }
    }

    /// The moments of packed nodes before an odd step.
    ///
    /// # Safety
    /// Nothing writes to the populations now, and `to` has room.
    unsafe fn packed_moments(&self, packed: &Packed, nodes: Range<usize>, to: [*mut f64; 4]) {
        let (size, mut buffer) = (packed.batch(), Buffer::new());
        for batch in nodes.start / size..nodes.end.div_ceil(size) {
            let part = nodes.start.max(batch * size)..nodes.end.min((batch + 1) * size);
            let to = to.map(|t| t.wrapping_add(part.start - nodes.start));
            // SAFETY: the caller's; the buffer holds these nodes.
            unsafe {
                let clip = packed.clip(batch, &part);
                let parts = packed.of(batch);
                parts.ferry::<false>(&self.storage, self.isa, Load::Some(&clip), &mut buffer);
                let places = packed.places(&self.storage, batch, &mut buffer);
                self.read(&places, part.start - batch * size..part.end - batch * size, to);
            }
        }
    }

    /// Sum of the momentum of all fluid nodes without force, lattice units.
    pub(crate) fn momentum(&self) -> [f64; 3] {
        let rows = crate::parallel::map(&self.links.rows, |row| {
            let mut sum = [0.0; 3];
            for run in row.runs() {
                let nodes = self.links.run(run);
                let mut moments: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; nodes.len()]);
                self.moments(run, nodes, moments.each_mut().map(|m| m.as_mut_slice()));
                for a in 0..3 {
                    sum[a] += moments[a + 1].iter().sum::<f64>();
                }
            }
            sum
        });
        rows.iter().fold([0.0; 3], |s, r| std::array::from_fn(|a| s[a] + r[a]))
    }
}
