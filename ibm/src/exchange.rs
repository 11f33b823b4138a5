//! [`DeltaExchange`], the exchange by delta kernels.

mod gaps;
mod limit;
mod options;

use self::limit::with_slip;
use crate::forcing::Forcing;
use crate::inset::Inset;
use crate::kernel::Kernel;
use crate::placement::Placement;
use crate::slip::{Slip, Viscosities};
use crate::stability::{inertial_step, node_radius, stable_step};
use crate::subdivision::{Subdivision, edges, longest_edge};
use crate::surface::{Markers, Surface};
use crate::table::{Scratch, Table};
use crate::transfer::{self, Node};
use lbm_ibm_coupling::{
    BodyInfo, Bricks, Exchange, ExchangeError, Grid, ImmersedBody, Motion, RigidState, Soa3, Soa3Mut, Soa3Ref,
    StateError, StateReader, StateWriter,
};
use std::ops::Range;

/// Exchange of velocity and force by a [`Kernel`] on markers.
///
/// Velocity is interpolated to the markers, `u_m = sum_n delta(x_m - x_n) u_n`, and averaged over the patch of each
/// node; forces take the transposed path, so that power and total force are kept: `sum_j F_j U_j = sum_n f_n u_n`.
///
/// At a face of the grid that is not periodic, nodes of a stencil beyond the face are at rest and their share of the
/// force goes to the wall.
///
/// ```
/// use lbm_ibm_coupling::{Bricks, Exchange, Grid, Soa3, Vec3};
/// use lbm_ibm_ibm::{DeltaExchange, Kernel};
/// # use lbm_ibm_coupling::{BodyInfo, Motion};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let x: Soa3 = [Vec3::new(2e-6, 3e-6, 4e-6)].into_iter().collect();
/// # let body = BodyInfo {
/// #     id: 0, kind: "bead".into(), range: 0..1, triangles: [].into(), motion: Motion::Advected,
/// # };
/// let grid = Grid::new([16, 16, 16], 0.5e-6, [true; 3]);
/// let mut bricks = Bricks::new(&grid);
/// let mut exchange = DeltaExchange::new(Kernel::RomaThree);
/// exchange.set_bodies(&[body], x.view(), &grid)?;
/// exchange.place(x.view(), &mut bricks)?;
/// bricks.velocity_mut()[0].fill(1e-3); // the fluid's part
/// let mut velocity = Soa3::zeros(x.len());
/// exchange.interpolate(&bricks, velocity.view_mut());
/// assert!((velocity.x[0] - 1e-3).abs() < 1e-15);
/// exchange.spread(velocity.view(), &mut bricks);
/// # Ok(()) }
/// ```
#[derive(Clone, Debug)]
pub struct DeltaExchange {
    kernel: Kernel,
    markers: Markers,
    inset: bool,
    elastic_inset: Option<Inset>,
    elastic_slip: Option<Slip>,
    /// Of the fluid, Pa s.
    viscosity: f64,
    /// Bodies with another one inside, and their viscosity over that of the fluid.
    inside: Vec<(u32, f64)>,
    grid: Option<Grid>,
    nodes: usize,
    surfaces: Vec<Surface>,
    table: Table,
    /// Bodies have come, gone or been divided since the table was made.
    table_is_old: bool,
    placement: Placement,
    tiles: transfer::Scratch,
    velocity: Vec<[f64; 3]>,
    scratch: Scratch,
    rigid: Forcing,
}

impl DeltaExchange {
    /// An exchange with markers on surfaces, at most a grid spacing apart.
    pub fn new(kernel: Kernel) -> Self {
        Self {
            kernel,
            markers: Markers::default(),
            inset: true,
            elastic_inset: None,
            elastic_slip: None,
            viscosity: f64::INFINITY,
            inside: Vec::new(),
            grid: None,
            nodes: 0,
            surfaces: Vec::new(),
            table: Table::default(),
            table_is_old: false,
            placement: Placement::default(),
            tiles: transfer::Scratch::default(),
            velocity: Vec::new(),
            scratch: Scratch::default(),
            rigid: Forcing::default(),
        }
    }

    fn rebuild_table(&mut self) {
        let bodies = self.surfaces.iter().map(|s| (s.range.clone(), &s.subdivision));
        self.table = Table::new(self.nodes, bodies);
        self.table_is_old = false;
    }
}

/// Number of the body that owns a marker.
fn owner(surfaces: &[Surface], marker: usize) -> u32 {
    let mut first = 0;
    for s in surfaces {
        first += s.subdivision.len();
        if marker < first {
            return s.id;
        }
    }
    0
}

fn part<'a>(x: Soa3Ref<'a>, range: &Range<usize>) -> Soa3Ref<'a> {
    Soa3Ref {
        x: &x.x[range.clone()],
        y: &x.y[range.clone()],
        z: &x.z[range.clone()],
    }
}

