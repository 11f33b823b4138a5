//! Rigid bodies in a fluid of separate nodes, each of which only obeys Newton's law: what the forcing itself has to keep.

use lbm_ibm_coupling::nalgebra::{Isometry3, Matrix3};
use lbm_ibm_coupling::{
    BRICK_EDGE, BRICK_NODES, Boundary, Bricks, ExchangeError, FluidError, ForceField, Grid, Lattice, Loads, RigidDrive,
    Scene, SceneError, Vec3, View, WallReport,
};
use lbm_ibm_ibm::{Buoyancy, DeltaExchange, Kernel, RigidBody, RigidError};
use std::sync::Arc;

const N: usize = 24;
const H: f64 = 1e-6;
const DENSITY: f64 = 1e3;
const DT: f64 = 1e-7;

/// Nodes without pressure or viscosity.
struct Dust {
    grid: Grid,
    velocity: Vec<Vec3>,
}

impl Dust {
    fn new() -> Self {
        Self {
            grid: Grid::new([N; 3], H, [true; 3]),
            velocity: vec![Vec3::zeros(); N * N * N],
        }
    }

    fn momentum(&self) -> Vec3 {
        self.velocity.iter().sum::<Vec3>() * (DENSITY * H.powi(3))
    }

    fn angular_momentum(&self, centre: Vec3) -> Vec3 {
        let place = |n: usize| self.grid.position(n % N, n / N % N, n / (N * N)) - centre;
        let moments = self.velocity.iter().enumerate().map(|(n, v)| place(n).cross(v));
        moments.sum::<Vec3>() * (DENSITY * H.powi(3))
    }

    /// Slot and node of every brick node, and the number of the node on the grid.
    fn nodes(bricks: &Bricks) -> impl Iterator<Item = (usize, usize)> {
        (0..bricks.len()).flat_map(|slot| {
            let [x, y, z] = bricks.brick(slot).map(|b| b * BRICK_EDGE);
            (0..BRICK_NODES).map(move |n| {
                let [i, j, k] = [
                    n % BRICK_EDGE,
                    n / BRICK_EDGE % BRICK_EDGE,
                    n / (BRICK_EDGE * BRICK_EDGE),
                ];
                (slot * BRICK_NODES + n, ((z + k) * N + y + j) * N + x + i)
            })
        })
    }
}

impl Lattice for Dust {
    fn grid(&self) -> &Grid {
        &self.grid
    }

    fn time_step(&self) -> f64 {
        DT
    }

    fn viscosity(&self) -> f64 {
        1e-3
    }

    fn density(&self) -> f64 {
        DENSITY
    }

    fn set_walls(&mut self, _walls: Option<Arc<dyn Boundary>>, _t: f64) -> Result<WallReport, FluidError> {
        Ok(WallReport::default())
    }

    fn read_velocity(&mut self, bricks: &mut Bricks) {
        let nodes: Vec<_> = Self::nodes(bricks).collect();
        let (velocity, force) = bricks.velocity_mut_and_force();
        for (at, node) in nodes {
            for a in 0..3 {
                velocity[a][at] = self.velocity[node][a] + 0.5 * DT / (DENSITY * H.powi(3)) * force[a][at];
            }
        }
    }

    fn advance(&mut self, bricks: &Bricks) -> Result<(), FluidError> {
        for (at, node) in Self::nodes(bricks) {
            for a in 0..3 {
                self.velocity[node][a] += DT / (DENSITY * H.powi(3)) * bricks.force()[a][at];
            }
        }
        Ok(())
    }
}

/// A force and a torque on each body, and a stiffness that it owns up to.
struct Pull {
    force: Vec3,
    torque: Vec3,
    stiffness: Option<f64>,
}

impl ForceField for Pull {
    fn name(&self) -> &str {
        "pull"
    }

    fn add_loads(&mut self, _view: &View<'_>, loads: &mut Loads) {
        for load in &mut loads.body {
            load.force += self.force;
            load.torque += self.torque;
        }
    }

    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        self.stiffness
    }
}

fn middle() -> Isometry3<f64> {
    let c = 0.5 * N as f64 * H;
    Isometry3::translation(c + 0.2 * H, c + 0.3 * H, c - 0.4 * H)
}

fn sphere(ratio: f64) -> RigidBody {
    RigidBody::sphere(4.0 * H, ratio * DENSITY).expect("a good sphere")
}

fn scene(body: RigidBody, kernel: Kernel) -> (Scene, u32) {
    let mut scene = Scene::with_fluid(Dust::new(), DeltaExchange::new(kernel));
    let id = scene.add_body(body, &middle()).expect("room for a body");
    (scene, id)
}

fn run(scene: &mut Scene, steps: usize) {
    for _ in 0..steps {
        scene.step().expect("a smooth run");
    }
}

