//! Sets of lattice velocities.

/// Most velocities of a stencil.
pub(crate) const MAX_Q: usize = 27;

/// A set of lattice velocities: the one at rest first, then opposite pairs side by side, `2p + 1` and `2p + 2`.
///
/// Components are -1, 0 or 1, and there are at most 27; a stencil that breaks these rules does not compile into a
/// [`Fluid`](crate::Fluid).
pub trait Stencil<const Q: usize>: 'static {
    /// Velocities, lattice units.
    const C: [[i32; 3]; Q];
    /// Weights.
    const W: [f64; Q];
}

/// The population that moves the other way.
pub const fn opposite(i: usize) -> usize {
    if i == 0 { 0 } else { ((i - 1) ^ 1) + 1 }
}

/// Nineteen velocities in space: rest, along the axes and the diagonals of their planes.
#[derive(Clone, Copy, Debug)]
pub struct D3Q19;

impl Stencil<19> for D3Q19 {
    const C: [[i32; 3]; 19] = [
        [0, 0, 0],
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [0, 0, 1],
        [0, 0, -1],
        [1, 1, 0],
        [-1, -1, 0],
        [1, -1, 0],
        [-1, 1, 0],
        [1, 0, 1],
        [-1, 0, -1],
        [1, 0, -1],
        [-1, 0, 1],
        [0, 1, 1],
        [0, -1, -1],
        [0, 1, -1],
        [0, -1, 1],
    ];
    const W: [f64; 19] = {
        let mut w = [1.0 / 36.0; 19];
        w[0] = 1.0 / 3.0;
        let mut i = 1;
        while i < 7 {
            w[i] = 1.0 / 18.0;
            i += 1;
        }
        w
    };
}

/// Twenty-seven velocities in space: all with components -1, 0 and 1. Isotropic to fifth order, as [`D3Q19`] is, but its
/// weights are a product of one for each axis, so that no moment of a Maxwellian up to second order in each component is lost.
#[derive(Clone, Copy, Debug)]
pub struct D3Q27;

impl Stencil<27> for D3Q27 {
    const C: [[i32; 3]; 27] = {
        let mut c = [[0; 3]; 27];
        let mut i = 0;
        while i < 19 {
            c[i] = D3Q19::C[i];
            i += 1;
        }
        let corners = [[1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1]];
        let mut p = 0;
        while p < 4 {
            let [x, y, z] = corners[p];
            c[19 + 2 * p] = [x, y, z];
            c[20 + 2 * p] = [-x, -y, -z];
            p += 1;
        }
        c
    };
    const W: [f64; 27] = product_weights(&Self::C, 3);
}

/// Nine velocities in the plane of x and y, for a grid one node thick that repeats in z. Motion and force along z are none of
/// its business: they stay zero.
#[derive(Clone, Copy, Debug)]
pub struct D2Q9;

impl Stencil<9> for D2Q9 {
    const C: [[i32; 3]; 9] = [
        [0, 0, 0],
        [1, 0, 0],
        [-1, 0, 0],
        [0, 1, 0],
        [0, -1, 0],
        [1, 1, 0],
        [-1, -1, 0],
        [1, -1, 0],
        [-1, 1, 0],
    ];
    const W: [f64; 9] = product_weights(&Self::C, 2);
}

/// For each of the first axes 2/3 at rest and 1/6 in motion.
const fn product_weights<const Q: usize>(c: &[[i32; 3]; Q], axes: usize) -> [f64; Q] {
    let mut w = [1.0; Q];
    let mut i = 0;
    while i < Q {
        let mut a = 0;
        while a < axes {
            w[i] *= if c[i][a] == 0 { 2.0 / 3.0 } else { 1.0 / 6.0 };
            a += 1;
        }
        i += 1;
    }
    w
}

/// A stencil at run time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Velocities {
    c: &'static [[i32; 3]],
    w: &'static [f64],
}

