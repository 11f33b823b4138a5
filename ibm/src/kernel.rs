//! Regularised delta kernels.

use std::f64::consts::{PI, SQRT_2};

/// A regularised delta function: a tensor product of one-dimensional kernels that spreads a marker over the nearest
/// grid nodes.
///
/// Every kernel is even and a partition of unity, so that spreading keeps the total force and a uniform velocity is
/// interpolated exactly. All but [`Kernel::CosineFour`] have a zero first moment too: linear fields are exact, and
/// spreading keeps the torque.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Kernel {
    /// Trilinear, 2 points: `1 - |r|`. The sharpest, but a marker's mobility varies by 72 % with its place in a cell.
    TwoPoint,
    /// 3 points, Roma, Peskin and Berger, J. Comput. Phys. 153 (1999) 509; sum of squares 1/2.
    #[default]
    RomaThree,
    /// Quadratic B-spline, 3 points (triangular-shaped cloud).
    SplineThree,
    /// 4 points, Peskin, Acta Numerica 11 (2002) 479: `(3 - 2|r| + sqrt(1 + 4|r| - 4r^2)) / 8` for `|r| < 1`,
    /// `(5 - 2|r| - sqrt(-7 + 12|r| - 4r^2)) / 8` to 2; sum of squares 3/8. A marker's mobility varies by 1.5 %.
    PeskinFour,
    /// 4 points: `(1 + cos(pi r / 2)) / 4`; sum of squares 3/8, first moment not zero.
    CosineFour,
    /// Cubic B-spline, 4 points.
    SplineFour,
    /// The smoothed 4-point cosine-like kernel of Yang, Zhang, Li and He, J. Comput. Phys. 228 (2009) 7821, 5 points:
    /// Peskin's averaged over a spacing, so that its second derivative is continuous and forces vary less with a marker's
    /// place in a cell. Nodes of even and of odd number share a force evenly.
    SmoothedFour,
    /// 6 points, Bao, Kaye and Peskin, J. Comput. Phys. 316 (2016) 139: three continuous derivatives, second moment
    /// `59/60 - sqrt(29)/20`, third moment zero, sum of squares 0.3258.
    SixPoint,
}

impl Kernel {
    /// All kernels.
    pub const ALL: [Self; 8] = [
        Self::TwoPoint,
        Self::RomaThree,
        Self::SplineThree,
        Self::PeskinFour,
        Self::CosineFour,
        Self::SplineFour,
        Self::SmoothedFour,
        Self::SixPoint,
    ];

    /// Grid nodes along each axis.
    pub fn support(self) -> usize {
        match self {
            Self::TwoPoint => 2,
            Self::RomaThree | Self::SplineThree => 3,
            Self::PeskinFour | Self::CosineFour | Self::SplineFour => 4,
            Self::SmoothedFour => 5,
            Self::SixPoint => 6,
        }
    }

    /// Lowest node of the stencil, and the weights of it and its successors (zero beyond [`Kernel::support`]), for a
    /// marker at `s`, in grid spacings from node 0.
    pub fn stencil(self, s: f64) -> (i64, [f64; 6]) {
        let (lower, f) = lower_corner(s, self.support());
        let mut w = [0.0; 6];
        match self {
            Self::TwoPoint => w[..2].copy_from_slice(&Hat::weights(f)),
            Self::RomaThree => w[..3].copy_from_slice(&Roma::weights(f)),
            Self::SplineThree => w[..3].copy_from_slice(&Quadratic::weights(f)),
            Self::PeskinFour => w[..4].copy_from_slice(&Peskin::weights(f)),
            Self::CosineFour => w[..4].copy_from_slice(&Cosine::weights(f)),
            Self::SplineFour => w[..4].copy_from_slice(&Cubic::weights(f)),
            Self::SmoothedFour => w[..5].copy_from_slice(&Smoothed::weights(f)),
            Self::SixPoint => w = Six::weights(f),
        }
        (lower, w)
    }

    /// Hydrodynamic radius of one marker in grid spacings, mean over its place in a cell: the `a` of the self-mobility
    /// `1 / (6 pi mu a)` under a spectral Stokes operator; [`crate::stokes::kernel_radius`] computes it.
    pub fn marker_radius(self) -> f64 {
        match self {
            Self::TwoPoint => 0.756,
            Self::RomaThree => 0.987,
            Self::SplineThree => 0.901,
            Self::PeskinFour => 1.313,
            Self::CosineFour => 1.311,
            Self::SplineFour => 1.035,
            Self::SmoothedFour => 1.406,
            Self::SixPoint => 1.520,
        }
    }

