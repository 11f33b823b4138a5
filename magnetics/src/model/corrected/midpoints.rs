//! Fields and forces between beads and the midpoints of near pairs.

use super::Extra;
use crate::kernel::{Overlap, Want};
use crate::model::Problem;
use crate::model::near::FACTOR;
use crate::tree::{DipoleSums, Summation};
use lbm_ibm_coupling::nalgebra::Matrix3;
use lbm_ibm_coupling::{CellList, Domain, Soa3, Vec3};

/// The midpoint's field is averaged over a ball of this many mean radii, so that a bead on it gives a finite field.
const BALL: f64 = 0.3;

/// One point per pair, with the source's field there.
pub(super) struct Midpoints {
    x: Soa3,
    ball: Vec<f64>,
    near: f64,
    /// Other beads within `near` of a midpoint: pair, bead.
    others: Vec<(usize, usize)>,
    field: Soa3,
    gradient: Vec<Matrix3<f64>>,
    from_beads: DipoleSums,
    to_beads: DipoleSums,
}

impl Midpoints {
    pub fn new(problem: &Problem<'_>, extras: &[Extra], how: Summation) -> Self {
        let positions = problem.positions;
        let x: Soa3 = extras.iter().map(|p| positions.get(p.i) - p.r * 0.5).collect();
        let radius = |i: usize| problem.beads[i].radius();
        let ball: Vec<f64> = extras
            .iter()
            .map(|p| BALL * 0.5 * (radius(p.i) + radius(p.j)))
            .collect();
        let near = (1.0 + BALL) * problem.largest_radius();
        let all: Soa3 = positions.iter().chain(x.iter()).collect();
        let n = positions.len();
        let mut others = Vec::new();
        let mut cells = CellList::new();
        cells.build(all.view(), &Domain::unbounded(), near);
        cells.for_each_pair(|i, j| {
            let (bead, mid) = (i.min(j), i.max(j));
            if bead < n && mid >= n {
                let pair = &extras[mid - n];
                let own = bead == pair.i || bead == pair.j;
                if !own && (all.get(i) - all.get(j)).norm() < near {
                    others.push((mid - n, bead));
                }
            }
        });
        let (mut field, mut gradient) = (Soa3::default(), Vec::new());
        problem
            .source
            .fields_and_gradients(x.view(), problem.time, &mut field, &mut gradient);
        let tree = how.tree(n);
        Self {
            from_beads: DipoleSums::new(x.view(), Some(positions), near, tree),
            to_beads: DipoleSums::new(positions, Some(x.view()), near, tree),
            x,
            ball,
            near,
            others,
            field,
            gradient,
        }
    }

    pub fn source_gradient(&mut self) -> Vec<Matrix3<f64>> {
        std::mem::take(&mut self.gradient)
    }

    /// The terms that the sums over all beads have too much (the pair's own beads) or not yet (beads that are near):
    /// weight, pair, bead, vector from bead to midpoint, interaction.
    fn special<'b>(
        &'b self,
        problem: &'b Problem<'_>,
        extras: &'b [Extra],
    ) -> impl Iterator<Item = (f64, usize, usize, Vec3, Overlap)> + 'b {
        let vector = |k: usize, bead: usize| self.x.get(k) - problem.positions.get(bead);
        let own = extras.iter().enumerate().flat_map(|(k, p)| [(k, p.i), (k, p.j)]);
        let own = own.filter_map(move |(k, bead)| {
            let r = vector(k, bead);
            (r.norm() >= self.near).then(|| (-1.0, k, bead, r, Overlap::point(r.norm())))
        });
        let others = self.others.iter().map(move |&(k, bead)| {
            let r = vector(k, bead);
            let balls = Overlap::balls(self.ball[k], problem.beads[bead].radius(), r.norm());
            (1.0, k, bead, r, balls)
        });
        own.chain(others)
    }

    /// Field (T) of the source and of all beads but the pair's own at each midpoint.
    pub fn field(&mut self, problem: &Problem<'_>, extras: &[Extra], moment: &Soa3) -> Soa3 {
        let mut field = Soa3::default();
        let m = moment.view();
        self.from_beads
            .sums(m, m, Want::Field, &mut field, &mut Soa3::default());
        for (weight, k, bead, r, overlap) in self.special(problem, extras) {
            field.add(k, overlap.field(moment.get(bead), r) * weight);
        }
        (0..extras.len())
            .map(|k| field.get(k) * FACTOR + self.field.get(k))
            .collect()
    }

    /// Forces (N) of the beads on the extra moments (returned) and of these on the beads (added to `force`), and the field
    /// (T) of the extra moments at the beads.
    pub fn forces(
        &mut self,
        problem: &Problem<'_>,
        extras: &[Extra],
        moment: &Soa3,
        back: &mut Soa3,
        force: &mut Soa3,
    ) -> Soa3 {
        let extra: Soa3 = extras.iter().map(|p| p.moment).collect();
        let (mut pull, mut push) = (Soa3::default(), Soa3::default());
        let (m, e) = (moment.view(), extra.view());
        self.from_beads.sums(e, m, Want::Force, &mut Soa3::default(), &mut pull);
        self.to_beads.sums(m, e, Want::Both, back, &mut push);
        for (weight, k, bead, r, overlap) in self.special(problem, extras) {
            let on_extra = overlap.force(extra.get(k), moment.get(bead), r) * weight;
            pull.add(k, on_extra);
            push.add(bead, -on_extra);
            back.add(bead, overlap.field(extra.get(k), r) * weight);
        }
        for i in 0..push.len() {
            force.add(i, push.get(i) * FACTOR);
            back.set(i, back.get(i) * FACTOR);
        }
        pull.iter().map(|f| f * FACTOR).collect()
    }
}
