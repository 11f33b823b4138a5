//! The longest stable explicit time step of a body, from its own stiffness and its mobility in the fluid.

use crate::table::{Scratch, Table};
use lbm_ibm_coupling::{ImmersedBody, Motion, Soa3, Soa3Ref, Vec3, surface_area};
use std::f64::consts::PI;

/// Share of the computed limit that is handed out: power iteration comes from below.
const SAFETY: f64 = 0.75;
/// The same for nodes that the fluid carries. With the mean radius of a marker the limit comes out up to 15 % long with
/// four-point kernels, 30 % with the trilinear one, and 77 % for a membrane of 400 mN/m at a spacing of 0.25 um, where it was
/// compared with the longest step that was stable (`validate membrane_time_step_limits`).
const CARRIED: f64 = 0.5;
/// Most products, and the relative change at which they end.
const PRODUCTS: usize = 40;
const CHANGE: f64 = 1e-3;
/// Nodes whose patch is looked at.
const SAMPLES: usize = 12;

/// Longest stable step (s) of `body` with nodes at `x` (m): nodes of hydrodynamic radius `radius` (m) in a fluid of
/// dynamic `viscosity` (Pa s); displacements of `probe` (m) feel the stiffness. None for a body that does not move or has
/// no stiffness.
///
/// With the stiffness `K = -dF/dx` and the mobility `M`, explicit steps `dx = dt M F` are stable to `dt = 2 / lambda`,
/// `lambda` the largest eigenvalue of `M K`. `M` is that of Rotne, Prager and Yamakawa for nodes carried by the fluid,
/// `1 / friction` for overdamped ones. Newton's equation with friction, velocity first (symplectic Euler), is stable while
/// `k dt^2 + 2 xi dt < 4 m`, `k` the largest eigenvalue of `K`.
pub(crate) fn stable_step(
    body: &mut dyn ImmersedBody,
    x: Soa3Ref<'_>,
    radius: f64,
    viscosity: f64,
    probe: f64,
) -> Option<f64> {
    let step = match body.motion() {
        Motion::Advected => CARRIED * 2.0 / largest_rate(body, x, probe, |f| rpy(x, f, radius, viscosity))?,
        Motion::Overdamped { friction } => SAFETY * 2.0 * friction / largest_rate(body, x, probe, Soa3::clone)?,
        Motion::Newton { node_mass, friction } => {
            let k = largest_rate(body, x, probe, Soa3::clone).unwrap_or(0.0);
            // The root of k dt^2 + 2 xi dt - 4 m in a form that bears k = 0.
            SAFETY * 4.0 * node_mass / (friction + (friction * friction + 4.0 * k * node_mass).sqrt())
        }
        _ => return None,
    };
    step.is_finite().then_some(step)
}

/// Longest step (s) at which nodes at `x` (m) of a body that the fluid carries can breathe, moving with them a layer of
/// fluid of `layer` (kg/m2). None for a body without triangles, or one that the fluid does not carry.
///
/// A mode of stiffness `k`, drag `z` and mass `m` is stable while `k dt^2 < 4 m + 2 z dt` where the fluid's viscosity is
/// implicit, as on a lattice: the viscous limit alone is the lesser one. Not so for a change of
/// volume: an incompressible fluid would not have it at all, while a lattice's, slightly compressible, lets a stiff volume
/// law ring without drag. So `2 / omega` counts for that mode, `v` along `grad V / m`: `omega^2 = v.Kv / v.mv`.
pub(crate) fn inertial_step(body: &mut dyn ImmersedBody, x: Soa3Ref<'_>, layer: f64, probe: f64) -> Option<f64> {
    if body.motion() != Motion::Advected || body.triangles().is_empty() {
        return None;
    }
    let (mut mass, mut swell) = (vec![0.0; x.len()], Soa3::zeros(x.len()));
    for t in body.triangles() {
        let share = surface_area(x, &[*t]) * layer / 3.0;
        let [a, b, c] = t.map(|i| x.get(i as usize));
        let normal = (b - a).cross(&(c - a));
        for &i in t {
            mass[i as usize] += share;
            swell.add(i as usize, normal);
        }
    }
    let lightest = mass.iter().copied().filter(|m| *m > 0.0).fold(f64::INFINITY, f64::min);
    let mode: Soa3 = swell.iter().zip(&mass).map(|(g, m)| g / m.max(lightest)).collect();
    let inertia: f64 = mode.iter().zip(&mass).map(|(v, m)| m * v.norm_squared()).sum();
    let square = dot(&mode, &stiffness(body, x, &mode, probe)) / inertia;
    (square > 0.0).then(|| SAFETY * 2.0 / square.sqrt())
}

