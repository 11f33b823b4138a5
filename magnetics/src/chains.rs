//! Chains of beads: which beads form one, how long and how tilted it is, what pulls in it, and how far apart they stand.

use crate::bead::Bead;
use lbm_ibm_coupling::nalgebra::{Matrix3, SymmetricEigen};
use lbm_ibm_coupling::{CellList, Domain, Soa3Ref, Sphere, Vec3};

/// Beads that hang together.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// The beads, in order along the axis.
    pub beads: Vec<usize>,
    /// Unit vector along the chain, its z component not negative.
    pub axis: Vec3,
    /// Extent of the beads' surfaces along the axis, m.
    pub length: f64,
    /// Mean of the beads' centres, m.
    pub centre: Vec3,
}

/// Groups of beads whose surfaces are at most `gap` (m) apart, ordered by their first bead; lone beads are chains of one,
/// with axis z.
pub fn find_chains(beads: &[Bead], x: Soa3Ref<'_>, gap: f64) -> Vec<Chain> {
    let mut group: Vec<usize> = (0..x.len()).collect();
    for_near_pairs(beads, x, gap, |i, j, _| {
        let (a, b) = (root(&mut group, i), root(&mut group, j));
        group[a.max(b)] = a.min(b);
    });
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); x.len()];
    for i in 0..x.len() {
        members[root(&mut group, i)].push(i);
    }
    let found = members.into_iter().filter(|m| !m.is_empty());
    found.map(|m| Chain::new(m, beads, x)).collect()
}

fn root(group: &mut [usize], mut i: usize) -> usize {
    while group[i] != i {
        group[i] = group[group[i]];
        i = group[i];
    }
    i
}

fn for_near_pairs(beads: &[Bead], x: Soa3Ref<'_>, gap: f64, mut pair: impl FnMut(usize, usize, f64)) {
    let largest = beads.iter().map(Bead::radius).fold(0.0, f64::max);
    let reach = 2.0 * largest + gap.max(0.0);
    if x.len() < 2 || reach <= 0.0 {
        return;
    }
    let mut cells = CellList::new();
    cells.build(x, &Domain::unbounded(), reach);
    cells.for_each_pair(|i, j| {
        let between = (x.get(i) - x.get(j)).norm() - beads[i].radius() - beads[j].radius();
        if between <= gap {
            pair(i, j, between);
        }
    });
}

impl Chain {
    fn new(mut members: Vec<usize>, beads: &[Bead], x: Soa3Ref<'_>) -> Self {
        let centre = members.iter().map(|i| x.get(*i)).sum::<Vec3>() / members.len() as f64;
        let axis = if members.len() == 1 {
            Vec3::z()
        } else {
            let spread: Matrix3<f64> = members
                .iter()
                .map(|i| (x.get(*i) - centre) * (x.get(*i) - centre).transpose())
                .sum();
            let eigen = SymmetricEigen::new(spread / spread.norm().max(f64::MIN_POSITIVE));
            let axis = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
            if axis.z < 0.0 { -axis } else { axis }
        };
        let along = |i: usize| (x.get(i) - centre).dot(&axis);
        members.sort_by(|a, b| along(*a).total_cmp(&along(*b)));
        let top = members
            .iter()
            .map(|i| along(*i) + beads[*i].radius())
            .fold(f64::NEG_INFINITY, f64::max);
        let bottom = members
            .iter()
            .map(|i| along(*i) - beads[*i].radius())
            .fold(f64::INFINITY, f64::min);
        Self {
            beads: members,
            axis,
            length: top - bottom,
            centre,
        }
    }

    /// Angle (rad, 0 to pi/2) between the chain and `direction`, of any length.
    pub fn tilt(&self, direction: Vec3) -> f64 {
        let cross = self.axis.cross(&direction).norm();
        cross.atan2(self.axis.dot(&direction).abs())
    }

