//! Central Hermite moments and those of the lattice.
//!
//! Hermite polynomials shift as powers do, `H_n(x + u) = sum binom(n, k) u^(n-k) H_k(x)` along each axis, and raw moments follow
//! from them by `c^2 = H_2 + 1/3`. The reference density being 1, a node's central moments are those of its populations less
//! the weights times the density's departure, which stays at rest: order 0 is 1, order 1 half the force (after collision),
//! and a Maxwellian has no other. All sums below leave out what the weights themselves have.

use crate::models::basis::{Corners, Raw19, raise_fourth, raise_low, raise_third};
use crate::models::low::{Low, PLANES, State, THIRDS, Third};
use crate::real::Real;

/// Central Hermite moments after collision; those of fourth order and above are zero.
pub struct Central<V> {
    pub density: V,
    pub u: [V; 3],
    /// Velocity of the frame: that of the fluid, or zero in a Stokes flow.
    pub v: [V; 3],
    pub half: [V; 3],
    /// As in [`State`].
    pub stress: [V; 6],
    pub third: Third<V>,
}

/// Central moments of third order before collision.
#[inline(always)]
pub fn third_before<V: Real, const FORCE: bool>(low: &Low<V>, third: &Third<V>, state: &State<V>) -> Third<V> {
    let third_part = low.density.like(1.0 / 3.0);
    let State { v, half, stress, .. } = state;
    let mut central = *third;
    for (n, [a, b, ab]) in THIRDS.into_iter().enumerate() {
        let hermite = low.momentum[a].neg_mul_add(third_part, third[n]);
        let second = low.density.neg_mul_add(third_part, low.second[b]);
        let mut inner = stress[ab] + stress[ab];
        if FORCE {
            inner = v[b].neg_mul_add(half[a], inner);
        }
        central[n] = v[b].neg_mul_add(inner, v[a].neg_mul_add(second, hermite));
    }
    let [x, y, z] = *v;
    let xz = if FORCE {
        z.neg_mul_add(half[0], stress[4])
    } else {
        stress[4]
    };
    let rest = z.neg_mul_add(stress[3], y.neg_mul_add(xz, third[6]));
    central[6] = x.neg_mul_add(low.second[5], rest);
    central
}

/// Hermite moments of the lattice, in the order of [`Low`].
struct Shifted<V> {
    momentum: [V; 3],
    second: [V; 6],
    third: [V; 6],
    /// `xyy` and so on before the shift along the first axis.
    third_partly: [V; 6],
    /// xxyy, xxzz, yyzz.
    fourth: [V; 3],
}

impl<V: Real> Central<V> {
    /// After the stress has been relaxed.
    #[inline(always)]
    pub fn new(state: State<V>, third: Third<V>) -> Self {
        Self {
            density: state.density,
            u: state.u,
            v: state.v,
            half: state.half,
            stress: state.stress,
            third,
        }
    }

    #[inline(always)]
    fn shifted<const FORCE: bool>(&self) -> Shifted<V> {
        let Self {
            u,
            v,
            half,
            stress,
            third: t,
            ..
        } = self;
        let (momentum, second) = lattice_second::<V, FORCE>(u, v, half, stress);
        let mut third = [self.density; 6];
        let mut third_partly = third;
        for (n, [a, b, ab]) in THIRDS.into_iter().enumerate() {
            let mut inner = stress[ab] + stress[ab];
            if FORCE {
                inner = v[b].mul_add(half[a], inner);
            }
            third_partly[n] = v[b].mul_add(inner, t[n]);
            third[n] = v[a].mul_add(second[b], third_partly[n]);
        }
        // The places of `a b b` and `b a a`.
        let places = [[0, 2], [1, 4], [3, 5]];
        let mut fourth = [self.density; 3];
        for p in 0..3 {
            let ([a, b], [abb, baa]) = (PLANES[p], places[p]);
            let outer = v[b] * v[b].mul_add(stress[a], t[baa] + t[baa]);
            let inner = v[a].mul_add(second[b], third_partly[abb] + third_partly[abb]);
            fourth[p] = v[a].mul_add(inner, outer);
        }
        Shifted {
            momentum,
            second,
            third,
            third_partly,
            fourth,
        }
    }

    #[inline(always)]
    fn raise(&self, s: &Shifted<V>) -> Raw19<V> {
        let mut fourth = raise_fourth(self.density, &s.second);
        for p in 0..3 {
            fourth[p] = fourth[p] + s.fourth[p];
        }
        Raw19 {
            low: raise_low(self.density, s.momentum, &s.second),
            third: raise_third(&s.momentum, Some(s.third)),
            fourth,
        }
    }

    /// Raw moments of the nineteen velocities; those of the plane of x and y among them are those of the nine.
    #[inline(always)]
    pub fn raw19<const FORCE: bool>(&self) -> Raw19<V> {
        self.raise(&self.shifted::<FORCE>())
    }

