//! Where contacts close triangles, and how that changes as beads move.

use crate::model::Problem;
use crate::model::near::pairs;
use lbm_ibm_coupling::{Soa3, Vec3};

/// Gaps (mean radii) up to which a pair counts fully, and from which it does not count.
const GAPS: [f64; 2] = [0.5, 0.8];

/// How much each bead is a part of closed contacts, from 0 to 1.
///
/// A pair counts by s = 1 - u^3 (10 - 15 u + 6 u^2) of its gap, a triangle by the product p of its three pairs, a bead by
/// 1 - product over its triangles of 1 - p.
pub(super) struct Activity {
    /// One per bead.
    pub value: Vec<f64>,
    /// Bead whose value changes, the two beads of a pair, and the slope with the vector from the second to the first (1/m).
    slopes: Vec<(usize, usize, usize, Vec3)>,
}

struct Edge {
    i: usize,
    j: usize,
    weight: f64,
    slope: Vec3,
}

impl Activity {
    pub fn of(problem: &Problem<'_>) -> Self {
        let n = problem.beads().len();
        let mut edges = Vec::new();
        let mut of = vec![Vec::new(); n];
        for pair in pairs(problem, (2.0 + GAPS[1]) * problem.largest_radius()) {
            let contact = problem.beads()[pair.i].radius() + problem.beads()[pair.j].radius();
            let gap = 2.0 * (pair.distance - contact) / contact;
            let (weight, slope) = count(gap);
            if weight > 0.0 {
                let (i, j) = (pair.i, pair.j);
                of[i].push((j, edges.len()));
                of[j].push((i, edges.len()));
                let slope = if slope == 0.0 {
                    Vec3::zeros()
                } else {
                    pair.r * (slope * 2.0 / contact / pair.distance)
                };
                edges.push(Edge { i, j, weight, slope });
            }
        }
        // Triangles per bead: its three edges.
        let mut triangles = vec![Vec::new(); n];
        for (e, edge) in edges.iter().enumerate() {
            for &(k, a) in &of[edge.i] {
                if let Some(&(_, b)) = of[edge.j].iter().find(|(other, _)| *other == k) {
                    triangles[k].push([e, a, b]);
                }
            }
        }
        let mut value = vec![0.0; n];
        let mut slopes = Vec::new();
        for (k, own) in triangles.iter().enumerate() {
            let product = |t: &[usize; 3]| t.iter().map(|e| edges[*e].weight).product::<f64>();
            let factors: Vec<f64> = own.iter().map(|t| 1.0 - product(t)).collect();
            value[k] = 1.0 - factors.iter().product::<f64>();
            for (t, triangle) in own.iter().enumerate() {
                let others: f64 = factors
                    .iter()
                    .enumerate()
                    .filter(|(u, _)| *u != t)
                    .map(|(_, f)| f)
                    .product();
                for (a, e) in triangle.iter().enumerate() {
                    let rest = edges[triangle[(a + 1) % 3]].weight * edges[triangle[(a + 2) % 3]].weight;
                    let slope = edges[*e].slope * (rest * others);
                    if slope != Vec3::zeros() {
                        slopes.push((k, edges[*e].i, edges[*e].j, slope));
                    }
                }
            }
        }
        Self { value, slopes }
    }

    pub fn is_none(&self) -> bool {
        self.value.iter().all(|v| *v == 0.0)
    }

    /// Adds the forces (N) of an energy whose slopes with the values are `slope` (J).
    pub fn add_forces(&self, slope: &[f64], force: &mut Soa3) {
        for (k, i, j, with) in &self.slopes {
            let f = with * -slope[*k];
            force.add(*i, f);
            force.add(*j, -f);
        }
    }
}

/// Weight of a gap and its slope.
fn count(gap: f64) -> (f64, f64) {
    let u = (gap - GAPS[0]) / (GAPS[1] - GAPS[0]);
    falling(u, GAPS[1] - GAPS[0])
}

/// A weight that falls from one at u = 0 to nothing at u = 1, and its slope where u = x/width.
pub(super) fn falling(u: f64, width: f64) -> (f64, f64) {
    if u <= 0.0 {
        (1.0, 0.0)
    } else if u >= 1.0 {
        (0.0, 0.0)
    } else {
        let weight = 1.0 - u * u * u * (10.0 - u * (15.0 - 6.0 * u));
        (weight, -30.0 * (u * (1.0 - u)).powi(2) / width)
    }
}
