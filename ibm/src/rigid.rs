//! Rigid bodies: spheres, ellipsoids, closed meshes.

mod mass;
mod surface;

use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{
    ForceField, ImmersedBody, Loads, Motion, Rigid, RigidDrive, Soa3, Soa3Mut, Soa3Ref, Vec3, View,
};
use std::f64::consts::PI;

/// What makes no rigid body.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RigidError {
    /// A quantity that must be positive and finite is not.
    #[error("the {name} of a rigid body is {value}, it must be positive and finite")]
    NotPositive {
        /// What it is.
        name: &'static str,
        /// Its value, SI.
        value: f64,
    },
    /// An edge of the mesh has not two triangles.
    #[error("the mesh is not closed: edge ({}, {}) belongs to {triangles} triangle(s); close the mesh", edge[0], edge[1])]
    Open {
        /// Nodes of the edge.
        edge: [u32; 2],
        /// Triangles that have it.
        triangles: usize,
    },
    /// The mesh encloses no volume, or its triangles face inwards.
    #[error("the mesh encloses {volume:e} m3: its triangles must face outwards by the right hand")]
    NoVolume {
        /// Enclosed volume, m3.
        volume: f64,
    },
    /// A triangle names a node that is not there.
    #[error("triangle {triangle} names node {node}, the mesh has {nodes}")]
    NoNode {
        /// The triangle.
        triangle: usize,
        /// The node it names.
        node: u32,
        /// Nodes of the mesh.
        nodes: usize,
    },
}

/// Parts into which the edges of an icosahedron are divided for the nodes of spheres and ellipsoids.
const PARTS: usize = 6;

#[derive(Clone, Debug)]
enum Shape {
    /// Semi-axes along x, y, z, m.
    Ellipsoid([f64; 3]),
    Mesh,
}

/// A body of uniform density that keeps its shape, with six degrees of freedom, coupled to the fluid both ways.
///
/// Its reference has the centre of mass at the origin. The nodes carry contact and pictures; the fluid meets the body at
/// markers of their own, one to two grid spacings apart, which the exchange places inside the surface by
/// [`crate::Kernel::rigid_inset`]. What a step solves is told at [`lbm_ibm_coupling::RigidState`].
///
/// ```
/// use lbm_ibm_coupling::nalgebra::Isometry3;
/// use lbm_ibm_coupling::{ImmersedBody, RigidDrive, Vec3};
/// use lbm_ibm_ibm::RigidBody;
///
/// # fn main() -> Result<(), lbm_ibm_ibm::RigidError> {
/// // A bead of 4 um, a spheroid, and a sphere that is held so that the fluid's load on it can be read.
/// let bead = RigidBody::sphere(2e-6, 1500.0)?.with_kind("bead");
/// let disc = RigidBody::ellipsoid([4e-6, 4e-6, 1e-6], 1100.0)?;
/// let held = RigidBody::sphere(2e-6, 1000.0)?.held();
/// assert!((bead.mass() / 5.0265e-14 - 1.0).abs() < 1e-4);
/// // scene.add_body(bead, &Isometry3::translation(8e-6, 8e-6, 8e-6))?;
/// # let _ = (disc, held, Isometry3::<f64>::identity(), Vec3::zeros());
/// # Ok(()) }
/// ```
#[derive(Clone, Debug)]
pub struct RigidBody {
    kind: String,
    shape: Shape,
    nodes: Soa3,
    triangles: Vec<[u32; 3]>,
    rigid: Rigid,
}

impl RigidBody {
    /// A sphere of `radius` (m) and `density` (kg/m3), free to move.
    ///
    /// # Errors
    /// [`RigidError::NotPositive`].
    pub fn sphere(radius: f64, density: f64) -> Result<Self, RigidError> {
        positive("radius", radius)?;
        Ok(Self::ellipsoid([radius; 3], density)?.with_kind("sphere"))
    }

    /// An ellipsoid of semi-axes `axes` (m) along x, y and z and `density` (kg/m3), free to move.
    ///
    /// # Errors
    /// [`RigidError::NotPositive`].
    pub fn ellipsoid(axes: [f64; 3], density: f64) -> Result<Self, RigidError> {
        for axis in axes {
            positive("semi-axis", axis)?;
        }
        positive("density", density)?;
        let (unit, triangles) = surface::icosphere(PARTS);
        let nodes = unit.iter().map(|p| p.component_mul(&Vec3::from(axes))).collect();
        let volume = 4.0 / 3.0 * PI * axes.iter().product::<f64>();
        let [a, b, c] = axes.map(|a| a * a);
        let inertia = Matrix3::from_diagonal(&Vec3::new(b + c, c + a, a + b)) * (volume / 5.0);
        Ok(Self {
            kind: "ellipsoid".to_owned(),
            shape: Shape::Ellipsoid(axes),
            nodes,
            triangles,
            rigid: of_density(density, volume, inertia),
        })
    }

