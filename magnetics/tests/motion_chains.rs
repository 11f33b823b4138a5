//! Chains at rest in flow, against part c of `bead_dynamics.csv`.

mod scene;

use lbm_ibm_coupling::{Soa3, Vec3};
use lbm_ibm_magnetics::*;
use scene::RADIUS;
use std::f64::consts::PI;

const VISCOSITY: f64 = 1e-3;
const D: f64 = 2.0 * RADIUS;
const FIELD: f64 = 0.05;

/// 3 mu0 m^2/(2 pi d^4).
fn f0() -> f64 {
    let m = scene::beads(1, RADIUS, 2.0)[0].response(Vec3::z() * FIELD).moment.z;
    1.5 * MU0 * m * m / (PI * D.powi(4))
}

#[derive(Clone, Copy, Debug)]
enum Case {
    PinnedUniform,
    PinnedShear,
    FreeShear,
}

/// Tip x, z, angles of the first, the middle and the last bond, least contact force over F0.
/// Starts `from` there and leaves the place of rest in it.
fn rest(case: Case, n: usize, load: f64, from: &mut Soa3) -> Result<[f64; 6], MagneticsError> {
    let u = load * f0() / (6.0 * PI * VISCOSITY * RADIUS);
    let flow = match case {
        Case::PinnedUniform => Flow::uniform(Vec3::x() * u),
        _ => Flow::shear(Vec3::zeros(), Vec3::x(), Vec3::z(), u / D),
    };
    let source = Uniform::new(Vec3::z() * FIELD);
    let mut system = BeadSystem::new(
        scene::beads(n, RADIUS, 2.0),
        from.clone(),
        source,
        FixedDipoles::new(),
        VISCOSITY,
    )?
    .with_flow(flow);
    if !matches!(case, Case::FreeShear) {
        system = system.with_frozen([0]);
    }
    let mut rest = QuasiStatic::new(system).with_most_steps(20_000);
    rest.relax()?;
    *from = rest.positions().iter().collect();
    let x = rest.positions();
    let bond = |k: usize| {
        let r = x.get(k + 1) - x.get(k);
        r.x.atan2(r.z)
    };
    let tip = (x.get(n - 1) - x.get(0)) / D;
    let closed: Vec<f64> = rest.contacts().iter().map(|c| c.normal_force / f0()).collect();
    let least = if closed.len() == n - 1 {
        closed.into_iter().fold(f64::INFINITY, f64::min)
    } else {
        0.0
    };
    Ok([tip.x, tip.z, bond(0), bond((n - 1) / 2), bond(n - 2), least])
}

fn straight(case: Case, n: usize) -> Soa3 {
    let middle = if matches!(case, Case::FreeShear) {
        0.5 * (n - 1) as f64
    } else {
        0.0
    };
    (0..n).map(|k| Vec3::z() * ((k as f64 - middle) * D)).collect()
}

