mod again;
mod crowded;
mod lazy;
mod sizes;

use super::*;
use crate::samples::{numbers, on_a_sphere};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::Unplaced;
use crate::{Control, DVec3, Error, Mesh, Plc, PlcFacet, Triangulation};

fn random_box(count: usize, seed: u64) -> Plc {
    let mut next = numbers(seed);
    let mut point = || DVec3::new(next(), next(), next()) * 2.0 - 1.0;
    Plc::boxed(DVec3::splat(-1.5), DVec3::splat(1.5), (0..count).map(|_| point()).collect::<Vec<_>>())
}

fn volume(mesh: &Mesh) -> f64 {
    let view = mesh.view();
    let six = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| view.points[v as usize]);
        (b - a).cross(c - a).dot(d - a)
    };
    view.tetrahedra.iter().map(six).sum::<f64>() / 6.0
}

fn check(mesh: &Mesh, beta: f64, expected_volume: f64) {
    mesh.validate(3).unwrap();
    mesh.validate_quality(beta).unwrap();
    assert!((volume(mesh) / expected_volume - 1.0).abs() < 1e-9, "{}", volume(mesh));
}

/// One batch at a time, by the paper's rule, until no edge is bad.
fn refine_in_steps(mesh: &mut Mesh) {
    let options = step::StepOptions { radius_edge: 2.0, rule: Rule::Paper };
    let mut steps = 0;
    while let Some(&edge) = mesh.bad_short_edges(2.0).unwrap().first() {
        let batch = mesh.steiner_batch(edge, &options).unwrap();
        assert!(!batch.points.is_empty());
        mesh.insert_batch(&batch).unwrap();
        steps += 1;
        assert!(steps < 5000);
    }
    assert!(steps > 3, "{steps}");
}

/// The vertices of an icosahedron in the unit sphere, and twice the middles of all edges that there are by then, put on the sphere.
fn icosphere() -> Vec<DVec3> {
    let golden = 0.5 + 1.25f64.sqrt();
    let ring = [1.0, -1.0].into_iter().flat_map(|x| [DVec3::new(0.0, x, golden), DVec3::new(0.0, x, -golden)]);
    let turned = ring.flat_map(|p| [p, DVec3::new(p.y, p.z, p.x), DVec3::new(p.z, p.x, p.y)]);
    let mut points: Vec<DVec3> = turned.map(DVec3::normalize).collect();
    for longest_edge in [1.1, 0.7] {
        for (i, j) in (0..points.len()).flat_map(|j| (0..j).map(move |i| (i, j))) {
            if points[i].distance(points[j]) < longest_edge {
                points.push((points[i] + points[j]).normalize());
            }
        }
    }
    points
}

#[test]
fn one_vertex_in_the_middle_serves_a_whole_sphere() {
    for decimals in [1e4, 1e15] {
        let points = icosphere().into_iter().map(|p| (p * decimals).round() / decimals);
        let mut mesh = Mesh::new();
        mesh.insert(&points.collect::<Vec<_>>(), None, &Control::new()).unwrap();
        mesh.use_hull_as_domain().unwrap();
        let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
        assert_eq!((report.status, report.steiner, report.tetrahedra), (RefineStatus::Done, 1, 320));
        assert!(mesh.view().points[162].length() < 0.01);
    }
}

#[test]
fn boxes_are_refined_by_both_rules() {
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        for beta in [1.5, 2.0, 4.0] {
            for count in [0, 1, 2, 50] {
                let mut mesh = Mesh::from_plc(&random_box(count, 7), &Control::new()).unwrap();
                let options = RefineOptions { radius_edge: beta, rule, ..RefineOptions::default() };
                let report = mesh.refine(&options, &Control::new()).unwrap();
                assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
                assert_eq!(report.input_vertices, 8 + count);
                assert!(report.worst_radius_edge <= beta * (1.0 + 1e-12));
                check(&mesh, beta, 27.0);
            }
        }
    }
}

#[test]
fn small_features_grade_up_to_the_box() {
    let points = [DVec3::new(-0.5, 0.0, 0.0), DVec3::new(0.5, 0.0, 0.0)];
    let half = 50_000.0;
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        let plc = Plc::boxed(DVec3::splat(-half), DVec3::splat(half), points);
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let options = RefineOptions { radius_edge: 2.0, rule, ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert_eq!(report.bad, 0);
        check(&mesh, 2.0, 1e15);
    }
}

