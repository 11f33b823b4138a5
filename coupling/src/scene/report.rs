//! What a scene says of itself.

use super::Scene;
use crate::guard::Scope;
use crate::{SceneError, Vec3};
use std::fmt;

impl Scene {
    /// Least distance (m) of any node of a body from the walls; infinite without walls.
    ///
    /// # Errors
    /// [`SceneError::UnknownBody`].
    pub fn wall_distance(&self, id: u32) -> Result<f64, SceneError> {
        let x = self.body_positions(id)?;
        let Some(walls) = &self.walls else {
            return Ok(f64::INFINITY);
        };
        let distance = |p: Vec3| walls.probe(self.domain.wrap(p), self.time).distance;
        Ok(x.iter().map(distance).fold(f64::INFINITY, f64::min))
    }

    /// Looks at everything, as the guard does every so many steps.
    ///
    /// # Errors
    /// The first offending thing.
    pub fn check(&self) -> Result<(), SceneError> {
        if let Some(fluid) = &self.fluid {
            fluid.lattice.check()?;
        }
        for (i, info) in self.infos.iter().enumerate() {
            let scope = Scope {
                x: self.nodes(i),
                v: self.v.slice(info.range.clone()),
                spacing: self.fluid.as_ref().map(|f| f.lattice.grid().spacing),
                time_step: self.time_step,
                time: self.time,
                step: self.step,
                walls: self.walls.as_deref(),
                domain: &self.domain,
            };
            self.guard.look(info, &self.bodies[i].rest, &scope)?;
        }
        Ok(())
    }
}

impl fmt::Display for Scene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "Scene at {:.4e} s (step {}, dt {:.4e} s)",
            self.time, self.step, self.time_step
        )?;
        match &self.fluid {
            Some(fluid) => {
                let grid = fluid.lattice.grid();
                let [nx, ny, nz] = grid.shape;
                writeln!(f, "  fluid   {nx} x {ny} x {nz} nodes, dx {:.3e} m", grid.spacing)?;
            }
            None => writeln!(f, "  fluid   none")?,
        }
        if let Some(walls) = &self.wall_report {
            writeln!(
                f,
                "  walls   {} solid nodes, {} links",
                walls.solid_nodes, walls.wall_links
            )?;
        }
        for b in &self.infos {
            writeln!(
                f,
                "  body {}  {}, {} nodes, {:?}",
                b.id,
                b.kind,
                b.range.len(),
                b.motion
            )?;
        }
        for field in &self.fields {
            writeln!(f, "  force   {}", field.name())?;
        }
        Ok(())
    }
}