    /// The same, but of fourth order only what lower Hermite moments give on the nineteen velocities.
    #[inline(always)]
    pub fn raw19_to_third<const FORCE: bool>(&self) -> Raw19<V> {
        let s = self.shifted::<FORCE>();
        Raw19 {
            fourth: fourth19(self.density, &s.second),
            ..self.raise(&s)
        }
    }

    /// Raw moments of the twenty-seven velocities.
    #[inline(always)]
    pub fn raw27<const FORCE: bool>(&self) -> (Raw19<V>, Corners<V>) {
        let like = self.density;
        let (third_part, ninth) = (like.like(1.0 / 3.0), like.like(1.0 / 9.0));
        let Self {
            v,
            half,
            stress,
            third: t,
            ..
        } = self;
        let s = self.shifted::<FORCE>();
        let [xx, yy, zz, xy, xz, yz] = s.second;
        let across = [yz, xz, xy];
        let xyz = {
            let mut inner = stress[4];
            if FORCE {
                inner = v[2].mul_add(half[0], inner);
            }
            v[2].mul_add(stress[3], v[1].mul_add(inner, v[0].mul_add(yz, t[6])))
        };
        // Moments a a b c.
        let mut even = [self.density; 4];
        for (a, [b, c, baa, caa]) in [[1, 2, 2, 4], [0, 2, 0, 5], [0, 1, 1, 3]].into_iter().enumerate() {
            let partly = v[a].neg_mul_add(across[a], xyz);
            let outer = v[b].mul_add(v[c].mul_add(stress[a], t[caa]), v[c] * t[baa]);
            let hermite = v[a].mul_add(v[a].mul_add(across[a], partly + partly), outer);
            even[a + 1] = across[a].mul_add(third_part, hermite);
        }
        // Moments a b b c c.
        let mut odd = [self.density; 4];
        let mut first_partly = self.density;
        for (a, [b, c, abb, acc, bbcc]) in [[1, 2, 0, 1, 2], [0, 2, 2, 3, 1], [0, 1, 4, 5, 0]]
            .into_iter()
            .enumerate()
        {
            let (bb, cc, bc) = (v[b] * v[b], v[c] * v[c], v[b] * v[c]);
            let mut partly = bb.mul_add(s.third_partly[acc], cc * s.third_partly[abb]);
            partly = bc.mul_add(like.like(4.0) * t[6], partly);
            if FORCE {
                partly = (bb * cc).neg_mul_add(half[a], partly);
            }
            if a == 0 {
                first_partly = partly;
            }
            let hermite = v[a].mul_add(s.fourth[bbcc], partly);
            let lower = (s.third[abb] + s.third[acc]).mul_add(third_part, s.momentum[a] * ninth);
            odd[a] = hermite + lower;
        }
        odd[3] = xyz;
        let (x, bc) = (v[0], v[1] * v[2]);
        let half_thirds = v[2].mul_add(t[2], v[1] * t[4]);
        let thirds = half_thirds + half_thirds;
        let outer = bc * bc.mul_add(stress[0], thirds);
        let hermite = x.mul_add(x.mul_add(s.fourth[2], first_partly + first_partly), outer);
        let [p, q, r] = s.fourth;
        let lower = (xx + yy + zz).mul_add(ninth, self.density * like.like(1.0 / 27.0));
        even[0] = (p + q + r).mul_add(third_part, hermite + lower);
        (self.raise(&s), Corners { even, odd })
    }
}

/// Momentum after collision, and Hermite moments of second order, from the central ones.
#[inline(always)]
pub fn lattice_second<V: Real, const FORCE: bool>(
    u: &[V; 3],
    v: &[V; 3],
    half: &[V; 3],
    stress: &[V; 6],
) -> ([V; 3], [V; 6]) {
    let mut second = *stress;
    for a in 0..3 {
        let carried = if FORCE { u[a] + (half[a] + half[a]) } else { u[a] };
        second[a] = v[a].mul_add(carried, second[a]);
    }
    let mut momentum = *u;
    if FORCE {
        for a in 0..3 {
            momentum[a] = u[a] + half[a];
        }
    }
    for (p, [a, b]) in PLANES.into_iter().enumerate() {
        second[3 + p] = v[a].mul_add(momentum[b], second[3 + p]);
        if FORCE {
            second[3 + p] = v[b].mul_add(half[a], second[3 + p]);
        }
    }
    (momentum, second)
}

/// Raw moments of fourth order of the nineteen velocities from Hermite ones of second: with the orthogonal polynomials of this
/// stencil `xxyy` sees stress along z.
#[inline(always)]
pub fn fourth19<V: Real>(density: V, second: &[V; 6]) -> [V; 3] {
    let sixth = density.like(1.0 / 6.0);
    let mut fourth = raise_fourth(density, second);
    for p in 0..3 {
        fourth[p] = second[2 - p].neg_mul_add(sixth, fourth[p]);
    }
    fourth
}
