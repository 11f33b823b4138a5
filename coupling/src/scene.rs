//! A fluid, bodies in it, walls around it and forces between them.

mod elastic;
mod inside;
mod limits;
mod motion;
mod report;
mod rigid;
mod save;
mod step;

pub use elastic::Elasticity;

use crate::guard::{Guard, RestShape, outside_walls};
use crate::{
    BodyInfo, Boundary, Bricks, Domain, Exchange, ForceField, ImmersedBody, Inside, Lattice, Loads, Motion, RigidState,
    SceneError, Soa3, Soa3Ref, View, WallReport,
};
use nalgebra::Isometry3;
use std::any::Any;
use std::sync::Arc;

/// Everything that takes part in a run, and its state. Positions in m, velocities in m/s, forces in N.
pub struct Scene {
    fluid: Option<Fluid>,
    domain: Domain,
    walls: Option<Arc<dyn Boundary>>,
    wall_report: Option<WallReport>,
    bodies: Vec<Slot>,
    infos: Vec<BodyInfo>,
    rigid: Vec<RigidState>,
    had_rigid: bool,
    fields: Vec<Box<dyn ForceField>>,
    /// Nodes of all bodies at rest, each about its own origin, m.
    reference: Soa3,
    x: Soa3,
    v: Soa3,
    fluid_velocity: Soa3,
    on_fluid: Soa3,
    loads: Loads,
    time: f64,
    time_step: f64,
    step: u64,
    next_id: u32,
    guard: Guard,
    elasticity: Elasticity,
    workspace: elastic::Workspace,
    ready: bool,
}

struct Fluid {
    lattice: Box<dyn Lattice>,
    exchange: Box<dyn Exchange>,
    bricks: Bricks,
    inside: Inside,
}

struct Slot {
    body: Box<dyn ImmersedBody>,
    rest: RestShape,
}

impl Scene {
    /// A scene with a fluid, and the exchange that joins it to bodies. The time step is the fluid's.
    pub fn with_fluid(lattice: impl Lattice, exchange: impl Exchange) -> Self {
        let time_step = lattice.time_step();
        let domain = lattice.grid().domain();
        let (bricks, inside) = (Bricks::new(lattice.grid()), Inside::new(lattice.grid()));
        let fluid = Fluid {
            lattice: Box::new(lattice),
            exchange: Box::new(exchange),
            bricks,
            inside,
        };
        Self::empty(Some(fluid), domain, time_step)
    }

    /// A scene without a fluid, stepped by `time_step` (s).
    ///
    /// # Errors
    /// [`SceneError::NotPositive`].
    pub fn without_fluid(time_step: f64) -> Result<Self, SceneError> {
        if !(time_step.is_finite() && time_step > 0.0) {
            return Err(SceneError::NotPositive {
                what: "the time step (s)",
                value: time_step,
            });
        }
        Ok(Self::empty(None, Domain::unbounded(), time_step))
    }

    fn empty(fluid: Option<Fluid>, domain: Domain, time_step: f64) -> Self {
        Self {
            fluid,
            domain,
            walls: None,
            wall_report: None,
            bodies: Vec::new(),
            infos: Vec::new(),
            rigid: Vec::new(),
            had_rigid: false,
            fields: Vec::new(),
            reference: Soa3::default(),
            x: Soa3::default(),
            v: Soa3::default(),
            fluid_velocity: Soa3::default(),
            on_fluid: Soa3::default(),
            loads: Loads::default(),
            time: 0.0,
            time_step,
            step: 0,
            next_id: 0,
            guard: Guard::default(),
            elasticity: Elasticity::default(),
            workspace: elastic::Workspace::default(),
            ready: false,
        }
    }

    /// Replaces what the guard allows.
    pub fn with_guard(mut self, guard: Guard) -> Self {
        self.guard = guard;
        self
    }

    /// Puts walls around fluid and bodies.
    ///
    /// # Errors
    /// What the fluid says of the walls, and [`SceneError::BodyInWall`].
    pub fn set_walls(&mut self, walls: Arc<dyn Boundary>) -> Result<WallReport, SceneError> {
        for (i, info) in self.infos.iter().enumerate() {
            outside_walls(info, self.nodes(i), walls.as_ref(), &self.domain, self.time, 0.0)?;
        }
        let report = match &mut self.fluid {
            Some(fluid) => fluid.lattice.set_walls(Some(walls.clone()), self.time)?,
            None => WallReport::default(),
        };
        self.walls = Some(walls);
        self.wall_report = Some(report.clone());
        Ok(report)
    }

