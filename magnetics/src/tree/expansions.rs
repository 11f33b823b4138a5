//! The sums over all dipoles by expansions: up the boxes, across, and down to the points.

use super::boxes::Boxes;
use super::expansion::{Gather, Spread, Translate, shift_down, shift_up};
use super::plan::Plan;
use super::terms::Terms;
use super::{LEAF, Tree};
use crate::kernel::{self, Sources, Sum, Want, lanes};
use lbm_ibm_coupling::{Soa3, Soa3Ref};

/// Boxes of targets and sources, what meets what, and the expansions of the last sums.
#[derive(Clone, Debug)]
pub(super) struct Expansions {
    terms: Terms,
    targets: Boxes,
    /// None where the targets are the sources.
    sources: Option<Boxes>,
    plan: Plan,
    near2: f64,
    multipoles: Vec<f64>,
    locals: Vec<f64>,
    on: Soa3,
    by: Soa3,
    out: Vec<Sum>,
}

impl Expansions {
    pub fn new(targets: Soa3Ref<'_>, sources: Option<Soa3Ref<'_>>, near: f64, tree: &Tree) -> Self {
        let targets = Boxes::new(targets, LEAF);
        let sources = sources.map(|x| Boxes::new(x, LEAF));
        let plan = Plan::new(&targets, sources.as_ref().unwrap_or(&targets), tree.opening, near);
        Self {
            terms: Terms::new(tree.order),
            targets,
            sources,
            plan,
            near2: near * near,
            multipoles: Vec::new(),
            locals: Vec::new(),
            on: Soa3::default(),
            by: Soa3::default(),
            out: Vec::new(),
        }
    }

    /// Sums of the moments `by` at every target, with forces on the moments `on`.
    pub fn sums(&mut self, on: Soa3Ref<'_>, by: Soa3Ref<'_>, want: Want, field: &mut Soa3, force: &mut Soa3) {
        let sources = self.sources.as_ref().unwrap_or(&self.targets);
        sort(&sources.order, by, &mut self.by);
        if want != Want::Field {
            sort(&self.targets.order, on, &mut self.on);
        }
        gather(&self.terms, sources, &self.by, &mut self.multipoles);
        self.across();
        self.spread(want);
        let n = self.out.len();
        if want != Want::Force {
            field.resize(n);
        }
        if want != Want::Field {
            force.resize(n);
        }
        for (i, sum) in self.targets.order.iter().zip(&self.out) {
            if want != Want::Force {
                field.set(*i as usize, sum.field);
            }
            if want != Want::Field {
                force.set(*i as usize, sum.force);
            }
        }
    }

    /// What each target box gets as a whole: from the boxes that meet it, and from its parent.
    fn across(&mut self) {
        let n = self.terms.len();
        let (terms, plan, targets) = (&self.terms, &self.plan, &self.targets);
        let sources = self.sources.as_ref().unwrap_or(targets);
        self.locals.clear();
        self.locals.resize(targets.nodes.len() * n, 0.0);
        let multipoles = &self.multipoles;
        rows(&mut self.locals, n, |k, local| {
            lanes::run(Translate {
                terms,
                sources: plan.far.of(k),
                centre: |b: usize| sources.nodes[b].centre,
                target: targets.nodes[k].centre,
                multipoles,
                local,
            });
        });
        for level in targets.levels.iter().skip(1) {
            let (above, here) = self.locals.split_at_mut(level.start * n);
            rows(&mut here[..level.len() * n], n, |k, local| {
                let node = &targets.nodes[level.start + k];
                let shift = node.centre - targets.nodes[node.parent].centre;
                shift_down(terms, &above[node.parent * n..][..n], shift, local);
            });
        }
    }

    fn spread(&mut self, want: Want) {
        let n = self.terms.len();
        let (terms, plan, targets, near2) = (&self.terms, &self.plan, &self.targets, self.near2);
        let sources = self.sources.as_ref().unwrap_or(targets);
        let (on, by, locals) = (&self.on, &self.by, &self.locals);
        self.out.clear();
        self.out.resize(targets.x.len(), Sum::zero());
        let mut rest = self.out.as_mut_slice();
        let mut work = Vec::with_capacity(targets.leaves.len());
        for k in &targets.leaves {
            let (here, after) = rest.split_at_mut(targets.nodes[*k].points.len());
            work.push((*k, here));
            rest = after;
        }
        kernel::each(work, Sources::default, |close, (k, out)| {
            let node = &targets.nodes[k];
            // Near boxes of a leaf and, where a leaf is large beside them, of the boxes that it is in.
            let near = plan
                .near
                .of(k)
                .iter()
                .map(|b| sources.nodes[*b as usize].points.clone());
            close.collect(&sources.x, by, near);
            for (o, i) in out.iter_mut().zip(node.points.clone()) {
                let m = if want == Want::Field {
                    Default::default()
                } else {
                    on.get(i)
                };
                *o = kernel::one(close, targets.x.get(i), m, near2, want);
            }
            lanes::run(Spread {
                terms,
                x: &targets.x,
                m: if want == Want::Field { &targets.x } else { on },
                points: node.points.clone(),
                centre: node.centre,
                local: &locals[k * n..][..n],
                want,
                out,
            });
        });
    }
}

/// The multipole of every box.
fn gather(terms: &Terms, boxes: &Boxes, m: &Soa3, multipoles: &mut Vec<f64>) {
    let n = terms.len();
    multipoles.clear();
    multipoles.resize(boxes.nodes.len() * n, 0.0);
    rows(multipoles, n, |k, multipole| {
        let node = &boxes.nodes[k];
        if node.is_leaf() {
            lanes::run(Gather {
                terms,
                x: &boxes.x,
                m,
                points: node.points.clone(),
                centre: node.centre,
                multipole,
            });
        }
    });
    for level in boxes.levels.iter().rev() {
        let (above, below) = multipoles.split_at_mut(level.end * n);
        rows(&mut above[level.start * n..], n, |k, whole| {
            let node = &boxes.nodes[level.start + k];
            for part in node.parts.clone() {
                let shift = boxes.nodes[part].centre - node.centre;
                shift_up(terms, &below[(part - level.end) * n..][..n], shift, whole);
            }
        });
    }
}

fn sort(order: &[u32], from: Soa3Ref<'_>, to: &mut Soa3) {
    to.resize(order.len());
    for (k, i) in order.iter().enumerate() {
        to.set(k, from.get(*i as usize));
    }
}

/// Calls `each` with every row of `n` numbers.
fn rows(all: &mut [f64], n: usize, each: impl Fn(usize, &mut [f64]) + Sync + Send) {
    kernel::each(
        all.chunks_mut(n).enumerate().collect(),
        || (),
        |_, (k, row)| each(k, row),
    );
}
