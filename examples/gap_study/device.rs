//! One run's device: a channel with a slit across it, fluid in it, and a cell before the slit.

use super::options::{Drive, Options, Subject, Where};
use lbm_ibm::contact::{ContactError, CutOff, SlitChannel, SoftSphere, WallRepulsion};
use lbm_ibm::coupling::nalgebra::{Isometry3, UnitQuaternion};
use lbm_ibm::coupling::{Boundary, Grid, Guard, Motion, NN, Scene, UM, US, Units, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Markers};
use lbm_ibm::lbm::{Collision, Drive as FluidDrive, Fluid, Pace};
use lbm_ibm::membrane::{Cell, Form, MembraneError, presets};
use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Blood plasma: density, kg/m3, and dynamic viscosity, Pa s.
const PLASMA: (f64, f64) = (1025.0, 1.2e-3);
/// The fluid of the samples of the paper's software: density, kg/m3, and dynamic viscosity, Pa s.
const SAMPLE_FLUID: (f64, f64) = (1000.0, 1.5e-3);
/// Time step (s), friction of a node (kg/s) and mass of a node (kg) in those samples.
const SAMPLE: (f64, f64, f64) = (0.1 * US, 0.5 * NN * US / UM, 1.0e-15);

/// A cell, a gap, and the options of the study. Lengths in m.
#[derive(Clone, Debug)]
pub struct Device {
    /// The cell.
    pub subject: Subject,
    /// Height of the slit.
    pub gap: f64,
    /// Grid spacing.
    pub spacing: f64,
    /// Where the slit begins along x.
    pub entry: f64,
    /// Where it ends.
    pub exit: f64,
    /// Height of the channel.
    pub height: f64,
    /// Width of the channel.
    pub width: f64,
    /// Period along x.
    pub length: f64,
    /// Mean velocity in the channel, m/s.
    pub velocity: f64,
    tau: f64,
    options: Options,
}

impl Subject {
    /// Diameter at rest, m.
    pub fn diameter(self) -> f64 {
        match self {
            Self::RbcEdge | Self::RbcFace => 8.0 * UM,
            Self::Ctc => presets::CTC_DIAMETER,
            Self::Neutrophil => 8.4 * UM,
            Self::Lymphocyte => 7.0 * UM,
        }
    }

    /// Name of the cell in tables.
    pub fn cell(self) -> &'static str {
        match self {
            Self::RbcEdge | Self::RbcFace => "rbc",
            Self::Ctc => "ctc",
            Self::Neutrophil => "neutrophil",
            Self::Lymphocyte => "lymphocyte",
        }
    }

    /// Name of the orientation in tables.
    pub fn orientation(self) -> &'static str {
        match self {
            Self::RbcEdge => "edge",
            Self::RbcFace => "face",
            Self::Ctc | Self::Neutrophil | Self::Lymphocyte => "sphere",
        }
    }
}

impl Device {
    /// The device of a cell and a gap (m).
    pub fn new(subject: Subject, gap: f64, options: &Options) -> Self {
        let default = if subject == Subject::Ctc || options.paper_mode {
            1.0
        } else {
            0.5
        };
        let spacing = options.resolution.unwrap_or(default) * UM;
        // The faces of the grid lie half way between nodes, so the box is whole in spacings, and in those of a grid twice as coarse.
        let whole = |length: f64| (length / (2.0 * spacing)).round() * 2.0 * spacing;
        let diameter = subject.diameter();
        let entry = (options.start + 1.0) * diameter;
        let exit = entry + options.thickness * UM;
        let height = whole(options.height * diameter);
        let velocity = match options.velocity {
            Where::Channel => options.speed * UM,
            Where::Gap => options.speed * UM * gap / height,
        };
        Self {
            subject,
            gap,
            spacing,
            entry,
            exit,
            height,
            width: whole(options.width * diameter),
            length: whole(exit + 2.5 * diameter),
            velocity,
            tau: options.tau,
            options: options.clone(),
        }
    }

    /// The same device on a grid twice as coarse, with the same time step and Reynolds number.
    pub fn coarser(&self) -> Self {
        Self {
            spacing: 2.0 * self.spacing,
            tau: 0.5 + 0.25 * (self.tau - 0.5),
            ..self.clone()
        }
    }

    /// Mean velocity in the open gap, m/s.
    pub fn gap_velocity(&self) -> f64 {
        self.velocity * self.height / self.gap
    }

    /// Density (kg/m3, scaled), viscosity (Pa s) and pace.
    fn fluid_numbers(&self) -> (f64, f64, Pace) {
        if self.options.paper_mode {
            let (density, viscosity) = SAMPLE_FLUID;
            return (density, viscosity, Pace::TimeStep(SAMPLE.0));
        }
        let (density, viscosity) = PLASMA;
        (density * self.scale(), viscosity, Pace::Tau(self.tau))
    }

    /// What is held while the cell passes.
    pub fn drive(&self) -> Drive {
        self.options.drive
    }

    /// Declared factor on the Reynolds number.
    pub fn scale(&self) -> f64 {
        if self.options.paper_mode {
            1.0
        } else {
            self.options.reynolds_scale
        }
    }

