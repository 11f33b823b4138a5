//! What velocities forces give to beads: one block per bead near its wall, or one matrix for all with hydrodynamic interaction.

use super::drag::{WallDrag, parallel_drag, squeeze_mobility};
use crate::bead::Bead;
use crate::error::MagneticsError;
use lbm_ibm_coupling::nalgebra::{Cholesky, DMatrix, DVector, Matrix3};
use lbm_ibm_coupling::{Boundary, Soa3, Vec3};
use std::f64::consts::PI;

/// Beads farther apart than this many mean radii are not lubricated.
const LUBRICATED: f64 = 12.0;

/// How beads drag each other along.
///
/// Both interactions are one symmetric positive matrix for all beads; near a wall the pair terms shrink with the mobilities of
/// their beads, M_ij = b_i^1/2 M_ij b_j^1/2. Frozen beads take no part. Cost: square of the number of beads, with
/// lubrication its cube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum PairMobility {
    /// Not at all.
    #[default]
    None,
    /// The tensor of Rotne and Prager (unequal radii: Zuk et al. 2014), overlapping beads as at contact.
    RotnePrager,
    /// Rotne and Prager, and for each pair a resistance to approach that makes a lone pair of equal spheres exact
    /// ([`squeeze_mobility`], Brenner 1961; mean radius for unequal ones): lubrication, cut off at the roughness. The resistances
    /// add up over pairs, as in Stokesian dynamics.
    Squeeze,
}

/// Mobility of one bead, m/(s N): towards the wall along `normal`, and along it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    pub normal: Vec3,
    pub towards: f64,
    pub along: f64,
}

impl Block {
    pub const HELD: Self = Self {
        normal: Vec3::new(0.0, 0.0, 0.0),
        towards: 0.0,
        along: 0.0,
    };

    /// The block with `f` of its two mobilities.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Self {
        Self {
            normal: self.normal,
            towards: f(self.towards),
            along: f(self.along),
        }
    }

    pub fn times(&self, f: Vec3) -> Vec3 {
        f * self.along + self.normal * (self.normal.dot(&f) * (self.towards - self.along))
    }

    pub fn matrix(&self) -> Matrix3<f64> {
        Matrix3::identity() * self.along + self.normal * self.normal.transpose() * (self.towards - self.along)
    }
}

/// Velocities from forces.
#[derive(Clone, Debug)]
pub(super) enum Mobility {
    Blocks(Vec<Block>),
    /// Blocks, and the matrix of all free beads; `row` says where a bead stands in it.
    Dense {
        matrix: DMatrix<f64>,
        row: Vec<Option<usize>>,
    },
}

impl Default for Mobility {
    fn default() -> Self {
        Self::Blocks(Vec::new())
    }
}

impl Mobility {
    /// Adds M f to `v`.
    pub fn add(&self, force: &Soa3, v: &mut Soa3) {
        match self {
            Self::Blocks(blocks) => {
                for (i, b) in blocks.iter().enumerate() {
                    v.add(i, b.times(force.get(i)));
                }
            }
            Self::Dense { matrix, row } => {
                let out = matrix * gather(row, matrix.nrows(), force);
                scatter(row, &out, v);
            }
        }
    }

    /// Adds to `v` what the force `f` on bead `i` does.
    pub fn kick(&self, i: usize, f: Vec3, v: &mut Soa3) {
        match self {
            Self::Blocks(blocks) => v.add(i, blocks[i].times(f)),
            Self::Dense { matrix, row } => {
                let Some(at) = row[i] else { return };
                for (k, r) in row.iter().enumerate() {
                    if let Some(r) = r {
                        v.add(k, matrix.fixed_view::<3, 3>(3 * r, 3 * at) * f);
                    }
                }
            }
        }
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        match self {
            Self::Blocks(blocks) if i == j => blocks[i].matrix(),
            Self::Dense { matrix, row } => match (row[i], row[j]) {
                (Some(a), Some(b)) => matrix.fixed_view::<3, 3>(3 * a, 3 * b).into_owned(),
                _ => Matrix3::zeros(),
            },
            Self::Blocks(_) => Matrix3::zeros(),
        }
    }

