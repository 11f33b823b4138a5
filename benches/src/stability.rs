//! Linear stability of a uniform flow (von Neumann): how much the waves of a collision grow in a step.
//!
//! A wave `F exp(i k.x)` on a uniform flow becomes `A F exp(i k.x)` in a step, with `A = diag(exp(-i k.c_i)) J` and `J` the
//! derivative of the collision at the flow's equilibrium, taken from the collision itself by differences. The flow is stable as
//! long as no eigenvalue of `A` is greater than 1 in modulus for any `k`.

pub mod cases;
pub mod eigen;

use lbm_ibm::coupling::nalgebra::Complex;
use lbm_ibm::lbm::{Model, Stencil};
use std::f64::consts::PI;

/// Growth per step that counts as none.
pub const TOLERANCE: f64 = 1e-7;
/// Greatest velocity that is tried, lattice units.
pub const FASTEST: f64 = 0.6;
/// How closely the limit is found.
const CLOSE: f64 = 1e-4;

/// A flow's directions, unit vectors: along an axis, a face diagonal and a space diagonal.
pub const FLOWS: [[f64; 3]; 3] = {
    let (two, three) = (std::f64::consts::FRAC_1_SQRT_2, 0.577_350_269_189_625_8);
    [[1.0, 0.0, 0.0], [two, two, 0.0], [three, three, three]]
};

/// A collision about a uniform flow.
pub struct Linear {
    c: Vec<[i32; 3]>,
    /// Row after row.
    derivative: Vec<f64>,
}

impl Linear {
    /// A model about density 1 and velocity `u` (lattice units).
    pub fn new<M: Model<Q>, const Q: usize>(model: &M, u: [f64; 3]) -> Self {
        let collide = |mut f: [f64; Q]| {
            model.collide::<f64, false>(&mut f, [0.0; 3]);
            f
        };
        let equilibrium = uniform::<M, Q>(model, u);
        let mut derivative = vec![0.0; Q * Q];
        // Collisions are polynomials: central differences leave a third of the third derivative times the square of this.
        let step = 1e-5;
        for j in 0..Q {
            let moved = |by: f64| {
                let mut f = equilibrium;
                f[j] += by;
                collide(f)
            };
            let (high, low) = (moved(step), moved(-step));
            for i in 0..Q {
                derivative[i * Q + j] = (high[i] - low[i]) / (2.0 * step);
            }
        }
        Self {
            c: M::Stencil::C.to_vec(),
            derivative,
        }
    }

    /// The same collision, but with the compressible equilibrium of second order, `w rho (1 + 3 c.u + 4.5 (c.u)^2 - 1.5 u^2)` with
    /// `u = j/rho`, which the reference file has. Only for models that relax linearly to an equilibrium of second order: the
    /// matrix that does so is taken from the collision at rest.
    pub fn compressible<M: Model<Q>, const Q: usize>(model: &M, u: [f64; 3]) -> Self {
        let rest = Self::new(model, [0.0; 3]);
        let uu: f64 = u.iter().map(|v| v * v).sum();
        // The derivative of equilibrium less populations.
        let departure = |i: usize, j: usize| {
            let (c, d) = (M::Stencil::C[i].map(f64::from), M::Stencil::C[j].map(f64::from));
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let (cu, cd, ud) = (dot(c, u), dot(c, d), dot(u, d));
            let density = 1.0 - 4.5 * cu * cu + 1.5 * uu;
            let equilibrium = M::Stencil::W[i] * (density + 3.0 * cd + 9.0 * cu * cd - 3.0 * ud);
            equilibrium - if i == j { 1.0 } else { 0.0 }
        };
        let departures: Vec<f64> = (0..Q * Q).map(|m| departure(m / Q, m % Q)).collect();
        let unit = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let relaxed = |i: usize, j: usize| -> f64 {
            let moved = |n: usize| unit(i, n) - rest.derivative[i * Q + n];
            unit(i, j) + (0..Q).map(|n| moved(n) * departures[n * Q + j]).sum::<f64>()
        };
        Self {
            derivative: (0..Q * Q).map(|m| relaxed(m / Q, m % Q)).collect(),
            ..rest
        }
    }

