//! Net force and torque of a set of node forces.

use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};

/// Takes the net force and the net torque off all nodes: what would move the cell as a rigid body of equal nodes.
pub(crate) fn take_off(x: Soa3Ref<'_>, f: &mut Soa3) {
    let n = x.len();
    let (centre, mean) = (x.mean(), f.view().mean());
    let (mut torque, mut inertia) = (Vec3::zeros(), Matrix3::zeros());
    for i in 0..n {
        let r = x.get(i) - centre;
        torque += r.cross(&f.get(i));
        inertia += Matrix3::identity() * r.norm_squared() - r * r.transpose();
    }
    let turn = inertia.try_inverse().map_or(Vec3::zeros(), |inverse| inverse * torque);
    for i in 0..n {
        let r = x.get(i) - centre;
        f.add(i, -mean - turn.cross(&r));
    }
}
