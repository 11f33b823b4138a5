//! An elastic cell.

use crate::constraint::ConstantVolume;
use crate::mesh::positive;
use crate::{Law, MembraneError, Mesh};
use lbm_ibm_coupling::{ImmersedBody, Motion, Soa3Mut, Soa3Ref, StateError, StateReader, StateWriter};
use std::fmt;
use std::sync::Arc;

/// An elastic cell: a shared rest shape and a list of membrane laws. By default the fluid carries its nodes.
#[derive(Clone)]
pub struct Cell {
    kind: String,
    mesh: Arc<Mesh>,
    laws: Vec<Box<dyn Law>>,
    motion: Motion,
    volume: Option<ConstantVolume>,
    viscosity_ratio: Option<f64>,
}

impl Cell {
    /// A cell named `kind` at rest on `mesh` (about the origin), without any law yet.
    pub fn new(kind: impl Into<String>, mesh: Arc<Mesh>) -> Self {
        Self {
            kind: kind.into(),
            mesh,
            laws: Vec::new(),
            motion: Motion::Advected,
            volume: None,
            viscosity_ratio: None,
        }
    }

    /// The cell with one more law.
    pub fn with_law(mut self, law: impl Law + 'static) -> Self {
        self.laws.push(Box::new(law));
        self
    }

    /// The cell with another way of moving its nodes.
    pub fn with_motion(mut self, motion: Motion) -> Self {
        self.motion = motion;
        self
    }

    /// The cell with its volume held at that of its rest shape: after each step the nodes are moved along the gradient of the
    /// volume, all by the same small factor. Nodes that the fluid carries go round a little outside of their paths, by the
    /// second order of the step, and a cell that rolls or tank-treads would swell: a sphere by a fraction
    /// `(rate of turning)^2 time step` in a unit of time. A law cannot hold that, since the fluid inside does not yield.
    pub fn with_constant_volume(mut self) -> Self {
        self.volume = Some(ConstantVolume::of(&self.mesh));
        self
    }

    /// The cell with a fluid inside whose viscosity is `ratio` times that of the fluid around.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`].
    pub fn with_viscosity_ratio(mut self, ratio: f64) -> Result<Self, MembraneError> {
        self.viscosity_ratio = Some(positive("the viscosity inside over that around", ratio)?);
        Ok(self)
    }

    /// Its rest shape, shared with its copies.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Its laws.
    pub fn laws(&self) -> &[Box<dyn Law>] {
        &self.laws
    }
}

impl ImmersedBody for Cell {
    fn kind(&self) -> &str {
        &self.kind
    }

    fn reference(&self) -> Soa3Ref<'_> {
        self.mesh.nodes()
    }

    fn triangles(&self) -> &[[u32; 3]] {
        self.mesh.triangles()
    }

    fn motion(&self) -> Motion {
        self.motion
    }

    fn add_internal_forces(&mut self, x: Soa3Ref<'_>, v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for law in &mut self.laws {
            law.add_forces(x, v, force);
        }
    }

    fn viscosity_ratio(&self) -> Option<f64> {
        self.viscosity_ratio.filter(|r| *r != 1.0)
    }

    fn constrain(&mut self, x: &mut Soa3Mut<'_>) {
        if let Some(volume) = &mut self.volume {
            volume.restore(self.mesh.triangles(), x);
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

    fn energy(&self, x: Soa3Ref<'_>) -> Option<f64> {
        self.laws.iter().map(|law| law.energy(x)).sum()
    }
}

impl fmt::Debug for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let laws: Vec<_> = self.laws.iter().map(|l| l.name()).collect();
        f.debug_struct("Cell")
            .field("kind", &self.kind)
            .field("nodes", &self.mesh.nodes().len())
            .field("laws", &laws)
            .field("motion", &self.motion)
            .finish()
    }
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}", self.kind, self.mesh.quality())?;
        let laws: Vec<_> = self.laws.iter().map(|l| l.name()).collect();
        write!(f, "  laws: {}", laws.join(", "))
    }
}