#[test]
fn stepping_reaches_the_bound_too() {
    let mut mesh = Mesh::from_plc(&random_box(120, 3), &Control::new()).unwrap();
    refine_in_steps(&mut mesh);
    check(&mesh, 2.0, 27.0);
}

#[test]
fn limits_stop_with_a_valid_mesh() {
    let plc = random_box(200, 5);
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    let options = RefineOptions { radius_edge: 1.5, max_vertices: 300, ..RefineOptions::default() };
    let report = mesh.refine(&options, &Control::new()).unwrap();
    assert_eq!((report.status, report.vertices), (RefineStatus::VertexLimit, 300));
    assert!(report.bad > 0);
    mesh.validate(3).unwrap();

    let control = Control::with_progress(|p| p.vertices < 320);
    let report = mesh.refine(&RefineOptions { radius_edge: 1.5, ..RefineOptions::default() }, &control).unwrap();
    assert_eq!(report.status, RefineStatus::Cancelled);
    mesh.validate(3).unwrap();

    // And on from there to the end.
    let report = mesh.refine(&RefineOptions { radius_edge: 1.5, ..RefineOptions::default() }, &Control::new()).unwrap();
    assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
    check(&mesh, 1.5, 27.0);
}

#[test]
fn a_minimum_edge_length_leaves_tetrahedra_bad_but_ends() {
    let mut mesh = Mesh::from_plc(&random_box(100, 9), &Control::new()).unwrap();
    let options = RefineOptions { radius_edge: 0.7, min_edge: 0.2, ..RefineOptions::default() };
    let report = mesh.refine(&options, &Control::new()).unwrap();
    assert_eq!(report.status, RefineStatus::Unrefined);
    assert!(report.bad > 0);
    mesh.validate(3).unwrap();
    let points = mesh.view().points;
    for &p in &points[report.input_vertices..] {
        assert!(points.iter().all(|&q| q == p || q.distance(p) >= 0.2));
    }
}

#[test]
fn the_hull_is_the_domain_of_bare_points() {
    let cube: Vec<DVec3> = random_box(200, 11).points;
    let octahedron =
        [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z].map(|p| p * 3.0).into_iter();
    let octahedron: Vec<DVec3> =
        octahedron.chain(random_box(30, 5).points.into_iter().skip(8).map(|p| p * 0.5)).collect();
    let tetrahedron = cube[..4].iter().map(|p| DVec3::new(p.x + p.y, p.y + p.z, p.z + p.x + 0.5 * p.x * p.y)).collect();
    for points in [cube, octahedron, tetrahedron] {
        for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
            let mut mesh = Mesh::new();
            mesh.insert(&points, None, &Control::new()).unwrap();
            let before = volume(&mesh);
            let options = RefineOptions { radius_edge: 2.0, rule, max_vertices: 10_000, ..RefineOptions::default() };
            let report = mesh.refine(&options, &Control::new()).unwrap();
            assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
            check(&mesh, 2.0, before);
        }
    }
}

