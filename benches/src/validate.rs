//! The cases of `validate`: each has the name of a reference file and computes every row of it.

mod channel;
mod coupling;
mod finding;
mod kernels;
mod stretch;

pub use finding::{Finding, Findings};

use crate::reference::Table;
use std::error::Error;

/// How a case is run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    /// Leave out the slow rows, so that all cases end in three minutes.
    pub quick: bool,
}

/// Computes a table and reports a finding per row and quantity.
pub type Case = fn(&Table, Effort) -> Result<Findings, Box<dyn Error>>;

/// All cases by name.
pub const CASES: &[(&str, Case)] = &[
    ("poiseuille_wall_slip", channel::poiseuille_wall_slip),
    ("duct_flow", channel::duct_flow),
    ("square_duct_profile", channel::square_duct_profile),
    ("ibm_kernel_radius", kernels::ibm_kernel_radius),
    ("ibm_sphere_radius", kernels::ibm_sphere_radius),
    ("friction_coupling_slip", coupling::friction_coupling_slip),
    ("paper_rbc_stretch", stretch::paper_rbc_stretch),
    ("paper_ctc_stretch", stretch::paper_ctc_stretch),
    ("rbc_optical_tweezers", stretch::rbc_optical_tweezers),
];
