//! Finds the rows, runs and links of a mask.

use crate::developed::Developed;
use crate::faces::Faces;
use crate::links::{Cut, Link, Links, NO_ROW, Row, RowLinks, Side};
use crate::mask::Mask;
use crate::pack::Packing;
use crate::rule::{CutLink, LinkRule, Shares};
use crate::stencil::opposite;
use crate::storage::Storage;
use crate::surface::{Between, Meeting, Surface};

/// A fraction this close to a half is one.
const HALF: f64 = 1e-8;

/// What links are made from.
pub struct Maker<'a> {
    pub surface: Surface<'a>,
    pub mask: &'a Mask,
    pub storage: &'a Storage,
    pub rule: &'a dyn LinkRule,
    /// Relaxation time.
    pub tau: f64,
    pub faces: &'a Faces,
    /// Density, kg/m3.
    pub density: f64,
    pub mach_limit: f64,
    /// Profiles of the faces with a flux.
    pub profiles: [[Option<Developed>; 2]; 3],
    /// Both ends of the links that pass thin walls, sorted.
    pub severed: Vec<([usize; 3], usize)>,
}

impl<'a> Maker<'a> {
    /// For the walls as they stand.
    pub fn new(
        surface: Surface<'a>,
        mask: &'a Mask,
        storage: &'a Storage,
        rule: &'a dyn LinkRule,
        faces: &'a Faces,
    ) -> Self {
        Self {
            surface,
            mask,
            storage,
            rule,
            faces,
            tau: 1.0,
            density: 0.0,
            mach_limit: f64::INFINITY,
            profiles: Default::default(),
            severed: Vec::new(),
        }
    }

    /// Finds all rows, runs and links.
    pub fn links(mut self) -> Links {
        let Between { thin, closed_gaps } = self.surface.between(self.mask);
        let mut links = Links {
            closed_gaps,
            ny: self.surface.grid.shape[1],
            q: self.storage.velocities().q(),
            row_at: vec![NO_ROW; self.surface.grid.shape[1] * self.surface.grid.shape[2]],
            ..Links::default()
        };
        for &(node, i, _) in &thin {
            self.severed.push((node, i));
            if let Some(far) = self.surface.in_grid(node, i) {
                self.severed.push((far, opposite(i)));
            }
        }
        self.severed.sort_unstable();
        self.develop();
        let [_, ny, nz] = self.surface.grid.shape;
        let mut packing = self.storage.is_packed().then(|| Packing::new(&self));
        for k in 0..nz {
            for j in 0..ny {
                let starts = links.ends();
                links.add_runs(self.mask.fluid_runs(j, k));
                if links.runs.len() == starts[0] {
                    continue;
                }
                match &mut packing {
                    Some(packing) => packing.add_row(&self, [j, k], starts[0], &mut links),
                    None => self.add_row(j, k, starts[0], &mut links),
                }
                links.row_at[k * ny + j] = links.rows.len() as u32;
                let ends = links.ends();
                let range = |n: usize| starts[n]..ends[n];
                links.rows.push(Row::new([j, k], range(0)));
                // Packed nodes keep no other lists.
                if packing.is_none() {
                    links.row_links.push(RowLinks {
                        walls: range(1),
                        cuts: range(2),
                        wraps_out: range(3),
                        wraps_in: range(4),
                    });
                }
            }
        }
        for (node, i, rim) in thin {
            if let Some(far) = self.surface.in_grid(node, i) {
                let through = rim.map_or(0.0, |rim| rim.share(self.tau));
                let sides = [(node, i), (far, opposite(i))].map(|(node, i)| self.side(node, i, through, &mut links));
                links.thin.push(sides);
            }
        }
        self.settle_fluxes(&mut links);
        if links.fractions.iter().all(|f| (f - 0.5).abs() < HALF) {
            links.fractions = Vec::new();
        }
        links.balance_pushes(self.rule.interpolates(), self.storage.velocities());
        if let Some(packing) = packing {
            packing.finish(&self, &mut links);
        }
        links
    }

    /// Links and places of a row with the runs from number `first` on.
    fn add_row(&self, j: usize, k: usize, first: usize, links: &mut Links) {
        for run in first..links.runs.len() {
            for x in links.run(run) {
                self.add_incoming([x, j, k], links);
            }
        }
        self.add_outgoing(j, k, links);
        self.add_places(j, k, first, links);
    }

    /// Lattice velocity `i`.
    pub fn c(&self, i: usize) -> [isize; 3] {
        self.storage.velocities().c(i).map(|c| c as isize)
    }

    fn add_incoming(&self, node: [usize; 3], links: &mut Links) {
        let [x, j, k] = node.map(|i| i as isize);
        let nx = self.surface.grid.shape[0] as isize;
        for i in 1..self.storage.velocities().q() {
            let [cx, cy, cz] = self.c(i);
            let source = x - cx;
            let solid = self.mask.is_solid(source, j - cy, k - cz);
            if !solid && (0..nx).contains(&source) {
                continue;
            }
            let [sj, sk] = self.storage.wrapped(j - cy, k - cz);
            let ghost = self.storage.index(opposite(i), source, sj, sk);
            if solid {
                let home = self.storage.index(i, x, j, k);
                if self.add_open(node, i, Link { ghost, home }, links) {
                    links.add_wall(Link { ghost, home }, i, 0.0, self.fraction(0.5));
                } else {
                    self.add_wall(node, i, Link { ghost, home }, links);
                }
            } else {
                let home = self.storage.index(opposite(i), source.rem_euclid(nx), sj, sk);
                links.wraps_in.push(Link { ghost, home });
            }
        }
    }

