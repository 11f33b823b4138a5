//! The stable step of stiff hinges in a fluid whose relaxation time is long: it is not the viscous one.

use lbm_ibm::coupling::nalgebra::Isometry3;
use lbm_ibm::coupling::{BodyInfo, Bricks, Exchange, Grid, ImmersedBody, Lattice, Scene, SceneError, Soa3, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel};
use lbm_ibm::lbm::{Fluid, Pace};
use lbm_ibm::membrane::{Cell, Mesh, laws};
use std::error::Error;
use std::sync::Arc;

const H: f64 = 1e-6;
const EDGE: usize = 16;
const STEPS: usize = 200;

struct Case {
    mesh: Arc<Mesh>,
    kernel: Kernel,
    tau: f64,
}

impl Case {
    fn fluid(&self) -> Result<Fluid, Box<dyn Error>> {
        let grid = Grid::new([EDGE; 3], H, [true; 3]);
        Ok(Fluid::new(grid, 1e3, 1e-3, Pace::Tau(self.tau))?.with_inertia(false))
    }

    fn cell(&self, stiffness: f64) -> Result<Cell, Box<dyn Error>> {
        Ok(Cell::new("hinges", self.mesh.clone()).with_law(laws::Bending::new(&self.mesh, stiffness)?))
    }

    fn middle() -> Vec3 {
        Vec3::repeat((0.5 * EDGE as f64 + 0.21) * H)
    }

    fn exchange(&self, x: &Soa3, cell: &Cell, fluid: &Fluid) -> Result<DeltaExchange, Box<dyn Error>> {
        let info = BodyInfo {
            id: 0,
            kind: cell.kind().to_owned(),
            range: 0..x.len(),
            triangles: cell.triangles().into(),
            motion: cell.motion(),
        };
        let mut exchange = DeltaExchange::new(self.kernel);
        exchange.set_bodies(&[info], x.view(), fluid.grid())?;
        Ok(exchange)
    }

    /// Longest step (s) that is handed out at a stiffness (J).
    fn limit(&self, stiffness: f64) -> Result<f64, Box<dyn Error>> {
        let (mut cell, fluid) = (self.cell(stiffness)?, self.fluid()?);
        let x: Soa3 = cell.reference().iter().map(|p| p + Self::middle()).collect();
        let exchange = self.exchange(&x, &cell, &fluid)?;
        let limit = exchange.stable_step(&mut cell, x.view(), fluid.viscosity(), fluid.density());
        Ok(limit.ok_or("hinges have a limit")?)
    }

    /// How far (m) a node gets away from rest in some steps after a disturbance of 1e-5 spacings; ends once it is far away.
    fn strays(&self, stiffness: f64) -> Result<f64, Box<dyn Error>> {
        let (mut cell, mut fluid) = (self.cell(stiffness)?, self.fluid()?);
        let rest: Soa3 = cell.reference().iter().map(|p| p + Self::middle()).collect();
        let disturbed = |(i, p): (usize, Vec3)| {
            let s = i as f64;
            p + Vec3::new((7.0 * s).sin(), (5.0 * s).cos(), (3.0 * s).sin()) * (5e-6 * H)
        };
        let mut x: Soa3 = rest.iter().enumerate().map(disturbed).collect();
        let mut exchange = self.exchange(&rest, &cell, &fluid)?;
        let mut bricks = Bricks::new(fluid.grid());
        let mut u = Soa3::zeros(x.len());
        let mut away = 0.0_f64;
        for _ in 0..STEPS {
            let mut force = Soa3::zeros(x.len());
            cell.add_internal_forces(x.view(), u.view(), &mut force.view_mut());
            exchange.place(x.view(), &mut bricks)?;
            bricks.clear_force();
            exchange.spread(force.view(), &mut bricks);
            fluid.advance(&bricks)?;
            fluid.read_velocity(&mut bricks);
            exchange.interpolate(&bricks, u.view_mut());
            for i in 0..x.len() {
                x.add(i, u.get(i) * fluid.time_step());
                away = away.max((x.get(i) - rest.get(i)).norm());
            }
            if away > 1e-3 * H {
                break;
            }
        }
        Ok(away)
    }
}

/// For meshes, kernels and relaxation times over one: hinges for which the time step is the limit handed out are stable, and
/// such for which it would have to be two thirds of that are not. So the limit lies between 0.67 and 1 of the true one.
#[test]
fn hinges_are_stable_to_the_limit_and_hardly_beyond() -> Result<(), Box<dyn Error>> {
    for (nodes, radius, kernel, tau) in [
        (162, 2.5, Kernel::TwoPoint, 5.0),
        (642, 4.0, Kernel::TwoPoint, 5.0),
        (642, 4.0, Kernel::TwoPoint, 1.5),
        (1280, 4.0, Kernel::TwoPoint, 3.0),
        (642, 4.0, Kernel::RomaThree, 5.0),
    ] {
        let mesh = Arc::new(Mesh::sphere(radius * H, nodes)?);
        let case = Case { mesh, kernel, tau };
        let (dt, any) = (case.fluid()?.time_step(), 1e-15);
        // Here the limit goes as one over the root of the stiffness.
        let stiffness = any * (case.limit(any)? / dt).powi(2);
        let ratio = case.limit(stiffness)? / dt;
        assert!(
            (ratio - 1.0).abs() < 0.01,
            "{nodes} nodes, {kernel:?}, tau {tau}: {ratio}"
        );
        let away = case.strays(stiffness)?;
        assert!(
            away < 5e-5 * H,
            "{nodes} nodes, {kernel:?}, tau {tau}: stable to {away:e} m"
        );
        let away = case.strays(stiffness * 1.5_f64.powi(2))?;
        assert!(
            away > 1e-3 * H,
            "{nodes} nodes, {kernel:?}, tau {tau}: still stable beyond, {away:e} m"
        );
    }
    Ok(())
}

#[test]
fn a_scene_refuses_hinges_beyond_the_limit() -> Result<(), Box<dyn Error>> {
    let mesh = Arc::new(Mesh::sphere(4.0 * H, 642)?);
    let case = Case {
        mesh,
        kernel: Kernel::TwoPoint,
        tau: 5.0,
    };
    let fits = 1e-15 * (case.limit(1e-15)? / case.fluid()?.time_step()).powi(2);
    for (stiffness, refused) in [(0.9 * fits, false), (1.1 * fits, true)] {
        let mut scene = Scene::with_fluid(case.fluid()?, DeltaExchange::new(case.kernel));
        scene.add_body(case.cell(stiffness)?, &Isometry3::from(Case::middle()))?;
        match scene.prepare() {
            Ok(()) => assert!(!refused),
            Err(SceneError::TimeStep { term, time_step, limit }) => {
                assert!(refused && term.contains("elasticity of body 0") && limit < time_step);
            }
            Err(other) => return Err(other.into()),
        }
    }
    Ok(())
}