    /// Sum of the squared weights along an axis, mean over the place in a cell: a flat sheet of force moves a layer of
    /// fluid one over this thick, in grid spacings.
    pub fn sum_of_squares(self) -> f64 {
        match self {
            Self::TwoPoint => 2.0 / 3.0,
            Self::RomaThree => 0.5,
            Self::SplineThree => 0.55,
            Self::PeskinFour | Self::CosineFour => 0.375,
            Self::SplineFour => 0.479_365,
            Self::SmoothedFour => 0.351_099_6,
            Self::SixPoint => SIX_SQUARES,
        }
    }

    /// How much larger than its mesh a closed surface acts in the fluid, in grid spacings, whatever the spacing of its
    /// markers; spheres of 4 to 8 spacings, [`crate::stokes::sphere_radius`].
    pub fn hydrodynamic_shift(self) -> f64 {
        match self {
            Self::TwoPoint => 0.25,
            Self::RomaThree => 0.33,
            Self::SplineThree => 0.30,
            Self::PeskinFour => 0.45,
            Self::CosineFour => 0.45,
            Self::SplineFour => 0.35,
            Self::SmoothedFour => 0.485,
            Self::SixPoint => 0.528,
        }
    }

    /// How deep the markers of a rigid body sit below its surface, and the slip length there, both in grid spacings.
    ///
    /// The slip is 0.4 of the shift of a sheet of markers. With that share a sphere in an unbounded Stokes flow with a Gaussian kernel needs
    /// the same depth for its drag, torque, strain and share in a curved profile, at any radius from 3 spacings on
    /// (`docs/work_precision.md`). The depth is that of spheres of 2 to 5.5 spacings held (Hasimoto's drag) or turned (torque
    /// `1/(1 - phi)` at a solid fraction phi) in a periodic box; `validate rigid_drag` holds both.
    fn rigid_layer(self) -> [f64; 2] {
        match self {
            Self::TwoPoint => [0.148, 0.120],
            Self::RomaThree => [0.210, 0.138],
            Self::SplineThree => [0.1935, 0.127],
            Self::PeskinFour => [0.272, 0.1795],
            Self::CosineFour => [0.268, 0.182],
            Self::SplineFour => [0.2195, 0.1445],
            Self::SmoothedFour => [0.2895, 0.192],
            Self::SixPoint => [0.307, 0.211],
        }
    }

    /// How deep the markers of a rigid body have to sit so that it acts as large as it is, in grid spacings, whatever its size.
    pub fn rigid_inset(self) -> f64 {
        self.rigid_layer()[0]
    }

    /// Slip length of the markers of a rigid body, in grid spacings: the fluid there lags along the surface by so much times the
    /// shear. Without it a body would act larger to a flow that varies over it than to a uniform one,
    /// and turn as a smaller one, where its drag is right.
    pub fn rigid_slip(self) -> f64 {
        self.rigid_layer()[1]
    }

    /// Radius of the smallest rigid sphere that can act as large as it is, within 2 %, in grid spacings: its markers are half their support
    /// from the centre, and 1.5 spacings at least.
    pub fn least_rigid_radius(self) -> f64 {
        0.5 * self.support().max(3) as f64 + self.rigid_inset()
    }
}

/// Lowest of `support` nodes about `s` and the remainder in `[0, 1)` that [`Delta::weights`] takes.
#[inline(always)]
pub(crate) fn lower_corner(s: f64, support: usize) -> (i64, f64) {
    let t = s + (1.0 - 0.5 * support as f64);
    let lower = t.floor();
    (lower as i64, t - lower)
}

/// The weights of a one-dimensional kernel with `S` points. Node `i` is at distance `f + S/2 - 1 - i` from the marker.
pub(crate) trait Delta<const S: usize>: Copy + Sync {
    fn weights(f: f64) -> [f64; S];
}

#[derive(Clone, Copy)]
pub(crate) struct Hat;
#[derive(Clone, Copy)]
pub(crate) struct Roma;
#[derive(Clone, Copy)]
pub(crate) struct Quadratic;
#[derive(Clone, Copy)]
pub(crate) struct Peskin;
#[derive(Clone, Copy)]
pub(crate) struct Cosine;
#[derive(Clone, Copy)]
pub(crate) struct Cubic;
#[derive(Clone, Copy)]
pub(crate) struct Smoothed;
#[derive(Clone, Copy)]
pub(crate) struct Six;

