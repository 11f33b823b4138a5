//! Rigid bodies in the fluid: no slip at their markers and Newton's law at once.
//!
//! A step begins with the velocity `u` that the fluid has without the rigid bodies, half a step of all other forces
//! included, as Guo's forcing counts it. Marker forces `F` (N) change it by half a step of theirs, so that no slip reads
//! `J u + dt/(2 rho h^3) J S F = U + W x r` at the markers, with interpolation `J` and spreading `S = J^T` (the velocity
//! correction of Wu and Shu, J. Comput. Phys. 228 (2009) 1963), and Newton's law of each free body is
//! `M U + dt sum F = P`, `I W + dt sum r x F = L` ([`lbm_ibm_coupling::RigidLaw`]). Velocities and forces are unknowns
//! together: no mass is too small, and a body as dense as the fluid needs no care. On the left stands a slip along the surface too,
//! of a fraction of a spacing times the shear ([`crate::Kernel::rigid_slip`]), without which smeared markers act larger to a turn or to a curved
//! profile than to a drag. It adds a positive diagonal to `J S`.
//!
//! The system is solved by conjugate gradients whose preconditioner replaces `J S` by a number and keeps Newton's law as it
//! is (a constraint preconditioner: Keller, Gould and Wathen, SIAM J. Matrix Anal. 21 (2000) 1300). So every iterate
//! fulfils Newton's law to rounding, momentum is kept however early the iteration ends, and what is left is slip. It
//! starts from the forces of the step before. One iteration from zero forces would be direct forcing, and the steps without
//! conjugate directions multi-direct forcing.

mod body;
mod end;
mod state;
mod twist;

pub(crate) use end::End;

use crate::Kernel;
use crate::placement::Placement;
use crate::transfer::{self, Node};
use body::Body;
use lbm_ibm_coupling::{Bricks, ExchangeError, Grid, ImmersedBody, RigidState, Vec3};
use twist::{Twist, at, dot, generalised, norm, sum, twist};

/// Share of the slip that the forces of the step before leave which is made up for in a step. The velocity that has to be
/// right is the one at half a step of force, so that a whole correction overshoots by as much again: alone it would ring,
/// and with a flux control it grows. At 0.85 an isolated layer of fluid settles by a factor of 0.39 a step, the most.
const SHARE: f64 = 0.85;

/// Forces on markers and velocities of bodies, or a residual of theirs.
#[derive(Clone, Debug, Default)]
struct Pair {
    marker: Vec<Vec3>,
    body: Vec<Twist>,
}

impl Pair {
    fn resize(&mut self, markers: usize, bodies: usize) {
        self.marker.resize(markers, Vec3::zeros());
        self.body.resize(bodies, Twist::zeros());
    }

    fn add(&mut self, factor: f64, other: &Self) {
        for (a, b) in self.marker.iter_mut().zip(&other.marker) {
            *a += factor * b;
        }
        for (a, b) in self.body.iter_mut().zip(&other.body) {
            *a += factor * b;
        }
    }
}

/// What holds rigid bodies in the fluid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Forcing {
    pub end: End,
    bodies: Vec<Body>,
    spacing: f64,
    /// Marker positions, m.
    x: Vec<[f64; 3]>,
    /// Markers from the centre of their body, in grid spacings.
    arm: Vec<Vec3>,
    /// Unit normals of the surfaces at the markers.
    normal: Vec<Vec3>,
    placement: Placement,
    tiles: transfer::Scratch,
    sorted: Vec<[f64; 3]>,
    field: [Vec<f64>; 3],
    /// Marker forces as the velocity they give to a node, `dt F / (2 rho h^3)` (m/s), and velocities of the bodies.
    state: Pair,
    residual: Pair,
    search: Pair,
    step: Pair,
    product: Vec<Vec3>,
    slip: f64,
    iterations: usize,
}

impl Forcing {
    /// Places markers on new bodies; those that stay keep their forces.
    ///
    /// # Errors
    /// [`ExchangeError::TooSmall`].
    pub fn set_bodies(
        &mut self,
        bodies: &[(u32, &dyn ImmersedBody)],
        grid: &Grid,
        kernel: Kernel,
        inset: bool,
    ) -> Result<(), ExchangeError> {
        let h = grid.spacing;
        let mut new = Vec::with_capacity(bodies.len());
        let mut force = Vec::new();
        for &(id, body) in bodies {
            let start = force.len();
            match self.bodies.iter().find(|b| b.id == id) {
                Some(old) => {
                    force.extend_from_slice(&self.state.marker[old.markers.clone()]);
                    let mut kept = old.clone();
                    kept.markers = start..force.len();
                    new.push(kept);
                }
                None => {
                    new.push(Body::new(id, body, h, kernel, inset, start)?);
                    force.resize(new[new.len() - 1].markers.end, Vec3::zeros());
                }
            }
        }
        self.spacing = h;
        self.bodies = new;
        self.state.marker = force;
        let (markers, bodies) = (self.state.marker.len(), self.bodies.len());
        for pair in [&mut self.state, &mut self.residual, &mut self.search, &mut self.step] {
            pair.resize(markers, bodies);
        }
        self.x.resize(markers, [0.0; 3]);
        self.arm.resize(markers, Vec3::zeros());
        self.normal.resize(markers, Vec3::zeros());
        self.product.resize(markers, Vec3::zeros());
        self.sorted.resize(markers, [0.0; 3]);
        self.placement = Placement::default();
        Ok(())
    }

