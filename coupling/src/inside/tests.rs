use super::Inside;
use crate::{BodyInfo, Grid, Motion, Soa3, Vec3, enclosed_volume};

/// An octahedron divided `times` times, on a sphere of radius 1.
fn sphere(times: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut nodes: Vec<Vec3> = [Vec3::x(), Vec3::y(), Vec3::z()]
        .into_iter()
        .flat_map(|v| [v, -v])
        .collect();
    let mut triangles = vec![
        [0, 2, 4],
        [2, 1, 4],
        [1, 3, 4],
        [3, 0, 4],
        [2, 0, 5],
        [1, 2, 5],
        [3, 1, 5],
        [0, 3, 5],
    ];
    for _ in 0..times {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                nodes.push((nodes[a as usize] + nodes[b as usize]).normalize());
                nodes.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    (nodes, triangles)
}

fn found(grid: &Grid, place: impl Fn(Vec3) -> Vec3) -> (Inside, f64) {
    let (nodes, triangles) = sphere(3);
    let x: Soa3 = nodes.into_iter().map(place).collect();
    let exact = enclosed_volume(x.view(), &triangles) / grid.spacing.powi(3);
    let body = BodyInfo {
        id: 0,
        kind: "cell".into(),
        range: 0..x.len(),
        triangles: triangles.into(),
        motion: Motion::Advected,
    };
    let mut inside = Inside::new(grid);
    inside.find(grid, x.view(), std::iter::once((&body, 5.0)));
    (inside, exact)
}

#[test]
fn the_volume_inside_is_that_of_the_surface() {
    let grid = Grid::new([24, 22, 20], 0.5, [true; 3]);
    for n in 0..20 {
        let s = 0.37 * f64::from(n);
        // Rolled, flattened, in every place of a cell, over the faces of the box as well; the first with nodes on rays.
        let turn = nalgebra::Rotation3::new(Vec3::new(s, 2.0 * s, -s));
        let size = Vec3::new(4.0, 3.0, 2.5);
        let (inside, exact) = found(&grid, |p| {
            turn * p.component_mul(&size) + Vec3::new(6.25 + s, 5.25 + 0.1 * s, 5.25)
        });
        let error = inside.volume() / exact - 1.0;
        assert!(error.abs() < 1e-3, "{n}: {error:e}");
    }
}

#[test]
fn nodes_are_inside_where_they_are() {
    let grid = Grid::new([20, 20, 20], 1.0, [true, false, true]);
    let centre = Vec3::new(2.3, 9.6, 10.0);
    let (inside, _) = found(&grid, |p| 6.0 * p + centre);
    for k in 0..20 {
        for j in 0..20 {
            let ([from, to], levels) = inside.row(j, k);
            for i in 0..20 {
                let level = if (from..to).contains(&i) { levels[i - from] } else { 0 };
                let r = grid.domain().shortest(grid.position(i, j, k) - centre).norm();
                let ratio = inside.ratio(level);
                if r < 5.0 {
                    assert_eq!(ratio, 5.0, "{i} {j} {k}");
                } else if r > 7.0 {
                    assert_eq!(ratio, 1.0, "{i} {j} {k}");
                }
            }
        }
    }
}

#[test]
fn what_has_been_inside_is_forgotten() {
    let grid = Grid::new([16; 3], 1.0, [true; 3]);
    let (mut inside, _) = found(&grid, |p| 4.0 * p + Vec3::repeat(8.0));
    inside.find(&grid, Soa3::default().view(), std::iter::empty());
    assert_eq!(inside.volume(), 0.0);
}