    /// Greatest growth of a wave in a step; none if the eigenvalues cannot be had.
    pub fn growth(&self, k: [f64; 3]) -> Option<f64> {
        let q = self.c.len();
        let mut a = Vec::with_capacity(q * q);
        for (c, row) in self.c.iter().zip(self.derivative.chunks_exact(q)) {
            let angle = -(0..3).map(|d| f64::from(c[d]) * k[d]).sum::<f64>();
            let turn = Complex::from_polar(1.0, angle);
            a.extend(row.iter().map(|v| turn * v));
        }
        eigen::spectral_radius(&mut a, q)
    }
}

/// The populations that a collision leaves alone in a uniform flow, less their weights.
fn uniform<M: Model<Q>, const Q: usize>(model: &M, u: [f64; 3]) -> [f64; Q] {
    let mut f: [f64; Q] = std::array::from_fn(|i| {
        let cu: f64 = (0..3).map(|a| f64::from(M::Stencil::C[i][a]) * u[a]).sum();
        let uu: f64 = u.iter().map(|v| v * v).sum();
        M::Stencil::W[i] * (3.0 * cu + 4.5 * cu * cu - 1.5 * uu)
    });
    for _ in 0..20_000 {
        let before = f;
        model.collide::<f64, false>(&mut f, [0.0; 3]);
        if (0..Q).all(|i| (f[i] - before[i]).abs() < 1e-16) {
            break;
        }
    }
    f
}

/// Magnitudes of the waves of a scan along each direction: 22 even ones, and four of long waves before them, where sound first
/// grows.
const MAGNITUDES: usize = EVEN + LONG.len();
const EVEN: usize = 22;
const LONG: [f64; 4] = [0.1, 0.2, 0.35, 0.6];

/// The wave vectors of a scan, for a flow along one of [`FLOWS`]: 26 magnitudes, one after the other, along every direction with
/// components to 2, of those that are mirror images of each other about the flow one.
pub fn waves(flow: usize) -> Vec<[f64; 3]> {
    let mut directions: Vec<[i32; 3]> = Vec::new();
    for x in -2..=2_i32 {
        for y in -2..=2_i32 {
            for z in -2..=2_i32 {
                let v = [x, y, z];
                let even = v.iter().all(|c| c % 2 == 0);
                if !even {
                    let image = representative(v, flow);
                    if !directions.contains(&image) {
                        directions.push(image);
                    }
                }
            }
        }
    }
    let along = |d: [i32; 3]| {
        let longest = d.iter().map(|c| c.abs()).max().unwrap_or(1);
        let even = (1..=EVEN).map(|m| m as f64);
        LONG.into_iter()
            .chain(even)
            .map(move |m| d.map(|c| PI * m / EVEN as f64 * f64::from(c) / f64::from(longest)))
    };
    directions.into_iter().flat_map(along).collect()
}

/// The greatest of the images of a vector under the symmetries of a flow, and under reversal, which has the complex conjugate
/// for its growth.
fn representative(v: [i32; 3], flow: usize) -> [i32; 3] {
    let [x, y, z] = v;
    let images = |[x, y, z]: [i32; 3]| -> Vec<[i32; 3]> {
        match flow {
            0 => [[y, z], [z, y]].iter().map(|[y, z]| [x, y.abs(), z.abs()]).collect(),
            1 => vec![[x, y, z.abs()], [y, x, z.abs()]],
            _ => vec![[x, y, z], [x, z, y], [y, x, z], [y, z, x], [z, x, y], [z, y, x]],
        }
    };
    let all = images(v).into_iter().chain(images([-x, -y, -z]));
    all.max().unwrap_or(v)
}