impl Exchange for DeltaExchange {
    fn set_bodies(&mut self, bodies: &[BodyInfo], reference: Soa3Ref<'_>, grid: &Grid) -> Result<(), ExchangeError> {
        let support = self.kernel.support();
        if let Some(axis) = (0..3).find(|&a| grid.periodic[a] && grid.shape[a] < support) {
            return Err(ExchangeError::GridTooSmall {
                axis,
                nodes: grid.shape[axis],
                support,
            });
        }
        let nodes = reference.len();
        let mut old = std::mem::take(&mut self.surfaces);
        if self.grid.as_ref().is_some_and(|g| g.spacing != grid.spacing) {
            old.clear();
        }
        // Both lists are in ascending order of the numbers.
        let mut old = old.into_iter().peekable();
        for body in bodies {
            while old.next_if(|s| s.id < body.id).is_some() {}
            if let Some(mut kept) = old.next_if(|s| s.id == body.id) {
                kept.range = body.range.clone();
                self.surfaces.push(kept);
                continue;
            }
            let reference: Soa3 = part(reference, &body.range).iter().collect();
            // Rigid bodies meet the fluid at markers of their own.
            let rigid = body.motion == Motion::Rigid;
            let edges = if rigid { Vec::new() } else { edges(&body.triangles) };
            let longest = longest_edge(reference.view(), &edges).0;
            let division = self.markers.division_at_rest(longest, grid.spacing);
            let mut surface = Surface {
                id: body.id,
                range: body.range.clone(),
                triangles: body.triangles.clone(),
                reference,
                edges,
                division: 1,
                subdivision: Subdivision::default(),
            };
            if !rigid {
                surface.divide(division);
            }
            self.surfaces.push(surface);
        }
        self.grid = Some(grid.clone());
        self.nodes = nodes;
        self.placement = Placement::default();
        self.table_is_old = true;
        if let Some(inset) = &mut self.elastic_inset {
            let depth = self.kernel.hydrodynamic_shift() * grid.spacing;
            inset.set_bodies(&self.surfaces, nodes, depth);
        }
        if let Some(slip) = &mut self.elastic_slip {
            let viscosities = Viscosities {
                around: self.viscosity,
                inside: &self.inside,
            };
            slip.set_bodies(bodies, nodes, self.kernel, grid.spacing, viscosities)?;
        }
        Ok(())
    }

    fn set_viscosity(&mut self, viscosity: f64, inside: &[(u32, f64)]) {
        self.viscosity = viscosity;
        self.inside = inside.to_vec();
    }

    fn place(&mut self, x: Soa3Ref<'_>, bricks: &mut Bricks) -> Result<(), ExchangeError> {
        let Some(grid) = self.grid.take() else {
            bricks.commit();
            return Ok(());
        };
        let closed = self.close_gaps(x, grid.spacing);
        if self.table_is_old {
            self.rebuild_table();
        }
        let placed = closed.and_then(|()| {
            let x = match (&mut self.elastic_inset, &mut self.elastic_slip) {
                (Some(inset), _) => inset.place(x)?,
                (None, Some(slip)) => slip.place(x)?,
                (None, None) => x,
            };
            let support = self.kernel.support();
            self.placement
                .place(&self.table, x, &grid, support, bricks)
                .map_err(|(marker, position)| ExchangeError::OutsideGrid {
                    body: owner(&self.surfaces, marker),
                    position: position.into(),
                })
        });
        self.grid = Some(grid);
        placed
    }

    fn interpolate(&mut self, bricks: &Bricks, velocity: Soa3Mut<'_>) {
        let p = &self.placement;
        if self.table_is_old || p.rank.len() != self.table.len() {
            // Not placed since the bodies changed: nothing is in the fluid yet.
            for out in [velocity.x, velocity.y, velocity.z] {
                out.fill(0.0);
            }
            return;
        }
        self.velocity.resize(p.placed.len(), [0.0; 3]);
        let (tiles, u) = (&mut self.tiles, &mut self.velocity);
        let field = bricks.velocity();
        transfer::interpolate_by(self.kernel, p, field, tiles, u);
        let (rank, u) = (&p.rank, &self.velocity);
        let out = [&mut *velocity.x, &mut *velocity.y, &mut *velocity.z];
        self.table.to_nodes(|m| u[rank[m] as usize], out, &mut self.scratch);
        let Soa3Mut { x, y, z } = velocity;
        if let Some(inset) = &self.elastic_inset {
            inset.carry(Soa3Mut {
                x: &mut *x,
                y: &mut *y,
                z: &mut *z,
            });
        }
        if let Some(slip) = &mut self.elastic_slip {
            slip.carry(Soa3Mut { x, y, z });
        }
    }

