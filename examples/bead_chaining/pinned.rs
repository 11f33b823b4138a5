//! One chain across the channel in a growing flow: how far it tilts, and when it breaks.

use crate::options::Options;
use lbm_ibm::coupling::{Soa3, UM, Vec3};
use lbm_ibm::magnetics::{Auto, Constraint, Flow, Overdamped, contact_force, find_chains, mason_number};
use serde::Serialize;
use std::error::Error;

/// The chain at a speed.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Mean speed of the flow, m/s.
    pub speed: f64,
    /// Drag at that speed over the attraction of touching beads as fixed dipoles.
    pub mason: f64,
    /// Tilt of the chain, rad.
    pub tilt: f64,
    /// How far its top is displaced, m.
    pub displacement: f64,
    /// Least force in a contact between beads, N.
    pub least_contact: f64,
    /// Whether all beads still hang together.
    pub whole: bool,
}

/// The foot is held, as by a pillar; contacts have no friction, so nothing but the field holds the chain up. The speed doubles
/// until the chain breaks, then the interval is halved six times.
pub fn run(options: &Options) -> Result<Vec<Row>, Box<dyn Error>> {
    let mut rows = Vec::new();
    let (mut low, mut high) = (0.0, None);
    let mut speed = options.mean_speed();
    for _ in 0..if options.smoke { 3 } else { 16 } {
        let row = at(options, speed)?;
        if row.whole {
            low = speed;
        } else {
            high = Some(speed);
        }
        rows.push(row);
        speed = match high {
            None => 2.0 * speed,
            Some(high) if high - low < 0.02 * high => break,
            Some(high) => 0.5 * (low + high),
        };
    }
    rows.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    Ok(rows)
}

fn at(options: &Options, speed: f64) -> Result<Row, Box<dyn Error>> {
    let bead = options.bead()?;
    let (a, height) = (bead.radius(), options.height * UM);
    let n = (height / (2.0 * a)).floor() as usize;
    let beads = vec![bead.clone(); n];
    let foot = -0.5 * height + a;
    let x: Soa3 = (0..n).map(|k| Vec3::z() * (foot + 2.0 * a * k as f64)).collect();
    let mut motion = Overdamped::new(beads.clone(), x, options.source(0.0)?, Auto::new(), options.eta())?
        .with_walls(Options::plates(height))
        .with_contact(Constraint::frictionless())
        .in_flow(Flow::poiseuille(Vec3::zeros(), Vec3::z(), height, Vec3::x() * speed)?);
    motion.freeze(0);
    // Long enough for the chain to lean as far as it will: the relaxation time of a chain of n beads is about n^2 that of
    // a bead, drag over attraction per radius.
    let moment = bead.response(Vec3::z() * (options.field * 1e-3)).moment.norm();
    let relax = (n * n) as f64 * 6.0 * std::f64::consts::PI * options.eta() * a * a / contact_force(a, moment);
    let mut whole = true;
    for part in 1..=20 {
        motion.run_to(relax * 0.5 * f64::from(part))?;
        whole = find_chains(&beads, motion.positions(), 0.1 * a).len() == 1;
        if !whole {
            break;
        }
    }
    let top = motion.positions().get(n - 1) - motion.positions().get(0);
    let least = motion
        .contacts()
        .iter()
        .map(|c| c.normal_force)
        .fold(f64::INFINITY, f64::min);
    Ok(Row {
        speed,
        mason: mason_number(a, moment, options.eta(), speed),
        tilt: top.angle(&Vec3::z()),
        displacement: top.x,
        least_contact: if whole { least } else { 0.0 },
        whole,
    })
}

/// Says how far the chain leans, and when it breaks.
pub fn print(rows: &[Row], options: &Options) {
    if let Some(row) = rows
        .iter()
        .find(|r| (r.speed / options.mean_speed() - 1.0).abs() < 1e-9)
    {
        println!(
            "a chain across the channel, its foot held: at {:.0} um/s (Mason number {:.4}) it leans by {:.2} degrees, its top by {:.2} um",
            row.speed / UM,
            row.mason,
            row.tilt.to_degrees(),
            row.displacement / UM
        );
    }
    let whole = rows.iter().rev().find(|r| r.whole);
    let broken = rows.iter().find(|r| !r.whole);
    if let (Some(whole), Some(broken)) = (whole, broken) {
        println!(
            "  whole at {:.2} mm/s, leaning by {:.1} degrees; broken at {:.2} mm/s (Mason number {:.3})",
            whole.speed * 1e3,
            whole.tilt.to_degrees(),
            broken.speed * 1e3,
            broken.mason
        );
    }
}
