//! Membrane viscosity: no power in rigid motions, the tensions of known flows, recovery within eta/G.

use lbm_ibm_coupling::nalgebra::Isometry3;
use lbm_ibm_coupling::{ImmersedBody, Motion, Scene, Soa3, Vec3};
use lbm_ibm_membrane::laws::{CorticalTension, Maxwell, Viscosity, WormLikeChain};
use lbm_ibm_membrane::{Cell, Law, Mesh};

const ETA: f64 = 0.5e-6;
const SHEAR: f64 = 5e-6;

fn sphere() -> Mesh {
    Mesh::sphere(4e-6, 642).unwrap()
}

fn forces(law: &mut dyn Law, x: &Soa3, v: &Soa3) -> Soa3 {
    let mut f = Soa3::zeros(x.len());
    law.add_forces(x.view(), v.view(), &mut f.view_mut());
    f
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(&b)).sum()
}

#[test]
fn rigid_motions_cost_nothing_and_any_motion_keeps_force_and_torque() {
    let mesh = sphere();
    let x: Soa3 = mesh
        .nodes()
        .iter()
        .map(|x| Vec3::new(1.4 * x.x + 0.3 * x.y, 0.8 * x.y, x.z))
        .collect();
    let mut law = Viscosity::new(&mesh, ETA)
        .unwrap()
        .with_dilatational(3.0 * ETA)
        .unwrap();
    let turn = Vec3::new(30.0, -20.0, 10.0);
    let rigid: Soa3 = x.iter().map(|x| Vec3::new(1e-4, 0.0, -2e-4) + turn.cross(&x)).collect();
    let wild: Soa3 = x
        .iter()
        .enumerate()
        .map(|(i, x)| turn.cross(&x) + 1e-4 * Vec3::new((7 * i % 13) as f64, (5 * i % 11) as f64, (3 * i % 17) as f64))
        .collect();
    let size = |f: &Soa3| f.iter().map(|f| f.norm()).sum::<f64>();
    let f = forces(&mut law, &x, &wild);
    assert!(size(&forces(&mut law, &x, &rigid)) < 1e-12 * size(&f));
    let torque: Vec3 = x.iter().zip(f.iter()).map(|(x, f)| x.cross(&f)).sum();
    let moment: f64 = x.iter().zip(f.iter()).map(|(x, f)| x.norm() * f.norm()).sum();
    assert!(f.iter().sum::<Vec3>().norm() < 1e-12 * size(&f) && torque.norm() < 1e-12 * moment);
    assert!(dot(&f, &wild) < 0.0, "it takes power");
}

#[test]
fn a_growing_sphere_feels_the_dilatational_viscosity_alone() {
    // Radius R grows at rate a: every area at 2 a/R, so the tension is zeta 2 a/R, the same as a cortical one.
    let mesh = sphere();
    let x: Soa3 = mesh.nodes().iter().collect();
    let rate = 10.0;
    let v: Soa3 = x.iter().map(|x| x * rate).collect();
    let zeta = 2.0 * ETA;
    let f = forces(
        &mut Viscosity::new(&mesh, ETA).unwrap().with_dilatational(zeta).unwrap(),
        &x,
        &v,
    );
    let g = forces(&mut CorticalTension::new(&mesh, 2.0 * zeta * rate).unwrap(), &x, &v);
    let scale = g.iter().map(|g| g.norm()).fold(0.0, f64::max);
    for (f, g) in f.iter().zip(g.iter()) {
        assert!((f - g).norm() < 1e-12 * scale);
    }
    assert!(
        forces(&mut Viscosity::new(&mesh, ETA).unwrap(), &x, &v)
            .iter()
            .all(|f| f.norm() < 1e-12 * scale)
    );
}

/// Velocities at which the viscous forces and a little friction (kg/s) balance `load`, by conjugate gradients.
fn balanced(viscosity: &mut Viscosity, x: &Soa3, load: &Soa3, friction: f64) -> Soa3 {
    let n = x.len();
    let mut resist = |v: &Soa3| -> Soa3 {
        let f = forces(viscosity, x, v);
        (0..n).map(|i| v.get(i) * friction - f.get(i)).collect()
    };
    let mut v = Soa3::zeros(n);
    let mut r = load.clone();
    let mut p = r.clone();
    let (start, mut rr) = (dot(&r, &r), dot(&r, &r));
    for _ in 0..20 * n {
        if rr < 1e-16 * start {
            break;
        }
        let q = resist(&p);
        let step = rr / dot(&p, &q);
        for i in 0..n {
            v.add(i, p.get(i) * step);
            r.add(i, -q.get(i) * step);
        }
        let next = dot(&r, &r);
        p = (0..n).map(|i| r.get(i) + p.get(i) * (next / rr)).collect();
        rr = next;
    }
    v
}

