//! A scene without a fluid: motion, bodies that come and go, the guard, and what is refused.

use approx::assert_relative_eq;
use lbm_ibm_coupling::nalgebra::Isometry3;
use lbm_ibm_coupling::{
    ForceField, Guard, ImmersedBody, Loads, Motion, Plane, Run, Scene, SceneError, Schedule, Soa3, Soa3Mut, Soa3Ref,
    Vec3, View,
};
use std::sync::Arc;

const FRICTION: f64 = 2.0;

/// A tetrahedron whose nodes are tied to where they began by springs.
struct Tetrahedron {
    x: Soa3,
    stiffness: f64,
    motion: Motion,
}

const TRIANGLES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

impl Tetrahedron {
    fn new(stiffness: f64) -> Self {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self {
            x: corners.map(Vec3::from).into_iter().collect(),
            stiffness,
            motion: Motion::Overdamped { friction: FRICTION },
        }
    }
}

impl ImmersedBody for Tetrahedron {
    fn kind(&self) -> &str {
        "tetrahedron"
    }

    fn reference(&self) -> Soa3Ref<'_> {
        self.x.view()
    }

    fn triangles(&self) -> &[[u32; 3]] {
        &TRIANGLES
    }

    fn motion(&self) -> Motion {
        self.motion
    }

    fn add_internal_forces(&mut self, x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        let shift = x.mean() - self.x.view().mean();
        for i in 0..x.len() {
            force.add(i, (self.x.get(i) + shift - x.get(i)) * self.stiffness);
        }
    }
}

/// A force on each whole body, and one on its first node alone.
struct Push {
    body: Vec3,
    first_node: Vec3,
}

impl ForceField for Push {
    fn name(&self) -> &str {
        "push"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        for (b, body) in view.bodies.iter().enumerate() {
            loads.body[b].force += self.body;
            loads.node.add(body.range.start, self.first_node);
        }
    }
}

fn push(body: Vec3, first_node: Vec3) -> Push {
    Push { body, first_node }
}

fn scene_with(body: Tetrahedron) -> (Scene, u32) {
    let mut scene = Scene::without_fluid(0.01).expect("a good time step");
    let id = scene.add_body(body, &Isometry3::identity()).expect("a good body");
    (scene, id)
}

#[test]
fn an_overdamped_body_drifts_at_force_over_friction() {
    let (mut scene, id) = scene_with(Tetrahedron::new(1.0));
    scene.add_field(push(Vec3::new(8.0, 0.0, -4.0), Vec3::zeros()));
    let mut times = Vec::new();
    let end = Run::new()
        .until_time(1.0)
        .observe(Schedule::Seconds(0.25), |s| {
            times.push(s.time());
            Ok(())
        })
        .run(&mut scene)
        .expect("a smooth run");
    assert_eq!((end.steps, end.reason.as_str()), (100, "time"));
    assert_eq!(times.len(), 5);
    let moved = scene.body_positions(id).expect("the body").mean() - Vec3::repeat(0.25);
    assert_relative_eq!(moved, Vec3::new(8.0, 0.0, -4.0) / (4.0 * FRICTION), epsilon = 1e-12);
}

#[test]
fn the_body_that_stays_keeps_its_number_and_place() {
    let (mut scene, first) = scene_with(Tetrahedron::new(1.0));
    let second = scene
        .add_body(Tetrahedron::new(1.0), &Isometry3::translation(5.0, 0.0, 0.0))
        .expect("room for two");
    scene.remove_body(first).expect("it is there");
    assert_eq!(scene.bodies().len(), 1);
    assert_eq!(scene.bodies()[0].range, 0..4);
    assert_relative_eq!(scene.body_positions(second).expect("it stays").mean().x, 5.25);
    scene.step().expect("one body steps");
    let gone = scene.remove_body(first).expect_err("gone already");
    assert!(matches!(gone, SceneError::UnknownBody { body: 0, bodies: 1 }));
}

#[test]
fn a_body_in_a_wall_is_refused_with_its_depth_and_the_scene_is_as_before() {
    let mut scene = Scene::without_fluid(0.01).expect("a good time step");
    let floor = Arc::new(Plane::new(Vec3::y() * 0.5, Vec3::y()).with_part(3));
    scene.set_walls(floor).expect("no body yet");
    let error = scene
        .add_body(Tetrahedron::new(1.0), &Isometry3::identity())
        .expect_err("three nodes are below");
    let SceneError::BodyInWall {
        inside, part, depth, ..
    } = error
    else {
        panic!("another error: {error}");
    };
    assert_eq!((inside, part), (3, 3));
    assert_relative_eq!(depth, 0.5);
    assert!(scene.bodies().is_empty());
    scene
        .add_body(Tetrahedron::new(1.0), &Isometry3::translation(0.0, 0.6, 0.0))
        .expect("above the floor");
}

