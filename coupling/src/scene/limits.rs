//! The time step against the stiffness of bodies and fields, before the first step.

use super::{Elasticity, Fluid, Scene, view_of};
use crate::{ImmersedBody, Motion, SceneError, Soa3, Soa3Ref};
use std::f64::consts::PI;

impl Scene {
    /// Checks the time step against every term whose limit is known: called before the first step, and again after
    /// bodies or forces have come or gone.
    ///
    /// # Errors
    /// [`SceneError::TimeStep`] with the term and its limit.
    pub fn prepare(&mut self) -> Result<(), SceneError> {
        for i in 0..self.bodies.len() {
            let info = &self.infos[i];
            let x = self.x.slice(info.range.clone());
            let body = self.bodies[i].body.as_mut();
            let limit = match (&self.fluid, info.motion) {
                (Some(_), Motion::Advected) if self.elasticity != Elasticity::Explicit => None,
                (Some(Fluid { exchange, lattice, .. }), _) => {
                    exchange.stable_step(body, x, lattice.viscosity(), lattice.density())
                }
                (None, Motion::Overdamped { friction }) => Some(2.0 * friction / greatest_stiffness(body, x)),
                (None, _) => None,
            };
            self.accept(limit, || format!("the elasticity of body {} ({})", info.id, info.kind))?;
        }
        for field in &self.fields {
            for (body, info) in self.infos.iter().enumerate() {
                let Some(stiffness) = field.stiffness_on(&view_of(self), body) else {
                    continue;
                };
                let limit = match info.motion {
                    Motion::Rigid => self.rigid_step_limit(info.id, stiffness),
                    motion => self.node_step_limit(motion, stiffness),
                };
                self.accept(limit, || {
                    format!("{} on body {} ({})", field.name(), info.id, info.kind)
                })?;
            }
        }
        self.ready = true;
        Ok(())
    }

    fn accept(&self, limit: Option<f64>, term: impl Fn() -> String) -> Result<(), SceneError> {
        match limit {
            Some(limit) if self.time_step > limit => Err(SceneError::TimeStep {
                term: term(),
                time_step: self.time_step,
                limit,
            }),
            _ => Ok(()),
        }
    }

    /// Limit (s) for a single node on a spring of `stiffness` (N/m). A node carried by the fluid moves it as a sphere
    /// of about one spacing would: mobility 1/(6 pi mu h).
    fn node_step_limit(&self, motion: Motion, stiffness: f64) -> Option<f64> {
        match motion {
            Motion::Advected => self
                .fluid
                .as_ref()
                .map(|fluid| 12.0 * PI * fluid.lattice.viscosity() * fluid.lattice.grid().spacing / stiffness),
            Motion::Newton { node_mass, .. } => Some(2.0 * (node_mass / stiffness).sqrt()),
            Motion::Overdamped { friction } => Some(2.0 * friction / stiffness),
            Motion::Frozen | Motion::Rigid => None,
        }
    }
}

/// Largest eigenvalue (N/m) of minus the gradient of a body's forces at `x` (m), by power iteration over central
/// differences.
fn greatest_stiffness(body: &mut dyn ImmersedBody, x: Soa3Ref<'_>) -> f64 {
    let n = x.len();
    let size = x.iter().map(|p| (p - x.mean()).norm()).fold(0.0, f64::max);
    let step = 1e-6 * size.max(f64::MIN_POSITIVE);
    // A start that no symmetry of the mesh is orthogonal to.
    let mut direction: Soa3 = (0..n)
        .map(|i| {
            let s = i as f64 + 1.0;
            crate::Vec3::new((1.7 * s).sin(), (2.3 * s).cos(), (3.1 * s).sin())
        })
        .collect();
    let rest = Soa3::zeros(n);
    let mut force = [Soa3::zeros(n), Soa3::zeros(n)];
    let mut eigenvalue = 0.0;
    for _ in 0..25 {
        let norm = direction.iter().map(|d| d.norm_squared()).sum::<f64>().sqrt();
        for (f, sign) in force.iter_mut().zip([1.0, -1.0]) {
            let moved: Soa3 = (0..n)
                .map(|i| x.get(i) + direction.get(i) * (sign * step / norm))
                .collect();
            f.fill(0.0);
            body.add_internal_forces(moved.view(), rest.view(), &mut f.view_mut());
        }
        for i in 0..n {
            direction.set(i, (force[1].get(i) - force[0].get(i)) / (2.0 * step));
        }
        eigenvalue = direction.iter().map(|d| d.norm_squared()).sum::<f64>().sqrt();
        if eigenvalue == 0.0 {
            return f64::MIN_POSITIVE;
        }
    }
    eigenvalue
}