impl Velocities {
    /// Those of a stencil; one that breaks the rules of [`Stencil`] does not compile.
    pub const fn of<S: Stencil<Q>, const Q: usize>() -> Self {
        const {
            assert!(
                Q % 2 == 1 && Q <= MAX_Q,
                "a stencil has an odd number of velocities, 27 at most"
            );
            let (mut i, c) = (0, S::C);
            while i < Q {
                let mut a = 0;
                while a < 3 {
                    assert!(c[i][a] >= -1 && c[i][a] <= 1, "a velocity has components -1, 0 and 1");
                    assert!(c[opposite(i)][a] == -c[i][a], "opposite velocities are side by side");
                    a += 1;
                }
                i += 1;
            }
        }
        Self {
            c: const { &S::C },
            w: const { &S::W },
        }
    }

    /// Number of populations of a node.
    pub fn q(&self) -> usize {
        self.c.len()
    }

    /// Lattice velocity `i`.
    #[inline]
    pub fn c(&self, i: usize) -> [i32; 3] {
        self.c[i]
    }

    /// Weight of population `i`.
    #[inline]
    pub fn weight(&self, i: usize) -> f64 {
        self.w[i]
    }

    /// `c_i . v`.
    #[inline]
    pub fn along(&self, i: usize, v: [f64; 3]) -> f64 {
        let c = self.c[i];
        f64::from(c[0]) * v[0] + f64::from(c[1]) * v[1] + f64::from(c[2]) * v[2]
    }
}

/// Writes a block out for each opposite pair `i`, `i + 1` of `Q` velocities, so that what depends on the velocity is known when it is
/// compiled: a loop of so many turns compilers leave as it is.
macro_rules! each_pair {
    ($q:ident, $i:ident, $body:block) => { each_pair!($q, $i, $body: 1 3 5 7 9 11 13 15 17 19 21 23 25); };
    ($q:ident, $i:ident, $body:block: $($n:literal)*) => {
        $(
            if $n < $q {
                let $i = $n;
                $body
            }
        )*
    };
}
pub(crate) use each_pair;

/// Density (about 1, less 1) and momentum of a node.
#[inline(always)]
pub(crate) fn moments<S: Stencil<Q>, V: crate::Real, const Q: usize>(f: &[V; Q]) -> (V, [V; 3]) {
    let (mut density, mut momentum) = (f[0], [f[0].like(0.0); 3]);
    each_pair!(Q, i, {
        let (s, d) = (f[i] + f[i + 1], f[i] - f[i + 1]);
        density = density + s;
        for a in 0..3 {
            match S::C[i][a] {
                1 => momentum[a] = momentum[a] + d,
                -1 => momentum[a] = momentum[a] - d,
                _ => {}
            }
        }
    });
    (density, momentum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moments_of_the_weights_are_those_of_an_isotropic_lattice() {
        let v = Velocities::of::<D3Q19, 19>();
        assert!(((0..v.q()).map(|i| v.weight(i)).sum::<f64>() - 1.0).abs() < 1e-15);
        for a in 0..3 {
            for b in 0..3 {
                let second: f64 = (0..v.q()).map(|i| v.weight(i) * f64::from(v.c(i)[a] * v.c(i)[b])).sum();
                assert!((second - if a == b { 1.0 / 3.0 } else { 0.0 }).abs() < 1e-15);
            }
        }
    }

    /// Moments of the weights are those of a Maxwellian, to fifth order.
    #[test]
    fn stencils_are_isotropic() {
        fn check<S: Stencil<Q>, const Q: usize>(axes: usize) {
            for i in 1..Q {
                assert_eq!(S::C[opposite(i)], S::C[i].map(|c| -c));
            }
            for n in 0..6_u32.pow(3) {
                let powers = [n % 6, n / 6 % 6, n / 36];
                if powers.iter().sum::<u32>() > 5 || powers[axes..].iter().any(|p| *p > 0) {
                    continue;
                }
                let one = |i: usize| (0..3).map(|a| f64::from(S::C[i][a].pow(powers[a]))).product::<f64>();
                let sum: f64 = (0..Q).map(|i| S::W[i] * one(i)).sum();
                let exact: f64 = powers
                    .iter()
                    .map(|p| [1.0, 0.0, 1.0 / 3.0, 0.0, 1.0 / 3.0, 0.0][*p as usize])
                    .product();
                assert!((sum - exact).abs() < 1e-15, "{powers:?}: {sum} {exact}");
            }
        }
        check::<D2Q9, 9>(2);
        check::<D3Q19, 19>(3);
        check::<D3Q27, 27>(3);
    }
}
