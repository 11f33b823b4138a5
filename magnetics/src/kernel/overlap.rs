//! The interaction of two uniformly magnetised balls at any distance.
//!
//! With U(r) the mutual potential of two balls of unit charge, the field of ball j averaged over ball i is grad grad U m_j.
//! Apart, U = 1/r and the balls are point dipoles. Overlapping, r U'' and so on follow from the overlap volume: U =
//! w0/r + w1 + w2 r + w3 r^2 + w4 r^3 + w6 r^5 with c = a + b, d = a - b. Since the energy is that of a real magnetisation,
//! mu0/2 int H^2, mutual induction with it is positive definite for every arrangement and permeability: no overlap gives
//! an infinite moment.

use lbm_ibm_coupling::Vec3;

/// The derivatives p_k = (1/r d/dr)^k U of the pair potential.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overlap {
    p1: f64,
    p2: f64,
    p3: f64,
}

impl Overlap {
    /// Point dipoles at distance `r`.
    pub fn point(r: f64) -> Self {
        let i2 = 1.0 / (r * r);
        let i3 = i2 / r;
        Self {
            p1: -i3,
            p2: 3.0 * i3 * i2,
            p3: -15.0 * i3 * i2 * i2,
        }
    }

    /// Balls of radii `a` and `b` at distance `r`.
    pub fn balls(a: f64, b: f64, r: f64) -> Self {
        let (c, d) = (a + b, a - b);
        if r >= c {
            return Self::point(r);
        }
        if r <= d.abs() {
            return Self {
                p1: -1.0 / a.max(b).powi(3),
                p2: 0.0,
                p3: 0.0,
            };
        }
        let r = r.max(1e-9 * c);
        let (c2, d2) = (c * c, d * d);
        let scale = 1.0 / (c2 - d2).powi(3);
        let w0 = d2 * d2 * (3.0 * c2 - d2) * scale;
        let w2 = 18.0 * c2 * d2 * scale;
        let w3 = -12.0 * c * (c2 / 3.0 + d2) * scale;
        let w4 = 3.0 * (c2 + d2) * scale;
        let w6 = -0.4 * scale;
        let i1 = 1.0 / r;
        let (i3, i5) = (i1.powi(3), i1.powi(5));
        Self {
            p1: -w0 * i3 + w2 * i1 + 2.0 * w3 + 3.0 * w4 * r + 5.0 * w6 * r.powi(3),
            p2: 3.0 * w0 * i5 - w2 * i3 + 3.0 * w4 * i1 + 15.0 * w6 * r,
            p3: -15.0 * w0 * i5 * i1 * i1 + 3.0 * w2 * i5 - 3.0 * w4 * i3 + 15.0 * w6 * i1,
        }
    }

    /// 4 pi times the field at distance vector `r` from moment `m`.
    pub fn field(&self, m: Vec3, r: Vec3) -> Vec3 {
        m * self.p1 + r * (self.p2 * m.dot(&r))
    }

    /// 4 pi times the force on moment `on` at distance vector `r` from moment `by`.
    pub fn force(&self, on: Vec3, by: Vec3, r: Vec3) -> Vec3 {
        let (p, q) = (on.dot(&r), by.dot(&r));
        (on * q + by * p + r * on.dot(&by)) * self.p2 + r * (self.p3 * p * q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_pieces_meet_and_the_force_is_the_gradient_of_the_energy() {
        let (m, n) = (Vec3::new(0.3, 1.0, -0.4), Vec3::new(-0.2, 0.5, 0.8));
        for (a, b) in [(1.0f64, 1.0), (1.0, 1.0 + 1e-7), (1.0, 1.5), (2.0, 0.5)] {
            for edge in [a + b, f64::abs(a - b)] {
                let (inner, outer) = (Overlap::balls(a, b, edge - 1e-9), Overlap::balls(a, b, edge + 1e-9));
                if edge > 1e-3 {
                    assert_relative_eq!(inner.p1, outer.p1, max_relative = 1e-6);
                }
            }
            for d in [1e-6, 0.01, 0.3, 0.7, 1.4, 1.7, 1.99, 2.3, 2.6] {
                let r = Vec3::new(0.48, 0.6, 0.64) * d;
                let energy = |r: Vec3| -m.dot(&Overlap::balls(a, b, r.norm()).field(n, r));
                let force = Overlap::balls(a, b, d).force(m, n, r);
                let h = 1e-4 * d.min(0.1);
                for c in 0..3 {
                    let e = Vec3::ith(c, h);
                    let fd = (energy(r - e) - energy(r + e)) / (2.0 * h);
                    assert_relative_eq!(fd, force[c], epsilon = 2e-6);
                }
            }
        }
    }

    #[test]
    fn coincident_equal_balls_have_the_demagnetising_field() {
        // H = -M/3 inside, that is -m/(4 pi a^3): without 4 pi, -1/a^3.
        let field = Overlap::balls(2.0, 2.0, 0.0).field(Vec3::z(), Vec3::zeros());
        assert_relative_eq!(field.z, -1.0 / 8.0, max_relative = 1e-8);
    }
}
