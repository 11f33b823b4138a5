//! Drag of spheres near walls and near each other, over the Stokes drag 6 pi eta a.

use lbm_ibm_coupling::Vec3;
use std::f64::consts::PI;

/// How beads drag each other along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PairMobility {
    /// Not at all.
    #[default]
    None,
    /// The tensor of Rotne and Prager (unequal radii: Zuk et al. 2014), overlapping beads as at contact.
    RotnePrager,
    /// Rotne and Prager, and for each pair the exact mobility of two equal spheres that approach each other (Brenner 1961),
    /// with mean radius for unequal ones: lubrication. Exact for a lone pair; a sum over pairs for more beads.
    Squeeze,
}

/// Drag of a sphere towards a plane wall at gap over radius `gap` (Brenner 1961, exact series); below 1e-3 the lubrication
/// limit 1/gap - ln(gap)/5 + 0.9713.
pub fn perpendicular_drag(gap: f64) -> f64 {
    if gap < 1e-3 {
        return 1.0 / gap - 0.2 * gap.ln() + 0.9713;
    }
    series(1.0 + gap, |n, alpha| {
        let (k, s) = (2.0 * n + 1.0, alpha.sinh());
        let top = 2.0 * (k * alpha).sinh() + k * (2.0 * alpha).sinh();
        top / (4.0 * (0.5 * k * alpha).sinh().powi(2) - k * k * s * s) - 1.0
    })
}

/// Drag of a sphere along a plane wall at gap over radius `gap`: the greater of Faxen's five terms and the lubrication
/// limit -8/15 ln(gap) + 0.9588 (Goldman, Cox and Brenner 1967), within 3 %.
pub fn parallel_drag(gap: f64) -> f64 {
    let y = 1.0 / (1.0 + gap);
    let faxen = 1.0 / (1.0 - y * (9.0 / 16.0 - y * y * (1.0 / 8.0 - y * (45.0 / 256.0 + y / 16.0))));
    faxen.max(0.9588 - 8.0 / 15.0 * gap.ln())
}

/// Relative mobility along the line of two equal spheres at `x` radii between centres, over that of two lone ones: one over
/// the drag of a sphere towards a free surface (Brenner 1961).
pub fn squeeze_mobility(x: f64) -> f64 {
    let gap = x - 2.0;
    if gap <= 0.0 {
        return 0.0;
    }
    if gap < 1e-4 {
        return 2.0 * gap;
    }
    let drag = series(0.5 * x, |n, alpha| {
        let (k, s) = (2.0 * n + 1.0, alpha.sinh());
        let top = 4.0 * (0.5 * k * alpha).cosh().powi(2) + k * k * s * s;
        top / (2.0 * (k * alpha).sinh() - k * (2.0 * alpha).sinh()) - 1.0
    });
    1.0 / drag
}

fn series(cosh: f64, term: impl Fn(f64, f64) -> f64) -> f64 {
    let alpha = cosh.acosh();
    let mut sum = 0.0;
    let mut n = 1.0;
    while (2.0 * n + 1.0) * alpha < 45.0 || n < 3.0 {
        sum += n * (n + 1.0) / ((2.0 * n - 1.0) * (2.0 * n + 3.0)) * term(n, alpha);
        n += 1.0;
    }
    4.0 / 3.0 * alpha.sinh() * sum
}

/// Velocity (m/s) of a sphere of `radius` (m) under `force` (N) in a fluid of `viscosity` (Pa s), a wall of unit normal
/// `normal` at `gap` (m) from its surface; gaps below `roughness` (m) count as that.
pub fn wall_mobility(force: Vec3, radius: f64, viscosity: f64, normal: Vec3, gap: f64, roughness: f64) -> Vec3 {
    let gap = gap.max(roughness) / radius;
    let towards = normal * force.dot(&normal);
    let along = force - towards;
    (towards / perpendicular_drag(gap) + along / parallel_drag(gap)) / (6.0 * PI * viscosity * radius)
}

impl PairMobility {
    /// Adds to the velocities `vi` and `vj` (m/s) of two beads what their forces (N) do to each other; `r` (m) from j to i.
    pub(super) fn add(self, r: Vec3, radius: [f64; 2], viscosity: f64, force: [Vec3; 2]) -> [Vec3; 2] {
        let contact = radius[0] + radius[1];
        let distance = r.norm();
        if self == Self::None || distance == 0.0 {
            return [Vec3::zeros(); 2];
        }
        let n = r / distance;
        let far = distance.max(contact);
        let squares = (radius[0].powi(2) + radius[1].powi(2)) / (far * far);
        let prager =
            |f: Vec3| (f * (1.0 + squares / 3.0) + n * ((1.0 - squares) * f.dot(&n))) / (8.0 * PI * viscosity * far);
        let mut v = [prager(force[1]), prager(force[0])];
        if self == Self::Squeeze {
            let x = 2.0 * far / contact;
            let beyond = squeeze_mobility(x) - (1.0 - 1.5 / x + 1.0 / (x * x * x));
            let mean = 0.5 * contact;
            let push = 0.5 * (force[0] - force[1]).dot(&n) * beyond / (6.0 * PI * viscosity * mean);
            v[0] += n * push;
            v[1] -= n * push;
        }
        v
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lubrication_meets_the_series() {
        let step = |f: fn(f64) -> f64, at: f64| (f(at * (1.0 - 1e-9)) / f(at * (1.0 + 1e-9)) - 1.0).abs();
        assert!(step(perpendicular_drag, 1e-3) < 1e-6);
        let gap = 1e-4;
        assert!((squeeze_mobility(2.0 + gap) / (2.0 * gap) - 1.0).abs() < 2e-3);
    }
}
