//! The static estimate: the force that squeezes the cell through the slit without any fluid.

use crate::device::Device;
use crate::empty::Empty;
use crate::options::Drive;
use lbm_ibm::contact::WallRepulsion;
use lbm_ibm::coupling::nalgebra::Point3;
use lbm_ibm::coupling::{BodyInfo, Domain, ForceField, ImmersedBody, Loads, Soa3, UM, View};
use lbm_ibm::membrane::Cell;
use lbm_ibm::membrane::fire::Fire;
use std::error::Error;
use std::f64::consts::PI;

/// Distance of the stops on the way, m.
const STRIDE: f64 = 0.2 * UM;
/// A stop is at rest when no node feels more than this beside the push, N.
const TOLERANCE: f64 = 2e-14;
/// Most rounds at a stop.
const ROUNDS: usize = 4000;

/// The hardest stop on the way through the slit.
#[derive(Clone, Copy, Debug, Default)]
pub struct Squeeze {
    /// Greatest push along x that holds the cell at rest on its way in, N; zero where it falls through.
    pub force: f64,
    /// Area of the slit that the cell blocks, m2: gap times the cell's extent along the slit at the hardest stop, or the
    /// diameter of the pancake of its volume that fills the gap, whichever is greater.
    pub blocked: f64,
    /// Greatest force left on a node at any stop, N.
    pub residual: f64,
}

impl Squeeze {
    /// The force (N) of the flow on the cell in the slit: pressure drop times blocked area. At a held flux all of it goes
    /// through the width that the cell leaves free, and the slit's pressure drop grows by that ratio; at a held pressure
    /// drop the cell bears all of it.
    pub fn flow_force(&self, device: &Device, empty: &Empty) -> f64 {
        let free = (device.width - self.blocked / device.gap).max(0.0);
        let pressure = match device.drive() {
            Drive::Flux => empty.slit_pressure_drop * device.width / free,
            Drive::Pressure => empty.pressure_drop,
        };
        pressure * self.blocked
    }
}

/// Moves the cell's centre in small strides from before the slit to its middle. At each stop the nodes come to rest
/// with the centre's x held by equal forces on all nodes, whose sum is the push.
pub fn squeeze(device: &Device) -> Result<Squeeze, Box<dyn Error>> {
    let cell = device.cell()?;
    let start = device.start();
    let x: Soa3 = cell
        .reference()
        .iter()
        .map(|p| (start * Point3::from(p)).coords)
        .collect();
    let n = x.len();
    let mut pusher = Pusher {
        contact: WallRepulsion::new(device.walls()?, device.contact()),
        // Contact acts on bodies, not on bare nodes.
        info: BodyInfo {
            id: 0,
            kind: cell.kind().to_owned(),
            range: 0..n,
            triangles: cell.triangles().into(),
            motion: cell.motion(),
        },
        cell,
        x,
        v: Soa3::zeros(n),
        loads: Loads::new(n, 1),
    };
    let radius = 0.5 * device.subject.diameter();
    let first = device.entry - 1.2 * radius;
    pusher.shift(first - pusher.x.view().mean().x);
    let stops = ((0.5 * (device.entry + device.exit) - first) / STRIDE).ceil() as usize;
    let pancake = pancake_diameter(pusher.cell.mesh().volume(), device.gap);
    let mut hardest = Squeeze {
        blocked: pancake * device.gap,
        ..Squeeze::default()
    };
    for _ in 0..stops {
        pusher.shift(STRIDE);
        let (push, residual) = pusher.rest();
        hardest.residual = hardest.residual.max(residual);
        if push > hardest.force {
            let z = &pusher.x.z;
            let width =
                z.iter().copied().fold(f64::NEG_INFINITY, f64::max) - z.iter().copied().fold(f64::INFINITY, f64::min);
            hardest.force = push;
            hardest.blocked = width.max(pancake) * device.gap;
        }
    }
    Ok(hardest)
}

/// Diameter (m) of a disc of thickness `gap` with a half-torus rim that holds `volume` (m3); zero where a ball fits the
/// gap. With the core's radius c: pi c^2 d + pi^2 c d^2/4 + pi d^3/6 = V.
fn pancake_diameter(volume: f64, gap: f64) -> f64 {
    let (a, b, c) = (PI * gap, 0.25 * (PI * gap).powi(2), PI * gap.powi(3) / 6.0 - volume);
    if c >= 0.0 {
        return 0.0;
    }
    let core = ((b * b - 4.0 * a * c).sqrt() - b) / (2.0 * a);
    2.0 * core + gap
}

struct Pusher {
    cell: Cell,
    info: BodyInfo,
    contact: WallRepulsion,
    x: Soa3,
    v: Soa3,
    loads: Loads,
}

impl Pusher {
    fn shift(&mut self, way: f64) {
        for x in &mut self.x.x {
            *x += way;
        }
    }

    /// Brings the nodes to rest with the mean of the forces along x taken off: returns the push that stands for it and the
    /// greatest force left on a node, N.
    fn rest(&mut self) -> (f64, f64) {
        let fire = Fire {
            tolerance: TOLERANCE,
            iterations: ROUNDS,
            time_step: 0.5 / self.stiffness().sqrt(),
        };
        let Self {
            cell,
            info,
            contact,
            x,
            v,
            loads,
        } = self;
        let mut push = 0.0;
        let rest = fire.rest(x, |x, f| {
            loads.clear();
            cell.add_internal_forces(x, v.view(), &mut loads.node.view_mut());
            let view = View {
                x,
                v: v.view(),
                bodies: std::slice::from_ref(info),
                domain: &Domain::unbounded(),
                time: 0.0,
                time_step: 1.0,
                step: 0,
            };
            contact.add_loads(&view, loads);
            f.clone_from(&loads.node);
            let sum: f64 = f.x.iter().sum();
            let mean = sum / f.len() as f64;
            f.x.iter_mut().for_each(|f| *f -= mean);
            push = -sum;
        });
        (push, rest.residual)
    }

    /// A bound of the stiffness of a node, N/m: that of the contact and of the cell's laws together.
    fn stiffness(&self) -> f64 {
        let view = View {
            x: self.x.view(),
            v: self.v.view(),
            bodies: std::slice::from_ref(&self.info),
            domain: &Domain::unbounded(),
            time: 0.0,
            time_step: 1.0,
            step: 0,
        };
        self.contact.stiffness(&view).unwrap_or(0.0) + 0.02
    }
}
