//! Hydrodynamic radii of markers and spheres against computed references.

use lbm_ibm_ibm::Kernel;
use lbm_ibm_ibm::stokes::{kernel_radius, sphere_radius};

#[test]
fn marker_radius() {
    let reference = [
        (Kernel::TwoPoint, 0.756056, 0.13115),
        (Kernel::RomaThree, 0.986852, 0.0121844),
        (Kernel::SplineThree, 0.900865, 0.0322066),
        (Kernel::PeskinFour, 1.31256, 0.00350212),
        (Kernel::CosineFour, 1.31108, 0.00322174),
        (Kernel::SplineFour, 1.03527, 0.0117422),
    ];
    for (kernel, radius, spread) in reference {
        let (a, deviation) = kernel_radius(kernel, 32, 60);
        println!("{kernel:?}: {a:.4} ({radius:.4}), deviation {deviation:.4} ({spread:.4})");
        assert!((a / radius - 1.0).abs() < 0.05, "{kernel:?}: {a}");
        assert!((kernel.marker_radius() / radius - 1.0).abs() < 1e-3);
    }
}

#[test]
fn sphere_excess() {
    // Kernel, radius, spacing of the markers, excess of the hydrodynamic radius, all in grid spacings.
    let reference = [
        (Kernel::TwoPoint, 2.0, 1.0, 0.260522),
        (Kernel::TwoPoint, 4.0, 0.5, 0.246641),
        (Kernel::RomaThree, 4.0, 1.0, 0.338327),
        (Kernel::RomaThree, 8.0, 1.0, 0.334622),
        (Kernel::PeskinFour, 2.0, 0.5, 0.517677),
        (Kernel::PeskinFour, 6.0, 1.0, 0.448151),
        (Kernel::SplineThree, 6.0, 1.0, 0.301963),
        (Kernel::CosineFour, 6.0, 1.0, 0.447014),
        (Kernel::SplineFour, 6.0, 1.0, 0.350851),
    ];
    for (kernel, radius, spacing, excess) in reference {
        let a = sphere_radius(kernel, radius, spacing, 48).expect("a sphere inside the box");
        println!("{kernel:?} {radius} {spacing}: {:.4} ({excess:.4})", a - radius);
        assert!((a - radius - excess).abs() < 0.05);
        assert!(radius < 4.0 || (a - radius - kernel.hydrodynamic_shift()).abs() < 0.02);
    }
}