    fn spread(&mut self, force: Soa3Ref<'_>, bricks: &mut Bricks) {
        let p = &self.placement;
        if self.table_is_old || p.rank.len() != self.table.len() {
            return;
        }
        let (table, tiles) = (&self.table, &mut self.tiles);
        let force = match (&mut self.elastic_inset, &mut self.elastic_slip) {
            (Some(inset), _) => inset.spread(force),
            (None, Some(slip)) => slip.spread(force),
            (None, None) => force,
        };
        let field = bricks.force_mut();
        if table.is_plain() {
            let f = |m: usize| Node([force.x[m], force.y[m], force.z[m], 0.0]);
            return transfer::spread_by(self.kernel, p, f, tiles, field);
        }
        let nodes = table.to_markers(force, &mut self.scratch);
        transfer::spread_by(self.kernel, p, |m| table.marker_force(m, nodes), tiles, field);
    }

    fn set_rigid(&mut self, bodies: &[(u32, &dyn ImmersedBody)], grid: &Grid) -> Result<(), ExchangeError> {
        self.rigid.set_bodies(bodies, grid, self.kernel, self.inset)
    }

    fn place_rigid(&mut self, bodies: &[RigidState], bricks: &mut Bricks) -> Result<(), ExchangeError> {
        let Some(grid) = &self.grid else { return Ok(()) };
        self.rigid.place(bodies, grid, self.kernel, bricks)
    }

    fn hold_rigid(
        &mut self,
        bodies: &mut [RigidState],
        density: f64,
        viscosity: f64,
        time_step: f64,
        bricks: &mut Bricks,
    ) -> Result<(), ExchangeError> {
        self.rigid
            .hold(bodies, [density, viscosity], time_step, self.kernel, bricks);
        Ok(())
    }

    fn save(&self, to: &mut StateWriter) {
        self.surfaces.iter().for_each(|s| to.count(s.division as u64));
        self.rigid.save(to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        for surface in &mut self.surfaces {
            let division = from.count()? as usize;
            if division != surface.division {
                surface.divide(division);
                self.table_is_old = true;
            }
        }
        self.rigid.restore(from)
    }

    fn rigid_layer(&self, body: u32, density: f64) -> f64 {
        self.rigid.layer(body, density)
    }

    /// The least of the limits of its terms, less a margin. The viscous one is `2 / lambda`, `lambda` the largest eigenvalue of
    /// mobility times stiffness by power iteration; the mobility of nodes carried by the fluid is that of Rotne, Prager and
    /// Yamakawa, for spheres as mobile as the markers of a node; that of the others is one over their friction. In steps beyond
    /// `rho h^2/(6 mu)`, a relaxation time of one, a lattice no longer takes viscosity into account within a step: then the fluid
    /// is asked for no more than its mass within the reach of the kernel, `dt^2 = 2 / lambda`, `lambda` the largest eigenvalue of `J S K/(rho h^3)`.
    /// What nodes slip adds to the motion in both. The inertial one is `2 / omega`, `omega` the frequency at which the body breathes with the mass of fluid that its nodes
    /// move within a step: their share of the surface times the thickness of the kernel, `h / sum phi^2`. It binds where a
    /// volume law is stiffer than the fluid is compressible.
    fn stable_step(&self, body: &mut dyn ImmersedBody, x: Soa3Ref<'_>, viscosity: f64, density: f64) -> Option<f64> {
        if body.motion() == Motion::Rigid {
            return None;
        }
        let grid = self.grid.as_ref()?;
        let spacing = grid.spacing;
        let edges = edges(body.triangles());
        let division = self.markers.division_at_rest(longest_edge(x, &edges).0, spacing);
        let markers = Subdivision::of_surface(body.reference(), body.triangles(), &edges, division);
        let table = Table::new(x.len(), std::iter::once((0..x.len(), &markers)));
        let radius = node_radius(&table, x, self.kernel.marker_radius() * spacing);
        let probe = 1e-5 * spacing;
        let slip = self.slip_step(body, x, probe);
        let mut carried = stable_step(body, x, radius, viscosity, probe).map(|step| with_slip(step, slip, 0.0));
        let implicit = density * spacing * spacing / (6.0 * viscosity);
        if body.motion() == Motion::Advected && carried.is_some_and(|step| step > implicit) {
            let on_grid = self.step_on_grid(body, x, density, grid, probe);
            let on_grid = on_grid.map(|step| with_slip(f64::INFINITY, slip, 1.0 / (step * step)).max(implicit));
            carried = [carried, on_grid].into_iter().flatten().reduce(f64::min);
        }
        let layer = density * spacing / self.kernel.sum_of_squares();
        [carried, inertial_step(body, x, layer, probe)]
            .into_iter()
            .flatten()
            .reduce(f64::min)
    }
}