    /// Puts a body into the scene under `pose` (m); returns its number.
    ///
    /// # Errors
    /// [`SceneError::BodyInWall`], [`SceneError::NeedsFluid`], [`SceneError::NoMass`], [`SceneError::Exchange`]; the scene
    /// is unchanged then.
    pub fn add_body(&mut self, body: impl ImmersedBody, pose: &Isometry3<f64>) -> Result<u32, SceneError> {
        let placed = rigid::placed(body.reference(), pose);
        let start = self.x.len();
        let info = BodyInfo {
            id: self.next_id,
            kind: body.kind().to_owned(),
            range: start..start + placed.len(),
            triangles: body.triangles().into(),
            motion: body.motion(),
        };
        if self.fluid.is_none() && matches!(info.motion, Motion::Advected | Motion::Newton { .. } | Motion::Rigid) {
            return Err(SceneError::NeedsFluid {
                body: info.id,
                kind: info.kind,
            });
        }
        if let Some(walls) = &self.walls {
            outside_walls(&info, placed.view(), walls.as_ref(), &self.domain, self.time, 0.0)?;
        }
        let rigid = match (info.motion, body.rigid()) {
            (Motion::Rigid, None) => {
                return Err(SceneError::NoMass {
                    body: info.id,
                    kind: info.kind,
                });
            }
            (Motion::Rigid, Some(rigid)) => Some(RigidState::new(info.id, self.infos.len(), rigid, *pose)),
            _ => None,
        };
        let rest = RestShape::of(body.reference(), body.triangles());
        for (p, reference) in placed.iter().zip(body.reference().iter()) {
            self.x.push(p);
            self.reference.push(reference);
        }
        self.rigid.extend(rigid);
        self.infos.push(info);
        self.bodies.push(Slot {
            body: Box::new(body),
            rest,
        });
        self.resize();
        if let Err(error) = self.tell_exchange() {
            self.infos.pop();
            self.bodies.pop();
            self.rigid.retain(|r| r.id != self.next_id);
            self.x.resize(start);
            self.reference.resize(start);
            self.resize();
            self.tell_exchange()?;
            return Err(error);
        }
        self.next_id += 1;
        Ok(self.next_id - 1)
    }

