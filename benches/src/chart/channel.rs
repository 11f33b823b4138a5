//! Straight channels: collision, relaxation time and resolution.

use super::{Chart, Row, Work, seconds_per_call};
use crate::Fault;
use lbm_ibm::coupling::{Bricks, Grid, Lattice, UM, Vec3};
use lbm_ibm::lbm::{Collision, Drive, Fluid, OddRate, Pace, Precision};
use std::f64::consts::PI;

/// Water in a channel 16 um high, under the force density that drives it at a mean of 1 mm/s between plates.
const DENSITY: f64 = 1e3;
const VISCOSITY: f64 = 1e-3;
const HEIGHT: f64 = 16.0 * UM;
const FORCE: f64 = 12.0 * VISCOSITY * 1e-3 / (HEIGHT * HEIGHT);

const BGK: Collision = Collision::Bgk;
/// TRT of a magic number.
const fn trt(magic: f64) -> Collision {
    Collision::Trt { magic }
}

/// A multiple relaxation time collision with the odd moments of TRT.
const MRT: Collision = Collision::Mrt {
    bulk: 1.19,
    fourth: 1.4,
    odd: OddRate::Magic(3.0 / 16.0),
};
/// Central moments with the odd moments of TRT.
const CENTRAL: Collision = Collision::CentralMoments {
    bulk: 1.0,
    odd: OddRate::Magic(3.0 / 16.0),
};

/// Collisions, relaxation times and precisions, a curve each.
const CURVES: &[(&str, Choice)] = &[
    ("BGK, tau 0.6", choice(BGK, 0.6)),
    ("BGK, tau 0.8", choice(BGK, 0.8)),
    ("BGK, tau 1", choice(BGK, 1.0)),
    ("BGK, tau 2", choice(BGK, 2.0)),
    ("regularised, tau 1", choice(Collision::RecursiveRegularised, 1.0)),
    ("MRT 3/16, tau 4", choice(MRT, 4.0)),
    ("central moments 3/16, tau 4", choice(CENTRAL, 4.0)),
    ("TRT 3/16, tau 1", choice(trt(3.0 / 16.0), 1.0)),
    ("TRT 3/16, tau 4", choice(trt(3.0 / 16.0), 4.0)),
    ("TRT 3/16, tau 8", choice(trt(3.0 / 16.0), 8.0)),
    ("TRT 1/8, tau 4", choice(trt(1.0 / 8.0), 4.0)),
    ("TRT 1/12, tau 2", choice(trt(1.0 / 12.0), 2.0)),
    ("TRT 1/12, tau 4", choice(trt(1.0 / 12.0), 4.0)),
    ("TRT 1/12, tau 8", choice(trt(1.0 / 12.0), 8.0)),
    (
        "TRT 1/12, tau 4, f32",
        choice(trt(1.0 / 12.0), 4.0).stored(Precision::F32),
    ),
    (
        "TRT 1/12, tau 4, 16 bits",
        choice(trt(1.0 / 12.0), 4.0).stored(Precision::F16),
    ),
];

/// What a flow is computed with.
#[derive(Clone, Copy, Debug)]
struct Choice {
    collision: Collision,
    tau: f64,
    precision: Precision,
}

const fn choice(collision: Collision, tau: f64) -> Choice {
    Choice {
        collision,
        tau,
        precision: Precision::F64,
    }
}

impl Choice {
    const fn stored(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }
}

/// Cells across a channel, a point each.
const CELLS: &[usize] = &[6, 8, 12, 16, 24, 32, 48];

/// Relative change of the flow rate, while the slowest disturbance decays by a factor of e, below which a flow is steady.
const STEADY: f64 = 1e-8;
/// What may be left of the start then, above all of modes that outlast the flow's own: no error is given as less.
const LEFT: f64 = 1e-6;

/// The square duct.
pub const DUCT: Chart = Chart {
    name: "duct",
    title: "Flow rate of a square duct",
    cost: "cost of a steady flow from rest, s",
    error: "relative error of the flow rate",
    advice: "TRT with magic 1/12 and tau 2 on 6 to 8 cells, 4 on 12 to 16, 8 from 24 on. Magic 3/16 has eleven times the error \
              in the flow rate at any tau; BGK only near tau 0.8, where the slip of its walls happens to cancel the error of \
              the grid.",
    cases: |quick| steady(Section::Square, quick),
};

/// The channel between plates.
pub const PLANE: Chart = Chart {
    name: "plane",
    title: "Flow rate between two plates",
    cost: "cost of a steady flow from rest, s",
    error: "relative error of the flow rate",
    advice: "TRT with magic 1/8 has the exact flow rate on any grid (3/16 the exact velocity): take a coarse grid and tau 4.",
    cases: |quick| steady(Section::Plates, quick),
};

