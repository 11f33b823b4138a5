//! A rigid body as the forcing keeps it: its markers, and how they meet the fluid.
//!
//! Smeared markers act as a surface farther out. Where a shell of radius `R` moves as the body does, the shift `s` is the same for a drag, a
//! turn, a strain or the curvature of a profile in the first order of `s/R`, and differs in the second: the fluid inside
//! is overdriven. A slip along the surface of `l` times the shear (Navier's law) takes `l` off the shift and
//! brings the fluid inside to the velocity of the body. With `l = 0.4 s` what is left of the shift depends neither on the kind of flow nor on the radius
//! ([`Kernel::rigid_slip`]).

use super::twist::{Twist, at, sum};
use crate::Kernel;
use lbm_ibm_coupling::nalgebra::Matrix6;
use lbm_ibm_coupling::{ExchangeError, ImmersedBody, Soa3, Vec3};
use std::f64::consts::PI;
use std::ops::Range;

/// Distance of neighbouring markers, in hydrodynamic radii of one. Closer markers make the system ill-conditioned: more
/// iterations, and with the trilinear kernel a larger drag.
const SPACING: f64 = 1.5;

/// A rigid body's markers.
#[derive(Clone, Debug)]
pub(super) struct Body {
    pub id: u32,
    pub markers: Range<usize>,
    /// Reference positions of the markers, m, and unit normals of the surface there.
    pub reference: Vec<Vec3>,
    pub normal: Vec<Vec3>,
    /// Area of a marker in squared grid spacings, and slip length in grid spacings.
    area: f64,
    slip: f64,
    /// Inverse of the number that stands for `J S` of a smooth force: the fluid nodes that a marker moves.
    pub nodes: f64,
    /// Slip velocity along the surface that a unit of force makes, as the forces are counted.
    pub ease: f64,
    /// Inverse of the matrix of the preconditioned Newton's law; none where the motion is given.
    pub inverse: Option<Matrix6<f64>>,
}

impl Body {
    /// A new body on a grid of spacing `h` (m), its markers numbered from `start`; without `inset` the markers lie on the surface, without slip.
    ///
    /// # Errors
    /// [`ExchangeError::TooSmall`].
    pub fn new(
        id: u32,
        body: &dyn ImmersedBody,
        h: f64,
        kernel: Kernel,
        inset: bool,
        start: usize,
    ) -> Result<Self, ExchangeError> {
        let scale = if inset { scale(id, body, h, kernel)? } else { 1.0 };
        let spacing = SPACING * kernel.marker_radius();
        let reference: Vec<Vec3> = body.markers(spacing * h, scale).iter().collect();
        let mesh = Mesh::of(body, scale);
        let whole = if mesh.area > 0.0 {
            mesh.area / (h * h)
        } else {
            spacing * spacing * reference.len() as f64
        };
        Ok(Self {
            id,
            markers: start..start + reference.len(),
            normal: reference.iter().map(|x| mesh.normal(*x)).collect(),
            area: whole / reference.len() as f64,
            slip: if inset { kernel.rigid_slip() } else { 0.0 },
            nodes: spacing * spacing / kernel.sum_of_squares(),
            ease: 0.0,
            inverse: None,
            reference,
        })
    }

    /// Finds [`Body::ease`] in a fluid of a kinematic `viscosity` in grid spacings squared a step: forces are counted as the velocity, half
    /// of which is theirs in a step, that they give to a node.
    pub fn slide(&mut self, viscosity: f64) {
        self.ease = 2.0 * self.slip / (viscosity * self.area);
    }

    /// The slip velocity of a force on a marker with this normal.
    #[inline]
    pub fn slipped(&self, force: &Vec3, normal: &Vec3) -> Vec3 {
        (force - normal * normal.dot(force)) * self.ease
    }

    /// The force on such a marker that makes up for a velocity if `J S` is a number.
    #[inline]
    pub fn mend(&self, velocity: &Vec3, normal: &Vec3) -> Vec3 {
        let across = normal * normal.dot(velocity);
        (velocity - across) * (self.nodes / (1.0 + self.nodes * self.ease)) + across * self.nodes
    }

    /// Force and torque of [`Body::mend`] for the velocities of a rigid motion.
    pub fn shell(&self, arm: &[Vec3], normal: &[Vec3]) -> Matrix6<f64> {
        let mut columns = Matrix6::zeros();
        for a in 0..6 {
            let mut unit = Twist::zeros();
            unit[a] = 1.0;
            let force: Vec<Vec3> = arm
                .iter()
                .zip(normal)
                .map(|(r, n)| self.mend(&at(&unit, r), n))
                .collect();
            columns.set_column(a, &sum(&force, arm));
        }
        columns
    }
}

/// How much smaller than a body the surface of its markers has to be so that the body acts as large as it is: as for the
/// sphere of its volume. The shape stays, for a spheroid tumbles in a shear flow by the aspect ratio of its markers.
fn scale(id: u32, body: &dyn ImmersedBody, h: f64, kernel: Kernel) -> Result<f64, ExchangeError> {
    let volume = body.rigid().map_or(0.0, |r| r.volume);
    let radius = (0.75 * volume / PI).cbrt() / h;
    let least = kernel.least_rigid_radius();
    if radius < least {
        return Err(ExchangeError::TooSmall {
            body: id,
            radius_in_cells: radius,
            least,
        });
    }
    Ok(1.0 - kernel.rigid_inset() / radius)
}

/// A body's own mesh, for the normals at its markers.
struct Mesh {
    nodes: Soa3,
    normal: Vec<Vec3>,
    /// About an edge: how far beyond the nearest node the normals of others count, m.
    reach: f64,
    area: f64,
}

impl Mesh {
    fn of(body: &dyn ImmersedBody, scale: f64) -> Self {
        let nodes: Soa3 = body.reference().iter().map(|x| x * scale).collect();
        let mut normal = vec![Vec3::zeros(); nodes.len()];
        let mut area = 0.0;
        for t in body.triangles() {
            let t = t.map(|n| n as usize);
            let [a, b, c] = t.map(|n| nodes.get(n));
            let twice = (b - a).cross(&(c - a));
            area += 0.5 * twice.norm();
            t.iter().for_each(|&n| normal[n] += twice);
        }
        for n in &mut normal {
            *n = n.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        }
        let reach = (area / nodes.len().max(1) as f64).sqrt();
        Self {
            nodes,
            normal,
            reach,
            area,
        }
    }

    /// Unit normal at a marker: the mean of the nodes about it, the nearer the heavier; off the centre where there are no triangles.
    fn normal(&self, x: Vec3) -> Vec3 {
        let nearest = self.nodes.iter().map(|p| (p - x).norm()).fold(f64::INFINITY, f64::min);
        let far = nearest + self.reach;
        let mean: Vec3 = self
            .nodes
            .iter()
            .zip(&self.normal)
            .map(|(p, n)| n * (far * far - (p - x).norm_squared()).max(0.0))
            .sum();
        let outward = || x.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        mean.try_normalize(1e-12 * far * far).unwrap_or_else(outward)
    }
}
