//! Cells flow against a row of chains, frozen or carried by the flow.

use crate::chains::Row;
use crate::device::{DENSITY, Device, HEIGHT, PLASMA, RADIUS, ROW};
use crate::subject::{Fate, Subject, cells};
use clap::Args;
use lbm_ibm::contact::{BeadRepulsion, CellRepulsion, SoftSphere, WallRepulsion};
use lbm_ibm::coupling::nalgebra::{Isometry3, UnitQuaternion};
use lbm_ibm::coupling::{Boundary, Grid, Guard, Scene, SceneError, Soa3, UM, Vec3};
use lbm_ibm::ibm::{DeltaExchange, Kernel, RigidBody};
use lbm_ibm::lbm::{Drive, Fluid, Pace};
use lbm_ibm::magnetics::{Auto, BeadForces, Uniform};
use lbm_ibm::output::VtkSeries;
use serde::Serialize;
use std::error::Error;
use std::f64::consts::PI;
use std::sync::Arc;

/// Length of the channel before its period (m), and where in it the row stands.
const LENGTH: f64 = 72.0 * UM;
const ROW_AT: f64 = 34.0 * UM;
/// Part of the walls that the first bead is.
const BEAD_PART: usize = 4;
/// Time between two looks, s.
const EVERY: f64 = 0.5e-3;

/// The flow and its grid.
#[derive(Clone, Copy, Debug, Args)]
pub struct Settings {
    /// Mean speed of the flow in the channel, um/s.
    #[arg(long, default_value_t = 460.0)]
    pub speed: f64,
    /// Grid spacing, um.
    #[arg(long, default_value_t = 1.0)]
    resolution: f64,
    /// Relaxation time tau.
    #[arg(long, default_value_t = 0.75)]
    tau: f64,
    /// Factor on the density, and so on the Reynolds number and the time step.
    #[arg(long, default_value_t = 58.0)]
    reynolds_scale: f64,
}

/// What became of a cell, in SI.
#[derive(Clone, Debug, Serialize)]
pub struct End {
    /// frozen, coupled or released.
    pub beads: String,
    /// ctc or rbc.
    pub cell: String,
    /// How it fared.
    pub fate: Fate,
    /// When that was known, from its nose's meeting the row on, s.
    pub time: f64,
    /// Where its middle was then, along the flow from the row's middle, m.
    pub place: f64,
    /// Its speed at the end over that of the fluid in the open row.
    pub speed: f64,
    /// Greatest relative change of its volume.
    pub volume_drift: f64,
}

/// A moment of a run, in SI.
#[derive(Clone, Debug, Serialize)]
pub struct Moment {
    /// frozen, coupled or released.
    pub beads: String,
    /// Time, s.
    pub time: f64,
    /// Middle of the tumour cell along the flow from the row's middle, m.
    pub ctc: f64,
    /// The same of the red cell; none when it has left.
    pub rbc: Option<f64>,
    /// Pressure drop over the channel, Pa.
    pub pressure_drop: f64,
    /// Force of the fluid on all beads along the flow, N.
    pub fluid_force: f64,
    /// Force of the cells on all beads along the flow, N; frozen beads alone tell.
    pub cell_force: Option<f64>,
    /// Greatest displacement of a bead from where it was, m.
    pub bend: f64,
}

/// What a frozen bead bears at the end, in SI; x is along the flow, z along the chain.
#[derive(Clone, Debug, Serialize)]
pub struct Load {
    /// Number of the bead: four to a chain.
    pub bead: usize,
    /// Force of the fluid, N.
    pub fluid_x: f64,
    /// Force of the fluid, N.
    pub fluid_y: f64,
    /// Force of the fluid, N.
    pub fluid_z: f64,
    /// Force of the cells, N.
    pub cells_x: f64,
    /// Force of the cells, N.
    pub cells_y: f64,
    /// Force of the cells, N.
    pub cells_z: f64,
}

/// How the beads are treated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beads {
    /// Frozen: part of the walls.
    Frozen,
    /// Rigid bodies under fluid, field and contact.
    Coupled,
}

/// A row of beads and cells in a flow.
pub struct Run<'a> {
    row: &'a Row,
    scene: Scene,
    walls: Arc<dyn Boundary>,
    shift: Vec3,
    beads: Vec<u32>,
    /// The cells.
    pub cells: Vec<Subject>,
    /// Index of the magnetic forces among the scene's.
    magnets: Option<usize>,
    name: String,
    /// What was seen.
    pub moments: Vec<Moment>,
    /// Speed of the fluid in the open row, m/s.
    pub open_speed: f64,
}