    pub fn slip(&self) -> (f64, usize) {
        (self.slip, self.iterations)
    }

    pub fn marker_count(&self) -> usize {
        self.state.marker.len()
    }

    /// Mass of fluid (kg) that follows a body within a step.
    pub fn layer(&self, body: u32, density: f64) -> f64 {
        let nodes = |b: &Body| b.nodes * b.markers.len() as f64;
        let found = self.bodies.iter().find(|b| b.id == body).map_or(0.0, nodes);
        2.0 * density * self.spacing.powi(3) * found
    }

    /// Moves the markers with their bodies and wants the bricks they touch.
    ///
    /// # Errors
    /// [`ExchangeError::OutsideGrid`].
    pub fn place(
        &mut self,
        states: &[RigidState],
        grid: &Grid,
        kernel: Kernel,
        bricks: &mut Bricks,
    ) -> Result<(), ExchangeError> {
        for (body, state) in self.bodies.iter().zip(states) {
            let centre = state.pose.translation.vector;
            for ((m, p), n) in body.markers.clone().zip(&body.reference).zip(&body.normal) {
                let r = state.pose.rotation * p;
                self.normal[m] = state.pose.rotation * n;
                self.arm[m] = r / self.spacing;
                self.x[m] = (centre + r).into();
            }
        }
        let x = &self.x;
        let placed = self
            .placement
            .locate(x.len(), &|m| x[m], grid, kernel.support(), bricks);
        placed.map_err(|(marker, position)| ExchangeError::OutsideGrid {
            body: self
                .bodies
                .iter()
                .find(|b| b.markers.contains(&marker))
                .map_or(0, |b| b.id),
            position: position.into(),
        })
    }

    /// Finds the marker forces, adds them to the bricks and sets velocities and loads of the bodies.
    pub fn hold(
        &mut self,
        states: &mut [RigidState],
        [density, viscosity]: [f64; 2],
        dt: f64,
        kernel: Kernel,
        bricks: &mut Bricks,
    ) {
        self.placement.order_by_slot(bricks);
        for a in 0..3 {
            self.field[a].resize(bricks.force()[a].len(), 0.0);
        }
        let h = self.spacing;
        let per_force = dt / (2.0 * density * h.powi(3));
        // The velocity of the fluid without the bodies, then what is missing to no slip and to Newton's law.
        let field = bricks.velocity();
        transfer::interpolate_by(kernel, &self.placement, field, &mut self.tiles, &mut self.sorted);
        for (m, r) in self.residual.marker.iter_mut().enumerate() {
            *r = -Vec3::from(self.sorted[self.placement.rank[m] as usize]);
        }
        for (b, state) in states.iter().enumerate() {
            self.state.body[b] = twist(state.velocity, h * state.angular_velocity);
            let body = &mut self.bodies[b];
            body.slide(viscosity * dt / (density * h * h));
            let missing = self.residual.marker[body.markers.clone()].iter_mut();
            let arm = &self.arm[body.markers.clone()];
            let normal = &self.normal[body.markers.clone()];
            missing.zip(arm).for_each(|(r, arm)| *r += at(&self.state.body[b], arm));
            body.inverse = state.law.as_ref().and_then(|law| {
                let mass = law.mass / (2.0 * density * h.powi(3));
                let inertia = law.inertia / (2.0 * density * h.powi(5));
                let added = Twist::from_iterator(
                    (law.momentum * (per_force / dt))
                        .iter()
                        .chain((law.angular_momentum * (per_force / (dt * h))).iter())
                        .copied(),
                );
                let own = generalised(mass, &inertia);
                let load = sum(&self.state.marker[body.markers.clone()], arm);
                self.residual.body[b] = added - load - own * self.state.body[b];
                (own + body.shell(arm, normal)).try_inverse()
            });
        }
        let scale = norm(&self.residual.marker);
        self.multiply(kernel, true);
        for (r, product) in self.residual.marker.iter_mut().zip(&self.product) {
            *r = SHARE * (*r - product);
        }
        self.solve(kernel, scale);
        self.hand_out(states, per_force, kernel, bricks);
    }

