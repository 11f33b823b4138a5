//! A sphere as plain data, handed from one crate to another.

use crate::Vec3;

/// A sphere: a bead of a chain, a post.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, m.
    pub centre: Vec3,
    /// Radius, m.
    pub radius: f64,
}

impl Sphere {
    /// A sphere of `radius` about `centre`, m.
    pub fn new(centre: Vec3, radius: f64) -> Self {
        Self { centre, radius }
    }
}
