//! Hydrodynamic radii of markers and spheres, and the leak of a mesh.

use super::PeriodicStokes;
use crate::{DeltaExchange, Kernel, Markers};
use lbm_ibm_coupling::{BodyInfo, Bricks, Exchange, ExchangeError, Motion, Soa3, Soa3Ref, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// Radius (m) of a sphere whose mobility in a periodic cube of edge `length` (m) is `mobility` (s/kg): the root of
/// `M = 1/(6 pi mu a) - 2.837297/(6 pi mu L) + 4 pi a^2/(18 pi mu L^3)` (Hasimoto 1959; exact for a uniform traction).
pub fn periodic_radius(mobility: f64, viscosity: f64, length: f64) -> f64 {
    let target = 6.0 * PI * viscosity * length * mobility;
    let mut s = 1.0 / (target + 2.837297);
    for _ in 0..50 {
        s = 1.0 / (target + 2.837297 - 4.0 * PI / 3.0 * s * s);
    }
    s * length
}

/// Point `i` of a sequence that fills the unit cube evenly (Roberts' generalised golden ratio).
fn even(i: usize) -> Vec3 {
    let g = 1.220_744_084_605_759_5_f64;
    Vec3::new(1.0 / g, 1.0 / (g * g), 1.0 / (g * g * g)).map(|a| (0.5 + a * i as f64).fract())
}

/// Hydrodynamic radius of a single marker in grid spacings: the mean over `positions` places in a cell, and its relative
/// standard deviation, on a periodic cube of `n` nodes along each edge.
///
/// The self-mobility is that of interpolation after Stokes flow after spreading, mean over the three directions.
pub fn kernel_radius(kernel: Kernel, n: usize, positions: usize) -> (f64, f64) {
    let stokes = PeriodicStokes::new(n, 1.0, 1.0);
    let mut force = [0, 1, 2].map(|_| vec![0.0; n * n * n]);
    force[0][0] = 1.0;
    let [along, ..] = stokes.solve(&force);
    let wrap = |d: i64| d.rem_euclid(n as i64) as usize;
    let reach = kernel.support() as i64 - 1;
    let radii: Vec<f64> = (0..positions)
        .map(|i| {
            let weights = even(i).map(|s| kernel.stencil(s).1);
            let product = |axis: usize, d: i64| -> f64 {
                let w = &weights[axis];
                (0..6)
                    .filter(|j| (0..6).contains(&(j + d)))
                    .map(|j| w[j as usize] * w[(j + d) as usize])
                    .sum()
            };
            let mut mobility = 0.0;
            for (a, b, c) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                for z in -reach..=reach {
                    for y in -reach..=reach {
                        for x in -reach..=reach {
                            let flow = along[(wrap(z) * n + wrap(y)) * n + wrap(x)];
                            mobility += product(a, x) * product(b, y) * product(c, z) * flow / 3.0;
                        }
                    }
                }
            }
            periodic_radius(mobility, 1.0, n as f64)
        })
        .collect();
    let mean = radii.iter().sum::<f64>() / positions as f64;
    let variance = radii.iter().map(|a| (a - mean) * (a - mean)).sum::<f64>() / positions as f64;
    (mean, variance.sqrt() / mean)
}

/// Hydrodynamic radius, in grid spacings, of a sphere of `radius` (grid spacings) covered by markers at a mean distance
/// of `spacing` (grid spacings, triangular packing on a Fibonacci spiral) under a uniform traction, on a periodic cube
/// of `n` nodes along each edge.
///
/// # Errors
/// [`ExchangeError`] where the exchange cannot do it.
pub fn sphere_radius(kernel: Kernel, radius: f64, spacing: f64, n: usize) -> Result<f64, ExchangeError> {
    let count = (8.0 * PI * radius * radius / (3.0_f64.sqrt() * spacing * spacing)).round() as usize;
    let centre = Vec3::repeat(0.5 * n as f64) + Vec3::new(0.13, 0.29, 0.41);
    let x: Soa3 = (0..count)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / count as f64;
            let (s, c) = (PI * (3.0 - 5.0_f64.sqrt()) * i as f64).sin_cos();
            let r = (1.0 - z * z).sqrt();
            centre + radius * Vec3::new(r * c, r * s, z)
        })
        .collect();
    let force: Soa3 = (0..count).map(|_| Vec3::z() / count as f64).collect();
    let mut fluid = Fluid::new(kernel, n);
    let field = fluid.drag(Markers::Nodes, x.view(), &[], force.view())?;
    let mobility = fluid.velocity_at(&field, x.view())?.view().mean().z;
    Ok(periodic_radius(mobility, 1.0, n as f64))
}

/// Hydrodynamic radius, in grid spacings, of a closed mesh that is dragged along z by a uniform traction on a periodic cube of
/// `n` nodes along each edge, with its markers on the surface or inside it
/// ([`DeltaExchange::with_elastic_inset`]); `x` in grid spacings.
///
/// # Errors
/// [`ExchangeError`] where the exchange cannot do it.
pub fn surface_radius(
    kernel: Kernel,
    inset: bool,
    x: Soa3Ref<'_>,
    triangles: &[[u32; 3]],
    n: usize,
) -> Result<f64, ExchangeError> {
    let mut force = uniform_traction(x, triangles);
    let total: f64 = force.z.iter().sum();
    force.z.iter_mut().for_each(|f| *f /= total);
    let mut fluid = Fluid::new(kernel, n);
    fluid.exchange = DeltaExchange::new(kernel).with_elastic_inset(inset);
    fluid.place(x, triangles)?;
    fluid.exchange.spread(force.view(), &mut fluid.bricks);
    let field = fluid.stokes.respond(&fluid.bricks);
    let velocity = fluid.node_velocity(&field);
    let mobility = velocity.z.iter().zip(&force.z).map(|(u, f)| u * f).sum();
    Ok(periodic_radius(mobility, 1.0, n as f64))
}

