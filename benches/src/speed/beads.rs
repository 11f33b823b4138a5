//! What rigid beads cost in a step, and that nothing of elastic cells runs beside them.

use super::times;
use crate::Fault;
use crate::scenes::plasma;
use lbm_ibm::coupling::nalgebra::{Isometry3, Translation3};
use lbm_ibm::coupling::{
    BodyInfo, Bricks, Exchange, ExchangeError, Grid, ImmersedBody, Lattice, Motion, Rigid, RigidState, Scene, Soa3,
    Soa3Mut, Soa3Ref, UM, Vec3,
};
use lbm_ibm::ibm::{DeltaExchange, Kernel, RigidBody};
use lbm_ibm::lbm::{Drive, Fluid};
use serde::Serialize;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Radius of a bead, m.
const RADIUS: f64 = 4.0 * UM;

/// Timings of beads in a periodic cube with a grid of 1 um. Medians, and the least times, which other work on the machine
/// disturbs less.
#[derive(Debug, Serialize)]
pub struct Speed {
    /// Nodes along each edge of the cube.
    pub size: usize,
    /// Beads of 4 spacings.
    pub count: usize,
    /// Threads.
    pub threads: usize,
    /// Markers of all beads.
    pub markers: usize,
    /// Whole step.
    pub ms_per_step: f64,
    /// Least whole step.
    pub best_ms_per_step: f64,
    /// Step of the bare fluid under the same force.
    pub fluid_ms_per_step: f64,
    /// Least step of the bare fluid.
    pub best_fluid_ms_per_step: f64,
    /// Placing and holding the beads, mean of a step.
    pub holding_ms: f64,
    /// What the exchange does for elastic bodies, mean of a step.
    pub elastic_exchange_ms: f64,
    /// Times that a body was asked for internal forces, a constraint or a memory, in a step.
    pub body_calls: f64,
    /// Times that forces of elastic nodes were spread or velocities interpolated to them, in a step.
    pub elastic_calls: f64,
}

/// What has been called, and how long it took, ns.
#[derive(Debug, Default)]
struct Tally {
    body: AtomicU64,
    elastic: AtomicU64,
    elastic_ns: AtomicU64,
    holding_ns: AtomicU64,
}

impl Tally {
    fn timed<T>(to: &AtomicU64, work: impl FnOnce() -> T) -> T {
        let clock = Instant::now();
        let out = work();
        to.fetch_add(clock.elapsed().as_nanos() as u64, Ordering::Relaxed);
        out
    }

    fn reset(&self) {
        for count in [&self.body, &self.elastic, &self.elastic_ns, &self.holding_ns] {
            count.store(0, Ordering::Relaxed);
        }
    }
}

/// A body that counts what it is asked for in a step.
struct Watched(RigidBody, Arc<Tally>);

impl ImmersedBody for Watched {
    fn kind(&self) -> &str {
        self.0.kind()
    }
    fn reference(&self) -> Soa3Ref<'_> {
        self.0.reference()
    }
    fn triangles(&self) -> &[[u32; 3]] {
        self.0.triangles()
    }
    fn motion(&self) -> Motion {
        self.0.motion()
    }
    fn rigid(&self) -> Option<Rigid> {
        self.0.rigid()
    }
    fn markers(&self, spacing: f64, scale: f64) -> Soa3 {
        self.0.markers(spacing, scale)
    }
    fn add_internal_forces(&mut self, x: Soa3Ref<'_>, v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        self.1.body.fetch_add(1, Ordering::Relaxed);
        self.0.add_internal_forces(x, v, force);
    }
    fn constrain(&mut self, x: &mut Soa3Mut<'_>) {
        self.1.body.fetch_add(1, Ordering::Relaxed);
        self.0.constrain(x);
    }
    fn advance(&mut self, x: Soa3Ref<'_>, time_step: f64) {
        self.1.body.fetch_add(1, Ordering::Relaxed);
        self.0.advance(x, time_step);
    }
}

/// An exchange that counts its calls.
struct Clocked(DeltaExchange, Arc<Tally>);

