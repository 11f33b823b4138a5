//! What dipoles miss of a pair, tabulated against the gap.

use super::TwoSpheres;
use crate::error::MagneticsError;
use std::f64::consts::PI;

/// How finely a table is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fineness {
    /// Least scale of the gap, in mean radii.
    scale: f64,
    nodes: usize,
    tolerance: f64,
    order: usize,
}

impl Fineness {
    /// For forces: about 1e-5 of the force between nodes.
    pub const FORCE: Self = Self {
        scale: 1e-3,
        nodes: 96,
        tolerance: 1e-9,
        order: 1400,
    };
    /// For estimates of error.
    pub const ESTIMATE: Self = Self {
        scale: 1e-2,
        nodes: 24,
        tolerance: 1e-3,
        order: 160,
    };
}

/// Depth of overlap, in contact distances, in which the force of contact falls by e.
const SOFT: f64 = 0.01;

/// Total moments (m3) of a pair by some model, and their derivatives with distance (m2): forces are half of these.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Moments {
    pub par: f64,
    pub perp: f64,
    pub par_slope: f64,
    pub perp_slope: f64,
}

impl Moments {
    /// These moments of a pair at contact, carried on to the gap `gap` (m, below zero): slopes fall by e in [`SOFT`] of the
    /// distance of `contact` (m), so that no overlap gives large moments.
    pub fn inside(&self, gap: f64, contact: f64) -> Self {
        let depth = SOFT * contact;
        let fall = (gap / depth).exp();
        Self {
            par: self.par - self.par_slope * depth * (1.0 - fall),
            perp: self.perp - self.perp_slope * depth * (1.0 - fall),
            par_slope: self.par_slope * fall,
            perp_slope: self.perp_slope * fall,
        }
    }
}

/// Exact less mutual dipoles, piecewise cubic in ln(gap + scale).
#[derive(Clone, Debug)]
pub(crate) struct PairTable {
    contact: f64,
    scale: f64,
    step: f64,
    first: f64,
    reach: f64,
    nodes: Vec<Moments>,
    radius: [f64; 2],
    permeability: [f64; 2],
    polarisability: [f64; 2],
}

impl PairTable {
    /// A table for gaps up to `reach` (m) of spheres of `radius` (m) and `permeability`.
    pub fn new(
        radius: [f64; 2],
        permeability: [f64; 2],
        reach: f64,
        fineness: Fineness,
    ) -> Result<Self, MagneticsError> {
        let pair = TwoSpheres::new(radius, permeability)?.with_limits(fineness.tolerance, fineness.order);
        let mean = 0.5 * (radius[0] + radius[1]);
        let contact = 2.0 * mean;
        let polarisability = [0, 1].map(|k| radius[k].powi(3) * (permeability[k] - 1.0) / (permeability[k] + 2.0));
        let scale = fineness.scale * mean;
        let first = scale.ln();
        let step = ((reach + scale).ln() - first) / (fineness.nodes - 1) as f64;
        let mut nodes = Vec::with_capacity(fineness.nodes);
        for k in 0..fineness.nodes {
            let gap = ((first + step * k as f64).exp() - scale).max(0.0);
            let exact = pair.solve(contact + gap)?;
            let dipoles = mutual(polarisability, contact + gap);
            let [par, perp] = exact.total_moment();
            nodes.push(Moments {
                par: par - dipoles.par,
                perp: perp - dipoles.perp,
                par_slope: 2.0 * exact.force_par - dipoles.par_slope,
                perp_slope: 2.0 * exact.force_perp - dipoles.perp_slope,
            });
        }
        Ok(Self {
            contact,
            scale,
            step,
            first,
            reach,
            nodes,
            radius,
            permeability,
            polarisability,
        })
    }

    /// Exact less mutual dipoles at `distance` (m). Overlapping pairs begin with the force of contact, which falls by e in a
    /// hundredth of the contact distance; from three quarters of the reach on the difference fades to nothing.
    pub fn correction(&self, distance: f64) -> Moments {
        let gap = distance - self.contact;
        if gap >= self.reach {
            return Moments::default();
        }
        if gap <= 0.0 {
            return self.nodes[0].inside(gap, self.contact);
        }
        let t = ((gap + self.scale).ln() - self.first) / self.step;
        let k = (t as usize).min(self.nodes.len() - 2);
        let (a, b) = (&self.nodes[k], &self.nodes[k + 1]);
        // Nodes have slopes with distance; the cubic needs them with ln(gap + scale).
        let stretch = |k: usize| (self.first + self.step * k as f64).exp() * self.step;
        let (sa, sb, here) = (stretch(k), stretch(k + 1), (gap + self.scale) * self.step);
        let u = t - k as f64;
        let cubic = |v0: f64, d0: f64, v1: f64, d1: f64| {
            let (d0, d1) = (d0 * sa, d1 * sb);
            let c2 = 3.0 * (v1 - v0) - 2.0 * d0 - d1;
            let c3 = 2.0 * (v0 - v1) + d0 + d1;
            let value = v0 + u * (d0 + u * (c2 + u * c3));
            (value, (d0 + u * (2.0 * c2 + u * 3.0 * c3)) / here)
        };
        let (par, par_slope) = cubic(a.par, a.par_slope, b.par, b.par_slope);
        let (perp, perp_slope) = cubic(a.perp, a.perp_slope, b.perp, b.perp_slope);
        let (w, dw) = self.fade(gap);
        Moments {
            par: w * par,
            perp: w * perp,
            par_slope: w * par_slope + dw * par,
            perp_slope: w * perp_slope + dw * perp,
        }
    }

