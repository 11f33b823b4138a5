//! Elastic cells: closed triangle meshes, membrane laws, the paper's red blood cell and tumour cell, and the static
//! stretch that calibrates them.
//!
//! All quantities are SI. A [`Cell`] is a shared [`Mesh`] and a list of [`Law`]s; it is an
//! [`ImmersedBody`](lbm_ibm_coupling::ImmersedBody). A third party adds a law by implementing [`Law`].
//!
//! ```
//! use lbm_ibm_coupling::ImmersedBody;
//! use lbm_ibm_membrane::{Form, presets, stretch};
//!
//! let cell = presets::ctc_paper(Form::Paper2011)?;
//! assert_eq!((cell.reference().len(), cell.triangles().len()), (306, 608));
//!
//! // Pull 5 % of the nodes at each end with 79 pN.
//! let ends = stretch::Patch::Fraction(0.05).ends(cell.reference())?;
//! let shape = stretch::pull(&cell, ends, 79e-12)?;
//! assert!((shape.axial / 16e-6 - 1.297).abs() < 0.01);
//! # Ok::<(), lbm_ibm_membrane::MembraneError>(())
//! ```

pub mod calibrate;
mod cell;
mod constraint;
mod error;
pub mod fire;
pub mod laws;
mod material;
mod mesh;
pub mod nucleus;
pub mod presets;
pub mod stretch;

pub use cell::Cell;
pub use error::MembraneError;
pub use laws::Law;
pub use material::{Material, Modulus, Sheet};
pub use mesh::{Disc, Edge, Mesh, Quality, Spacing};
pub use presets::{Form, Moduli};
