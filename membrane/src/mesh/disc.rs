//! Biconcave discs: the rest shape of a red blood cell.

use super::hull::{convex_hull, golden_spiral};
use super::relax::relax;
use super::shapes::SWEEPS;
use super::{Mesh, positive};
use crate::MembraneError;
use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Fewest nodes that show a dimple on both sides.
const LEAST_NODES: usize = 60;
/// Rounds of asking for a little more.
const PASSES: usize = 5;
/// Intervals of the quadrature along the meridian (even), and of the table that starts a projection.
const INTERVALS: usize = 400;
const TABLE: usize = 96;

/// How the nodes of a disc are spread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Spacing {
    /// Along a golden spiral that gives each node the same area: edges spread by 14 %, the same pattern everywhere.
    Spiral,
    /// From there evened out to edges that spread by 9 %, with some nodes of five and seven neighbours.
    Even,
}

/// What a biconcave disc measures: the symmetry axis is z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Diameter, m.
    pub diameter: f64,
    /// Enclosed volume of the triangulated surface, m3.
    pub volume: f64,
    /// Area of the triangulated surface, m2.
    pub area: f64,
    /// Greatest thickness, m.
    pub thickness: f64,
}

impl Disc {
    /// The red blood cell of the paper: 8 um, 96.56 um3, 137.58 um2, 2.476 um.
    pub const RBC_PAPER: Self = Self {
        diameter: 8e-6,
        volume: 96.56e-18,
        area: 137.58e-12,
        thickness: 2.476e-6,
    };

    /// An even mesh of `nodes` nodes (60 or more) whose *triangulated* surface has these measures, to 0.1 %.
    ///
    /// The profile is that of Evans and Fung (Microvasc. Res. 4, 335, 1972),
    /// z = +-R sqrt(1 - s) (c0 + c1 s + c2 s^2) with s = (r/R)^2, its coefficients solved for the measures. The same on
    /// every run.
    ///
    /// # Errors
    /// [`MembraneError::TooFewNodes`], [`MembraneError::NotPositive`], [`MembraneError::NoSuchDisc`].
    pub fn mesh(&self, nodes: usize, spacing: Spacing) -> Result<Mesh, MembraneError> {
        if nodes < LEAST_NODES {
            return Err(MembraneError::TooFewNodes {
                shape: "biconcave disc",
                nodes,
                least: LEAST_NODES,
            });
        }
        positive("the diameter of a disc", self.diameter)?;
        positive("the volume of a disc", self.volume)?;
        positive("the area of a disc", self.area)?;
        positive("the thickness of a disc", self.thickness)?;

        // A mesh inscribed in a surface has less volume and area than the surface: ask for a little more until it fits.
        let mut goal = *self;
        let spiral = golden_spiral(nodes);
        let mut triangles = convex_hull(&spiral);
        let mut points = Vec::new();
        for pass in 0..PASSES {
            let profile = Profile::solve(&goal)?;
            if pass == 0 || spacing == Spacing::Spiral {
                points = profile.spread(&spiral);
            }
            let sweeps = match spacing {
                Spacing::Spiral => 0,
                Spacing::Even if pass == 0 => SWEEPS,
                Spacing::Even => SWEEPS / 6,
            };
            relax(&mut points, &mut triangles, |x| profile.project(x), sweeps)?;
            let mesh = Mesh::new(points.iter().copied().collect(), triangles.clone())?;
            let size = mesh.extent();
            goal.diameter *= 2.0 * self.diameter / (size.x + size.y);
            goal.volume *= self.volume / mesh.volume();
            goal.area *= self.area / mesh.area();
            goal.thickness *= self.thickness / size.z;
        }
        Mesh::new(points.into_iter().collect(), triangles).map(Mesh::centred)
    }
}

/// The meridian of a disc, by the angle phi from the axis: r = R sin(phi), z = R cos(phi) (c0 + c1 s + c2 s^2).
struct Profile {
    radius: f64,
    c: Vector3<f64>,
    table: Vec<(f64, f64)>,
}

impl Profile {
    fn new(radius: f64, c: Vector3<f64>) -> Self {
        let mut profile = Self {
            radius,
            c,
            table: Vec::new(),
        };
        profile.table = (0..=TABLE)
            .map(|k| profile.point(PI * k as f64 / TABLE as f64).0)
            .collect();
        profile
    }

    /// Point `(r, z)` of the meridian and its first derivative.
    fn point(&self, phi: f64) -> ((f64, f64), (f64, f64)) {
        let (sin, cos) = phi.sin_cos();
        let s = sin * sin;
        let p = self.c[0] + s * (self.c[1] + s * self.c[2]);
        let dp = 2.0 * sin * cos * (self.c[1] + 2.0 * s * self.c[2]);
        let r = self.radius;
        ((r * sin, r * cos * p), (r * cos, r * (cos * dp - sin * p)))
    }