impl<'a> Run<'a> {
    /// Cells upstream of the row, in a flow that starts from rest at a given flux.
    pub fn new(
        device: &Device,
        settings: &Settings,
        row: &'a Row,
        kind: Beads,
        bias: f64,
    ) -> Result<Self, Box<dyn Error>> {
        if row.chains != ROW.0 {
            return Err(format!("the beads stand in {} chains, the row needs {}", row.chains, ROW.0).into());
        }
        let h = settings.resolution * UM;
        let width = Device::width(row.gap, h);
        let nodes = [LENGTH, width, HEIGHT].map(|l| (l / h).round() as usize);
        let grid = Grid::new(nodes, h, [true, false, false]);
        let shift = Vec3::new(ROW_AT, 0.5 * width, 0.5 * HEIGHT);
        let (density, viscosity) = PLASMA;
        // A cell stretched in the row, as coupled beads find it, bears half the step of one at rest.
        let slower = if kind == Beads::Coupled { 0.5 } else { 1.0 };
        let tau = 0.5 + slower * (settings.tau - 0.5);
        let fluid = Fluid::new(grid, density * settings.reynolds_scale, viscosity, Pace::Tau(tau))?
            .with_narrow_gaps_filled()
            .with_drive(Drive::flux(0, settings.speed * UM))?;
        let guard = Guard {
            depth: 0.1 * h,
            triangle: 0.0,
            stretch: f64::INFINITY,
            fold: std::f64::consts::PI,
            ..Guard::default()
        };
        let mut scene = Scene::with_fluid(fluid, DeltaExchange::new(Kernel::RomaThree)).with_guard(guard);
        let frozen = if kind == Beads::Frozen {
            row.spheres()
        } else {
            Vec::new()
        };
        let walls = Device::walls(width, &frozen, shift)?;
        scene.set_walls(walls.clone())?;
        let contact = SoftSphere::paper_wall();
        let cells = cells(&mut scene, shift, row)?;
        scene.add_field(WallRepulsion::new(walls.clone(), contact).except("bead"));
        scene.add_field(CellRepulsion::new(contact).except("bead"));
        let (mut beads, mut magnets) = (Vec::new(), None);
        if kind == Beads::Coupled {
            for centre in row.centres.iter() {
                let bead = RigidBody::sphere(RADIUS, DENSITY * settings.reynolds_scale)?.with_kind("bead");
                beads.push(scene.add_body(
                    bead,
                    &Isometry3::from_parts((centre + shift).into(), UnitQuaternion::identity()),
                )?);
            }
            scene.add_field(
                BeadRepulsion::new(contact.scaled(100.0))
                    .with_node_law(contact)
                    .with_kind("bead", RADIUS)?
                    .with_walls(walls.clone()),
            );
            let forces = BeadForces::new(device.source(shift, bias)?, Auto::new());
            magnets = Some(scene.add_field(forces.with_kind("bead", device.bead()?)));
        }
        let open = HEIGHT * width - (ROW.0 * ROW.1) as f64 * PI * RADIUS * RADIUS;
        Ok(Self {
            row,
            scene,
            walls,
            shift,
            beads,
            cells,
            magnets,
            name: format!("{kind:?}").to_lowercase(),
            moments: Vec::new(),
            open_speed: settings.speed * UM * HEIGHT * width / open,
        })
    }
}