/// The fastest growing wave that was found, and its growth.
#[derive(Clone, Copy, Debug)]
pub struct Worst {
    /// Wave vector, lattice units.
    pub k: [f64; 3],
    /// Growth per step.
    pub growth: f64,
}

/// Waves off the directions of [`waves`].
const SCATTERED: usize = 500;

/// Wave vectors that fill space evenly (Roberts 2018): multiples of powers of the root of x^4 = x + 1, less whole turns.
fn scattered(n: usize) -> [f64; 3] {
    const ROOT: f64 = 1.220_744_084_605_759_5;
    [1, 2, 3].map(|power| PI * (2.0 * (n as f64 / ROOT.powi(power)).fract() - 1.0))
}

/// Places from which a search climbs.
const STARTS: usize = 12;
/// Least step of a climb.
const LEAST: f64 = 4e-3;

/// Looks for a growing wave among those of [`waves`]; where none grows, climbs from the greatest of the maxima along their
/// directions. Ends at the first that grows.
pub fn worst(linear: &Linear, set: &[[f64; 3]]) -> Worst {
    let growth = |k: [f64; 3]| wave_of(linear, k);
    let mut found = Vec::with_capacity(set.len());
    for &k in set {
        let one = growth(k);
        if one.growth > 1.0 + TOLERANCE {
            return one;
        }
        found.push(one);
    }
    // Long waves, which hardly decay, are no maxima along their direction but for the first.
    let mut maxima: Vec<Worst> = Vec::new();
    for line in found.chunks(MAGNITUDES) {
        for m in 1..line.len() {
            let next = line.get(m + 1).map_or(0.0, |w| w.growth);
            if line[m].growth >= line[m - 1].growth && line[m].growth >= next {
                maxima.push(line[m]);
            }
        }
    }
    maxima.extend((1..=SCATTERED).map(|n| growth(scattered(n))));
    maxima.sort_by(|a, b| b.growth.total_cmp(&a.growth));
    let mut best = found
        .iter()
        .copied()
        .max_by(|a, b| a.growth.total_cmp(&b.growth))
        .unwrap_or(growth([0.0; 3]));
    for start in maxima.into_iter().take(STARTS) {
        let climbed = climb(start, &growth);
        if climbed.growth > best.growth {
            best = climbed;
        }
        if best.growth > 1.0 + TOLERANCE {
            break;
        }
    }
    best
}