impl Exchange for Clocked {
    fn set_bodies(&mut self, bodies: &[BodyInfo], reference: Soa3Ref<'_>, grid: &Grid) -> Result<(), ExchangeError> {
        self.0.set_bodies(bodies, reference, grid)
    }
    fn place(&mut self, x: Soa3Ref<'_>, bricks: &mut Bricks) -> Result<(), ExchangeError> {
        // Also takes up the bricks that beads have asked for.
        Tally::timed(&self.1.elastic_ns, || self.0.place(x, bricks))
    }
    fn interpolate(&mut self, bricks: &Bricks, velocity: Soa3Mut<'_>) {
        self.1.elastic.fetch_add(1, Ordering::Relaxed);
        Tally::timed(&self.1.elastic_ns, || self.0.interpolate(bricks, velocity));
    }
    fn spread(&mut self, force: Soa3Ref<'_>, bricks: &mut Bricks) {
        self.1.elastic.fetch_add(1, Ordering::Relaxed);
        Tally::timed(&self.1.elastic_ns, || self.0.spread(force, bricks));
    }
    fn set_rigid(&mut self, bodies: &[(u32, &dyn ImmersedBody)], grid: &Grid) -> Result<(), ExchangeError> {
        self.0.set_rigid(bodies, grid)
    }
    fn place_rigid(&mut self, bodies: &[RigidState], bricks: &mut Bricks) -> Result<(), ExchangeError> {
        Tally::timed(&self.1.holding_ns, || self.0.place_rigid(bodies, bricks))
    }
    fn hold_rigid(
        &mut self,
        bodies: &mut [RigidState],
        density: f64,
        viscosity: f64,
        time_step: f64,
        bricks: &mut Bricks,
    ) -> Result<(), ExchangeError> {
        let Self(exchange, tally) = self;
        Tally::timed(&tally.holding_ns, || {
            exchange.hold_rigid(bodies, density, viscosity, time_step, bricks)
        })
    }
}

/// The fluid.
fn fluid(size: usize) -> Result<Fluid, Fault> {
    let fluid = plasma(Grid::new([size; 3], UM, [true; 3]), 0.9, 80.0)?;
    Ok(fluid.with_drive(Drive::Force(Vec3::x() * 1e3))?)
}

/// A scene of `count` beads on a lattice.
fn scene(size: usize, count: usize, tally: &Arc<Tally>) -> Result<Scene, Fault> {
    let per_edge = (1..).find(|n: &usize| n.pow(3) >= count).unwrap_or(1);
    let pitch = size as f64 * UM / per_edge as f64;
    if pitch < 3.0 * RADIUS {
        return Err(
            format!("{count} beads of 8 um do not fit into {size} um: use a larger cube or fewer beads").into(),
        );
    }
    let exchange = Clocked(DeltaExchange::new(Kernel::RomaThree), tally.clone());
    let fluid = fluid(size)?;
    let density = fluid.density();
    let mut scene = Scene::with_fluid(fluid, exchange);
    for i in 0..count {
        let place = [i % per_edge, i / per_edge % per_edge, i / (per_edge * per_edge)];
        let place = Vec3::from(place.map(|c| (c as f64 + 0.5) * pitch)) + Vec3::new(0.13, 0.29, 0.41) * UM;
        let body = Watched(RigidBody::sphere(RADIUS, 1.5 * density)?, tally.clone());
        scene.add_body(body, &Isometry3::from(Translation3::from(place)))?;
    }
    Ok(scene)
}

/// Times beads for at least `seconds` each: the bare fluid, and whole steps.
///
/// # Errors
/// [`Fault`] where the beads do not fit.
pub fn beads(size: usize, count: usize, threads: usize, seconds: f64) -> Result<Speed, Fault> {
    let mut bare = fluid(size)?;
    let bricks = Bricks::new(bare.grid());
    let tally = Arc::new(Tally::default());
    let mut scene = scene(size, count, &tally)?;
    // Until the forces of the markers have come to their size.
    (0..40).try_for_each(|_| scene.step())?;
    tally.reset();
    let before = scene.steps();
    // Even and odd steps differ: a pair at a time. The two take turns, so that other work disturbs both alike.
    let (mut fluid_times, mut whole) = (Vec::new(), Vec::new());
    times(seconds, || {
        let start = Instant::now();
        bare.advance(&bricks)?;
        bare.advance(&bricks)?;
        fluid_times.push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        scene.step()?;
        scene.step()?;
        whole.push(start.elapsed().as_secs_f64());
        Ok(())
    })?;
    let steps = (scene.steps() - before) as f64;
    let sorted = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        [times[times.len() / 2] / 2e-3, times[0] / 2e-3]
    };
    let [fluid_ms_per_step, best_fluid_ms_per_step] = sorted(fluid_times);
    let [ms_per_step, best_ms_per_step] = sorted(whole);
    let exchange: &Clocked = scene.exchange_as().ok_or("the exchange is the one given")?;
    let of = |count: &AtomicU64| count.load(Ordering::Relaxed) as f64 / steps;
    Ok(Speed {
        size,
        count,
        threads,
        markers: exchange.0.rigid_marker_count(),
        ms_per_step,
        best_ms_per_step,
        fluid_ms_per_step,
        best_fluid_ms_per_step,
        holding_ms: 1e-6 * of(&tally.holding_ns),
        elastic_exchange_ms: 1e-6 * of(&tally.elastic_ns),
        body_calls: of(&tally.body),
        elastic_calls: of(&tally.elastic),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_of_rigid_beads_asks_for_nothing_elastic() {
        let speed = beads(32, 2, 1, 0.0).unwrap();
        assert_eq!((speed.body_calls, speed.elastic_calls), (0.0, 0.0), "{speed:?}");
        assert!(speed.holding_ms > 0.0 && speed.markers > 100, "{speed:?}");
    }
}
