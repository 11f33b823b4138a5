//! Points sorted into nested boxes.

use lbm_ibm_coupling::{Soa3, Soa3Ref, Vec3};
use std::ops::Range;

/// A box of points and the ball about them.
#[derive(Clone, Debug)]
pub(super) struct Node {
    pub points: Range<usize>,
    /// Its two parts; empty in a leaf.
    pub parts: Range<usize>,
    pub parent: usize,
    pub centre: Vec3,
    pub radius: f64,
}

impl Node {
    pub fn is_leaf(&self) -> bool {
        self.parts.is_empty()
    }
}

/// A tree of boxes, each halved at the middle of its longest side. Boxes are shrunk to their points, so empty space costs
/// nothing, and stored level by level.
#[derive(Clone, Debug)]
pub(super) struct Boxes {
    /// Which point stands at each place.
    pub order: Vec<u32>,
    /// Positions in that order.
    pub x: Soa3,
    pub nodes: Vec<Node>,
    pub levels: Vec<Range<usize>>,
    /// Leaves in the order of their points.
    pub leaves: Vec<usize>,
}

impl Boxes {
    /// A tree over `x` (m) whose leaves hold at most `most` points, unless these are all at one place.
    pub fn new(x: Soa3Ref<'_>, most: usize) -> Self {
        let n = x.len();
        let mut order: Vec<u32> = (0..n as u32).collect();
        let mut scratch = order.clone();
        let mut nodes = Vec::new();
        let mut levels = Vec::new();
        if n > 0 {
            nodes.push(node(x, &order, 0..n, 0).0);
        }
        let mut level = 0..nodes.len();
        while !level.is_empty() {
            let begin = nodes.len();
            for k in level.clone() {
                let points = nodes[k].points.clone();
                let (_, low, high) = node(x, &order, points.clone(), 0);
                let side = high - low;
                let axis = side.imax();
                if points.len() <= most || side[axis] <= 0.0 {
                    continue;
                }
                let middle = 0.5 * (low[axis] + high[axis]);
                let at = points.start + halve(&mut order[points.clone()], &mut scratch, |i| x.get(i)[axis] < middle);
                let first = nodes.len();
                for half in [points.start..at, at..points.end] {
                    if !half.is_empty() {
                        nodes.push(node(x, &order, half, k).0);
                    }
                }
                nodes[k].parts = first..nodes.len();
            }
            levels.push(level);
            level = begin..nodes.len();
        }
        let mut leaves: Vec<usize> = (0..nodes.len()).filter(|k| nodes[*k].is_leaf()).collect();
        leaves.sort_unstable_by_key(|k| nodes[*k].points.start);
        let sorted = order.iter().map(|i| x.get(*i as usize)).collect();
        Self {
            order,
            x: sorted,
            nodes,
            levels,
            leaves,
        }
    }
}

/// Puts the points that satisfy `first` before the others, keeping their order; returns how many they are.
fn halve(order: &mut [u32], scratch: &mut [u32], first: impl Fn(usize) -> bool) -> usize {
    let (mut low, mut high) = (0, 0);
    for k in 0..order.len() {
        let i = order[k];
        if first(i as usize) {
            order[low] = i;
            low += 1;
        } else {
            scratch[high] = i;
            high += 1;
        }
    }
    order[low..].copy_from_slice(&scratch[..high]);
    low
}

fn node(x: Soa3Ref<'_>, order: &[u32], points: Range<usize>, parent: usize) -> (Node, Vec3, Vec3) {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for i in &order[points.clone()] {
        let p = x.get(*i as usize);
        low = low.inf(&p);
        high = high.sup(&p);
    }
    let centre = 0.5 * (low + high);
    let far2 = order[points.clone()]
        .iter()
        .map(|i| (x.get(*i as usize) - centre).norm_squared())
        .fold(0.0, f64::max);
    let node = Node {
        points,
        parts: 0..0,
        parent,
        centre,
        radius: far2.sqrt(),
    };
    (node, low, high)
}
