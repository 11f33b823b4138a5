//! Rigid motions at markers, and loads of markers on rigid bodies.

use lbm_ibm_coupling::Vec3;
use lbm_ibm_coupling::nalgebra::{Matrix3, Matrix6, Vector6};

/// Velocity and angular velocity times the grid spacing, or another pair that is added and scaled like it.
pub(super) type Twist = Vector6<f64>;

pub(super) fn twist(velocity: Vec3, angular: Vec3) -> Twist {
    Twist::from_iterator(velocity.iter().chain(angular.iter()).copied())
}

/// Velocity of a rigid motion at `arm` from the centre.
#[inline]
pub(super) fn at(velocity: &Twist, arm: &Vec3) -> Vec3 {
    let [a, b, c] = [velocity[3], velocity[4], velocity[5]];
    Vec3::new(
        velocity[0] + b * arm.z - c * arm.y,
        velocity[1] + c * arm.x - a * arm.z,
        velocity[2] + a * arm.y - b * arm.x,
    )
}

/// Sum of forces and of their torques.
pub(super) fn sum(force: &[Vec3], arm: &[Vec3]) -> Twist {
    let (mut total, mut torque) = (Vec3::zeros(), Vec3::zeros());
    for (f, r) in force.iter().zip(arm) {
        total += f;
        torque += r.cross(f);
    }
    twist(total, torque)
}

pub(super) fn generalised(mass: f64, inertia: &Matrix3<f64>) -> Matrix6<f64> {
    let mut out = Matrix6::zeros();
    out.fixed_view_mut::<3, 3>(0, 0)
        .copy_from(&(Matrix3::identity() * mass));
    out.fixed_view_mut::<3, 3>(3, 3).copy_from(inertia);
    out
}

pub(super) fn dot(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

pub(super) fn norm(a: &[Vec3]) -> f64 {
    dot(a, a).sqrt()
}
