//! Logarithms and angles of eight numbers.

use super::{Isa, Lanes};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_8, LN_2, PI, SQRT_2};

/// ln(a/b) of positive numbers, with all digits where they are close: 2 artanh((a - b)/(a + b)); `difference` is a - b.
#[inline(always)]
pub(crate) fn ln_ratio<I: Isa>(isa: I, a: I::V, b: I::V, difference: I::V) -> I::V {
    let one = isa.splat(1.0);
    let (exponent, mantissa) = (a / b).split();
    let high = isa.splat(SQRT_2).less(mantissa);
    let mantissa = I::V::select(high, isa.splat(0.5) * mantissa, mantissa);
    let exponent = I::V::select(high, exponent + one, exponent);
    let close = exponent.abs().less(isa.splat(0.5));
    let above = I::V::select(close, difference, mantissa - one);
    let below = I::V::select(close, a + b, mantissa + one);
    let x = above / below;
    // |x| is below 0.172: the series to x^23.
    let x2 = x * x;
    let mut series = isa.splat(1.0 / 23.0);
    for k in (0..11).rev() {
        series = series.mul_add(x2, isa.splat(1.0 / (2 * k + 1) as f64));
    }
    exponent.mul_add(isa.splat(LN_2), (x + x) * series)
}

/// The angle of the point (x, y), in (-pi, pi].
#[inline(always)]
pub(crate) fn angle<I: Isa>(isa: I, x: I::V, y: I::V) -> I::V {
    let zero = isa.splat(0.0);
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ax.less(ay);
    let (low, high) = (I::V::select(steep, ax, ay), I::V::select(steep, ay, ax));
    // Turned by 0, pi/8 or pi/4, to a slope below tan(pi/16).
    let (sixteenth, third) = (0.198_912_367_379_658, 0.668_178_637_919_298_9);
    let over = (high * isa.splat(sixteenth)).less(low);
    let far_over = (high * isa.splat(third)).less(low);
    let slope = I::V::select(over, isa.splat(SQRT_2 - 1.0), zero);
    let slope = I::V::select(far_over, isa.splat(1.0), slope);
    let turned = I::V::select(over, isa.splat(FRAC_PI_8), zero);
    let turned = I::V::select(far_over, isa.splat(FRAC_PI_4), turned);
    let below = slope.mul_add(low, high).max(isa.splat(f64::MIN_POSITIVE));
    let t = (low - slope * high) / below;
    let t2 = t * t;
    let mut series = isa.splat(1.0 / 25.0);
    for k in (0..12).rev() {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        series = series.mul_add(t2, isa.splat(sign / (2 * k + 1) as f64));
    }
    let angle = t.mul_add(series, turned);
    let angle = I::V::select(steep, isa.splat(FRAC_PI_2) - angle, angle);
    let angle = I::V::select(x.less(zero), isa.splat(PI) - angle, angle);
    I::V::select(y.less(zero), -angle, angle)
}

#[cfg(test)]
mod tests {
    use super::super::{LANES, Work, run};
    use super::*;

    struct Both([f64; LANES], [f64; LANES]);

    impl Work for Both {
        type Out = [[f64; LANES]; 2];
        #[inline(always)]
        fn run<I: Isa>(self, isa: I) -> Self::Out {
            let (a, b) = (isa.load(&self.0), isa.load(&self.1));
            [
                ln_ratio(isa, a.abs(), b.abs(), a.abs() - b.abs()).array(),
                angle(isa, a, b).array(),
            ]
        }
    }

    #[test]
    fn logarithms_and_angles_have_all_digits_on_every_instruction_set() {
        for k in 1..2000 {
            let t = k as f64;
            let a: [f64; LANES] =
                std::array::from_fn(|l| (t * 0.37 + l as f64).sin() * 10f64.powf(3.0 * (t * 0.11).sin()));
            let b: [f64; LANES] = std::array::from_fn(|l| (t * 0.73 + 2.0 * l as f64).cos() * 3.0);
            for [ln, angle] in [run(Both(a, b)), Both(a, b).run(super::super::Plain)] {
                for l in 0..LANES {
                    let (x, y) = (a[l].abs(), b[l].abs());
                    let expected = if (x / y - 1.0).abs() < 0.4 {
                        ((x - y) / y).ln_1p()
                    } else {
                        (x / y).ln()
                    };
                    assert!((ln[l] - expected).abs() <= 4e-16 * (1.0 + expected.abs()), "ln {x}/{y}");
                    let expected = b[l].atan2(a[l]);
                    assert!(
                        (angle[l] - expected).abs() <= 1e-15,
                        "angle {} {}: {}",
                        a[l],
                        b[l],
                        angle[l]
                    );
                }
            }
        }
    }
}
