//! Beads in their surroundings: what every way of moving them shares.

use super::contact::{ContactLaw, Contacts};
use super::drag::WallDrag;
use super::flow::Flow;
use super::mobility::{Mobility, MobilityLaw, PairMobility};
use crate::bead::Bead;
use crate::error::{MagneticsError, positive};
use crate::model::{Model, Problem, Solution};
use crate::source::FieldSource;
use lbm_ibm_coupling::{Boundary, CellList, Domain, Soa3, Soa3Ref, Vec3};
use std::sync::Arc;

/// Beads, the field, the fluid and the walls around them: what [`Overdamped`](crate::Overdamped),
/// [`Newton`](crate::Newton), [`Brownian`](crate::Brownian) and [`QuasiStatic`](crate::QuasiStatic) move.
pub struct BeadSystem {
    pub(super) beads: Vec<Bead>,
    pub(super) frozen: Vec<bool>,
    pub(super) x: Soa3,
    pub(super) source: Arc<dyn FieldSource>,
    pub(super) model: Box<dyn Model>,
    pub(super) flow: Flow,
    pub(super) walls: Option<Arc<dyn Boundary>>,
    pub(super) gravity: Vec3,
    pub(super) density: f64,
    pub(super) contact: ContactLaw,
    pub(super) mobility: MobilityLaw,
    pub(super) solution: Solution,
    pub(super) contacts: Contacts,
    cells: CellList,
}

/// Forces and velocities of beads at one place and time, before contact.
#[derive(Default)]
pub(super) struct Stage {
    pub x: Soa3,
    pub time: f64,
    pub force: Soa3,
    pub velocity: Soa3,
    pub mobility: Mobility,
}

impl BeadSystem {
    /// Beads at `x` (m) in the field of `source` in a fluid of `viscosity` (Pa s) at rest, without walls and weight.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the viscosity, [`MagneticsError::Count`], [`MagneticsError::NotFinite`],
    /// [`MagneticsError::Overlap`] for beads that overlap at the start.
    pub fn new(
        beads: Vec<Bead>,
        x: Soa3,
        source: impl FieldSource + 'static,
        model: impl Model + 'static,
        viscosity: f64,
    ) -> Result<Self, MagneticsError> {
        positive("viscosity (Pa s)", viscosity)?;
        let smallest = beads.iter().map(Bead::radius).fold(f64::INFINITY, f64::min);
        Problem::new(&beads, x.view(), &source, 0.0)?.check_overlap(1e-9 * smallest)?;
        Ok(Self {
            frozen: vec![false; beads.len()],
            beads,
            x,
            source: Arc::new(source),
            model: Box::new(model),
            flow: Flow::at_rest(),
            walls: None,
            gravity: Vec3::zeros(),
            density: 1000.0,
            contact: ContactLaw::default(),
            mobility: MobilityLaw {
                viscosity,
                pair: PairMobility::None,
                wall: WallDrag::Brenner,
                roughness: 1e-3,
            },
            solution: Solution::new(),
            contacts: Contacts::default(),
            cells: CellList::new(),
        })
    }

    /// The flow that carries the beads.
    pub fn with_flow(mut self, flow: Flow) -> Self {
        self.flow = flow;
        self
    }

    /// Walls, for drag and contact. Of several walls the nearest one sets the drag; contact finds the others too where they
    /// are within a bead's radius of its surface.
    pub fn with_walls(mut self, walls: Arc<dyn Boundary>) -> Self {
        self.walls = Some(walls);
        self
    }

    /// Gravity (m/s2) in a fluid of `density` (kg/m3): weight less buoyancy.
    pub fn with_gravity(mut self, gravity: Vec3, density: f64) -> Self {
        (self.gravity, self.density) = (gravity, density);
        self
    }

    /// What keeps beads apart; by default a constraint with friction.
    pub fn with_contact(mut self, contact: impl Into<ContactLaw>) -> Self {
        self.contact = contact.into();
        self
    }

    /// Lets beads drag each other along.
    pub fn with_pair_mobility(mut self, mobility: PairMobility) -> Self {
        self.mobility.pair = mobility;
        self
    }

    /// Which drag beads have towards a wall (default [`WallDrag::Brenner`]).
    pub fn with_wall_drag(mut self, drag: WallDrag) -> Self {
        self.mobility.wall = drag;
        self
    }

    /// Gap to a wall or to another bead, in radii, below which drag grows no more (default 1e-3).
    pub fn with_roughness(mut self, roughness: f64) -> Self {
        self.mobility.roughness = roughness;
        self
    }

