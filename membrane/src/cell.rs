//! An elastic cell.

use crate::{Law, Mesh};
use lbm_ibm_coupling::{ImmersedBody, Motion, Soa3Mut, Soa3Ref};
use std::fmt;
use std::sync::Arc;

/// An elastic cell: a shared rest shape and a list of membrane laws. By default the fluid carries its nodes.
#[derive(Clone)]
pub struct Cell {
    kind: String,
    mesh: Arc<Mesh>,
    laws: Vec<Box<dyn Law>>,
    motion: Motion,
}

impl Cell {
    /// A cell named `kind` at rest on `mesh` (about the origin), without any law yet.
    pub fn new(kind: impl Into<String>, mesh: Arc<Mesh>) -> Self {
        Self {
            kind: kind.into(),
            mesh,
            laws: Vec::new(),
            motion: Motion::Advected,
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

    fn advance(&mut self, x: Soa3Ref<'_>, time_step: f64) {
        for law in &mut self.laws {
            law.advance(x, time_step);
        }
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
