//! Many beads that attract each other until they touch.

use super::rigid::{DENSITY, H, VISCOSITY, at, flow, key, stokes};
use super::{Effort, Findings, Outcome};
use crate::Fault;
use lbm_ibm::coupling::{ForceField, Grid, Loads, Scene, Vec3, View};
use lbm_ibm::ibm::{DeltaExchange, Kernel, RigidBody};
use std::f64::consts::PI;
use std::time::Instant;

/// Beads, their radius in grid spacings, and nodes along the edge of the box.
const BEADS: usize = 60;
const RADIUS: f64 = 4.0;
const EDGE: usize = 64;

/// Beads attract each other like parallel dipoles along x, `f0 (2a/r)^4`, and repel with a spring where they are closer than
/// `2a + reach`.
struct Magnets {
    strength: f64,
    stiffness: f64,
    reach: f64,
    x: Vec<Vec3>,
}

impl ForceField for Magnets {
    fn name(&self) -> &str {
        "magnets"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        let diameter = 2.0 * RADIUS * H;
        let centre = |r: &std::ops::Range<usize>| r.clone().map(|i| view.x.get(i)).sum::<Vec3>() / r.len() as f64;
        self.x.clear();
        self.x.extend(view.bodies.iter().map(|b| centre(&b.range)));
        for i in 0..self.x.len() {
            for j in i + 1..self.x.len() {
                let d = view.domain.shortest(self.x[j] - self.x[i]);
                let r = d.norm();
                let (n, along) = (d / r, d.x / r);
                let dipole = self.strength * (diameter / r).powi(4);
                let force = dipole * ((5.0 * along * along - 1.0) * n - 2.0 * along * Vec3::x()) / 2.0;
                let push = self.stiffness * (diameter + self.reach - r).max(0.0);
                loads.body[i].force += force - push * n;
                loads.body[j].force -= force - push * n;
            }
        }
    }

    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        Some(self.stiffness)
    }
}

/// Sixty beads 1.4 times as dense as the fluid form chains: nothing is lost of the momentum, no two overlap, the slip stays
/// small. What they cost is reported against the bare fluid.
pub fn rigid_crowd(effort: Effort) -> Outcome {
    let mut findings = Findings::of("rigid_crowd");
    findings.begin(key(&[("beads", BEADS.to_string()), ("R_over_h", RADIUS.to_string())]));
    let grid = Grid::new([EDGE; 3], H, [true; 3]);
    let fluid = |grid: Grid| stokes(grid, 1.5);
    let bare = {
        let mut scene = Scene::with_fluid(fluid(grid.clone())?, DeltaExchange::new(Kernel::RomaThree));
        seconds_per_step(&mut scene, 40)?
    };
    let mut scene = Scene::with_fluid(fluid(grid)?, DeltaExchange::new(Kernel::RomaThree));
    let bead = RigidBody::sphere(RADIUS * H, 1.4 * DENSITY)?.with_kind("bead");
    let excess = bead.excess_mass(DENSITY);
    for i in 0..BEADS {
        let cell = Vec3::new((i % 4) as f64, (i / 4 % 4) as f64, (i / 16) as f64);
        // Off the lattice a little, differently for each.
        let aside = Vec3::new(0.37, 0.61, 0.83).map(|a| (a * (i + 1) as f64).fract() * 4.0);
        let x = (cell * (EDGE as f64 / 4.0) + aside + Vec3::repeat(RADIUS)) * H;
        scene.add_body(bead.clone(), &at(x))?;
    }
    let speed = 2e-3 * H / scene.time_step();
    let strength = 6.0 * PI * VISCOSITY * RADIUS * H * speed;
    scene.add_field(Magnets {
        strength,
        stiffness: 4.0 * strength / (0.2 * H),
        reach: 0.5 * H,
        x: Vec::new(),
    });
    let steps = if effort.quick { 400 } else { 6000 };
    let (mut nearest, mut slip, mut iterations) = (f64::INFINITY, 0.0_f64, 0);
    let clock = Instant::now();
    for _ in 0..steps {
        scene.step()?;
        let exchange: &DeltaExchange = scene.exchange_as().ok_or("no exchange")?;
        let (left, taken) = exchange.rigid_slip();
        (slip, iterations) = (slip.max(left), iterations + taken);
    }
    let seconds = clock.elapsed().as_secs_f64() / steps as f64;
    let states = scene.rigid_bodies();
    for (i, a) in states.iter().enumerate() {
        for b in &states[i + 1..] {
            let d = scene
                .domain()
                .shortest(b.pose.translation.vector - a.pose.translation.vector);
            nearest = nearest.min(d.norm() / (2.0 * RADIUS * H));
        }
    }
    let given: Vec3 = states.iter().map(|s| s.on_fluid.force).sum();
    let volume = (EDGE as f64 * H).powi(3);
    let fluid = DENSITY * volume * flow(&scene) - 0.5 * scene.time_step() * given;
    let bodies: Vec3 = states.iter().map(|s| s.velocity).sum();
    let moving: f64 = states.iter().map(|s| s.velocity.norm()).sum();
    findings.check_scaled(
        "momentum lost",
        (fluid + bodies * excess).norm(),
        0.0,
        moving * bead.mass(),
        1e-9,
    );
    findings.check_at_least("least distance over the diameter", nearest, 1.0);
    findings.check_scaled("greatest slip", slip, 0.0, 1.0, 1e-2);
    findings.report("iterations a step", iterations as f64 / steps as f64, 0.0, 1.0);
    findings.report("step over the bare fluid's", seconds / bare, 1.0, 1.0);
    Ok(findings)
}

fn seconds_per_step(scene: &mut Scene, steps: usize) -> Result<f64, Fault> {
    let mut least = f64::INFINITY;
    for _ in 0..steps {
        let clock = Instant::now();
        scene.step()?;
        least = least.min(clock.elapsed().as_secs_f64());
    }
    Ok(least)
}