    /// Holds these beads where they are: soft-magnetic pillars, the feet of chains. Numbers beyond the last bead are ignored.
    pub fn with_frozen(mut self, beads: impl IntoIterator<Item = usize>) -> Self {
        for bead in beads {
            self.freeze(bead);
        }
        self
    }

    pub(super) fn freeze(&mut self, bead: usize) {
        if let Some(frozen) = self.frozen.get_mut(bead) {
            *frozen = true;
        }
    }

    /// Centres, m.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.x.view()
    }

    /// The beads.
    pub fn beads(&self) -> &[Bead] {
        &self.beads
    }

    /// Which beads are held.
    pub fn frozen(&self) -> &[bool] {
        &self.frozen
    }

    pub(super) fn smallest_radius(&self) -> f64 {
        self.beads.iter().map(Bead::radius).fold(f64::INFINITY, f64::min)
    }

    /// Tells of the first bead that stands in a wall.
    pub(super) fn check_walls(&self, time: f64) -> Result<(), MagneticsError> {
        let Some(walls) = &self.walls else { return Ok(()) };
        for (bead, b) in self.beads.iter().enumerate() {
            let probe = walls.probe(self.x.get(bead), time);
            let depth = b.radius() - probe.distance;
            if depth > 1e-6 * b.radius() && !self.frozen[bead] {
                return Err(MagneticsError::WallOverlap {
                    bead,
                    part: probe.part,
                    depth,
                });
            }
        }
        Ok(())
    }

    /// Magnetic force, weight less buoyancy and repulsion (N) on beads at `x`.
    pub(super) fn forces(&mut self, x: &Soa3, t: f64) -> Result<Soa3, MagneticsError> {
        let source = self.source.clone();
        let problem = Problem::new(&self.beads, x.view(), &source, t)?;
        self.model.solve(&problem, &mut self.solution)?;
        let mut force = self.solution.force.clone();
        for (i, bead) in self.beads.iter().enumerate() {
            force.add(i, bead.buoyant_weight(self.density, self.gravity));
        }
        if let ContactLaw::Repulsion(law) = self.contact {
            let push = |gap: f64| law.strength * (-gap / law.range).min(30.0).exp();
            self.for_close_pairs(x, 30.0 * law.range, |i, j, r, gap| {
                let f = r * (push(gap) / r.norm());
                force.add(i, f);
                force.add(j, -f);
            });
            if let Some(walls) = &self.walls {
                for (i, bead) in self.beads.iter().enumerate() {
                    let probe = walls.probe(x.get(i), t);
                    force.add(i, probe.normal * push(probe.distance - bead.radius()));
                }
            }
        }
        Ok(force)
    }

    /// Calls `pair(i, j, x_i - x_j, gap)` for all pairs with gaps below `reach` (m) whose centres differ.
    pub(super) fn for_close_pairs(&mut self, x: &Soa3, reach: f64, mut pair: impl FnMut(usize, usize, Vec3, f64)) {
        if x.len() < 2 {
            return;
        }
        let largest = self.beads.iter().map(Bead::radius).fold(0.0, f64::max);
        self.cells.build(x.view(), &Domain::unbounded(), 2.0 * largest + reach);
        let beads = &self.beads;
        self.cells.for_each_pair(|i, j| {
            let r = x.get(i) - x.get(j);
            let distance = r.norm();
            let gap = distance - beads[i].radius() - beads[j].radius();
            if gap < reach && distance > 0.0 {
                pair(i, j, r, gap);
            }
        });
    }

    /// Forces, mobility and the velocities that they give, contact apart.
    pub(super) fn stage(&mut self, x: Soa3, time: f64) -> Result<Stage, MagneticsError> {
        let force = self.forces(&x, time)?;
        let walls = self.walls.as_deref();
        let mobility = self.mobility.build(&self.beads, &self.frozen, &x, time, walls)?;
        let mut velocity = Soa3::zeros(x.len());
        mobility.add(&force, &mut velocity);
        self.add_flow(&x, time, &mut velocity);
        Ok(Stage {
            x,
            time,
            force,
            velocity,
            mobility,
        })
    }

    fn add_flow(&self, x: &Soa3, time: f64, velocity: &mut Soa3) {
        for i in (0..x.len()).filter(|i| !self.frozen[*i]) {
            velocity.add(i, self.flow.velocity(x.get(i), time));
        }
    }
}
