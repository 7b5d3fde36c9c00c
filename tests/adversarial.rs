//! Points as bad as they come, a hundred thousand of each kind but those on a sphere; the ignored tests, which script/check runs, take a million. What the answer is,
//! wsp_triangulation_insert and wsp_triangulation_dimension document: equal points are one vertex; points on a line or in a plane have no tetrahedra, leave
//! nothing to refine, and are triangulated when the first point beside them comes; points on a sphere have the one triangulation that the
//! perturbation chooses, in whatever order they come.

use std::collections::BTreeSet;

use wellspaced::{Control, DVec3, Mesh, Plc, RefineOptions, RefineStatus, Triangulation};

const MANY: usize = 100_000;
const MILLION: usize = 1_000_000;

fn triangulated(points: &[DVec3]) -> (Triangulation, Vec<u32>) {
    let mut t = Triangulation::new();
    let ids = t.insert_many(points, &Control::new()).unwrap().unwrap();
    t.validate(3).unwrap();
    (t, ids)
}

/// There is nothing to refine, and that is no error.
fn nothing_to_refine(points: &[DVec3]) {
    let mut mesh = Mesh::new();
    mesh.insert(points, None, &Control::new()).unwrap();
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    assert_eq!((report.status, report.tetrahedra, report.steiner), (RefineStatus::Done, 0, 0));
    assert!(mesh.view().tetrahedra.is_empty());
    mesh.validate(3).unwrap();
    assert!(Mesh::from_plc(&Plc { points: points.into(), ..Plc::default() }, &Control::new()).is_ok());
}

fn equal(count: usize) {
    let points = vec![DVec3::new(0.1, -0.0, 3.0); count];
    let (t, ids) = triangulated(&points);
    assert_eq!((t.dimension(), t.vertex_count()), (0, 1));
    assert!(ids.iter().all(|&id| id == 0));
    nothing_to_refine(&points);
}

/// Each of few points many times, in turns.
fn duplicates(count: usize) {
    let few: Vec<DVec3> =
        (0..50).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3 % 4), f64::from(i / 12))).collect();
    let points: Vec<DVec3> = few.iter().copied().cycle().take(count).collect();
    let (t, ids) = triangulated(&points);
    assert_eq!((t.dimension(), t.vertex_count()), (3, few.len()));
    assert!(ids.iter().enumerate().all(|(i, &id)| id as usize == i % few.len()));
}

/// Along an axis and in other directions.
fn collinear(count: usize, directions: &[DVec3]) {
    for &direction in directions {
        // The middle ones first, so that the order is none of theirs.
        let along = |i: usize| direction * ((i * 7919) % count) as f64;
        let mut points: Vec<DVec3> = (0..count).map(along).collect();
        let (mut t, ids) = triangulated(&points);
        assert_eq!((t.dimension(), t.vertex_count()), (1, count));
        assert!(ids.iter().enumerate().all(|(i, &id)| id as usize == i));
        if direction == DVec3::X {
            nothing_to_refine(&points);
        }
        // Beside them comes one, then one beside the plane: each piece of the line makes a tetrahedron with both.
        t.insert(DVec3::new(0.0, 0.0, -1.0), None).unwrap();
        assert_eq!(t.dimension(), 2);
        t.insert(DVec3::new(0.0, 1.0, 0.0), None).unwrap();
        assert_eq!((t.dimension(), t.tetrahedra().count()), (3, count - 1));
        t.validate(3).unwrap();
        // The same, all at once.
        points.extend([DVec3::new(0.0, 0.0, -1.0), DVec3::new(0.0, 1.0, 0.0)]);
        let (at_once, _) = triangulated(&points);
        assert_eq!(at_once.tetrahedra().count(), count - 1);
    }
}