/// Goes to the next maximum, or to a wave that grows, by steps along the axes and diagonals, halved where none helps.
fn climb(mut at: Worst, growth: &impl Fn([f64; 3]) -> Worst) -> Worst {
    let mut step = PI / 44.0;
    while step > LEAST && at.growth <= 1.0 + TOLERANCE {
        let mut better = false;
        for way in WAYS {
            let next = growth(std::array::from_fn(|a| at.k[a] + step * f64::from(way[a])));
            if next.growth > at.growth {
                (at, better) = (next, true);
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    at
}

/// Where a climb may go.
const WAYS: [[i32; 3]; 26] = {
    let mut ways = [[0; 3]; 26];
    let mut n = 0;
    while n < 26 {
        // 13 of 27 is no step.
        let m = if n < 13 { n } else { n + 1 };
        ways[n] = [m as i32 / 9 - 1, m as i32 / 3 % 3 - 1, m as i32 % 3 - 1];
        n += 1;
    }
    ways
};

/// Parts of the limit at which all waves are tried, to see that it is the least.
const TRIED: [f64; 2] = [1.0, 0.6];

/// Where growth begins.
#[derive(Clone, Copy, Debug)]
pub struct Limit {
    /// Greatest velocity, lattice units, at which no wave was found to grow.
    pub speed: f64,
    /// The wave that grows at once above it, where one does below [`FASTEST`].
    pub wave: Option<[f64; 3]>,
}

/// The wave that a search from `k` leads to.
pub fn follow(linear: &Linear, k: [f64; 3]) -> Worst {
    let growth = |k: [f64; 3]| wave_of(linear, k);
    climb(growth(k), &growth)
}

/// The least velocity (lattice units) along a direction of [`FLOWS`] from which on a wave grows, less at most 1e-4, or
/// [`FASTEST`]; `at` makes the collision about a velocity.
///
/// A wave that grows at a velocity is followed down to where it no longer does. There, and at parts of that velocity, all waves are
/// tried; where another one grows, that is followed further.
pub fn limit(at: impl Fn([f64; 3]) -> Linear, flow: usize) -> Limit {
    let set = waves(flow);
    let about = |speed: f64| at(FLOWS[flow].map(|d| d * speed));
    let growing = |speed: f64| Some(worst(&about(speed), &set)).filter(|w| w.growth > 1.0 + TOLERANCE);
    let mut high = FASTEST;
    let Some(mut wave) = growing(high) else {
        return Limit {
            speed: FASTEST,
            wave: None,
        };
    };
    loop {
        let mut low = 0.0;
        while high - low > CLOSE {
            let middle = 0.5 * (low + high);
            let found = follow(&about(middle), wave.k);
            if found.growth > 1.0 + TOLERANCE {
                (high, wave) = (middle, found);
            } else {
                low = middle;
            }
        }
        let lower = TRIED
            .into_iter()
            .find_map(|part| growing(part * low).map(|w| (part * low, w)));
        match lower {
            Some(found) => (high, wave) = found,
            None => {
                return Limit {
                    speed: low,
                    wave: Some(wave.k),
                };
            }
        }
    }
}

fn wave_of(linear: &Linear, k: [f64; 3]) -> Worst {
    Worst {
        k,
        growth: linear.growth(k).unwrap_or(f64::INFINITY),
    }
}

#[cfg(test)]
mod tests {
    use super::cases::Case;
    use super::*;
    use lbm_ibm::coupling::Grid;
    use lbm_ibm::lbm::{Collision, Fluid, Pace, VelocitySet};

    /// The fluid's table is what the scan gives, and a little below no wave of many at random grows.
    #[test]
    fn fluids_know_their_limits() {
        for (name, collision, set, tau) in [
            ("BGK9", Collision::Bgk, VelocitySet::D2Q9, 0.51),
            ("TRT316", Collision::default(), VelocitySet::D3Q19, 0.505),
            ("TRT9", Collision::default(), VelocitySet::D2Q9, 0.52),
        ] {
            // Lattice units: spacing, time step and density 1.
            let grid = Grid::new([4, 4, 1], 1.0, [true; 3]);
            let known = Fluid::new(grid, 1.0, (tau - 0.5) / 3.0, Pace::TimeStep(1.0))
                .and_then(|f| f.with_collision(collision))
                .and_then(|f| f.with_velocity_set(set))
                .expect("a fluid")
                .stable_speed()
                .expect("in the table");
            let case = Case::named(name).expect("a case");
            let limits = [0, 1, 2].map(|flow| case.limit(tau, flow).speed);
            let flow = (0..3).min_by(|a, b| limits[*a].total_cmp(&limits[*b])).unwrap_or(0);
            assert!((known - limits[flow]).abs() < 1e-5, "{name}: {known} {limits:?}");
            let about = |speed: f64| case.about(tau, FLOWS[flow].map(|d| d * speed));
            let below = about(0.98 * known);
            let mut seed = 1_u64;
            let mut angle = || {
                seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                PI * ((seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
            };
            for _ in 0..1000 {
                let k = [angle(), angle(), angle()];
                let growth = below.growth(k).expect("eigenvalues");
                assert!(growth <= 1.0 + TOLERANCE, "{name}: {k:?} grows by {growth}");
            }
        }
    }
}
