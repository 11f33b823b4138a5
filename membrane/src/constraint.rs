//! What a cell keeps exactly.

use crate::Mesh;
use crate::laws::{corners, twice_area};
use lbm_ibm_coupling::{Soa3, Soa3Mut, Soa3Ref, enclosed_volume};

/// The volume of a cell, held.
#[derive(Clone, Debug)]
pub(crate) struct ConstantVolume {
    volume: f64,
    /// Gradient of the volume by the place of each node, m2.
    gradient: Soa3,
}

impl ConstantVolume {
    /// At the volume of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        Self {
            volume: mesh.volume(),
            gradient: Soa3::zeros(mesh.nodes().len()),
        }
    }

    /// Moves nodes `x` (m) along the gradient of the volume to where it is the cell's own, to the first order of what is
    /// missing.
    pub fn restore(&mut self, triangles: &[[u32; 3]], x: &mut Soa3Mut<'_>) {
        let at = Soa3Ref { x: x.x, y: x.y, z: x.z };
        self.gradient.fill(0.0);
        for &triangle in triangles {
            let share = twice_area(corners(at, triangle)) / 6.0;
            for node in triangle {
                self.gradient.add(node as usize, share);
            }
        }
        let missing = self.volume - enclosed_volume(at, triangles);
        let step = missing / self.gradient.iter().map(|g| g.norm_squared()).sum::<f64>();
        for i in 0..self.gradient.len() {
            x.add(i, self.gradient.get(i) * step);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ConstantVolume;
    use crate::Mesh;
    use lbm_ibm_coupling::{Soa3, Vec3, enclosed_volume};

    #[test]
    fn a_deformed_cell_gets_its_volume_back_and_keeps_its_place_and_turn() {
        let mesh = Mesh::ellipsoid(Vec3::new(4e-6, 3e-6, 2e-6), 200).expect("an ellipsoid");
        let mut x: Soa3 = mesh
            .nodes()
            .iter()
            .map(|p| p * 1.001 + Vec3::new(1e-5, 0.0, 0.0))
            .collect();
        let before: Soa3 = x.iter().collect();
        ConstantVolume::of(&mesh).restore(mesh.triangles(), &mut x.view_mut());
        let error = enclosed_volume(x.view(), mesh.triangles()) / mesh.volume() - 1.0;
        assert!(error.abs() < 1e-5, "{error:e}");
        let moved: Vec3 = x.iter().zip(before.iter()).map(|(p, q)| p - q).sum();
        let turned: Vec3 = x.iter().zip(before.iter()).map(|(p, q)| q.cross(&(p - q))).sum();
        assert!(
            moved.norm() < 1e-12 * 4e-6 && turned.norm() < 1e-9 * 4e-6 * 4e-6,
            "{moved} {turned}"
        );
    }
}
