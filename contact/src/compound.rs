//! Points and the union of several parry shapes.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::{Real, Vector};
use parry3d_f64::query::PointProjection;
use parry3d_f64::shape::{CompositeShapeRef, Compound};

/// The part of `compound` that answers for `point`, and the nearest place of its surface: of the parts that hold the
/// point the one that holds it deepest, else the nearest.
///
/// parry ranks parts by the bare distance to their surfaces: a point deep in one part and close before another would
/// be told to be outside.
pub(crate) fn project(compound: &Compound, point: Vector) -> Option<(u32, PointProjection)> {
    compound
        .bvh()
        .intersect_aabb(&Aabb::new(point, point))
        .filter_map(|part| {
            let (pose, shape) = &compound.shapes()[part as usize];
            let projection = shape.project_point(pose, point, false);
            projection.is_inside.then_some((part, projection))
        })
        .max_by(|(_, a), (_, b)| (a.point - point).length().total_cmp(&(b.point - point).length()))
        .or_else(|| CompositeShapeRef(compound).project_local_point(point, Real::MAX, false))
}