/// The start of a flow between plates.
pub const START_UP: Chart = Chart {
    name: "timestep",
    title: "Start of a flow between two plates: how long a time step may be",
    cost: "cost of the flow to t = 0.1 H²/ν, s",
    error: "relative error of the velocity at that time, rms",
    advice: "TRT with magic 3/16 and tau 0.8 to 1, and the coarsest grid that is good enough there: above tau 1.25 a coarser \
              grid is better at any cost, below 0.8 more steps gain nothing.",
    cases: start_up,
};

/// Cross-section of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Section {
    Square,
    Plates,
}

impl Section {
    /// A fluid at rest in a channel, `cells` high and `length` nodes long (and wide, between plates).
    fn fluid(self, cells: usize, length: usize, choice: Choice) -> Result<(Fluid, Bricks), Fault> {
        let spacing = HEIGHT / cells as f64;
        let grid = match self {
            Self::Square => Grid::new([cells, cells, length], spacing, [false, false, true]),
            Self::Plates => Grid::new([cells, length, length], spacing, [false, true, true]),
        };
        let bricks = Bricks::new(&grid);
        let mut fluid = Fluid::new(grid, DENSITY, VISCOSITY, Pace::Tau(choice.tau))?
            .with_collision(choice.collision)?
            .with_precision(choice.precision)
            .with_drive(Drive::Force(Vec3::z() * FORCE))?;
        // At rest when the force sets in.
        fluid.set_velocity(|_| Vec3::zeros());
        Ok((fluid, bricks))
    }

    /// Mean velocity of the steady flow, m/s.
    ///
    /// Between plates `G H^2/(12 mu)`; in the duct `(1 - 192/pi^5 sum tanh(n pi/2)/n^5)` over odd n times as much
    /// (White, Viscous fluid flow, 3-48).
    fn mean(self) -> f64 {
        let plates = FORCE * HEIGHT * HEIGHT / (12.0 * VISCOSITY);
        match self {
            Self::Plates => plates,
            Self::Square => {
                let odd = (0..100).rev().map(|i| f64::from(2 * i + 1));
                let sum: f64 = odd.map(|n| (0.5 * n * PI).tanh() / n.powi(5)).sum();
                plates * (1.0 - 192.0 / PI.powi(5) * sum)
            }
        }
    }

    /// Time in which the slowest disturbance decays by a factor of e, s.
    fn decay(self) -> f64 {
        let walls = if self == Self::Square { 2.0 } else { 1.0 };
        HEIGHT * HEIGHT * DENSITY / (VISCOSITY * PI * PI * walls)
    }

    /// Seconds of a step, and its node updates, of each choice in a channel as long (and wide) as it is high.
    fn steps(self, choices: &[(usize, Choice)], quick: bool) -> Result<Vec<(f64, f64)>, Fault> {
        let (mut works, mut nodes) = (Vec::<Work>::new(), Vec::new());
        for &(cells, choice) in choices {
            let (mut fluid, bricks) = self.fluid(cells, cells, choice)?;
            nodes.push(fluid.fluid_nodes() as f64);
            // An even and an odd step.
            works.push(Box::new(move || {
                fluid.advance(&bricks)?;
                Ok(fluid.advance(&bricks)?)
            }));
        }
        let pairs = seconds_per_call(quick, &mut works)?;
        Ok(pairs.iter().map(|s| 0.5 * s).zip(nodes).collect())
    }
}

/// Runs until the mean velocity changes by less than [`STEADY`] within `window` steps, and returns it, m/s.
fn settle(fluid: &mut Fluid, bricks: &Bricks, window: usize) -> Result<f64, Fault> {
    let mut last = 0.0;
    for _ in 0..100 {
        for _ in 0..window {
            fluid.advance(bricks)?;
        }
        let mean = fluid.superficial_velocity().z;
        if (mean - last).abs() <= STEADY * mean.abs() {
            return Ok(mean);
        }
        last = mean;
    }
    Err(format!(
        "tau {}: the flow has not settled in {} steps",
        fluid.tau(),
        fluid.steps()
    )
    .into())
}

