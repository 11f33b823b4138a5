//! Size against force, without a fluid.

use crate::measured::{PAPER_CTC, optical_stretcher, tweezers};
use crate::options::{FormName, Options, Subject};
use lbm_ibm::coupling::{ImmersedBody, PN, UM};
use lbm_ibm::membrane::MembraneError;
use lbm_ibm::membrane::stretch::{Patch, Shape, Stretch};
use serde::Serialize;

/// Most iterations of one equilibrium: a cell that finds none takes them all.
const ITERATIONS: usize = 10_000;

/// A cell, how its membrane is computed, where it is pulled, and by which forces (N) one after the other.
#[derive(Clone, Debug)]
pub struct Pull {
    /// The cell.
    pub subject: Subject,
    /// The formulas.
    pub form: FormName,
    /// The nodes at the ends.
    pub patch: Patch,
    /// End forces in ascending order, N.
    pub forces: Vec<f64>,
}

/// What a force makes of a cell, in SI; empty where no equilibrium was found.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// rbc or ctc.
    pub cell: &'static str,
    /// Membrane formulas.
    pub form: &'static str,
    /// Nodes that are pulled.
    pub patch: String,
    /// Force at each end, N.
    pub force: f64,
    /// Size along the pull over the diameter at rest, less one.
    pub strain: Option<f64>,
    /// Size along the pull, m.
    pub axial: Option<f64>,
    /// Size across the pull, m.
    pub transverse: Option<f64>,
    /// Size across the pull in the other direction, m.
    pub thickness: Option<f64>,
    /// Area over the area at rest.
    pub area_ratio: Option<f64>,
    /// Volume over the volume at rest.
    pub volume_ratio: Option<f64>,
    /// Greatest force left on a node, N.
    pub residual: Option<f64>,
    /// Sum of the membrane's own forces, N: taken off all nodes evenly.
    pub net_force: Option<f64>,
    /// Measured size along the pull, m.
    pub measured_axial: Option<f64>,
    /// Lower end of its error bar, m.
    pub measured_axial_low: Option<f64>,
    /// Upper end of its error bar, m.
    pub measured_axial_high: Option<f64>,
    /// Measured size across the pull, m.
    pub measured_transverse: Option<f64>,
    /// Lower end of its error bar, m.
    pub measured_transverse_low: Option<f64>,
    /// Upper end of its error bar, m.
    pub measured_transverse_high: Option<f64>,
    /// Why no equilibrium was found.
    pub message: String,
}

/// All curves that are asked for; the smoke test has a few points of the calibrations alone.
pub fn pulls(options: &Options) -> Vec<Pull> {
    let mut pulls = Vec::new();
    for &subject in options.cell.subjects() {
        let all = match subject {
            Subject::Rbc => tweezers().iter().map(|r| r.force).collect(),
            Subject::Ctc => optical_stretcher(),
        };
        let (forces, patches) = if options.smoke {
            let few = all.into_iter().filter(|f| *f < 80.0 * PN).skip(1).step_by(2);
            (few.collect(), &subject.patches()[..1])
        } else {
            (all, subject.patches())
        };
        for &form in &options.form {
            pulls.extend(patches.iter().map(|&patch| Pull {
                subject,
                form,
                patch,
                forces: forces.clone(),
            }));
        }
    }
    pulls
}

/// Name of a patch in tables.
pub fn patch_name(patch: Patch) -> String {
    match patch {
        Patch::Chord(chord) => format!("{} um chord", chord / UM),
        Patch::Fraction(share) => format!("{} % of nodes", 100.0 * share),
        other => format!("{other:?}"),
    }
}

impl Pull {
    /// The whole curve. A force without an equilibrium does not end it: the next one starts from the last shape at rest.
    ///
    /// # Errors
    /// No cell or no patch; what goes wrong at one force is in its row.
    pub fn curve(&self) -> Result<Vec<Row>, MembraneError> {
        let cell = self.subject.cell(self.form)?;
        let ends = self.patch.ends(cell.reference())?;
        let mut stretch = Stretch::new(cell, ends).with_iterations(ITERATIONS);
        let mut rows = Vec::new();
        for &force in &self.forces {
            let before = stretch.clone();
            let shape = stretch.pull(force);
            if shape.is_err() {
                stretch = before;
            }
            rows.push(self.row(force, shape));
        }
        Ok(rows)
    }

    fn row(&self, force: f64, shape: Result<Shape, MembraneError>) -> Row {
        let (shape, message) = match shape {
            Ok(shape) => (Some(shape), String::new()),
            Err(error) => (None, error.to_string()),
        };
        let of = |quantity: fn(&Shape) -> f64| shape.as_ref().map(quantity);
        let axial = of(|s| s.axial);
        let reading = match self.subject {
            Subject::Rbc => tweezers().into_iter().find(|r| r.force == force),
            Subject::Ctc => None,
        };
        let (measured_axial, axial_bar) = match (self.subject, reading) {
            (Subject::Ctc, _) if force == PAPER_CTC.0 => (Some((1.0 + PAPER_CTC.1) * self.subject.diameter()), None),
            (_, reading) => (reading.map(|r| r.axial.0), reading.and_then(|r| r.axial.1)),
        };
        let transverse_bar = reading.and_then(|r| r.transverse.1);
        Row {
            cell: self.subject.name(),
            form: self.form.name(),
            patch: patch_name(self.patch),
            force,
            strain: axial.map(|a| a / self.subject.diameter() - 1.0),
            axial,
            transverse: of(|s| s.transverse),
            thickness: of(|s| s.thickness),
            area_ratio: of(|s| s.area_ratio),
            volume_ratio: of(|s| s.volume_ratio),
            residual: of(|s| s.residual),
            net_force: of(|s| s.net_force),
            measured_axial,
            measured_axial_low: axial_bar.map(|b| b.0),
            measured_axial_high: axial_bar.map(|b| b.1),
            measured_transverse: reading.map(|r| r.transverse.0),
            measured_transverse_low: transverse_bar.map(|b| b.0),
            measured_transverse_high: transverse_bar.map(|b| b.1),
            message,
        }
    }
}
