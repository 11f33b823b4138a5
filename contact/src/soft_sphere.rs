//! The soft-sphere law: a repulsion that dies at a cut-off.

use crate::ContactError;

/// How the law ends at its cut-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutOff {
    /// Force and slope go to zero at the cut-off, and below half the cut-off the force goes on as a straight line, so
    /// that its stiffness is bounded; the force has a continuous first derivative everywhere.
    Smooth,
    /// The bare power law, which jumps to zero at the cut-off: the paper's form.
    Unshifted,
}

/// Repulsion of potential a/r^n, cut at `r_c`: force n a/r^(n+1) on a node at distance r (ESPResSo's soft-sphere
/// interaction, Limbach et al. 2006).
///
/// In the smooth form the force is F(r) - F(r_c) - F'(r_c) (r - r_c), and below r_c/2 a straight line of the slope there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SoftSphere {
    strength: f64,
    exponent: f64,
    cutoff: f64,
    form: CutOff,
}

impl SoftSphere {
    /// `strength` a in J m^n, `exponent` n, `cutoff` in m; smooth at the cut-off.
    ///
    /// # Errors
    /// [`ContactError::NotPositive`].
    pub fn new(strength: f64, exponent: f64, cutoff: f64) -> Result<Self, ContactError> {
        for (what, value) in [
            ("the strength of the soft sphere", strength),
            ("the exponent of the soft sphere", exponent),
            ("the cut-off of the soft sphere (m)", cutoff),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(ContactError::NotPositive { what, value });
            }
        }
        Ok(Self {
            strength,
            exponent,
            cutoff,
            form: CutOff::Smooth,
        })
    }

    /// The same in the units of the paper's software: `strength` in nN um^(n+1), `cutoff` in um.
    ///
    /// # Errors
    /// [`ContactError::NotPositive`].
    pub fn from_nanonewton_micrometre(strength: f64, exponent: f64, cutoff: f64) -> Result<Self, ContactError> {
        Self::new(strength * 1e-15 * 1e-6_f64.powf(exponent), exponent, cutoff * 1e-6)
    }

    /// Cell against wall in the samples of the paper's software: a = 1e-4, n = 1.2, cut at 0.1 um.
    pub fn paper_wall() -> Self {
        Self::paper(1e-4, 1.2, 0.1)
    }

    /// Cell against cell in the samples of the paper's software: a = 5e-3, n = 2, cut at 0.3 um.
    pub fn paper_cell() -> Self {
        Self::paper(5e-3, 2.0, 0.3)
    }

    fn paper(strength: f64, exponent: f64, cutoff: f64) -> Self {
        Self {
            strength: strength * 1e-15 * 1e-6_f64.powf(exponent),
            exponent,
            cutoff: cutoff * 1e-6,
            form: CutOff::Smooth,
        }
    }

    /// The form at the cut-off.
    pub fn with_cut_off(mut self, form: CutOff) -> Self {
        self.form = form;
        self
    }

    /// Forces `factor` times as great.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.strength *= factor;
        self
    }

    /// Distance beyond which there is no force, m.
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    fn power(&self, r: f64) -> f64 {
        self.exponent * self.strength / r.powf(self.exponent + 1.0)
    }

    fn power_slope(&self, r: f64) -> f64 {
        -(self.exponent + 1.0) * self.power(r) / r
    }

    /// Slope of the smooth force at and below half the cut-off, N/m.
    fn core_slope(&self) -> f64 {
        self.power_slope(0.5 * self.cutoff) - self.power_slope(self.cutoff)
    }

    /// Repulsive force (N) at distance `r` (m); zero from the cut-off on.
    pub fn force(&self, r: f64) -> f64 {
        if r >= self.cutoff {
            return 0.0;
        }
        match self.form {
            CutOff::Unshifted => self.power(r),
            CutOff::Smooth => {
                let core = 0.5 * self.cutoff;
                let outer = r.max(core);
                let shift = self.power(self.cutoff) + self.power_slope(self.cutoff) * (outer - self.cutoff);
                self.power(outer) - shift + self.core_slope() * (r - core).min(0.0)
            }
        }
    }

    /// Potential (J) at distance `r` (m): zero at the cut-off in the smooth form, a/r^n in the unshifted one.
    pub fn energy(&self, r: f64) -> f64 {
        if r >= self.cutoff {
            return 0.0;
        }
        let bare = |r: f64| self.strength / r.powf(self.exponent);
        match self.form {
            CutOff::Unshifted => bare(r),
            CutOff::Smooth => {
                let core = 0.5 * self.cutoff;
                let outer = r.max(core);
                let away = outer - self.cutoff;
                let shift = self.power(self.cutoff) * away + 0.5 * self.power_slope(self.cutoff) * away * away;
                let depth = (core - r).max(0.0);
                let straight = self.force(core) * depth - 0.5 * self.core_slope() * depth * depth;
                bare(outer) - bare(self.cutoff) + shift + straight
            }
        }
    }

    /// Greatest stiffness (N/m) of the smooth form; the unshifted one has no bound, this is its value at half the
    /// cut-off.
    pub fn stiffness(&self) -> f64 {
        match self.form {
            CutOff::Smooth => -self.core_slope(),
            CutOff::Unshifted => -self.power_slope(0.5 * self.cutoff),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_paper_force_jumps_by_19_piconewton_at_the_cut() {
        let law = SoftSphere::paper_wall().with_cut_off(CutOff::Unshifted);
        assert_relative_eq!(law.force(0.1e-6 * (1.0 - 1e-12)), 19.02e-12, max_relative = 1e-3);
        assert_eq!(law.force(0.1e-6), 0.0);
    }

    #[test]
    fn the_smooth_force_and_its_slope_are_continuous() {
        let law = SoftSphere::paper_wall();
        let (cut, core, e) = (law.cutoff(), 0.5 * law.cutoff(), 1e-13);
        assert!(law.force(cut - e) < 1e-10 * law.force(core));
        assert!(law.force(cut - 1e4 * e) < 1e-3 * law.force(core));
        let below = (law.force(core - e) - law.force(core - 2.0 * e)) / e;
        let above = (law.force(core + 2.0 * e) - law.force(core + e)) / e;
        assert_relative_eq!(below, above, max_relative = 1e-4);
        assert_relative_eq!(-below, law.stiffness(), max_relative = 1e-6);
    }

    #[test]
    fn force_is_minus_the_slope_of_the_energy() {
        for form in [CutOff::Smooth, CutOff::Unshifted] {
            let law = SoftSphere::paper_cell().with_cut_off(form);
            for r in [0.05e-6, 0.1e-6, 0.16e-6, 0.25e-6] {
                let h = 1e-12;
                let slope = (law.energy(r + h) - law.energy(r - h)) / (2.0 * h);
                assert_relative_eq!(law.force(r), -slope, max_relative = 1e-6);
            }
        }
    }

    #[test]
    fn a_law_without_strength_is_refused() {
        let error = SoftSphere::new(0.0, 1.2, 1e-7).expect_err("no strength");
        assert!(error.to_string().contains("strength"));
    }
}
