//! When the iteration is good enough.

/// Where the iteration of a step ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    /// Slip, relative to the velocity of the fluid without the bodies against their surfaces.
    pub slip: f64,
    /// Most iterations.
    pub iterations: usize,
}

impl Default for End {
    fn default() -> Self {
        Self {
            slip: 1e-3,
            iterations: 30,
        }
    }
}
