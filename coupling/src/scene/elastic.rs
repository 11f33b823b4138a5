//! Stiff membranes at the fluid's own time step.
//!
//! Within a step the fluid answers forces `F` on the nodes about as `U = U0 + M F`, `U0` the velocity without them and
//! `M = 3/2 dt/(rho h^3) J S`, interpolation `J` after spreading `S`: the force of a step counts whole in the momentum and
//! half again in the velocity that moves the nodes. Viscosity leaves less of it where forces are rough, so that `M` errs on
//! the stable side: the limit of infinite stiffness is stable while `M` is more than half of the truth.
//!
//! Where a membrane is in balance with the flow `U0` undoes the true answer to the forces, not `M F`, and what is left of it, times `dt K`, would
//! weaken the membrane by a share that does not vanish with time. So `U0` counts what the true velocity of the steps before was above
//! the one reckoned with, as a mean that forgets in ten steps: too slow to touch the stability of the stiffest motion.

use super::step::internal_forces;
use super::{Fluid, Scene, Slot};
use crate::{BodyInfo, Motion, Soa3, Soa3Ref};

/// How the elastic forces of bodies that the fluid carries follow the motion of their nodes within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Elasticity {
    /// The forces are those at the start of the step. The time step is limited by the stiffest mode of the mesh.
    #[default]
    Explicit,
    /// The forces are those at the end of the step, linearised: `(1 + dt K M) F = F(x) - dt K U0`, `K` the stiffness.
    /// Conjugate gradients in the scalar product of `M`; no limit to the time step from elasticity.
    Implicit {
        /// Residual at which the iteration ends, over that of the explicit forces.
        tolerance: f64,
        /// Most iterations of a step.
        iterations: usize,
    },
}

impl Elasticity {
    /// Implicit, to a thousandth, in at most 60 iterations.
    pub const IMPLICIT: Self = Self::Implicit {
        tolerance: 1e-3,
        iterations: 60,
    };
}

/// Share of the last step in what the true velocity was above that reckoned with.
const LEARNT: f64 = 0.1;

/// Arrays of the solution, kept between steps.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    /// Internal forces at the start of the step.
    rest: Soa3,
    moved: Soa3,
    /// The velocity that the forces of the step are to make.
    velocity: Soa3,
    /// What the true one of the steps before was above that, `U0 + M F`.
    pub excess: Soa3,
    residual: Soa3,
    swept: Soa3,
    search: Soa3,
    swept_search: Soa3,
    product: Soa3,
    swept_product: Soa3,
    /// Iterations of the last step, and the residual that was left.
    pub taken: (usize, f64),
}

/// What the products work on.
struct Operators<'a> {
    fluid: &'a mut Fluid,
    bodies: &'a mut [Slot],
    infos: &'a [BodyInfo],
    x: Soa3Ref<'a>,
    v: Soa3Ref<'a>,
    /// 3/2 dt/(rho h^3), s/kg.
    mobility: f64,
    /// Largest displacement of a node (m) in a difference of forces.
    probe: f64,
    time_step: f64,
}

impl Operators<'_> {
    /// Sets all but the nodes that the fluid carries to zero.
    fn carried(&self, a: &mut Soa3) {
        for info in self.infos.iter().filter(|i| i.motion != Motion::Advected) {
            let part = a.slice_mut(info.range.clone());
            part.x.fill(0.0);
            part.y.fill(0.0);
            part.z.fill(0.0);
        }
    }

    /// `M f`.
    fn sweep(&mut self, f: &Soa3, out: &mut Soa3) {
        let Fluid { exchange, bricks, .. } = self.fluid;
        bricks.clear_force();
        exchange.spread(f.view(), bricks);
        bricks.velocity_from_force(self.mobility);
        exchange.interpolate(bricks, out.view_mut());
        self.carried(out);
    }

    /// Internal forces at `x`.
    fn forces(&mut self, x: &Soa3, out: &mut Soa3) {
        internal_forces(self.bodies, self.infos, x.view(), self.v, out.view_mut());
        self.carried(out);
    }

    /// `dt K u`, by a difference from the forces `rest`.
    fn stiffen(&mut self, rest: &Soa3, u: &Soa3, moved: &mut Soa3, out: &mut Soa3) {
        let largest = u.x.iter().chain(&u.y).chain(&u.z).fold(0.0, |m: f64, u| m.max(u.abs()));
        if largest.is_nan() || largest <= 0.0 {
            return out.fill(0.0);
        }
        let scale = self.probe / largest;
        zip3(moved, [self.x, u.view()], |_, [x, u]| x + scale * u);
        self.forces(moved, out);
        let per = self.time_step / scale;
        zip3(out, [rest.view(), rest.view()], |f, [rest, _]| (rest - f) * per);
    }
}

impl Scene {
    /// Chooses how elastic forces follow the motion of the nodes within a step.
    pub fn set_elasticity(&mut self, elasticity: Elasticity) {
        self.elasticity = elasticity;
        self.ready = false;
    }

    /// Iterations of the last implicit step, and the residual left, over that of the explicit forces.
    pub fn elastic_iterations(&self) -> (usize, f64) {
        self.workspace.taken
    }

