//! Membrane viscosity that an explicit step bears.

use super::Law;
use super::elements::length;
use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{Soa3Mut, Soa3Ref, StateError, StateReader, StateWriter};
use std::sync::Arc;

/// Viscosity within the membrane by a spring and a dashpot in line along each edge (Maxwell): beside an elastic
/// membrane of shear modulus G this is the standard linear solid, with which Li and Zhang (Int. J. Numer. Meth.
/// Biomed. Eng. 35, e3200, 2019) and others compute red blood cells.
///
/// The pull of an edge of length L is k e, e the stretch of its spring, and de/dt = dL/dt - e/tau. A network of
/// equilateral triangles has the shear viscosity eta = sqrt(3)/4 k tau and the dilatational one 2 eta; k = 4
/// G'/sqrt(3) with the shear modulus G' of the springs alone, tau = eta/G'. On uneven meshes k is less by the factor
/// that makes the tension of a uniform dilation right. A shape recovers within eta (1/G + 1/G'): with G' of 20 G 5 %
/// later than with [`Viscosity`](super::Viscosity). Unlike that law, whose force on a node grows with the node's
/// velocity and needs steps of rho h^2/eta, this one limits a step as a membrane of shear modulus G' does.
///
/// Keeps force and torque. The springs are without tension in the rest shape at the start; [`Law::advance`] moves them
/// on.
#[derive(Clone, Debug)]
pub struct Maxwell {
    ends: Arc<[[u32; 2]]>,
    /// Lengths when it was last moved on, m.
    last: Vec<f64>,
    /// Stretch of the springs then, m.
    stretch: Vec<f64>,
    stiffness: f64,
    time: f64,
}

impl Maxwell {
    /// On the edges of `mesh`, with the shear `viscosity` eta in N s/m and the shear modulus `spring` G' in N/m, some
    /// 10 to 20 times that of the membrane.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn new(mesh: &Mesh, viscosity: f64, spring: f64) -> Result<Self, MembraneError> {
        positive("the shear viscosity of a membrane", viscosity)?;
        positive("the shear modulus of the springs of a viscous membrane", spring)?;
        let x = mesh.nodes();
        let ends: Arc<[_]> = mesh.edges().iter().map(|e| e.nodes).collect();
        let last: Vec<f64> = ends.iter().map(|&e| length(x, e)).collect();
        let squares: f64 = last.iter().map(|l| l * l).sum();
        Ok(Self {
            last,
            stretch: vec![0.0; ends.len()],
            ends,
            // 4/sqrt(3) G' on equilateral triangles, where the squares sum to 2 sqrt(3) S.
            stiffness: 8.0 * spring * mesh.area() / squares,
            time: viscosity / spring,
        })
    }
}

/// Length of an edge, m.
impl Law for Maxwell {
    fn name(&self) -> &str {
        "Maxwell viscosity"
    }

    fn add_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for ((&[a, b], last), stretch) in self.ends.iter().zip(&self.last).zip(&self.stretch) {
            let (a, b) = (a as usize, b as usize);
            let d = x.get(b) - x.get(a);
            let length = d.norm();
            // Since it was last moved on the spring alone gives way.
            let f = d * (self.stiffness * (stretch + length - last) / length);
            force.add(a, f);
            force.add(b, -f);
        }
    }

    fn advance(&mut self, x: Soa3Ref<'_>, time_step: f64) {
        // Exact for an edge that grows evenly within the step.
        let share = time_step / self.time;
        let (kept, taken) = ((-share).exp(), -(-share).exp_m1() / share);
        for ((&ends, last), stretch) in self.ends.iter().zip(&mut self.last).zip(&mut self.stretch) {
            let now = length(x, ends);
            *stretch = *stretch * kept + (now - *last) * taken;
            *last = now;
        }
    }

    fn save(&self, to: &mut StateWriter) {
        to.numbers(&self.last);
        to.numbers(&self.stretch);
    }

    fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        from.numbers(&mut self.last)?;
        from.numbers(&mut self.stretch)
    }
}