/// Forces along z on the nodes of a mesh, by the area around each.
fn uniform_traction(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> Soa3 {
    let mut force = Soa3::zeros(x.len());
    for t in triangles {
        let [a, b, c] = t.map(|v| x.get(v as usize));
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        for &v in t {
            force.add(v as usize, Vec3::z() * (area / 3.0));
        }
    }
    force
}

/// How fluid and membrane move against each other; all in units of the membrane's mean speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leak {
    /// Mean over the surface of the normal component of the slip.
    pub normal: f64,
    /// Largest normal component.
    pub normal_max: f64,
    /// Mean over the surface of the whole slip.
    pub total: f64,
    /// Parts into which the edges were divided for markers.
    pub division: usize,
}

/// Slip of the fluid against a closed mesh that is dragged along z by a uniform traction on a periodic cube of `n` nodes
/// along each edge; `x` in grid spacings.
///
/// The membrane's velocity is linear between its nodes, which move as the exchange says; the fluid's is interpolated at
/// points at most a quarter of a spacing apart on all triangles.
///
/// # Errors
/// [`ExchangeError`] where the exchange cannot do it.
pub fn leak(
    kernel: Kernel,
    markers: Markers,
    x: Soa3Ref<'_>,
    triangles: &[[u32; 3]],
    n: usize,
) -> Result<Leak, ExchangeError> {
    let force = uniform_traction(x, triangles);
    let mut fluid = Fluid::new(kernel, n);
    let field = fluid.drag(markers, x, triangles, force.view())?;
    let node_velocity = fluid.node_velocity(&field);
    let division = fluid.exchange.divisions().map(|(_, k)| k).max().unwrap_or(1);
    let speed = node_velocity.view().mean().norm();

    let (mut points, mut membrane, mut weight, mut normals) =
        (Soa3::default(), Soa3::default(), Vec::new(), Vec::new());
    for t in triangles {
        let [a, b, c] = t.map(|v| x.get(v as usize));
        let [u, v, w] = t.map(|v| node_velocity.get(v as usize));
        let normal = (b - a).cross(&(c - a));
        let k = (4.0 * (b - a).norm().max((c - b).norm()).max((a - c).norm())).ceil() as usize;
        for i in 0..k {
            for j in 0..k - i {
                let [p, q] = [i, j].map(|i| (i as f64 + 1.0 / 3.0) / k as f64);
                points.push(a + (b - a) * p + (c - a) * q);
                membrane.push(u + (v - u) * p + (w - u) * q);
                weight.push(normal.norm() / (k * (k + 1)) as f64);
                normals.push(normal.normalize());
            }
        }
    }
    let flow = fluid.velocity_at(&field, points.view())?;
    let mut out = Leak {
        normal: 0.0,
        normal_max: 0.0,
        total: 0.0,
        division,
    };
    let area: f64 = weight.iter().sum();
    for i in 0..points.len() {
        let slip = (flow.get(i) - membrane.get(i)) / speed;
        let normal = slip.dot(&normals[i]).abs();
        out.normal += weight[i] / area * normal;
        out.total += weight[i] / area * slip.norm();
        out.normal_max = out.normal_max.max(normal);
    }
    Ok(out)
}

/// A periodic fluid of unit viscosity and spacing with one body.
struct Fluid {
    stokes: PeriodicStokes,
    exchange: DeltaExchange,
    bricks: Bricks,
}

impl Fluid {
    fn new(kernel: Kernel, n: usize) -> Self {
        let stokes = PeriodicStokes::new(n, 1.0, 1.0);
        let bricks = Bricks::new(stokes.grid());
        Self {
            stokes,
            exchange: DeltaExchange::new(kernel),
            bricks,
        }
    }

    fn place(&mut self, x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> Result<(), ExchangeError> {
        let body = BodyInfo {
            id: 0,
            kind: "surface".into(),
            range: 0..x.len(),
            triangles: Arc::from(triangles),
            motion: Motion::Advected,
        };
        self.exchange.set_bodies(&[body], x, self.stokes.grid())?;
        self.exchange.place(x, &mut self.bricks)
    }

    /// Flow at all nodes under forces on a body.
    fn drag(
        &mut self,
        markers: Markers,
        x: Soa3Ref<'_>,
        triangles: &[[u32; 3]],
        force: Soa3Ref<'_>,
    ) -> Result<[Vec<f64>; 3], ExchangeError> {
        self.exchange = DeltaExchange::new(self.exchange.kernel()).with_markers(markers);
        self.place(x, triangles)?;
        self.exchange.spread(force, &mut self.bricks);
        Ok(self.stokes.respond(&self.bricks))
    }

    /// Velocity of the nodes of the body in a flow.
    fn node_velocity(&mut self, field: &[Vec<f64>; 3]) -> Soa3 {
        self.stokes.fill(field, &mut self.bricks);
        let mut u = Soa3::zeros(self.exchange.node_count());
        self.exchange.interpolate(&self.bricks, u.view_mut());
        u
    }

    /// Velocity of a flow at points.
    fn velocity_at(&mut self, field: &[Vec<f64>; 3], x: Soa3Ref<'_>) -> Result<Soa3, ExchangeError> {
        self.exchange = DeltaExchange::new(self.exchange.kernel()).with_markers(Markers::Nodes);
        self.place(x, &[])?;
        Ok(self.node_velocity(field))
    }
}