    /// Takes a body out of the scene; the numbers of the others stay.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn remove_body(&mut self, id: u32) -> Result<(), SceneError> {
        let at = self.index(id)?;
        let range = self.infos[at].range.clone();
        let excess = &mut self.workspace.excess;
        let arrays = [&mut self.x, &mut self.v, &mut self.fluid_velocity, &mut self.reference];
        for a in arrays.into_iter().chain([excess]) {
            a.x.drain(range.clone());
            a.y.drain(range.clone());
            a.z.drain(range.clone());
        }
        self.infos.remove(at);
        self.bodies.remove(at);
        self.rigid.retain(|r| r.id != id);
        self.number_rigid();
        for info in &mut self.infos[at..] {
            info.range = info.range.start - range.len()..info.range.end - range.len();
        }
        self.resize();
        // What was of the body behind is now of another one.
        self.on_fluid.fill(0.0);
        self.loads.clear();
        self.tell_exchange()
    }

    /// Adds a force between bodies, or between bodies and walls; returns its index for [`Scene::field`].
    pub fn add_field(&mut self, field: impl ForceField) -> usize {
        self.fields.push(Box::new(field));
        self.ready = false;
        self.fields.len() - 1
    }

    fn resize(&mut self) {
        let n = self.x.len();
        self.v.resize(n);
        self.fluid_velocity.resize(n);
        self.on_fluid.resize(n);
        self.workspace.excess.resize(n);
        self.loads.resize(n, self.infos.len());
        self.ready = false;
    }

    fn tell_exchange(&mut self) -> Result<(), SceneError> {
        let Some(fluid) = &mut self.fluid else {
            return Ok(());
        };
        let pairs = self.infos.iter().zip(&self.bodies);
        let inside: Vec<_> = pairs
            .filter_map(|(info, slot)| Some((info.id, slot.body.viscosity_ratio()?)))
            .collect();
        fluid.exchange.set_viscosity(fluid.lattice.viscosity(), &inside);
        fluid
            .exchange
            .set_bodies(&self.infos, self.reference.view(), fluid.lattice.grid())?;
        self.tell_rigid()
    }

    fn index(&self, id: u32) -> Result<usize, SceneError> {
        self.infos
            .iter()
            .position(|b| b.id == id)
            .ok_or(SceneError::UnknownBody {
                body: id,
                bodies: self.infos.len(),
            })
    }

    fn nodes(&self, index: usize) -> Soa3Ref<'_> {
        self.x.slice(self.infos[index].range.clone())
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Time step, s.
    pub fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Steps taken.
    pub fn steps(&self) -> u64 {
        self.step
    }

    /// The bodies.
    pub fn bodies(&self) -> &[BodyInfo] {
        &self.infos
    }

    /// The walls.
    pub fn walls(&self) -> Option<&Arc<dyn Boundary>> {
        self.walls.as_ref()
    }

    /// The box and its periods.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// The fluid.
    pub fn fluid(&self) -> Option<&dyn Lattice> {
        self.fluid.as_ref().map(|f| f.lattice.as_ref())
    }

    /// The fluid as the type that it is.
    pub fn fluid_as<T: Lattice>(&mut self) -> Option<&mut T> {
        let lattice: &mut dyn Any = self.fluid.as_mut()?.lattice.as_mut();
        lattice.downcast_mut()
    }

    /// A force field as the type that it is.
    pub fn field<T: ForceField>(&self, index: usize) -> Option<&T> {
        let field: &dyn Any = self.fields.get(index)?.as_ref();
        field.downcast_ref()
    }

    /// A force field as the type that it is, to change it.
    pub fn field_mut<T: ForceField>(&mut self, index: usize) -> Option<&mut T> {
        let field: &mut dyn Any = self.fields.get_mut(index)?.as_mut();
        field.downcast_mut()
    }

    /// A body as the type that it is.
    pub fn body_as<T: ImmersedBody>(&self, id: u32) -> Option<&T> {
        let body: &dyn Any = self.bodies[self.index(id).ok()?].body.as_ref();
        body.downcast_ref()
    }

    /// Node positions of all bodies, m, not wrapped.
    pub fn positions(&self) -> Soa3Ref<'_> {
        self.x.view()
    }

    /// Node positions of one body, m, not wrapped.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn body_positions(&self, id: u32) -> Result<Soa3Ref<'_>, SceneError> {
        Ok(self.nodes(self.index(id)?))
    }

    /// Puts the nodes of one body elsewhere: a deformed start, or a restart.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`], [`SceneError::WrongLength`]; [`SceneError::FollowsPose`] for a rigid body.
    pub fn set_body_positions(&mut self, id: u32, x: Soa3Ref<'_>) -> Result<(), SceneError> {
        let info = &self.infos[self.index(id)?];
        let range = info.range.clone();
        if x.len() != range.len() {
            return Err(SceneError::WrongLength {
                body: id,
                nodes: range.len(),
                given: x.len(),
            });
        }
        if info.motion == Motion::Rigid {
            return Err(SceneError::FollowsPose {
                body: id,
                kind: info.kind.clone(),
            });
        }
        for (i, p) in range.zip(x.iter()) {
            self.x.set(i, p);
        }
        Ok(())
    }

    /// Node velocities of all bodies in the last step, m/s.
    pub fn velocities(&self) -> Soa3Ref<'_> {
        self.v.view()
    }

    /// Velocity of the fluid at all nodes in the last step, m/s.
    pub fn fluid_velocities(&self) -> Soa3Ref<'_> {
        self.fluid_velocity.view()
    }

    /// Forces of the last step on nodes and walls.
    pub fn loads(&self) -> &Loads {
        &self.loads
    }
}

fn view_of<'a>(scene: &'a Scene) -> View<'a> {
    View {
        x: scene.x.view(),
        v: scene.v.view(),
        bodies: &scene.infos,
        domain: &scene.domain,
        time: scene.time,
        time_step: scene.time_step,
        step: scene.step,
    }
}