#[test]
fn a_stretched_membrane_recovers_within_eta_over_shear_modulus() {
    // A network of springs with shear modulus G has an area modulus of 2 G: with zeta = 2 eta elastic and viscous
    // tensions are of one kind, and every small strain decays as exp(-t G/eta).
    let mesh = Mesh::sphere(4e-6, 162).unwrap();
    let mut elastic = WormLikeChain::new(&mesh, SHEAR).unwrap();
    let mut viscosity = Viscosity::new(&mesh, ETA)
        .unwrap()
        .with_dilatational(2.0 * ETA)
        .unwrap();
    let zero = Soa3::zeros(mesh.nodes().len());
    let pulled = 1.01;
    let mut x: Soa3 = mesh
        .nodes()
        .iter()
        .map(|x| Vec3::new(x.x * pulled, x.y / f64::sqrt(pulled), x.z / f64::sqrt(pulled)))
        .collect();
    let energy = |x: &Soa3, law: &WormLikeChain| law.energy(x.view()).unwrap();
    let start = energy(&x, &elastic);
    let tau = ETA / SHEAR;
    let (steps, dt) = (20, 0.05 * tau);
    for _ in 0..steps {
        let load = forces(&mut elastic, &x, &zero);
        // The friction settles the bending modes, which springs and viscosity leave soft.
        let v = balanced(&mut viscosity, &x, &load, 1e-3 * ETA);
        // Heun would be finer; the error of Euler's step is known: (1 - dt/tau)^n against exp(-n dt/tau).
        for i in 0..x.len() {
            x.add(i, v.get(i) * dt);
        }
    }
    // The energy is quadratic in the strain.
    let decay = (energy(&x, &elastic) / start).sqrt();
    let found = f64::from(steps) * (1.0 - dt / tau).ln() / decay.ln() * tau;
    println!("time constant {:.2} ms, eta/G = {:.2} ms", found * 1e3, tau * 1e3);
    assert!((found / tau - 1.0).abs() < 0.1, "{found:e} {tau:e}");
}

/// A prolate of the sphere's volume, `pulled` times as long.
fn prolate(mesh: &Mesh, pulled: f64) -> Soa3 {
    let thin = 1.0 / pulled.sqrt();
    mesh.nodes()
        .iter()
        .map(|x| x.component_mul(&Vec3::new(pulled, thin, thin)))
        .collect()
}

#[test]
fn springs_and_dashpots_recover_within_eta_over_shear_modulus() {
    // In a scene without a fluid: a little friction stands for it.
    let spring = 20.0 * SHEAR;
    let mesh = std::sync::Arc::new(Mesh::sphere(4e-6, 100).unwrap());
    let mut cell = Cell::new("sheet", mesh.clone())
        .with_law(WormLikeChain::new(&mesh, SHEAR).unwrap())
        .with_law(Maxwell::new(&mesh, ETA, spring).unwrap())
        .with_motion(Motion::Overdamped { friction: 2e-9 });
    let x = prolate(&mesh, 1.02);
    // Held there until the dashpots have given way.
    cell.advance(x.view(), 1e3 * ETA / spring);
    let tau = ETA / SHEAR;
    let dt = 2e-6;
    let mut scene = Scene::without_fluid(dt).unwrap();
    let body = scene.add_body(cell, &Isometry3::identity()).unwrap();
    scene.set_body_positions(body, x.view()).unwrap();
    let elastic = WormLikeChain::new(&mesh, SHEAR).unwrap();
    let strain = |scene: &Scene| elastic.energy(scene.body_positions(body).unwrap()).unwrap().sqrt();
    let run = |scene: &mut Scene, time: f64| {
        for _ in 0..(time / dt).round() as usize {
            scene.step().unwrap();
        }
    };
    // The springs give at once, and the friction settles; then one exponential is left.
    run(&mut scene, 0.1 * tau);
    let first = strain(&scene);
    run(&mut scene, 0.5 * tau);
    let found = 0.5 * tau / (first / strain(&scene)).ln();
    println!("time constant {:.2} ms, eta/G = {:.2} ms", found * 1e3, tau * 1e3);
    assert!((found / tau - 1.0).abs() < 0.1, "{found:e} {tau:e}");
    // The standard linear solid's own: eta (1/G + 1/G').
    assert!((found / (tau * 1.05) - 1.0).abs() < 0.03, "{found:e}");
}

#[test]
fn a_steady_strain_rate_is_answered_by_the_viscosity() {
    // After tau the springs pull as dashpots do: a sphere that grows at rate a has the tension 2 zeta a, zeta = 2 eta.
    let mesh = Mesh::sphere(4e-6, 642).unwrap();
    let spring = 200e-6;
    let (rate, dt) = (0.1, 1e-4);
    let mut law = Maxwell::new(&mesh, ETA, spring).unwrap();
    let mut x: Soa3 = mesh.nodes().iter().collect();
    for _ in 0..400 {
        x = x.iter().map(|x| x * (1.0 + rate * dt)).collect();
        law.advance(x.view(), dt);
    }
    let zero = Soa3::zeros(x.len());
    let radial = |f: &Soa3| f.iter().zip(x.iter()).map(|(f, x)| f.dot(&x)).sum::<f64>();
    let found = radial(&forces(&mut law, &x, &zero));
    let tension = CorticalTension::new(&mesh, 2.0 * (2.0 * ETA) * rate).unwrap();
    let wanted = radial(&forces(&mut tension.clone(), &x, &zero));
    println!("{:.3}", found / wanted);
    assert!((found / wanted - 1.0).abs() < 2e-3, "{found:e} {wanted:e}");
}
