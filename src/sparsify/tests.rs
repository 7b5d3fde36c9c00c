use std::collections::BTreeSet;

use std::sync::atomic::{AtomicUsize, Ordering};

use super::forecast::{Demand, Forecast};
use crate::domain::Unsplit;
use crate::refine::{RefineOptions, RefineStatus};
use crate::samples::{numbers, prism, random_points};
use crate::triangulation::cavity::Cavity;
use crate::triangulation::remove::{Hole, Replacement};
use crate::triangulation::topology::GHOST;
use crate::{Control, DVec3, Mesh, Plc, PlcFacet, PlcSegment, Rule, Sparsify, Triangulation};

fn random_box(count: usize, seed: u64) -> Plc {
    Plc::boxed(DVec3::splat(-1.5), DVec3::splat(1.5), random_points(count, seed))
}

/// A box in a slanted position with a facet and a segment inside.
fn slanted_box(count: usize, seed: u64) -> Plc {
    let mut plc = random_box(count, seed);
    let first = plc.points.len() as u32;
    plc.points.extend([[-1.2, -1.2, 0.3], [1.2, -1.2, 0.3], [1.2, 1.2, 0.3], [-1.2, 1.2, 0.3]].map(DVec3::from));
    plc.points.extend([[0.2, 0.1, -1.4], [0.25, -0.1, -0.2]].map(DVec3::from));
    plc.facets.push(PlcFacet { polygons: vec![(first..first + 4).collect()], ..PlcFacet::default() });
    plc.segments.push(PlcSegment { ends: [first + 4, first + 5], marker: 9 });
    let turn = glam::DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    for p in &mut plc.points {
        *p = turn * *p;
    }
    plc
}

fn volume(mesh: &Mesh) -> f64 {
    let view = mesh.view();
    let six = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| view.points[v as usize]);
        (b - a).cross(c - a).dot(d - a)
    };
    view.tetrahedra.iter().map(six).sum::<f64>() / 6.0
}

fn check(mesh: &Mesh, plc: &Plc, beta: f64) {
    mesh.validate(3).unwrap();
    mesh.validate_quality(beta).unwrap();
    assert!((volume(mesh) / 27.0 - 1.0).abs() < 1e-9, "{}", volume(mesh));
    assert_eq!(&mesh.view().points[..plc.points.len()], &plc.points[..], "an input vertex has moved");
    assert!(mesh.view().points.iter().all(|p| p.is_finite()), "a gap is left");
    // Each subfacet's vertices lie on its facet, and together they cover it.
    let boundary = mesh.boundary().unwrap();
    let area = |face: [u32; 3]| {
        let [a, b, c] = face.map(|v| mesh.view().points[v as usize]);
        0.5 * (b - a).cross(c - a).length()
    };
    let mut areas = vec![0.0; plc.facets.len()];
    for (face, facet) in boundary.subfacets() {
        areas[facet as usize] += area(face);
    }
    let expected = (0..plc.facets.len()).map(|i| if i < 6 { 9.0 } else { 5.76 });
    assert!(areas.iter().zip(expected).all(|(a, e)| (a / e - 1.0).abs() < 1e-9), "{areas:?}");
    let mut lengths = vec![0.0; boundary.segments().len()];
    for (edge, segment) in boundary.subsegments() {
        let [a, b] = edge.map(|v| mesh.view().points[v as usize]);
        lengths[segment as usize] += a.distance(b);
    }
    for (segment, length) in boundary.segments().iter().zip(lengths) {
        let [a, b] = segment.ends.map(|v| mesh.view().points[v as usize]);
        assert!((length / a.distance(b) - 1.0).abs() < 1e-9);
    }
}

fn refined(plc: &Plc, options: &RefineOptions) -> (Mesh, crate::RefineReport) {
    let mut mesh = Mesh::from_plc(plc, &Control::new()).unwrap();
    let report = mesh.refine(options, &Control::new()).unwrap();
    assert_eq!((report.status, report.bad), (RefineStatus::Done, 0), "{options:?}: {report:?}");
    (mesh, report)
}

