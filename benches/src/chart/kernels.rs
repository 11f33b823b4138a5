//! Delta kernels: how large a sphere of markers acts.

use super::{Chart, Row, Work, seconds_per_call};
use crate::Fault;
use lbm_ibm::coupling::{BodyInfo, Bricks, Exchange, Motion, Soa3, Vec3};
use lbm_ibm::ibm::stokes::{PeriodicStokes, periodic_radius};
use lbm_ibm::ibm::{DeltaExchange, Kernel, Markers};
use std::f64::consts::PI;

/// Kernels: two curves each, one with the radius of the mesh corrected for the kernel's shift.
const CURVES: &[(&str, Kernel)] = &[
    ("2 points", Kernel::TwoPoint),
    ("3 points, Roma", Kernel::RomaThree),
    ("3 points, spline", Kernel::SplineThree),
    ("4 points, Peskin", Kernel::PeskinFour),
    ("4 points, spline", Kernel::SplineFour),
];
/// Radii of the mesh in grid spacings, a point each.
const RADII: &[f64] = &[2.0, 3.0, 4.0, 6.0, 8.0];
/// Nodes along each edge of the periodic box: six of the largest radii.
const BOX: usize = 48;
/// Places of the centre in a cell.
const PLACES: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.5], [0.0, 0.25, 0.5], [0.13, 0.29, 0.41]];

/// Spheres under a uniform traction.
pub const KERNELS: Chart = Chart {
    name: "kernels",
    title: "Hydrodynamic radius of a sphere of markers one spacing apart",
    cost: "cost of placing, interpolating and spreading once, s",
    error: "relative error of the radius, rms over places in a cell",
    advice: "Correct the radius of the mesh for the kernel's shift: it gains a factor of nine and more for nothing. Then two \
             points do for the radius of a sphere; more points are for what varies with the place of a single marker.",
    cases: radii,
};

fn radii(quick: bool) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    for &radius in if quick { &RADII[..2] } else { RADII } {
        let mut spheres = CURVES
            .iter()
            .map(|&(_, kernel)| Sphere::new(kernel, radius))
            .collect::<Result<Vec<_>, _>>()?;
        let mut works: Vec<_> = spheres.iter_mut().map(Sphere::work).collect();
        let costs = seconds_per_call(quick, &mut works)?;
        drop(works);
        for ((&(curve, kernel), sphere), cost_s) in CURVES.iter().zip(&mut spheres).zip(costs) {
            let acts = PLACES.iter().map(|&p| sphere.acts(p)).collect::<Result<Vec<_>, _>>()?;
            for (correction, shift) in [("", 0.0), (", corrected", kernel.hydrodynamic_shift())] {
                let squares: f64 = acts.iter().map(|a| (a / (radius + shift) - 1.0).powi(2)).sum();
                rows.push(Row {
                    case: String::new(),
                    curve: format!("{curve}{correction}"),
                    label: format!("{radius} spacings"),
                    cost_s,
                    updates: (2 * sphere.x.len() * kernel.support().pow(3)) as f64,
                    error: (squares / PLACES.len() as f64).sqrt(),
                });
            }
        }
    }
    Ok(rows)
}

/// A sphere of markers in a periodic fluid of unit viscosity and spacing.
struct Sphere {
    /// Markers about the centre, and where they are.
    shape: Soa3,
    x: Soa3,
    u: Soa3,
    stokes: PeriodicStokes,
    exchange: DeltaExchange,
    bricks: Bricks,
}

impl Sphere {
    /// A sphere of `radius` spacings: markers one spacing apart on a Fibonacci spiral.
    fn new(kernel: Kernel, radius: f64) -> Result<Self, Fault> {
        let count = (8.0 * PI * radius * radius / 3.0_f64.sqrt()).round() as usize;
        let marker = |i: usize| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (s, c) = (PI * (3.0 - 5.0_f64.sqrt()) * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            radius * Vec3::new(r * c, r * s, z)
        };
        let body = BodyInfo {
            id: 0,
            kind: "sphere".into(),
            range: 0..count,
            triangles: [].into(),
            motion: Motion::Advected,
        };
        let stokes = PeriodicStokes::new(BOX, 1.0, 1.0);
        let mut sphere = Self {
            shape: (0..count).map(marker).collect(),
            x: Soa3::zeros(count),
            u: Soa3::zeros(count),
            exchange: DeltaExchange::new(kernel).with_markers(Markers::Nodes),
            bricks: Bricks::new(stokes.grid()),
            stokes,
        };
        sphere.put(PLACES[0]);
        sphere
            .exchange
            .set_bodies(&[body], sphere.x.view(), sphere.stokes.grid())?;
        Ok(sphere)
    }

    fn put(&mut self, place: [f64; 3]) {
        let centre = Vec3::repeat(0.5 * BOX as f64) + Vec3::from(place);
        self.x = self.shape.iter().map(|p| centre + p).collect();
    }

    /// What a step does with markers.
    fn work(&mut self) -> Work<'_> {
        Box::new(|| {
            self.exchange.place(self.x.view(), &mut self.bricks)?;
            self.exchange.interpolate(&self.bricks, self.u.view_mut());
            self.bricks.clear_force();
            self.exchange.spread(self.shape.view(), &mut self.bricks);
            Ok(())
        })
    }

    /// Hydrodynamic radius under a uniform traction, spacings.
    fn acts(&mut self, place: [f64; 3]) -> Result<f64, Fault> {
        self.put(place);
        let count = self.x.len();
        let force: Soa3 = (0..count).map(|_| Vec3::z() / count as f64).collect();
        self.exchange.place(self.x.view(), &mut self.bricks)?;
        self.bricks.clear_force();
        self.exchange.spread(force.view(), &mut self.bricks);
        let flow = self.stokes.respond(&self.bricks);
        self.stokes.fill(&flow, &mut self.bricks);
        self.exchange.interpolate(&self.bricks, self.u.view_mut());
        Ok(periodic_radius(self.u.view().mean().z, 1.0, self.stokes.length()))
    }
}
