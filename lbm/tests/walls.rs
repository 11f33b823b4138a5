//! What walls feel of the fluid, and gaps too narrow to carry a flow.

use lbm_ibm_coupling::{Boundary, Bricks, Closure, FluidError, Grid, Lattice, Plane, Union, Vec3};
use lbm_ibm_lbm::{Drive, Fluid, Pace};
use std::sync::Arc;

const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;

fn ball(centre: Vec3, radius: f64) -> Closure<impl Fn(Vec3) -> f64 + Send + Sync> {
    Closure::new(move |x| (x - centre).norm() - radius, 1e-9)
}

/// In the steady state the drag on a sphere carries the whole drive, and the torque about its centre is zero; beside its
/// centre it is the lever times the force. The drag coefficient of a dilute cubic array is that of Hasimoto (1959).
#[test]
fn a_sphere_feels_the_force_that_drives_the_flow() {
    let n = 24;
    let grid = Grid::new([n; 3], SPACING, [true; 3]);
    let (centre, radius) = (Vec3::repeat(12.0 * SPACING), 4.0 * SPACING);
    let sphere = Arc::new(ball(centre, radius));
    let drive = Vec3::new(1.0, 0.3, 0.0);
    let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(1.0))
        .unwrap()
        .with_inertia(false)
        .with_drive(Drive::Force(drive))
        .unwrap();
    fluid.set_walls(Some(sphere.clone()), 0.0).unwrap();
    let idle = Bricks::new(fluid.grid());
    let nodes = fluid.fluid_nodes() as f64;
    for steps in [12000, 1] {
        for _ in 0..steps {
            fluid.advance(&idle).unwrap();
        }
        let loads = fluid.wall_loads(sphere.as_ref(), 0.0, centre).unwrap();
        let whole = drive * (nodes * SPACING.powi(3));
        assert!((loads[0].force - whole).norm() < 1e-6 * whole.norm(), "{:?}", loads[0]);
        assert!(loads[0].torque.norm() < 1e-9 * whole.norm() * radius);
        let lever = Vec3::z() * radius;
        let beside = fluid.wall_loads(sphere.as_ref(), 0.0, centre - lever).unwrap();
        assert!((beside[0].torque - lever.cross(&loads[0].force)).norm() < 1e-6 * whole.norm() * radius);
    }
    let phi = 4.0 / 3.0 * std::f64::consts::PI * (4.0f64 / 24.0).powi(3);
    let hasimoto = 1.0 / (1.0 - 1.7601 * phi.cbrt() + phi - 1.5593 * phi * phi);
    // The whole cell's drive, the sphere's share included, is what stands for the pressure gradient.
    let force = drive.norm() * (n as f64 * SPACING).powi(3);
    let stokes = 6.0 * std::f64::consts::PI * VISCOSITY * radius * fluid.superficial_velocity().norm();
    assert!(
        (force / stokes / hasimoto - 1.0).abs() < 0.05,
        "{} {hasimoto}",
        force / stokes
    );
}

/// Sliding plates: the shear force is viscosity times rate times area, opposite on both.
#[test]
fn sliding_plates_feel_the_shear() {
    let (n, speed) = (8, 1e-3);
    let grid = Grid::new([4, n, 6], SPACING, [true, false, true]);
    let height = n as f64 * SPACING;
    let walls = Arc::new(
        Union::new().with(Plane::new(Vec3::zeros(), Vec3::y())).with(
            Plane::new(Vec3::y() * height, -Vec3::y())
                .with_velocity(Vec3::x() * speed)
                .with_part(1),
        ),
    );
    let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(0.9)).unwrap();
    fluid.set_walls(Some(walls.clone()), 0.0).unwrap();
    let idle = Bricks::new(fluid.grid());
    for _ in 0..3001 {
        fluid.advance(&idle).unwrap();
    }
    let loads = fluid.wall_loads(walls.as_ref(), 0.0, Vec3::zeros()).unwrap();
    let shear = VISCOSITY * speed / height * 24.0 * SPACING * SPACING;
    for (part, sign) in [(0, 1.0), (1, -1.0)] {
        let force = loads[part].force;
        assert!(
            (force.x - sign * shear).abs() < 1e-9 * shear,
            "{part}: {force:?} against {shear:e}"
        );
    }
}

/// Touching spheres of 6 cells in a cubic array, the narrow nodes left fluid: the drag is Zick and Homsy's (1982), 42.1 times
/// Stokes' at the superficial velocity, within 2 %. With those nodes filled it is 12 % too high.
#[test]
fn gaps_between_touching_spheres_are_kept() {
    let (n, force) = (12, 1e4);
    let (length, middle) = (n as f64 * SPACING, Vec3::new(6.13, 6.29, 6.41) * SPACING);
    let walls = Closure::new(
        move |x: Vec3| {
            let nearest = (x - middle).map(|s| s - length * (s / length).round());
            nearest.norm() - 0.5 * length
        },
        1e-10,
    );
    let mut fluid = Fluid::new(
        Grid::new([n; 3], SPACING, [true; 3]),
        DENSITY,
        VISCOSITY,
        Pace::Tau(3.0),
    )
    .unwrap()
    .with_inertia(false)
    .with_narrow_gaps_kept()
    .with_drive(Drive::Force(Vec3::x() * force))
    .unwrap();
    let report = fluid.set_walls(Some(Arc::new(walls)), 0.0).unwrap();
    assert!(report.narrowest.is_some_and(|(nodes, _)| nodes == 1) && report.filled_nodes == 0);
    let idle = Bricks::new(fluid.grid());
    for _ in 0..1000 {
        fluid.advance(&idle).unwrap();
    }
    let stokes = force * length.powi(3) / (6.0 * std::f64::consts::PI * VISCOSITY * 0.5 * length);
    let drag = stokes / fluid.superficial_velocity().x;
    assert!((drag / 42.1 - 1.0).abs() < 0.02, "{drag}");
}

#[test]
fn gaps_between_touching_spheres_are_refused_or_filled() {
    let grid = || Grid::new([24, 24, 24], SPACING, [true; 3]);
    let spheres = || -> Arc<dyn Boundary> {
        let at = |z: f64| Vec3::new(12.2, 12.0, z) * SPACING;
        Arc::new(
            Union::new()
                .with(ball(at(7.3), 5.0 * SPACING))
                .with(ball(at(17.3), 5.0 * SPACING)),
        )
    };
    let mut refused = Fluid::new(grid(), DENSITY, VISCOSITY, Pace::Tau(1.0)).unwrap();
    let error = refused.set_walls(Some(spheres()), 0.0);
    assert!(
        matches!(error, Err(FluidError::NarrowGap { axis: 'z', .. })),
        "{error:?}"
    );
    let mut filled = Fluid::new(grid(), DENSITY, VISCOSITY, Pace::Tau(1.0))
        .unwrap()
        .with_narrow_gaps_filled()
        .with_drive(Drive::Force(Vec3::x()))
        .unwrap();
    let report = filled.set_walls(Some(spheres()), 0.0).unwrap();
    assert!(report.filled_nodes > 0 && report.filled_nodes < 60, "{report:?}");
    assert!(report.narrowest.is_none_or(|(nodes, _)| nodes >= 2));
    assert_eq!(report.fluid_nodes + report.solid_nodes, 24 * 24 * 24);
    let idle = Bricks::new(filled.grid());
    for _ in 0..50 {
        filled.advance(&idle).unwrap();
    }
    filled.check().unwrap();
}
