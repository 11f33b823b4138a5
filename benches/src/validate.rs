//! The cases of `validate`: most have the name of a reference file and compute every row of it, the others check what a
//! scene has to keep.

pub(crate) mod arrays;
pub(crate) mod capsule;
mod cavity;
mod cells;
mod channel;
mod compare;
mod constriction;
mod coupling;
mod driven;
mod duct;
mod finding;
mod kernels;
mod leak;
mod loads;
mod magnetics;
mod open_channel;
mod pores;
mod profile;
mod relaxation;
pub(crate) mod rigid;
mod rigid_crowd;
mod rigid_reference;
mod stability;
mod stiff;
mod stretch;
mod unsteady;

pub use compare::comparison;
pub use finding::{Finding, Findings};

use crate::Fault;
use crate::reference::Table;
use lbm_ibm::lbm::Precision;

/// How a case is run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Effort {
    /// Leave out the slow rows, so that all cases end in three minutes.
    pub quick: bool,
    /// What the fluid's populations are stored as, in the cases of [`STORED`].
    pub precision: Precision,
}

/// What a case finds, or why it cannot be computed.
pub type Outcome = Result<Findings, Fault>;

/// How a case is computed.
#[derive(Clone, Copy, Debug)]
pub enum Case {
    /// From the rows of the reference file of its name.
    Rows(fn(&Table, Effort) -> Outcome),
    /// Without a file: its references are zero, or bounds.
    Alone(fn(Effort) -> Outcome),
}

/// Cases whose fluid is stored as [`Effort::precision`] says; all others are computed in 64 bits.
pub const STORED: &[&str] = &[
    "poiseuille_wall_slip",
    "duct_flow",
    "square_duct_profile",
    "inclined_channel",
    "sphere_array_drag",
    "cylinder_array_drag",
    "slit_pore_resistance",
    "womersley",
    "taylor_green_3d",
    "couette",
    "sphere_loads",
    "open_channel",
    "cavity_2d_ghia",
    "cavity_3d_re1000",
    "sphere_settling_ten_cate",
];

/// All cases by name.
pub const CASES: &[(&str, Case)] = &[
    ("poiseuille_wall_slip", Case::Rows(channel::poiseuille_wall_slip)),
    ("duct_flow", Case::Rows(duct::duct_flow)),
    ("square_duct_profile", Case::Rows(duct::square_duct_profile)),
    ("inclined_channel", Case::Alone(arrays::inclined_channel)),
    ("sphere_array_drag", Case::Rows(arrays::sphere_array_drag)),
    ("cylinder_array_drag", Case::Rows(arrays::cylinder_array_drag)),
    ("slit_pore_resistance", Case::Rows(pores::slit_pore_resistance)),
    ("womersley", Case::Rows(unsteady::womersley)),
    ("taylor_green_3d", Case::Rows(unsteady::taylor_green_3d)),
    ("couette", Case::Alone(loads::couette)),
    ("sphere_loads", Case::Alone(loads::sphere_loads)),
    ("open_channel", Case::Alone(open_channel::open_channel)),
    ("cavity_2d_ghia", Case::Rows(cavity::cavity_2d_ghia)),
    ("cavity_3d_re1000", Case::Rows(cavity::cavity_3d_re1000)),
    ("linear_stability", Case::Rows(stability::linear_stability)),
    ("ibm_kernel_radius", Case::Rows(kernels::ibm_kernel_radius)),
    ("ibm_sphere_radius", Case::Rows(kernels::ibm_sphere_radius)),
    (
        "membrane_time_step_limits",
        Case::Rows(stiff::membrane_time_step_limits),
    ),
    ("stiff_membrane", Case::Alone(stiff::stiff_membrane)),
    ("friction_coupling_slip", Case::Rows(coupling::friction_coupling_slip)),
    ("paper_rbc_stretch", Case::Rows(stretch::paper_rbc_stretch)),
    ("paper_ctc_stretch", Case::Rows(stretch::paper_ctc_stretch)),
    ("rbc_optical_tweezers", Case::Rows(stretch::rbc_optical_tweezers)),
    ("capsule_shear", Case::Rows(capsule::capsule_shear)),
    ("capsule_shear_contrast", Case::Rows(capsule::capsule_shear_contrast)),
    ("capsule_tube", Case::Rows(capsule::capsule_tube)),
    ("capsule_tube_profile", Case::Rows(capsule::capsule_tube_profile)),
    ("drop_shear", Case::Alone(capsule::drop_shear)),
    ("keller_skalak", Case::Alone(capsule::keller_skalak_period)),
    ("capsule_volume", Case::Alone(capsule::capsule_volume)),
    ("constriction", Case::Rows(constriction::constriction)),
    ("rbc_relaxation", Case::Alone(relaxation::rbc_relaxation)),
    ("charge_sheet_field", Case::Rows(magnetics::charge_sheet_field)),
    ("dipole_pair_force", Case::Rows(magnetics::dipole_pair_force)),
    ("two_sphere_force", Case::Rows(magnetics::two_sphere_force)),
    ("unequal_pair_force", Case::Rows(magnetics::unequal_pair_force)),
    ("bead_chain_tension", Case::Rows(magnetics::bead_chain_tension)),
    ("bead_cluster_force", Case::Rows(magnetics::bead_cluster_force)),
    ("bead_dynamics", Case::Rows(magnetics::bead_dynamics)),
    ("sphere_wall_drag", Case::Rows(magnetics::sphere_wall_drag)),
    ("no_leak", Case::Alone(leak::no_leak)),
    ("free_cell", Case::Alone(cells::free_cell)),
    ("rigid_drag", Case::Alone(rigid::rigid_drag)),
    ("rigid_free", Case::Alone(rigid::rigid_free)),
    ("rigid_pair", Case::Alone(rigid::rigid_pair)),
    ("rigid_crowd", Case::Alone(rigid_crowd::rigid_crowd)),
    ("jeffery_orbit", Case::Rows(rigid_reference::jeffery_orbit)),
    ("sphere_near_wall", Case::Rows(rigid_reference::sphere_near_wall)),
    (
        "sphere_settling_ten_cate",
        Case::Rows(rigid_reference::sphere_settling_ten_cate),
    ),
    ("rigid_sphere_tube", Case::Rows(rigid_reference::rigid_sphere_tube)),
    ("same_bits", Case::Alone(cells::same_bits)),
];
