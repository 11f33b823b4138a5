//! The state of a whole scene as bytes.
//!
//! The state is what a step reads and does not find in the way the scene was built: populations of the fluid and its drive,
//! positions and velocities of nodes, rigid bodies, and what exchange, bodies and force fields remember. Walls, laws, meshes and
//! numbers come from building the scene again.

use super::{Elasticity, Scene};
use crate::state::{checksum, differs};
use crate::{SceneError, StateError, StateReader, StateWriter, Wrench};

/// What a saved scene starts with, and the version of the format.
const MARK: [u8; 8] = *b"lbmscene";
const VERSION: u64 = 2;

impl Scene {
    /// The state as bytes, for [`Scene::restore`] of a scene that is built alike: it goes on as this one does, to the last bit,
    /// on any number of threads. Bytes are those of this version of the format on any machine; they end with a checksum.
    ///
    /// ```
    /// # use lbm_ibm_coupling::Scene;
    /// let build = || Scene::without_fluid(1e-6);
    /// let mut scene = build()?;
    /// scene.step()?;
    /// let saved = scene.save()?;
    /// let mut again = build()?;
    /// again.restore(&saved)?;
    /// assert_eq!(again.steps(), 1);
    /// # Ok::<(), lbm_ibm_coupling::SceneError>(())
    /// ```
    ///
    /// # Errors
    /// [`StateError::CannotSave`] where the fluid cannot tell its state, [`StateError::Unwritable`] where a body or a field gives
    /// its state a value that the format has no place for.
    pub fn save(&self) -> Result<Vec<u8>, SceneError> {
        let mut to = StateWriter::default();
        for (_, here) in self.build()? {
            to.part(here.as_bytes());
        }
        to.count(self.step);
        to.count(u64::from(self.ready));
        for array in [&self.x, &self.v, &self.fluid_velocity, &self.on_fluid, &self.loads.node] {
            to.array(array.view());
        }
        if self.elasticity != Elasticity::Explicit {
            to.array(self.workspace.excess.view());
        }
        for load in &self.loads.body {
            to.vector(load.force);
            to.vector(load.torque);
        }
        to.count(self.loads.wall.len() as u64);
        for force in &self.loads.wall {
            to.vector(*force);
        }
        for state in &self.rigid {
            state.save(&mut to);
        }
        if let Some(fluid) = &self.fluid {
            let state = fluid.lattice.save().ok_or_else(|| StateError::CannotSave {
                what: "the fluid".to_owned(),
            })?;
            to.part(&state);
            to.part(&part(|to| fluid.exchange.save(to))?);
        }
        for slot in &self.bodies {
            to.part(&part(|to| slot.body.save(to))?);
        }
        for field in &self.fields {
            to.part(&part(|to| field.save(to))?);
        }
        let mut bytes = [MARK.as_slice(), &VERSION.to_le_bytes(), &to.into_bytes()?].concat();
        let sum = checksum(&bytes);
        bytes.extend_from_slice(&sum.to_le_bytes());
        Ok(bytes)
    }

