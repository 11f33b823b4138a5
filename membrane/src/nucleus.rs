//! A nucleus: a second membrane inside a cell, linked to it.

use crate::{MembraneError, Mesh, mesh::positive};
use lbm_ibm_coupling::{BodyInfo, ForceField, Loads, Vec3, View};
use std::ops::Range;

/// Springs between the nodes of a nucleus and those of its cell: E = sum of k/2 (l - l0)^2, k in N/m. They stand for
/// the filaments that hold a nucleus in its place.
///
/// The nucleus is a body of its own, placed where the cell is, with laws, viscosity of its inside and motion of its
/// own. Each of its nodes is linked to the cell's node that lies most nearly in the same direction from the common
/// origin; at rest no link pulls. Central forces between pairs keep force and torque. The links do not keep the two
/// surfaces apart when the cell is squeezed flat on the nucleus: add a repulsion between the bodies for that. If one
/// of the two bodies is gone, nothing pulls on the other.
///
/// ```
/// use lbm_ibm_coupling::{Motion, Scene};
/// use lbm_ibm_coupling::nalgebra::Isometry3;
/// use lbm_ibm_membrane::nucleus::NucleusLinks;
/// use lbm_ibm_membrane::{Material, Mesh, Sheet, presets};
///
/// let slow = Motion::Overdamped { friction: 1e-8 };
/// let cell = presets::MCF7.with_nodes(300).cell()?.with_motion(slow);
/// // Half as wide as the cell and ten times as stiff.
/// let stiff = Material { shear: 170e-6, dilation: 510e-6, volume: 3e3, ..Material::none(Sheet::NeoHookean) };
/// let nucleus = stiff.cell("nucleus", Mesh::sphere(4e-6, 100)?.into())?.with_motion(slow);
/// let (outer, inner) = (cell.mesh().clone(), nucleus.mesh().clone());
///
/// let mut scene = Scene::without_fluid(1e-7)?;
/// let place = Isometry3::translation(20e-6, 20e-6, 20e-6);
/// let (cell, nucleus) = (scene.add_body(cell, &place)?, scene.add_body(nucleus, &place)?);
/// scene.add_field(NucleusLinks::new((cell, &outer), (nucleus, &inner), 1e-6)?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NucleusLinks {
    cell: u32,
    nucleus: u32,
    /// Node of the nucleus, node of the cell.
    links: Vec<[u32; 2]>,
    rest: Vec<f64>,
    stiffness: f64,
    /// Most links at a node.
    most: usize,
}

impl NucleusLinks {
    /// Links the nucleus to the cell, both given by the number that the scene knows them by and their mesh at rest,
    /// with springs of `stiffness` k in N/m each.
    ///
    /// # Errors
    /// [`MembraneError::NotPositive`]; [`MembraneError::NucleusOutside`] where a node of the nucleus lies farther out
    /// than the node of the cell in its direction.
    pub fn new(cell: (u32, &Mesh), nucleus: (u32, &Mesh), stiffness: f64) -> Result<Self, MembraneError> {
        let (outer, inner) = (cell.1.nodes(), nucleus.1.nodes());
        let directions: Vec<Vec3> = outer.iter().map(|x| x / x.norm()).collect();
        let mut count = vec![0_usize; outer.len()];
        let (mut links, mut rest) = (Vec::new(), Vec::new());
        for (i, x) in inner.iter().enumerate() {
            let along = |j: usize| directions[j].dot(&x);
            let nearest = (1..outer.len()).fold(0, |best, j| if along(j) > along(best) { j } else { best });
            if x.norm() >= outer.get(nearest).norm() {
                return Err(MembraneError::NucleusOutside {
                    node: i,
                    distance: x.norm(),
                    cell: outer.get(nearest).norm(),
                });
            }
            count[nearest] += 1;
            links.push([i as u32, nearest as u32]);
            rest.push((outer.get(nearest) - x).norm());
        }
        Ok(Self {
            cell: cell.0,
            nucleus: nucleus.0,
            links,
            rest,
            stiffness: positive("the stiffness of a link to a nucleus", stiffness)?,
            most: count.into_iter().max().unwrap_or(0),
        })
    }

    /// Nodes of the nucleus and of the cell, while both are there.
    fn ranges(&self, bodies: &[BodyInfo]) -> Option<[Range<usize>; 2]> {
        let range = |id: u32| bodies.iter().find(|b| b.id == id).map(|b| b.range.clone());
        Some([range(self.nucleus)?, range(self.cell)?])
    }

    /// Node numbers in the scene, rest lengths.
    fn ends<'a>(&'a self, ranges: &'a [Range<usize>; 2]) -> impl Iterator<Item = ([usize; 2], f64)> + 'a {
        let [nucleus, cell] = ranges;
        let link = |(&[i, j], &rest): (&[u32; 2], &f64)| ([nucleus.start + i as usize, cell.start + j as usize], rest);
        self.links.iter().zip(&self.rest).map(link)
    }
}

impl ForceField for NucleusLinks {
    fn name(&self) -> &str {
        "links of a nucleus"
    }

    fn add_loads(&mut self, view: &View<'_>, loads: &mut Loads) {
        let Some(ranges) = self.ranges(view.bodies) else { return };
        for ([i, j], rest) in self.ends(&ranges) {
            let d = view.x.get(j) - view.x.get(i);
            let length = d.norm();
            let f = d * (self.stiffness * (length - rest) / length);
            loads.node.add(i, f);
            loads.node.add(j, -f);
        }
    }

    fn energy(&mut self, view: &View<'_>) -> Option<f64> {
        let Some(ranges) = self.ranges(view.bodies) else {
            return Some(0.0);
        };
        let link = |([i, j], rest): ([usize; 2], f64)| ((view.x.get(j) - view.x.get(i)).norm() - rest).powi(2);
        Some(0.5 * self.stiffness * self.ends(&ranges).map(link).sum::<f64>())
    }

    fn stiffness(&self, _view: &View<'_>) -> Option<f64> {
        Some(self.stiffness * self.most as f64)
    }
}