    /// Volume, area and greatest thickness of the smooth surface.
    fn measures(&self) -> Vector3<f64> {
        let step = FRAC_PI_2 / INTERVALS as f64;
        let (mut volume, mut area, mut half) = (0.0, 0.0, 0.0_f64);
        for k in 0..=INTERVALS {
            let ((r, z), (dr, dz)) = self.point(k as f64 * step);
            let weight = match k {
                0 | INTERVALS => 1.0,
                k if k % 2 == 1 => 4.0,
                _ => 2.0,
            };
            volume -= weight * PI * r * r * dz;
            area += weight * 2.0 * PI * r * dr.hypot(dz);
            half = half.max(z);
        }
        Vector3::new(2.0 * volume * step / 3.0, 2.0 * area * step / 3.0, 2.0 * half)
    }

    /// The profile of the asked measures, by Newton's method from the shape of Evans and Fung.
    fn solve(disc: &Disc) -> Result<Self, MembraneError> {
        let radius = 0.5 * disc.diameter;
        let wanted = Vector3::new(disc.volume, disc.area, disc.thickness);
        let error = |c: Vector3<f64>| Self::new(radius, c).measures().component_div(&wanted).add_scalar(-1.0);
        let mut c = Vector3::new(0.1035, 1.0015, -0.5615);
        let mut e = error(c);
        for _ in 0..30 {
            if e.amax() < 1e-10 {
                return Ok(Self::new(radius, c));
            }
            let columns = [0, 1, 2].map(|k| {
                let mut d = c;
                d[k] += 1e-6;
                (error(d) - e) / 1e-6
            });
            let Some(full) = Matrix3::from_columns(&columns).lu().solve(&e) else {
                break;
            };
            // Halve the step until it improves.
            let better = (0..12)
                .map(|k| c - full * 0.5_f64.powi(k))
                .find(|&d| error(d).norm() < e.norm());
            let Some(next) = better else { break };
            c = next;
            e = error(c);
        }
        if e.amax() < 1e-6 {
            return Ok(Self::new(radius, c));
        }
        Err(MembraneError::NoSuchDisc {
            diameter: disc.diameter,
            volume: disc.volume,
            area: disc.area,
            thickness: disc.thickness,
            error: e.amax(),
            sphere_area: (36.0 * PI * disc.volume * disc.volume).cbrt(),
        })
    }

    /// Where points of the unit sphere go so that equal areas stay equal areas.
    fn spread(&self, points: &[Vec3]) -> Vec<Vec3> {
        let step = PI / INTERVALS as f64;
        let mut below = vec![0.0];
        for k in 0..INTERVALS {
            let ((r, _), (dr, dz)) = self.point((k as f64 + 0.5) * step);
            below.push(below[k] + r * dr.hypot(dz));
        }
        let place = |x: &Vec3| {
            let wanted = 0.5 * (1.0 - x.z) * below[INTERVALS];
            let k = below.partition_point(|&b| b < wanted).clamp(1, INTERVALS);
            let phi = step * (k as f64 - (below[k] - wanted) / (below[k] - below[k - 1]));
            let ((r, z), _) = self.point(phi);
            let scale = r / x.xy().norm().max(f64::MIN_POSITIVE);
            Vec3::new(scale * x.x, scale * x.y, z)
        };
        points.iter().map(place).collect()
    }

    /// The point of the surface nearest to `x`.
    fn project(&self, x: Vec3) -> Vec3 {
        let rho = x.xy().norm();
        let square = |&(r, z): &(f64, f64)| (r - rho).powi(2) + (z - x.z).powi(2);
        let mut nearest = (0, f64::INFINITY);
        for (k, p) in self.table.iter().enumerate() {
            let d = square(p);
            if d < nearest.1 {
                nearest = (k, d);
            }
        }
        let step = PI / TABLE as f64;
        let start = nearest.0 as f64 * step;
        let mut phi = start;
        for _ in 0..4 {
            // Gauss-Newton: the component of the remaining vector along the meridian.
            let ((r, z), (dr, dz)) = self.point(phi);
            phi += ((rho - r) * dr + (x.z - z) * dz) / (dr * dr + dz * dz);
            phi = phi.clamp(start - step, start + step).clamp(0.0, PI);
        }
        let ((r, z), _) = self.point(phi);
        if rho == 0.0 {
            return Vec3::new(r, 0.0, z);
        }
        Vec3::new(r * x.x / rho, r * x.y / rho, z)
    }
}
