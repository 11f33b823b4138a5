//! Links through open faces.

use crate::developed::Developed;
use crate::faces::{Face, FaceError, Side};
use crate::links::{Link, Links};
use crate::maker::Maker;
use crate::open::{Kind, Open};
use crate::stencil::opposite;
use lbm_ibm_coupling::Vec3;

/// What goes in and out is equal within this part of it.
const BALANCED: f64 = 1e-9;

/// A link as it passes a face.
#[derive(Clone, Copy)]
struct Passage {
    node: [usize; 3],
    /// The population that comes back.
    direction: usize,
    /// The face that holds: axis and end.
    axis: usize,
    side: Side,
    /// The node beside, from which the mirror image of the population would come.
    beside: [usize; 3],
    /// Its direction, mirrored at all planes of symmetry that the link crosses.
    mirrored: usize,
    /// Whether all other faces that it crosses are planes of symmetry.
    plain: bool,
}

/// Unit vector along an axis.
fn unit(axis: usize) -> Vec3 {
    Vec3::from(std::array::from_fn(|a| if a == axis { 1.0 } else { 0.0 }))
}

impl Maker<'_> {
    /// The open face by which the link of `node` against direction `i` leaves the grid.
    fn lead(&self, crossed: [Option<Side>; 3]) -> Option<(usize, Side)> {
        let sides = crossed.iter().enumerate().filter_map(|(a, s)| Some((a, (*s)?)));
        let rank = |(axis, side): (usize, Side)| self.faces.at(axis, side).rank();
        let lead = sides.reduce(|lead, next| if rank(next) > rank(lead) { next } else { lead });
        lead.filter(|(a, s)| !matches!(self.faces.at(*a, *s), Face::Wall))
    }

    /// The direction beyond open faces of the link of `node` against direction `i`, were the scene mirrored there; none if it
    /// leaves by no open face.
    pub fn mirrored(&self, node: [usize; 3], i: usize) -> Option<usize> {
        if !self.faces.any_open() {
            return None;
        }
        let c = self.c(i);
        let crossed = self.faces.crossed(self.surface.grid, node, c);
        self.lead(crossed)?;
        let mirror = std::array::from_fn(|a| if crossed[a].is_some() { -c[a] } else { c[a] });
        self.direction(mirror)
    }

    fn direction(&self, c: [isize; 3]) -> Option<usize> {
        (0..self.storage.velocities().q()).find(|&m| self.c(m) == c)
    }

    /// How the link of `node` against direction `i` passes an open face, if it does and meets no wall before.
    fn passage(&self, node: [usize; 3], i: usize) -> Option<Passage> {
        let (grid, c) = (self.surface.grid, self.c(i));
        let crossed = self.faces.crossed(grid, node, c);
        let (axis, side) = self.lead(crossed)?;
        let mut beside = node;
        let mut mirror = c;
        let mut plain = true;
        for a in 0..3 {
            match crossed[a] {
                None => {
                    let n = grid.shape[a] as isize;
                    beside[a] = (node[a] as isize - c[a]).rem_euclid(n) as usize;
                }
                Some(s) if matches!(self.faces.at(a, s), Face::Symmetry) => mirror[a] = -c[a],
                Some(_) => plain &= a == axis,
            }
        }
        let [x, y, z] = beside.map(|b| b as isize);
        if self.mask.is_solid(x, y, z) || self.surface.meets_by_half_way(node, i) {
            return None;
        }
        let mirrored = self.direction(mirror)?;
        Some(Passage {
            node,
            direction: i,
            axis,
            side,
            beside,
            mirrored,
            plain,
        })
    }

    /// Whether the link of `node` against direction `i` leaves by an open face.
    pub fn is_open(&self, node: [usize; 3], i: usize) -> bool {
        self.faces.any_open() && self.passage(node, i).is_some()
    }

    /// Notes the link as open, if it is, and says so.
    pub fn add_open(&self, node: [usize; 3], i: usize, link: Link, links: &mut Links) -> bool {
        if !self.faces.any_open() {
            return false;
        }
        let Some(passage) = self.passage(node, i) else {
            return false;
        };
        let kind = self.kind(&passage, links);
        links.openings.push(Open {
            link,
            wall: links.walls.len(),
            face: (passage.axis, passage.side as usize),
            direction: i,
            kind,
        });
        true
    }

    fn kind(&self, passage: &Passage, links: &mut Links) -> Kind {
        let &Passage {
            node,
            direction: i,
            axis,
            side,
            beside,
            mirrored,
            plain,
        } = passage;
        let velocities = self.storage.velocities();
        let weight = velocities.weight(i);
        let (other, from) = if plain { (beside, mirrored) } else { (node, i) };
        match self.faces.at(axis, side) {
            Face::Velocity(profile) => {
                let half = Vec3::from(velocities.c(i).map(f64::from)) * (0.5 * self.surface.grid.spacing);
                let [x, j, k] = node;
                let at = self.surface.grid.position(x, j, k) - half;
                let u = profile(at);
                if let Some(value) = u.iter().copied().find(|u| !u.is_finite()) {
                    links.openings.fault = Some(FaceError::Velocity {
                        axis,
                        side,
                        value,
                        at: at.into(),
                    });
                }
                self.check_speed(axis, side, u.norm(), links);
                Kind::Velocity {
                    push: 6.0 * weight * velocities.along(i, (u / self.surface.velocity_unit).into()),
                }
            }
            // Scaled later to the flux.
            Face::Flux(_) => {
                let shape = self.profiles[axis][side as usize].as_ref();
                let normal = unit(axis) * side.inward() as f64;
                let u = shape.map_or(0.0, |shape| shape.between(node, beside));
                Kind::Velocity {
                    push: 6.0 * weight * velocities.along(i, (normal * u).into()),
                }
            }
            Face::Pressure(pressure) => {
                let unit = self.density * self.surface.velocity_unit.powi(2) / 3.0;
                let samples =
                    [(node, i), (other, from)].map(|(node, i)| (links.openings.sample(node, None, self.storage), i));
                Kind::Pressure {
                    rest: 2.0 * weight * pressure / unit,
                    samples,
                }
            }
            Face::Convective(speed) => {
                let face = links.openings.convective((axis, side as usize));
                links.openings.sample(node, Some(face), self.storage);
                let [x, j, k] = other.map(|n| n as isize);
                let [cx, cy, cz] = self.c(from);
                let [aj, ak] = self.storage.wrapped(j + cy, k + cz);
                Kind::Convective {
                    ahead: [
                        self.storage.index(opposite(from), x, j, k),
                        self.storage.index(from, x + cx, aj, ak),
                    ],
                    speed: speed / self.surface.velocity_unit,
                    weight,
                    face,
                }
            }
            Face::Symmetry | Face::Wall => {
                let [x, j, k] = beside.map(|n| n as isize);
                let [cx, cy, cz] = self.c(mirrored);
                let back = opposite(mirrored);
                let [sj, sk] = self.storage.wrapped(j + cy, k + cz);
                Kind::Mirror {
                    from: Link {
                        ghost: self.storage.index(mirrored, x + cx, sj, sk),
                        home: self.storage.index(back, x, j, k),
                    },
                }
            }
        }
    }

    fn check_speed(&self, axis: usize, side: Side, speed: f64, links: &mut Links) {
        let mach = 3.0_f64.sqrt() * speed / self.surface.velocity_unit;
        if mach > self.mach_limit {
            links.openings.fault.get_or_insert(FaceError::TooFast {
                axis,
                side,
                speed,
                mach,
                limit: self.mach_limit,
                time_step: self.mach_limit / 3.0_f64.sqrt() * self.surface.grid.spacing / speed,
            });
        }
    }

    /// Profiles of the faces with a flux.
    pub fn develop(&mut self) {
        for axis in 0..3 {
            for side in [Side::Low, Side::High] {
                if matches!(self.faces.at(axis, side), Face::Flux(_)) {
                    self.profiles[axis][side as usize] = Some(Developed::new(self, axis, side));
                }
            }
        }
    }

    /// Scales the faces with a flux to it, and compares what goes in with what goes out.
    pub fn settle_fluxes(&self, links: &mut Links) {
        let unit = self.surface.velocity_unit * self.surface.grid.spacing.powi(2);
        for axis in 0..3 {
            for side in [Side::Low, Side::High] {
                let Face::Flux(flux) = *self.faces.at(axis, side) else {
                    continue;
                };
                let here = |open: &Open| open.face == (axis, side as usize);
                let sum: f64 = links.openings.links.iter().filter(|o| here(o)).map(push).sum();
                if sum <= 0.0 {
                    links.openings.fault = Some(FaceError::NoOpening { axis, side, flux });
                    return;
                }
                let factor = flux / unit / sum;
                for open in links.openings.links.iter_mut().filter(|o| here(o)) {
                    if let Kind::Velocity { push } = &mut open.kind {
                        *push *= factor;
                    }
                }
                let greatest = self.profiles[axis][side as usize]
                    .as_ref()
                    .map_or(0.0, Developed::greatest);
                self.check_speed(
                    axis,
                    side,
                    (greatest * factor).abs() * self.surface.velocity_unit,
                    links,
                );
            }
        }
        let free = self.faces.0.iter().flatten().any(Face::is_free);
        let pushes = || links.openings.links.iter().map(push);
        let (sum, size) = (pushes().sum::<f64>(), pushes().map(f64::abs).sum::<f64>());
        if !free && sum.abs() > BALANCED * size {
            links
                .openings
                .fault
                .get_or_insert(FaceError::Unbalanced { flux: sum * unit });
        }
    }
}

/// What a link with a velocity adds to the mass in a step.
fn push(open: &Open) -> f64 {
    match open.kind {
        Kind::Velocity { push } => push,
        _ => 0.0,
    }
}