#[test]
fn body_and_fluid_share_what_is_given_to_them() {
    // No slip ends at a small slip, Newton's law and momentum hold to rounding all the same.
    let (force, torque) = (Vec3::new(2e-12, -1e-12, 0.5e-12), Vec3::new(1e-18, 3e-18, -2e-18));
    for ratio in [1.0, 1.8] {
        for kernel in [Kernel::TwoPoint, Kernel::RomaThree, Kernel::PeskinFour] {
            let body = sphere(ratio);
            let excess = body.excess_mass(DENSITY);
            let spin = 0.4 * excess * (4.0 * H).powi(2);
            let (mut scene, id) = scene(body, kernel);
            scene.add_field(Pull {
                force,
                torque,
                stiffness: None,
            });
            let centre = scene.pose(id).expect("a pose").translation.vector;
            run(&mut scene, 20);
            let state = scene.rigid_body(id).expect("it is rigid").clone();
            let dust: &mut Dust = scene.fluid_as().expect("dust");
            let given = force * (20.0 * DT);
            let all = dust.momentum() + excess * state.velocity;
            assert!(
                (all - given).norm() < 1e-12 * given.norm(),
                "{kernel:?} {ratio}: {all} {given}"
            );
            let given = torque * (20.0 * DT);
            let all = dust.angular_momentum(centre) + spin * state.angular_velocity;
            // The body has moved a little on the way, and the forces' point with it.
            assert!(
                (all - given).norm() < 1e-5 * given.norm(),
                "{kernel:?} {ratio}: {all} {given}"
            );
        }
    }
}

#[test]
fn a_light_body_is_stable_and_gains_its_momentum() {
    // Body and layer of dust have the same momentum whatever the body weighs: 1/U is linear in the mass, with the slope
    // one over the momentum given.
    let (pull, steps) = (1e-12, 100);
    let inverse = [0.01, 0.5, 1.0].map(|ratio| {
        let (mut scene, id) = scene(sphere(ratio), Kernel::RomaThree);
        scene.add_field(Buoyancy::new(Vec3::z()).with("sphere", pull));
        run(&mut scene, steps);
        1.0 / scene.rigid_body(id).expect("it is rigid").velocity.z
    });
    let slope = sphere(1.0).mass() / (pull * steps as f64 * DT);
    for (at, mass) in [(0, 0.99), (1, 0.5)] {
        let found = (inverse[2] - inverse[at]) / mass;
        assert!((found / slope - 1.0).abs() < 0.1, "{found} {slope}");
    }
}

#[test]
fn the_fluid_follows_a_given_motion_and_the_load_is_what_it_takes() {
    let (velocity, angular_velocity) = (Vec3::new(0.01, 0.02, -0.01), Vec3::new(0.0, 3e3, 1e3));
    let (mut scene, id) = scene(sphere(1.0).moving(velocity, angular_velocity), Kernel::RomaThree);
    let mut before = Vec3::zeros();
    for step in 0..12 {
        scene.step().expect("a smooth run");
        let on_fluid = scene.rigid_body(id).expect("it is rigid").on_fluid.force;
        let after = scene.fluid_as::<Dust>().expect("dust").momentum();
        assert!(
            ((after - before) / DT - on_fluid).norm() < 1e-9 * on_fluid.norm().max(1e-12),
            "{step}"
        );
        before = after;
    }
    let exchange: &DeltaExchange = scene.exchange_as().expect("the exchange");
    let (slip, iterations) = exchange.rigid_slip();
    assert!(slip < 1e-3 && iterations < 30, "{slip} {iterations}");
    // Held bodies report the load: the fluid that still streams past it pulls along its way.
    let held = RigidDrive::Given {
        velocity: Vec3::zeros(),
        angular_velocity: Vec3::zeros(),
    };
    scene.set_drive(id, held).expect("it is rigid");
    scene.step().expect("a smooth step");
    assert!(scene.wrench_on(id).expect("a load").force.dot(&velocity) > 0.0);
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let bits = |threads: usize| -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let (mut scene, _) = scene(sphere(1.3), Kernel::PeskinFour);
            let aside = Isometry3::translation(4.0 * H, 5.0 * H, 6.0 * H);
            scene.add_body(sphere(0.9), &aside).expect("room for two");
            scene.add_field(Pull {
                force: Vec3::x() * 1e-11,
                torque: Vec3::y() * 1e-17,
                stiffness: None,
            });
            run(&mut scene, 10);
            let all = [scene.positions().x, scene.positions().y, scene.positions().z].concat();
            all.iter().map(|x| x.to_bits()).collect()
        })
    };
    let one = bits(1);
    assert!(one == bits(2) && one == bits(5));
}