#[test]
fn meshes_come_out_sparser_and_as_good() {
    for plc in [random_box(0, 1), random_box(150, 5), slanted_box(60, 8)] {
        for beta in [1.2, 1.5, 2.0, 4.0] {
            let counts = [Sparsify::Off, Sparsify::Moves, Sparsify::Quick, Sparsify::Thorough].map(|level| {
                let options = RefineOptions { radius_edge: beta, sparsify: Some(level), ..RefineOptions::default() };
                let (mesh, report) = refined(&plc, &options);
                check(&mesh, &plc, beta);
                assert_eq!(report.vertices, mesh.view().points.len());
                report.steiner
            });
            let [off, moves, quick, thorough] = counts;
            assert!(off < 8 || moves <= off && quick < moves && thorough < moves, "{beta}: {counts:?}");
        }
    }
}

#[test]
fn a_bound_of_one_can_be_kept() {
    // A new point may then be as near as the edge that it mends is long, so that nothing promises an end: circumcentres don't.
    let half = DVec3::splat(5e4);
    let plc = Plc::boxed(-half, half, [DVec3::ZERO, DVec3::X]);
    let ends = |rule, sparsify| {
        let options =
            RefineOptions { radius_edge: 1.0, rule, sparsify, max_vertices: 10_000, ..RefineOptions::default() };
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let report = mesh.refine(&options, &Control::new()).unwrap();
        if report.status == RefineStatus::Done {
            assert_eq!((mesh.validate(3), mesh.validate_quality(1.0)), (Ok(()), Ok(())));
        }
        report.status == RefineStatus::Done && report.bad == 0
    };
    assert!(ends(Rule::Sparse, Some(Sparsify::Quick)) && !ends(Rule::Circumcenter, None));
}

#[test]
fn what_splits_the_boundary_is_made_one_with_a_neighbour() {
    let mut boxed = random_box(0, 1);
    boxed.points.extend(random_points(600, 4).into_iter().map(|p| 1.5 * p));
    let options = RefineOptions { radius_edge: 1.5, sparsify: Some(Sparsify::Moves), ..RefineOptions::default() };
    for plc in [boxed, slanted_box(60, 8)] {
        let on_boundary = |mesh: &Mesh| {
            let vertices = 0..mesh.triangulation().points().len() as u32;
            vertices.filter(|&v| mesh.boundary().unwrap().kind(v) != 0).count()
        };
        let before = on_boundary(&Mesh::from_plc(&plc, &Control::new()).unwrap());
        let (mesh, report) = refined(&plc, &options);
        check(&mesh, &plc, 1.5);
        // Each split has put one there, and at this level nothing else takes any away.
        let splits = report.segment_splits + report.facet_splits;
        assert!(on_boundary(&mesh) < before + splits, "{before} {report:?}");
    }
}

