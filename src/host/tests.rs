use glam::{DQuat, EulerRot};

mod counts;
mod hulls;
mod keep;

use super::*;
use crate::samples::{on_a_sphere, random_points};
use crate::{Control, Error, Origin, Plc, Rule, Triangulation};

fn boxed(points: &[DVec3], half: f64) -> Vec<DVec3> {
    Plc::boxed(DVec3::splat(-half), DVec3::splat(half), points.iter().copied()).points
}

/// A host: any mesher that keeps a Delaunay triangulation in arrays.
struct Host {
    t: Triangulation,
}

impl Host {
    fn new(points: &[DVec3]) -> Host {
        let mut t = Triangulation::new();
        t.insert_many(points, &Control::new()).unwrap();
        Host { t }
    }

    fn tetrahedra(&self) -> Vec<[u32; 4]> {
        self.t.tetrahedra().collect()
    }

    fn round(&self, options: &ArrayOptions) -> ArrayBatch {
        let tetrahedra = self.tetrahedra();
        let arrays = Arrays { points: self.t.points(), tetrahedra: &tetrahedra, ..Arrays::default() };
        sample_arrays(&arrays, options, &Control::new()).unwrap().unwrap()
    }

    /// Batch, insert, repeat. Returns the number of rounds.
    fn refine(&mut self, options: &ArrayOptions) -> usize {
        for round in 0..1000 {
            let batch = self.round(options);
            if batch.points.is_empty() {
                assert_eq!((batch.bad_edges.len(), batch.refused), (0, 0), "nothing to insert, but not done");
                return round;
            }
            for point in &batch.points {
                assert!(self.t.insert(point.position, None).unwrap().is_new);
            }
        }
        panic!("no end");
    }
}

/// The new tetrahedra at a point that is inserted alone.
fn cavity_of(t: &Triangulation, p: DVec3) -> Vec<[u32; 4]> {
    let mut after = t.clone();
    after.insert(p, None).unwrap();
    let sorted = |t: &Triangulation| -> std::collections::BTreeSet<[u32; 4]> {
        t.tetrahedra()
            .map(|mut v| {
                v.sort_unstable();
                v
            })
            .collect()
    };
    sorted(t).difference(&sorted(&after)).copied().collect()
}

#[test]
fn the_cavities_of_a_batch_do_not_meet() {
    let host = Host::new(&boxed(&random_points(150, 5), 1.5));
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        let batch = host.round(&ArrayOptions { radius_edge: 1.5, rule, ..ArrayOptions::default() });
        let groups: Vec<([u32; 2], Vec<[u32; 4]>)> = batch
            .points
            .iter()
            .map(|p| {
                let own = if p.origin == Origin::Sample { p.edge } else { [u32::MAX; 2] };
                (own, cavity_of(&host.t, p.position))
            })
            .collect();
        let mut others = 0;
        for (i, (edge, cavity)) in groups.iter().enumerate() {
            for (other, theirs) in &groups[..i] {
                if edge == other && *edge != [u32::MAX; 2] {
                    continue;
                }
                others += 1;
                for a in cavity {
                    for b in theirs {
                        let common = a.iter().filter(|v| b.contains(v)).count();
                        assert!(common < 3, "cavities {i} meet or share a face: {a:?} {b:?}");
                    }
                }
            }
        }
        assert!(others > 3, "{rule:?}: {} points", batch.points.len());
    }
}

#[test]
fn a_batch_is_the_same_in_any_order_of_the_arrays_and_of_insertion() {
    let host = Host::new(&boxed(&random_points(100, 8), 1.5));
    let options = ArrayOptions::default();
    let batch = host.round(&options);
    let tetrahedra: Vec<[u32; 4]> = host.tetrahedra().into_iter().rev().map(|[a, b, c, d]| [b, c, a, d]).collect();
    let arrays = Arrays { points: host.t.points(), tetrahedra: &tetrahedra, ..Arrays::default() };
    let other = sample_arrays(&arrays, &options, &Control::new()).unwrap().unwrap();
    let places = |batch: &ArrayBatch| batch.points.iter().map(|p| (p.edge, p.origin)).collect::<Vec<_>>();
    assert_eq!(places(&batch), places(&other));
    assert_eq!(batch.bad_edges, other.bad_edges);
}

/// A round mends what lies at about one length, so rounds go with the logarithm of the lengths between the smallest feature and the
/// domain, and not with the number of vertices.
#[test]
fn rounds_grow_with_the_logarithm_of_the_sizes() {
    let rounds = |points: &[DVec3]| Host::new(points).refine(&ArrayOptions::default());
    // Two points at distance 1 in cubes of side 2^k: 8 doublings more cost about as many rounds each time.
    let pair = [DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0)];
    let wide: Vec<usize> = [8, 16, 24, 32].map(|k| rounds(&boxed(&pair, f64::exp2(f64::from(k))))).to_vec();
    for (step, pair) in wide.windows(2).enumerate() {
        assert!(pair[1] > pair[0] && pair[1] - pair[0] <= 8 * 9, "{wide:?} at step {step}");
    }
    // The same features in many places: four times as many points, not even twice the rounds.
    let many: Vec<usize> = [200, 800, 3200].map(|n| rounds(&boxed(&random_points(n, 7), 1.5))).to_vec();
    assert!(many[2] < 2 * many[0], "{many:?}");
}

