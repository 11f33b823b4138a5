//! One time step.

use super::{Elasticity, Scene, Slot, motion, rigid};
use crate::threads::join;
use crate::{BodyInfo, Motion, SceneError, Soa3Mut, Soa3Ref, View};

impl Scene {
    /// One time step: the four steps of the immersed boundary method.
    ///
    /// They form a cycle, and it matters where a step begins: here nodes move with the velocity that their own forces
    /// have made (the symplectic order), which is stable for time steps at which moving them with the velocity of the
    /// step before is not.
    ///
    /// # Errors
    /// What the guard, the fluid or the exchange find; the scene stays as it was at the fault.
    pub fn step(&mut self) -> Result<(), SceneError> {
        if !self.ready {
            self.prepare()?;
        }
        // 1. The forces on the nodes: elastic, contact and other fields, friction against the fluid.
        self.gather_loads();
        let all_rigid = self.infos.len() == self.rigid.len();
        motion::force_on_fluid(
            &self.infos,
            &self.loads,
            &self.v,
            &self.fluid_velocity,
            self.on_fluid.view_mut(),
        );
        if let Some(fluid) = &mut self.fluid {
            // 2. The nodes' forces go to the fluid, then those that make it follow rigid bodies.
            if !self.infos.is_empty() {
                if !self.rigid.is_empty() {
                    fluid.exchange.place_rigid(&self.rigid, &mut fluid.bricks)?;
                }
                fluid.exchange.place(self.x.view(), &mut fluid.bricks)?;
                fluid.bricks.clear_force();
            }
        }
        self.relax_forces();
        if let Some(fluid) = &mut self.fluid {
            if !self.infos.is_empty() {
                if !all_rigid {
                    fluid.exchange.spread(self.on_fluid.view(), &mut fluid.bricks);
                }
                if !self.rigid.is_empty() {
                    fluid.hold_rigid(&mut self.rigid, &self.x, &self.loads, &self.infos)?;
                }
            }
            // 3. The fluid moves, with the viscosity that it has inside of cells.
            fluid.find_inside(&self.bodies, &self.infos, self.x.view())?;
            fluid.lattice.advance(&fluid.bricks)?;
            // 4. The velocity of the fluid goes to the nodes, and they move.
            if !all_rigid {
                fluid.lattice.read_velocity(&mut fluid.bricks);
                fluid
                    .exchange
                    .interpolate(&fluid.bricks, self.fluid_velocity.view_mut());
                if self.elasticity != Elasticity::Explicit {
                    self.workspace.learn(self.fluid_velocity.view());
                }
            }
        }
        motion::advance(
            &self.infos,
            &self.loads,
            &self.fluid_velocity,
            self.time_step,
            self.x.view_mut(),
            self.v.view_mut(),
        );
        self.constrain();
        rigid::advance(self);
        let bodies = self.bodies.iter_mut().zip(&self.infos);
        for (slot, info) in bodies.filter(|(_, info)| info.motion != Motion::Rigid) {
            slot.body.advance(part(self.x.view(), &info.range), self.time_step);
        }
        self.step += 1;
        self.time = self.step as f64 * self.time_step;
        if self.step.is_multiple_of(self.guard.every) {
            self.check()?;
        }
        Ok(())
    }

    /// Takes at least one step and at most `most`, and says how many. A fluid that is alone, without bodies and fields, may take several at
    /// once ([`Lattice::advance_many`](crate::Lattice::advance_many)), up to the guard's next look; the result is that of single steps. Any
    /// other scene takes one.
    ///
    /// # Errors
    /// As for [`Scene::step`].
    pub fn step_by(&mut self, most: u64) -> Result<u64, SceneError> {
        if !self.ready {
            self.prepare()?;
        }
        let look = match self.guard.every {
            0 => u64::MAX,
            every => every - self.step % every,
        };
        let steps = most.min(look).min(u64::from(u32::MAX));
        let alone = self.bodies.is_empty() && self.fields.is_empty();
        let fluid = self.fluid.as_mut().filter(|f| alone && f.inside.is_empty());
        let Some(fluid) = fluid.filter(|_| steps > 1) else {
            return self.step().map(|()| 1);
        };
        fluid.lattice.advance_many(&fluid.bricks, steps as usize)?;
        self.step += steps;
        self.time = self.step as f64 * self.time_step;
        if steps == look {
            self.check()?;
        }
        Ok(steps)
    }

    /// Lets each body that has moved node by node keep its own constraints.
    fn constrain(&mut self) {
        for (slot, info) in self.bodies.iter_mut().zip(&self.infos) {
            if !matches!(info.motion, Motion::Rigid | Motion::Frozen) {
                slot.body.constrain(&mut self.x.slice_mut(info.range.clone()));
            }
        }
    }

    fn gather_loads(&mut self) {
        self.loads.clear_sums();
        internal_forces(
            &mut self.bodies,
            &self.infos,
            self.x.view(),
            self.v.view(),
            self.loads.node.view_mut(),
        );
        let view = View {
            x: self.x.view(),
            v: self.v.view(),
            bodies: &self.infos,
            domain: &self.domain,
            time: self.time,
            time_step: self.time_step,
            step: self.step,
        };
        for field in &mut self.fields {
            field.add_loads(&view, &mut self.loads);
        }
        self.loads.share_among_nodes(&view);
    }
}

/// Sets `force` to each body's forces on its own range. Halves the bodies until one is left, so that threads share them without
/// allocating; `force` covers the ranges of these bodies alone.
pub(super) fn internal_forces(
    bodies: &mut [Slot],
    infos: &[BodyInfo],
    x: Soa3Ref<'_>,
    v: Soa3Ref<'_>,
    mut force: Soa3Mut<'_>,
) {
    match bodies {
        [] => {}
        [one] => {
            let range = infos[0].range.clone();
            for f in [&mut *force.x, &mut *force.y, &mut *force.z] {
                f.fill(0.0);
            }
            if infos[0].motion != Motion::Rigid {
                one.body
                    .add_internal_forces(part(x, &range), part(v, &range), &mut force);
            }
        }
        _ => {
            let half = bodies.len() / 2;
            let (left, right) = bodies.split_at_mut(half);
            let (left_infos, right_infos) = infos.split_at(half);
            let (left_force, right_force) = split(force, right_infos[0].range.start - left_infos[0].range.start);
            join(
                || internal_forces(left, left_infos, x, v, left_force),
                || internal_forces(right, right_infos, x, v, right_force),
            );
        }
    }
}

fn part<'a>(a: Soa3Ref<'a>, range: &std::ops::Range<usize>) -> Soa3Ref<'a> {
    Soa3Ref {
        x: &a.x[range.clone()],
        y: &a.y[range.clone()],
        z: &a.z[range.clone()],
    }
}

pub(super) fn split(a: Soa3Mut<'_>, at: usize) -> (Soa3Mut<'_>, Soa3Mut<'_>) {
    let (x0, x1) = a.x.split_at_mut(at);
    let (y0, y1) = a.y.split_at_mut(at);
    let (z0, z1) = a.z.split_at_mut(at);
    (Soa3Mut { x: x0, y: y0, z: z0 }, Soa3Mut { x: x1, y: y1, z: z1 })
}
