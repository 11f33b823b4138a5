//! What comes back through open faces.
//!
//! Each link through an open face has a post box of its own, as those into walls have (see [`crate::links`]); the rows send
//! back what goes out, and a pass after them writes what belongs there instead. It reads the outgoing population of the link
//! or of its mirror image, one that a node beside it has sent into the fluid, and what was read before the step. None of
//! these is written by the pass, so the order of links does not matter.

use crate::faces::FaceError;
use crate::fluid::Fluid;
use crate::links::Link;
use crate::parallel;
use crate::stencil::{MAX_Q, Velocities, opposite};
use crate::storage::Storage;
use lbm_ibm_coupling::FluidError;
use std::collections::HashMap;

/// Links that a thread takes at a time, and fewer than which one thread takes all.
const PIECE: usize = 512;
/// Nodes likewise.
const NODES: usize = 32;
/// Part of its excess that the mean density on a convective face loses in a step.
const PULL: f64 = 1e-3;

/// What comes back.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// The outgoing one and `6 w_i c_i.u`.
    Velocity { push: f64 },
    /// Anti-bounce-back: `rest` is `2 w_i` times the density there less one; numbers of samples, and directions in them.
    Pressure { rest: f64, samples: [(usize, usize); 2] },
    /// The places (after an even step, after an odd one) of what reaches the node ahead, cells per step, the weight, and
    /// which of the sampled faces.
    Convective {
        ahead: [usize; 2],
        speed: f64,
        weight: f64,
        face: usize,
    },
    /// The outgoing one of the mirrored link.
    Mirror { from: Link },
}

/// A link through an open face.
#[derive(Clone, Copy, Debug)]
pub struct Open {
    pub link: Link,
    /// Its number among the links that send back.
    pub wall: usize,
    /// Axis and end of the face.
    pub face: (usize, usize),
    /// The population that comes back.
    pub direction: usize,
    pub kind: Kind,
}

/// A node whose populations are read before a step.
#[derive(Clone, Debug)]
struct Sample {
    /// Where its populations stand before an even and an odd step.
    places: [[usize; MAX_Q]; 2],
    /// The convective face that it is counted to.
    face: Option<usize>,
    /// Density less one.
    density: f64,
    /// Of each population what a pressure face adds to anti-bounce-back.
    terms: [f64; MAX_Q],
}

impl Sample {
    /// Reads the node, `half` being half the force on it.
    fn read(&mut self, storage: &Storage, odd: bool, tau: f64, inertia: bool, half: [f64; 3]) {
        let velocities = storage.velocities();
        let places = &self.places[usize::from(odd)];
        let mut f = [0.0; MAX_Q];
        let (mut density, mut u) = (0.0, half);
        for i in 0..velocities.q() {
            f[i] = storage.get(places[i]);
            density += f[i];
            for (u, c) in u.iter_mut().zip(velocities.c(i)) {
                *u += f64::from(c) * f[i];
            }
        }
        self.density = density;
        let uu: f64 = u.iter().map(|u| u * u).sum();
        for i in (1..velocities.q()).step_by(2) {
            let cu = velocities.along(i, u);
            let second = if inertia { 4.5 * cu * cu - 1.5 * uu } else { 0.0 };
            let second = velocities.weight(i) * second;
            let rest = velocities.weight(i) * density;
            let off = 0.5 * (f[i] + f[i + 1]) - rest - second;
            let term = 2.0 * second + (2.0 - 1.0 / tau) * off;
            (self.terms[i], self.terms[i + 1]) = (term, term);
        }
    }
}

/// All links through open faces, and what the pass keeps of a step.
#[derive(Debug, Default)]
pub struct Openings {
    /// In the order of the links that send back.
    pub links: Vec<Open>,
    /// Nodes at pressure and convective faces.
    samples: Vec<Sample>,
    known: HashMap<([usize; 3], Option<usize>), usize>,
    /// Convective faces: axis and end.
    convective: Vec<(usize, usize)>,
    /// For each link what was read before the step; after it, how much more came back than went out.
    values: Vec<f64>,
    /// What is wrong with the faces.
    pub fault: Option<FaceError>,
}

/// The collision as open faces see it.
#[derive(Clone, Copy, Debug)]
struct Settings {
    tau: f64,
    inertia: bool,
    /// Uniform force, lattice units.
    force: [f64; 3],
}