/// Points with whole coordinates on the sphere around the origin whose radius is `norm`: L. Euler's parametrization by quaternions of that norm, and with the
/// axes exchanged.
fn on_sphere(norm: i64) -> Vec<DVec3> {
    let mut found = BTreeSet::new();
    let root = |n: i64| (n as f64).sqrt() as i64;
    for a in 0..=root(norm) {
        for b in 0..=root(norm - a * a) {
            for c in 0..=root(norm - a * a - b * b) {
                let rest = norm - a * a - b * b - c * c;
                let d = root(rest);
                if d * d != rest {
                    continue;
                }
                for signs in 0..8 {
                    let sign = |bit: i64, x: i64| if signs >> bit & 1 == 1 { -x } else { x };
                    let (b, c, d) = (sign(0, b), sign(1, c), sign(2, d));
                    let p = [a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)];
                    found.extend([p, [p[1], p[2], p[0]], [p[2], p[0], p[1]]]);
                }
            }
        }
    }
    found.into_iter().map(|p| DVec3::from(p.map(|x| x as f64))).collect()
}

fn cospherical(norm: i64, count: usize, reversed: bool) {
    let mut points = on_sphere(norm);
    assert!(points.len() >= count, "{}", points.len());
    // Not in order, and no more than asked for.
    let len = points.len();
    let step = (len / 3..).find(|step| (2..step.isqrt() + 1).all(|d| step % d > 0) && len % step > 0).unwrap();
    points = (0..count).map(|i| points[i * step % len]).collect();
    let (t, ids) = triangulated(&points);
    assert_eq!((t.dimension(), t.vertex_count()), (3, count));
    assert!(ids.iter().enumerate().all(|(i, &id)| id as usize == i));
    if !reversed {
        return;
    }
    // The order does not matter: the triangulation is the same one.
    points.reverse();
    let (other, _) = triangulated(&points);
    let last = count as u32 - 1;
    let sorted = |all: &mut dyn Iterator<Item = [u32; 4]>| {
        let mut all: Vec<[u32; 4]> = all
            .map(|mut v| {
                v.sort_unstable();
                v
            })
            .collect();
        all.sort_unstable();
        all
    };
    let one = sorted(&mut t.tetrahedra());
    assert!(one == sorted(&mut other.tetrahedra().map(|v| v.map(|v| last - v))));
}

/// On a circle of this radius: all in one plane, and the apex of a cone above it.
fn cocircular(radius: i64) {
    let root = |n: i64| (n as f64).sqrt().round() as i64;
    let beside = |x: i64| Some(root(radius * radius - x * x)).filter(|y| x * x + y * y == radius * radius);
    let both = (-radius..=radius).filter_map(|x| Some((x, beside(x)?))).flat_map(|(x, y)| [(x, y), (x, -y)]);
    let mut points: Vec<DVec3> = both.map(|(x, y)| DVec3::new(x as f64, y as f64, 0.0)).collect();
    points.dedup();
    assert!(points.len() > 500, "{}", points.len());
    let (mut t, _) = triangulated(&points);
    assert_eq!((t.dimension(), t.vertex_count()), (2, points.len()));
    nothing_to_refine(&points);
    t.insert(DVec3::Z, None).unwrap();
    t.validate(3).unwrap();
    assert_eq!((t.dimension(), t.tetrahedra().count()), (3, points.len() - 2));
}

#[test]
fn equal_points_are_one() {
    equal(MANY);
}

#[test]
fn duplicates_have_the_id_of_the_first() {
    duplicates(MANY);
}

#[test]
fn points_on_a_line_wait_for_others() {
    collinear(MANY, &[DVec3::X, DVec3::ONE, DVec3::new(1.0, -2.0, 4.0)]);
}

#[test]
fn points_on_a_circle_make_a_cone() {
    cocircular(5 * 5 * 13 * 17 * 29);
}

#[test]
fn points_on_a_sphere_have_one_triangulation() {
    cospherical(3 * 5 * 7 * 11 * 3, 20_000, true);
}

#[test]
#[ignore = "a million of each"]
fn a_million_equal_points() {
    equal(MILLION);
    duplicates(MILLION);
}

#[test]
#[ignore = "a million of them"]
fn a_million_points_on_a_line() {
    collinear(MILLION, &[DVec3::ONE]);
}

// Each step of a cospherical input is exact arithmetic.
#[test]
#[ignore = "a million exact spheres"]
fn a_million_points_on_a_sphere() {
    cospherical(3 * 5 * 7 * 11 * 13 * 17, MILLION, false);
}