    /// Replaces the forces on the fluid by those that [`Elasticity`] asks for; the markers are placed, and the bricks hold no
    /// force.
    pub(super) fn relax_forces(&mut self) {
        let (Some(fluid), Elasticity::Implicit { tolerance, iterations }) = (&mut self.fluid, self.elasticity) else {
            return;
        };
        if !self.infos.iter().any(|i| i.motion == Motion::Advected) {
            return;
        }
        let w = &mut self.workspace;
        for a in [
            &mut w.rest,
            &mut w.moved,
            &mut w.velocity,
            &mut w.residual,
            &mut w.swept,
            &mut w.search,
            &mut w.swept_search,
            &mut w.product,
            &mut w.swept_product,
        ] {
            a.resize(self.x.len());
        }
        // The velocity without the forces of this step.
        fluid.lattice.read_velocity(&mut fluid.bricks);
        fluid.exchange.interpolate(&fluid.bricks, w.velocity.view_mut());
        let grid = fluid.lattice.grid();
        let (h, dt) = (grid.spacing, self.time_step);
        let mobility = 1.5 * dt / (fluid.lattice.density() * h.powi(3));
        let mut operators = Operators {
            fluid,
            bodies: &mut self.bodies,
            infos: &self.infos,
            x: self.x.view(),
            v: self.v.view(),
            mobility,
            probe: 1e-5 * h,
            time_step: dt,
        };
        operators.carried(&mut w.velocity);
        add(&mut w.velocity, 1.0, &w.excess);
        zip3(&mut w.moved, [self.x.view(), self.x.view()], |_, [x, _]| x);
        operators.forces(&w.moved, &mut w.rest);
        w.solve(&mut operators, tolerance, iterations, &mut self.on_fluid);
        operators.fluid.bricks.clear_force();
    }
}

impl Workspace {
    /// Takes the true velocity of the nodes that the forces of the step have made.
    pub fn learn(&mut self, truth: Soa3Ref<'_>) {
        zip3(&mut self.excess, [truth, self.velocity.view()], |e, [u, v]| {
            e + LEARNT * (u - v)
        });
    }

    /// Conjugate gradients from the explicit forces.
    fn solve(&mut self, of: &mut Operators<'_>, tolerance: f64, iterations: usize, force: &mut Soa3) {
        self.taken = (0, 0.0);
        zip3(&mut self.search, [force.view(), force.view()], |_, [f, _]| f);
        of.carried(&mut self.search);
        of.sweep(&self.search, &mut self.swept);
        zip3(
            &mut self.velocity,
            [self.swept.view(), self.swept.view()],
            |u, [v, _]| u + v,
        );
        of.stiffen(&self.rest, &self.velocity, &mut self.moved, &mut self.residual);
        zip3(&mut self.residual, [self.rest.view(), self.rest.view()], |r, _| -r);
        of.sweep(&self.residual, &mut self.swept);
        let first = dot(&self.residual, &self.swept);
        let mut now = first;
        zip3(
            &mut self.search,
            [self.residual.view(), self.residual.view()],
            |_, [r, _]| r,
        );
        zip3(
            &mut self.swept_search,
            [self.swept.view(), self.swept.view()],
            |_, [z, _]| z,
        );
        while now > tolerance * tolerance * first && self.taken.0 < iterations {
            of.stiffen(&self.rest, &self.swept_search, &mut self.moved, &mut self.product);
            zip3(
                &mut self.product,
                [self.search.view(), self.search.view()],
                |q, [p, _]| q + p,
            );
            of.sweep(&self.product, &mut self.swept_product);
            let curvature = dot(&self.search, &self.swept_product);
            // A membrane that buckles has directions without stiffness: what has been found so far is kept.
            if curvature.is_nan() || curvature <= 0.0 {
                break;
            }
            let along = now / curvature;
            add(force, along, &self.search);
            add(&mut self.velocity, along, &self.swept_search);
            add(&mut self.residual, -along, &self.product);
            add(&mut self.swept, -along, &self.swept_product);
            let next = dot(&self.residual, &self.swept);
            let turn = next / now;
            now = next;
            zip3(
                &mut self.search,
                [self.residual.view(), self.residual.view()],
                |p, [r, _]| r + turn * p,
            );
            zip3(
                &mut self.swept_search,
                [self.swept.view(), self.swept.view()],
                |p, [z, _]| z + turn * p,
            );
            self.taken.0 += 1;
        }
        self.taken.1 = if first > 0.0 {
            (now.max(0.0) / first).sqrt()
        } else {
            0.0
        };
    }
}

/// `out = f(out, a, b)` number by number.
fn zip3(out: &mut Soa3, [a, b]: [Soa3Ref<'_>; 2], f: impl Fn(f64, [f64; 2]) -> f64) {
    let Soa3 { x, y, z } = out;
    for (out, a, b) in [(x, a.x, b.x), (y, a.y, b.y), (z, a.z, b.z)] {
        for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
            *out = f(*out, [*a, *b]);
        }
    }
}

fn add(to: &mut Soa3, factor: f64, a: &Soa3) {
    zip3(to, [a.view(), a.view()], |t, [a, _]| t + factor * a);
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    sum(&a.x, &b.x) + sum(&a.y, &b.y) + sum(&a.z, &b.z)
}