    /// How much a pair at `distance` (m) counts, and the slope of that: one from contact to three quarters of the reach,
    /// falling as the fifth power of the distance inside contact.
    pub fn presence(&self, distance: f64) -> (f64, f64) {
        let s = distance / self.contact;
        if s < 1.0 {
            return (s.powi(5) * (6.0 - 5.0 * s), 30.0 * s.powi(4) * (1.0 - s) / self.contact);
        }
        match distance - self.contact {
            gap if gap < self.reach => self.fade(gap),
            _ => (0.0, 0.0),
        }
    }

    fn fade(&self, gap: f64) -> (f64, f64) {
        let width = 0.25 * self.reach;
        let s = (gap - 3.0 * width) / width;
        if s <= 0.0 {
            return (1.0, 0.0);
        }
        let w = 1.0 - s * s * s * (10.0 - s * (15.0 - 6.0 * s));
        (w, -30.0 * (s * (1.0 - s)).powi(2) / width)
    }

    /// Exact less fixed dipoles at `distance` (m).
    pub fn beyond_fixed(&self, distance: f64) -> Moments {
        let (c, m) = (self.correction(distance), mutual(self.polarisability, distance));
        let f = fixed(self.polarisability, distance);
        Moments {
            par: c.par + m.par - f.par,
            perp: c.perp + m.perp - f.perp,
            par_slope: c.par_slope + m.par_slope - f.par_slope,
            perp_slope: c.perp_slope + m.perp_slope - f.perp_slope,
        }
    }

    /// Radii (m) and permeabilities.
    pub fn spheres(&self) -> ([f64; 2], [f64; 2]) {
        (self.radius, self.permeability)
    }

    /// Greatest gap that is corrected, m.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// How much of what the pair has beyond dipoles is the first sphere's.
    pub fn share(&self) -> f64 {
        let [a, b] = self.polarisability;
        a / (a + b)
    }
}

/// Mutual dipoles: m1 + m2 = (p1 + p2 + 2 g p1 p2)/(1 - g^2 p1 p2), g = 2/R^3 (par), -1/R^3 (perp).
fn mutual([p1, p2]: [f64; 2], distance: f64) -> Moments {
    let one = |g: f64| {
        let d = 1.0 - g * g * p1 * p2;
        let top = p1 + p2 + 2.0 * g * p1 * p2;
        let slope = (2.0 * p1 * p2 * d + 2.0 * g * p1 * p2 * top) / (d * d);
        (4.0 * PI * top / d, -3.0 * g / distance * 4.0 * PI * slope)
    };
    let cube = distance.powi(3);
    let (par, par_slope) = one(2.0 / cube);
    let (perp, perp_slope) = one(-1.0 / cube);
    Moments {
        par,
        perp,
        par_slope,
        perp_slope,
    }
}

/// Fixed dipoles, as the moments whose half slopes are their forces.
fn fixed([p1, p2]: [f64; 2], distance: f64) -> Moments {
    let g = 1.0 / distance.powi(3);
    let one = |g: f64| {
        let extra = 4.0 * PI * 2.0 * g * p1 * p2;
        (4.0 * PI * (p1 + p2) + extra, -3.0 / distance * extra)
    };
    let (par, par_slope) = one(2.0 * g);
    let (perp, perp_slope) = one(-g);
    Moments {
        par,
        perp,
        par_slope,
        perp_slope,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn between_its_nodes_a_table_has_the_exact_force_and_its_slope_is_its_derivative() {
        let pair = TwoSpheres::new([1.0, 1.3], [4.0, 2.0]).unwrap();
        let table = PairTable::new([1.0, 1.3], [4.0, 2.0], 3.0, Fineness::FORCE).unwrap();
        for gap in [3e-3, 0.017, 0.13, 0.4, 1.1, 1.9] {
            let (r, h) = (2.3 + gap, 1e-5 * gap);
            let exact = pair.solve(r).unwrap();
            let (now, dipoles) = (table.correction(r), mutual(table.polarisability, r));
            assert_relative_eq!(
                0.5 * (now.par_slope + dipoles.par_slope),
                exact.force_par,
                max_relative = 1e-5
            );
            assert_relative_eq!(
                0.5 * (now.perp_slope + dipoles.perp_slope),
                exact.force_perp,
                max_relative = 1e-5
            );
            let slope = (table.correction(r + h).par - table.correction(r - h).par) / (2.0 * h);
            assert_relative_eq!(slope, now.par_slope, max_relative = 1e-6);
        }
        assert_eq!(table.correction(5.3), Moments::default());
    }
}
