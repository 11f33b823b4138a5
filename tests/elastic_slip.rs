//! Nodes of an elastic surface that slip by what the kernel takes off the kink of the velocity.

use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{Grid, ImmersedBody, Scene, Soa3, Soa3Mut, Soa3Ref, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Fluid, Pace};
use lbm_ibm::membrane::Mesh;
use std::f64::consts::PI;

const H: f64 = 1e-6;
const VISCOSITY: f64 = 1e-3;
const DENSITY: f64 = 1e3;
/// Traction along the surface at the equator, Pa.
const TRACTION: f64 = 1e-3;

/// A shell that is turned about z by a traction that goes with the distance from the axis.
struct Turned {
    mesh: Mesh,
    force: Soa3,
}

impl Turned {
    fn new(radius: f64, nodes: usize) -> Self {
        let mesh = Mesh::sphere(radius, nodes).expect("a sphere");
        let x: Vec<Vec3> = mesh.nodes().iter().collect();
        let mut force = Soa3::zeros(x.len());
        for t in mesh.triangles() {
            let t = t.map(|i| i as usize);
            let area = 0.5 * (x[t[1]] - x[t[0]]).cross(&(x[t[2]] - x[t[0]])).norm();
            for i in t {
                force.add(i, Vec3::z().cross(&x[i]) * (area / 3.0 * TRACTION / radius));
            }
        }
        Self { mesh, force }
    }

    fn torque(&self) -> f64 {
        let torque = |(x, f): (Vec3, Vec3)| x.cross(&f).z;
        self.mesh.nodes().iter().zip(self.force.iter()).map(torque).sum()
    }
}

impl ImmersedBody for Turned {
    fn kind(&self) -> &str {
        "turned shell"
    }

    fn reference(&self) -> Soa3Ref<'_> {
        self.mesh.nodes()
    }

    fn triangles(&self) -> &[[u32; 3]] {
        self.mesh.triangles()
    }

    fn add_internal_forces(&mut self, _x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for i in 0..self.force.len() {
            force.add(i, self.force.get(i));
        }
    }
}

/// Angular velocity of a shell of `radius` spacings under a torque in a box of six radii, over the exact one, `(1 - phi)/(8 pi mu R^3)` times the torque.
fn turning(kernel: Kernel, radius: f64, slip: bool) -> f64 {
    let side = (6.0 * radius) as usize;
    let fluid = Fluid::new(Grid::new([side; 3], H, [true; 3]), DENSITY, VISCOSITY, Pace::Tau(2.0));
    let fluid = fluid.expect("a fluid").with_inertia(false);
    let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(kernel).with_elastic_slip(slip));
    let size = radius * H;
    let nodes = (12.0 * PI * radius * radius) as usize;
    let shell = Turned::new(size, nodes);
    let torque = shell.torque();
    let middle = 0.5 * side as f64 * H;
    let id = scene
        .add_body(shell, &Isometry3::translation(middle, middle, middle))
        .expect("room for it");
    // Twice the time in which momentum spreads over the box, the slowest wave decaying by 2 pi squared in one.
    for _ in 0..(0.5 * (side * side) as f64) as usize {
        scene.step().expect("a step");
    }
    let x = scene.body_positions(id).expect("its nodes");
    let v = scene.velocities();
    let centre = x.mean();
    let (spin, square) = x.iter().zip(v.iter()).fold((0.0, 0.0), |(spin, square), (x, v)| {
        let arm = Vec3::new(x.x - centre.x, x.y - centre.y, 0.0);
        (spin + arm.cross(&v).z, square + arm.norm_squared())
    });
    let phi = 4.0 / 3.0 * PI * (radius / side as f64).powi(3);
    let exact = torque * (1.0 - phi) / (8.0 * PI * VISCOSITY * size.powi(3));
    spin / square / exact
}

#[test]
fn a_turned_shell_is_as_fast_as_it_should_be() {
    for kernel in [Kernel::TwoPoint, Kernel::RomaThree, Kernel::PeskinFour] {
        let plain = turning(kernel, 4.0, false) - 1.0;
        let slips = turning(kernel, 4.0, true) - 1.0;
        println!("{kernel:?}: off by {plain:.3} without slip, {slips:.4} with it");
        assert!(plain < -0.15, "{kernel:?} {plain}");
        assert!(slips.abs() < 0.03, "{kernel:?} {slips}");
    }
}

#[test]
fn what_is_left_is_of_the_second_order() {
    let error = |radius| (turning(Kernel::PeskinFour, radius, true) - 1.0).abs();
    let (coarse, fine) = (error(4.0), error(8.0));
    assert!((coarse / fine).log2() > 1.5, "{coarse} {fine}");
}
