//! Beads scattered in the channel, and the chains that they form.

use crate::options::{FLUID_DENSITY, GRAVITY, Options};
use lbm_ibm::coupling::{MS, Soa3, Sphere, UM, US, Vec3};
use lbm_ibm::magnetics::{
    Auto, Bead, Chain, Flow, Overdamped, chain_gaps, chain_histogram, contact_time, find_chains, mason_number,
};
use lbm_ibm::output::BeadSeries;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::Serialize;
use std::error::Error;
use std::path::Path;

/// Surfaces nearer than this, in radii, count as touching.
const TOUCH: f64 = 0.05;

/// The chains at a moment.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// rest or flow.
    pub run: String,
    /// Time, s.
    pub time: f64,
    /// Beads per chain, averaged over beads: the length of the chain that a bead is in.
    pub mean_length: f64,
    /// Beads in the longest chain.
    pub longest: usize,
    /// Chains of two beads and more.
    pub chains: usize,
    /// Beads that are alone.
    pub single: usize,
    /// Mean tilt of chains of three beads and more from the field, rad.
    pub tilt: f64,
    /// Mean gap between a chain and its nearest neighbour, m.
    pub gap: f64,
}

/// What became of the scatter.
#[derive(Clone, Debug, Serialize)]
pub struct Formed {
    /// rest or flow.
    pub run: String,
    /// Distance between neighbours at the start, m: the cube root of the volume that a bead has.
    pub spacing: f64,
    /// Moment of a lone bead in the middle, A m2.
    pub moment: f64,
    /// Time in which two beads at that distance meet, by fixed dipoles and Stokes drag, s.
    pub pair_time: f64,
    /// Drag at the mean speed over the attraction of touching beads.
    pub mason: f64,
    /// When the mean length first was three beads, s; none if it never was.
    pub three: Option<f64>,
    /// How many chains have 1, 2, 3, ... beads at the end.
    pub histogram: Vec<usize>,
    /// Greatest Stokes number of a bead: overdamped motion holds while it is small.
    pub stokes: f64,
    /// Greatest Reynolds number of a bead.
    pub reynolds: f64,
    /// Estimated error of the forces at the end, over the greatest force.
    pub force_error: f64,
    /// Steps taken.
    pub steps: usize,
}

/// Lets the beads go, at rest or in the flow, and looks at them twenty times.
pub fn run(options: &Options, flowing: bool) -> Result<(Vec<Row>, Formed), Box<dyn Error>> {
    let name = if flowing { "flow" } else { "rest" };
    let bead = options.bead()?;
    let height = options.height * UM;
    let x = scatter(options, bead.radius());
    let beads = vec![bead.clone(); x.len()];
    let source = options.source(0.0)?;
    let moment = bead.response(Vec3::z() * (options.field * 1e-3)).moment.norm();
    let volume = bead.volume() * x.len() as f64 / options.fraction;
    let spacing = (volume / x.len() as f64).cbrt();
    let speed = if flowing { options.mean_speed() } else { 0.0 };
    let mut motion = Overdamped::new(beads.clone(), x, source, Auto::new(), options.eta())?
        .with_walls(Options::plates(height))
        .with_gravity(GRAVITY, FLUID_DENSITY)
        .in_flow(Flow::poiseuille(Vec3::zeros(), Vec3::z(), height, Vec3::x() * speed)?)
        .with_steps(1e-3, 20.0 * US);
    let mut series = BeadSeries::new(&options.out.join(name))?;
    let mut rows = Vec::new();
    let looks = 20;
    for look in 0..=looks {
        motion.run_to(options.time * MS * f64::from(look) / f64::from(looks))?;
        let chains = find_chains(&beads, motion.positions(), TOUCH * bead.radius());
        rows.push(row(name, &motion, &chains, &beads));
        film(&mut series, &motion, &beads)?;
    }
    let chains = find_chains(&beads, motion.positions(), TOUCH * bead.radius());
    let greatest = motion.solution().force.iter().map(|f| f.norm()).fold(0.0, f64::max);
    let regime = motion.regime();
    let formed = Formed {
        run: name.to_owned(),
        spacing,
        moment,
        pair_time: contact_time(bead.radius(), moment, options.eta(), spacing),
        mason: mason_number(bead.radius(), moment, options.eta(), options.mean_speed()),
        three: rows.iter().find(|r| r.mean_length >= 3.0).map(|r| r.time),
        histogram: chain_histogram(&chains),
        stokes: regime.stokes,
        reynolds: regime.reynolds,
        force_error: motion.solution().error.force / greatest,
        steps: motion.steps(),
    };
    Ok((rows, formed))
}

