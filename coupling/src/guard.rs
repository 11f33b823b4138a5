//! Watches a run and names the first thing that goes wrong.

mod edges;

use crate::{BodyInfo, Boundary, Domain, SceneError, Soa3Ref, Vec3, enclosed_volume, surface_area};

/// What a run may do before it is ended with a [`SceneError`].
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// Steps between two looks.
    pub every: u64,
    /// Greatest way of a node in one step, in grid spacings (only in a scene with a fluid).
    pub displacement: f64,
    /// Greatest relative change of the volume of a closed body.
    pub volume: f64,
    /// Greatest relative growth of the area of a body.
    pub area: f64,
    /// Least area of a triangle relative to rest.
    pub triangle: f64,
    /// Greatest length of an edge relative to rest.
    pub stretch: f64,
    /// Greatest angle between the normals of two neighbouring triangles, rad: near pi one of them has turned over.
    /// Triangles that enclose more at rest are not looked at.
    pub fold: f64,
    /// Greatest depth of a node in a wall, m.
    pub depth: f64,
}

impl Default for Guard {
    fn default() -> Self {
        Self {
            every: 100,
            displacement: 0.25,
            volume: 0.05,
            area: 1.0,
            triangle: 1e-3,
            stretch: 10.0,
            fold: 175.0_f64.to_radians(),
            depth: 0.0,
        }
    }
}

/// Volume and areas of a body at rest.
#[derive(Clone, Debug, Default)]
pub(crate) struct RestShape {
    volume: f64,
    area: f64,
    triangle: Vec<f64>,
    edges: Vec<edges::Edge>,
}

impl RestShape {
    pub(crate) fn of(x: Soa3Ref<'_>, triangles: &[[u32; 3]]) -> Self {
        Self {
            volume: enclosed_volume(x, triangles),
            area: surface_area(x, triangles),
            triangle: triangles.iter().map(|t| surface_area(x, &[*t])).collect(),
            edges: edges::of(x, triangles),
        }
    }
}

/// What the guard knows of a scene when it looks.
pub(crate) struct Scope<'a> {
    pub x: Soa3Ref<'a>,
    pub v: Soa3Ref<'a>,
    pub spacing: Option<f64>,
    pub time_step: f64,
    pub time: f64,
    pub step: u64,
    pub walls: Option<&'a dyn Boundary>,
    pub domain: &'a Domain,
}

impl Guard {
    /// Looks at one body whose nodes `scope.x` and `scope.v` are.
    pub(crate) fn look(&self, body: &BodyInfo, rest: &RestShape, scope: &Scope<'_>) -> Result<(), SceneError> {
        self.finite_and_slow(body, scope)?;
        self.shape(body, rest, scope)?;
        match scope.walls {
            Some(walls) => outside_walls(body, scope.x, walls, scope.domain, scope.time, self.depth),
            None => Ok(()),
        }
    }

    fn finite_and_slow(&self, body: &BodyInfo, scope: &Scope<'_>) -> Result<(), SceneError> {
        let limit = scope.spacing.map_or(f64::INFINITY, |h| h * self.displacement);
        for (node, (x, v)) in scope.x.iter().zip(scope.v.iter()).enumerate() {
            if !(x.norm_squared() + v.norm_squared()).is_finite() {
                return Err(SceneError::NotFinite {
                    body: body.id,
                    kind: body.kind.clone(),
                    node,
                    step: scope.step,
                });
            }
            let distance = v.norm() * scope.time_step;
            if distance > limit {
                return Err(SceneError::Displacement {
                    body: body.id,
                    kind: body.kind.clone(),
                    node,
                    distance,
                    limit,
                    step: scope.step,
                });
            }
        }
        Ok(())
    }

    fn shape(&self, body: &BodyInfo, rest: &RestShape, scope: &Scope<'_>) -> Result<(), SceneError> {
        if rest.volume <= 0.0 {
            return Ok(());
        }
        let drift = enclosed_volume(scope.x, &body.triangles) / rest.volume - 1.0;
        if drift.abs() > self.volume {
            return Err(SceneError::VolumeDrift {
                body: body.id,
                kind: body.kind.clone(),
                percent: 100.0 * drift,
                limit_percent: 100.0 * self.volume,
                step: scope.step,
            });
        }
        let strain = surface_area(scope.x, &body.triangles) / rest.area - 1.0;
        if strain > self.area {
            return Err(SceneError::AreaStrain {
                body: body.id,
                kind: body.kind.clone(),
                strain,
                limit: self.area,
                step: scope.step,
            });
        }
        for (triangle, (t, area)) in body.triangles.iter().zip(&rest.triangle).enumerate() {
            let ratio = surface_area(scope.x, &[*t]) / area;
            if ratio < self.triangle {
                return Err(SceneError::CollapsedTriangle {
                    body: body.id,
                    kind: body.kind.clone(),
                    triangle,
                    ratio,
                    step: scope.step,
                });
            }
        }
        self.edges(body, &rest.edges, scope.x, scope.step)
    }
}

/// Reports a body that is deeper than `depth` (m) in a wall.
pub(crate) fn outside_walls(
    body: &BodyInfo,
    x: Soa3Ref<'_>,
    walls: &dyn Boundary,
    domain: &Domain,
    time: f64,
    depth: f64,
) -> Result<(), SceneError> {
    let mut inside = 0;
    let mut deepest = (0.0, 0, Vec3::zeros());
    for p in x.iter() {
        let probe = walls.probe(domain.wrap(p), time);
        if probe.distance < -depth {
            inside += 1;
            if -probe.distance > deepest.0 {
                deepest = (-probe.distance, probe.part, p);
            }
        }
    }
    if inside == 0 {
        return Ok(());
    }
    Err(SceneError::BodyInWall {
        body: body.id,
        kind: body.kind.clone(),
        inside,
        nodes: x.len(),
        part: deepest.1,
        depth: deepest.0,
        position: deepest.2.into(),
    })
}
