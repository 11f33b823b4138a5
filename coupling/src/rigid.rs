//! Bodies that keep their shape: what they weigh, and how they move.

use crate::{StateError, StateReader, StateWriter, Vec3, Wrench};
use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion};

/// What drives a rigid body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum RigidDrive {
    /// Newton's law, under the load of the fluid and of the force fields.
    #[default]
    Free,
    /// A given motion, whatever the loads: at zero the body is held, and the fluid's load on it is a measurement.
    Given {
        /// Velocity of the centre, m/s.
        velocity: Vec3,
        /// Angular velocity, 1/s.
        angular_velocity: Vec3,
    },
}

/// Mass, shape and drive of a rigid body whose reference has its centre of mass at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Rigid {
    /// Mass, kg.
    pub mass: f64,
    /// Inertia about the centre of mass in the axes of the reference, kg m2.
    pub inertia: Matrix3<f64>,
    /// Volume of the fluid that it displaces, m3.
    pub volume: f64,
    /// Inertia of that volume at unit density, m5.
    pub volume_inertia: Matrix3<f64>,
    /// What drives it.
    pub drive: RigidDrive,
}

/// Newton's law for one step, as an [`crate::Exchange`] has to fulfil it together with no slip:
/// `mass U + dt F = momentum` and `inertia W + dt T = angular_momentum`, with the force `F` and the torque `T` of the
/// body on the fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidLaw {
    /// Mass that the step accelerates, kg; zero for a body as dense as the fluid.
    pub mass: f64,
    /// Inertia that the step accelerates, in the axes of space, kg m2.
    pub inertia: Matrix3<f64>,
    /// Momentum before the step and what other forces add, N s.
    pub momentum: Vec3,
    /// The same of the angular momentum about the centre, N m s.
    pub angular_momentum: Vec3,
}

/// A rigid body in a scene.
///
/// The grid's fluid fills the body too and is carried along by it, so the force `F` of the body on the fluid also
/// accelerates this inner fluid of mass `M_f`, which the true body does not contain. The inner fluid is taken to move as
/// the body does (Feng and Michaelides, Comput. Fluids 38 (2009) 370), so that
/// `(M - M_f) dU/dt = -F + F_fields` and `d((I - I_f) W)/dt = -T + T_fields`; in a flow that a uniform force density
/// drives, the inner fluid's share of it is the push of the pressure gradient that it stands for. The step is implicit in
/// `F` and `T`, so a mass difference of zero does no harm. Where the body is lighter than the fluid, the negative
/// difference is multiplied by the acceleration of the steps before (a mean that forgets in a few steps) instead.
#[derive(Clone, Debug)]
pub struct RigidState {
    /// Number of the body.
    pub id: u32,
    /// Place of its centre of mass (m) and rotation of its reference.
    pub pose: Isometry3<f64>,
    /// Velocity of the centre, m/s.
    pub velocity: Vec3,
    /// Angular velocity, 1/s.
    pub angular_velocity: Vec3,
    /// Newton's law for the step under way; none where the motion is given.
    pub law: Option<RigidLaw>,
    /// Force (N) and torque (N m) about the centre of mass of the body on the fluid in the last step, the inner fluid
    /// included.
    pub on_fluid: Wrench,
    pub(crate) rigid: Rigid,
    pub(crate) body: usize,
    /// Velocity and angular velocity of the step before.
    before: [Vec3; 2],
    /// Angular momentum by Newton's law after the last step, if it obeyed it.
    angular_momentum: Option<Vec3>,
    /// Mean acceleration of the steps before, m/s2, and mean rate of change of the angular momentum at unit density.
    mean_rate: [Vec3; 2],
    /// Rate of change of the inner fluid's momenta at unit density in the last step: m4/s2 and m5/s2.
    inner: Wrench,
    density: f64,
}

/// Share of the last acceleration in the mean that a light body goes by.
const MEMORY: f64 = 0.2;

impl RigidState {
    pub(crate) fn new(id: u32, body: usize, rigid: Rigid, pose: Isometry3<f64>) -> Self {
        let mut state = Self {
            id,
            pose,
            velocity: Vec3::zeros(),
            angular_velocity: Vec3::zeros(),
            law: None,
            on_fluid: Wrench::zero(),
            rigid,
            body,
            before: [Vec3::zeros(); 2],
            angular_momentum: None,
            mean_rate: [Vec3::zeros(); 2],
            inner: Wrench::zero(),
            density: 0.0,
        };
        state.drive(state.rigid.drive);
        state
    }

    /// Changes what drives the body; a free one starts from the velocity it has.
    pub(crate) fn drive(&mut self, drive: RigidDrive) {
        self.rigid.drive = drive;
        if let RigidDrive::Given {
            velocity,
            angular_velocity,
        } = drive
        {
            self.velocity = velocity;
            self.angular_velocity = angular_velocity;
        }
        self.mean_rate = [Vec3::zeros(); 2];
    }

    /// A tensor in the axes of the reference, in those of space.
    fn turned(&self, tensor: &Matrix3<f64>) -> Matrix3<f64> {
        let r = self.pose.rotation.to_rotation_matrix();
        r.matrix() * tensor * r.matrix().transpose()
    }

    /// The mass difference to a fluid of `density` (kg/m3).
    pub(crate) fn excess_mass(&self, density: f64) -> f64 {
        self.rigid.mass - density * self.rigid.volume
    }

