//! The profile of a developed flow in a cross-section.

use crate::faces::{Face, Side};
use crate::maker::Maker;

/// Residual over that of the start at which a profile is done, and most sweeps.
const DONE: f64 = 1e-12;
const SWEEPS: usize = 20_000;

/// A side of a node in the cross-section.
#[derive(Clone, Copy, Debug)]
enum Arm {
    /// Another node.
    Node(usize),
    /// A wall, at a fraction of a cell.
    Wall(f64),
    /// The same velocity beyond.
    Mirror,
}

/// The solution of `d2u/db2 + d2u/dc2 = -1` on the fluid nodes of a layer at a face, zero at walls, by finite differences with
/// unequal arms (Shortley and Weller 1938) and over-relaxation; one everywhere where there is no wall.
pub struct Developed {
    /// Axes along the face and nodes along them.
    axes: [usize; 2],
    shape: [usize; 2],
    u: Vec<f64>,
    /// Second derivatives along both axes.
    curvature: Vec<[f64; 2]>,
}

impl Developed {
    /// On the layer at a face.
    pub fn new(maker: &Maker, axis: usize, side: Side) -> Self {
        let grid = maker.surface.grid;
        let axes = [(axis + 1) % 3, (axis + 2) % 3];
        let shape = axes.map(|a| grid.shape[a]);
        let layer = match side {
            Side::Low => 0,
            Side::High => grid.shape[axis] - 1,
        };
        let node = |m: usize| {
            let mut node = [layer; 3];
            (node[axes[0]], node[axes[1]]) = (m % shape[0], m / shape[0]);
            node
        };
        let solid = |n: [usize; 3]| maker.mask.is_solid_at(n);
        let arms: Vec<Option<[[Arm; 2]; 2]>> = (0..shape[0] * shape[1])
            .map(|m| {
                let node = node(m);
                let arm =
                    |a: usize, step: isize| arm(maker, node, axes[a], step, |n| n[axes[1]] * shape[0] + n[axes[0]]);
                (!solid(node)).then(|| [0, 1].map(|a| [arm(a, -1), arm(a, 1)]))
            })
            .collect();
        let mut profile = Self {
            axes,
            shape,
            u: vec![0.0; arms.len()],
            curvature: vec![[0.0; 2]; arms.len()],
        };
        profile.solve(&arms);
        for (m, arms) in arms.iter().enumerate() {
            if let Some(arms) = arms {
                profile.curvature[m] = [0, 1].map(|a| {
                    let (centre, rest) = profile.stencil(&arms[a]);
                    rest - centre * profile.u[m]
                });
            }
        }
        profile
    }

    /// The second derivative at a node along an axis, as `rest - centre u`.
    fn stencil(&self, arms: &[Arm; 2]) -> (f64, f64) {
        let of = |arm: Arm| match arm {
            Arm::Node(n) => (1.0, Some(self.u[n])),
            Arm::Wall(fraction) => (fraction.max(1e-6), Some(0.0)),
            Arm::Mirror => (1.0, None),
        };
        let ends = arms.map(of);
        let span = 0.5 * (ends[0].0 + ends[1].0);
        let (mut centre, mut rest) = (0.0, 0.0);
        for (length, value) in ends {
            // Beyond a mirror the velocity is the node's own.
            if let Some(value) = value {
                centre += 1.0 / (span * length);
                rest += value / (span * length);
            }
        }
        (centre, rest)
    }

    fn solve(&mut self, arms: &[Option<[[Arm; 2]; 2]>]) {
        let held = arms
            .iter()
            .flatten()
            .flatten()
            .flatten()
            .any(|a| matches!(a, Arm::Wall(_)));
        if !held {
            // A plug.
            self.u.fill(1.0);
            return;
        }
        let longest = self.shape[0].max(self.shape[1]) as f64;
        let factor = 2.0 / (1.0 + (std::f64::consts::PI / (longest + 1.0)).sin());
        for _ in 0..SWEEPS {
            let (mut worst, mut greatest) = (0.0_f64, 0.0_f64);
            for (m, arms) in arms.iter().enumerate() {
                let Some(arms) = arms else { continue };
                let [(b, rb), (c, rc)] = arms.each_ref().map(|arms| self.stencil(arms));
                let change = (1.0 + rb + rc) / (b + c) - self.u[m];
                self.u[m] += factor * change;
                worst = worst.max(change.abs());
                greatest = greatest.max(self.u[m].abs());
            }
            if worst <= DONE * greatest {
                return;
            }
        }
    }

    /// Half way between two neighbouring nodes of the layer, or at the node where they are the same.
    pub fn between(&self, a: [usize; 3], b: [usize; 3]) -> f64 {
        let at = |n: [usize; 3]| n[self.axes[1]] * self.shape[0] + n[self.axes[0]];
        let (m, n) = (at(a), at(b));
        let mean = 0.5 * (self.u[m] + self.u[n]);
        let bend = |axis: usize| match a[self.axes[axis]] == b[self.axes[axis]] {
            true => 0.0,
            false => 0.125 * 0.5 * (self.curvature[m][axis] + self.curvature[n][axis]),
        };
        mean - bend(0) - bend(1)
    }

    /// The greatest velocity.
    pub fn greatest(&self) -> f64 {
        self.u.iter().fold(0.0, |most, u| most.max(*u))
    }
}

/// What lies beside a node of the layer along an axis.
fn arm(maker: &Maker, node: [usize; 3], axis: usize, step: isize, number: impl Fn([usize; 3]) -> usize) -> Arm {
    let grid = maker.surface.grid;
    let n = grid.shape[axis] as isize;
    let s = node[axis] as isize + step;
    if !grid.periodic[axis] && !(0..n).contains(&s) {
        let side = if step < 0 { Side::Low } else { Side::High };
        return match maker.faces.at(axis, side) {
            Face::Wall => Arm::Wall(0.5),
            _ => Arm::Mirror,
        };
    }
    let mut beside = node;
    beside[axis] = s.rem_euclid(n) as usize;
    if !maker.mask.is_solid_at(beside) {
        return Arm::Node(number(beside));
    }
    if !maker.rule.interpolates() {
        return Arm::Wall(0.5);
    }
    let velocities = maker.storage.velocities();
    let away = |i: usize| (0..3).all(|a| velocities.c(i)[a] as isize == if a == axis { -step } else { 0 });
    let fraction = (1..velocities.q())
        .find(|i| away(*i))
        .map(|i| maker.surface.meeting(node, i).fraction);
    Arm::Wall(fraction.unwrap_or(0.5))
}