    /// Conjugate gradients; the first step is the preconditioner's and makes Newton's law hold.
    fn solve(&mut self, kernel: Kernel, mut scale: f64) {
        self.iterations = 0;
        self.precondition();
        std::mem::swap(&mut self.search, &mut self.step);
        let mut weight = 0.0;
        loop {
            self.multiply(kernel, false);
            self.iterations += 1;
            let first = self.iterations == 1;
            if first {
                // At rest nothing is missing to no slip until Newton's law moves the bodies.
                scale = scale.max(norm(&self.product));
            }
            let along = if first {
                1.0
            } else {
                weight / dot(&self.search.marker, &self.product)
            };
            if !along.is_finite() {
                break;
            }
            self.state.add(along, &self.search);
            for (r, product) in self.residual.marker.iter_mut().zip(&self.product) {
                *r -= along * product;
            }
            if first {
                self.residual.body.fill(Twist::zeros());
            }
            self.slip = norm(&self.residual.marker) / scale.max(f64::MIN_POSITIVE);
            if self.slip <= self.end.slip || self.iterations >= self.end.iterations {
                break;
            }
            self.precondition();
            let now = dot(&self.residual.marker, &self.step.marker);
            let turn = if first { 0.0 } else { now / weight };
            weight = now;
            let Pair { marker, body } = &mut self.search;
            for (p, z) in marker.iter_mut().zip(&self.step.marker) {
                *p = z + turn * *p;
            }
            for (p, z) in body.iter_mut().zip(&self.step.body) {
                *p = z + turn * *p;
            }
        }
    }

    /// `step` from `residual`: the forces that would mend it if `J S` were a number, and the velocities that keep Newton's
    /// law.
    fn precondition(&mut self) {
        for (b, body) in self.bodies.iter().enumerate() {
            let markers = body.markers.clone();
            let (arm, normal) = (&self.arm[markers.clone()], &self.normal[markers.clone()]);
            let residual = &self.residual.marker[markers.clone()];
            let step = &mut self.step.marker[markers];
            let velocity = match &body.inverse {
                Some(inverse) => {
                    for ((z, r), n) in step.iter_mut().zip(residual).zip(normal) {
                        *z = body.mend(r, n);
                    }
                    inverse * (self.residual.body[b] - sum(step, arm))
                }
                None => Twist::zeros(),
            };
            self.step.body[b] = velocity;
            for (((z, r), n), arm) in step.iter_mut().zip(residual).zip(normal).zip(arm) {
                *z = body.mend(&(r + at(&velocity, arm)), n);
            }
        }
    }

    /// `product = J S q` and the slip, of the forces so far, or of the search direction and then less the surface's velocity in it.
    fn multiply(&mut self, kernel: Kernel, of_state: bool) {
        let force = if of_state {
            &self.state.marker
        } else {
            &self.search.marker
        };
        for f in &mut self.field {
            f.fill(0.0);
        }
        let f = |m: usize| Node([force[m].x, force[m].y, force[m].z, 0.0]);
        let field = self.field.each_mut().map(Vec::as_mut_slice);
        transfer::spread_by(kernel, &self.placement, f, &mut self.tiles, field);
        let field = self.field.each_ref().map(Vec::as_slice);
        transfer::interpolate_by(kernel, &self.placement, field, &mut self.tiles, &mut self.sorted);
        for (m, p) in self.product.iter_mut().enumerate() {
            *p = Vec3::from(self.sorted[self.placement.rank[m] as usize]);
        }
        for (body, velocity) in self.bodies.iter().zip(&self.search.body) {
            for m in body.markers.clone() {
                self.product[m] += body.slipped(&force[m], &self.normal[m]);
                if !of_state {
                    self.product[m] -= at(velocity, &self.arm[m]);
                }
            }
        }
    }

    /// The forces to the bricks, and velocities and loads to the bodies.
    fn hand_out(&mut self, states: &mut [RigidState], per_force: f64, kernel: Kernel, bricks: &mut Bricks) {
        let h = self.spacing;
        for (b, state) in states.iter_mut().enumerate() {
            let markers = self.bodies[b].markers.clone();
            if state.law.is_some() {
                let velocity = &self.state.body[b];
                state.velocity = velocity.fixed_rows::<3>(0).into();
                state.angular_velocity = velocity.fixed_rows::<3>(3) / h;
            }
            let load = sum(&self.state.marker[markers.clone()], &self.arm[markers]) / per_force;
            state.on_fluid.force = load.fixed_rows::<3>(0).into();
            state.on_fluid.torque = load.fixed_rows::<3>(3) * h;
        }
        let force = &self.state.marker;
        let f = |m: usize| {
            let f = force[m] / per_force;
            Node([f.x, f.y, f.z, 0.0])
        };
        let field = bricks.force_mut();
        transfer::spread_by(kernel, &self.placement, f, &mut self.tiles, field);
    }
}
