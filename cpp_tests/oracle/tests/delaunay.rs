//! The set of tetrahedra is CGAL's, whatever the points and the order in which they come.

mod common;

use common::*;
use glam::DVec3;
use proptest::prelude::*;
use wellspaced::Control;
use wellspaced_oracle::Point;

/// Bulk, one by one, and half of each.
fn every_way(points: &[Point]) -> Result<(), TestCaseError> {
    let (triangulation, ids) = bulk(points);
    same_as_cgal(&triangulation, points, &ids)?;
    // Ids follow the input: a point that is no duplicate gets the next one.
    let mut next = 0;
    for (i, &id) in ids.iter().enumerate() {
        match points[..i].iter().position(|p| dvec(p) == dvec(&points[i])) {
            Some(first) => prop_assert_eq!(id, ids[first]),
            None => {
                prop_assert_eq!(id, next, "ids {:?}", &ids);
                next += 1;
            }
        }
    }

    let (triangulation, ids) = one_by_one(points);
    same_as_cgal(&triangulation, points, &ids)?;

    let (first, second) = points.split_at(points.len() / 2);
    let (mut triangulation, mut ids) = bulk(first);
    ids.extend(insert_many(&mut triangulation, second));
    same_as_cgal(&triangulation, points, &ids)
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
            let (triangulation, _) = bulk(points);
            let mut cells: Vec<_> = triangulation
                .tetrahedra()
                .map(|t| {
                    let mut corners = t.map(|v| triangulation.point(v).unwrap().to_array().map(|x| x as i64));
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
        let (triangulation, ids) = bulk(&points);
        same_as_cgal(&triangulation, &points, &ids).unwrap();
        let shifted: Vec<Point> = points.iter().map(|p| p.map(|x| x * 0.1 + 1e7)).collect();
        let (triangulation, ids) = bulk(&shifted);
        same_as_cgal(&triangulation, &shifted, &ids).unwrap();
    }
}

#[test]
fn nothing_and_one_point_many_times() {
    let (triangulation, ids) = bulk(&[]);
    same_as_cgal(&triangulation, &[], &ids).unwrap();
    let same = vec![[0.1, 0.2, 0.3]; 500];
    let (triangulation, ids) = bulk(&same);
    same_as_cgal(&triangulation, &same, &ids).unwrap();
    // The signs of zero do not tell points apart.
    let zeros = [[0.0, -0.0, 0.0], [-0.0, 0.0, -0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-0.0, 0.0, 3.0]];
    every_way(&zeros).unwrap();
}

#[test]
fn a_refused_call_inserts_nothing() {
    let many: Vec<Point> = (0..5000).map(|i| [f64::from(i), f64::from(i * i % 71), f64::from(i * i % 83)]).collect();
    for before in [&many[..0], &many[..2], &many[..50]] {
        let (mut triangulation, ids) = bulk(before);
        for bad in [f64::NAN, f64::INFINITY, 1e-300, 1e300] {
            let points = [DVec3::splat(0.5), DVec3::new(0.0, bad, 0.0)];
            assert!(triangulation.insert_many(&points, &Control::default()).is_err());
            assert!(triangulation.insert(points[1], None).is_err());
            same_as_cgal(&triangulation, before, &ids).unwrap();
        }
        let cancelled = Control::default();
        cancelled.cancel();
        assert_eq!(triangulation.insert_many(&dvecs(&many), &cancelled), Ok(None));
        same_as_cgal(&triangulation, before, &ids).unwrap();
        // Cancelled half way.
        let turns = std::sync::atomic::AtomicUsize::new(0);
        let late = Control::with_progress(move |_| turns.fetch_add(1, std::sync::atomic::Ordering::Relaxed) < 3);
        if triangulation.insert_many(&dvecs(&many), &late) == Ok(None) {
            same_as_cgal(&triangulation, before, &ids).unwrap();
        }
    }
}

/// Enough points to be divided among threads.
#[test]
fn points_divided_among_threads() {
    let mut state = 3u64;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let n = 80_000;
    let uniform: Vec<Point> = (0..n).map(|_| [next(), next(), next()]).collect();
    let mut sphere: Vec<Point> = Vec::new();
    while sphere.len() < n {
        let p = DVec3::new(next(), next(), next()) * 2.0 - 1.0;
        if p.length() > 0.1 {
            sphere.push((p.normalize() * (0.999 + 0.002 * next())).to_array());
        }
    }
    let tenths: Vec<Point> =
        (0..44 * 44 * 42).map(|i| [i % 44, i / 44 % 44, i / 1936].map(|x| f64::from(x) * 0.1)).collect();
    let mut clusters: Vec<Point> =
        (0..n).map(|i| [(i % 3) as f64 + 1e-6 * next(), next() * 1e-6, (i % 2) as f64 + 1e-6 * next()]).collect();
    clusters.extend_from_within(..2_000);
    for points in [uniform, sphere, tenths, clusters] {
        let mut triangulation = wellspaced::Triangulation::new();
        triangulation.set_threads(2);
        let ids = triangulation.insert_many(&dvecs(&points), &Control::default()).unwrap().unwrap();
        same_as_cgal(&triangulation, &points, &ids).unwrap();
    }
}
