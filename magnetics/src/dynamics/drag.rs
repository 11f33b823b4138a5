//! Drag of spheres near walls and near each other, over the Stokes drag 6 pi eta a.

use lbm_ibm_coupling::Vec3;
use std::f64::consts::PI;

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

/// Drag of a sphere towards a plane wall at gap over radius `gap`, the rational fit (6 g2 + 9 g + 2)/(6 g2 + 2 g) of Bevan
/// and Prieve (2000): within 0.8 % of [`perpendicular_drag`].
pub fn bevan_prieve_drag(gap: f64) -> f64 {
    (6.0 * gap * gap + 9.0 * gap + 2.0) / (6.0 * gap * gap + 2.0 * gap)
}

/// Drag of a sphere along a plane wall at gap over radius `gap`: Faxen's five terms (1923), good from a gap of 0.05 on.
pub fn faxen_drag(gap: f64) -> f64 {
    let y = 1.0 / (1.0 + gap);
    1.0 / (1.0 - y * (9.0 / 16.0 - y * y * (1.0 / 8.0 - y * (45.0 / 256.0 + y / 16.0))))
}

/// Drag of a sphere along a plane wall at gap over radius `gap` in lubrication, -8/15 ln(gap) + 0.9588 (Goldman, Cox and
/// Brenner 1967), good below a gap of 0.03.
pub fn near_wall_drag(gap: f64) -> f64 {
    0.9588 - 8.0 / 15.0 * gap.ln()
}

/// Drag of a sphere along a plane wall at gap over radius `gap`: the greater of [`faxen_drag`] and [`near_wall_drag`],
/// within 3 %.
pub fn parallel_drag(gap: f64) -> f64 {
    faxen_drag(gap).max(near_wall_drag(gap))
}

/// Which drag a bead has towards a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum WallDrag {
    /// [`perpendicular_drag`], exact.
    #[default]
    Brenner,
    /// [`bevan_prieve_drag`], cheaper.
    BevanPrieve,
}

impl WallDrag {
    /// Drag factor towards a plane wall at gap over radius `gap`.
    pub fn perpendicular(self, gap: f64) -> f64 {
        match self {
            Self::Brenner => perpendicular_drag(gap),
            Self::BevanPrieve => bevan_prieve_drag(gap),
        }
    }
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