impl Delta<2> for Hat {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 2] {
        [1.0 - f, f]
    }
}

impl Delta<3> for Roma {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 3] {
        let g = f - 0.5;
        let q = (1.0 - 3.0 * g * g).sqrt();
        let side = 2.0 - q;
        [(side - 3.0 * g) / 6.0, (1.0 + q) / 3.0, (side + 3.0 * g) / 6.0]
    }
}

impl Delta<3> for Quadratic {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 3] {
        let g = f - 0.5;
        [0.5 * (0.5 - g) * (0.5 - g), 0.75 - g * g, 0.5 * (0.5 + g) * (0.5 + g)]
    }
}

impl Delta<4> for Peskin {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 4] {
        let q = (1.0 + 4.0 * f * (1.0 - f)).sqrt();
        let (a, b) = (3.0 - 2.0 * f, 1.0 + 2.0 * f);
        [0.125 * (a - q), 0.125 * (a + q), 0.125 * (b + q), 0.125 * (b - q)]
    }
}

impl Delta<4> for Cosine {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 4] {
        let (s, c) = (std::f64::consts::FRAC_PI_2 * f).sin_cos();
        [0.25 * (1.0 - s), 0.25 * (1.0 + c), 0.25 * (1.0 + s), 0.25 * (1.0 - c)]
    }
}

impl Delta<4> for Cubic {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 4] {
        let g = 1.0 - f;
        let middle = |t: f64| (4.0 - 3.0 * t * t * (2.0 - t)) / 6.0;
        [g * g * g / 6.0, middle(f), middle(g), f * f * f / 6.0]
    }
}

impl Delta<5> for Smoothed {
    #[inline(always)]
    fn weights(f: f64) -> [f64; 5] {
        // The three pieces, by the distance r to 1/2, 3/2 and 5/2.
        let inner = |r: f64| 0.375 + PI / 32.0 - 0.25 * r * r;
        let middle = |r: f64| {
            let root = (-2.0 + 8.0 * r - 4.0 * r * r).max(0.0).sqrt();
            0.25 + 0.125 * (1.0 - r) * root - 0.125 * (SQRT_2 * (r - 1.0)).clamp(-1.0, 1.0).asin()
        };
        let outer = |r: f64| {
            let root = (-14.0 + 16.0 * r - 4.0 * r * r).max(0.0).sqrt();
            let arc = (SQRT_2 * (r - 2.0)).clamp(-1.0, 1.0).asin();
            1.0625 - PI / 64.0 - 0.75 * r + 0.125 * r * r + 0.0625 * ((r - 2.0) * root + arc)
        };
        [
            outer(1.5 + f),
            middle(0.5 + f),
            inner(f - 0.5),
            middle(1.5 - f),
            outer(2.5 - f),
        ]
    }
}

/// Second moment of [`Kernel::SixPoint`]: `59/60 - sqrt(29)/20`, which makes its third derivative continuous.
const SIX_MOMENT: f64 = 0.714_075_092_976_608_3;
/// Its sum of squares: that of the weights of a marker on a node.
const SIX_SQUARES: f64 = 0.325_777_615_390_186_4;