    /// The beads as spheres, in order along the axis: a frozen chain for the crate of contact to make a wall of.
    pub fn spheres(&self, beads: &[Bead], x: Soa3Ref<'_>) -> Vec<Sphere> {
        let sphere = |i: &usize| Sphere::new(x.get(*i), beads[*i].radius());
        self.beads.iter().map(sphere).collect()
    }

    /// Tension (N) in each contact along the chain under `force` (N, one per bead of the scene): half the difference of the
    /// pulls on both sides along the axis. Positive holds the chain together.
    pub fn tension(&self, force: Soa3Ref<'_>) -> Vec<f64> {
        let pull: Vec<f64> = self.beads.iter().map(|i| force.get(*i).dot(&self.axis)).collect();
        let total: f64 = pull.iter().sum();
        let mut below = 0.0;
        pull[..pull.len() - 1]
            .iter()
            .map(|p| {
                below += p;
                0.5 * (below - (total - below))
            })
            .collect()
    }
}

/// How many chains have 1, 2, 3, ... beads.
pub fn chain_histogram(chains: &[Chain]) -> Vec<usize> {
    let longest = chains.iter().map(|c| c.beads.len()).max().unwrap_or(0);
    let mut count = vec![0; longest];
    for chain in chains {
        count[chain.beads.len() - 1] += 1;
    }
    count
}

/// Gap (m) between the surfaces of each chain and its nearest neighbour, for neighbours within `reach` (m); infinite else.
pub fn chain_gaps(chains: &[Chain], beads: &[Bead], x: Soa3Ref<'_>, reach: f64) -> Vec<f64> {
    let mut of = vec![usize::MAX; x.len()];
    for (c, chain) in chains.iter().enumerate() {
        for i in &chain.beads {
            of[*i] = c;
        }
    }
    let mut gaps = vec![f64::INFINITY; chains.len()];
    for_near_pairs(beads, x, reach, |i, j, between| {
        if of[i] != of[j] && of[i] != usize::MAX && of[j] != usize::MAX {
            gaps[of[i]] = gaps[of[i]].min(between);
            gaps[of[j]] = gaps[of[j]].min(between);
        }
    });
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Intrinsic;
    use approx::assert_relative_eq;
    use lbm_ibm_coupling::Soa3;

    #[test]
    fn two_tilted_chains_are_found_with_length_tilt_gap_and_tension() {
        let bead = Bead::new(1.0, 1500.0, Intrinsic::new(1.0).unwrap()).unwrap();
        let lean = Vec3::new(0.6, 0.0, 0.8);
        let mut x = Soa3::default();
        for k in [2.0, 0.0, 1.0] {
            x.push(lean * (2.01 * k));
            x.push(Vec3::y() * 5.0 + lean * (2.01 * k));
        }
        x.push(Vec3::new(50.0, 0.0, 0.0));
        let beads = vec![bead; 7];
        let chains = find_chains(&beads, x.view(), 0.05);
        assert_eq!(chains.len(), 3);
        assert_eq!(chains[0].beads, [2, 4, 0]);
        assert_eq!(chains[2].beads, [6]);
        assert_relative_eq!(chains[0].length, 6.02, max_relative = 1e-12);
        assert_relative_eq!(chains[1].tilt(Vec3::z() * -3.0), 0.6f64.asin(), max_relative = 1e-10);
        assert_eq!(chain_histogram(&chains), [1, 0, 2]);
        let spheres = chains[1].spheres(&beads, x.view());
        assert_relative_eq!(spheres[2].centre, Vec3::y() * 5.0 + lean * 4.02, epsilon = 1e-12);
        let gaps = chain_gaps(&chains, &beads, x.view(), 10.0);
        assert_relative_eq!(gaps[0], 3.0, max_relative = 1e-12);
        assert_eq!(gaps[2], f64::INFINITY);
        let mut force = Soa3::zeros(7);
        force.set(2, lean * 3.0);
        force.set(0, lean * -3.0);
        assert_relative_eq!(chains[0].tension(force.view())[1], 3.0, max_relative = 1e-12);
    }
}