impl Run<'_> {
    /// Where the nodes of each cell are, m; none for one that has left.
    pub fn cell_positions(&self) -> Result<Vec<Option<Soa3>>, SceneError> {
        let nodes = |cell: &Subject| match cell.gone {
            true => Ok(None),
            false => Ok(Some(self.scene.body_positions(cell.id)?.iter().collect())),
        };
        self.cells.iter().map(nodes).collect()
    }

    /// Puts the cells where another run has them; those that have left it leave this one, too.
    pub fn place_cells(&mut self, positions: &[Option<Soa3>]) -> Result<(), SceneError> {
        for (cell, x) in self.cells.iter_mut().zip(positions) {
            match x {
                Some(x) => self.scene.set_body_positions(cell.id, x.view())?,
                None => {
                    self.scene.remove_body(cell.id)?;
                    (cell.gone, cell.absent) = (true, true);
                }
            }
        }
        Ok(())
    }

    /// Switches the magnets off.
    pub fn switch_off(&mut self) {
        self.name = "released".to_owned();
        if let Some(forces) = self.magnets.and_then(|m| self.scene.field_mut::<BeadForces>(m)) {
            forces.set_source(Uniform::new(Vec3::zeros()));
        }
        for cell in &mut self.cells {
            if cell.fate.is_none_or(|(fate, _)| fate != Fate::Pass) {
                cell.fate = None;
            }
        }
    }

    /// Lets cells flow until each has passed or is held, or `time` (s) is over; ten moments go to `film`.
    pub fn until_settled(&mut self, time: f64, mut film: Option<&mut VtkSeries>) -> Result<(), Box<dyn Error>> {
        let end = self.scene.time() + time;
        let mut frame = self.scene.time();
        while self.scene.time() < end && self.cells.iter().any(|c| !c.gone && c.fate.is_none()) {
            self.go_on(EVERY)?;
            if let Some(film) = &mut film
                && self.scene.time() >= frame
            {
                film.write(&self.scene)?;
                frame += 0.1 * time;
            }
        }
        Ok(())
    }

    /// Goes on for `time` (s), then looks.
    fn go_on(&mut self, time: f64) -> Result<(), Box<dyn Error>> {
        let until = self.scene.time() + time;
        while self.scene.time() < until {
            self.scene.step()?;
        }
        self.look()
    }

    fn look(&mut self) -> Result<(), Box<dyn Error>> {
        let time = self.scene.time();
        let entry = self.entry();
        for cell in self.cells.iter_mut().filter(|c| !c.gone) {
            cell.look(&self.scene, self.shift.x, 0.01 * self.open_speed, entry)?;
            if matches!(cell.fate, Some((Fate::Pass, _))) && cell.name == "rbc" {
                // What has passed would come round again.
                self.scene.remove_body(cell.id)?;
                cell.gone = true;
            }
        }
        let fluid = self.scene.fluid().ok_or("the trap has a fluid")?;
        let (mut fluid_force, mut cell_force) = (0.0, None);
        if self.beads.is_empty() {
            let loads = self.bead_loads();
            fluid_force = loads.iter().map(|l| l.fluid_x).sum();
            cell_force = Some(loads.iter().map(|l| l.cells_x).sum());
        }
        let mut bend: f64 = 0.0;
        for (id, start) in self.beads.iter().zip(self.row.centres.iter()) {
            fluid_force += self.scene.wrench_on(*id)?.force.x;
            let place = self.scene.pose(*id)?.translation.vector - self.shift;
            bend = bend.max((place - start).norm());
        }
        let at = |cell: &Subject| (!cell.gone).then(|| cell.track.last().map_or(f64::NAN, |(_, x)| x.x - self.shift.x));
        self.moments.push(Moment {
            beads: self.name.clone(),
            time,
            ctc: at(&self.cells[0]).unwrap_or(f64::NAN),
            rbc: at(&self.cells[1]),
            pressure_drop: fluid.body_force().x * LENGTH,
            fluid_force,
            cell_force,
            bend,
        });
        Ok(())
    }

    /// Time in which the fluid of the open row goes the tumour cell's diameter, s.
    fn entry(&self) -> f64 {
        2.0 * self.cells[0].radius / self.open_speed
    }

    /// How the cells fared.
    pub fn ends(&self) -> Vec<End> {
        let end = |cell: &&Subject| {
            let (fate, at) = cell.fate.unwrap_or((Fate::Undecided, self.scene.time()));
            let place = cell.track.last().map_or(f64::NAN, |(_, x)| x.x - self.shift.x);
            End {
                beads: self.name.clone(),
                cell: cell.name.to_owned(),
                fate,
                time: at - cell.touched.unwrap_or(at),
                place,
                speed: cell.speed(2.0 * self.entry()) / self.open_speed,
                volume_drift: cell.drift,
            }
        };
        self.cells.iter().filter(|c| !c.absent).map(|c| end(&c)).collect()
    }

    /// What each frozen bead bears now.
    pub fn bead_loads(&self) -> Vec<Load> {
        let time = self.scene.time();
        let fluid = self.scene.fluid();
        let loads = fluid.and_then(|f| f.wall_loads(self.walls.as_ref(), time, self.shift));
        let loads = loads.unwrap_or_default();
        let cells = &self.scene.loads().wall;
        let load = |bead: usize| {
            let f = loads.get(BEAD_PART + bead).map_or(Vec3::zeros(), |w| w.force);
            let c = cells.get(BEAD_PART + bead).copied().unwrap_or_default();
            Load {
                bead,
                fluid_x: f.x,
                fluid_y: f.y,
                fluid_z: f.z,
                cells_x: c.x,
                cells_y: c.y,
                cells_z: c.z,
            }
        };
        (0..self.row.centres.len()).map(load).collect()
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }
}
