//! Damped dynamics that brings nodes to rest.

use lbm_ibm_coupling::{Soa3, Soa3Ref};

/// Share of the velocity that is turned along the force, at the start.
const MIXING: f64 = 0.1;

/// The FIRE rule (Bitzek et al., Phys. Rev. Lett. 97, 170201, 2006) with unit masses: it needs forces only, no energy.
///
/// ```
/// use lbm_ibm_coupling::{Soa3, Vec3};
/// use lbm_ibm_membrane::fire::Fire;
///
/// // A node on a spring of 2 N/m about x = 1.
/// let mut x: Soa3 = [Vec3::zeros()].into_iter().collect();
/// let fire = Fire { tolerance: 1e-12, iterations: 1000, time_step: 0.5 };
/// let rest = fire.rest(&mut x, |x, f| f.x[0] = 2.0 * (1.0 - x.x[0]));
/// assert!(rest.settled && (x.x[0] - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fire {
    /// Greatest force left on a node, N.
    pub tolerance: f64,
    /// Most evaluations of the forces.
    pub iterations: usize,
    /// Longest step: below 2 over the root of the greatest stiffness in N/m.
    pub time_step: f64,
}

/// How a search for rest ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Whether the tolerance was reached.
    pub settled: bool,
    /// Greatest force left on a node, N.
    pub residual: f64,
    /// Evaluations of the forces.
    pub iterations: usize,
}

impl Fire {
    /// Moves the nodes `x` (m) until they are at rest under `forces`, which fills the forces (N) at given positions
    /// into an array of zeros.
    pub fn rest(&self, x: &mut Soa3, mut forces: impl FnMut(Soa3Ref<'_>, &mut Soa3)) -> Rest {
        let n = x.len();
        let (mut v, mut f) = (Soa3::zeros(n), Soa3::zeros(n));
        let (mut mixing, mut step, mut downhill) = (MIXING, 0.2 * self.time_step, 0);
        let mut rest = Rest {
            settled: false,
            residual: f64::INFINITY,
            iterations: 0,
        };
        while rest.iterations < self.iterations {
            f.fill(0.0);
            forces(x.view(), &mut f);
            rest.iterations += 1;
            rest.residual = greatest(&f);
            rest.settled = rest.residual < self.tolerance;
            if rest.settled || !rest.residual.is_finite() {
                break;
            }
            if dot(&f, &v) > 0.0 {
                let ratio = mixing * (dot(&v, &v) / dot(&f, &f)).sqrt();
                for i in 0..n {
                    v.set(i, v.get(i) * (1.0 - mixing) + f.get(i) * ratio);
                }
                downhill += 1;
                if downhill > 5 {
                    step = (1.1 * step).min(self.time_step);
                    mixing *= 0.99;
                }
            } else {
                v.fill(0.0);
                (mixing, step, downhill) = (MIXING, 0.5 * step, 0);
            }
            for i in 0..n {
                v.add(i, f.get(i) * step);
                x.add(i, v.get(i) * step);
            }
        }
        rest
    }
}

fn dot(a: &Soa3, b: &Soa3) -> f64 {
    a.iter().zip(b.iter()).map(|(a, b)| a.dot(&b)).sum()
}

/// The greatest force; not a number if any is not.
fn greatest(f: &Soa3) -> f64 {
    f.iter()
        .map(|f| f.norm())
        .fold(0.0, |a, b| if b > a || b.is_nan() { b } else { a })
}