/// Error of the flow rate over steps until it is steady. The steps are counted in a channel one node long, in which the
/// flow is the same.
fn steady(section: Section, quick: bool) -> Result<Vec<Row>, Fault> {
    let mut rows = Vec::new();
    for &n in if quick { &CELLS[1..4] } else { CELLS } {
        let choices: Vec<_> = CURVES.iter().map(|&(_, choice)| (n, choice)).collect();
        let costs = section.steps(&choices, quick)?;
        for (&(curve, choice), (seconds, nodes)) in CURVES.iter().zip(costs) {
            let (mut fluid, bricks) = section.fluid(n, 1, choice.stored(Precision::F64))?;
            let window = ((section.decay() / fluid.time_step()).ceil() as usize).max(10);
            let mut mean = settle(&mut fluid, &bricks, window)?;
            if choice.precision != Precision::F64 {
                // Rounding hides when it is steady: as many steps as in 64 bits.
                let (mut rounded, bricks) = section.fluid(n, 1, choice)?;
                (0..fluid.steps()).try_for_each(|_| rounded.advance(&bricks))?;
                mean = rounded.superficial_velocity().z;
            }
            let steps = fluid.steps() as f64;
            rows.push(Row {
                case: String::new(),
                curve: curve.into(),
                label: format!("{n} cells"),
                cost_s: steps * seconds,
                updates: steps * nodes,
                error: (mean / section.mean() - 1.0).abs().max(LEFT),
            });
        }
    }
    Ok(rows)
}

/// Velocity between plates at `y` (m) from one of them and `t` (s) after the force has set in, m/s:
/// `G/(2 mu) y (H - y) - sum 4 G H^2/(mu pi^3 n^3) sin(n pi y/H) exp(-n^2 pi^2 nu t/H^2)` over odd n.
fn starting(y: f64, t: f64) -> f64 {
    let wave = |n: f64| {
        let decay = (-n * n * t / Section::Plates.decay()).exp();
        4.0 * HEIGHT * HEIGHT / (PI * n).powi(3) * (n * PI * y / HEIGHT).sin() * decay
    };
    let waves: f64 = (0..200).rev().map(|i| wave(f64::from(2 * i + 1))).sum();
    FORCE / VISCOSITY * (0.5 * y * (HEIGHT - y) - waves)
}

/// Collisions and cells across the channel, a curve each.
const START_UPS: &[(&str, Collision, usize)] = &[
    ("BGK, 8 cells", BGK, 8),
    ("BGK, 16 cells", BGK, 16),
    ("BGK, 32 cells", BGK, 32),
    ("TRT 3/16, 8 cells", trt(3.0 / 16.0), 8),
    ("TRT 3/16, 16 cells", trt(3.0 / 16.0), 16),
    ("TRT 3/16, 32 cells", trt(3.0 / 16.0), 32),
    ("TRT 1/8, 16 cells", trt(1.0 / 8.0), 16),
];
/// Relaxation times, a point each.
const TAUS: &[f64] = &[0.55, 0.6, 0.7, 0.8, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0];

/// Error at a time, over relaxation times.
fn start_up(quick: bool) -> Result<Vec<Row>, Fault> {
    let end = 0.1 * HEIGHT * HEIGHT * DENSITY / VISCOSITY;
    let choices: Vec<_> = START_UPS
        .iter()
        .map(|&(_, collision, n)| (n, choice(collision, 1.0)))
        .collect();
    let costs = Section::Plates.steps(&choices, quick)?;
    let mut rows = Vec::new();
    for (&(curve, collision, n), (seconds, nodes)) in START_UPS.iter().zip(costs) {
        for &tau in TAUS {
            let (mut fluid, bricks) = Section::Plates.fluid(n, 1, choice(collision, tau))?;
            let steps = (end / fluid.time_step()).round().max(1.0);
            for _ in 0..steps as usize {
                fluid.advance(&bricks)?;
            }
            let t = steps * fluid.time_step();
            let [_, _, along] = fluid.macroscopic().ok_or("the fluid has no velocity field")?.velocity;
            let (mut off, mut all) = (0.0, 0.0);
            for (i, u) in along.iter().enumerate() {
                let exact = starting((i as f64 + 0.5) * HEIGHT / n as f64, t);
                off += (u - exact).powi(2);
                all += exact * exact;
            }
            rows.push(Row {
                case: String::new(),
                curve: curve.into(),
                label: format!("tau {tau}"),
                cost_s: steps * seconds,
                updates: steps * nodes,
                error: (off / all).sqrt(),
            });
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_of_a_square_duct() {
        // Shah and London 1978: Fanning's f times Re is 14.22708; Darcy's is four times it, and 2 D^2/(mean in G D^2/mu).
        let mean = Section::Square.mean() * VISCOSITY / (FORCE * HEIGHT * HEIGHT);
        assert!((2.0 / mean - 4.0 * 14.22708).abs() < 1e-4);
    }

    #[test]
    fn a_flow_starts_like_a_free_fall_and_ends_as_a_parabola() {
        let middle = 0.5 * HEIGHT;
        let early = 1e-3 * Section::Plates.decay();
        assert!((starting(middle, early) / (FORCE / DENSITY * early) - 1.0).abs() < 1e-6);
        let late = 40.0 * Section::Plates.decay();
        assert!((starting(middle, late) / (1.5 * Section::Plates.mean()) - 1.0).abs() < 1e-12);
    }
}
