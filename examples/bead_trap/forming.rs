//! The bias field for a gap, and beads that form chains in it.

use crate::chains::{Row, at_rest, upright};
use crate::device::{Device, HEIGHT, PLASMA, RADIUS, ROW};
use lbm_ibm::coupling::{Soa3, UM, Vec3};
use lbm_ibm::magnetics::{Auto, Flow, MagneticsError, Overdamped};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::error::Error;
use std::sync::Arc;

/// The bias field (T) that gives a gap (m), by the rule of false position on the row at rest.
///
/// # Errors
/// A gap below that without bias, or above that of eight times the sheets' field.
pub fn bias_for(device: &Device, gap: f64) -> Result<f64, Box<dyn Error>> {
    let excess = |bias: f64| -> Result<f64, MagneticsError> { Ok(at_rest(device, bias, gap)?.gap - gap) };
    let (mut low, mut high) = (0.0, 8.0 * device.sheets());
    let (mut below, mut above) = (excess(low)?, excess(high)?);
    if below > 0.0 || above < 0.0 {
        let (least, most) = ((below + gap) / UM, (above + gap) / UM);
        return Err(format!(
            "a gap of {:.2} um is out of reach: the field gives {least:.2} to {most:.2} um",
            gap / UM
        )
        .into());
    }
    for _ in 0..30 {
        let middle = if high - low < 0.1 * device.sheets() {
            low + (high - low) * below / (below - above)
        } else {
            0.5 * (low + high)
        };
        let there = excess(middle)?;
        if there.abs() < 1e-3 * UM {
            return Ok(middle);
        }
        if there < 0.0 {
            (low, below) = (middle, there);
        } else {
            (high, above) = (middle, there);
        }
    }
    Ok(0.5 * (low + high))
}

/// How the chains of a trap have formed.
pub struct Forming {
    /// The row after the given time, and its moments on the way: time (s) and bead centres (m).
    pub row: Row,
    /// Moments on the way.
    pub film: Vec<(f64, Soa3)>,
    /// When the beads first hung together in as many chains as the row has, s.
    pub formed: Option<f64>,
}

/// Beads in loose columns, as accumulation points would hold them, are let go in the field and in the flow of mean `speed`
/// (m/s) for `time` (s).
pub fn form(device: &Device, bias: f64, gap: f64, speed: f64, time: f64, seed: u64) -> Result<Forming, Box<dyn Error>> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
    let loose: Soa3 = upright(gap)
        .iter()
        .map(|x| x * 1.02 + Vec3::new(uniform(), uniform(), 0.0) * (0.8 * RADIUS))
        .collect();
    let mut motion = Overdamped::new(
        device.beads()?,
        loose,
        device.source(Vec3::zeros(), bias)?,
        Auto::new(),
        PLASMA.1,
    )?
    .with_walls(Arc::new(Device::plates()))
    .in_flow(Flow::poiseuille(Vec3::zeros(), Vec3::z(), HEIGHT, Vec3::x() * speed)?)
    .with_steps(1e-3, f64::INFINITY);
    let mut film = Vec::new();
    let mut formed = None;
    let looks = 40;
    for look in 0..=looks {
        motion.run_to(time * f64::from(look) / f64::from(looks))?;
        let now: Soa3 = motion.positions().iter().collect();
        let row = Row::new(device, now.clone())?;
        if formed.is_none() && row.chains == ROW.0 {
            formed = Some(motion.time());
        }
        film.push((motion.time(), now));
    }
    let row = Row::new(device, motion.positions().iter().collect())?;
    Ok(Forming { row, film, formed })
}