impl Openings {
    /// What is wrong but for the balance of in and out, which the next face may put right.
    pub fn fault_without_balance(&self) -> Option<FaceError> {
        self.fault.filter(|f| !matches!(f, FaceError::Unbalanced { .. }))
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.links) + size_of_val(&*self.samples) + size_of_val(&*self.values)
    }

    /// Adds a link.
    pub fn push(&mut self, open: Open) {
        self.links.push(open);
        self.values.push(0.0);
    }

    /// The number of the sample of a node, for a pressure face, or for the convective face of that number.
    pub fn sample(&mut self, node: [usize; 3], face: Option<usize>, storage: &Storage) -> usize {
        let samples = &mut self.samples;
        let [x, j, k] = node.map(|n| n as isize);
        let mut places = [[0; MAX_Q]; 2];
        *self.known.entry((node, face)).or_insert_with(|| {
            for i in 0..storage.velocities().q() {
                let [cx, cy, cz] = storage.velocities().c(i).map(|c| c as isize);
                let [sj, sk] = storage.wrapped(j - cy, k - cz);
                places[0][i] = storage.index(i, x, j, k);
                places[1][i] = storage.index(opposite(i), x - cx, sj, sk);
            }
            samples.push(Sample {
                places,
                face,
                density: 0.0,
                terms: [0.0; MAX_Q],
            });
            samples.len() - 1
        })
    }

    /// The number of a convective face.
    pub fn convective(&mut self, face: (usize, usize)) -> usize {
        self.convective.iter().position(|f| *f == face).unwrap_or_else(|| {
            self.convective.push(face);
            self.convective.len() - 1
        })
    }

    /// Mean density less one on each convective face.
    fn means(&self) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.convective.len()];
        for sample in &self.samples {
            if let Some(face) = sample.face {
                sums[face].0 += sample.density;
                sums[face].1 += 1.0;
            }
        }
        sums.iter().map(|(sum, count)| sum / count).collect()
    }

    /// Reads what links need of the populations before a step.
    fn read(&mut self, storage: &Storage, odd: bool, settings: Settings) {
        let half = settings.force.map(|f| 0.5 * f);
        let few = self.samples.len() < NODES * 4;
        parallel::for_pieces(few, &mut self.samples, NODES, |_, samples| {
            for sample in samples {
                sample.read(storage, odd, settings.tau, settings.inertia, half);
            }
        });
        let means = self.means();
        for (open, value) in self.links.iter().zip(&mut self.values) {
            *value = match open.kind {
                Kind::Velocity { push } => push,
                Kind::Mirror { .. } => 0.0,
                Kind::Pressure { rest, samples } => {
                    let term = |(n, i): (usize, usize)| self.samples[n].terms[i];
                    rest + 0.5 * (term(samples[0]) + term(samples[1]))
                }
                Kind::Convective { weight, face, .. } => {
                    let place = if odd { open.link.ghost } else { open.link.home };
                    storage.get(place) - PULL * weight * means[face]
                }
            };
        }
    }

    /// Writes what comes back, and notes how much more that is than what went out.
    ///
    /// # Safety
    /// All rows have taken the step, and nothing else touches the populations.
    pub unsafe fn write(&mut self, storage: &Storage, odd: bool) {
        let open = &self.links;
        let few = open.len() < PIECE * 2;
        parallel::for_pieces(few, &mut self.values, PIECE, |first, values| {
            for (open, value) in open[first..].iter().zip(values) {
                let from = |link: Link| if odd { link.ghost } else { link.home };
                let to = if odd { open.link.home } else { open.link.ghost };
                // SAFETY: all are places of the populations, and `to` is written by this link alone.
                unsafe {
                    let own = storage.read(from(open.link));
                    let back = match open.kind {
                        Kind::Velocity { .. } => own + *value,
                        Kind::Pressure { .. } => *value - own,
                        Kind::Convective { ahead, speed, .. } => {
                            (*value + speed * storage.read(ahead[usize::from(odd)])) / (1.0 + speed)
                        }
                        Kind::Mirror { from: link } => storage.read(from(link)),
                    };
                    storage.write(to, back);
                    *value = back - own;
                }
            }
        });
    }

    /// Momentum that the pass has added to what walls at rest would have sent back.
    pub fn momentum(&self, velocities: Velocities) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (open, more) in self.links.iter().zip(&self.values) {
            for (sum, c) in sum.iter_mut().zip(velocities.c(open.direction)) {
                *sum += f64::from(c) * more;
            }
        }
        sum
    }

    /// Mass that the links of a face have added in the last step.
    pub fn mass(&self, face: (usize, usize)) -> f64 {
        let here = self.links.iter().zip(&self.values).filter(|(o, _)| o.face == face);
        here.map(|(_, more)| more).sum()
    }
}

impl Fluid {
    /// Reads what open faces need of the flow before a step.
    pub(crate) fn read_faces(&mut self) -> Result<(), FluidError> {
        if let Some(fault) = self.links.openings.fault {
            return Err(FluidError::Other(Box::new(fault)));
        }
        let settings = Settings {
            tau: self.tau,
            inertia: self.inertia,
            force: self.force.map(|f| f[0]),
        };
        self.links.openings.read(&self.storage, self.odd, settings);
        Ok(())
    }
}
