//! Point sets that are hard on a Delaunay triangulation, and the comparison with CGAL's.

// Each test binary uses its own part of this.
#![allow(dead_code)]

use std::collections::BTreeSet;

use glam::DVec3;
use proptest::prelude::*;
use wellspaced::{Control, Mesh, Triangulation};
use wellspaced_oracle as oracle;
use wellspaced_oracle::Point;

/// Proptest's settings: finds become named tests with literal coordinates, so none are kept in files.
pub fn config(cases: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(cases);
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

pub fn dvec(p: &Point) -> DVec3 {
    DVec3::from_array(*p)
}

pub fn dvecs(points: &[Point]) -> Vec<DVec3> {
    points.iter().map(dvec).collect()
}

pub fn sorted<const N: usize>(mut simplex: [u32; N]) -> [u32; N] {
    simplex.sort_unstable();
    simplex
}

/// The points moved by `step` units in the last place a coordinate.
pub fn nudged(p: Point, steps: [i8; 3]) -> Point {
    let nudge = |x: f64, step: i8| {
        // 0's neighbours are subnormal: far below what the predicates take.
        let far = if x == 0.0 { f64::EPSILON * f64::from(step) } else { x };
        if x == 0.0 {
            far
        } else {
            f64::from_bits(x.to_bits().wrapping_add_signed(i64::from(step)))
        }
    };
    [nudge(p[0], steps[0]), nudge(p[1], steps[1]), nudge(p[2], steps[2])]
}

fn coordinates<S: Strategy<Value = f64> + Clone>(x: S) -> impl Strategy<Value = Point> {
    [x.clone(), x.clone(), x]
}

/// Uniform in a cube.
pub fn uniform() -> impl Strategy<Value = Point> {
    coordinates(-1.0..1.0f64)
}

/// A grid of `n`³ points.
pub fn grid(n: i32) -> impl Strategy<Value = Point> {
    [0..n, 0..n, 0..n].prop_map(|p| p.map(f64::from))
}

/// Integer points on the sphere of radius² 2,601 = 51²: 480 and more exactly cospherical points.
pub fn cospherical() -> impl Strategy<Value = Point> {
    let all: Vec<Point> = (-51i32..=51)
        .flat_map(|x| (-51i32..=51).map(move |y| (x, y)))
        .filter_map(|(x, y)| {
            let z2 = 2601 - x * x - y * y;
            let z = f64::from(z2.max(0)).sqrt().round() as i32;
            (z * z == z2).then_some([f64::from(x), f64::from(y), f64::from(z)])
        })
        .flat_map(|p| [p, [p[0], p[1], -p[2]]])
        .collect();
    prop::sample::select(all)
}

/// On the plane x + y = z of a small grid.
pub fn coplanar() -> impl Strategy<Value = Point> {
    [0..6i32, 0..6i32].prop_map(|[x, y]| [f64::from(x), f64::from(y), f64::from(x + y)])
}

/// On a line that is parallel to no axis.
pub fn collinear() -> impl Strategy<Value = Point> {
    (-20..20i32).prop_map(|t| [f64::from(t), f64::from(2 * t + 1), f64::from(-3 * t)])
}

/// A few tight clusters, far apart.
pub fn clustered() -> impl Strategy<Value = Point> {
    (0..4usize, coordinates(-1e-6..1e-6f64)).prop_map(|(cluster, offset)| {
        let centre = [[0.0, 0.0, 0.0], [1000.0, 1.0, 7.0], [-3.0, 512.0, 0.1], [1.0, -1.0, 1e5]][cluster];
        [centre[0] + offset[0], centre[1] + offset[1], centre[2] + offset[2]]
    })
}

/// Magnitudes from 2⁻¹⁴⁰ to 2²⁰⁰, both signs, and 0.
pub fn mixed_exponents() -> impl Strategy<Value = Point> {
    let coordinate = (-140..200i32, 1.0..2.0f64, 0..8u8).prop_map(|(exponent, mantissa, kind)| match kind {
        0 => 0.0,
        1..=3 => -mantissa * 2f64.powi(exponent),
        4 => 2f64.powi(exponent),
        _ => mantissa * 2f64.powi(exponent),
    });
    coordinates(coordinate)
}

/// Grid points a few units in the last place off their places.
pub fn grid_nudged() -> impl Strategy<Value = Point> {
    (grid(4), [-1..=1i8, -1..=1, -1..=1]).prop_map(|(p, steps)| nudged(p, steps))
}

/// A jittered sphere: nearly cospherical in floating point.
pub fn on_sphere() -> impl Strategy<Value = Point> {
    uniform().prop_filter_map("too near the centre", |p| {
        let length = dvec(&p).length();
        (length > 0.1).then(|| (dvec(&p) / length).to_array())
    })
}

/// A mixture that puts most kinds side by side.
pub fn mixed() -> impl Strategy<Value = Point> {
    prop_oneof![grid(3), coplanar(), collinear(), uniform(), grid_nudged()]
}

/// Up to `most` points of a kind, then some of them once more, in any order.
pub fn sets(point: impl Strategy<Value = Point>, most: usize) -> impl Strategy<Value = Vec<Point>> {
    (prop::collection::vec(point, 0..=most), prop::collection::vec(any::<prop::sample::Index>(), 0..4))
        .prop_map(|(mut points, again)| {
            if !points.is_empty() {
                let copies: Vec<Point> = again.iter().map(|i| points[i.index(points.len())]).collect();
                points.extend(copies);
            }
            points
        })
        .prop_shuffle()
}

/// `Err` for proptest and plain tests alike.
pub fn ensure(holds: bool, problem: impl FnOnce() -> String) -> Result<(), TestCaseError> {
    if holds {
        Ok(())
    } else {
        Err(TestCaseError::fail(problem()))
    }
}

/// Whether this is CGAL's triangulation of `points`, of which `points[i]` became vertex `ids[i]`.
pub fn same_as_cgal(ours: &Triangulation, points: &[Point], ids: &[u32]) -> Result<(), TestCaseError> {
    ensure(ids.len() == points.len(), || format!("{} ids for {} points", ids.len(), points.len()))?;
    let cgal = oracle::delaunay(points).expect("CGAL takes finite points");
    ensure(ours.dimension() == cgal.dimension, || format!("dimension {}, CGAL {}", ours.dimension(), cgal.dimension))?;
    ensure(ours.vertex_count() == cgal.vertices, || {
        format!("{} vertices, CGAL {}", ours.vertex_count(), cgal.vertices)
    })?;
    for (point, &id) in points.iter().zip(ids) {
        ensure(ours.point(id) == Some(dvec(point)), || format!("vertex {id} is {:?}, not {point:?}", ours.point(id)))?;
    }

    let mapped = |v: u32| ids[v as usize];
    let expected: BTreeSet<_> = cgal.tetrahedra.iter().map(|t| sorted(t.map(mapped))).collect();
    let found: BTreeSet<_> = ours.tetrahedra().map(sorted).collect();
    ensure(found.len() == ours.tetrahedron_count(), || "the count is not that of the distinct tetrahedra".into())?;
    same_sets(&found, &expected)?;
    for tet in ours.tetrahedra() {
        let corners = tet.map(|v| ours.point(v).expect("a vertex").to_array());
        ensure(oracle::orientation(corners).unwrap() == 1, || format!("{tet:?} is not positively oriented"))?;
    }
    if cgal.dimension == 3 {
        let hull: BTreeSet<_> = cgal.hull.iter().map(|f| sorted(f.map(mapped))).collect();
        same_sets(&ours.hull().map(sorted).collect(), &hull)?;
    }
    ours.validate(3).map_err(|defect| TestCaseError::fail(defect.to_string()))
}

/// Equality, and what differs if not.
pub fn same_sets<const N: usize>(ours: &BTreeSet<[u32; N]>, cgals: &BTreeSet<[u32; N]>) -> Result<(), TestCaseError> {
    ensure(ours == cgals, || {
        let only_ours: Vec<_> = ours.difference(cgals).collect();
        let only_cgals: Vec<_> = cgals.difference(ours).collect();
        format!("only ours: {only_ours:?}, only CGAL's: {only_cgals:?}")
    })
}

/// The face opposite corner `i`.
fn face(tet: &[u32; 4], i: usize) -> [u32; 3] {
    [tet[(i + 1) % 4], tet[(i + 2) % 4], tet[(i + 3) % 4]]
}

/// Orientation by CGAL's predicate, and neighbours that share the face they should.
pub fn sound_view(mesh: &Mesh) -> Result<(), TestCaseError> {
    let view = mesh.view();
    ensure(view.neighbours.len() == view.tetrahedra.len(), || "as many neighbour entries as tetrahedra".into())?;
    for (t, tet) in view.tetrahedra.iter().enumerate() {
        let corners = tet.map(|v| view.points[v as usize].to_array());
        ensure(oracle::orientation(corners).unwrap() == 1, || format!("{tet:?} is not positively oriented"))?;
        for i in 0..4 {
            let n = view.neighbours[t][i];
            if n == u32::MAX {
                continue;
            }
            let shared = sorted(face(tet, i));
            let other = &view.tetrahedra[n as usize];
            let back = (0..4).find(|&j| sorted(face(other, j)) == shared);
            ensure(back.is_some_and(|j| view.neighbours[n as usize][j] == t as u32), || {
                format!("tetrahedra {t} and {n} disagree on the face {shared:?}")
            })?;
        }
    }
    mesh.validate(3).map_err(|defect| TestCaseError::fail(defect.to_string()))
}

/// All points at once, and their ids.
pub fn bulk(points: &[Point]) -> (Triangulation, Vec<u32>) {
    let mut triangulation = Triangulation::new();
    let ids = insert_many(&mut triangulation, points);
    (triangulation, ids)
}

/// More points at once.
pub fn insert_many(triangulation: &mut Triangulation, points: &[Point]) -> Vec<u32> {
    triangulation.insert_many(&dvecs(points), &Control::default()).unwrap().expect("nothing cancels it")
}

/// The points one by one, each with a hint that is good, bad or missing.
pub fn one_by_one(points: &[Point]) -> (Triangulation, Vec<u32>) {
    let mut triangulation = Triangulation::new();
    let mut ids: Vec<u32> = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let hint = match i % 4 {
            0 => None,
            1 => ids.last().copied(),
            2 => ids.first().copied(),
            _ => Some(i as u32),
        };
        let known = ids.iter().any(|&id| triangulation.point(id) == Some(dvec(point)));
        let inserted = triangulation.insert(dvec(point), hint).unwrap();
        assert_eq!(inserted.is_new, !known, "point {i}");
        ids.push(inserted.vertex);
    }
    (triangulation, ids)
}
