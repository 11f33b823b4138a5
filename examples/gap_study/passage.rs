//! Watches a cell on its way: pass, stuck or undecided.

use crate::device::Device;
use crate::empty::Empty;
use lbm_ibm::coupling::{Scene, SceneError, Soa3Ref, enclosed_volume, surface_area};
use lbm_ibm::membrane::{Cell, Edge, Mesh};
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::Arc;

/// Steps between two looks.
const EVERY: u64 = 20;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// The rearmost node is one cell radius downstream of the slit.
    Pass,
    /// The cell stands still in the slit, and its forces are settled.
    Stuck,
    /// Neither within twenty times the undisturbed fluid's transit.
    Undecided,
    /// The run ended with an error.
    Failed,
}

/// What is seen on the way, in SI.
pub struct Passage<'a> {
    device: &'a Device,
    empty: &'a Empty,
    cell: u32,
    mesh: Arc<Mesh>,
    /// When the nose met the entry plane.
    clock: Option<f64>,
    history: VecDeque<Moment>,
    /// Least distance of a node from the walls, m.
    pub least_wall_distance: f64,
    /// Greatest relative growth of the area.
    pub greatest_area_strain: f64,
    /// Relative change of the volume, the one of greatest size.
    pub volume_drift: f64,
    /// Least area of a triangle over its area at rest.
    pub least_triangle: f64,
    /// Most edges at once whose two triangles face away from each other.
    pub folded_edges: usize,
    /// Greatest pressure drop since the nose met the entry plane, Pa.
    pub peak_pressure_drop: f64,
    /// Pressure drop at the last look, Pa.
    pub pressure_drop: f64,
    /// Time from the nose's meeting the entry plane to the end, s.
    pub elapsed: f64,
}

#[derive(Clone, Copy)]
struct Moment {
    time: f64,
    centre: f64,
    pressure_drop: f64,
    contact: f64,
}

impl<'a> Passage<'a> {
    /// Begins to watch body `id`, which is `cell`.
    pub fn new(device: &'a Device, empty: &'a Empty, cell: &Cell, id: u32) -> Self {
        Self {
            device,
            empty,
            cell: id,
            mesh: cell.mesh().clone(),
            clock: None,
            history: VecDeque::new(),
            least_wall_distance: f64::INFINITY,
            greatest_area_strain: 0.0,
            volume_drift: 0.0,
            least_triangle: 1.0,
            folded_edges: 0,
            peak_pressure_drop: 0.0,
            pressure_drop: 0.0,
            elapsed: 0.0,
        }
    }

    /// Looks at the scene; says how the run ends, when it does.
    pub fn look(&mut self, scene: &Scene) -> Result<Option<Outcome>, SceneError> {
        if !scene.steps().is_multiple_of(EVERY) {
            return Ok(None);
        }
        let x = scene.body_positions(self.cell)?;
        let triangles = self.mesh.triangles();
        let nose = x.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let tail = x.x.iter().copied().fold(f64::INFINITY, f64::min);
        self.least_wall_distance = self.least_wall_distance.min(scene.wall_distance(self.cell)?);
        let strain = surface_area(x, triangles) / self.mesh.area() - 1.0;
        self.greatest_area_strain = self.greatest_area_strain.max(strain);
        let drift = enclosed_volume(x, triangles) / self.mesh.volume() - 1.0;
        if drift.abs() > self.volume_drift.abs() {
            self.volume_drift = drift;
        }
        self.look_at_mesh(x);
        self.pressure_drop = scene.fluid().map_or(0.0, |f| f.body_force().x) * self.device.length;
        if self.clock.is_none() && nose >= self.device.entry {
            self.clock = Some(scene.time());
        }
        let Some(start) = self.clock else {
            // Flow that never brings the cell to the slit is given up after as long as the passage may take.
            let late = scene.time() > 20.0 * self.empty.transit + self.approach();
            return Ok(late.then_some(Outcome::Undecided));
        };
        self.peak_pressure_drop = self.peak_pressure_drop.max(self.pressure_drop);
        self.elapsed = scene.time() - start;
        if tail >= self.device.exit + 0.5 * self.device.subject.diameter() {
            return Ok(Some(Outcome::Pass));
        }
        self.history.push_back(Moment {
            time: scene.time(),
            centre: x.mean().x,
            pressure_drop: self.pressure_drop,
            contact: scene.loads().wall.iter().map(|f| f.x).sum(),
        });
        if self.stands_still(drift) {
            return Ok(Some(Outcome::Stuck));
        }
        Ok((self.elapsed > 20.0 * self.empty.transit).then_some(Outcome::Undecided))
    }

    fn look_at_mesh(&mut self, x: Soa3Ref<'_>) {
        let area = |x: Soa3Ref<'_>, t: usize| {
            let [a, b, c] = self.mesh.triangles()[t].map(|i| x.get(i as usize));
            (b - a).cross(&(c - a))
        };
        let ratio = |t: usize| area(x, t).norm() / area(self.mesh.nodes(), t).norm();
        let least = (0..self.mesh.triangles().len()).map(ratio).fold(1.0, f64::min);
        let folded = |e: &&Edge| area(x, e.triangles[0] as usize).dot(&area(x, e.triangles[1] as usize)) < 0.0;
        let count = self.mesh.edges().iter().filter(folded).count();
        self.least_triangle = self.least_triangle.min(least);
        self.folded_edges = self.folded_edges.max(count);
    }

    /// Time in which the mean flow of the channel covers the way to the slit, s.
    fn approach(&self) -> f64 {
        self.device.entry / self.device.velocity
    }

    /// Centroid slower than 1 % of the empty gap's velocity over twice the entry time, volume within 1 %, pressure drop
    /// and wall force settled to 1 %.
    fn stands_still(&mut self, drift: f64) -> bool {
        let window = 2.0 * self.empty.entry;
        let (Some(&now), Some(start)) = (self.history.back(), self.clock) else {
            return false;
        };
        if now.time - start < window {
            return false;
        }
        while self.history.get(1).is_some_and(|m| m.time <= now.time - window) {
            self.history.pop_front();
        }
        let then = self.history[0];
        let speed = (now.centre - then.centre) / (now.time - then.time);
        let settled = |a: f64, b: f64| (a - b).abs() <= 0.01 * b.abs();
        speed.abs() < 0.01 * self.device.gap_velocity()
            && drift.abs() < 0.01
            && settled(then.pressure_drop, now.pressure_drop)
            && settled(then.contact, now.contact)
    }
}
