//! Cell-resolved microfluidics: a lattice-Boltzmann fluid, immersed elastic cells, walls and contact, in SI units.
//!
//! This package re-exports the crates of the workspace under short names and adds files, charts and progress
//! ([`output`]). The seams where a third party joins are the traits of [`coupling`].

pub use lbm_ibm_contact as contact;
pub use lbm_ibm_coupling as coupling;
pub use lbm_ibm_ibm as ibm;
pub use lbm_ibm_lbm as lbm;
pub use lbm_ibm_magnetics as magnetics;
pub use lbm_ibm_membrane as membrane;

pub mod output;
