//! A fluid of a third party in a scene: anything that can say its velocity will do.

use lbm_ibm_coupling::nalgebra::Isometry3;
use lbm_ibm_coupling::{
    Boundary, Bricks, FluidError, Grid, ImmersedBody, Lattice, Scene, Soa3, Soa3Mut, Soa3Ref, Vec3, WallReport,
};
use lbm_ibm_ibm::DeltaExchange;
use std::sync::Arc;

const H: f64 = 1e-6;
const DT: f64 = 1e-6;
const VELOCITY: [f64; 3] = [1e-3, -2e-3, 5e-4];

/// A wind that takes no notice of what is in it, but counts the force it was given.
struct Wind {
    grid: Grid,
    impulse: Vec3,
}

impl Lattice for Wind {
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
        1e3
    }

    fn set_walls(&mut self, _walls: Option<Arc<dyn Boundary>>, _t: f64) -> Result<WallReport, FluidError> {
        Ok(WallReport::default())
    }

    fn read_velocity(&mut self, bricks: &mut Bricks) {
        let (velocity, _) = bricks.velocity_mut_and_force();
        for (all, v) in velocity.into_iter().zip(VELOCITY) {
            all.fill(v);
        }
    }

    fn advance(&mut self, bricks: &Bricks) -> Result<(), FluidError> {
        let force = |a: usize| bricks.force()[a].iter().sum::<f64>();
        self.impulse += Vec3::new(force(0), force(1), force(2)) * DT;
        Ok(())
    }
}

/// Three nodes, one of which is pulled at.
struct Triangle {
    nodes: Soa3,
    pull: Vec3,
}

impl ImmersedBody for Triangle {
    fn kind(&self) -> &str {
        "triangle"
    }

    fn reference(&self) -> Soa3Ref<'_> {
        self.nodes.view()
    }

    fn triangles(&self) -> &[[u32; 3]] {
        &[[0, 1, 2]]
    }

    fn add_internal_forces(&mut self, _x: Soa3Ref<'_>, _v: Soa3Ref<'_>, force: &mut Soa3Mut<'_>) {
        force.add(0, self.pull);
    }
}

#[test]
fn a_scene_runs_in_a_fluid_of_a_third_party() {
    let wind = Wind {
        grid: Grid::new([16, 16, 16], H, [true; 3]),
        impulse: Vec3::zeros(),
    };
    let mut scene = Scene::with_fluid(wind, DeltaExchange::new(Default::default()));
    let corners = [
        Vec3::new(0.0, 0.5, 0.0),
        Vec3::new(0.8, -0.4, 0.2),
        Vec3::new(-0.6, 0.3, 0.7),
    ];
    let pull = Vec3::new(1e-12, 2e-12, -1e-12);
    let nodes: Soa3 = corners.iter().map(|c| c * H).collect();
    let pose = Isometry3::translation(8.0 * H, 9.0 * H, 8.0 * H);
    scene.add_body(Triangle { nodes, pull }, &pose).expect("a body");
    let before: Vec<Vec3> = scene.positions().iter().collect();
    let steps = 200;
    (0..steps).for_each(|_| scene.step().expect("a step"));
    let time = f64::from(steps) * DT;
    for (x, start) in scene.positions().iter().zip(&before) {
        let exact = start + Vec3::from(VELOCITY) * time;
        assert!((x - exact).norm() < 1e-9 * H, "{x} {exact}");
    }
    let wind: &mut Wind = scene.fluid_as().expect("our fluid");
    assert!(
        (wind.impulse - pull * time).norm() < 1e-9 * (pull * time).norm(),
        "{}",
        wind.impulse
    );
}
