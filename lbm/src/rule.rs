//! How a wall sends populations back.

use std::fmt;

/// A link that a wall cuts, as a [`LinkRule`] sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CutLink {
    /// Where the wall cuts it, as a fraction of the way from the fluid node to the solid one.
    pub fraction: f64,
    /// Whether there is a fluid node behind the fluid node, away from the wall, or an open face.
    pub behind: bool,
    /// Lattice velocity of the population that returns.
    pub velocity: [i32; 3],
    /// Its weight.
    pub weight: f64,
    /// Relaxation time of the shear, in time steps.
    pub tau: f64,
}

/// What returns from a cut link, as shares of populations.
///
/// With `f_o` the population that goes out to the wall and `f_i` the one that returns, `x` the fluid node and `y` the node behind
/// it, and a star after collision, `f_i(x, t + 1)` is
/// `f*_o(x) + arriving (f*_o(y) - f*_o(x)) + leaving (f*_i(x) - f*_o(x)) + push 6 w_i c_i.u_wall`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Of the population that goes to the wall from the node behind.
    pub arriving: f64,
    /// Of the one that leaves the wall from the node itself.
    pub leaving: f64,
    /// Factor of what a moving wall adds.
    pub push: f64,
}

impl Shares {
    /// Those of halfway bounce-back.
    pub const HALFWAY: Self = Self {
        arriving: 0.0,
        leaving: 0.0,
        push: 1.0,
    };
}

/// How walls send populations back; [`WallRule`] has the usual ones.
///
/// It is asked once for each link when walls are set, so it may be as slow as it likes. A wall that the rule takes to be half
/// way should have [`Shares::HALFWAY`] to the last bit: such a link costs nothing.
///
/// Shares are kept as they are, but in pores and narrow tubes whose links are cut in over 16384 different ways, so that a list of those
/// would take more memory: there `arriving` is kept to 2^-32 of the greatest, and so is `leaving` if it is its opposite everywhere. With
/// [`WallRule::Cli`] a wall then stands elsewhere by 5e-10 of a link at most.
///
/// ```
/// use lbm_ibm_lbm::{CutLink, LinkRule, Shares};
///
/// /// Bouzidi's where the wall is near, else halfway.
/// #[derive(Debug)]
/// struct NearWalls;
///
/// impl LinkRule for NearWalls {
///     fn shares(&self, link: &CutLink) -> Option<Shares> {
///         let near = link.fraction < 0.5;
///         let arriving = if near { 1.0 - 2.0 * link.fraction } else { 0.0 };
///         (link.behind || !near).then_some(Shares { arriving, ..Shares::HALFWAY })
///     }
/// }
/// ```
pub trait LinkRule: fmt::Debug + Send + Sync {
    /// The shares of a link; none where the rule would need the node behind and there is none: such a link is halfway, and
    /// counted in [`WallReport::uninterpolated_links`](lbm_ibm_coupling::WallReport::uninterpolated_links).
    fn shares(&self, link: &CutLink) -> Option<Shares>;

    /// Whether it asks where walls cut links. If not, every fraction is 1/2, moving walls are not balanced (see
    /// [`WallRule`]), and walls are set faster.
    fn interpolates(&self) -> bool {
        true
    }
}