    /// Velocity of bead `i` relative to `j` (or to a wall) per force on `i` and minus it on `j`.
    pub fn relative(&self, i: usize, j: Option<usize>) -> Matrix3<f64> {
        let own = self.block(i, i);
        match j {
            Some(j) => own + self.block(j, j) - self.block(i, j) - self.block(j, i),
            None => own,
        }
    }

    /// A root B of the mobility, M = B B^T, times `noise`, and the force that makes that velocity.
    ///
    /// # Errors
    /// [`MagneticsError::Mobility`] for a matrix without a root.
    pub fn root_times(&self, noise: &Soa3) -> Result<(Soa3, Soa3), MagneticsError> {
        let n = noise.len();
        let (mut v, mut f) = (Soa3::zeros(n), Soa3::zeros(n));
        match self {
            Self::Blocks(blocks) => {
                for (i, b) in blocks.iter().enumerate() {
                    v.set(i, b.map(f64::sqrt).times(noise.get(i)));
                    f.set(
                        i,
                        b.map(|m| if m > 0.0 { m.sqrt().recip() } else { 0.0 })
                            .times(noise.get(i)),
                    );
                }
            }
            Self::Dense { matrix, row } => {
                let root = Cholesky::new(matrix.clone()).ok_or(MagneticsError::Mobility)?;
                let noise = gather(row, matrix.nrows(), noise);
                scatter(row, &(root.l() * &noise), &mut v);
                let force = root
                    .l()
                    .tr_solve_lower_triangular(&noise)
                    .ok_or(MagneticsError::Mobility)?;
                scatter(row, &force, &mut f);
            }
        }
        Ok((v, f))
    }
}

fn gather(row: &[Option<usize>], n: usize, from: &Soa3) -> DVector<f64> {
    let mut out = DVector::zeros(n);
    for (i, r) in row.iter().enumerate() {
        if let Some(r) = r {
            out.fixed_rows_mut::<3>(3 * r).copy_from(&from.get(i));
        }
    }
    out
}

fn scatter(row: &[Option<usize>], from: &DVector<f64>, to: &mut Soa3) {
    for (i, r) in row.iter().enumerate() {
        if let Some(r) = r {
            to.add(i, from.fixed_rows::<3>(3 * r).into_owned());
        }
    }
}

/// What sets the mobility of beads.
#[derive(Clone, Copy, Debug)]
pub(super) struct MobilityLaw {
    pub viscosity: f64,
    pub pair: PairMobility,
    pub wall: WallDrag,
    /// Gap in radii below which drag grows no more.
    pub roughness: f64,
}

impl MobilityLaw {
    /// 6 pi eta a, N s/m.
    pub fn stokes(&self, radius: f64) -> f64 {
        6.0 * PI * self.viscosity * radius
    }

    /// Mobility of each bead alone near its wall.
    pub fn blocks(&self, beads: &[Bead], held: &[bool], x: &Soa3, t: f64, walls: Option<&dyn Boundary>) -> Vec<Block> {
        let rough = [self.wall.perpendicular(self.roughness), parallel_drag(self.roughness)];
        let block = |(i, bead): (usize, &Bead)| {
            if held[i] {
                return Block::HELD;
            }
            let free = 1.0 / (6.0 * PI * self.viscosity * bead.radius());
            let Some(walls) = walls else {
                return Block {
                    normal: Vec3::z(),
                    towards: free,
                    along: free,
                };
            };
            let probe = walls.probe(x.get(i), t);
            let gap = probe.distance / bead.radius() - 1.0;
            let [towards, along] = if gap <= self.roughness {
                rough
            } else if gap.is_finite() {
                [self.wall.perpendicular(gap), parallel_drag(gap)]
            } else {
                [1.0; 2]
            };
            Block {
                normal: probe.normal,
                towards: free / towards,
                along: free / along,
            }
        };
        beads.iter().enumerate().map(block).collect()
    }