    /// Takes a state of [`Scene::save`]. This scene has to be built as that one was: grid, fluid and its numbers, walls, the same
    /// bodies under the same numbers (those that have been removed added and removed again), the same force fields, all in the
    /// same order. What can be compared is.
    ///
    /// # Errors
    /// [`StateError`]; [`crate::FluidError::State`]. Bytes that are not whole, not of this version, or of a scene that differs in
    /// bodies, fields or time step leave the scene as it was; after any other error it has to be built anew.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SceneError> {
        let mut from = StateReader::new(whole(bytes)?, "the scene");
        for (what, here) in self.build()? {
            let saved = String::from_utf8_lossy(from.part()?).into_owned();
            differs(what, saved, here)?;
        }
        self.step = from.count()?;
        self.time = self.step as f64 * self.time_step;
        self.ready = from.count()? != 0;
        for array in [
            &mut self.x,
            &mut self.v,
            &mut self.fluid_velocity,
            &mut self.on_fluid,
            &mut self.loads.node,
        ] {
            from.array(array)?;
        }
        if self.elasticity != Elasticity::Explicit {
            from.array(&mut self.workspace.excess)?;
        }
        for load in &mut self.loads.body {
            *load = Wrench {
                force: from.vector()?,
                torque: from.vector()?,
            };
        }
        self.loads.wall = (0..from.count()?).map(|_| from.vector()).collect::<Result<_, _>>()?;
        for state in &mut self.rigid {
            state.restore(&mut from)?;
        }
        if let Some(fluid) = &mut self.fluid {
            fluid.lattice.restore(from.part()?)?;
            let mut part = StateReader::new(from.part()?, "the exchange");
            fluid.exchange.restore(&mut part)?;
            part.end()?;
        }
        for (slot, info) in self.bodies.iter_mut().zip(&self.infos) {
            let mut part = StateReader::new(from.part()?, format!("body {} ({})", info.id, info.kind));
            slot.body.restore(&mut part)?;
            part.end()?;
        }
        for field in &mut self.fields {
            let mut part = StateReader::new(from.part()?, field.name());
            field.restore(&mut part)?;
            part.end()?;
        }
        Ok(from.end()?)
    }

    /// What a saved scene has to agree in with the one that takes it.
    fn build(&self) -> Result<Vec<(String, String)>, StateError> {
        let mut all = vec![
            ("the time step (s)".to_owned(), format!("{:e}", self.time_step)),
            ("whether there is a fluid".to_owned(), self.fluid.is_some().to_string()),
            ("whether there are walls".to_owned(), self.walls.is_some().to_string()),
            ("the elasticity".to_owned(), format!("{:?}", self.elasticity)),
            ("the number of bodies".to_owned(), self.infos.len().to_string()),
            ("the number of force fields".to_owned(), self.fields.len().to_string()),
        ];
        for (i, info) in self.infos.iter().enumerate() {
            let reference = self.reference.slice(info.range.clone());
            let shape = checksum(&part(|to| to.array(reference))?);
            let triangles = info.triangles.iter().flatten().flat_map(|n| n.to_le_bytes());
            let shape = shape ^ checksum(&triangles.collect::<Vec<_>>());
            let body = format!("number {}, {} of {} nodes", info.id, info.kind, info.range.len());
            let body = format!("{body}, shape {shape:016x}, {:?}", info.motion);
            all.push((format!("body {i}"), body));
        }
        for (i, field) in self.fields.iter().enumerate() {
            all.push((format!("force field {i}"), field.name().to_owned()));
        }
        Ok(all)
    }
}

/// The bytes that `write` writes.
fn part(write: impl FnOnce(&mut StateWriter)) -> Result<Vec<u8>, StateError> {
    let mut to = StateWriter::default();
    write(&mut to);
    to.into_bytes()
}

/// What is between the head and the checksum of a saved scene.
fn whole(bytes: &[u8]) -> Result<&[u8], StateError> {
    let foreign = || StateError::NotAScene { bytes: bytes.len() };
    let (body, sum) = bytes.split_last_chunk::<8>().ok_or_else(foreign)?;
    let (mark, rest) = body.split_first_chunk::<8>().ok_or_else(foreign)?;
    let (version, rest) = rest.split_first_chunk::<8>().ok_or_else(foreign)?;
    if *mark != MARK {
        return Err(foreign());
    }
    let version = u64::from_le_bytes(*version);
    if version != VERSION {
        return Err(StateError::Version {
            found: version,
            known: VERSION,
        });
    }
    let (found, expected) = (checksum(body), u64::from_le_bytes(*sum));
    if found != expected {
        return Err(StateError::Damaged {
            bytes: bytes.len(),
            found,
            expected,
        });
    }
    Ok(rest)
}
