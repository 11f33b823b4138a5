//! Steady flows along straight channels, and their velocity between nodes.

use lbm_ibm::coupling::{Bricks, Lattice, Vec3};
use lbm_ibm::coupling::{FluidError, Grid};
use lbm_ibm::lbm::{Collision, Drive, Fluid, LbmError, Pace, Precision};
use std::f64::consts::PI;

/// Water on a grid of 1 um.
const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const SPACING: f64 = 1e-6;
/// Greatest velocity, lattice units: far below where terms of second order show.
const SPEED: f64 = 1e-7;

/// Changes over the greatest velocity that are rounding's in 32 bits.
const ROUNDING: f64 = 1e-6;

/// Flow along z under a uniform force density, in a channel that is one node long.
///
/// Velocities are in units of `G h^2/mu`, `h` the spacing: a channel `n` cells high carries `y (n - y)/2`.
pub struct Channel {
    fluid: Fluid,
    bricks: Bricks,
    unit: f64,
    decay: usize,
}

impl Channel {
    /// A channel of `nx` by `ny` cells between walls; one of a single cell in y is without end in y.
    pub fn new(nx: usize, ny: usize, collision: Collision, tau: f64, precision: Precision) -> Result<Self, LbmError> {
        let periodic = [false, ny == 1, true];
        let grid = Grid::new([nx, ny, 1], SPACING, periodic);
        let bricks = Bricks::new(&grid);
        let fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(tau))?
            .with_collision(collision)?
            .with_precision(precision);
        let narrow = if ny == 1 { nx } else { nx.min(ny) } as f64;
        let force = SPEED * SPACING / fluid.time_step() / (narrow * narrow / 8.0) * VISCOSITY / SPACING.powi(2);
        // The slowest mode of a channel that is far wider than high.
        let decay = narrow * narrow / (PI * PI * fluid.lattice_viscosity());
        Ok(Self {
            unit: force * SPACING.powi(2) / VISCOSITY,
            fluid: fluid.with_drive(Drive::Force(Vec3::z() * force))?,
            bricks,
            decay: (decay.ceil() as usize).max(10),
        })
    }

    /// Viscosity in lattice units.
    pub fn lattice_viscosity(&self) -> f64 {
        self.fluid.lattice_viscosity()
    }

    /// Starts from a velocity along z (in units of this channel) at x (in cells).
    pub fn start(mut self, velocity: impl Fn(f64) -> f64) -> Self {
        let unit = self.unit;
        self.fluid
            .set_velocity(|p| Vec3::z() * (unit * velocity(p.x / SPACING)));
        self
    }

    /// Steps in which a disturbance decays by a factor of e.
    pub fn decay(&self) -> usize {
        self.decay
    }

    /// Runs until no velocity changes by more than `tolerance` of the greatest while a disturbance decays by a factor
    /// of e, at most 60 times that long. In 32 bits or less rounding keeps velocities from changing by less than
    /// [`ROUNDING`]: then five such times more.
    pub fn settle(&mut self, tolerance: f64) -> Result<Vec<f64>, FluidError> {
        let (tolerance, mut more) = match self.fluid.precision() {
            Precision::F64 => (tolerance, 0),
            _ => (tolerance.max(ROUNDING), 5),
        };
        let mut last = self.velocity();
        for _ in 0..60 {
            for _ in 0..self.decay {
                self.fluid.advance(&self.bricks)?;
            }
            let now = self.velocity();
            let greatest = now.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
            let change = now.iter().zip(&last).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            last = now;
            if change <= tolerance * greatest {
                if more == 0 {
                    break;
                }
                more -= 1;
            }
        }
        Ok(last)
    }

    /// Velocity along z at all nodes, x fastest.
    fn velocity(&self) -> Vec<f64> {
        let [_, _, along] = self.fluid.macroscopic().unwrap_or_default().velocity;
        along.iter().map(|u| u / self.unit).collect()
    }
}

/// Weights of the `count` nodes about `s` (in cells from the first wall; node i is at i + 1/2) that interpolate a
/// polynomial there; the first of the nodes comes first. Near a wall they extrapolate.
fn lagrange(s: f64, nodes: usize, count: usize) -> (usize, Vec<f64>) {
    let count = count.min(nodes);
    let first = (s - 0.5 * count as f64).round().clamp(0.0, (nodes - count) as f64) as usize;
    let at = |i: usize| (first + i) as f64 + 0.5;
    let factor = |i: usize, j: usize| (s - at(j)) / (at(i) - at(j));
    let weight = |i: usize| (0..count).filter(|&j| j != i).map(|j| factor(i, j)).product();
    (first, (0..count).map(weight).collect())
}

/// Value at (`x`, `y`), in cells from the walls, of a field of `nx` by `ny` nodes, by polynomials through six nodes each way.
pub fn interpolate(field: &[f64], [nx, ny]: [usize; 2], [x, y]: [f64; 2]) -> f64 {
    let (i0, wx) = lagrange(x, nx, 6);
    let (j0, wy) = lagrange(y, ny, 6);
    let row = |j: usize| {
        wx.iter()
            .enumerate()
            .map(|(i, w)| w * field[(j0 + j) * nx + i0 + i])
            .sum::<f64>()
    };
    wy.iter().enumerate().map(|(j, w)| w * row(j)).sum()
}

/// Value at `s` of the polynomial through the six of the `points` (place and value, in order) about it.
pub fn through(points: &[[f64; 2]], s: f64) -> f64 {
    let after = points.partition_point(|[x, _]| *x < s);
    let first = after.saturating_sub(3).min(points.len().saturating_sub(6));
    let six = &points[first..points.len().min(first + 6)];
    let weight = |i: usize| -> f64 {
        let others = six.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, [x, _])| (s - x) / (six[i][0] - x)).product()
    };
    six.iter().enumerate().map(|(i, [_, u])| weight(i) * u).sum()
}

/// Weights of `n` nodes (at i + 1/2) that integrate a cubic over the `n` cells: the midpoint rule, which alone leaves
/// `h^2/24` times the difference of the slopes at the ends, less those slopes from three nodes each.
fn quadrature(n: usize) -> Vec<f64> {
    let mut weights = vec![1.0; n];
    for (i, end) in [2.0, -3.0, 1.0].into_iter().enumerate() {
        weights[i] += end / 24.0;
        weights[n - 1 - i] += end / 24.0;
    }
    weights
}

/// Mean over the cross-section of a field of `nx` by `ny` nodes (three or more).
pub fn mean(field: &[f64], [nx, ny]: [usize; 2]) -> f64 {
    let (wx, wy) = (quadrature(nx), quadrature(ny));
    let row = |j: usize| wx.iter().zip(&field[j * nx..]).map(|(w, u)| w * u).sum::<f64>();
    wy.iter().enumerate().map(|(j, w)| w * row(j)).sum::<f64>() / (nx * ny) as f64
}
