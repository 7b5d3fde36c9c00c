//! A host that can't split its boundary.

use super::*;
use crate::geometry::encroachment::{encroaches_facet, encroaches_segment};
use crate::geometry::quality::exceeds_radius_edge;

const KEEP: ArrayOptions = ArrayOptions { radius_edge: 2.0, rule: Rule::Sparse, keep_boundary: true, min_edge: 0.0 };

/// The sides of a tetrahedron.
fn sides([a, b, c, d]: [u32; 4]) -> [[u32; 3]; 4] {
    [[b, c, d], [a, c, d], [a, b, d], [a, b, c]]
}

fn sorted<const N: usize>(mut v: [u32; N]) -> [u32; N] {
    v.sort_unstable();
    v
}

/// A box with an even grid of points on its sides, and on the plane z = 0 through its middle if wanted: few of its faces are encroached upon.
fn grid(inner: bool, rest: &[DVec3]) -> Vec<DVec3> {
    let at = |i: i32| f64::from(i) / 4.0;
    let mut points = boxed(&[], 1.0);
    for (x, y, z) in (-4..=4).flat_map(|x| (-4..=4).flat_map(move |y| (-4..=4).map(move |z| (x, y, z)))) {
        let p = [x, y, z];
        let on_side = p.iter().any(|k: &i32| k.abs() == 4) && p.iter().any(|k| k.abs() < 4);
        let is_corner = p.iter().all(|k| k.abs() == 4);
        if (on_side || inner && z == 0) && !is_corner {
            points.push(DVec3::new(at(x), at(y), at(z)));
        }
    }
    points.extend(rest);
    points
}

/// What is boundary in a mesh: faces on the outside, and those on the plane z = 0 if wanted.
fn boundary(host: &Host, inner: bool) -> Vec<[u32; 3]> {
    let mut all: Vec<[u32; 3]> = host.tetrahedra().into_iter().flat_map(sides).map(sorted).collect();
    all.sort_unstable();
    let flat = |face: &[u32; 3]| inner && face.iter().all(|&v| host.t.points()[v as usize].z == 0.0);
    all.chunk_by(|a, b| a == b).filter(|same| same.len() == 1 || flat(&same[0])).map(|same| same[0]).collect()
}

fn kept_round(host: &Host, inner: bool, options: &ArrayOptions) -> ArrayBatch {
    let tetrahedra = host.tetrahedra();
    let flat = |face: &[u32; 3]| face.iter().all(|&v| host.t.points()[v as usize].z == 0.0);
    let faces: Vec<[u32; 3]> = tetrahedra.iter().copied().flat_map(sides).filter(|face| inner && flat(face)).collect();
    let arrays = Arrays { points: host.t.points(), tetrahedra: &tetrahedra, faces: &faces, ..Arrays::default() };
    sample_arrays(&arrays, options, &Control::new()).unwrap().unwrap()
}

/// Only samples come, none in the ball of a boundary element that no vertex is in; all boundary faces stay.
fn keeps_all(points: &[DVec3], inner: bool, options: &ArrayOptions) -> (usize, usize) {
    let mut host = Host::new(points);
    let before = boundary(&host, inner);
    let at = |v: u32| points[v as usize];
    let empty = |face: &&[u32; 3]| !points.iter().any(|&p| encroaches_facet(face.map(at), p));
    let guarded: Vec<[u32; 3]> = before.iter().filter(empty).copied().collect();
    let mut edges: Vec<[u32; 2]> = before.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [a, c]]).map(sorted).collect();
    edges.sort_unstable();
    edges.dedup();
    // All of the six sides' common edges, which are segments.
    let creases: Vec<[u32; 2]> = edges
        .into_iter()
        .filter(|edge| {
            (0..3).filter(|&k| edge.iter().all(|&v| at(v)[k].abs() == 1.0 && at(v)[k] == at(edge[0])[k])).count() > 1
        })
        .filter(|edge| !points.iter().any(|&p| encroaches_segment(edge.map(at), p)))
        .collect();
    assert!(guarded.len() * 2 > before.len() && creases.len() > 10, "{} of {}", guarded.len(), before.len());
    for round in 0..300 {
        let batch = kept_round(&host, inner, options);
        for point in &batch.points {
            assert_eq!(point.origin, Origin::Sample);
            assert!(!guarded.iter().any(|face| encroaches_facet(face.map(at), point.position)), "{point:?}");
            assert!(!creases.iter().any(|edge| encroaches_segment(edge.map(at), point.position)), "{point:?}");
            assert!(host.t.insert(point.position, None).unwrap().is_new);
        }
        assert_eq!(boundary(&host, inner), before, "round {round}");
        if batch.points.is_empty() {
            // All that is bad is counted, and nothing else.
            let corners = |t: [u32; 4]| t.map(|v| host.t.points()[v as usize]);
            let is_bad = |&t: &[u32; 4]| exceeds_radius_edge(corners(t), options.radius_edge);
            assert_eq!(batch.refused, host.tetrahedra().iter().filter(|t| is_bad(t)).count());
            return (host.t.vertex_count() - points.len(), batch.refused);
        }
    }
    panic!("no end");
}

#[test]
fn samples_keep_away_from_hull_faces_that_stay() {
    for seed in [1, 2, 3] {
        let inside: Vec<DVec3> = random_points(40, seed).iter().map(|&p| 0.8 * p).collect();
        for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
            let (added, _) = keeps_all(&grid(false, &inside), false, &ArrayOptions { rule, ..KEEP });
            assert!(added > 5, "{added}");
        }
    }
}

#[test]
fn samples_keep_away_from_inner_faces_that_stay() {
    for seed in [1, 2, 3] {
        let inside: Vec<DVec3> = random_points(40, seed).iter().map(|&p| 0.8 * p).collect();
        let (added, refused) = keeps_all(&grid(true, &inside), true, &KEEP);
        assert!(added > 5 && refused > 0, "{added}, {refused}");
        // Without the option there are splits, and nothing is left.
        let mut host = Host::new(&grid(true, &inside));
        let mut splits = 0;
        loop {
            let batch = kept_round(&host, true, &ArrayOptions { keep_boundary: false, ..KEEP });
            splits += batch.points.iter().filter(|p| p.origin != Origin::Sample).count();
            for point in &batch.points {
                host.t.insert(point.position, None).unwrap();
            }
            if batch.points.is_empty() {
                assert!(splits > 0 && batch.refused == 0, "{splits}, {}", batch.refused);
                break;
            }
        }
    }
}

/// Hulls of bare random points: vertices encroach upon many of their faces, and no sample may go through one.
#[test]
fn samples_stay_inside_hulls_that_are_encroached_upon() {
    for (n, seed) in [(5, 0), (10, 2), (30, 1), (100, 0)] {
        let mut host = Host::new(&random_points(n, seed));
        let before = boundary(&host, false);
        let mut rounds = 0;
        loop {
            let batch = host.round(&KEEP);
            assert!(batch.points.iter().all(|point| point.origin == Origin::Sample));
            for point in &batch.points {
                assert!(host.t.insert(point.position, None).unwrap().is_new);
            }
            assert_eq!(boundary(&host, false), before, "round {rounds} of {n} points, seed {seed}");
            if batch.points.is_empty() {
                break;
            }
            rounds += 1;
            assert!(rounds < 200, "no end");
        }
    }
}