fn row(name: &str, motion: &Overdamped, chains: &[Chain], beads: &[Bead]) -> Row {
    let sum = |f: &dyn Fn(&Chain) -> f64| chains.iter().map(f).sum::<f64>();
    let long: Vec<&Chain> = chains.iter().filter(|c| c.beads.len() > 2).collect();
    let gaps = chain_gaps(chains, beads, motion.positions(), 20.0 * beads[0].radius());
    let known: Vec<f64> = gaps.into_iter().filter(|g| g.is_finite()).collect();
    let mean = |sum: f64, n: usize| if n == 0 { f64::NAN } else { sum / n as f64 };
    Row {
        run: name.to_owned(),
        time: motion.time(),
        mean_length: sum(&|c| (c.beads.len() * c.beads.len()) as f64) / beads.len() as f64,
        longest: chains.iter().map(|c| c.beads.len()).max().unwrap_or(0),
        chains: chains.iter().filter(|c| c.beads.len() > 1).count(),
        single: chains.iter().filter(|c| c.beads.len() == 1).count(),
        tilt: mean(long.iter().map(|c| c.tilt(Vec3::z())).sum(), long.len()),
        gap: mean(known.iter().sum(), known.len()),
    }
}

fn film(series: &mut BeadSeries, motion: &Overdamped, beads: &[Bead]) -> Result<(), Box<dyn Error>> {
    let spheres: Vec<Sphere> = motion
        .positions()
        .iter()
        .zip(beads)
        .map(|(x, b)| Sphere::new(x, b.radius()))
        .collect();
    let solution = motion.solution();
    let vectors = [
        ("velocity", motion.velocities()),
        ("moment", solution.moment.view()),
        ("magnetic_force", solution.force.view()),
    ];
    let vectors = if solution.moment.len() == beads.len() {
        &vectors[..]
    } else {
        &vectors[..1]
    };
    Ok(series.write(motion.time(), &spheres, vectors)?)
}

/// Centres at random (m) in a square piece of the channel, none nearer to another or to a plate than touching.
fn scatter(options: &Options, radius: f64) -> Soa3 {
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let height = options.height * UM;
    let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * options.beads as f64 / options.fraction;
    let edge = (volume / height).sqrt();
    let size = Vec3::new(edge, edge, height - 2.1 * radius);
    let mut x: Vec<Vec3> = Vec::new();
    while x.len() < options.beads {
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        let at = Vec3::new(uniform(), uniform(), uniform()).component_mul(&size);
        if x.iter().all(|other| (at - other).norm() > 2.05 * radius) {
            x.push(at);
        }
    }
    x.into_iter().collect()
}

/// Says what became of the scatter.
pub fn print(formed: &Formed, rows: &[Row], out: &Path) {
    let last = &rows[rows.len() - 1];
    println!(
        "{}: neighbours {:.2} um apart, moment {:.2e} A m2: a pair meets in {:.0} us; Mason number {:.4}",
        formed.run,
        formed.spacing / UM,
        formed.moment,
        formed.pair_time / US,
        formed.mason
    );
    let three = formed
        .three
        .map_or("never".to_owned(), |t| format!("at {:.0} us", t / US));
    println!(
        "  chains of three on average {three}; after {:.1} ms {} chains, longest {}, {} single, tilt {:.1} degrees, gap {:.1} um",
        last.time / MS,
        last.chains,
        last.longest,
        last.single,
        last.tilt.to_degrees(),
        last.gap / UM
    );
    println!(
        "  {} steps, Stokes number up to {:.3}, Reynolds {:.4}, force error {:.1e}; VTK series in {}",
        formed.steps,
        formed.stokes,
        formed.reynolds,
        formed.force_error,
        out.join(&formed.run).display()
    );
}
