use super::super::neo_hookean::Rubber;
use super::super::skalak::Stiffening;
use super::{Elements, StrainEnergy, Triangles, at_rest, corners};
use lbm_ibm_coupling::{Soa3, Vec3};

/// Cells along an edge of the patch.
const N: usize = 5;
const SHEAR: f64 = 5e-6;
const RATIO: f64 = 3.0;

/// A square of unit edge in the plane z = 0, its inner nodes out of place.
fn patch() -> (Soa3, Vec<[u32; 3]>) {
    let number = |i: usize, j: usize| (j * (N + 1) + i) as u32;
    let mut nodes = Soa3::default();
    for j in 0..=N {
        for i in 0..=N {
            let inner = (1..N).contains(&i) && (1..N).contains(&j);
            let jitter = if inner { 0.2 } else { 0.0 };
            let s = (7 * i + 13 * j) as f64;
            let at = Vec3::new(i as f64 + jitter * s.sin(), j as f64 + jitter * (2.0 * s).cos(), 0.0);
            nodes.push(at / N as f64);
        }
    }
    let cells = (0..N).flat_map(|j| (0..N).map(move |i| (i, j)));
    let triangles = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    (nodes, triangles.collect())
}

/// Tensions along x and y (N/m) of the patch stretched by `l`, from the forces on its edges, and the greatest force on an
/// inner node.
fn tensions(l: [f64; 2], law: &impl StrainEnergy) -> ([f64; 2], f64) {
    let (rest, triangles) = patch();
    let triangles = Triangles {
        elements: Elements::new(triangles.into(), |t| at_rest(corners(rest.view(), t))),
    };
    let turn = lbm_ibm_coupling::nalgebra::Rotation3::new(Vec3::new(0.3, -1.1, 0.7));
    let x: Soa3 = rest
        .iter()
        .map(|p| turn * Vec3::new(l[0] * p.x, l[1] * p.y, 0.0))
        .collect();
    let mut f = Soa3::zeros(x.len());
    triangles.add_forces(x.view(), &mut f.view_mut(), law);
    let (mut sums, mut inner) = ([0.0; 2], 0.0_f64);
    for (p, f) in rest.iter().zip(f.iter()) {
        let f = turn.inverse() * f;
        for a in 0..2 {
            if p[a] > 1.0 - 1e-12 {
                sums[a] -= f[a];
            }
        }
        if (0..2).all(|a| p[a] > 1e-12 && p[a] < 1.0 - 1e-12) {
            inner = inner.max(f.norm());
        }
    }
    ([sums[0] / l[1], sums[1] / l[0]], inner)
}

fn agree(l: [f64; 2], law: &impl StrainEnergy, cauchy: impl Fn(f64, f64) -> f64) {
    let (found, inner) = tensions(l, law);
    for (found, exact) in found.into_iter().zip([cauchy(l[0], l[1]), cauchy(l[1], l[0])]) {
        assert!(
            (found - exact).abs() < 1e-13 * SHEAR * 10.0,
            "{l:?}: {found:e} {exact:e}"
        );
    }
    assert!(inner < 1e-13 * SHEAR, "{l:?}: {inner:e}");
}

#[test]
fn a_patch_of_rubber_has_the_analytic_tensions() {
    let cauchy = |l1: f64, l2: f64| SHEAR / (l1 * l2) * (l1 * l1 - (l1 * l2).powi(-2));
    for l in [0.8, 1.0, 1.3, 1.9] {
        agree([l, l], &Rubber(SHEAR), cauchy);
        agree([l, 0.9], &Rubber(SHEAR), cauchy);
        // Pulled along x alone it has T = G (l^1.5 - l^-1.5).
        let uniaxial = [l, l.powf(-0.5)];
        let ([along, across], _) = tensions(uniaxial, &Rubber(SHEAR));
        assert!((along / SHEAR - l.powf(1.5) + l.powf(-1.5)).abs() < 1e-12 && across.abs() < 1e-12 * SHEAR);
    }
}

#[test]
fn a_patch_of_skalaks_membrane_has_the_analytic_tensions() {
    let law = Stiffening(SHEAR, RATIO);
    let cauchy = |l1: f64, l2: f64| SHEAR * l1 / l2 * (l1 * l1 - 1.0 + RATIO * l2 * l2 * (l1 * l1 * l2 * l2 - 1.0));
    for l in [0.8_f64, 1.0, 1.2, 1.4] {
        agree([l, l], &law, cauchy);
        agree([l, 0.9], &law, cauchy);
        let squared = l * l;
        let uniaxial = [l, ((1.0 + RATIO * squared) / (1.0 + RATIO * squared * squared)).sqrt()];
        let ([_, across], _) = tensions(uniaxial, &law);
        assert!(across.abs() < 1e-12 * SHEAR, "{l}: {across:e}");
    }
}

/// Area modulus and shear modulus (N/m) at a small strain.
fn moduli(law: &impl StrainEnergy) -> [f64; 2] {
    let e = 1e-6;
    let ([dilated, _], _) = tensions([1.0 + e, 1.0 + e], law);
    let ([along, across], _) = tensions([1.0 + e, 1.0 - e], law);
    [dilated / (2.0 * e), (along - across) / (4.0 * e)]
}

#[test]
fn small_strains_have_the_moduli_of_the_docs() {
    for ([area, shear], expected) in [
        (moduli(&Rubber(SHEAR)), 3.0),
        (moduli(&Stiffening(SHEAR, RATIO)), 1.0 + 2.0 * RATIO),
    ] {
        assert!((shear / SHEAR - 1.0).abs() < 1e-4, "{shear:e}");
        assert!((area / (expected * SHEAR) - 1.0).abs() < 1e-4, "{area:e}");
    }
}
