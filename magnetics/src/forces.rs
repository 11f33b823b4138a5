//! Magnetic forces in a scene.

use crate::bead::Bead;
use crate::error::MagneticsError;
use crate::model::{Model, Problem, Solution};
use crate::source::FieldSource;
use lbm_ibm_coupling::{ForceField, Loads, Soa3, StateError, StateReader, StateWriter, Vec3, View};
use std::sync::Arc;

/// Puts the magnetic forces and torques of a model on the bodies of a scene that are beads.
///
/// A body is a bead if its kind has been named; its centre is the mean of its nodes. A [`ForceField`] cannot report an error
/// in the step: where the model fails the loads become NaN, which the scene's guard stops at, and [`BeadForces::fault`]
/// says why.
pub struct BeadForces {
    kinds: Vec<(String, Bead)>,
    source: Arc<dyn FieldSource>,
    model: Box<dyn Model>,
    beads: Vec<Bead>,
    bodies: Vec<usize>,
    x: Soa3,
    solution: Solution,
    fault: Option<MagneticsError>,
}

impl BeadForces {
    /// Forces by `model` in the field of `source`, on no body yet.
    pub fn new(source: impl FieldSource + 'static, model: impl Model + 'static) -> Self {
        Self {
            kinds: Vec::new(),
            source: Arc::new(source),
            model: Box::new(model),
            beads: Vec::new(),
            bodies: Vec::new(),
            x: Soa3::default(),
            solution: Solution::new(),
            fault: None,
        }
    }

    /// Bodies of this kind are such beads.
    pub fn with_kind(mut self, kind: impl Into<String>, bead: Bead) -> Self {
        self.kinds.push((kind.into(), bead));
        self
    }

    /// Another source from now on: magnets moved, or switched off.
    pub fn set_source(&mut self, source: impl FieldSource + 'static) {
        self.source = Arc::new(source);
    }

    /// Moments, forces and error of the last step, one entry per bead in the order of the scene's bodies.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Why the last step's loads are NaN, if they are.
    pub fn fault(&self) -> Option<&MagneticsError> {
        self.fault.as_ref()
    }

    fn solve(&mut self, view: &View<'_>) -> Result<(), MagneticsError> {
        self.beads.clear();
        self.bodies.clear();
        self.x = Soa3::default();
        for (b, body) in view.bodies.iter().enumerate() {
            let Some((_, bead)) = self.kinds.iter().find(|(kind, _)| *kind == body.kind) else {
                continue;
            };
            let centre = body.range.clone().map(|i| view.x.get(i)).sum::<Vec3>() / body.range.len().max(1) as f64;
            self.beads.push(bead.clone());
            self.bodies.push(b);
            self.x.push(centre);
        }
        let source = self.source.clone();
        let problem = Problem::new(&self.beads, self.x.view(), &source, view.time)?;
        self.model.solve(&problem, &mut self.solution)
    }
}

impl ForceField for BeadForces {
    fn name(&self) -> &str {
        self.model.name()
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        self.fault = self.solve(view).err();
        for (k, body) in self.bodies.iter().enumerate() {
            let wrench = &mut loads.body[*body];
            if self.fault.is_some() {
                wrench.force = Vec3::repeat(f64::NAN);
            } else {
                wrench.force += self.solution.force.get(k);
                wrench.torque += self.solution.torque.get(k);
            }
        }
    }

    fn save(&self, to: &mut StateWriter) {
        self.model.save(to);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.model.restore(from)
    }

    fn energy(&mut self, view: &View<'_>) -> Option<f64> {
        self.fault = self.solve(view).err();
        self.fault.is_none().then_some(self.solution.energy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Intrinsic, MutualDipoles, Uniform};
    use lbm_ibm_coupling::{BodyInfo, Domain, Motion};

    #[test]
    fn beads_among_other_bodies_get_their_forces() {
        let bead = Bead::new(2e-6, 1500.0, Intrinsic::new(3.0).unwrap()).unwrap();
        let body = |id: u32, kind: &str, range| BodyInfo {
            id,
            kind: kind.into(),
            range,
            triangles: [].into(),
            motion: Motion::Frozen,
        };
        let bodies = [body(0, "bead", 0..2), body(1, "cell", 2..3), body(2, "bead", 3..4)];
        // The first bead has two nodes about its centre.
        let x: Soa3 = [-1e-6, 1e-6, 7e-6, 5e-6].iter().map(|z| Vec3::z() * *z).collect();
        let view = View {
            x: x.view(),
            v: x.view(),
            bodies: &bodies,
            domain: &Domain::unbounded(),
            time: 0.0,
            time_step: 1.0,
            step: 0,
        };
        let mut forces = BeadForces::new(Uniform::new(Vec3::z() * 0.05), MutualDipoles::new()).with_kind("bead", bead);
        let mut loads = Loads::new(4, 3);
        forces.add_loads(&view, &mut loads);
        assert!(forces.fault().is_none() && forces.energy(&view).is_some());
        assert!(loads.body[0].force.z > 0.0 && loads.body[1].force.z == 0.0);
        assert!((loads.body[0].force + loads.body[2].force).norm() < 1e-12 * loads.body[0].force.z);
        let bad: Soa3 = (0..4).map(|_| Vec3::repeat(f64::NAN)).collect();
        forces.add_loads(&View { x: bad.view(), ..view }, &mut loads);
        assert!(forces.fault().is_some() && loads.body[0].force.x.is_nan());
    }
}
