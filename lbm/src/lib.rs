//! The lattice-Boltzmann fluid of lbm-ibm: in place, vectorised and threaded, in 64, 32 or 16 bits ([`Precision`]).
//!
//! [`Fluid`] implements [`lbm_ibm_coupling::Lattice`] and is built from SI quantities. Collision is TRT or BGK
//! ([`Collision`]), or a model of one's own ([`Model`]), with the force of Guo, Zheng and Shi (2002); walls are taken from
//! any [`lbm_ibm_coupling::Boundary`], at rest or sliding on themselves, half way between nodes or where they are
//! ([`WallRule`]); a force density or a flux ([`Drive`]) drives it.
//!
//! A step reads and writes each population once, in place (the "AA pattern", Bailey et al. 2009): in an even step a node
//! finds its populations at home and leaves them there, swapped; in an odd one it finds them in its neighbours, where
//! the even step has left them, and leaves the collided ones where the next even step finds them. Only fluid nodes are
//! touched. Results do not depend on the number of threads, to the last bit.

mod collide;
mod drive;
mod element;
mod error;
mod fluid;
mod interpolate;
mod intervals;
mod isa;
mod kernel;
mod lattice;
mod links;
mod loads;
mod mask;
mod memory;
mod model;
mod parallel;
mod real;
mod relaxation;
mod rule;
mod save;
mod simd;
mod state;
mod stencil;
mod step;
mod storage;
mod surface;
mod sweep;
mod trt;

pub use drive::Drive;
pub use element::Precision;
pub use error::LbmError;
pub use fluid::{Fluid, LEAST_TAU, Pace};
pub use isa::InstructionSet;
pub use model::Model;
pub use real::Real;
pub use relaxation::Collision;
pub use rule::WallRule;
pub use stencil::{D3Q19, Stencil};
