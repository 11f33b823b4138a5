//! Magnetic sources, soft-magnetic beads and the forces between them, at a known error. Usable without a grid.
//!
//! All quantities are SI and `f64`; fields are flux densities B (T), gradients dB_i/dx_j (T/m).
//!
//! - **Sources** ([`FieldSource`]): [`Uniform`], [`ChargeSheet`] and the paper's [`SheetPair`], [`Cuboid`], [`PointDipole`],
//!   [`MagnetisedSphere`], [`CurrentLoop`], their [`Sum`], and a user's own.
//! - **Beads** ([`Bead`]): linear by [`Apparent`] or [`Intrinsic`] susceptibility, [`Saturation`], a [`Table`], or remanent;
//!   commercial ones ([`Preset`]) and soft-magnetic posts ([`Pillar`]).
//! - **Models** ([`Model`]), a ladder: [`FixedDipoles`], [`MutualDipoles`], [`PairCorrected`] (pairs and open chains),
//!   [`Multipoles`] (packed contacts), and [`Auto`], which picks bead by bead: the default choice. Forces are (grad B)^T m with the moments held and the gradient of the
//!   reported energy; every [`Solution`] has an [`ErrorEstimate`]. [`TwoSpheres`] is the exact pair, [`dense_moments`] the
//!   reference for tests.
//! - **Many beads** ([`Tree`]): sums directly up to 20 000 beads, above by a tree whose accuracy is asked for and reported.
//! - **Motion** of a [`BeadSystem`]: [`Overdamped`], [`Brownian`] with thermal noise, [`Newton`] for heavy beads, and
//!   [`QuasiStatic`] for where they come to rest. Drag is on v - u in any [`Flow`], near walls ([`WallDrag`]) and near other
//!   beads ([`PairMobility`]); contact is a [`Constraint`] with Coulomb friction or a [`Repulsion`]. [`BeadForces`] puts
//!   the forces into a scene. [`find_chains`] and [`chain_gaps`] say what has formed.
//!
//! ```
//! use lbm_ibm_coupling::{Soa3, UM, Vec3};
//! use lbm_ibm_magnetics::*;
//!
//! // Two beads between the paper's sheets, and a bias field.
//! let sheets = SheetPair::opposite(Vec3::zeros(), [100.0 * UM, 50.0 * UM], 120.0 * UM, 0.1)?;
//! let source = Sum::new().with(sheets).with(Uniform::new(Vec3::z() * 0.02));
//! let bead = Bead::new(2.25 * UM, 1600.0, Apparent::new(1.2)?)?;
//! let x: Soa3 = [Vec3::zeros(), Vec3::z() * 5.0 * UM].into_iter().collect();
//! let beads = [bead.clone(), bead];
//! let problem = Problem::new(&beads, x.view(), &source, 0.0)?;
//! let mut solution = Solution::new();
//! Auto::new().solve(&problem, &mut solution)?;
//! assert!(solution.force.get(0).z > 0.0 && solution.error.force < 0.3 * solution.force.get(0).z);
//! # Ok::<(), MagneticsError>(())
//! ```

mod bead;
mod chains;
mod dynamics;
mod error;
mod estimates;
mod forces;
mod kernel;
mod model;
mod source;
mod tree;
mod two_sphere;

pub use bead::{
    Apparent, Bead, Intrinsic, Magnetisation, Pillar, Preset, Response, Saturation, SaturationShape, Sourced, Table,
};
pub use chains::{Chain, chain_gaps, chain_histogram, find_chains};
pub use dynamics::{
    BOLTZMANN, BeadContact, BeadSystem, Brownian, Constraint, ContactLaw, Exceeded, Flow, Newton, Overdamped,
    PairMobility, Partner, QuasiStatic, Regime, Repulsion, Rest, SampledFlow, WallDrag, bevan_prieve_drag, faxen_drag,
    near_wall_drag, parallel_drag, perpendicular_drag, squeeze_mobility, wall_mobility,
};
pub use error::MagneticsError;
pub use estimates::{contact_force, contact_time, mason_number};
pub use forces::BeadForces;
pub use model::{
    Auto, ErrorEstimate, FixedDipoles, Model, Multipoles, MutualDipoles, PairCorrected, Problem, Solution,
    dense_moments, dipole_forces, tree_forces,
};
pub use source::{
    ChargeSheet, Cuboid, CurrentLoop, FieldSource, MagnetisedSphere, PointDipole, SheetPair, Sum, Uniform,
};
pub use tree::{Tree, TreeReport};
pub use two_sphere::{PairForce, TwoSpheres};

/// The magnetic constant as this crate uses it, 4e-7 pi N/A^2 (the value before 2019; today's differs by 1e-10).
pub const MU0: f64 = 4e-7 * std::f64::consts::PI;