    /// Spacing, time step and fluid.
    pub fn units(&self) -> Units {
        let (density, viscosity, pace) = self.fluid_numbers();
        let time_step = match pace {
            Pace::Tau(tau) => Units::time_step_for(self.spacing, density, viscosity, tau),
            _ => SAMPLE.0,
        };
        Units::new(self.spacing, time_step, density, viscosity).with_reynolds_scale(self.scale())
    }

    /// The walls: channel and slit.
    pub fn walls(&self) -> Result<Arc<dyn Boundary>, ContactError> {
        let slit = SlitChannel {
            height: self.height,
            gap: self.gap,
            thickness: self.exit - self.entry,
            edge_radius: self.options.edge_radius * UM,
            position: 0.5 * (self.entry + self.exit),
        };
        Ok(Arc::new(slit.walls()?))
    }

    /// Fluid and walls, `width` (m) wide, driven at the device's flux.
    pub fn channel(&self, width: f64) -> Result<Scene, Box<dyn Error>> {
        let nodes = [self.length, self.height, width].map(|l| (l / self.spacing).round() as usize);
        let grid = Grid::new(nodes, self.spacing, [true, false, true]);
        let (density, viscosity, pace) = self.fluid_numbers();
        let collision = if self.options.paper_mode {
            Collision::Bgk
        } else {
            Collision::default()
        };
        let fluid = Fluid::new(grid, density, viscosity, pace)?
            .with_collision(collision)?
            .with_drive(FluidDrive::flux(0, self.velocity))?;
        let exchange = if self.options.paper_mode {
            DeltaExchange::new(lbm_ibm::ibm::Kernel::TwoPoint).with_markers(Markers::Nodes)
        } else {
            DeltaExchange::new(self.options.kernel.kernel())
        };
        // The soft contact may give by a tenth of a spacing before the run counts as failed. The paper's local area
        // modulus is so small that the flow shears triangles to slivers: that is reported, and ends no run.
        let guard = Guard {
            depth: 0.1 * self.spacing,
            triangle: 0.0,
            stretch: f64::INFINITY,
            fold: std::f64::consts::PI,
            ..Guard::default()
        };
        let mut scene = Scene::with_fluid(fluid, exchange).with_guard(guard);
        scene.set_walls(self.walls()?)?;
        Ok(scene)
    }

    /// The cell at rest about the origin.
    pub fn cell(&self) -> Result<Cell, MembraneError> {
        let form = if self.options.paper_mode {
            Form::Paper2011
        } else {
            self.options.form.form()
        };
        let cell = match self.subject {
            Subject::RbcEdge | Subject::RbcFace => presets::rbc_paper(form)?,
            Subject::Ctc => presets::ctc_paper(form)?,
            Subject::Neutrophil => presets::NEUTROPHIL
                .cell()?
                .with_viscosity_ratio(self.options.contrast)?,
            Subject::Lymphocyte => presets::LYMPHOCYTE
                .cell()?
                .with_viscosity_ratio(self.options.contrast)?,
        };
        Ok(if self.options.paper_mode {
            let (_, friction, node_mass) = SAMPLE;
            cell.with_motion(Motion::Newton { node_mass, friction })
        } else {
            cell
        })
    }

    /// Where the cell starts: its centre on the axis, turned as the subject says. The disc of a red cell lies in the
    /// x-y plane of its own frame.
    pub fn start(&self) -> Isometry3<f64> {
        let turn = match self.subject {
            Subject::RbcEdge => UnitQuaternion::from_scaled_axis(Vec3::x() * FRAC_PI_2),
            Subject::RbcFace => UnitQuaternion::from_scaled_axis(Vec3::y() * FRAC_PI_2),
            Subject::Ctc | Subject::Neutrophil | Subject::Lymphocyte => UnitQuaternion::identity(),
        };
        let x = self.entry - self.options.start * self.subject.diameter();
        Isometry3::from_parts(Vec3::new(x, 0.5 * self.height, 0.5 * self.width).into(), turn)
    }

    /// Contact between nodes and walls.
    pub fn contact(&self) -> SoftSphere {
        let law = SoftSphere::paper_wall().scaled(self.options.wall_strength);
        if self.options.paper_mode {
            law.with_cut_off(CutOff::Unshifted)
        } else {
            law
        }
    }

    /// The whole scene: fluid, walls, contact and cell. `pressure_drop` (Pa over the period) is held where the options
    /// say so. Returns the scene and the number of the cell.
    pub fn scene(&self, pressure_drop: f64) -> Result<(Scene, u32), Box<dyn Error>> {
        let mut scene = self.channel(self.width)?;
        if let (Drive::Pressure, Some(fluid)) = (self.options.drive, scene.fluid_as::<Fluid>()) {
            fluid.set_drive(FluidDrive::Force(Vec3::x() * (pressure_drop / self.length)))?;
        }
        let cell = scene.add_body(self.cell()?, &self.start())?;
        scene.add_field(WallRepulsion::new(self.walls()?, self.contact()));
        Ok((scene, cell))
    }
}
