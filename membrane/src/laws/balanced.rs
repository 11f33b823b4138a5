//! Laws whose forces do not sum to zero, made to.

use super::{Law, take_off};
use lbm_ibm_coupling::{Soa3, Soa3Mut, Soa3Ref, StateError, StateReader, StateWriter};

/// Several laws together, with their net force and net torque taken off.
///
/// What is taken off is the forces of least norm that have the same sum and the same torque: equal forces on all nodes,
/// and those of a rigid turn about their centre. It changes no deformation of a free cell at rest, for it does no work on
/// one, but it keeps the cell from driving itself: the 2011 area forces ([`super::Area2011`]) of a cell in a narrow slit
/// sum to more than the flow's own push.
#[derive(Clone)]
pub struct Balanced {
    laws: Vec<Box<dyn Law>>,
    scratch: Soa3,
}

impl Balanced {
    /// The laws of a mesh of `nodes` nodes; none yet.
    pub fn new(nodes: usize) -> Self {
        Self {
            laws: Vec::new(),
            scratch: Soa3::zeros(nodes),
        }
    }

    /// With one more law.
    pub fn with_law(mut self, law: impl Law + 'static) -> Self {
        self.laws.push(Box::new(law));
        self
    }
}

impl Law for Balanced {
    fn name(&self) -> &str {
        "balanced laws"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        self.scratch.fill(0.0);
        for law in &mut self.laws {
            law.add_forces(x, v, &mut self.scratch.view_mut());
        }
        take_off(x, &mut self.scratch);
        for i in 0..x.len() {
            force.add(i, self.scratch.get(i));
        }
    }

    fn advance(&mut self, x: Soa3Ref<'_>, time_step: f64) {
        for law in &mut self.laws {
            law.advance(x, time_step);
        }
    }

    fn save(&self, to: &mut StateWriter) {
        self.laws.iter().for_each(|law| law.save(to));
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        self.laws.iter_mut().try_for_each(|law| law.restore(from))
    }
}

#[cfg(test)]
mod tests {
    use crate::{Form, presets};
    use lbm_ibm_coupling::{ImmersedBody, Soa3, Vec3};

    /// Net force over the sum of sizes, and net torque over the sum of arm times size, of a cell squeezed unevenly.
    fn net(form: Form) -> (f64, f64) {
        let mut cell = presets::ctc_paper(form).expect("a preset");
        let x: Soa3 = cell
            .reference()
            .iter()
            .map(|p| Vec3::new(p.x * 1.2 + 2e4 * p.y * p.y, p.y * 0.6, p.z * 1.1 + 0.1 * p.x))
            .collect();
        let mut f = Soa3::zeros(x.len());
        cell.add_internal_forces(x.view(), Soa3::zeros(x.len()).view(), &mut f.view_mut());
        let centre = x.view().mean();
        let arm = |i: usize| x.get(i) - centre;
        let sum = |g: &dyn Fn(usize) -> f64| (0..x.len()).map(g).sum::<f64>();
        let torque: Vec3 = (0..x.len()).map(|i| arm(i).cross(&f.get(i))).sum();
        (
            f.iter().sum::<Vec3>().norm() / sum(&|i| f.get(i).norm()),
            torque.norm() / sum(&|i| arm(i).norm() * f.get(i).norm()),
        )
    }

    #[test]
    fn balanced_laws_keep_force_and_torque_where_the_bare_ones_do_not() {
        let (force, torque) = net(Form::Paper2011Balanced);
        assert!(force < 1e-12 && torque < 1e-12, "{force:e} {torque:e}");
        let (force, _) = net(Form::Paper2011);
        assert!(force > 1e-5, "{force:e}");
    }
}