    /// Sets up Newton's law for a step of `dt` (s) under `load` (N, N m) in a fluid of `density` (kg/m3).
    pub(crate) fn begin(&mut self, load: Wrench, density: f64, dt: f64) {
        self.density = density;
        self.before = [self.velocity, self.angular_velocity];
        if self.rigid.drive != RigidDrive::Free {
            self.law = None;
            return;
        }
        let excess = self.excess_mass(density);
        let mass = excess.max(0.0);
        let mut momentum = mass * self.velocity + dt * load.force;
        if excess < 0.0 {
            momentum -= dt * excess * self.mean_rate[0];
        }
        let difference = self.rigid.inertia - density * self.rigid.volume_inertia;
        let lighter = difference.symmetric_eigenvalues().min() < -1e-12 * self.rigid.inertia.norm();
        let mut angular_momentum = dt * load.torque;
        let inertia = if lighter {
            // The difference need not be in proportion to the inner fluid's inertia: its tensor acts on the mean rate.
            let inner = self.turned(&self.rigid.volume_inertia);
            let rate = inner.try_inverse().map_or(Vec3::zeros(), |i| i * self.mean_rate[1]);
            angular_momentum -= dt * (self.turned(&difference) * rate);
            Matrix3::zeros()
        } else {
            let inertia = self.turned(&difference);
            // Kept from the step before, with the inertia that belonged to the old pose.
            angular_momentum += self.angular_momentum.unwrap_or(inertia * self.angular_velocity);
            inertia
        };
        self.law = Some(RigidLaw {
            mass,
            inertia,
            momentum,
            angular_momentum,
        });
    }

    /// Notes the accelerations of a step of `dt` (s) whose velocities are known, then moves the body.
    pub(crate) fn finish(&mut self, dt: f64) {
        let inner = self.turned(&self.rigid.volume_inertia);
        let turn = self.angular_velocity - self.before[1];
        self.inner = Wrench {
            force: (self.velocity - self.before[0]) * (self.rigid.volume / dt),
            torque: inner * turn / dt + self.angular_velocity.cross(&(inner * self.angular_velocity)),
        };
        if self.rigid.drive == RigidDrive::Free {
            let rate = [(self.velocity - self.before[0]) / dt, self.inner.torque];
            for (mean, rate) in self.mean_rate.iter_mut().zip(rate) {
                *mean += MEMORY * (rate - *mean);
            }
        }
        self.angular_momentum = self.law.map(|law| law.inertia * self.angular_velocity);
        self.pose.translation.vector += self.velocity * dt;
        let turn = nalgebra::UnitQuaternion::from_scaled_axis(self.angular_velocity * dt);
        self.pose.rotation = turn * self.pose.rotation;
        self.pose.rotation.renormalize();
    }

    /// Writes what a step reads of it.
    pub(crate) fn save(&self, to: &mut StateWriter) {
        to.vector(self.pose.translation.vector);
        to.numbers(self.pose.rotation.coords.as_slice());
        to.count(u64::from(self.rigid.drive == RigidDrive::Free));
        to.count(u64::from(self.angular_momentum.is_some()));
        to.number(self.density);
        for vector in self.vectors() {
            to.vector(vector);
        }
    }

    /// Takes what [`RigidState::save`] has written.
    pub(crate) fn restore(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError> {
        let place = Translation3::from(from.vector()?);
        let mut rotation = [0.0; 4];
        from.numbers(&mut rotation)?;
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from(rotation));
        self.pose = Isometry3::from_parts(place, rotation);
        let (free, has_momentum) = (from.count()? != 0, from.count()? != 0);
        self.density = from.number()?;
        let mut vectors = self.vectors();
        for vector in &mut vectors {
            *vector = from.vector()?;
        }
        let [velocity, angular_velocity, before, before_angular, momentum, rest @ ..] = vectors;
        let [rate, angular_rate, force, torque, inner_force, inner_torque] = rest;
        self.velocity = velocity;
        self.angular_velocity = angular_velocity;
        self.before = [before, before_angular];
        self.angular_momentum = has_momentum.then_some(momentum);
        self.mean_rate = [rate, angular_rate];
        self.on_fluid = Wrench { force, torque };
        self.inner = Wrench {
            force: inner_force,
            torque: inner_torque,
        };
        self.rigid.drive = match free {
            true => RigidDrive::Free,
            false => RigidDrive::Given {
                velocity,
                angular_velocity,
            },
        };
        Ok(())
    }

    /// The vectors of its state, in the order in which they are saved.
    fn vectors(&self) -> [Vec3; 11] {
        [
            self.velocity,
            self.angular_velocity,
            self.before[0],
            self.before[1],
            self.angular_momentum.unwrap_or_default(),
            self.mean_rate[0],
            self.mean_rate[1],
            self.on_fluid.force,
            self.on_fluid.torque,
            self.inner.force,
            self.inner.torque,
        ]
    }

    /// Force (N) and torque (N m) about the centre of mass of the fluid on the true body in the last step: minus that on
    /// the fluid, plus the rate of change of the inner fluid's momentum.
    pub fn from_fluid(&self) -> Wrench {
        Wrench {
            force: self.density * self.inner.force - self.on_fluid.force,
            torque: self.density * self.inner.torque - self.on_fluid.torque,
        }
    }

    /// Velocity (m/s) of the body's point at `x` (m).
    #[inline]
    pub fn velocity_at(&self, x: Vec3) -> Vec3 {
        self.velocity + self.angular_velocity.cross(&(x - self.pose.translation.vector))
    }
}
