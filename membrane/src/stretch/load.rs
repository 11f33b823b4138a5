//! What pulls a cell.

use super::Ends;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::f64::consts::PI;

/// How the pull on a cell is spread over it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Load {
    /// Equal forces along x on the nodes of two patches, as in optical tweezers.
    Ends(Ends),
    /// The same forces on two patches that are glued to beads: the nodes of a patch move as one piece, without turning.
    Beads(Ends),
    /// A stress s0 cos(theta)^2 along the outward normal, theta the angle between the x axis and the way from the
    /// cell's centre: an optical stretcher whose two beams run along x (Guck et al., Biophys. J. 81, 767, 2001). The
    /// peak stress is that which pulls each half of a sphere of the cell's volume by the asked force, s0 = 2 F/(pi
    /// R^2).
    CosineSquared,
}

impl From<Ends> for Load {
    fn from(ends: Ends) -> Self {
        Self::Ends(ends)
    }
}

impl Load {
    /// Peak stress s0 (Pa) of an optical stretcher that pulls each half of a sphere of `radius` (m) by `force` (N).
    pub fn peak_stress(force: f64, radius: f64) -> f64 {
        2.0 * force / (PI * radius * radius)
    }

    /// Adds the load of `force` (N) on a cell of the volume of a sphere of `radius` (m) to its internal forces `f` (N).
    pub(super) fn add(&self, x: Soa3Ref<'_>, triangles: &[[u32; 3]], force: f64, radius: f64, f: &mut Soa3) {
        match self {
            Self::Ends(ends) => {
                for (nodes, sign) in [(&ends.plus, 1.0), (&ends.minus, -1.0)] {
                    for &i in nodes {
                        f.x[i as usize] += sign * force / nodes.len() as f64;
                    }
                }
            }
            Self::Beads(ends) => {
                for (nodes, sign) in [(&ends.plus, 1.0), (&ends.minus, -1.0)] {
                    let sum: Vec3 = nodes.iter().map(|&i| f.get(i as usize)).sum();
                    let share = (sum + Vec3::new(sign * force, 0.0, 0.0)) / nodes.len() as f64;
                    for &i in nodes {
                        f.set(i as usize, share);
                    }
                }
            }
            Self::CosineSquared => {
                let centre = x.mean();
                let peak = Self::peak_stress(force, radius);
                for &t in triangles {
                    let [a, b, c] = t.map(|i| x.get(i as usize) - centre);
                    let middle = a + b + c;
                    let square = middle.x * middle.x / middle.norm_squared();
                    let push = (b - a).cross(&(c - a)) * (peak * square / 6.0);
                    for node in t {
                        f.add(node as usize, push);
                    }
                }
            }
        }
    }
}
