//! Our exact predicates beside CGAL's, where floating point alone is wrong.

mod common;

use common::*;
use proptest::prelude::*;
use wellspaced::geometry::Filter;
use wellspaced_oracle as oracle;
use wellspaced_oracle::Point;

/// Both predicates on five points, with a filter made for just these and one made for a wider box.
fn agree(points: [Point; 5], wider: Point) -> Result<(), TestCaseError> {
    let v = points.map(|p| dvec(&p));
    let tight = Filter::for_points(&v);
    let mut wide = tight.clone();
    wide.extend(dvec(&wider));
    let orientation = oracle::orientation([points[0], points[1], points[2], points[3]]).unwrap();
    let sphere = oracle::side_of_oriented_sphere(points).unwrap();
    for filter in [&tight, &wide] {
        prop_assert_eq!(filter.orient3d(v[0], v[1], v[2], v[3]) as i32, orientation);
        prop_assert_eq!(filter.insphere(v[0], v[1], v[2], v[3], v[4]) as i32, sphere);
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(4000))]

    #[test]
    fn on_a_grid(p in [grid(4), grid(4), grid(4), grid(4), grid(4)], w in uniform()) { agree(p, w)?; }

    #[test]
    fn beside_a_grid(p in [grid_nudged(), grid_nudged(), grid_nudged(), grid_nudged(), grid_nudged()], w in grid(100)) {
        agree(p, w)?;
    }

    #[test]
    fn on_a_large_grid(p in [grid(1 << 25), grid(1 << 25), grid(1 << 25), grid(1 << 25), grid(1 << 25)], w in grid(2)) {
        agree(p, w)?;
    }

    #[test]
    fn on_a_sphere(p in [cospherical(), cospherical(), cospherical(), cospherical(), cospherical()], w in uniform()) {
        agree(p, w)?;
    }

    #[test]
    fn beside_a_sphere(
        p in [cospherical(), cospherical(), cospherical(), cospherical(), cospherical()],
        steps in [-2..=2i8, -2..=2, -2..=2],
        scale in -80..80i32,
    ) {
        let mut p = p.map(|q| q.map(|x| x * 2f64.powi(scale)));
        p[4] = p[4].map(|x| x + 0.0);
        let off = nudged(p[4], steps);
        // 0 moves by an epsilon whatever the scale: leave it where it is.
        p[4] = std::array::from_fn(|i| if p[4][i] == 0.0 { 0.0 } else { off[i] });
        agree(p, [1.0, 1.0, 1.0])?;
    }

    #[test]
    fn in_a_plane(
        p in [coplanar(), coplanar(), coplanar(), coplanar(), coplanar()],
        steps in [-1..=1i8, -1..=1, -1..=1],
        shift in uniform(),
    ) {
        let mut p = p.map(|q| [q[0] + shift[0], q[1] + shift[1], q[2] + shift[2]]);
        p[3] = nudged(p[3], steps);
        agree(p, shift)?;
    }

    #[test]
    fn over_the_whole_range(
        p in [mixed_exponents(), mixed_exponents(), mixed_exponents(), mixed_exponents(), mixed_exponents()],
        w in mixed_exponents(),
    ) {
        agree(p, w)?;
    }
}

#[test]
fn at_both_ends_of_the_range() {
    for unit in [2f64.powi(-142), 2f64.powi(200)] {
        let corner = |x: f64, y: f64, z: f64| [x * unit, y * unit, z * unit];
        let last = f64::EPSILON;
        for z in [1.0 - last / 2.0, 1.0, 1.0 + last] {
            let p = [corner(0., 0., 0.), corner(1., 0., 0.), corner(0., 1., 0.), corner(0., 0., 1.), corner(1., 1., z)];
            agree(p, corner(1.0, 2.0, 2.0)).unwrap();
        }
    }
}