    /// Mobility of all beads together.
    ///
    /// # Errors
    /// [`MagneticsError::Mobility`] when the matrix is not positive.
    pub fn build(
        &self,
        beads: &[Bead],
        held: &[bool],
        x: &Soa3,
        t: f64,
        walls: Option<&dyn Boundary>,
    ) -> Result<Mobility, MagneticsError> {
        let blocks = self.blocks(beads, held, x, t, walls);
        if self.pair == PairMobility::None {
            return Ok(Mobility::Blocks(blocks));
        }
        let mut free = Vec::new();
        let mut row = vec![None; beads.len()];
        for i in (0..beads.len()).filter(|i| !held[*i]) {
            row[i] = Some(free.len());
            free.push(i);
        }
        let mut matrix = DMatrix::zeros(3 * free.len(), 3 * free.len());
        let mut lubrication = Vec::new();
        for (a, &i) in free.iter().enumerate() {
            matrix
                .fixed_view_mut::<3, 3>(3 * a, 3 * a)
                .copy_from(&blocks[i].matrix());
            for (b, &j) in free[..a].iter().enumerate() {
                let (r, radii) = (x.get(i) - x.get(j), [beads[i].radius(), beads[j].radius()]);
                let stokes = radii.map(|a| 1.0 / (6.0 * PI * self.viscosity * a));
                let screen = |k: usize, own: f64| blocks[k].map(|m| (m / own).sqrt()).matrix();
                let cross = rotne_prager(r, radii, self.viscosity);
                let block = screen(i, stokes[0]) * cross * screen(j, stokes[1]);
                matrix.fixed_view_mut::<3, 3>(3 * a, 3 * b).copy_from(&block);
                matrix
                    .fixed_view_mut::<3, 3>(3 * b, 3 * a)
                    .copy_from(&block.transpose());
                let x = 2.0 * r.norm() / (radii[0] + radii[1]);
                if self.pair == PairMobility::Squeeze && x < LUBRICATED {
                    let n = r / r.norm();
                    let far = stokes[0] + stokes[1] - 2.0 * n.dot(&(cross * n));
                    let x = x.max(2.0 + self.roughness);
                    let resistance = ((1.0 - 1.5 / x + 1.0 / (x * x * x)) / squeeze_mobility(x) - 1.0) / far;
                    lubrication.push((a, b, n, resistance));
                }
            }
        }
        if !lubrication.is_empty() {
            matrix = lubricate(matrix, &lubrication)?;
        }
        Ok(Mobility::Dense { matrix, row })
    }
}

/// (M^-1 + L)^-1 = C (1 + C^T L C)^-1 C^T with M = C C^T, L the sum of the pairs' resistances to approach.
fn lubricate(m: DMatrix<f64>, pairs: &[(usize, usize, Vec3, f64)]) -> Result<DMatrix<f64>, MagneticsError> {
    let root = Cholesky::new(m).ok_or(MagneticsError::Mobility)?.unpack();
    let mut stretch = DMatrix::zeros(pairs.len(), root.nrows());
    for (k, (a, b, n, resistance)) in pairs.iter().enumerate() {
        let rows = root.fixed_rows::<3>(3 * a) - root.fixed_rows::<3>(3 * b);
        stretch.set_row(k, &(n.transpose() * rows * resistance.max(0.0).sqrt()));
    }
    let mut inner = stretch.tr_mul(&stretch);
    for k in 0..inner.nrows() {
        inner[(k, k)] += 1.0;
    }
    let inner = Cholesky::new(inner).ok_or(MagneticsError::Mobility)?;
    Ok(&root * inner.solve(&root.transpose()))
}

/// Velocity of one bead per force on another, `r` (m) between them.
fn rotne_prager(r: Vec3, radii: [f64; 2], viscosity: f64) -> Matrix3<f64> {
    let distance = r.norm();
    let n = if distance > 0.0 { r / distance } else { Vec3::zeros() };
    let far = distance.max(radii[0] + radii[1]);
    let squares = (radii[0].powi(2) + radii[1].powi(2)) / (far * far);
    (Matrix3::identity() * (1.0 + squares / 3.0) + n * n.transpose() * (1.0 - squares)) / (8.0 * PI * viscosity * far)
}
