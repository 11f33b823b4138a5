//! A fluid of a third party in a scene: anything that can say its velocity will do.

use lbm_ibm_coupling::nalgebra::Isometry3;
use lbm_ibm_coupling::{
    BRICK_EDGE, BRICK_NODES, Boundary, Bricks, FluidError, Grid, ImmersedBody, Lattice, Scene, Soa3, Soa3Mut, Soa3Ref,
    Vec3, WallReport,
};
use lbm_ibm_ibm::DeltaExchange;
use std::sync::Arc;

const H: f64 = 1e-6;
const DT: f64 = 1e-6;
const RATE: f64 = 1e3;

/// A creeping shear `u_x = RATE (y - middle)` that takes no notice of what is in it, but counts the force it was given.
struct Shear {
    grid: Grid,
    impulse: Vec3,
}

impl Shear {
    fn at(&self, x: Vec3) -> Vec3 {
        Vec3::x() * RATE * (x.y - 0.5 * H * self.grid.shape[1] as f64)
    }
}

impl Lattice for Shear {
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
        let starts: Vec<_> = (0..bricks.len())
            .map(|s| bricks.brick(s).map(|b| b * BRICK_EDGE))
            .collect();
        let (velocity, _) = bricks.velocity_mut_and_force();
        for (slot, [x, y, z]) in starts.into_iter().enumerate() {
            for n in 0..BRICK_NODES {
                let (i, j, k) = (
                    n % BRICK_EDGE,
                    n / BRICK_EDGE % BRICK_EDGE,
                    n / (BRICK_EDGE * BRICK_EDGE),
                );
                let u = self.at(self.grid.position(x + i, y + j, z + k));
                for a in 0..3 {
                    velocity[a][slot * BRICK_NODES + n] = u[a];
                }
            }
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
    let shear = Shear {
        grid: Grid::new([16, 16, 16], H, [true; 3]),
        impulse: Vec3::zeros(),
    };
    let mut scene = Scene::with_fluid(shear, DeltaExchange::new(Default::default()));
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
        let exact = start + Vec3::x() * RATE * (start.y - 8.0 * H) * time;
        assert!((x - exact).norm() < 1e-9 * H, "{x} {exact}");
    }
    let shear: &mut Shear = scene.fluid_as().expect("our fluid");
    assert!(
        (shear.impulse - pull * time).norm() < 1e-9 * (pull * time).norm(),
        "{}",
        shear.impulse
    );
}
