//! What friction coupling loses.

use super::{Effort, Findings, Outcome};
use crate::Fault;
use crate::reference::Table;
use lbm_ibm::coupling::{BodyInfo, Bricks, Exchange, Motion, Soa3, Vec3};
use lbm_ibm::ibm::stokes::{PeriodicStokes, periodic_radius};
use lbm_ibm::ibm::{DeltaExchange, Kernel, Markers, friction_ratio, friction_slip_fraction};
use lbm_ibm::membrane::Mesh;
use std::f64::consts::PI;

/// The kernel of the paper's software.
const KERNEL: Kernel = Kernel::TwoPoint;

/// Mobility (s/kg) of a sphere of radius `a` (m) of `nodes` separate nodes that share the force evenly, in an unbounded fluid.
///
/// The grid is as fine as the nodes are dense, and the nodes sit inside `a` by the kernel's hydrodynamic shift.
fn mobility(nodes: usize, a: f64, viscosity: f64) -> Result<f64, Fault> {
    let radius = (3.0_f64.sqrt() * nodes as f64 / (8.0 * PI)).sqrt();
    let spacing = a / (radius + KERNEL.hydrodynamic_shift());
    let n = 48 * (radius / 12.0).ceil() as usize;
    let stokes = PeriodicStokes::new(n, spacing, viscosity);
    let centre = Vec3::repeat(0.5 * stokes.length()) + Vec3::new(0.13, 0.29, 0.41) * spacing;
    let x: Soa3 = Mesh::sphere(radius * spacing, nodes)?
        .nodes()
        .iter()
        .map(|p| centre + p)
        .collect();
    let body = BodyInfo {
        id: 0,
        kind: "sphere".into(),
        range: 0..nodes,
        triangles: [].into(),
        motion: Motion::Frozen,
    };
    let mut bricks = Bricks::new(stokes.grid());
    let mut exchange = DeltaExchange::new(KERNEL).with_markers(Markers::Nodes);
    exchange.set_bodies(&[body], x.view(), stokes.grid())?;
    exchange.place(x.view(), &mut bricks)?;
    let share: Soa3 = (0..nodes).map(|_| Vec3::z() / nodes as f64).collect();
    exchange.spread(share.view(), &mut bricks);
    let flow = stokes.respond(&bricks);
    stokes.fill(&flow, &mut bricks);
    let mut velocity = Soa3::zeros(nodes);
    exchange.interpolate(&bricks, velocity.view_mut());
    let images = periodic_radius(velocity.view().mean().z, viscosity, stokes.length());
    Ok(1.0 / (6.0 * PI * viscosity * images))
}

/// The share of its velocity that a sphere loses when it is pulled through a fluid by friction coupling: measured in a
/// Stokes flow within 2 %, and by the closed formula to 1e-4.
pub fn friction_coupling_slip(table: &Table, _effort: Effort) -> Outcome {
    let mut findings = Findings::of(table.name());
    for row in table.rows() {
        findings.begin(row.key(&["cell", "nodes", "a_um", "xi_nN_us_um"]));
        let (nodes, a) = (row.number("nodes")? as usize, row.number("a_um")? * 1e-6);
        let friction = row.number("xi_nN_us_um")? * 1e-9;
        let viscosity = row.number("stokes_kg_s")? / (6.0 * PI * a);
        let reference = row.number("slip_fraction")?;
        let slip = 1.0 / (nodes as f64 * friction);
        let measured = slip / (slip + mobility(nodes, a, viscosity)?);
        findings.check("slip, measured", measured, reference, 0.02);
        let formula = friction_slip_fraction(nodes, friction, viscosity, a);
        findings.check("slip, formula", formula, reference, 1e-4);
        let ratio = 1.0 / row.number("ratio")?;
        findings.check(
            "N xi/(6 pi mu a)",
            1.0 / friction_ratio(nodes, friction, viscosity, a),
            ratio,
            1e-4,
        );
    }
    Ok(findings)
}