#[test]
fn chains_in_flow_bend_as_the_reference() {
    let rows: [(Case, usize, f64, [f64; 6]); 20] = [
        (
            Case::PinnedUniform,
            10,
            0.00759,
            [
                2.9528807767e-01,
                8.9937022528e+00,
                6.4340004863e-02,
                3.1858063137e-02,
                6.3418230333e-03,
                1.0709873977e+00,
            ],
        ),
        (
            Case::PinnedUniform,
            10,
            0.019,
            [
                7.3916634594e-01,
                8.9604053096e+00,
                1.6161292892e-01,
                7.9823137239e-02,
                1.5876598291e-02,
                1.0133497764e+00,
            ],
        ),
        (
            Case::PinnedUniform,
            10,
            0.0379,
            [
                1.4742369869e+00,
                8.8405540575e+00,
                3.2642751243e-01,
                1.5974906655e-01,
                3.1677791850e-02,
                8.0943213825e-01,
            ],
        ),
        (
            Case::PinnedUniform,
            10,
            0.0569,
            [
                2.2126648359e+00,
                8.6328615360e+00,
                5.0117950913e-01,
                2.4118456381e-01,
                4.7579043166e-02,
                4.6955983552e-01,
            ],
        ),
        (
            Case::PinnedUniform,
            10,
            0.0683,
            [
                2.6551960989e+00,
                8.4612906325e+00,
                6.1330126394e-01,
                2.9083062827e-01,
                5.7131185382e-02,
                2.0225564402e-01,
            ],
        ),
        (
            Case::PinnedShear,
            10,
            0.00178,
            [
                4.3630356898e-01,
                8.9877700782e+00,
                7.4684489517e-02,
                5.2498872432e-02,
                1.3571505258e-02,
                1.0670472747e+00,
            ],
        ),
        (
            Case::PinnedShear,
            10,
            0.00445,
            [
                1.0812693138e+00,
                8.9245457902e+00,
                1.8582277372e-01,
                1.3043861027e-01,
                3.3703285752e-02,
                9.9063814960e-01,
            ],
        ),
        (
            Case::PinnedShear,
            10,
            0.00889,
            [
                2.0963346894e+00,
                8.7119766946e+00,
                3.6516433557e-01,
                2.5509430554e-01,
                6.5814316922e-02,
                7.4071739931e-01,
            ],
        ),
        (
            Case::PinnedShear,
            10,
            0.0133,
            [
                2.9952685121e+00,
                8.3982032281e+00,
                5.3248533487e-01,
                3.6926125276e-01,
                9.5104930905e-02,
                3.9181467366e-01,
            ],
        ),
        (
            Case::PinnedShear,
            10,
            0.016,
            [
                3.4815012820e+00,
                8.1730404726e+00,
                6.2823124607e-01,
                4.3331224200e-01,
                1.1150630964e-01,
                1.5650542976e-01,
            ],
        ),
        (
            Case::FreeShear,
            10,
            0.00725,
            [
                5.0973080381e-01,
                8.9841055590e+00,
                2.8046189412e-02,
                7.7069307482e-02,
                2.8046189412e-02,
                1.0795931396e+00,
            ],
        ),
        (
            Case::FreeShear,
            10,
            0.0181,
            [
                1.2590061480e+00,
                8.9025156931e+00,
                6.9472110522e-02,
                1.9113355791e-01,
                6.9472110522e-02,
                1.0675823128e+00,
            ],
        ),
        (
            Case::FreeShear,
            10,
            0.0362,
            [
                2.4276992058e+00,
                8.6309752935e+00,
                1.3528979323e-01,
                3.7361894594e-01,
                1.3528979323e-01,
                8.0013412014e-01,
            ],
        ),
        (
            Case::FreeShear,
            10,
            0.0544,
            [
                3.4500182518e+00,
                8.2345874117e+00,
                1.9522659150e-01,
                5.4174536831e-01,
                1.9522659150e-01,
                4.1031696008e-01,
            ],
        ),
        (
            Case::FreeShear,
            10,
            0.0652,
            [
                3.9737063668e+00,
                7.9656908115e+00,
                2.2736172841e-01,
                6.3261677903e-01,
                2.2736172841e-01,
                1.6368050056e-01,
            ],
        ),
        (
            Case::FreeShear,
            3,
            0.0868,
            [
                1.6284572855e-01,
                1.9933592924e+00,
                8.1513101705e-02,
                8.1513101705e-02,
                8.1513101705e-02,
                1.0448899050e+00,
            ],
        ),
        (
            Case::FreeShear,
            3,
            0.217,
            [
                4.0020908735e-01,
                1.9595491028e+00,
                2.0146462140e-01,
                2.0146462140e-01,
                2.0146462140e-01,
                9.5613889331e-01,
            ],
        ),
        (
            Case::FreeShear,
            3,
            0.434,
            [
                7.5628171813e-01,
                1.8514961417e+00,
                3.8778721278e-01,
                3.8778721278e-01,
                3.8778721278e-01,
                6.8268145969e-01,
            ],
        ),
        (
            Case::FreeShear,
            3,
            0.651,
            [
                1.0448794644e+00,
                1.7053524284e+00,
                5.4970971540e-01,
                5.4970971540e-01,
                5.4970971540e-01,
                3.3749442909e-01,
            ],
        ),
        (
            Case::FreeShear,
            3,
            0.781,
            [
                1.1845347763e+00,
                1.6114829703e+00,
                6.3386997932e-01,
                6.3386997932e-01,
                6.3386997932e-01,
                1.3073887433e-01,
            ],
        ),
    ];
    let mut worst: f64 = 0.0;
    for (case, n, load, expected) in rows {
        // A straight chain put into a strong flow at once may part.
        let mut x = straight(case, n);
        let found = [0.4, 0.8, 1.0].map(|s| rest(case, n, s * load, &mut x).unwrap())[2];
        for (f, e) in found.iter().zip(expected) {
            worst = worst.max((f / e - 1.0).abs());
            assert!((f / e - 1.0).abs() < 1e-6, "{case:?} {n} {load}: {f} {e}");
        }
    }
    println!("greatest difference of {} figures: {worst:e}", 6 * rows.len());
}

#[test]
fn chains_part_at_the_reference_loads() {
    for (case, n, critical) in [
        (Case::PinnedUniform, 10, 0.075853201),
        (Case::PinnedShear, 10, 0.017783364),
        (Case::FreeShear, 10, 0.072470441),
        (Case::FreeShear, 3, 0.86752762),
    ] {
        // The least contact force falls to zero as the load grows to the critical one; secant from below.
        let mut x = straight(case, n);
        let mut least = |load: f64| rest(case, n, load, &mut x).unwrap()[5];
        for s in [0.4, 0.7, 0.9] {
            least(s * critical);
        }
        let (mut low, mut high) = (0.97 * critical, 0.99 * critical);
        let (mut at_low, mut at_high) = (least(low), least(high));
        for _ in 0..3 {
            let zero = high + at_high * (high - low) / (at_low - at_high);
            (low, at_low) = (high, at_high);
            high = low + 0.98 * (zero - low);
            at_high = least(high);
        }
        let found = high + at_high * (high - low) / (at_low - at_high);
        println!("{case:?} {n}: critical load {found:e}, {:e}", found / critical - 1.0);
        assert!(
            (found / critical - 1.0).abs() < 1e-4,
            "{case:?} {n}: {found} {critical}"
        );
    }
}
