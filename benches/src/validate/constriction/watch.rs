//! What is seen of a passage.

use super::wall::Throat;
use crate::Fault;
use crate::validate::driven::mean_force;
use lbm_ibm::coupling::{Scene, SceneError, Soa3Ref, Vec3, enclosed_volume, surface_area};
use lbm_ibm::membrane::Mesh;
use std::sync::Arc;

/// The transit is that of the centroid from this distance before the middle of the throat to as far behind it, in radii of the
/// capsule.
const WAY: f64 = 3.0;
/// Transit, in radii of the capsule over the throat's mean velocity, after which a capsule is given up.
const LONGEST: f64 = 60.0;

/// A passage in short. Lengths in radii of the capsule unless it is said otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Passed {
    /// Time for the way, in radii of the capsule over the throat's mean velocity; not a number where it did not get there.
    pub transit: f64,
    /// Pressure drop less that of the empty device in the units of `entering`, summed over the transit.
    pub impulse: f64,
    /// Pressure drop of the empty device over the period, in the units of `entering`.
    pub empty: f64,
    /// Greatest pressure drop less that of the empty device, in units of viscosity times the throat's mean velocity over its radius,
    /// before the centroid leaves the straight part of the throat.
    pub entering: f64,
    /// The same from there on.
    pub leaving: f64,
    /// Places of the centroid then, from the middle of the throat.
    pub places: [f64; 2],
    /// Greatest axial extent over twice the radius.
    pub length: f64,
    /// Least distance of the capsule's surface from the wall.
    pub film: f64,
    /// Greatest relative growth of the area.
    pub area: f64,
    /// Greatest angle between the normals of two neighbouring triangles, degrees.
    pub fold: f64,
    /// Steps taken with the capsule.
    pub steps: u64,
}

/// Looks at a capsule on its way.
pub struct Watch<'a> {
    throat: &'a Throat,
    mesh: &'a Arc<Mesh>,
    id: u32,
    radius: f64,
    velocity: f64,
}

impl<'a> Watch<'a> {
    /// On body `id`; `sizes` are the capsule's radius (m) and the throat's mean velocity (m/s).
    pub fn new(throat: &'a Throat, mesh: &'a Arc<Mesh>, id: u32, sizes: [f64; 2]) -> Self {
        let [radius, velocity] = sizes;
        Self {
            throat,
            mesh,
            id,
            radius,
            velocity,
        }
    }

    /// Goes on until the centroid is through; a look every `window` steps. `empty` is the force density (N/m3) of the empty
    /// device.
    ///
    /// # Errors
    /// What the scene finds.
    pub fn follow(&mut self, scene: &mut Scene, window: usize, empty: f64) -> Result<Passed, Fault> {
        let first = scene.steps();
        let unit = self.radius / self.velocity;
        let mut passed = Passed {
            transit: f64::NAN,
            impulse: 0.0,
            empty: f64::NAN,
            entering: 0.0,
            leaving: 0.0,
            places: [0.0; 2],
            length: 0.0,
            film: f64::INFINITY,
            area: 0.0,
            fold: 0.0,
            steps: 0,
        };
        let period = scene
            .fluid()
            .map_or(0.0, |f| f.grid().shape[0] as f64 * f.grid().spacing);
        let viscosity = scene.fluid().map_or(0.0, |f| f.viscosity());
        let throat = self.throat.tube - self.throat.lip;
        let unit_pressure = viscosity * self.velocity / throat;
        passed.empty = empty * period / unit_pressure;
        let mut entered = f64::NAN;
        let (mut before, mut then) = (self.place(scene)?, scene.time());
        while scene.time() < then.max(0.0) + LONGEST * unit {
            let extra = (mean_force(scene, window)? - empty) * period / unit_pressure;
            let (place, now) = (self.place(scene)?, scene.time());
            // When it was at `mark`, if it was since the last look.
            let when = |mark: f64| {
                (before < mark && place >= mark)
                    .then(|| (then + (now - then) * (mark - before) / (place - before)) / unit)
            };
            let left = when(WAY);
            entered = when(-WAY).unwrap_or(entered);
            // What of the time since the last look was between the marks.
            let during = left.unwrap_or(now / unit) - entered.max(then / unit);
            if !entered.is_nan() {
                passed.impulse += extra * during;
            }
            if place * self.radius < self.throat.half {
                if extra > passed.entering {
                    (passed.entering, passed.places[0]) = (extra, place);
                }
            } else if extra > passed.leaving {
                (passed.leaving, passed.places[1]) = (extra, place);
            }
            self.look(scene, &mut passed)?;
            if let Some(left) = left {
                passed.transit = left - entered;
                break;
            }
            (before, then) = (place, now);
        }
        passed.steps = scene.steps() - first;
        Ok(passed)
    }

    /// Place of the centroid of the volume from the middle of the throat, in radii.
    fn place(&self, scene: &Scene) -> Result<f64, SceneError> {
        let x = scene.body_positions(self.id)?;
        let origin = x.mean();
        let mut moment = 0.0;
        for t in self.mesh.triangles() {
            let [a, b, c] = t.map(|i| x.get(i as usize) - origin);
            moment += a.dot(&b.cross(&c)) / 6.0 * (a.x + b.x + c.x) / 4.0;
        }
        let centre = origin.x + moment / enclosed_volume(x, self.mesh.triangles());
        Ok((centre - self.throat.centre.x) / self.radius)
    }

    fn look(&self, scene: &Scene, passed: &mut Passed) -> Result<(), SceneError> {
        let x = scene.body_positions(self.id)?;
        let nose = x.x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let rear = x.x.iter().copied().fold(f64::INFINITY, f64::min);
        let length = (nose - rear) / (2.0 * self.radius);
        passed.length = passed.length.max(length);
        let film = scene.wall_distance(self.id)? / self.radius;
        passed.film = passed.film.min(film);
        let area = surface_area(x, self.mesh.triangles()) / self.mesh.area() - 1.0;
        passed.area = passed.area.max(area);
        passed.fold = passed.fold.max(self.fold(x));
        Ok(())
    }

    /// Greatest angle between neighbouring normals, degrees.
    fn fold(&self, x: Soa3Ref<'_>) -> f64 {
        let normal = |t: u32| -> Vec3 {
            let [a, b, c] = self.mesh.triangles()[t as usize].map(|i| x.get(i as usize));
            (b - a).cross(&(c - a))
        };
        let angle = |t: [u32; 2]| normal(t[0]).angle(&normal(t[1])).to_degrees();
        self.mesh.edges().iter().map(|e| angle(e.triangles)).fold(0.0, f64::max)
    }
}
