//! Fields at many points, eight at a time.

use super::FieldSource;
use crate::kernel::lanes::{self, Isa, LANES, Lanes, Work, minus, same, vectors};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};

/// Points that one task takes.
const BLOCK: usize = 2048;

/// Field and gradient (xx, xy, xz, yy, yz, zz) at eight points.
#[derive(Clone, Copy)]
pub(super) struct Eight<V> {
    pub field: [V; 3],
    pub gradient: [V; 6],
    /// Above zero where the formula does not hold and the source's own must be asked.
    pub special: V,
}

/// A source whose field has a form for eight points at once.
pub(super) trait Batch: FieldSource {
    /// At the points `x` (m); the gradient only where `GRADIENT`. Implementations are `#[inline(always)]`.
    fn eight<I: Isa, const GRADIENT: bool>(&self, isa: I, x: [I::V; 3]) -> Eight<I::V>;
}

impl<V: Lanes> Eight<V> {
    #[inline(always)]
    pub fn zero<I: Isa<V = V>>(isa: I) -> Self {
        let zero = isa.splat(0.0);
        Self {
            field: [zero; 3],
            gradient: [zero; 6],
            special: zero,
        }
    }

    #[inline(always)]
    pub fn plus(mut self, other: Self) -> Self {
        for c in 0..3 {
            self.field[c] = self.field[c] + other.field[c];
        }
        for c in 0..6 {
            self.gradient[c] = self.gradient[c] + other.gradient[c];
        }
        self.special = self.special.max(other.special);
        self
    }

    /// The same in axes that are the columns of `turn`.
    #[inline(always)]
    pub fn turned<I: Isa<V = V>, const GRADIENT: bool>(self, isa: I, turn: &Matrix3<f64>) -> Self {
        let rows = rows(isa, turn);
        let field = apply(&rows, self.field);
        let mut gradient = self.gradient;
        if GRADIENT {
            let [xx, xy, xz, yy, yz, zz] = self.gradient;
            // Rows of turn . G, then times the transpose of turn.
            let half = [
                apply(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], rows[0]),
                apply(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], rows[1]),
                apply(&[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], rows[2]),
            ];
            gradient = [
                lanes::dot(half[0], rows[0]),
                lanes::dot(half[0], rows[1]),
                lanes::dot(half[0], rows[2]),
                lanes::dot(half[1], rows[1]),
                lanes::dot(half[1], rows[2]),
                lanes::dot(half[2], rows[2]),
            ];
        }
        Self {
            field,
            gradient,
            special: self.special,
        }
    }
}

/// Points in the frame of a source: the transpose of `axes` times (x - centre).
#[inline(always)]
pub(super) fn to_frame<I: Isa>(isa: I, x: [I::V; 3], centre: Vec3, axes: &Matrix3<f64>) -> [I::V; 3] {
    apply(&rows(isa, &axes.transpose()), minus(x, same(isa, centre)))
}

#[inline(always)]
fn rows<I: Isa>(isa: I, m: &Matrix3<f64>) -> [[I::V; 3]; 3] {
    [
        [isa.splat(m.m11), isa.splat(m.m12), isa.splat(m.m13)],
        [isa.splat(m.m21), isa.splat(m.m22), isa.splat(m.m23)],
        [isa.splat(m.m31), isa.splat(m.m32), isa.splat(m.m33)],
    ]
}

#[inline(always)]
fn apply<V: Lanes>(rows: &[[V; 3]; 3], v: [V; 3]) -> [V; 3] {
    [lanes::dot(rows[0], v), lanes::dot(rows[1], v), lanes::dot(rows[2], v)]
}

/// Field of `source` at all points.
pub(super) fn fields<S: Batch>(source: &S, x: Soa3Ref<'_>, t: f64, b: &mut Soa3) {
    b.resize(x.len());
    blocks::<S, false>(source, x, t, b, &mut []);
}

/// Field and gradient of `source` at all points.
pub(super) fn fields_and_gradients<S: Batch>(
    source: &S,
    x: Soa3Ref<'_>,
    t: f64,
    b: &mut Soa3,
    g: &mut Vec<Matrix3<f64>>,
) {
    b.resize(x.len());
    g.resize(x.len(), Matrix3::zeros());
    blocks::<S, true>(source, x, t, b, g);
}

fn blocks<S: Batch, const GRADIENT: bool>(source: &S, x: Soa3Ref<'_>, t: f64, b: &mut Soa3, g: &mut [Matrix3<f64>]) {
    let fields =
        b.x.chunks_mut(BLOCK)
            .zip(b.y.chunks_mut(BLOCK))
            .zip(b.z.chunks_mut(BLOCK));
    let mut gradients = g.chunks_mut(BLOCK);
    let work: Vec<_> = fields
        .enumerate()
        .map(|(k, ((bx, by), bz))| (k * BLOCK, [bx, by, bz], gradients.next().unwrap_or_default()))
        .collect();
    crate::kernel::each(
        work,
        || (),
        |_, (first, b, g)| {
            lanes::run(Block::<S, GRADIENT> {
                source,
                x,
                first,
                time: t,
                b,
                g,
            });
        },
    );
}

struct Block<'a, S, const GRADIENT: bool> {
    source: &'a S,
    x: Soa3Ref<'a>,
    first: usize,
    time: f64,
    b: [&'a mut [f64]; 3],
    g: &'a mut [Matrix3<f64>],
}

impl<S: Batch, const GRADIENT: bool> Work for Block<'_, S, GRADIENT> {
    type Out = ();
    #[inline(always)]
    fn run<I: Isa>(self, isa: I) {
        let n = self.b[0].len();
        for at in (0..n).step_by(LANES) {
            let x = vectors(isa, [self.x.x, self.x.y, self.x.z], self.first + at);
            let out = self.source.eight::<I, GRADIENT>(isa, x);
            let here = at..(at + LANES).min(n);
            for c in 0..3 {
                self.b[c][here.clone()].copy_from_slice(&out.field[c].array()[..here.len()]);
            }
            if GRADIENT {
                let [xx, xy, xz, yy, yz, zz] = arrays(out.gradient);
                for (l, g) in self.g[here.clone()].iter_mut().enumerate() {
                    *g = Matrix3::new(xx[l], xy[l], xz[l], xy[l], yy[l], yz[l], xz[l], yz[l], zz[l]);
                }
            }
            let special = out.special.array();
            for i in here {
                // Not above zero where something is not a number either.
                if special[i - at] != 0.0 {
                    let (b, g) = self.source.field_and_gradient(self.x.get(self.first + i), self.time);
                    for c in 0..3 {
                        self.b[c][i] = b[c];
                    }
                    if GRADIENT {
                        self.g[i] = g;
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn arrays<V: Lanes>(v: [V; 6]) -> [[f64; LANES]; 6] {
    [
        v[0].array(),
        v[1].array(),
        v[2].array(),
        v[3].array(),
        v[4].array(),
        v[5].array(),
    ]
}