    /// A body with a closed surface of `nodes` (m) and `triangles` (outward by the right hand) of `density` (kg/m3), free to
    /// move. Its reference is moved so that the centre of mass is at the origin; returns that centre too.
    ///
    /// # Errors
    /// [`RigidError::Open`], [`RigidError::NoVolume`], [`RigidError::NoNode`], [`RigidError::NotPositive`].
    pub fn mesh(nodes: &[Vec3], triangles: &[[u32; 3]], density: f64) -> Result<(Self, Vec3), RigidError> {
        positive("density", density)?;
        mass::check_closed(nodes.len(), triangles)?;
        let solid = mass::Solid::of(nodes, triangles);
        if !(solid.volume > 0.0 && solid.volume.is_finite()) {
            return Err(RigidError::NoVolume { volume: solid.volume });
        }
        let body = Self {
            kind: "rigid body".to_owned(),
            shape: Shape::Mesh,
            nodes: nodes.iter().map(|p| p - solid.centre).collect(),
            triangles: triangles.to_vec(),
            rigid: of_density(density, solid.volume, solid.inertia),
        };
        Ok((body, solid.centre))
    }

    /// What it is called; `BeadForces` and other fields find bodies by it.
    pub fn with_kind(mut self, kind: impl Into<String>) -> Self {
        self.kind = kind.into();
        self
    }

    /// Another mass (kg) and inertia (about the centre, in the axes of the reference, kg m2) than those of a uniform body;
    /// the centre of mass stays that of the volume.
    ///
    /// # Errors
    /// [`RigidError::NotPositive`] for the mass or a principal moment.
    pub fn with_inertia(mut self, mass: f64, inertia: Matrix3<f64>) -> Result<Self, RigidError> {
        self.rigid.mass = positive("mass", mass)?;
        positive(
            "least principal moment of inertia",
            inertia.symmetric_eigenvalues().min(),
        )?;
        self.rigid.inertia = inertia;
        Ok(self)
    }

    /// The body is held where it is: the load of the fluid on it is a measurement.
    pub fn held(self) -> Self {
        self.moving(Vec3::zeros(), Vec3::zeros())
    }

    /// The body moves with `velocity` (m/s) and `angular_velocity` (1/s), whatever the loads.
    pub fn moving(mut self, velocity: Vec3, angular_velocity: Vec3) -> Self {
        self.rigid.drive = RigidDrive::Given {
            velocity,
            angular_velocity,
        };
        self
    }

    /// Mass, kg.
    pub fn mass(&self) -> f64 {
        self.rigid.mass
    }

    /// Volume, m3.
    pub fn volume(&self) -> f64 {
        self.rigid.volume
    }

    /// Mass less that of the displaced fluid of `density` (kg/m3), kg.
    pub fn excess_mass(&self, density: f64) -> f64 {
        self.rigid.mass - density * self.rigid.volume
    }
}

fn of_density(density: f64, volume: f64, volume_inertia: Matrix3<f64>) -> Rigid {
    Rigid {
        mass: density * volume,
        inertia: density * volume_inertia,
        volume,
        volume_inertia,
        drive: RigidDrive::Free,
    }
}

fn positive(name: &'static str, value: f64) -> Result<f64, RigidError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(RigidError::NotPositive { name, value })
    }
}

impl ImmersedBody for RigidBody {
    fn kind(&self) -> &str {
        &self.kind
    }

    fn reference(&self) -> Soa3Ref<'_> {
        self.nodes.view()
    }

    fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    fn motion(&self) -> Motion {
        Motion::Rigid
    }

    fn rigid(&self) -> Option<Rigid> {
        Some(self.rigid.clone())
    }

    fn markers(&self, spacing: f64, scale: f64) -> Soa3 {
        match self.shape {
            Shape::Ellipsoid(axes) => surface::ellipsoid_markers(axes.map(|a| scale * a), spacing),
            Shape::Mesh => surface::mesh_markers(self.nodes.view(), &self.triangles, spacing, scale),
        }
    }

    fn add_internal_forces(&mut self, _x: Soa3Ref<'_>, _v: Soa3Ref<'_>, _force: &mut Soa3Mut<'_>) {}
}

/// Weight less buoyancy of rigid bodies, by kind: `(M - M_f) g` on each.
#[derive(Clone, Debug)]
pub struct Buoyancy {
    gravity: Vec3,
    kinds: Vec<(String, f64)>,
}

impl Buoyancy {
    /// In a field of `gravity`, m/s2.
    pub fn new(gravity: Vec3) -> Self {
        Self {
            gravity,
            kinds: Vec::new(),
        }
    }

    /// Bodies of this kind weigh `excess_mass` (kg, [`RigidBody::excess_mass`]) more than the fluid they displace.
    pub fn with(mut self, kind: impl Into<String>, excess_mass: f64) -> Self {
        self.kinds.push((kind.into(), excess_mass));
        self
    }
}

impl ForceField for Buoyancy {
    fn name(&self) -> &str {
        "buoyancy"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        for (body, load) in view.bodies.iter().zip(&mut loads.body) {
            if let Some((_, mass)) = self.kinds.iter().find(|(kind, _)| *kind == body.kind) {
                load.force += *mass * self.gravity;
            }
        }
    }
}
