//! Collision models.

use crate::real::Real;
use crate::stencil::Stencil;

/// How the populations of a node collide. With [`Fluid::with_model`](crate::Fluid::with_model) a model of any crate runs at
/// the speed of the built-in ones: it is written once for [`Real`], and compiled for every instruction set and precision.
///
/// Write `collide` without branches on the populations and mark it, and what it calls, `#[inline(always)]`, or it will not be
/// vectorised. Write loops rather than `map` and `from_fn`: a closure that the compiler happens not to inline is compiled without
/// the instruction set of the kernel, and each of its operations becomes a call. Central moments were seven times slower so.
///
/// The convention: `f` are the populations less their weights, so their sum is the density less 1; forces are in lattice
/// units; a force is to be added to second order (Guo, Zheng and Shi 2002), with half of it in the velocity.
pub trait Model<const Q: usize>: Clone + Send + Sync + 'static {
    /// The lattice velocities.
    type Stencil: Stencil<Q>;

    /// Collides one node, or a vector of nodes, in place. `force` counts only where `FORCE` is set. Returns the momentum
    /// before the collision, without half the force.
    fn collide<V: Real, const FORCE: bool>(&self, f: &mut [V; Q], force: [V; 3]) -> [V; 3];
}
