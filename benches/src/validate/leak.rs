//! Fluid against a membrane that is dragged through it.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::scenes::plasma;
use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{
    BodyInfo, Bricks, Exchange, ForceField, Grid, Lattice, Loads, Motion, PN, Scene, Soa3, UM, Vec3, View,
};
use lbm_ibm::ibm::stokes::leak;
use lbm_ibm::ibm::{DeltaExchange, Kernel, Markers};
use lbm_ibm::lbm::{Drive, Fluid};
use lbm_ibm::membrane::{Form, Mesh, presets};
use std::collections::BTreeMap;
use std::f64::consts::PI;

const KERNELS: [Kernel; 3] = [Kernel::TwoPoint, Kernel::RomaThree, Kernel::PeskinFour];

fn key(fluid: &str, kernel: Kernel, edge: f64) -> BTreeMap<String, String> {
    let pairs = [
        ("fluid", fluid.to_owned()),
        ("kernel", format!("{kernel:?}")),
        ("edge/h", edge.to_string()),
    ];
    pairs.into_iter().map(|(k, v)| (k.to_owned(), v)).collect()
}

/// Mean normal slip of the fluid against a dragged sphere below 1 % of its speed, with mesh edges of 0.5 to 3.5 cells in
/// a Stokes flow, and for the paper's tumour cell in the lattice-Boltzmann fluid.
pub fn no_leak(_effort: Effort) -> Outcome {
    let mut findings = Findings::of("no_leak");
    for (radius, edge) in [(4.5, 0.5), (5.8, 1.0), (5.9, 1.75), (6.0, 3.5)] {
        let nodes = (8.0 * PI * radius * radius / (3.0_f64.sqrt() * edge * edge)).round() as usize;
        let mesh = Mesh::sphere(radius, nodes)?;
        let centre = Vec3::new(20.13, 20.29, 20.41);
        let x: Soa3 = mesh.nodes().iter().map(|p| centre + p).collect();
        for kernel in KERNELS {
            findings.begin(key("stokes", kernel, edge));
            let slip = leak(kernel, Markers::default(), x.view(), mesh.triangles(), 40)?;
            findings.check_scaled("mean normal slip", slip.normal, 0.0, 1.0, 0.01);
            findings.report("mean edge/h", mesh.mean_edge(), edge, edge);
        }
    }
    for (spacing, edge) in [(1.75, 1.0), (1.0, 1.75), (0.5, 3.5)] {
        let kernel = Kernel::default();
        findings.begin(key("lbm", kernel, edge));
        findings.check_scaled("mean normal slip", dragged(spacing * UM, kernel)?, 0.0, 1.0, 0.01);
    }
    Ok(findings)
}

/// A force on the first body as a whole.
struct Drag(Vec3);

impl ForceField for Drag {
    fn name(&self) -> &str {
        "drag"
    }

    fn add_loads(&mut self, _view: &View<'_>, loads: &mut Loads) {
        loads.body[0].force += self.0;
    }
}

/// Mean normal slip, in units of the cell's speed, of the fluid against the paper's tumour cell, dragged through fluid that
/// is at rest as a whole.
fn dragged(spacing: f64, kernel: Kernel) -> Result<f64, Fault> {
    let n = (2.0 * presets::CTC_DIAMETER / spacing).round() as usize;
    let grid = Grid::new([n; 3], spacing, [true; 3]);
    let fluid = plasma(grid, 1.0, 20.0)?.with_drive(Drive::Flux([Some(0.0); 3]))?;
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(kernel));
    let cell = presets::ctc_paper(Form::Corrected)?;
    let middle = 0.5 * n as f64 * spacing;
    let triangles = cell.mesh().triangles().to_vec();
    scene.add_body(cell, &Isometry3::translation(middle, middle, middle))?;
    scene.add_field(Drag(Vec3::z() * 2.0 * PN));
    // The flow about the cell is steady once momentum has crossed the box.
    for _ in 0..6 * n * n / 20 {
        scene.step()?;
    }
    let before: Soa3 = scene.positions().iter().collect();
    scene.step()?;
    let (velocity, force) = (scene.velocities().iter().collect(), scene.loads().node.clone());
    let fluid = scene.fluid_as::<Fluid>().ok_or("the scene has lost its fluid")?;
    slip(fluid, kernel, &before, &triangles, &velocity, &force)
}

/// Mean normal slip between the membrane, its velocity linear between its nodes, and the fluid at points at most a
/// quarter of a spacing apart, over the membrane's mean speed.
fn slip(
    fluid: &mut Fluid,
    kernel: Kernel,
    x: &Soa3,
    triangles: &[[u32; 3]],
    velocity: &Soa3,
    force: &Soa3,
) -> Result<f64, Fault> {
    let grid = fluid.grid().clone();
    let (mut all, mut membrane, mut vector) = (x.clone(), Vec::new(), Vec::new());
    for t in triangles {
        let [a, b, c] = t.map(|v| x.get(v as usize));
        let [u, v, w] = t.map(|v| velocity.get(v as usize));
        let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
        let k = (4.0 * longest / grid.spacing).ceil() as usize;
        for i in 0..k {
            for j in 0..k - i {
                let [p, q] = [i, j].map(|i| (i as f64 + 1.0 / 3.0) / k as f64);
                all.push(a + (b - a) * p + (c - a) * q);
                membrane.push(u + (v - u) * p + (w - u) * q);
                vector.push((b - a).cross(&(c - a)) / (k * (k + 1)) as f64);
            }
        }
    }
    // The nodes' forces belong to the fluid's velocity, so membrane and points are placed together.
    let (nodes, points) = (0..x.len(), x.len()..all.len());
    let body = |id, range: &std::ops::Range<usize>, triangles: &[[u32; 3]]| BodyInfo {
        id,
        kind: "surface".into(),
        range: range.clone(),
        triangles: triangles.into(),
        motion: Motion::Advected,
    };
    let mut exchange = DeltaExchange::new(kernel);
    let mut bricks = Bricks::new(&grid);
    exchange.set_bodies(&[body(0, &nodes, triangles), body(1, &points, &[])], all.view(), &grid)?;
    exchange.place(all.view(), &mut bricks)?;
    let mut forces = Soa3::zeros(all.len());
    nodes.clone().for_each(|i| forces.set(i, force.get(i)));
    bricks.clear_force();
    exchange.spread(forces.view(), &mut bricks);
    fluid.read_velocity(&mut bricks);
    let mut flow = Soa3::zeros(all.len());
    exchange.interpolate(&bricks, flow.view_mut());
    let normal = |i: usize| (flow.get(points.start + i) - membrane[i]).dot(&vector[i]).abs();
    let area: f64 = vector.iter().map(|n| n.norm()).sum();
    let sum: f64 = (0..vector.len()).map(normal).sum();
    Ok(sum / area / velocity.view().mean().norm())
}