#[test]
fn too_stiff_a_contact_is_refused_with_the_limit() {
    let limit_at = |stiffness: f64| {
        let (mut scene, _) = scene(sphere(1.5), Kernel::RomaThree);
        scene.add_field(Pull {
            force: Vec3::zeros(),
            torque: Vec3::zeros(),
            stiffness: Some(stiffness),
        });
        scene.prepare()
    };
    assert!(limit_at(1e-3).is_ok());
    let Err(SceneError::TimeStep { limit, .. }) = limit_at(1e3) else {
        panic!("a stiff contact has passed");
    };
    // A mass between the body's excess alone and ten times its own.
    let mass = |k: f64| 2.0 * k * limit * limit;
    let own = sphere(1.5).mass();
    assert!(mass(1e3) > own / 3.0 && mass(1e3) < 10.0 * own, "{} {own}", mass(1e3));
}

#[test]
fn what_makes_no_rigid_body_is_refused() {
    let positive = RigidBody::sphere(-1.0, 1.0).map(|_| ());
    assert!(matches!(positive, Err(RigidError::NotPositive { name: "radius", .. })));
    assert!(RigidBody::ellipsoid([1.0, f64::NAN, 1.0], 1.0).is_err());
    assert!(sphere(1.0).with_inertia(1.0, Matrix3::zeros()).is_err());
    let inward = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]];
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::from);
    assert!(matches!(
        RigidBody::mesh(&corners, &inward, 1.0),
        Err(RigidError::NoVolume { .. })
    ));
    let small = RigidBody::sphere(H, DENSITY).expect("a good sphere");
    let mut scene = Scene::with_fluid(Dust::new(), DeltaExchange::new(Kernel::RomaThree));
    let error = scene
        .add_body(small.clone(), &middle())
        .expect_err("smaller than the kernel knows");
    let SceneError::Exchange(ExchangeError::TooSmall { radius_in_cells, .. }) = error else {
        panic!("another error: {error}");
    };
    assert!((radius_in_cells - 1.0).abs() < 1e-12 && scene.bodies().is_empty() && scene.rigid_bodies().is_empty());
    scene.add_body(sphere(1.0), &middle()).expect("the scene is as before");
    let mut dry = Scene::without_fluid(DT).expect("a good time step");
    assert!(matches!(
        dry.add_body(small, &middle()),
        Err(SceneError::NeedsFluid { .. })
    ));
}

#[test]
fn bodies_come_and_go_and_keep_their_state() {
    let (mut scene, first) = scene(sphere(1.2), Kernel::RomaThree);
    let aside = Isometry3::translation(4.0 * H, 5.0 * H, 6.0 * H);
    let second = scene.add_body(sphere(1.1), &aside).expect("room for two");
    scene.add_field(Pull {
        force: Vec3::x() * 1e-11,
        torque: Vec3::zeros(),
        stiffness: None,
    });
    run(&mut scene, 5);
    let before = scene.rigid_body(second).expect("it is rigid").velocity;
    scene.remove_body(first).expect("it is there");
    assert_eq!(scene.rigid_body(second).expect("it is rigid").velocity, before);
    run(&mut scene, 1);
    let after = scene.rigid_body(second).expect("it is rigid").velocity;
    assert!((after - before).norm() < 0.5 * before.norm());
    assert!(matches!(scene.pose(first), Err(SceneError::UnknownBody { .. })));
    let nodes = scene.positions().iter().collect::<lbm_ibm_coupling::Soa3>();
    assert!(matches!(
        scene.set_body_positions(second, nodes.view()),
        Err(SceneError::FollowsPose { .. })
    ));
    scene.set_pose(second, &middle()).expect("it is rigid");
    let mean = scene.body_positions(second).expect("it is there").mean();
    assert!((mean - middle().translation.vector).norm() < 1e-9 * H);
}

#[test]
fn a_meshed_sphere_weighs_and_drags_like_a_sphere() {
    // The mesh of a sphere as a closed mesh of anybody's.
    let ball = sphere(1.0);
    let nodes: Vec<Vec3> = lbm_ibm_coupling::ImmersedBody::reference(&ball).iter().collect();
    let triangles = lbm_ibm_coupling::ImmersedBody::triangles(&ball).to_vec();
    let (mesh, centre) = RigidBody::mesh(&nodes, &triangles, DENSITY).expect("a closed mesh");
    assert!(centre.norm() < 1e-9 * H);
    assert!((mesh.mass() / ball.mass() - 1.0).abs() < 0.02);
    let load = |body: RigidBody| {
        let (mut scene, id) = scene(body.moving(Vec3::x() * 0.01, Vec3::zeros()), Kernel::RomaThree);
        run(&mut scene, 1);
        scene.rigid_body(id).expect("it is rigid").on_fluid.force.x
    };
    assert!((load(mesh) / load(ball) - 1.0).abs() < 0.05);
}