/// What a wall sends back along a link that it cuts at the fraction `q` of the way from the fluid node to the solid one.
///
/// All rules know where the wall is to second order, if it is where the rule takes it to be. The outgoing population is
/// `f_o`, the returning one `f_i`, the fluid node `x`, and `y` the node behind it, away from the wall; a star is after
/// collision. A wall that moves on itself adds `6 w_i c_i.u_wall`, times a factor of the rule, with `u_wall` taken where the
/// link is cut.
///
/// A link whose cut is half way is sent back alike by all three. One without a fluid node behind, where two walls are less
/// than two nodes apart, is halfway under every rule that needs that node; their number is in
/// [`WallReport::uninterpolated_links`](lbm_ibm_coupling::WallReport::uninterpolated_links).
///
/// Mass: [`WallRule::Halfway`] keeps it, to rounding, where walls rest or are flat and along the grid; a turning wall adds
/// or takes a little, for good. The other two rules do not keep it link by link. Interpolated walls give way by a normal
/// velocity, the same everywhere, that takes back in each step 1/256 of what their links have gained since the start, so
/// that the mass of the fluid stays within a few hundred steps' gain of what it was; what walls add by turning is balanced
/// link by link. The balance is that of the whole fluid: between parts that walls part altogether mass may shift.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum WallRule {
    /// Halfway bounce-back (Ladd 1994), `f_i(x) = f*_o(x)`: the wall is taken to be half way, wherever it is. For flat walls
    /// along the grid.
    Halfway,
    /// Linear interpolation of Bouzidi, Firdaouss and Lallemand (2001): `2 q f*_o(x) + (1 - 2 q) f*_o(y)` where `q` is less
    /// than 1/2, else `(f*_o(x) + (2 q - 1) f*_i(x))/(2 q)`. The wall moves with tau.
    Bouzidi,
    /// Central linear interpolation, CLI (Ginzburg, Verhaeghe and d'Humieres 2008):
    /// `f*_o(x) + (1 - 2 q)/(1 + 2 q) (f*_o(y) - f*_i(x))`. In a steady flow without inertia at a fixed magic number the
    /// wall does not move with tau. For curved and inclined walls; where the wall is half way, it is [`WallRule::Halfway`].
    #[default]
    Cli,
}

/// A cut this close to half way is half way.
const SAME: f64 = 1e-8;

impl LinkRule for WallRule {
    fn shares(&self, link: &CutLink) -> Option<Shares> {
        let q = link.fraction;
        if *self == Self::Halfway || (q - 0.5).abs() < SAME {
            return Some(Shares::HALFWAY);
        }
        match self {
            Self::Bouzidi if q >= 0.5 => {
                let leaving = 1.0 - 0.5 / q;
                Some(Shares {
                    arriving: 0.0,
                    leaving,
                    push: 1.0 - leaving,
                })
            }
            _ if !link.behind => None,
            Self::Bouzidi => Some(Shares {
                arriving: 1.0 - 2.0 * q,
                ..Shares::HALFWAY
            }),
            _ => {
                let k = (1.0 - 2.0 * q) / (1.0 + 2.0 * q);
                Some(Shares {
                    arriving: k,
                    leaving: -k,
                    push: 1.0 + k,
                })
            }
        }
    }

    fn interpolates(&self) -> bool {
        *self != Self::Halfway
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(fraction: f64, behind: bool) -> CutLink {
        CutLink {
            fraction,
            behind,
            velocity: [1, 0, 0],
            weight: 1.0 / 18.0,
            tau: 1.0,
        }
    }

    /// A linear shear with its zero at the cut, at a relaxation time of one, where collided populations are equilibria: `s`
    /// cells from the wall the one that leaves it is `s`, the one that goes to it `-s`. What returns has to be the one that
    /// leaves at the place from which it would come, `s = q - 1`.
    #[test]
    fn a_linear_shear_stays() {
        for rule in [WallRule::Cli, WallRule::Bouzidi] {
            for q in [0.1_f64, 0.3, 0.49, 0.51, 0.9, 1.0] {
                let shares = rule.shares(&link(q, true)).unwrap();
                let (own, arriving, leaving) = (-q, -(q + 1.0), q);
                let back = own + shares.arriving * (arriving - own) + shares.leaving * (leaving - own);
                assert!((back - (q - 1.0)).abs() < 1e-14, "{rule:?} {q}: {back}");
            }
        }
    }

    #[test]
    fn all_rules_are_one_half_way() {
        for rule in [WallRule::Halfway, WallRule::Bouzidi, WallRule::Cli] {
            assert_eq!(rule.shares(&link(0.5, false)), Some(Shares::HALFWAY));
        }
        assert_eq!(WallRule::Cli.shares(&link(0.3, false)), None);
        assert!(WallRule::Bouzidi.shares(&link(0.7, false)).is_some());
    }
}
