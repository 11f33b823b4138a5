//! The lattice-Boltzmann fluid of lbm-ibm: in place, vectorised and threaded, in 64, 32 or 16 bits ([`Precision`]).
//!
//! [`Fluid`] implements [`lbm_ibm_coupling::Lattice`] and is built from SI quantities. Collision is TRT with magic number 3/16,
//! another one of [`Collision`], or a [`Model`] of one's own, with the force of Guo, Zheng and Shi (2002), on D3Q19, D3Q27 or
//! D2Q9 ([`VelocitySet`]); walls are taken from any [`lbm_ibm_coupling::Boundary`], at
//! rest or sliding on themselves, where they are or half way between nodes ([`WallRule`], or a [`LinkRule`] of one's own); a
//! force density or a flux ([`Drive`]) drives it, or what enters and leaves by its faces ([`Face`]): a velocity, a flux, a
//! pressure; ends may be convective, or planes of symmetry.
//!
//! A step reads and writes each population once, in place (the "AA pattern", Bailey et al. 2009): in an even step a node
//! finds its populations at home and leaves them there, swapped; in an odd one it finds them in its neighbours, where
//! the even step has left them, and leaves the collided ones where the next even step finds them. Only fluid nodes are
//! touched. Results do not depend on the number of threads, to the last bit.

mod adding;
mod batch;
mod bits;
mod choice;
mod collide;
mod developed;
mod drive;
mod element;
mod error;
mod faces;
mod ferry;
mod fluid;
mod inner;
mod interpolate;
mod intervals;
mod isa;
mod kernel;
mod lattice;
mod links;
mod loads;
mod maker;
mod marks;
mod mask;
mod memory;
mod model;
pub mod models;
mod open;
mod open_links;
mod pack;
mod packed;
mod parallel;
mod reading;
mod real;
mod relaxation;
mod rim;
mod rule;
mod save;
mod scattered;
mod simd;
mod slabs;
mod stable;
mod state;
mod stencil;
mod step;
mod storage;
mod surface;
mod sweep;
mod terms;
mod thermal;
mod trt;

pub use drive::Drive;
pub use element::Precision;
pub use error::LbmError;
pub use faces::{Face, FaceError, Side};
pub use fluid::{Fluid, LEAST_TAU, Pace};
pub use isa::InstructionSet;
pub use model::Model;
pub use real::Real;
pub use relaxation::{Collision, OddRate, VelocitySet};
pub use rule::{CutLink, LinkRule, Shares, WallRule};
pub use stencil::{D2Q9, D3Q19, D3Q27, Stencil};
