//! The oracle itself, on cases whose answers are known without it.

use wellspaced_oracle as oracle;

fn cube() -> Vec<oracle::Point> {
    (0..8).map(|i| [(i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64]).collect()
}

#[test]
fn every_dimension_has_its_simplices() {
    assert_eq!(oracle::delaunay(&[]).unwrap().dimension, -1);
    assert_eq!(oracle::delaunay(&[[1.0; 3]; 4]).unwrap().dimension, 0);

    let line = oracle::delaunay(&[[0.0; 3], [2.0; 3], [1.0; 3]]).unwrap();
    assert_eq!((line.dimension, line.vertices, line.chain.len()), (1, 3, 2));

    let square = oracle::delaunay(&cube()[..4]).unwrap();
    assert_eq!((square.dimension, square.hull.len()), (2, 2));

    let solid = oracle::delaunay(&cube()).unwrap();
    assert_eq!((solid.dimension, solid.vertices, solid.hull.len()), (3, 8, 12));
    assert!((5..=6).contains(&solid.tetrahedra.len()));
}

#[test]
fn the_first_of_equal_points_stands_for_all() {
    let mut points = cube();
    points.splice(0..0, [[1.0; 3], [-0.0, 0.0, 0.0]]);
    points.push([0.5; 3]);
    let solid = oracle::delaunay(&points).unwrap();
    assert_eq!(solid.vertices, 9);
    // 2 and 9 repeat points 1 and 0.
    assert!(solid.tetrahedra.iter().flatten().all(|&v| v != 2 && v != 9));
    assert_eq!(solid.tetrahedra.len(), 12);
}

#[test]
fn signs_follow_the_convention() {
    let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert_eq!(oracle::orientation([a, b, c, d]).unwrap(), 1);
    assert_eq!(oracle::orientation([b, a, c, d]).unwrap(), -1);
    assert_eq!(oracle::orientation([a, b, c, [0.5, 0.5, 0.0]]).unwrap(), 0);
    let up = f64::from_bits(1f64.to_bits() + 1);
    for (e, sign) in [([0.25; 3], 1), ([1.0; 3], 0), ([1.0, 1.0, up], -1)] {
        assert_eq!(oracle::side_of_oriented_sphere([a, b, c, d, e]).unwrap(), sign);
    }
    assert_eq!(oracle::side_of_smallest_sphere([a, b, c, [0.5, 0.5, 0.5]]).unwrap(), 1);
    assert_eq!(oracle::side_of_smallest_sphere([a, b, c, [1.0, 1.0, 0.0]]).unwrap(), 0);
    assert_eq!(oracle::side_of_diametral_sphere([a, b, [0.5, 0.5, 0.0]]).unwrap(), 0);
    assert_eq!(oracle::side_of_diametral_sphere([a, b, c]).unwrap(), -1);
}

#[test]
fn the_bound_is_decided_exactly() {
    // A corner of a cube of side 2: circumradius √3, shortest edge 2; no double is the quotient.
    let corner = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
    let bound = 3f64.sqrt() / 2.0;
    let below = f64::from_bits(bound.to_bits() - 1);
    let above = f64::from_bits(bound.to_bits() + 1);
    assert!(oracle::over_bound(corner, below).unwrap());
    assert!(!oracle::over_bound(corner, above).unwrap());
    // Circumradius 5 and a shortest edge of √20.
    let on_sphere = [[5.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 0.0, 4.0], [-5.0, 0.0, 0.0]];
    let shortest = 20f64.sqrt();
    assert!(oracle::over_bound(on_sphere, 5.0 / shortest - 1e-15).unwrap());
    assert!(!oracle::over_bound(on_sphere, 5.0 / shortest + 1e-15).unwrap());
    let exact = [[3.0, 4.0, 0.0], [3.0, -4.0, 0.0], [-3.0, 0.0, 4.0], [-3.0, 0.0, -4.0]];
    // Circumradius 5, edges 8, 8 and four of √68: the quotient is a double, and on the bound is not over it.
    assert!(!oracle::over_bound(exact, 0.625).unwrap());
    assert!(oracle::over_bound(exact, 0.625 - f64::EPSILON).unwrap());
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(oracle::over_bound(flat, 1e9).unwrap());
}

#[test]
fn volumes_are_compared_exactly() {
    let points = cube();
    let solid = oracle::delaunay(&points).unwrap();
    let mut doubled: Vec<_> = solid.tetrahedra.clone();
    assert_eq!(oracle::compare_volumes(&points, &solid.tetrahedra, &points, &doubled).unwrap(), 0);
    doubled.pop();
    assert_eq!(oracle::compare_volumes(&points, &solid.tetrahedra, &points, &doubled).unwrap(), 1);
}

#[test]
fn exceptions_become_errors() {
    let error = oracle::delaunay(&[[0.0; 3], [f64::NAN, 0.0, 0.0]]).unwrap_err();
    assert!(error.what().contains("not finite"), "{error}");
    assert!(oracle::compare_volumes(&cube(), &[[0, 1, 2, 8]], &cube(), &[]).is_err());
}