#[test]
fn a_kept_boundary_keeps_the_points_that_its_recovery_has_put_there() {
    let plc = slanted_box(60, 8);
    let boundary = |mesh: &Mesh| -> BTreeSet<[[u64; 3]; 3]> {
        let place = |v: u32| mesh.triangulation().point(v).unwrap().to_array().map(f64::to_bits);
        let faces = mesh.boundary().unwrap().subfacets();
        let sorted = |face: [u32; 3]| {
            let mut places = face.map(place);
            places.sort_unstable();
            places
        };
        faces.into_iter().map(|(face, _)| sorted(face)).collect()
    };
    for level in [Sparsify::Moves, Sparsify::Quick, Sparsify::Thorough] {
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let before = boundary(&mesh);
        assert!(mesh.triangulation().vertex_count() > plc.points.len(), "nothing had to be recovered");
        let options = RefineOptions { keep_boundary: true, sparsify: Some(level), ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert!(report.replaced > 0, "{report:?}");
        mesh.validate(3).unwrap();
        assert_eq!(boundary(&mesh), before);
        // Without that wish they may go.
        let sparser = mesh.sparsify(2.0, Sparsify::Quick, &Control::new()).unwrap();
        assert!(sparser.removed + sparser.replaced > 0 && boundary(&mesh) != before);
    }
}

#[test]
fn merges_are_tried_less_often_where_few_come_to_something() {
    let mut odds = super::Odds::default();
    let turns = 100 * super::Odds::SOME;
    let tried = |odds: &mut super::Odds| (0..turns).filter(|_| odds.are_good()).count();
    let first = tried(&mut odds);
    assert!(first > super::Odds::FIRST && first < super::Odds::FIRST + 101, "{first}");
    odds.made = odds.tried;
    assert_eq!(tried(&mut odds), turns);
}

#[test]
fn the_other_rules_can_have_the_pass_too() {
    let plc = random_box(80, 2);
    for rule in [Rule::Paper, Rule::Circumcenter] {
        let with =
            |sparsify| refined(&plc, &RefineOptions { radius_edge: 1.5, rule, sparsify, ..RefineOptions::default() });
        let (mesh, report) = with(Some(Sparsify::Quick));
        check(&mesh, &plc, 1.5);
        assert_eq!((with(None).1.removed, with(None).1.replaced), (0, 0));
        assert!(report.replaced > 0 && report.steiner < with(None).1.steiner);
    }
}

#[test]
fn by_itself_it_works_until_little_is_left() {
    for plc in [random_box(100, 6), slanted_box(40, 3)] {
        let options = RefineOptions { rule: Rule::Circumcenter, ..RefineOptions::default() };
        let (mut mesh, before) = refined(&plc, &options);
        let report = mesh.sparsify(2.0, Sparsify::Quick, &Control::new()).unwrap();
        check(&mesh, &plc, 2.0);
        assert_eq!(report.status, RefineStatus::Done);
        assert_eq!(before.steiner - report.steiner, report.removed + report.replaced);
        assert!(report.steiner * 10 < before.steiner * 9, "{} {}", report.steiner, before.steiner);
        let again = mesh.sparsify(2.0, Sparsify::Quick, &Control::new()).unwrap();
        // What is seen of a neighbourhood reaches a little farther than what brings it back: next to nothing is left to find.
        assert!((again.removed + again.replaced) * 20 <= report.removed + report.replaced);
    }
}

#[test]
fn refining_goes_on_after_it() {
    let plc = slanted_box(60, 4);
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    for beta in [8.0, 2.0, 1.3] {
        let options =
            RefineOptions { radius_edge: beta, sparsify: Some(Sparsify::Thorough), ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        assert_eq!((report.status, report.bad), (RefineStatus::Done, 0));
        check(&mesh, &plc, beta);
    }
}

#[test]
fn nothing_becomes_bad_where_something_is() {
    let plc = random_box(60, 9);
    let options = RefineOptions { radius_edge: 4.0, sparsify: Some(Sparsify::Off), ..RefineOptions::default() };
    let (mut mesh, _) = refined(&plc, &options);
    let before = mesh.report(1.2, RefineStatus::Done).bad;
    let report = mesh.sparsify(1.2, Sparsify::Quick, &Control::new()).unwrap();
    assert_eq!(report.status, RefineStatus::Unrefined);
    assert!(before > 0 && report.bad <= before);
    mesh.validate(3).unwrap();
}

#[test]
fn cancelled_it_leaves_a_valid_mesh() {
    let plc = random_box(150, 7);
    let options = RefineOptions { radius_edge: 1.5, sparsify: Some(Sparsify::Thorough), ..RefineOptions::default() };
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    let control = Control::with_progress(|p| p.stage != "sparsify" || p.fraction < 0.3);
    let report = mesh.refine(&options, &control).unwrap();
    assert_eq!((report.status, report.measured), (RefineStatus::Cancelled, false));
    mesh.validate(3).unwrap();
    mesh.validate_quality(1.5).unwrap();
    // The gaps that it has left among the ids are closed by the next call.
    let slots = mesh.triangulation().vertex_slots();
    let report = mesh.refine(&RefineOptions { sparsify: Some(Sparsify::Quick), ..options }, &Control::new()).unwrap();
    assert!(report.status == RefineStatus::Done && report.vertices < slots);
    check(&mesh, &plc, 1.5);
}

#[test]
fn no_volume_and_no_steiner_points_are_ordinary_input() {
    for points in [vec![], random_points(1, 1), random_points(3, 1), random_points(20, 1)] {
        let mut mesh = Mesh::new();
        mesh.insert(&points, None, &Control::new()).unwrap();
        let report = mesh.sparsify(1e6, Sparsify::Thorough, &Control::new()).unwrap();
        assert_eq!((report.vertices, report.removed, report.replaced), (points.len(), 0, 0));
    }
    assert!(Mesh::new().sparsify(0.5, Sparsify::Quick, &Control::new()).is_err());
}

#[test]
fn a_forecast_is_what_the_preview_says() {
    let mut t = Triangulation::new();
    t.insert_many(&random_points(400, 3), &Control::new()).unwrap();
    let boundary = crate::domain::Boundary::default();
    let (mut forecast, mut hole) = (Forecast::default(), Hole::default());
    let demand = Demand { bound2: 1e300, level2: f64::INFINITY };
    let mut seen = 0;
    for v in 0..400u32 {
        let Some(&w) = t.topology.star(v).iter().flat_map(|&tet| &t.topology.tet(tet).v).find(|&&w| w != v) else {
            continue;
        };
        for remove in [&[v][..], &[v, w]] {
            let at_hull = |&v: &u32| t.topology.star(v).iter().any(|&tet| t.topology.tet(tet).is_ghost());
            if remove.contains(&GHOST) || remove.iter().any(at_hull) {
                continue;
            }
            assert!(forecast.open(&t, remove));
            if !forecast.fill(&t, &boundary, remove, &Unsplit::default(), demand, usize::MAX) {
                // It reaches the hull, and nothing says that the domain ends there.
                continue;
            }
            t.preview(&Replacement { remove, add: None }, &|_| false, &mut hole).unwrap();
            let sorted = |mut v: [u32; 4]| {
                v.sort_unstable();
                v
            };
            let exact: BTreeSet<[u32; 4]> = hole.coming.iter().map(|coming| sorted(coming.v)).collect();
            let foreseen = forecast.filling.iter().map(|tet| sorted(tet.v.map(|i| forecast.vertices[i as usize])));
            assert_eq!(exact, foreseen.collect());
            seen += 1;
        }
    }
    assert!(seen > 300, "{seen}");
}

/// The filling as vertices, sorted.
fn filled(forecast: &Forecast) -> BTreeSet<[u32; 4]> {
    let sorted = |mut v: [u32; 4]| {
        v.sort_unstable();
        v
    };
    forecast.filling.iter().map(|tet| sorted(tet.v.map(|i| forecast.vertices[i as usize]))).collect()
}

#[test]
fn a_hole_that_follows_from_another_is_as_one_made_anew() {
    let mut t = Triangulation::new();
    t.insert_many(&random_points(400, 3), &Control::new()).unwrap();
    let boundary = crate::domain::Boundary::default();
    // All tetrahedra are obstacles.
    let demand = Demand { bound2: 0.1, level2: f64::INFINITY };
    let [mut known, mut more, mut anew] = [(); 3].map(|()| Forecast::default());
    let mut cavity = Cavity::default();
    let mut next = numbers(8);
    let (mut of_vertices, mut of_points) = (0, 0);
    for v in 0..400u32 {
        let Some(&w) =
            t.topology.star(v).iter().flat_map(|&tet| &t.topology.tet(tet).v).find(|&&w| w != v && w != GHOST)
        else {
            continue;
        };
        // The hole of two vertices from that of one.
        let plan = Unsplit::default();
        if known.open(&t, &[v])
            && known.fill(&t, &boundary, &[v], &plan, demand, usize::MAX)
            && more.fill_more(&mut known, &t, &boundary, (w, 0.0), demand, usize::MAX)
        {
            assert!(anew.open(&t, &[v, w]) && anew.fill(&t, &boundary, &[v, w], &plan, demand, usize::MAX));
            assert_eq!(filled(&more), filled(&anew));
            of_vertices += 1;
        }
        // The hole of a vertex from the cavity of a point: as if the point had been inserted, and both were removed.
        let p = t.at(w) + 0.1 * (DVec3::new(next(), next(), next()) - 0.5);
        t.prepare(p, t.recent(), &mut cavity, &Control::new()).unwrap();
        if known.take_cavity(&t, &boundary, (p, &cavity), demand, usize::MAX)
            && more.fill_more(&mut known, &t, &boundary, (w, 0.0), demand, usize::MAX)
        {
            let mut with = t.clone();
            let new = with.insert(p, None).unwrap().vertex;
            if anew.open(&with, &[new, w]) && anew.fill(&with, &boundary, &[new, w], &plan, demand, usize::MAX) {
                assert_eq!(filled(&more), filled(&anew));
                of_points += 1;
            }
        }
        cavity.clear();
    }
    assert!(of_vertices > 150 && of_points > 150, "{of_vertices} {of_points}");
}

#[test]
fn neighbours_of_something_finer_are_left_where_they_are() {
    let mut t = Triangulation::new();
    t.insert_many(&random_points(200, 9), &Control::new()).unwrap();
    let boundary = crate::domain::Boundary::default();
    let demand = Demand { bound2: 1e300, level2: f64::INFINITY };
    let [mut known, mut more] = [(); 2].map(|()| Forecast::default());
    let mut seen = 0;
    for v in 0..200u32 {
        if !known.open(&t, &[v]) || !known.fill(&t, &boundary, &[v], &Unsplit::default(), demand, usize::MAX) {
            continue;
        }
        let Some(&w) = known.vertices.first() else { continue };
        let star = t.topology.star(w);
        let near = star.iter().flat_map(|&tet| t.topology.tet(tet).v).filter(|&x| x != w && x != GHOST);
        let spacing = near.map(|x| t.at(x).distance(t.at(w))).fold(f64::INFINITY, f64::min);
        let mut fill = |least: f64| more.fill_more(&mut known, &t, &boundary, (w, least), demand, usize::MAX);
        if fill(0.0) {
            assert!(fill(0.999 * spacing) && !fill(1.001 * spacing));
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen}");
}

#[test]
fn a_forecast_of_a_point_tells_the_worst_that_comes() {
    let mut t = Triangulation::new();
    t.insert_many(&random_points(400, 4), &Control::new()).unwrap();
    let boundary = crate::domain::Boundary::default();
    let (mut forecast, mut hole) = (Forecast::default(), Hole::default());
    let demand = Demand { bound2: 1e-6, level2: f64::INFINITY };
    let mut next = numbers(5);
    let mut seen = 0;
    for v in 0..400u32 {
        if t.topology.star(v).iter().any(|&tet| t.topology.tet(tet).is_ghost()) {
            continue;
        }
        let p = t.at(v) + 0.05 * (DVec3::new(next(), next(), next()) - 0.5);
        if !forecast.open(&t, &[v])
            || !forecast.fill(&t, &boundary, &[v], &Unsplit::default(), Demand { bound2: 1e300, ..demand }, usize::MAX)
        {
            continue;
        }
        let outcome = forecast.try_point(&t, &boundary, p, &[], demand, f64::INFINITY);
        t.preview(&Replacement { remove: &[v], add: Some(p) }, &|_| false, &mut hole).unwrap();
        let added = |c: &&crate::triangulation::remove::Coming| c.v.contains(&crate::triangulation::remove::ADDED);
        let worst = hole.coming.iter().filter(added).filter_map(|c| t.coming_corners(&hole, c)).map(|corners| {
            let (radius2, shortest2) = crate::geometry::quality::radius_and_edge_squared(corners);
            radius2 / (shortest2 * demand.bound2)
        });
        let worst = worst.fold(0.0, f64::max);
        if outcome.is_infinite() {
            // It is beside itself where the hull or a sliver is: then nothing is done there.
            continue;
        }
        assert!((outcome / worst - 1.0).abs() < 1e-6, "{outcome} {worst}");
        // And what comes in full is what an exact look finds.
        assert!(forecast.foresee(&t, &boundary, p));
        let sorted = |mut v: [u32; 4]| {
            v.sort_unstable();
            v
        };
        let exact: BTreeSet<[u32; 4]> = hole.coming.iter().map(|coming| sorted(coming.v)).collect();
        assert_eq!(forecast.guess.coming.iter().map(|coming| sorted(coming.v)).collect::<BTreeSet<_>>(), exact);
        let going: BTreeSet<u32> = hole.going.iter().map(|going| going.t).collect();
        assert_eq!(forecast.guess.going.iter().copied().collect::<BTreeSet<_>>(), going);
        let replacement = Replacement { remove: &[v], add: Some(p) };
        assert!(t.certify(&replacement, &forecast.guess, &|_| false, &mut hole));
        seen += 1;
    }
    assert!(seen > 200, "{seen}");
}

#[test]
fn the_same_input_gives_the_same_bytes_on_any_number_of_threads() {
    // Of the cylinder's vertices few pairs on the boundary come to something, so that it matters which ones are tried.
    let angle = |i: u32| f64::from(i) / 200.0 * std::f64::consts::TAU;
    let cylinder = prism(&std::array::from_fn::<_, 200, _>(|i| [angle(i as u32).cos(), angle(i as u32).sin()]), 0.3);
    // Hundreds of vertices are tried, most of them neighbours: changes that touch each other come in the same block.
    let cases = [
        (random_box(150, 5), 1.2, Sparsify::Quick),
        (slanted_box(80, 12), 1.2, Sparsify::Thorough),
        (cylinder, 2.0, Sparsify::Quick),
    ];
    for (plc, radius_edge, level) in cases {
        let [one, again, two, many] = [1, 1, 2, 8].map(|threads| {
            let options = RefineOptions { radius_edge, sparsify: Some(level), ..RefineOptions::default() };
            let mut mesh = Mesh::from_plc_on(threads, &plc, &Control::new()).unwrap();
            let report = mesh.refine(&options, &Control::new()).unwrap();
            assert_eq!((report.status, report.bad), (RefineStatus::Done, 0), "{options:?}: {report:?}");
            assert_eq!((mesh.validate(3), mesh.validate_quality(radius_edge)), (Ok(()), Ok(())));
            let points = mesh.view().points.iter().map(|p| p.to_array().map(f64::to_bits)).collect::<Vec<_>>();
            let (tetrahedra, neighbours) = (mesh.view().tetrahedra.to_vec(), mesh.view().neighbours.to_vec());
            (points, [report.steiner, report.removed, report.replaced], tetrahedra, neighbours)
        });
        let [steiner, removed, replaced] = one.1;
        assert!(steiner > 200 && removed + replaced > 100, "{level:?}: {:?}", one.1);
        assert!(one == again && one == two && one == many, "{level:?}");
    }
}

/// One point is so far away that the hull's facets at it come together by rounding. A vertex that was taken away stayed in a facet that its carrier
/// was not on, and a later refinement of the same mesh indexed it.
#[test]
fn a_vertex_of_a_facet_that_its_carrier_is_not_on_stays() {
    let points = [
        [-8.0, 4.0, -8.0],
        [-5.0, -5.0, -5.0],
        [-2.0, -2.0, -2.0],
        [-2.0, -2.0, -2.0],
        [-1.0, -2.0, -8.0],
        [-2.0, -8.0, -8.0],
        [-8.0, -8.0, -8.0],
        [-2.0, -5.0, -7.0],
        [-7.0, -8.0, -8.0],
        [4.0, -7.0, 4.0],
        [-3.0, 7.0, 7.0],
        [1.5880449566457765e29, 3.5295369653413445e30, 3.5295369657102793e30],
    ];
    let mut mesh = crate::Mesh::new();
    mesh.insert(&points.map(DVec3::from), None, &Control::new()).unwrap();
    let steps = [
        (1.2, Sparsify::Off),
        (4.0, Sparsify::Off),
        (4.0, Sparsify::Off),
        (2.0, Sparsify::Thorough),
        (2.0, Sparsify::Quick),
        (4.0, Sparsify::Off),
    ];
    for (radius_edge, level) in steps {
        let options = crate::RefineOptions {
            radius_edge,
            max_vertices: 200,
            sparsify: Some(level),
            ..crate::RefineOptions::default()
        };
        mesh.refine(&options, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
    }
}

/// Found by fuzzing: a flat tetrahedron at a slanted hull facet came to lie outside when two vertices gave way to one on a segment, and had the label of the
/// inside.
#[test]
fn a_flat_tetrahedron_that_leaves_the_domain_is_outside() {
    let points = [
        [-8.0, 2.9999999999999996, 7.0],
        [3.9999999999999996, -4.0, -8.000000000000002],
        [-8.0, 7.0, -7.000000000000001],
        [-3.0, -7.000000000000001, -7.000000000000001],
        [-4.000000000000001, -5.0, 2.0],
        [2.0, 2.0, -4.000000000000001],
        [6.0, -5.999999999999999, -4.0],
        [-5.0, -6.0, -6.0],
        [-4.0, -4.0, -4.0],
        [-1.0, -1.0, -6.0],
        [-6.0, -4.0, -7.0],
        [-8.0, -8.0, -8.0],
        [-6.0, -6.0, 3.0],
        [7.0, -8.0, -8.0],
    ]
    .map(DVec3::from);
    for (rule, level) in [
        (Rule::Paper, Sparsify::Quick),
        (Rule::Paper, Sparsify::Thorough),
        (Rule::Circumcenter, Sparsify::Quick),
        (Rule::Circumcenter, Sparsify::Thorough),
    ] {
        let mut mesh = Mesh::new();
        mesh.insert(&points, None, &Control::new()).unwrap();
        for max_vertices in [165, usize::MAX] {
            let options = RefineOptions { rule, max_vertices, sparsify: Some(level), ..RefineOptions::default() };
            mesh.refine(&options, &Control::new()).unwrap();
            mesh.validate(3).unwrap_or_else(|defect| panic!("{rule:?}, {level:?}: {defect}"));
        }
    }
}

/// Found by fuzzing: the middles of two segments with ends far apart were the same point, the facets at them then had a triangle in common, and when a vertex of it
/// was removed one of the two kept it.
#[test]
fn facets_do_not_fold_onto_each_other() {
    let points = [
        [-4.0, -4.0, -4.0],
        [-4.0, 1.0, 1.0],
        [1.0, -1.0000000000000002, 7.0],
        [-2.9444959458045504e47, -2.9444959457990247e47, -9.717876741935393e44],
        [1.0, 1.0, 1.0],
        [-2.9, -4.9, -4.9],
        [-8.0, -8.0, -8.0],
        [1.0, 0.0, 0.0],
        [1.0, -1.0, 1.0],
        [-1.0, -7.0, -8.0],
        [-1.0, -1.0, -1.0],
        [-2.0, -2.0, -2.0],
        [4.999999999999999, 4.0, 7.0],
        [-2.9444959457991504e47, -1.150193728827744e45, -2.9444959457990247e47],
    ]
    .map(DVec3::from);
    let mut given = Mesh::new();
    given.insert(&points, None, &Control::new()).unwrap();
    given.remove(1).unwrap();
    for rule in [Rule::Sparse, Rule::Paper, Rule::Circumcenter] {
        for calls in 0..12 {
            let mut mesh = given.clone();
            let told = AtomicUsize::new(0);
            let cancelled = Control::with_progress(move |_| told.fetch_add(1, Ordering::Relaxed) < calls);
            let sparsify = Some(Sparsify::Thorough);
            let options =
                RefineOptions { radius_edge: 4.0, rule, max_vertices: 237, sparsify, ..RefineOptions::default() };
            for control in [cancelled, Control::new()] {
                mesh.refine(&options, &control).unwrap_or_else(|error| panic!("{rule:?}: {error}"));
                mesh.validate(3).unwrap_or_else(|defect| panic!("{rule:?}: {defect}"));
            }
        }
    }
}
