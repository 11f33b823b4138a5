//! Fields at many points against the same source's field at one.

use lbm_ibm_coupling::nalgebra::{Matrix3, Rotation3};
use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;

fn sources() -> Vec<(&'static str, Box<dyn FieldSource>)> {
    let turn = Rotation3::from_euler_angles(0.3, 0.5, -1.0);
    let sheet = ChargeSheet::new(Vec3::new(0.1, 0.0, -0.2), turn * Vec3::x(), turn * Vec3::y() * 0.4, 0.7).unwrap();
    let plain = ChargeSheet::new(Vec3::zeros(), Vec3::x(), Vec3::y() * 0.4, 0.7).unwrap();
    let block = Cuboid::new(Vec3::zeros(), Vec3::new(0.5, 0.3, 0.8), Vec3::new(0.3, -0.7, 1.1)).unwrap();
    let turned = Cuboid::new(Vec3::new(0.1, 0.2, -0.2), Vec3::new(0.5, 0.3, 0.8), Vec3::z()).unwrap();
    let dipole = PointDipole::new(Vec3::new(0.1, 0.0, 0.0), Vec3::new(1.0, 2.0, -0.5) / MU0);
    let ball = MagnetisedSphere::new(Vec3::zeros(), 0.7, Vec3::new(0.2, 0.1, 1.0)).unwrap();
    let ring = CurrentLoop::new(Vec3::new(0.0, 0.1, 0.0), Vec3::new(0.3, -0.2, 1.0), 0.9, 3.0 / MU0).unwrap();
    let pair = SheetPair::opposite(Vec3::zeros(), [0.4, 0.3], 0.8, 1.2).unwrap();
    let sum = Sum::new().with(pair).with(ring).with(Uniform::new(Vec3::x()));
    vec![
        ("sheet", Box::new(sheet)),
        ("sheet in its own axes", Box::new(plain)),
        ("block", Box::new(block)),
        ("turned block", Box::new(turned.with_rotation(turn))),
        ("dipole", Box::new(dipole)),
        ("ball", Box::new(ball)),
        ("ring", Box::new(ring)),
        ("pair of sheets", Box::new(pair)),
        ("sum", Box::new(sum)),
    ]
}

/// Points near and far, and those where formulas change: planes, edges, corners, axes, centres.
fn points() -> Soa3 {
    let mut seed = 5u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    };
    let mut x: Soa3 = (0..4003)
        .map(|k| Vec3::new(random(), random(), random()) * [0.5, 1.0, 2.0, 5.0, 30.0, 1e5][k % 6])
        .collect();
    let steps = [
        -1.0, -0.8, -0.5, -0.3, -1e-9, 0.0, 0.1, 0.3, 0.4, 0.5, 0.8, 0.9, 1.0, 1e30,
    ];
    for a in steps {
        for b in steps {
            for c in steps {
                x.push(Vec3::new(a, b, c));
            }
        }
    }
    x
}

#[test]
fn many_points_have_the_field_and_gradient_of_one() {
    let x = points();
    let (mut b, mut alone, mut g) = (Soa3::default(), Soa3::default(), Vec::new());
    for (name, source) in sources() {
        source.fields_and_gradients(x.view(), 0.0, &mut b, &mut g);
        source.fields(x.view(), 0.0, &mut alone);
        let (mut worst, mut worst_gradient): (f64, f64) = (0.0, 0.0);
        for (i, x) in x.iter().enumerate() {
            let (field, gradient) = source.field_and_gradient(x, 0.0);
            // Closed forms are differences of terms of the size of the field at the magnet, which falls with 1/r^2 at least.
            let far = 1.0 + x.norm().min(30.0).powi(2);
            let off = (b.get(i) - field).norm() / field.norm().max(0.02 / far);
            let off_gradient = (g[i] - gradient).norm() / gradient.norm().max(0.02 / far);
            assert!(
                off < 2e-12 && off_gradient < 2e-11,
                "{name} at {x:?}: {off:e} {off_gradient:e}"
            );
            assert!(
                (alone.get(i) - b.get(i)).norm() <= 1e-15 * b.get(i).norm(),
                "{name} at {x:?}"
            );
            (worst, worst_gradient) = (worst.max(off), worst_gradient.max(off_gradient));
        }
        println!("{name}: field {worst:.1e}, gradient {worst_gradient:.1e}");
    }
}

#[test]
fn a_point_has_the_same_bits_in_every_company() {
    let x = points();
    let some: Soa3 = x.iter().skip(3).take(2500).collect();
    let (mut b, mut c) = (Soa3::default(), Soa3::default());
    let (mut g, mut h): (Vec<Matrix3<f64>>, Vec<Matrix3<f64>>) = (Vec::new(), Vec::new());
    for (name, source) in sources() {
        source.fields_and_gradients(x.view(), 0.0, &mut b, &mut g);
        source.fields_and_gradients(some.view(), 0.0, &mut c, &mut h);
        for i in 0..some.len() {
            assert!(b.get(i + 3) == c.get(i) && g[i + 3] == h[i], "{name}");
        }
    }
}
