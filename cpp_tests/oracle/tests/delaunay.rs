//! The set of tetrahedra is CGAL's, whatever the points and the order in which they come.

mod common;

use common::*;
use proptest::prelude::*;
use wellspaced::Control;
use wellspaced_oracle::Point;

/// Bulk, one by one, and half of each.
fn every_way(points: &[Point]) -> Result<(), TestCaseError> {
    let (mesh, ids) = bulk(points);
    same_as_cgal(&mesh, points, &ids)?;
    // Ids follow the input: a point that is no duplicate gets the next one.
    let mut next = 0;
    for (i, &id) in ids.iter().enumerate() {
        match points[..i].iter().position(|p| *p == points[i]) {
            Some(first) => prop_assert_eq!(id, ids[first]),
            None => {
                prop_assert!(i == 0 || id >= next, "ids {:?} do not follow the input", &ids);
                next = id + 1;
            }
        }
    }

    let (mesh, ids) = one_by_one(points);
    same_as_cgal(&mesh, points, &ids)?;

    let (first, second) = points.split_at(points.len() / 2);
    let (mut mesh, mut ids) = bulk(first);
    let mut more = Vec::new();
    prop_assert!(mesh.insert(&dvecs(second), Some(&mut more), &Control::default()).unwrap());
    ids.extend(more);
    same_as_cgal(&mesh, points, &ids)
}

proptest! {
    #![proptest_config(config(200))]

    #[test]
    fn uniform_points(points in sets(uniform(), 80)) { every_way(&points)?; }

    #[test]
    fn grid_of_two(points in sets(grid(2), 12)) { every_way(&points)?; }

    #[test]
    fn grid_of_three(points in sets(grid(3), 30)) { every_way(&points)?; }

    #[test]
    fn grid_of_four(points in sets(grid(4), 70)) { every_way(&points)?; }

    #[test]
    fn points_on_one_sphere(points in sets(cospherical(), 60)) { every_way(&points)?; }

    #[test]
    fn points_beside_one_sphere(points in sets(on_sphere(), 60)) { every_way(&points)?; }

    #[test]
    fn points_beside_a_grid(points in sets(grid_nudged(), 40)) { every_way(&points)?; }

    #[test]
    fn points_in_a_plane(points in sets(coplanar(), 30), off in sets(grid(6), 3)) {
        every_way(&points)?;
        every_way(&[points, off].concat())?;
    }

    #[test]
    fn points_on_a_line(points in sets(collinear(), 30), off in sets(grid(6), 3)) {
        every_way(&points)?;
        every_way(&[points, off].concat())?;
    }

    #[test]
    fn clusters(points in sets(clustered(), 60)) { every_way(&points)?; }

    #[test]
    fn all_magnitudes(points in sets(mixed_exponents(), 30)) { every_way(&points)?; }

    #[test]
    fn mixtures(points in sets(mixed(), 60)) { every_way(&points)?; }

    #[test]
    fn order_does_not_matter(
        (points, shuffled) in sets(prop_oneof![grid(3), cospherical()], 40)
            .prop_flat_map(|points| (Just(points.clone()), Just(points).prop_shuffle())),
    ) {
        let shape = |points: &[Point]| {
            let (mesh, _) = bulk(points);
            let view = mesh.view();
            let mut cells: Vec<_> = view
                .tetrahedra
                .iter()
                .map(|t| {
                    let mut corners = t.map(|v| view.points[v as usize].to_array().map(|x| x as i64));
                    corners.sort_unstable();
                    corners
                })
                .collect();
            cells.sort_unstable();
            cells
        };
        prop_assert_eq!(shape(&points), shape(&shuffled));
    }
}

#[test]
fn every_prefix_of_a_rising_dimension() {
    // A point, it again, a line outside in, a plane, then space.
    let points: Vec<Point> = [
        [0, 0, 0],
        [0, 0, 0],
        [4, 0, 0],
        [2, 0, 0],
        [-1, 0, 0],
        [4, 0, 0],
        [1, 3, 0],
        [2, -1, 0],
        [0, 0, 0],
        [7, 0, 0],
        [3, 3, 0],
        [2, 1, 5],
        [2, 1, -5],
        [2, 1, 0],
        [-9, 0, 0],
        [3, 1, 9],
    ]
    .iter()
    .map(|p| p.map(f64::from))
    .collect();
    for n in 0..=points.len() {
        every_way(&points[..n]).unwrap();
    }
}

#[test]
fn whole_grids() {
    for n in 2..=7 {
        let points: Vec<Point> = (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n].map(f64::from)).collect();
        let (mesh, ids) = bulk(&points);
        same_as_cgal(&mesh, &points, &ids).unwrap();
        let shifted: Vec<Point> = points.iter().map(|p| p.map(|x| x * 0.1 + 1e7)).collect();
        let (mesh, ids) = bulk(&shifted);
        same_as_cgal(&mesh, &shifted, &ids).unwrap();
    }
}

#[test]
fn nothing_and_one_point_many_times() {
    let (mesh, ids) = bulk(&[]);
    same_as_cgal(&mesh, &[], &ids).unwrap();
    let same = vec![[0.1, 0.2, 0.3]; 500];
    let (mesh, ids) = bulk(&same);
    same_as_cgal(&mesh, &same, &ids).unwrap();
    assert!(ids.iter().all(|&id| id == ids[0]));
    // The signs of zero do not tell points apart.
    let zeros = [[0.0, -0.0, 0.0], [-0.0, 0.0, -0.0], [1.0, 0.0, 0.0]];
    let (mesh, ids) = bulk(&zeros);
    assert_eq!(ids[0], ids[1]);
    assert_eq!(mesh.triangulation().vertex_count(), 2);
}

#[test]
fn a_refused_call_inserts_nothing() {
    let (mut mesh, _) = bulk(&[[0.0; 3], [1.0, 0.0, 0.0]]);
    let bad = [[0.5, 0.5, 0.5], [0.0, f64::NAN, 0.0]];
    assert!(mesh.insert(&dvecs(&bad), None, &Control::default()).is_err());
    assert_eq!(mesh.triangulation().vertex_count(), 2);
    assert_eq!(mesh.triangulation().dimension(), 1);
    let cancelled = Control::default();
    cancelled.cancel();
    let points: Vec<_> = (0..5000).map(|i| [f64::from(i), f64::from(i * i % 71), f64::from(i * i % 83)]).collect();
    assert_eq!(mesh.insert(&dvecs(&points), None, &cancelled), Ok(false));
    assert_eq!(mesh.triangulation().vertex_count(), 2);
}
