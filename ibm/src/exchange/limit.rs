//! The longest step at which a lattice fluid that forgets slowly bears a stiff body.

use super::DeltaExchange;
use crate::slip;
use crate::stability::largest_rate;
use lbm_ibm_coupling::{BodyInfo, Bricks, Exchange, Grid, ImmersedBody, Motion, Soa3, Soa3Ref};

/// Share of the computed limit that is handed out. The facade's test `stiff_hinges` holds what is handed out between two thirds of the longest
/// stable step and that step.
const SAFETY: f64 = 0.9;

impl DeltaExchange {
    /// Longest step (s) of a body that the fluid carries, with nodes at `x` (m), where a force F (N) on a node of the grid, of `density` (kg/m3),
    /// gives it the velocity `dt F/(rho h^3)` in every step, of which nothing is left in the next. Explicit steps bear that to `dt^2 =
    /// 2 / lambda`, `lambda` (1/s2) the largest eigenvalue of `J S K/(rho h^3)` by power iteration, `S` and `J` spreading and
    /// interpolation where the body is, `K` its stiffness felt by displacements of `probe` (m). A fluid that keeps what it has
    /// bears twice that, one in which it turns round in every step, as at long relaxation times, hardly more.
    ///
    /// None where the body has no stiffness or is not on the grid.
    pub(super) fn step_on_grid(
        &self,
        body: &mut dyn ImmersedBody,
        x: Soa3Ref<'_>,
        density: f64,
        grid: &Grid,
        probe: f64,
    ) -> Option<f64> {
        let info = BodyInfo {
            id: 0,
            kind: String::new(),
            range: 0..x.len(),
            triangles: body.triangles().into(),
            motion: body.motion(),
        };
        let mut own = Self::new(self.kernel).with_markers(self.markers);
        let mut bricks = Bricks::new(grid);
        own.set_bodies(&[info], body.reference(), grid).ok()?;
        own.place(x, &mut bricks).ok()?;
        let mobility = 1.0 / (density * grid.spacing.powi(3));
        let square = largest_rate(body, x, probe, |f| {
            bricks.clear_force();
            own.spread(f.view(), &mut bricks);
            bricks.velocity_from_force(mobility);
            let mut u = Soa3::zeros(f.len());
            own.interpolate(&bricks, u.view_mut());
            u
        })?;
        Some(SAFETY * (2.0 / square).sqrt())
    }
}

impl DeltaExchange {
    /// Longest step (s) for the slip of the nodes alone, infinite where they do not slip.
    pub(super) fn slip_step(&self, body: &mut dyn ImmersedBody, x: Soa3Ref<'_>, probe: f64) -> f64 {
        let carried = body.motion() == Motion::Advected && !body.triangles().is_empty();
        let Some(grid) = self.grid.as_ref().filter(|_| carried && self.elastic_slip.is_some()) else {
            return f64::INFINITY;
        };
        let ratio = body.viscosity_ratio().unwrap_or(1.0);
        let ease = slip::ease(self.kernel, ratio, grid.spacing, self.viscosity);
        let triangles = body.triangles().to_vec();
        let slip = |f: &Soa3| slip::velocities(x, &triangles, f, ease).collect();
        largest_rate(body, x, probe, slip).map_or(f64::INFINITY, |rate| SAFETY * 2.0 / rate)
    }
}

/// Longest step `t` (s) of motions that add up, whose rates do so at most: `t/a + t/b + c t^2 = 1`.
pub(super) fn with_slip(a: f64, b: f64, c: f64) -> f64 {
    let rate = 1.0 / a + 1.0 / b;
    2.0 / (rate + (rate * rate + 4.0 * c).sqrt())
}
