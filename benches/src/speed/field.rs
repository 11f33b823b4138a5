//! Fields of sources at many points.

use super::{scattered, times};
use crate::Fault;
use lbm_ibm::coupling::{Soa3, Vec3};
use lbm_ibm::magnetics::{
    ChargeSheet, Cuboid, CurrentLoop, FieldSource, MU0, MagnetisedSphere, PointDipole, SheetPair,
};
use serde::Serialize;

/// Millimetre, m.
const MM: f64 = 1e-3;

/// One source, with or without its gradient.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Which source.
    pub source: &'static str,
    /// Whether the gradient was wanted.
    pub gradient: bool,
    /// Points.
    pub points: usize,
    /// Threads.
    pub threads: usize,
    /// Nanoseconds per point, the median.
    pub ns_per_point: f64,
    /// The fastest.
    pub best_ns_per_point: f64,
}

/// Times every source at `count` points scattered over a cube of 6 mm about it; magnets are 2 x 1.2 x 1.6 mm, loops and balls
/// 1 mm in radius.
///
/// # Errors
/// None for these sources.
pub fn sources(count: usize, threads: usize, seconds: f64) -> Result<Vec<Speed>, Fault> {
    let half = Vec3::new(1.0, 0.6, 0.8) * MM;
    let (o, z) = (Vec3::zeros(), Vec3::z());
    let sources: [(&'static str, Box<dyn FieldSource>); 7] = [
        (
            "sheet",
            Box::new(ChargeSheet::new(o, Vec3::x() * half.x, Vec3::y() * half.y, 1.0)?),
        ),
        (
            "sheet pair",
            Box::new(SheetPair::opposite(o, [half.x, half.y], 2.0 * half.z, 1.0)?),
        ),
        ("cuboid along z", Box::new(Cuboid::new(o, half, z)?)),
        ("cuboid", Box::new(Cuboid::new(o, half, Vec3::new(0.3, -0.4, 1.0))?)),
        ("dipole", Box::new(PointDipole::new(o, z * 1e-3))),
        ("sphere", Box::new(MagnetisedSphere::new(o, MM, z)?)),
        ("loop", Box::new(CurrentLoop::new(o, z, MM, MM / MU0)?)),
    ];
    let points: Soa3 = (0..count)
        .map(|k| Vec3::from([0, 1, 2].map(|a| scattered(k, a))) * (3.0 * MM))
        .collect();
    let (mut b, mut g) = (Soa3::default(), Vec::new());
    let mut rows = Vec::new();
    for (name, source) in &sources {
        for gradient in [false, true] {
            let (all, ()) = times(seconds, || {
                if gradient {
                    source.fields_and_gradients(points.view(), 0.0, &mut b, &mut g);
                } else {
                    source.fields(points.view(), 0.0, &mut b);
                }
                Ok(())
            })?;
            let each = |seconds: f64| 1e9 * seconds / count.max(1) as f64;
            rows.push(Speed {
                source: name,
                gradient,
                points: count,
                threads,
                ns_per_point: each(all[all.len() / 2]),
                best_ns_per_point: each(all[0]),
            });
        }
    }
    Ok(rows)
}