#[test]
fn a_step_over_the_limit_of_the_springs_is_refused_with_the_limit() {
    let (mut scene, _) = scene_with(Tetrahedron::new(500.0));
    let error = scene.step().expect_err("2 friction/k = 0.008 s");
    let SceneError::TimeStep { limit, .. } = error else {
        panic!("another error: {error}");
    };
    assert_relative_eq!(limit, 2.0 * FRICTION / 500.0, max_relative = 1e-6);
}

#[test]
fn a_body_that_needs_a_fluid_is_refused_without_one() {
    let mut scene = Scene::without_fluid(0.01).expect("a good time step");
    let mut body = Tetrahedron::new(1.0);
    body.motion = Motion::Advected;
    let error = scene.add_body(body, &Isometry3::identity()).expect_err("no fluid");
    assert!(matches!(error, SceneError::NeedsFluid { .. }));
    assert!(matches!(
        Scene::without_fluid(f64::NAN).err(),
        Some(SceneError::NotPositive { .. })
    ));
}

#[test]
fn the_guard_names_what_went_wrong() {
    let tight = Guard {
        every: 1,
        volume: 0.01,
        area: 10.0,
        ..Guard::default()
    };
    let run = |guard: Guard, force: Vec3| {
        let (scene, _) = scene_with(Tetrahedron::new(1.0));
        let mut scene = scene.with_guard(guard);
        scene.add_field(push(Vec3::zeros(), force));
        let end = Run::new().until_time(20.0).run(&mut scene);
        end.expect_err("the guard ends the run").to_string()
    };
    let volume = run(tight.clone(), -Vec3::x());
    assert!(volume.contains("volume has changed by"), "{volume}");
    let wide = Guard {
        volume: 1e9,
        area: 0.2,
        ..tight.clone()
    };
    let area = run(wide, -Vec3::repeat(1.0));
    assert!(area.contains("area strain is 0.2"), "{area}");
    let finite = run(tight, Vec3::repeat(f64::NAN));
    assert!(finite.contains("node 0 is not finite at step 1"), "{finite}");
}

#[test]
fn a_frozen_body_stays() {
    let mut body = Tetrahedron::new(1.0);
    body.motion = Motion::Frozen;
    let (mut scene, id) = scene_with(body);
    scene.add_field(push(Vec3::repeat(1.0), Vec3::zeros()));
    Run::new().until_step(10).run(&mut scene).expect("nothing moves");
    assert_relative_eq!(scene.body_positions(id).expect("the body").mean(), Vec3::repeat(0.25));
}

#[test]
fn positions_that_are_not_one_per_node_are_refused() {
    let (mut scene, id) = scene_with(Tetrahedron::new(1.0));
    let error = scene
        .set_body_positions(id, Soa3::zeros(3).view())
        .expect_err("four nodes");
    assert!(matches!(
        error,
        SceneError::WrongLength {
            body: 0,
            nodes: 4,
            given: 3
        }
    ));
    let error = scene.pose(id).expect_err("it is not rigid");
    assert!(matches!(error, SceneError::NotRigid { body: 0, .. }));
}

#[test]
fn a_rigid_body_without_a_mass_is_refused() {
    let mut scene = Scene::without_fluid(0.01).expect("a good time step");
    let mut body = Tetrahedron::new(1.0);
    body.motion = Motion::Rigid;
    let error = scene.add_body(body, &Isometry3::identity()).expect_err("no fluid");
    assert!(matches!(error, SceneError::NeedsFluid { .. }));
}

/// A body whose constraint keeps its node 0 at rest.
struct Nailed(Tetrahedron);

impl ImmersedBody for Nailed {
    fn kind(&self) -> &str {
        "nailed"
    }

    fn reference(&self) -> Soa3Ref<'_> {
        self.0.reference()
    }

    fn triangles(&self) -> &[[u32; 3]] {
        self.0.triangles()
    }

    fn motion(&self) -> Motion {
        self.0.motion()
    }

    fn add_internal_forces(&mut self, _x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        for i in 0..force.x.len() {
            force.add(i, Vec3::x());
        }
    }

    fn constrain(&mut self, x: &mut Soa3Mut<'_>) {
        let at = self.0.x.get(0);
        (x.x[0], x.y[0], x.z[0]) = (at.x, at.y, at.z);
    }
}

#[test]
fn a_constraint_of_a_body_holds_after_a_step() {
    let mut scene = Scene::without_fluid(0.1).expect("a time step");
    scene
        .add_body(Tetrahedron::new(1.0), &Isometry3::identity())
        .expect("a body");
    let id = scene
        .add_body(Nailed(Tetrahedron::new(1.0)), &Isometry3::identity())
        .expect("a body");
    scene.step().expect("a step");
    let x = scene.body_positions(id).expect("the body");
    assert_eq!(x.get(0), Vec3::zeros());
    assert_relative_eq!(x.get(1).x, 1.0 + 0.1 / FRICTION, epsilon = 1e-14);
}
