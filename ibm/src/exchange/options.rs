//! What an exchange is set to, and what it tells of itself.

use super::{DeltaExchange, part};
use crate::forcing::End;
use crate::inset::Inset;
use crate::kernel::Kernel;
use crate::slip::Slip;
use crate::surface::{Markers, Surface};
use crate::table::Table;
#[cfg(doc)]
use lbm_ibm_coupling::{Exchange, ExchangeError, ImmersedBody};
use lbm_ibm_coupling::{Soa3, Soa3Ref};

impl DeltaExchange {
    /// The same with other markers.
    pub fn with_markers(mut self, markers: Markers) -> Self {
        self.markers = markers;
        self
    }

    /// Whether the markers of rigid bodies sit inside their surface by [`Kernel::rigid_inset`] and have the slip of [`Kernel::rigid_slip`],
    /// so that the body acts as large as it is in any flow; they do by default. Else they lie on the surface and do not slip.
    pub fn with_inset(mut self, inset: bool) -> Self {
        self.inset = inset;
        self
    }

    /// Whether the markers of bodies with triangles that are not rigid sit inside their surface by
    /// [`Kernel::hydrodynamic_shift`], so that their size and drag depend neither on the kernel nor on the grid; they do
    /// not by default. A surface bent more sharply than that ends the run with [`ExchangeError::Fold`].
    ///
    /// This and [`DeltaExchange::with_elastic_slip`] correct the same: what is switched on last holds.
    pub fn with_elastic_inset(mut self, inset: bool) -> Self {
        if inset {
            self.elastic_slip = None;
        }
        self.elastic_inset = inset.then(Inset::default);
        self
    }

    /// Whether nodes of surfaces that the fluid carries slip: along the surface they move ahead of the velocity that the kernel reads, by
    /// [`Kernel::hydrodynamic_shift`] spacings times the tangential force on their area over the fluid's viscosity, which is what the kernel takes off the
    /// kink of the velocity there; they do not by default. With it, and nodes on the surface itself, capsules that tread round deform as they
    /// should to second order in the spacing, where an inset is right only if the fluid inside does not deform. It makes stiff
    /// membranes move faster, so that the longest stable step is shorter. The step is checked for the membrane as it stands at the start:
    /// where it stiffens as it is stretched, above all on a mesh finer than the grid, leave some room.
    ///
    /// Around a fluid of another viscosity ([`ImmersedBody::viscosity_ratio`]) nodes slip less the more viscous it is, and the markers sit on a parallel surface
    /// in the more viscous of the two, 0.4 spacings deep for a ratio of 5 and three points: there the force meets the fluid that has to bear it. An error of the
    /// first order stays, by the fluid's own transition from one viscosity to the other: shells of 6 spacings around 5 times the viscosity are 0.3 to 12 % off by the way
    /// they move (the facade's test `elastic_slip`). For capsules take [`DeltaExchange::with_elastic_inset`] there. A surface bent more sharply than the markers are deep ends the run with
    /// [`ExchangeError::Fold`].
    ///
    /// The viscosities come with [`Exchange::set_viscosity`], which a scene calls; without it [`Exchange::set_bodies`] is the error [`ExchangeError::NoViscosity`].
    pub fn with_elastic_slip(mut self, slip: bool) -> Self {
        self.elastic_slip = slip.then(Slip::default);
        if slip {
            self.elastic_inset = None;
        }
        self
    }

    /// Where the iteration that makes the fluid follow rigid bodies ends in each step: at this relative slip
    /// ([`DeltaExchange::rigid_slip`]), or after so many iterations. By default 1e-3 and 30; at least one is taken, which alone
    /// is direct forcing that begins with the forces of the step before.
    pub fn with_rigid_iterations(mut self, slip: f64, iterations: usize) -> Self {
        self.rigid.end = End { slip, iterations };
        self
    }

    /// How the last step came to terms with rigid bodies: their greatest relative slip (the norm over all markers of the
    /// velocity that is left against the surface, over that of the fluid without the bodies) and the iterations taken.
    pub fn rigid_slip(&self) -> (f64, usize) {
        self.rigid.slip()
    }

    /// Number of markers of rigid bodies.
    pub fn rigid_marker_count(&self) -> usize {
        self.rigid.marker_count()
    }

    /// Its kernel.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// Where its markers are.
    pub fn markers(&self) -> Markers {
        self.markers
    }

    /// Number of nodes of all bodies.
    pub fn node_count(&self) -> usize {
        self.nodes
    }

    /// Number of markers of all bodies.
    pub fn marker_count(&self) -> usize {
        self.surfaces.iter().map(|s| s.subdivision.len()).sum()
    }

    /// Each body's number and the parts into which its edges are divided. It grows as a body is stretched and never
    /// shrinks while the body stays.
    pub fn divisions(&self) -> impl Iterator<Item = (u32, usize)> + '_ {
        self.surfaces.iter().map(|s| (s.id, s.division))
    }

    /// Positions of all markers (m) for node positions `x` (m), in the order of the bodies.
    pub fn marker_positions(&self, x: Soa3Ref<'_>) -> Soa3 {
        let of_body = |s: &Surface| {
            let table = Table::new(s.range.len(), std::iter::once((0..s.range.len(), &s.subdivision)));
            let x = part(x, &s.range);
            (0..table.len())
                .map(|m| table.position(m, x).into())
                .collect::<Vec<_>>()
        };
        self.surfaces.iter().flat_map(of_body).collect()
    }
}