/// Where facets are slanted their splits lie off the plane by rounding. A host that remembers which facets a vertex lies on knows the
/// flat tetrahedra that this makes, and the facet of every face.
#[test]
fn slanted_boxes_are_refined_too() {
    use std::collections::BTreeSet;
    for seed in 0..4 {
        let turn = DQuat::from_euler(EulerRot::XYZ, 0.3 + seed as f64, 0.7, 1.1);
        let mut host = Host::new(&boxed(&random_points(60, seed), 1.5).iter().map(|&p| turn * p).collect::<Vec<_>>());
        // Facets of the box by number: two a direction.
        let mut on: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); host.t.points().len()];
        for (i, corner) in on[..8].iter_mut().enumerate() {
            corner.extend((0..3).map(|axis| 2 * axis + (i as u32 >> axis & 1)));
        }
        let common = |on: &[BTreeSet<u32>], v: &[u32]| -> BTreeSet<u32> {
            v[1..].iter().fold(on[v[0] as usize].clone(), |all, &v| &all & &on[v as usize])
        };
        let mut left = None;
        for _ in 0..300 {
            let tetrahedra: Vec<[u32; 4]> = host.t.tetrahedra().filter(|t| common(&on, t).is_empty()).collect();
            let sides = |t: &[u32; 4]| [[t[1], t[2], t[3]], [t[0], t[2], t[3]], [t[0], t[1], t[3]], [t[0], t[1], t[2]]];
            let numbered: Vec<([u32; 3], u32)> = tetrahedra
                .iter()
                .flat_map(sides)
                .filter_map(|face| common(&on, &face).first().map(|&facet| (face, facet)))
                .collect();
            let (faces, facets): (Vec<_>, Vec<_>) = numbered.into_iter().unzip();
            let arrays = Arrays {
                points: host.t.points(),
                tetrahedra: &tetrahedra,
                neighbours: &[],
                faces: &faces,
                facets: &facets,
            };
            let batch = sample_arrays(&arrays, &ArrayOptions::default(), &Control::new()).unwrap().unwrap();
            if batch.points.is_empty() {
                left = Some((batch.bad_edges.len(), batch.refused));
                break;
            }
            for point in &batch.points {
                host.t.insert(point.position, None).unwrap();
                on.push(match point.origin {
                    Origin::Sample => BTreeSet::new(),
                    Origin::Segment(s) => common(&on, &s),
                    Origin::Subfacet(f) => common(&on, &f),
                });
            }
        }
        assert_eq!(left, Some((0, 0)), "no end");
    }
}

#[test]
fn nothing_encroaches_upon_inner_faces() {
    // Two boxes, one above the other, with one number for the facet between them.
    let mut points = boxed(&random_points(60, 3), 1.5);
    points.iter_mut().for_each(|p| p.z += 1.5);
    let below: Vec<DVec3> = points.iter().map(|p| DVec3::new(p.x, p.y, -p.z)).collect();
    points.extend(below);
    let mut host = Host::new(&points);
    for _ in 0..200 {
        let tetrahedra = host.tetrahedra();
        let flat = |f: &[u32; 3]| f.iter().all(|&v| host.t.points()[v as usize].z == 0.0);
        let sides = |t: &[u32; 4]| [[t[1], t[2], t[3]], [t[0], t[2], t[3]], [t[0], t[1], t[3]], [t[0], t[1], t[2]]];
        let faces: Vec<[u32; 3]> = tetrahedra.iter().flat_map(sides).filter(flat).collect();
        let facets = vec![7; faces.len()];
        let arrays = Arrays {
            points: host.t.points(),
            tetrahedra: &tetrahedra,
            faces: &faces,
            facets: &facets,
            ..Arrays::default()
        };
        let batch = sample_arrays(&arrays, &ArrayOptions::default(), &Control::new()).unwrap().unwrap();
        for point in batch.points.iter().filter(|p| p.origin == Origin::Sample) {
            for face in &faces {
                let corners = face.map(|v| host.t.points()[v as usize]);
                assert!(!crate::geometry::encroachment::encroaches_facet(corners, point.position));
            }
        }
        if batch.points.is_empty() {
            assert_eq!((batch.bad_edges.len(), batch.encroached, batch.refused), (0, 0, 0));
            return;
        }
        for point in &batch.points {
            host.t.insert(point.position, None).unwrap();
        }
    }
    panic!("no end");
}

