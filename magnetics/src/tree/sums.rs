//! Direct or by a tree: one face for both.

use super::expansions::Expansions;
use super::{Tree, TreeReport};
use crate::kernel::{self, Sources, Want};
use lbm_ibm_coupling::{Soa3, Soa3Ref};

/// Above this number of beads sums are by a tree unless a model is told otherwise.
const AUTOMATIC: usize = 20_000;
/// Beads at which a tree is held against the direct sum.
const SAMPLE: usize = 128;

/// How a model sums.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Summation {
    /// Directly up to [`AUTOMATIC`] beads.
    #[default]
    Automatic,
    Direct,
    Tree(Tree),
}

impl Summation {
    /// The tree for `n` beads, if any.
    pub fn tree(&self, n: usize) -> Option<Tree> {
        match self {
            Self::Automatic => (n > AUTOMATIC).then(Tree::new),
            Self::Direct => None,
            Self::Tree(tree) => Some(*tree),
        }
    }
}

/// Sums of dipoles at some points, without mu0/(4 pi).
#[derive(Clone, Debug)]
pub(crate) struct DipoleSums {
    near: f64,
    targets: Soa3,
    sources: Sources,
    also: Sources,
    tree: Option<(Tree, Box<Expansions>)>,
}

impl DipoleSums {
    /// Sums at `targets` over `sources`, the targets themselves where none; pairs within `near` (m) are left out.
    pub fn new(targets: Soa3Ref<'_>, sources: Option<Soa3Ref<'_>>, near: f64, tree: Option<Tree>) -> Self {
        let mut direct = Sources::default();
        direct.set_positions(sources.unwrap_or(targets));
        Self {
            near,
            targets: targets.iter().collect(),
            also: Sources::default(),
            sources: direct,
            tree: tree.map(|tree| (tree, Box::new(Expansions::new(targets, sources, near, &tree)))),
        }
    }

    /// The sources with moments `m`, for other sums.
    pub fn sources(&mut self, m: Soa3Ref<'_>) -> &Sources {
        self.sources.set_moments(m);
        &self.sources
    }

    /// Sums of the moments `by` at every target, with forces on the moments `on`, where wanted.
    pub fn sums(&mut self, on: Soa3Ref<'_>, by: Soa3Ref<'_>, want: Want, field: &mut Soa3, force: &mut Soa3) {
        if let Some((_, tree)) = &mut self.tree {
            tree.sums(on, by, want, field, force);
            return;
        }
        self.sources.set_moments(by);
        kernel::sums(&self.sources, self.targets.view(), on, self.near, want, field, force);
    }

    /// The forces of the moments `m` on each other and, to first order, what a `change` of them brings: that of `all`, m and its
    /// change, on m, and of m on the change.
    pub fn force_with_change(&mut self, m: Soa3Ref<'_>, change: Soa3Ref<'_>, all: Soa3Ref<'_>, force: &mut Soa3) {
        if let Some((_, tree)) = &mut self.tree {
            let (mut also, none) = (Soa3::default(), &mut Soa3::default());
            tree.sums(m, all, Want::Force, none, force);
            tree.sums(change, m, Want::Force, none, &mut also);
            also.iter().enumerate().for_each(|(i, f)| force.add(i, f));
            return;
        }
        self.sources.set_moments(all);
        self.also.set_moments(m);
        let by = [&self.sources, &self.also];
        kernel::two_forces(by, self.targets.view(), [m, change], self.near, force);
    }

    /// What the tree did, with the sum of the `forces` (on, by) held against the direct sum; none without a tree.
    pub fn report(&mut self, forces: &[[Soa3Ref<'_>; 2]], force: &Soa3) -> Option<TreeReport> {
        let (tree, _) = self.tree.as_ref()?;
        let (order, opening) = (tree.order, tree.opening);
        let n = self.targets.len();
        let sample: Vec<usize> = (0..n.min(SAMPLE)).map(|k| k * n / n.min(SAMPLE)).collect();
        let at = |v: Soa3Ref<'_>| -> Soa3 { sample.iter().map(|i| v.get(*i)).collect() };
        let x = at(self.targets.view());
        let mut missed: Soa3 = at(force.view());
        let mut exact = Soa3::default();
        for [on, by] in forces {
            self.sources.set_moments(*by);
            let (on, none) = (at(*on), &mut Soa3::default());
            kernel::sums(
                &self.sources,
                x.view(),
                on.view(),
                self.near,
                Want::Force,
                none,
                &mut exact,
            );
            exact.iter().enumerate().for_each(|(k, f)| missed.add(k, -f));
        }
        let mean = |v: &Soa3| v.iter().map(|f| f.norm_squared()).sum::<f64>() / v.len().max(1) as f64;
        Some(TreeReport {
            order,
            opening,
            rms_error: (mean(&missed) / mean(force).max(f64::MIN_POSITIVE)).sqrt(),
        })
    }
}
