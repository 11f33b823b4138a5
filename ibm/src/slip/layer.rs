//! Where markers have to be, and how nodes slip, where the fluid inside has another viscosity.

use crate::kernel::Kernel;

/// Parts of a spacing in which profiles across the surface are summed up.
const PARTS: usize = 100;
/// Halvings of the interval in which the depth is.
const HALVINGS: usize = 40;

/// How markers and nodes of a surface stand to it, in grid spacings.
///
/// Across a flat surface at `y = 0`, the fluid of viscosity `l mu` below it, let the shear stress be `t` above and `t + q` below, `q` the tangential
/// force on the area. Markers at `-d` spread the force over the kernel, a share `H(y)` of it above `y`. The fluid's viscosity goes over from
/// one to the other with the share of each node's cube below the surface; layers in line have a `1/mu(y)` that goes with the mean share `X(y)` of such cubes. So the fluid is
/// sheared by `(t + q H) (1 + (1/l - 1) X)/mu`, where it should be sheared by `t/mu` above and by `(t + q)/(l mu)` below. Summed up over `y`, the velocities
/// on both sides, each carried on to the surface, come apart by `(q/mu) (m (1 - 1/l) - d)`, with `m` the integral of `(1 - H) X`;
/// and a kernel at `-d` reads the velocity of the upper side, carried on to the surface, but for `(t/mu) (m (1 - 1/l) - d) - (q/mu) s`,
/// `s` the integral of `H (1 - H) (1 + (1/l - 1) X)`. At the depth `d = m (1 - 1/l)`, on which `m` depends, both sides move
/// as one, whatever the stress, and nodes have to slip by `s q/mu`. Markers of a surface around a fluid of less viscosity lie outside of it.
/// The lattice's cut nodes have the mean viscosity by their share, which is stiffer to shear than layers in line: the sides come apart by another
/// `(t/mu) ((1 + 1/l)/2 - ln l/(l - 1))`, 0.2 spacings at `l = 5`. That is of the fluid alone, and no place of the markers mends it. Without
/// a contrast the depth is none and `s` is [`Kernel::hydrodynamic_shift`], to which the kernel's width is fitted here: oblique surfaces meet it
/// a little wider than along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layer {
    /// Of the markers below the surface.
    pub depth: f64,
    /// Slip length over that of the viscosity around.
    pub slip: f64,
}

impl Layer {
    /// For a viscosity inside of `ratio` times that around.
    pub fn of(kernel: Kernel, ratio: f64) -> Self {
        let slip = kernel.hydrodynamic_shift();
        if ratio == 1.0 {
            return Self { depth: 0.0, slip };
        }
        let profile = Profile::new(kernel);
        // The deeper the markers, the less of the force is above them: one crossing, within the reach of both profiles.
        let beyond = |depth: f64| profile.mean_share(depth) * (1.0 - 1.0 / ratio) - depth;
        let (mut low, mut high) = (-profile.reach, profile.reach);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if beyond(middle) > 0.0 {
                low = middle
            } else {
                high = middle
            }
        }
        let depth = 0.5 * (low + high);
        Self {
            depth,
            slip: profile.slip(depth, ratio),
        }
    }
}

/// A kernel across a flat surface, as the mean over places in a cell.
struct Profile {
    /// Share of the kernel below the edges of parts of its stretched spacings, from its lower end on.
    below: Vec<f64>,
    /// Half its width, and length of a part.
    half: f64,
    part: f64,
    /// Beyond which there is nothing of the kernel, wherever the markers are sought, nor of the share.
    reach: f64,
}

impl Profile {
    fn new(kernel: Kernel) -> Self {
        let support = kernel.support();
        let mut density = vec![0.0; support * PARTS];
        for n in 0..PARTS {
            // A marker in the middle of a part; its stencil's nodes are whole spacings apart.
            let at = (n as f64 + 0.5) / PARTS as f64;
            let (lower, weights) = kernel.stencil(at);
            for (k, w) in weights[..support].iter().enumerate() {
                let from_end = (lower + k as i64) as f64 - at + 0.5 * support as f64;
                density[((from_end * PARTS as f64) as usize).min(support * PARTS - 1)] += w / PARTS as f64;
            }
        }
        let mut below = vec![0.0];
        for w in &density {
            below.push(below[below.len() - 1] + w);
        }
        let mut profile = Self {
            below,
            half: 0.5 * support as f64,
            part: 1.0 / PARTS as f64,
            reach: 0.0,
        };
        profile.reach = 2.0 * profile.half + 2.0;
        let stretch = kernel.hydrodynamic_shift() / profile.slip(0.0, 1.0);
        profile.half *= stretch;
        profile.part *= stretch;
        profile.reach = 2.0 * profile.half + 2.0;
        profile
    }

    /// Share of the kernel of a marker at 0 below `y`.
    fn below(&self, y: f64) -> f64 {
        let s = ((y + self.half) / self.part).clamp(0.0, (self.below.len() - 1) as f64);
        let n = (s as usize).min(self.below.len() - 2);
        self.below[n] + (self.below[n + 1] - self.below[n]) * (s - n as f64)
    }

    /// Sums up over `y`.
    fn sum(&self, f: impl Fn(f64) -> f64) -> f64 {
        let n = (2.0 * self.reach * PARTS as f64) as usize;
        let dy = 2.0 * self.reach / n as f64;
        (0..n).map(|i| f((i as f64 + 0.5) * dy - self.reach)).sum::<f64>() * dy
    }

    /// Integral of `(1 - H) X` for markers at a depth.
    fn mean_share(&self, depth: f64) -> f64 {
        self.sum(|y| self.below(y + depth) * share(y))
    }

    /// Integral of `H (1 - H) (1 + (1/l - 1) X)` for markers at a depth.
    fn slip(&self, depth: f64, ratio: f64) -> f64 {
        self.sum(|y| {
            let below = self.below(y + depth);
            below * (1.0 - below) * (1.0 + (1.0 / ratio - 1.0) * share(y))
        })
    }
}

/// Share of a cube with its middle at `y` below the surface.
fn share(y: f64) -> f64 {
    (0.5 - y).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One fluid seen from either side: what is inside of the one is outside of the other.
    #[test]
    fn both_sides_are_alike() {
        for kernel in Kernel::ALL {
            for ratio in [2.0, 5.0, 20.0] {
                let (thick, thin) = (Layer::of(kernel, ratio), Layer::of(kernel, 1.0 / ratio));
                assert!(
                    (thick.depth + thin.depth).abs() < 1e-3,
                    "{kernel:?} {ratio}: {thick:?} {thin:?}"
                );
                assert!(
                    (thick.slip * ratio / thin.slip - 1.0).abs() < 1e-2,
                    "{kernel:?} {ratio}: {thick:?} {thin:?}"
                );
            }
        }
    }

    /// The share of a cube adds a twelfth to the variance of the kernel, and a small contrast needs half the mean distance of the two.
    #[test]
    fn a_small_contrast_needs_a_small_depth() {
        for kernel in Kernel::ALL {
            let layer = Layer::of(kernel, 1.001);
            let slip = kernel.hydrodynamic_shift();
            assert!((layer.slip / slip - 1.0).abs() < 1e-2, "{kernel:?} {layer:?}");
            assert!(
                layer.depth > 0.0 && layer.depth < 1e-3 * (slip + 0.5),
                "{kernel:?} {layer:?}"
            );
        }
    }
}