    /// Adds the link of `node` into a wall, whose returning population is `i`.
    pub fn add_wall(&self, node: [usize; 3], i: usize, link: Link, links: &mut Links) {
        let meeting = self.meeting(node, i);
        let cut = self.cut(node, i, link, meeting, links);
        let push = cut.shares.push * meeting.push;
        links.add_wall(link, i, push, self.fraction(meeting.fraction));
        if cut.shares != Shares::HALFWAY {
            links.swell += cut.swell;
            links.cuts.push(cut);
        }
    }

    /// A fraction, where fractions are kept.
    fn fraction(&self, fraction: f64) -> Option<f64> {
        self.rule.interpolates().then_some(fraction)
    }

    /// Places of the runs from number `first` on.
    fn add_places(&self, j: usize, k: usize, first: usize, links: &mut Links) {
        for run in first..links.runs.len() {
            let x = links.run(run).start as isize;
            for i in 0..links.q {
                links
                    .places
                    .push((self.storage.place(i, x, j as isize, k as isize) - x) as i32);
            }
            for i in 0..links.q {
                let [cx, cy, cz] = self.c(i);
                let [sj, sk] = self.storage.wrapped(j as isize - cy, k as isize - cz);
                links
                    .places
                    .push((self.storage.place(opposite(i), x - cx, sj, sk) - x) as i32);
            }
        }
    }

    fn meeting(&self, node: [usize; 3], i: usize) -> Meeting {
        if !self.rule.interpolates() {
            return self.surface.halfway(node, i);
        }
        match self.mirrored(node, i) {
            Some(mirrored) => self.surface.mirrored_meeting(node, i, mirrored),
            None => self.surface.meeting(node, i),
        }
    }

    /// The link of `node` whose returning population is `i`.
    fn cut(&self, node: [usize; 3], i: usize, link: Link, meeting: Meeting, links: &mut Links) -> Cut {
        let [x, j, k] = node.map(|i| i as isize);
        let [cx, cy, cz] = self.c(i);
        let o = opposite(i);
        let solid = self.mask.is_solid(x + cx, j + cy, k + cz);
        let severed = self.severed.binary_search(&(node, o)).is_ok();
        // Through an open face something arrives too.
        let arrives = !solid || self.is_open(node, o);
        let velocities = self.storage.velocities();
        let shares = self.rule.shares(&CutLink {
            fraction: meeting.fraction,
            behind: arrives && !severed,
            velocity: velocities.c(i),
            weight: velocities.weight(i),
            tau: self.tau,
        });
        // The places of a thin wall behind are exchanged, perhaps before they are read.
        let shares = shares.filter(|s| !severed || *s == Shares::HALFWAY);
        links.uninterpolated += usize::from(shares.is_none());
        // Where the node behind is solid, its place is the ghost of the link on that side.
        let behind = if solid {
            x + cx
        } else {
            (x + cx).rem_euclid(self.surface.grid.shape[0] as isize)
        };
        let [bj, bk] = self.storage.wrapped(j + cy, k + cz);
        let near = self.storage.index(o, x, j, k);
        Cut {
            link,
            near,
            // Packed, it is the node's own place.
            behind: if solid && self.storage.is_packed() {
                near
            } else {
                self.storage.index(i, behind, bj, bk)
            },
            swell: meeting.swell * shares.map_or(1.0, |s| s.push),
            shares: shares.unwrap_or(Shares::HALFWAY),
            direction: i,
        }
    }

    /// The side of a thin wall on which `node` lies, population `i` returning to it and the share `through` passing.
    fn side(&self, node: [usize; 3], i: usize, through: f64, links: &mut Links) -> Side {
        let [x, j, k] = node.map(|i| i as isize);
        let [cx, cy, cz] = self.c(i);
        let [sj, sk] = self.storage.wrapped(j - cy, k - cz);
        let source = if self.storage.is_packed() {
            (x - cx).rem_euclid(self.surface.grid.shape[0] as isize)
        } else {
            x - cx
        };
        let link = Link {
            ghost: self.storage.index(opposite(i), source, sj, sk),
            home: self.storage.index(i, x, j, k),
        };
        let meeting = self.meeting(node, i);
        let cut = self.cut(node, i, link, meeting, links);
        if cut.shares != Shares::HALFWAY {
            links.swell += (1.0 - through) * cut.swell;
        }
        Side {
            cut,
            push: (1.0 - through) * cut.shares.push * meeting.push,
            through,
            node,
            fraction: meeting.fraction,
        }
    }

    /// The places at the two ends of row (`j`, `k`) that nodes at the other end use in an odd step.
    fn add_outgoing(&self, j: usize, k: usize, links: &mut Links) {
        let (j, k, nx) = (j as isize, k as isize, self.surface.grid.shape[0] as isize);
        for m in 1..self.storage.velocities().q() {
            let [cx, cy, cz] = self.c(m);
            let (end, ghost) = match cx {
                1 => (0, nx),
                -1 => (nx - 1, -1),
                _ => continue,
            };
            let both_fluid = !self.mask.is_solid(end, j, k) && !self.mask.is_solid(end - cx, j - cy, k - cz);
            if both_fluid {
                let home = self.storage.index(m, end, j, k);
                let ghost = self.storage.index(m, ghost, j, k);
                links.wraps_out.push(Link { ghost, home });
            }
        }
    }
}