#[test]
fn slender_hulls_end_too() {
    let mut next = numbers(17);
    for count in [5, 10, 30, 50, 200] {
        let points: Vec<DVec3> = (0..count).map(|_| DVec3::new(next(), next(), next())).collect();
        let mut mesh = Mesh::new();
        mesh.insert(&points, None, &Control::new()).unwrap();
        let before = volume(&mesh);
        let options = RefineOptions { max_vertices: 50_000, ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        println!("{report:?}");
        assert!(report.vertices < 50_000);
        assert_eq!(report.unrefined.iter().sum::<usize>(), report.bad);
        mesh.validate(3).unwrap();
        assert!((volume(&mesh) / before - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_turned_box_keeps_its_facets() {
    // Its corners and Steiner points lie on no plane exactly.
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1);
    let mut plc = random_box(40, 13);
    for p in &mut plc.points {
        *p = turn * *p + DVec3::new(0.1, 0.2, 0.3);
    }
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let options = RefineOptions { radius_edge: 2.0, rule, max_vertices: 20_000, ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
        check(&mesh, 2.0, 27.0);
    }
}

#[test]
fn degenerate_meshes_are_done_at_once() {
    for count in 0..4 {
        let mut mesh = Mesh::new();
        let points: Vec<DVec3> = (0..count).map(|i| DVec3::new(i as f64, (i * i) as f64, 0.0)).collect();
        mesh.insert(&points, None, &Control::new()).unwrap();
        let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
        assert_eq!((report.status, report.tetrahedra, report.vertices), (RefineStatus::Done, 0, count));
    }
}

#[test]
fn points_on_the_boundary_belong_to_it() {
    // Points in the middle of a facet, on an edge, and duplicated corners.
    let extra =
        [[1.5, 0.1, 0.2], [1.5, 1.5, 0.3], [1.5, 1.5, 1.5], [0.0, -1.5, 0.0], [0.2, -1.5, 0.1]].map(DVec3::from);
    let mut mesh = Mesh::from_plc(&Plc::boxed(DVec3::splat(-1.5), DVec3::splat(1.5), extra), &Control::new()).unwrap();
    assert_eq!(mesh.input_vertex_count(), 12);
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
    check(&mesh, 2.0, 27.0);
}

#[test]
fn wrong_options_are_refused() {
    let mut mesh = Mesh::new();
    for radius_edge in [f64::NAN, 0.5, -1.0, f64::INFINITY] {
        let options = RefineOptions { radius_edge, ..RefineOptions::default() };
        assert!(matches!(
            mesh.refine(&options, &Control::new()),
            Err(Error::InvalidOption { name: "radius_edge", .. })
        ));
    }
    let options = RefineOptions { min_edge: f64::NAN, ..RefineOptions::default() };
    assert!(matches!(mesh.refine(&options, &Control::new()), Err(Error::InvalidOption { name: "min_edge", .. })));
}

#[test]
fn domains_without_volume_are_refused() {
    use crate::{DomainElement, PlcFacet, PlcSegment};
    let whole = |plc: &Plc| match Mesh::from_plc(plc, &Control::new()) {
        Err(Error::InvalidDomain { element: DomainElement::Whole, .. }) => {}
        other => panic!("{other:?}"),
    };
    let mut open = random_box(5, 1);
    open.facets.pop();
    whole(&open);
    let mut flat = random_box(0, 1);
    flat.points.iter_mut().for_each(|p| p.z = 0.0);
    flat.facets = vec![PlcFacet { polygons: vec![vec![0, 1, 3, 2]], ..PlcFacet::default() }];
    whole(&flat);
    let mut bare = random_box(5, 1);
    bare.facets.clear();
    assert!(!Mesh::from_plc(&bare, &Control::new()).unwrap().view().tetrahedra.is_empty());
    bare.segments.push(PlcSegment { ends: [0, 1], marker: 0 });
    whole(&bare);
    // Elements that name what isn't there, or have no extent.
    let element = |plc: &Plc| match Mesh::from_plc(plc, &Control::new()) {
        Err(Error::InvalidDomain { element, problem }) => (element, problem),
        other => panic!("{other:?}"),
    };
    let mut plc = random_box(0, 1);
    plc.facets[4].polygons[0][1] = 99;
    assert_eq!(element(&plc).0, DomainElement::Facet(4));
    let mut plc = random_box(0, 1);
    plc.facets[2].polygons[0] = vec![0, 1];
    assert_eq!(
        element(&plc),
        (DomainElement::Facet(2), "has no area: its points lie on a line through (-1.5, -1.5, -1.5)".into())
    );
    let mut plc = random_box(0, 1);
    plc.facets[3].polygons[0][0] = 0;
    assert!(element(&plc).1.starts_with("is not planar"));
    let mut plc = random_box(0, 1);
    plc.segments.push(PlcSegment { ends: [3, 3], marker: 0 });
    assert_eq!(element(&plc).0, DomainElement::Segment(0));
}

#[test]
fn refused_points_leave_no_trace_in_the_bounding_box() {
    let mut next = numbers(17);
    let points: Vec<DVec3> = (0..60).map(|_| DVec3::new(next(), next(), next())).collect();
    for rule in [Rule::Sparse, Rule::Circumcenter] {
        let mut mesh = Mesh::new();
        mesh.insert(&points, None, &Control::new()).unwrap();
        mesh.refine(&RefineOptions { rule, ..RefineOptions::default() }, &Control::new()).unwrap();
        let all = mesh.t.points().iter();
        let exact = all.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        assert_eq!(mesh.t.bounding_box(), exact);
    }
}

#[test]
fn a_limit_met_with_nothing_left_to_do_is_done() {
    let plc = random_box(50, 7);
    let off = || RefineOptions { sparsify: Some(Sparsify::Off), ..RefineOptions::default() };
    let full = Mesh::from_plc(&plc, &Control::new()).unwrap().refine(&off(), &Control::new()).unwrap();
    for (max_vertices, status) in [(full.vertices, RefineStatus::Done), (full.vertices - 1, RefineStatus::VertexLimit)]
    {
        let options = RefineOptions { max_vertices, ..off() };
        let report = Mesh::from_plc(&plc, &Control::new()).unwrap().refine(&options, &Control::new()).unwrap();
        assert_eq!((report.status, report.vertices), (status, max_vertices));
    }
}

#[test]
fn what_one_call_could_not_split_the_next_may() {
    let mut mesh = Mesh::from_plc(&random_box(20, 9), &Control::new()).unwrap();
    let coarse = RefineOptions { radius_edge: 0.7, min_edge: 0.5, ..RefineOptions::default() };
    assert_eq!(mesh.refine(&coarse, &Control::new()).unwrap().status, RefineStatus::Unrefined);
    assert!(!mesh.boundary().unwrap().blocked.is_empty());
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
    check(&mesh, 2.0, 27.0);
}

#[test]
fn progress_never_falls() {
    use std::sync::{Arc, Mutex};
    let seen: Arc<Mutex<Vec<f64>>> = Arc::default();
    let sink = seen.clone();
    let control = Control::with_progress(move |p| {
        if p.stage == "refine" {
            sink.lock().unwrap().push(p.fraction);
        }
        true
    });
    let mut mesh = Mesh::from_plc(&random_box(1500, 2), &control).unwrap();
    mesh.refine(&RefineOptions { radius_edge: 1.5, ..RefineOptions::default() }, &control).unwrap();
    let seen = seen.lock().unwrap();
    assert!(seen.len() > 2 && seen.windows(2).all(|w| w[0] <= w[1]), "{seen:?}");
}

#[test]
fn seeds_must_be_finite() {
    let mut plc = random_box(0, 1);
    plc.facets[3].holes.push(DVec3::NAN);
    let refused = Mesh::from_plc(&plc, &Control::new());
    assert!(matches!(refused, Err(Error::InvalidDomain { element: crate::DomainElement::Facet(3), .. })));
}

/// Found by fuzzing: a vertex a unit in the last place off a side of the box; a refinement said that it was done, or had reached its limit, while
/// subsegments were missing.
#[test]
fn what_a_refinement_calls_done_has_all_of_its_boundary() {
    let loose = [[7.0, -8.000000000000002, -8.0], [2.0, -5.0, 2.9999999999999996], [-4.0, -8.0, -8.0]];
    let plc = Plc::boxed(DVec3::splat(-8.0), DVec3::splat(8.0), loose.map(DVec3::from));
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    for max_vertices in [0, 60, 400] {
        let options = RefineOptions { max_vertices, ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        mesh.triangulation().validate(3).unwrap();
        match mesh.validate(3) {
            Ok(()) => {}
            Err(defect) => assert_ne!(report.status, RefineStatus::Done, "{defect}"),
        }
    }
}

#[test]
fn seconds_and_bytes_end_a_refinement_where_it_can_go_on() {
    let plc =
        Plc::boxed(DVec3::splat(-8.0), DVec3::splat(8.0), [DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.1, 0.2, 0.31)]);
    let whole = {
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        mesh.refine(&RefineOptions::default(), &Control::new()).unwrap()
    };
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    let none = RefineOptions { max_seconds: 1e-300, ..RefineOptions::default() };
    let report = mesh.refine(&none, &Control::new()).unwrap();
    let added = report.samples + report.segment_splits + report.facet_splits;
    assert_eq!((report.status, added, report.measured), (RefineStatus::TimeLimit, 0, true));
    let little = RefineOptions { max_memory: 1, ..RefineOptions::default() };
    assert_eq!(mesh.refine(&little, &Control::new()).unwrap().status, RefineStatus::MemoryLimit);
    // As if nothing had been.
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    assert_eq!((report.status, report.vertices, report.bad), (whole.status, whole.vertices, 0));
}

/// Found by fuzzing: closing the gaps among the Steiner points' ids took the NaN of removed input points into the filter, and the predicates
/// answered wrongly from then on.
#[test]
fn removed_input_points_do_not_spoil_the_predicates() {
    let points = [
        [-8.0, 7.0, -6.0],
        [-8.0, -8.0, -8.000000000000002],
        [-8.0, -8.0, -8.0],
        [-4.0, -8.0, 0.0],
        [7.0, -6.0, -5.0],
        [-8.0, -0.9, -0.9],
        [-0.9, -8.0, -8.0],
        [3.0000000000000004, -8.0, -8.0],
        [-0.9, -0.9, -0.9],
    ]
    .map(DVec3::from);
    let mut mesh = Mesh::new();
    mesh.insert(&points, None, &Control::new()).unwrap();
    for v in [0, 1, 7] {
        mesh.remove(v).unwrap();
    }
    // The rule that splits what is encroached: here no tetrahedron is bad.
    let (rule, sparsify) = (Rule::Circumcenter, Some(Sparsify::Quick));
    let options = RefineOptions { rule, sparsify, max_vertices: 60, ..RefineOptions::default() };
    let report = mesh.refine(&options, &Control::new()).unwrap();
    assert!(report.removed + report.replaced > 0, "no gap was closed: {report:?}");
    mesh.triangulation().validate(3).unwrap();
    let (low, high) = mesh.triangulation().bounding_box();
    assert!(low.is_finite() && high.is_finite(), "{low} {high}");
}

#[test]
fn a_split_beside_a_nearly_flat_edge_of_the_hull_leaks_no_label() {
    // Two corners are a unit in the last place apart. The 185th vertex, a split of the hull's edge between the first and the sixth, comes to lie beside a
    // facet, so that what was outside it is inside.
    let points = [
        [-8.0, 7.0, -6.0],
        [3.9999999999999996, -4.0, -8.0],
        [-8.000000000000002, 7.0, -6.0],
        [-5.0, -8.0, -4.9],
        [-8.0, -8.0, 0.1],
        [0.1, 0.1, 0.1],
        [0.1, 0.1, -5.0],
        [-5.0, -5.0, -5.0],
        [-8.0, -5.9, -8.0],
        [-7.0, -8.0, 1.1],
        [-5.0, -3.0000000000000004, -8.0],
        [-8.0, -8.0, -7.0],
    ];
    let mut mesh = Mesh::new();
    mesh.insert(&points.map(DVec3::from), None, &Control::new()).unwrap();
    mesh.use_hull_as_domain().unwrap();
    for max_vertices in (180..190).chain([281]) {
        let rule = Rule::Circumcenter;
        let options = RefineOptions { rule, radius_edge: 1.5, max_vertices, ..RefineOptions::default() };
        mesh.refine(&options, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
    }
}

#[test]
fn splits_at_vertices_that_two_facets_have_are_taken_back_whole() {
    // Seen from the last point, 2e52 away, all others are one: splits meet in vertices that stand for several, and parts of them are there already.
    let points = [
        [-8.0, 7.0, -3.0],
        [-3.0, -3.0, -3.0],
        [3.9999999999999996, -4.0, -8.0],
        [-8.0, -7.0, -8.0],
        [-7.999999999999999, 7.0, -6.0],
        [-5.0, -8.0, -0.9],
        [-0.9, -0.9, -8.0],
        [-8.0, -8.0, 1.0],
        [1.0, 1.0, 1.0],
        [2.0, 2.0, 2.0],
        [2.0, 2.0, 7.0],
        [-2.8647537282032434e47, -7.805260849197838e43, -2.0048260471976572e52],
    ];
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        let mut mesh = Mesh::new();
        mesh.insert(&points.map(DVec3::from), None, &Control::new()).unwrap();
        let options = RefineOptions { rule, radius_edge: 1.5, max_vertices: 295, ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert_eq!(report.status, RefineStatus::Unrefined);
        mesh.validate(3).unwrap();
    }
}

/// Spacings from 2⁻²⁰ to 1.
#[test]
fn a_grading_of_a_million_ends_with_nothing_bad() {
    let mut next = numbers(23);
    let mut points = Vec::new();
    while points.len() < 250 {
        let direction = 2.0 * DVec3::new(next(), next(), next()) - DVec3::ONE;
        if (0.01..1.0).contains(&direction.length_squared()) {
            points.push(direction.normalize() * (-20.0 * next()).exp2());
        }
    }
    let plc = Plc::boxed(DVec3::splat(-1.5), DVec3::splat(1.5), points);
    for level in [Sparsify::Off, Sparsify::Moves, Sparsify::Quick] {
        for radius_edge in [1.1, 1.5, 4.0] {
            let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
            let options = RefineOptions { radius_edge, sparsify: Some(level), ..RefineOptions::default() };
            let report = mesh.refine(&options, &Control::new()).unwrap();
            assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
            check(&mesh, radius_edge, 27.0);
        }
    }
}

#[test]
fn a_domain_of_which_splits_take_all_out_keeps_its_labels() {
    // Inside there is but one tetrahedron. The first split leads to others, and by then nothing is left that has the label of the inside.
    let points = [
        [4.999999999999999, 5.0, -4.0],
        [-4.0, -4.0, 7.0],
        [2.0, 0.0, 7.0],
        [7.0, 2.9999999999999996, -2.0],
        [-1.0, 7.0, 7.0],
        [7.0, 7.0, -1.3333333333333333],
        [-7.0, -8.0, -8.0],
        [-8.0, -8.0, -8.0],
    ];
    for left_out in 4..=points.len() {
        let points = points.iter().enumerate().filter(|&(i, _)| i != left_out).map(|(_, &p)| DVec3::from(p));
        let facet = |corners: [u32; 3]| PlcFacet { polygons: vec![corners.into()], ..PlcFacet::default() };
        let facets = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]].map(facet).into();
        let plc = Plc { points: points.collect(), facets, ..Plc::default() };
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let before = volume(&mesh);
        for max_vertices in [10, 11, 12, 1000] {
            let options = RefineOptions { max_vertices, ..RefineOptions::default() };
            mesh.refine(&options, &Control::new()).unwrap();
            mesh.validate(3).unwrap();
            assert!((volume(&mesh) / before - 1.0).abs() < 1e-9, "{} of {before}", volume(&mesh));
        }
    }
}

#[test]
fn a_subfacet_that_two_facets_have_is_seen_without_labels() {
    // The last point is so far away that facets that meet there come to have the same triangles, with the outside on either side.
    let points = [
        [-8.0, 4.0, -8.0],
        [-5.0, -5.0, -5.0],
        [-2.0, -2.0, -2.0],
        [-1.0, -2.0, -8.0],
        [-2.0, -8.0, -8.0],
        [-8.0, -8.0, -8.0],
        [-2.0, -5.0, -7.0],
        [-7.0, -8.0, -8.0],
        [4.0, -7.0, 4.0],
        [-3.0, 7.0, 7.0],
        [3.6441835727946984e30, 3.5295369653413445e30, 3.5295369653427856e30],
    ];
    let mut mesh = Mesh::new();
    mesh.insert(&points.map(DVec3::from), None, &Control::new()).unwrap();
    for _ in 0..3 {
        let options = RefineOptions { radius_edge: 4.0, max_vertices: 105, ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert_eq!(report.status, RefineStatus::Unrefined);
        mesh.validate(3).unwrap();
    }
}

#[test]
fn a_split_beside_a_subfacet_that_stays_a_face_leaks_no_label() {
    // The last split of the segment between two of these vertices comes to lie so far beside a facet that what was its subfacet stays a face, and is nowhere near
    // the new vertex.
    let tenths = [
        [-7, -1, -5],
        [2, -4, 2],
        [1, 1, 1],
        [-7, -7, -1],
        [5, 2, -4],
        [0, 0, 0],
        [2, 2, 2],
        [2, 2, -4],
        [-7, -7, -7],
        [-7, -4, -3],
        [-7, -5, -4],
        [-4, -7, 6],
        [-4, -8, -5],
        [-6, 3, -4],
        [-4, -1, -1],
        [-6, -6, -6],
        [-8, -5, -6],
        [3, -4, -5],
        [0, 0, -7],
        [1, -1, -4],
        [5, 5, 5],
        [5, -8, -8],
        [1, 6, -4],
        [4, -7, -7],
        [-5, 5, -1],
        [-7, 2, -4],
        [1, -7, -7],
        [-5, -2, 7],
        [2, -4, -4],
    ];
    let points = tenths.map(|p| DVec3::from(p.map(|x: i32| f64::from(x) / 10.0)));
    let mut mesh = Mesh::new();
    mesh.insert(&points, None, &Control::new()).unwrap();
    for max_vertices in [105, 210] {
        let options = RefineOptions { radius_edge: 4.0, max_vertices, ..RefineOptions::default() };
        mesh.refine(&options, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
    }
}

/// Found by fuzzing: the circumcentre of a subfacet whose corners nearly are in line came to lie where no predicate holds.
#[test]
fn a_circumcentre_beyond_the_predicates_range_is_no_vertex() {
    let points = [
        [0.0, 5.04870979341476e-29, 0.296875],
        [-1.8978959697606932e-16, 2.093832106950585e34, -3.622547405812207e-43],
        [0.0, 3.138167743808124e57, 3.138167743808124e57],
        [1.7936688765890554e-43, 0.0, -2.076918751155803e34],
    ]
    .map(DVec3::from);
    let facet = |polygon: [u32; 3]| PlcFacet { polygons: vec![polygon.to_vec()], ..PlcFacet::default() };
    let facets = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]].map(facet).to_vec();
    let plc = Plc { points: points.to_vec(), facets, ..Plc::default() };
    match Mesh::from_plc(&plc, &Control::new()) {
        Ok(mesh) => mesh.validate(3).unwrap(),
        Err(error) => assert!(matches!(error, Error::InvalidDomain { .. }), "{error}"),
    }
    // The point itself.
    let mut t = Triangulation::new();
    t.insert_many(&[DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z], &Control::new()).unwrap().unwrap();
    let mut cavity = Cavity::default();
    let far = DVec3::new(-2.332002758916108e115, 6.652755312662908e49, 6.652755312662906e49);
    assert_eq!(t.prepare(far, t.recent(), &mut cavity, &Control::new()), Err(Unplaced::OutOfRange));
    assert_eq!(t.prepare(DVec3::X, t.recent(), &mut cavity, &Control::new()), Err(Unplaced::Occupied(1)));
}

/// The first sample in a sphere has a large cavity, that of all its vertices.
#[test]
fn a_refinement_is_cancelled_amid_large_cavities() {
    let count = 2000;
    let mut sphere = Mesh::new();
    sphere.insert(&on_a_sphere(count), None, &Control::new()).unwrap();
    for rule in [Rule::Sparse, Rule::Circumcenter] {
        let one = RefineOptions { rule, max_vertices: count + 1, ..RefineOptions::default() };
        let (control, mut refined) = (Control::new(), sphere.clone());
        let looks = control.looks(None, || assert!(refined.refine(&one, &control).is_ok()));
        assert!(looks > 20, "{looks}");
        for last in (1..=looks).rev().take(60).chain((1..looks).step_by(1013)) {
            let mut mesh = sphere.clone();
            let made = control.looks(Some(last), || {
                let report = mesh.refine(&one, &control).unwrap();
                assert_eq!(report.status, RefineStatus::Cancelled, "look {last} of {looks}");
            });
            // Each list that is given back looks once more.
            assert!(made <= last + 8, "{made} looks, {last} was the last");
            mesh.validate(2).unwrap();
            mesh.refine(&one, &control).unwrap();
            assert_eq!(mesh.triangulation().vertex_count(), refined.triangulation().vertex_count());
            mesh.validate(2).unwrap();
        }
    }
}