#[test]
fn arrays_that_are_no_delaunay_mesh_are_refused_by_name() {
    let host = Host::new(&boxed(&random_points(20, 4), 1.5));
    let tetrahedra = host.tetrahedra();
    let points = host.t.points();
    let round = |arrays: &Arrays<'_>| sample_arrays(arrays, &ArrayOptions::default(), &Control::new());
    let problem = |arrays: &Arrays<'_>| match round(arrays) {
        Err(Error::InvalidMesh { problem }) => problem,
        other => panic!("{other:?}"),
    };
    let with = |tetrahedra: &[[u32; 4]]| problem(&Arrays { points, tetrahedra, ..Arrays::default() });
    let mut broken = tetrahedra.clone();
    broken[3].swap(0, 1);
    assert!(with(&broken).contains("tetrahedron 3"), "{}", with(&broken));
    broken = tetrahedra.clone();
    broken[5][2] = 99;
    assert!(with(&broken).contains("tetrahedron 5 names vertex 99"));
    broken = tetrahedra.clone();
    broken.extend([tetrahedra[0], tetrahedra[0]]);
    assert!(with(&broken).contains("more than two"));
    // A vertex moved into its neighbour's sphere, without turning a tetrahedron over.
    let flip = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.3, 0.3, 0.2], [0.3, 0.3, -0.2]].map(DVec3::from);
    let two = [[0, 1, 2, 3], [0, 2, 1, 4]];
    assert!(problem(&Arrays { points: &flip, tetrahedra: &two, ..Arrays::default() }).contains("not Delaunay"));
    let neighbours = vec![[0; 4]; tetrahedra.len()];
    let arrays = Arrays { points, tetrahedra: &tetrahedra, neighbours: &neighbours, ..Arrays::default() };
    assert!(problem(&arrays).contains("share no face"));
    let arrays = Arrays { points, tetrahedra: &tetrahedra, faces: &[[0, 1, 200]], ..Arrays::default() };
    assert!(problem(&arrays).contains("face 0 names vertex 200"));
    let nan = [DVec3::NAN, DVec3::ZERO];
    assert!(round(&Arrays { points: &nan, tetrahedra: &[], ..Arrays::default() }).unwrap().unwrap().points.is_empty());
    assert!(matches!(
        round(&Arrays {
            points: &[DVec3::NAN, DVec3::X, DVec3::Y, DVec3::Z],
            tetrahedra: &[[0, 1, 2, 3]],
            ..Arrays::default()
        }),
        Err(Error::NotFinite { index: 0, .. })
    ));
    let control = Control::new();
    control.cancel();
    let arrays = Arrays { points, tetrahedra: &tetrahedra, ..Arrays::default() };
    assert_eq!(sample_arrays(&arrays, &ArrayOptions::default(), &control).unwrap(), None);
}

/// Found by fuzzing: the walk around an edge went to and fro between two such tetrahedra for ever.
#[test]
fn tetrahedra_on_the_same_side_of_their_common_face_are_refused() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.3, 0.2], [0.3, 0.3, 5.0]].map(DVec3::from);
    let tetrahedra = [[0, 1, 2, 3], [0, 1, 2, 4]];
    let neighbours = [[u32::MAX, u32::MAX, u32::MAX, 1], [u32::MAX, u32::MAX, u32::MAX, 0]];
    for neighbours in [&neighbours[..], &[]] {
        let arrays = Arrays { points: &points, tetrahedra: &tetrahedra, neighbours, ..Arrays::default() };
        match sample_arrays(&arrays, &ArrayOptions::default(), &Control::new()) {
            Err(Error::InvalidMesh { problem }) => {
                assert!(problem.contains("0 and 1 are on the same side"), "{problem}")
            }
            other => panic!("{other:?}"),
        }
    }
    let itself = [[u32::MAX, u32::MAX, u32::MAX, 0], [u32::MAX; 4]];
    let arrays = Arrays { points: &points, tetrahedra: &tetrahedra, neighbours: &itself, ..Arrays::default() };
    assert!(matches!(
        sample_arrays(&arrays, &ArrayOptions::default(), &Control::new()),
        Err(Error::InvalidMesh { .. })
    ));
}

/// Points on one sphere, as rounding lets them: the first sample's cavity is nearly all there is.
#[test]
fn a_round_can_be_cancelled_at_every_look_however_large_its_cavities_are() {
    let host = Host::new(&on_a_sphere(700));
    let tetrahedra = host.tetrahedra();
    let arrays = Arrays { points: host.t.points(), tetrahedra: &tetrahedra, ..Arrays::default() };
    let options = ArrayOptions { radius_edge: 2.0, rule: Rule::Sparse, ..ArrayOptions::default() };
    let control = Control::new();
    let mut whole = None;
    let looks = control.looks(None, || whole = sample_arrays(&arrays, &options, &control).unwrap());
    let whole = whole.unwrap();
    let cavity = whole.points.iter().map(|p| cavity_of(&host.t, p.position).len()).max().unwrap_or(0);
    assert!(cavity > 1000 && looks > 60, "{cavity}, {looks}");
    for last in (1..=looks).step_by(looks.div_ceil(200)) {
        let mut batch = None;
        let made = control.looks(Some(last), || batch = sample_arrays(&arrays, &options, &control).unwrap());
        // When all was there, what was made is given back with the last looks.
        assert!(made >= last && batch.is_none_or(|batch| batch == whole && last + 20 > looks), "{last} of {looks}");
    }
}