/// Largest eigenvalue of mobility times stiffness (1/s) by power iteration: the Rayleigh quotient `y.My / v.y`, `y = Kv`.
pub(crate) fn largest_rate(
    body: &mut dyn ImmersedBody,
    x: Soa3Ref<'_>,
    probe: f64,
    mut mobility: impl FnMut(&Soa3) -> Soa3,
) -> Option<f64> {
    let n = x.len();
    let mut v: Soa3 = (0..n)
        .map(|i| Vec3::new(0.618_034, 0.754_878, 0.819_173).map(|a| (a * (i + 1) as f64).fract() - 0.5))
        .collect();
    let mut rate = 0.0;
    for _ in 0..PRODUCTS {
        let y = stiffness(body, x, &v, probe);
        let next = mobility(&y);
        let (energy, power) = (dot(&v, &y), dot(&y, &next));
        let growth = (dot(&next, &next) / dot(&v, &v)).sqrt();
        let now = if energy > 0.0 { power / energy } else { growth };
        if !(growth > 0.0 && growth.is_finite()) {
            return None;
        }
        let settled = (now - rate).abs() < CHANGE * now;
        rate = now;
        // Of unit length, or the powers of a large rate overflow.
        let length = dot(&next, &next).sqrt();
        v = next.iter().map(|v| v / length).collect();
        if settled {
            break;
        }
    }
    (rate > 0.0).then_some(rate)
}

/// `K v` by central differences whose largest displacement is `probe`.
fn stiffness(body: &mut dyn ImmersedBody, x: Soa3Ref<'_>, v: &Soa3, probe: f64) -> Soa3 {
    let largest = v.iter().map(|v| v.amax()).fold(0.0, f64::max);
    let scale = probe / largest;
    let rest = Soa3::zeros(x.len());
    let mut force = [1.0, -1.0].map(|sign| {
        let moved: Soa3 = (0..x.len()).map(|i| x.get(i) + v.get(i) * (sign * scale)).collect();
        let mut force = Soa3::zeros(x.len());
        body.add_internal_forces(moved.view(), rest.view(), &mut force.view_mut());
        force
    });
    let [plus, minus] = &mut force;
    (0..x.len())
        .map(|i| (minus.get(i) - plus.get(i)) / (2.0 * scale))
        .collect()
}

/// Velocities of nodes of radius `a` under forces, Rotne-Prager-Yamakawa: `1/(8 pi mu r) [(1 + 2a^2/3r^2) + (1 - 2a^2/r^2)
/// rr]`, and `1/(6 pi mu a) [(1 - 9r/32a) + (3r/32a) rr]` where nodes overlap.
fn rpy(x: Soa3Ref<'_>, force: &Soa3, a: f64, viscosity: f64) -> Soa3 {
    let own = 1.0 / (6.0 * PI * viscosity * a);
    (0..x.len())
        .map(|i| {
            let mut u = force.get(i) * own;
            for j in (0..x.len()).filter(|&j| j != i) {
                let (d, f) = (x.get(j) - x.get(i), force.get(j));
                let square = d.norm_squared();
                let r = square.sqrt();
                let (plain, along) = if r > 2.0 * a {
                    let (s, q) = (0.75 * a / r, a * a / square);
                    (s * (1.0 + 2.0 / 3.0 * q), s * (1.0 - 2.0 * q) / square)
                } else {
                    (1.0 - 9.0 * r / (32.0 * a), 3.0 / (32.0 * a * r.max(f64::MIN_POSITIVE)))
                };
                u += (f * plain + d * (along * d.dot(&f))) * own;
            }
            u
        })
        .collect()
}

/// Hydrodynamic radius (m) of a node whose force its markers of radius `a` (m) share: from its mean self-mobility
/// `sum_mm' w_m w_m' g(r_mm')`, `g = 1/r`, and `(1 - r/4a)/a` where markers overlap. Mean over some nodes.
pub(crate) fn node_radius(table: &Table, x: Soa3Ref<'_>, a: f64) -> f64 {
    let mut scratch = Scratch::default();
    let step = x.len().div_ceil(SAMPLES).max(1);
    let radii: Vec<f64> = (0..x.len())
        .step_by(step)
        .map(|node| {
            let mut unit = Soa3::zeros(x.len());
            unit.x[node] = 1.0;
            let force = table.to_markers(unit.view(), &mut scratch);
            let patch: Vec<(f64, Vec3)> = (0..table.len())
                .map(|m| (table.marker_force(m, force).0[0], Vec3::from(table.position(m, x))))
                .filter(|(w, _)| *w != 0.0)
                .collect();
            let pair = |(w, p): &(f64, Vec3)| -> f64 {
                let sum = patch.iter().map(|(v, q)| {
                    let r = (p - q).norm();
                    v * if r > 2.0 * a { 1.0 / r } else { (1.0 - 0.25 * r / a) / a }
                });
                w * sum.sum::<f64>()
            };
            1.0 / patch.iter().map(pair).sum::<f64>()
        })
        .collect();
    radii.iter().sum::<f64>() / radii.len().max(1) as f64
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(&b)).sum()
}

#[cfg(test)]
mod tests;