impl Delta<6> for Six {
    /// Even and odd nodes share alike, moments 1 to 3 are 0, K and 0: five linear conditions, which leave the outermost
    /// weight `z` free, and the sum of squares, a quadratic equation for it.
    #[inline(always)]
    fn weights(f: f64) -> [f64; 6] {
        const K: f64 = SIX_MOMENT;
        // The weights at z = 0, of the nodes from the far side on, and how they change with it.
        const CHANGE: [f64; 6] = [1.0, -3.0, 2.0, 2.0, -3.0, 1.0];
        let square = (K + f * f) / 8.0;
        let (near, far) = (
            ((4.0 - 3.0 * K) * f - f * f * f) / 6.0,
            ((3.0 * K - 1.0) * f + f * f * f) / 12.0,
        );
        let at_zero = [
            square - far - 0.0625,
            0.25 - near,
            0.625 - 2.0 * square,
            0.25 + near,
            square + far - 0.0625,
            0.0,
        ];
        let (mut b, mut c) = (0.0, -SIX_SQUARES);
        for i in 0..6 {
            b += CHANGE[i] * at_zero[i];
            c += at_zero[i] * at_zero[i];
        }
        // 28 z^2 + 2 b z + c = 0, the root that vanishes with f.
        let z = ((b * b - 28.0 * c).sqrt() - b) / 28.0;
        std::array::from_fn(|i| at_zero[i] + CHANGE[i] * z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn weights_are_a_partition_of_unity_and_even(s in -20.0..20.0_f64) {
            for kernel in Kernel::ALL {
                let n = kernel.support();
                let (lower, w) = kernel.stencil(s);
                prop_assert!((w.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                let moment: f64 = (0..n).map(|i| w[i] * (lower as f64 + i as f64 - s)).sum();
                prop_assert!(kernel == Kernel::CosineFour || moment.abs() < 1e-13, "{kernel:?}: {moment}");
                let squares: f64 = w.iter().map(|w| w * w).sum();
                match kernel {
                    Kernel::RomaThree => prop_assert!((squares - 0.5).abs() < 1e-14),
                    Kernel::PeskinFour | Kernel::CosineFour => prop_assert!((squares - 0.375).abs() < 1e-14),
                    Kernel::SixPoint => {
                        prop_assert!((squares - SIX_SQUARES).abs() < 1e-14);
                        let power = |p: i32| -> f64 {
                            (0..n).map(|i| w[i] * (lower as f64 + i as f64 - s).powi(p)).sum()
                        };
                        prop_assert!((power(2) - 59.0 / 60.0 + 29.0_f64.sqrt() / 20.0).abs() < 1e-13);
                        prop_assert!(power(3).abs() < 1e-12);
                    }
                    _ => {}
                }
                let even: f64 = w.iter().step_by(2).sum();
                let shares = matches!(
                    kernel,
                    Kernel::PeskinFour | Kernel::CosineFour | Kernel::SmoothedFour | Kernel::SixPoint
                );
                prop_assert!(!shares || (even - 0.5).abs() < 1e-13, "{kernel:?}: {even}");
                let (mirror_lower, mirror) = kernel.stencil(-s);
                for i in 0..n {
                    let node = -(lower + i as i64) - mirror_lower;
                    let other = if (0..n as i64).contains(&node) { mirror[node as usize] } else { 0.0 };
                    prop_assert!((w[i] - other).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn weights_follow_the_published_formulas() {
        let peskin = |r: f64| match r.abs() {
            r if r < 1.0 => (3.0 - 2.0 * r + (1.0 + 4.0 * r - 4.0 * r * r).sqrt()) / 8.0,
            r => (5.0 - 2.0 * r - (-7.0 + 12.0 * r - 4.0 * r * r).sqrt()) / 8.0,
        };
        let roma = |r: f64| match r.abs() {
            r if r < 0.5 => (1.0 + (1.0 - 3.0 * r * r).sqrt()) / 3.0,
            r => (5.0 - 3.0 * r - (1.0 - 3.0 * (1.0 - r) * (1.0 - r)).sqrt()) / 6.0,
        };
        for s in [3.1, 3.45, 3.77, 3.98] {
            let check = |kernel: Kernel, phi: &dyn Fn(f64) -> f64| {
                let (lower, w) = kernel.stencil(s);
                for i in 0..kernel.support() {
                    assert!((w[i] - phi(s - (lower as f64 + i as f64))).abs() < 1e-14);
                }
            };
            check(Kernel::PeskinFour, &peskin);
            check(Kernel::RomaThree, &roma);
            // The average of Peskin's over the spacing about each point, by the midpoint rule.
            let (lower, w) = Kernel::SmoothedFour.stencil(s);
            for i in 0..5 {
                let r = s - (lower as f64 + i as f64);
                let inside = |x: f64| if x.abs() < 2.0 { peskin(x) } else { 0.0 };
                let n = 100_000;
                let mean = (0..n)
                    .map(|k| inside(r - 0.5 + (k as f64 + 0.5) / n as f64))
                    .sum::<f64>()
                    / n as f64;
                assert!((w[i] - mean).abs() < 1e-8, "{s} {i}: {} {mean}", w[i]);
            }
            check(Kernel::CosineFour, &|r| {
                0.25 * (1.0 + (0.5 * std::f64::consts::PI * r).cos())
            });
        }
    }

    #[test]
    fn the_mean_sum_of_squares_is_that_of_the_weights() {
        for kernel in Kernel::ALL {
            let n = 4000;
            let square = |i: usize| -> f64 {
                let (_, w) = kernel.stencil(3.0 + (i as f64 + 0.5) / n as f64);
                w[..kernel.support()].iter().map(|w| w * w).sum()
            };
            let mean = (0..n).map(square).sum::<f64>() / n as f64;
            assert!((mean - kernel.sum_of_squares()).abs() < 1e-5, "{kernel:?}: {mean}");
        }
    }
}
