//! The fluid's velocity, as beads feel it.

use crate::error::{MagneticsError, positive};
use lbm_ibm_coupling::{Grid, Soa3, Vec3};
use std::sync::{Arc, RwLock};

/// The undisturbed velocity of the fluid, u(x, t) in m/s; beads are dragged by v - u.
#[derive(Clone, Default)]
pub struct Flow(Kind);

#[derive(Clone, Default)]
enum Kind {
    #[default]
    Rest,
    Given(Arc<dyn Fn(Vec3, f64) -> Vec3 + Send + Sync>),
    Live(Arc<RwLock<SampledFlow>>),
}

impl Flow {
    /// A fluid at rest.
    pub fn at_rest() -> Self {
        Self::default()
    }

    /// Any flow: velocity (m/s) at a place (m) and a time (s).
    pub fn new(velocity: impl Fn(Vec3, f64) -> Vec3 + Send + Sync + 'static) -> Self {
        Self(Kind::Given(Arc::new(velocity)))
    }

    /// The same `velocity` (m/s) everywhere.
    pub fn uniform(velocity: Vec3) -> Self {
        Self::new(move |_, _| velocity)
    }

    /// Simple shear, u = rate ((x - origin) . gradient) direction: zero at `origin` (m), along the unit vector `direction`,
    /// growing along the unit vector `gradient`, at `rate` (1/s).
    pub fn shear(origin: Vec3, direction: Vec3, gradient: Vec3, rate: f64) -> Self {
        Self::new(move |x, _| direction * (rate * (x - origin).dot(&gradient)))
    }

    /// Plane Poiseuille flow between plates at `centre` (m) -+ `height`/2 (m) along the unit vector `across`:
    /// u = 3/2 mean (1 - (2 s/height)^2) with s the distance from the middle; `mean` is the mean velocity (m/s, a vector
    /// along the plates). Zero behind the plates.
    ///
    /// # Errors
    /// [`MagneticsError::NotPositive`] for the height.
    pub fn poiseuille(centre: Vec3, across: Vec3, height: f64, mean: Vec3) -> Result<Self, MagneticsError> {
        let height = positive("height of the slit (m)", height)?;
        Ok(Self::new(move |x, _| {
            let s = 2.0 * (x - centre).dot(&across) / height;
            mean * (1.5 * (1.0 - s * s).max(0.0))
        }))
    }

    /// A lattice's velocity as it was when sampled.
    pub fn frozen(flow: SampledFlow) -> Self {
        Self::new(move |x, _| flow.velocity(x))
    }

    /// A lattice's velocity that the caller renews between steps, through the shared samples.
    pub fn live(flow: Arc<RwLock<SampledFlow>>) -> Self {
        Self(Kind::Live(flow))
    }

    /// Velocity (m/s) at `x` (m) and `t` (s).
    pub fn velocity(&self, x: Vec3, t: f64) -> Vec3 {
        match &self.0 {
            Kind::Rest => Vec3::zeros(),
            Kind::Given(u) => u(x, t),
            // A writer that panicked has left whole vectors behind: samples are replaced at once.
            Kind::Live(flow) => flow.read().unwrap_or_else(|e| e.into_inner()).velocity(x),
        }
    }
}

/// Velocities at the nodes of a lattice, trilinear between them.
///
/// Between the outermost nodes and a face of the box that is not periodic, half a spacing away, the velocity goes on to zero
/// at the face when that is a wall, and stays that of the nodes when it is open (see [`SampledFlow::with_open_faces`]).
#[derive(Clone, Debug)]
pub struct SampledFlow {
    grid: Grid,
    velocity: Soa3,
    open: [bool; 3],
}

impl SampledFlow {
    /// Velocities (m/s) at all nodes of `grid`, x fastest.
    ///
    /// # Errors
    /// [`MagneticsError::Samples`] unless there is one velocity per node.
    pub fn new(grid: Grid, velocity: Soa3) -> Result<Self, MagneticsError> {
        check(&grid, &velocity)?;
        Ok(Self {
            grid,
            velocity,
            open: [false; 3],
        })
    }

    /// Faces across x, y, z through which the fluid flows, where they are not periodic.
    pub fn with_open_faces(mut self, open: [bool; 3]) -> Self {
        self.open = open;
        self
    }

    /// Renews the velocities (m/s), x fastest.
    ///
    /// # Errors
    /// As [`SampledFlow::new`].
    pub fn set(&mut self, velocity: Soa3) -> Result<(), MagneticsError> {
        check(&self.grid, &velocity)?;
        self.velocity = velocity;
        Ok(())
    }

    /// Velocity (m/s) at `x` (m).
    pub fn velocity(&self, x: Vec3) -> Vec3 {
        let at = (self.grid.domain().wrap(x) - self.grid.origin) / self.grid.spacing;
        let ends: [[(usize, f64); 2]; 3] = std::array::from_fn(|a| self.ends(at[a], a));
        let [nx, ny, _] = self.grid.shape;
        let mut u = Vec3::zeros();
        for (k, wz) in ends[2] {
            for (j, wy) in ends[1] {
                for (i, wx) in ends[0] {
                    u += self.velocity.get((k * ny + j) * nx + i) * (wx * wy * wz);
                }
            }
        }
        u
    }

    /// Two nodes and their weights for the coordinate `s`, in spacings from the face of the box.
    fn ends(&self, s: f64, axis: usize) -> [(usize, f64); 2] {
        let n = self.grid.shape[axis];
        let node = s - 0.5;
        if self.grid.periodic[axis] {
            let low = node.floor();
            let w = node - low;
            let wrap = |i: f64| (i as isize).rem_euclid(n as isize) as usize;
            return [(wrap(low), 1.0 - w), (wrap(low + 1.0), w)];
        }
        let last = (n - 1) as f64;
        if node < 0.0 || node > last {
            let i = if node < 0.0 { 0 } else { n - 1 };
            let beyond = if node < 0.0 { -node } else { node - last };
            let w = if self.open[axis] {
                1.0
            } else {
                (1.0 - 2.0 * beyond).max(0.0)
            };
            return [(i, w), (i, 0.0)];
        }
        let low = node.floor().min((last - 1.0).max(0.0));
        let w = node - low;
        [(low as usize, 1.0 - w), ((low as usize + 1).min(n - 1), w)]
    }
}

fn check(grid: &Grid, velocity: &Soa3) -> Result<(), MagneticsError> {
    if velocity.len() != grid.len() || grid.is_empty() {
        return Err(MagneticsError::Samples {
            nodes: grid.len(),
            samples: velocity.len(),
        });
    }
    match velocity.iter().position(|u| !u.iter().all(|c| c.is_finite())) {
        Some(bead) => Err(MagneticsError::NotFinite {
            what: "velocity of the fluid at node",
            bead,
        }),
        None => Ok(()),
    }
}
