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
    // Of the wider kernels no file knows; they are to be smoother than Peskin's.
    for (kernel, spread) in [(Kernel::SmoothedFour, 0.002), (Kernel::SixPoint, 0.0005)] {
        let (a, deviation) = kernel_radius(kernel, 32, 60);
        println!("{kernel:?}: {a:.4}, deviation {deviation:.5}");
        assert!((kernel.marker_radius() / a - 1.0).abs() < 1e-3);
        assert!(deviation < spread);
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

/// Markers of a sphere of 4 spacings, deeper by the shift.
#[test]
fn a_sphere_with_its_markers_inside_is_as_large_as_it_is() {
    for kernel in Kernel::ALL {
        let a = sphere_radius(kernel, 4.0 - kernel.hydrodynamic_shift(), 0.5, 48).expect("a sphere inside the box");
        println!("{kernel:?}: {a:.4}");
        assert!((a / 4.0 - 1.0).abs() < 0.01, "{kernel:?}: {a}");
    }
}
