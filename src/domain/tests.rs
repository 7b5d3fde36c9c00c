//! Domains of all kinds, each meshed and then checked against its own description: volume, area of each facet, validity, bound.

use super::Carrier;
use crate::geometry::quality::exceeds_radius_edge;
use crate::refine::{Rule, Sparsify, Unrefined};
use crate::samples::{facet, prism, thin_plate};
use crate::{Control, DVec3, Mesh, Plc, PlcRegion, PlcSegment, RefineOptions, RefineReport};

fn add(plc: &mut Plc, points: &[[f64; 3]]) -> u32 {
    let first = plc.points.len() as u32;
    plc.points.extend(points.iter().copied().map(DVec3::from));
    first
}

fn polygon_area(plc: &Plc, polygon: &[u32]) -> f64 {
    let at = |v: u32| plc.points[v as usize] - plc.points[polygon[0] as usize];
    let cross = (0..polygon.len()).map(|i| at(polygon[i]).cross(at(polygon[(i + 1) % polygon.len()])));
    0.5 * cross.sum::<DVec3>().length()
}

/// Meshes a domain of single polygons and checks all that can be checked.
fn meshed(plc: &Plc, beta: f64, volume: f64) -> (Mesh, RefineReport) {
    assert!(plc.check().errors().next().is_none());
    let mut mesh = Mesh::from_plc(plc, &Control::new()).unwrap();
    mesh.validate(3).unwrap();
    let options = RefineOptions { radius_edge: beta, max_vertices: 200_000, ..RefineOptions::default() };
    let report = mesh.refine(&options, &Control::new()).unwrap();
    mesh.validate(3).unwrap();
    let view = mesh.view();
    let corners = |t: &[u32; 4]| t.map(|v| view.points[v as usize]);
    let six = |t: &[u32; 4]| {
        let [a, b, c, d] = corners(t);
        (b - a).cross(c - a).dot(d - a)
    };
    assert!(view.tetrahedra.iter().all(|t| crate::geometry::predicates::orient3d(
        view.points[t[0] as usize],
        view.points[t[1] as usize],
        view.points[t[2] as usize],
        view.points[t[3] as usize]
    ) == crate::geometry::Sign::Positive));
    let found = view.tetrahedra.iter().map(six).sum::<f64>() / 6.0;
    assert!((found / volume - 1.0).abs() < 1e-9, "volume {found}, expected {volume}");
    // Each facet is covered by its subfacets, and only once.
    let boundary = mesh.boundary().unwrap();
    let mut areas = vec![0.0; plc.facets.len()];
    for (face, facet) in boundary.subfacets() {
        let [a, b, c] = face.map(|v| view.points[v as usize]);
        areas[facet as usize] += 0.5 * (b - a).cross(c - a).length();
    }
    for (i, (facet, area)) in plc.facets.iter().zip(&areas).enumerate() {
        let expected = polygon_area(plc, &facet.polygons[0]);
        assert!((area / expected - 1.0).abs() < 1e-9, "facet {i} has area {area}, expected {expected}");
    }
    let bad = view.tetrahedra.iter().filter(|t| exceeds_radius_edge(corners(t), beta)).count();
    assert_eq!(report.bad, bad);
    assert_eq!(report.unrefined.iter().sum::<usize>(), bad);
    for reason in [Unrefined::Limit, Unrefined::MinEdge] {
        assert_eq!(report.unrefined[reason as usize], 0, "{report:?}");
    }
    (mesh, report)
}

#[test]
fn an_l_shape() {
    let plc = prism(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 1.0);
    assert_eq!(meshed(&plc, 1.2, 3.0).1.bad, 0);
    assert_eq!(meshed(&plc, 2.0, 3.0).1.bad, 0);
}

#[test]
fn a_box_with_a_cavity() {
    let mut plc = Plc::boxed(DVec3::ZERO, DVec3::splat(4.0), []);
    let inner = Plc::boxed(DVec3::new(1.0, 1.0, 1.0), DVec3::new(2.0, 3.0, 2.5), []);
    let base = plc.points.len() as u32;
    plc.points.extend(inner.points);
    plc.facets.extend(inner.facets.iter().map(|f| facet(f.polygons[0].iter().map(|v| base + v), 0)));
    plc.holes.push(DVec3::new(1.5, 2.0, 2.0));
    assert_eq!(meshed(&plc, 2.0, 61.0).1.bad, 0);
    plc.holes.clear();
    plc.regions.push(PlcRegion { point: DVec3::new(1.5, 2.0, 2.0), attribute: 1.0, max_volume: None });
    let (mesh, report) = meshed(&plc, 2.0, 64.0);
    assert_eq!(report.bad, 0);
    let view = mesh.view();
    assert!(view.regions.contains(&0) && view.regions.contains(&1));
    let elements = view.tetrahedra.iter().copied().zip(view.regions.iter().copied());
    assert!(mesh.elements().eq(elements));
}

/// Two boxes one above the other with one facet between them.
fn two_boxes() -> Plc {
    let mut plc = prism(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0);
    add(&mut plc, &[[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]]);
    plc.facets.push(facet(8..12, 7));
    plc.facets.extend((0..4).map(|i| facet([4 + i, 4 + (i + 1) % 4, 8 + (i + 1) % 4, 8 + i], 8 + i as i32)));
    for (z, volume) in [(0.5, None), (1.5, Some(0.01))] {
        plc.regions.push(PlcRegion { point: DVec3::new(0.5, 0.5, z), attribute: z, max_volume: volume });
    }
    plc
}

#[test]
fn two_boxes_sharing_a_facet() {
    let (mesh, report) = meshed(&two_boxes(), 2.0, 2.0);
    assert_eq!((report.bad, report.too_large), (0, 0));
    let view = mesh.view();
    let of_region = |region| view.regions.iter().filter(move |&&r| r == region).count();
    // The upper one asks for small tetrahedra.
    assert!(of_region(2) >= 100 && of_region(1) < of_region(2), "{} {}", of_region(1), of_region(2));
    assert_eq!(of_region(0), 0);
}

#[test]
fn a_wedge_of_five_degrees() {
    let (sin, cos) = 5f64.to_radians().sin_cos();
    let plc = prism(&[[0.0, 0.0], [1.0, 0.0], [cos, sin]], 1.0);
    let (_, report) = meshed(&plc, 2.0, 0.5 * sin);
    assert!(report.vertices < 200, "{report:?}");
}

#[test]
fn what_is_merged_onto_a_sharp_segment_knows_it() {
    use super::boundary::SHARP;
    let mut plc = prism(&[[0.0, 0.0], [1.0, 0.0], [0.8, 0.6]], 1.0);
    let mut next = crate::samples::numbers(11);
    // Near the edge at 37°, and along all of it.
    let near: Vec<[f64; 3]> =
        (0..300).map(|_| [next(), next(), next()]).map(|[r, s, z]| [0.3 * r, 0.2 * r * s, z]).collect();
    add(&mut plc, &near);
    let mut on_sharp = 0;
    for level in [Sparsify::Moves, Sparsify::Quick, Sparsify::Thorough] {
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let options = RefineOptions { radius_edge: 1.5, sparsify: Some(level), ..RefineOptions::default() };
        assert!(mesh.refine(&options, &Control::new()).unwrap().replaced > 0);
        mesh.validate(3).unwrap();
        let boundary = mesh.boundary().unwrap();
        for v in mesh.triangulation().vertices() {
            if let Carrier::Segment(s) = boundary.carrier(v) {
                let sharp = boundary.sharp_segments[s as usize];
                on_sharp += usize::from(sharp);
                assert_eq!(boundary.kind(v) & SHARP != 0, sharp, "{level:?} {v}");
            }
        }
    }
    assert!(on_sharp > 10, "{on_sharp}");
}

#[test]
fn a_dangling_segment_and_facet() {
    let mut plc = Plc::boxed(DVec3::ZERO, DVec3::splat(4.0), []);
    let base = add(&mut plc, &[[1.0, 1.0, 1.0], [2.0, 3.0, 2.0], [3.0, 1.0, 1.0], [3.0, 3.0, 1.5], [3.0, 2.0, 3.0]]);
    plc.segments.push(PlcSegment { ends: [base, base + 1], marker: 5 });
    plc.facets.push(facet(base + 2..base + 5, 6));
    let (mesh, report) = meshed(&plc, 2.0, 64.0);
    assert_eq!(report.bad, 0);
    let boundary = mesh.boundary().unwrap();
    let parts = boundary.subsegments().into_iter().filter(|&(_, s)| boundary.segments()[s as usize].marker == 5);
    let length = |[a, b]: [u32; 2]| mesh.view().points[a as usize].distance(mesh.view().points[b as usize]);
    assert!((parts.map(|(part, _)| length(part)).sum::<f64>() - 6f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_wall_that_stands_on_a_floor_without_being_a_part_of_it() {
    let mut plc = Plc::boxed(DVec3::ZERO, DVec3::splat(4.0), []);
    let base = add(&mut plc, &[[1.0, 1.0, 0.0], [3.0, 1.5, 0.0], [3.0, 1.5, 2.0], [1.0, 1.0, 2.0]]);
    plc.facets.push(facet(base..base + 4, 0));
    assert_eq!(meshed(&plc, 2.0, 64.0).1.bad, 0);
    // And one from corner to corner, all of its ends known to the floor.
    let mut plc = Plc::boxed(DVec3::ZERO, DVec3::splat(4.0), []);
    let base = add(&mut plc, &[[2.0, 2.0, 3.0]]);
    plc.facets.push(facet([0, 3, base], 0));
    meshed(&plc, 2.0, 64.0);
}

#[test]
fn a_star_of_twenty_facets_around_one_segment() {
    let mut plc = Plc::boxed(DVec3::splat(-2.0), DVec3::splat(2.0), []);
    let axis = add(&mut plc, &[[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]);
    for k in 0..20 {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 20.0 + 0.1).sin_cos();
        // Not all as long.
        let r = 1.0 + 0.05 * f64::from(k % 7);
        let base = add(&mut plc, &[[r * cos, r * sin, -1.0], [r * cos, r * sin, 1.0]]);
        plc.facets.push(facet([axis, axis + 1, base + 1, base], k));
    }
    let (_, report) = meshed(&plc, 2.0, 64.0);
    assert!(report.vertices < 5_000, "{report:?}");
}

#[test]
fn a_comb_of_thin_fins() {
    let count = 5;
    let mut outline = vec![[0.0, -1.0], [f64::from(count), -1.0], [f64::from(count), 0.0]];
    for i in (0..count).map(f64::from).rev() {
        outline.extend([[i + 0.55, 0.0], [i + 0.55, 1.0], [i + 0.45, 1.0], [i + 0.45, 0.0]]);
    }
    outline.push([0.0, 0.0]);
    let (_, report) = meshed(&prism(&outline, 1.0), 2.0, 5.0 + 5.0 * 0.1);
    assert_eq!(report.bad, 0);
}

#[test]
fn a_cone_of_needles() {
    let count = 24u32;
    let mut plc = Plc { points: vec![DVec3::new(0.0, 0.0, 5.0)], ..Plc::default() };
    for k in 0..count {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(count)).sin_cos();
        plc.points.push(DVec3::new(cos, sin, 0.0));
        plc.facets.push(facet([0, 1 + k, 1 + (k + 1) % count], 0));
    }
    plc.facets.push(facet(1..=count, 1));
    let base = polygon_area(&plc, &plc.facets[count as usize].polygons[0]);
    let (_, report) = meshed(&plc, 2.0, base * 5.0 / 3.0);
    assert!(report.vertices < 5_000, "{report:?}");
}

#[test]
fn a_kept_boundary_gets_no_vertices() {
    let mut plc = two_boxes();
    add(&mut plc, &[[0.5, 0.5, 0.4], [0.5, 0.51, 0.4]]);
    plc.regions.clear();
    let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    let before = mesh.boundary().unwrap().subfacets();
    let options = RefineOptions { keep_boundary: true, ..RefineOptions::default() };
    let report = mesh.refine(&options, &Control::new()).unwrap();
    mesh.validate(3).unwrap();
    assert_eq!(mesh.boundary().unwrap().subfacets(), before);
    assert_eq!((report.segment_splits, report.facet_splits), (0, 0));
    assert_eq!(report.unrefined[Unrefined::Boundary as usize], report.bad);
    assert!(report.bad > 0 && report.samples > 0, "{report:?}");
    // Without that wish all of them are mended.
    assert_eq!(mesh.refine(&RefineOptions::default(), &Control::new()).unwrap().bad, 0);
}

#[test]
fn sizes_of_all_kinds() {
    use crate::Sizing;
    let mut plc = two_boxes();
    plc.regions.iter_mut().for_each(|region| region.max_volume = None);
    let refined = |sizing: &Sizing| {
        let mut mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
        let report = mesh.refine_sized(&RefineOptions::default(), sizing, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
        assert_eq!((report.bad, report.too_large), (0, 0));
        mesh
    };
    let longest = |mesh: &Mesh, keep: &dyn Fn(DVec3) -> bool| {
        let view = mesh.view();
        let shapes = view.tetrahedra.iter().map(|t| t.map(|v| view.points[v as usize]));
        let shapes = shapes.filter(|shape| keep(shape.iter().copied().sum::<DVec3>() / 4.0));
        let edges = shapes.flat_map(|s| crate::geometry::quality::EDGES.map(|[i, j]| s[i].distance(s[j])));
        edges.fold(0.0, f64::max)
    };
    let uniform = refined(&Sizing { uniform: 0.4, ..Sizing::default() });
    assert!(longest(&uniform, &|_| true) <= 0.4);
    let by_region = refined(&Sizing { regions: &[0.0, 0.3], ..Sizing::default() });
    assert!(longest(&by_region, &|p| p.z > 1.0) <= 0.3 && longest(&by_region, &|p| p.z < 0.7) > 0.4);
    let callback = |points: &[DVec3], sizes: &mut [f64]| {
        for (p, size) in points.iter().zip(sizes) {
            *size = 0.2 + 0.4 * p.z;
        }
    };
    let graded = refined(&Sizing { callback: Some(&callback), ..Sizing::default() });
    assert!(longest(&graded, &|p| p.z < 0.5) <= 0.4 && longest(&graded, &|p| p.z > 1.5) > 0.4);
    let sizes: Vec<f64> = plc.points.iter().map(|p| 0.2 + 0.4 * p.z).collect();
    let by_vertex = refined(&Sizing { vertices: &sizes, ..Sizing::default() });
    assert!(longest(&by_vertex, &|p| p.z < 0.5) < longest(&by_vertex, &|p| p.z > 1.5));
    assert!(by_vertex.view().tetrahedra.len() > 100);
}

#[test]
fn coplanar_facets_are_joined_and_nothing_else_changes() {
    // A box whose sides are cut in triangles, one of them around a point in its middle.
    let mut plc = Plc::boxed(DVec3::ZERO, DVec3::ONE, []);
    let sides: Vec<Vec<u32>> = plc.facets.drain(..).map(|f| f.polygons[0].clone()).collect();
    let middle = add(&mut plc, &[[0.5, 0.5, 0.0]]);
    for (i, side) in sides.iter().enumerate() {
        match i {
            0 => plc.facets.extend((0..4).map(|k| facet([side[k], side[(k + 1) % 4], middle], 0))),
            _ => plc.facets.extend([facet([side[0], side[1], side[2]], 0), facet([side[0], side[2], side[3]], 0)]),
        }
    }
    let apart = plc.clone();
    let group = plc.join_coplanar(0.01);
    assert_eq!(plc.facets.len(), 6);
    assert_eq!(group, [0, 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5]);
    assert!(plc.check().errors().next().is_none());
    let (joined, _) = meshed(&plc, 2.0, 1.0);
    meshed(&apart, 2.0, 1.0);
    assert!(joined.triangulation().locate(DVec3::new(0.5, 0.5, 0.0), None) == crate::Location::Vertex(middle));
    // A segment on a diagonal keeps its two triangles apart; markers do too.
    let mut marked = apart.clone();
    let diagonal = [sides[1][0], sides[1][2]];
    marked.segments.push(PlcSegment { ends: diagonal, marker: 1 });
    marked.facets[8].marker = 1;
    marked.join_coplanar(0.01);
    assert_eq!(marked.facets.len(), 8);
    // A ring of triangles around a gap stays a ring.
    let mut ring = Plc::default();
    add(&mut ring, &[[0., 0., 0.], [3., 0., 0.], [0., 3., 0.], [0.5, 0.5, 0.], [1.5, 0.5, 0.], [0.5, 1.5, 0.]]);
    for [a, b, c] in [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5]] {
        ring.facets.push(facet([a, b, c], 0));
    }
    ring.join_coplanar(0.01);
    assert_eq!((ring.facets.len(), ring.facets[0].polygons.len(), ring.facets[0].holes.len()), (1, 2, 1));
}

#[test]
fn joining_hears_of_a_cancellation_at_any_time_and_changes_nothing_then() {
    // A sheet of squares of two triangles, bent where every fifth row begins.
    let n = 40;
    let mut plc = Plc::default();
    let height = |j: u32| f64::from(j % 10).min(10.0 - f64::from(j % 10)).min(5.0);
    plc.points.extend(
        (0..(n + 1) * (n + 1))
            .map(|i| (i % (n + 1), i / (n + 1)))
            .map(|(i, j)| DVec3::new(f64::from(i), f64::from(j), height(j))),
    );
    for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
        let v = j * (n + 1) + i;
        plc.facets.extend([facet([v, v + 1, v + n + 2], 0), facet([v, v + n + 2, v + n + 1], 0)]);
    }
    let control = Control::new();
    let mut joined = plc.clone();
    let looks = control.looks(None, || assert_eq!(joined.join_coplanar_within(0.01, &control).unwrap().len(), 3200));
    assert_eq!(joined.facets.len(), 8);
    assert!(looks >= 3 * plc.facets.len() / 256, "{looks}");
    for last in (1..=looks).step_by(looks / 150) {
        let mut cancelled = plc.clone();
        let mut ended = Ok(Vec::new());
        let made = control.looks(Some(last), || ended = cancelled.join_coplanar_within(0.01, &control));
        // A few looks more, before memory goes. What comes while the last of it does is too late.
        assert!(made <= last + 8, "{made} of {last}");
        assert!(if ended.is_ok() { cancelled == joined && last + 8 > looks } else { cancelled == plc });
    }
}

/// Nodes of a surface mesh on a slanted side lie off its plane by rounding. Taken for points beside it, they asked for splits down to the last bits of the
/// coordinates, and refinement ran away outside.
#[test]
fn nodes_on_a_slanted_facet_belong_to_it() {
    let mut plc = prism(&[[0.0, 0.0], [4.0, 0.0], [4.0, 1.5], [2.0, 1.5], [1.5, 3.5], [0.0, 3.5]], 3.0);
    let first = add(
        &mut plc,
        &[
            [1.8249999999998692, 2.2000000000005215, 2.2187499999980176],
            [1.6649999999998757, 2.8400000000004963, 2.212499999998193],
            [1.7483333333332365, 2.506666666667054, 1.4624999999972401],
            [1.8345999999998917, 2.1616000000004325, 0.7378749999979289],
            // On the slanted edge above.
            [1.749999999999674, 2.500000000001304, 3.0],
            [1.8300000000000003, 2.18, 0.0],
        ],
    );
    let (mesh, report) = meshed(&plc, 2.0, 28.5);
    assert_eq!(report.bad, 0);
    assert!(report.vertices < 100, "{} vertices", report.vertices);
    let boundary = mesh.boundary().unwrap();
    let slanted = boundary.facets().iter().find(|facet| facet.marker == 6).unwrap();
    assert!((first..first + 4).all(|v| slanted.corners.contains(&v)));
    assert!([4, 5].iter().all(|i| boundary.subsegments().iter().any(|(edge, _)| edge.contains(&(first + i)))));
    // A point that is truly beside the facet stays so.
    let beside = add(&mut plc, &[[1.7, 2.2, 1.0]]);
    let mesh = Mesh::from_plc(&plc, &Control::new()).unwrap();
    assert_eq!(mesh.boundary().unwrap().carrier(beside), crate::domain::Carrier::Free);
}

/// Turned about two axes, with six digits behind the point.
fn turned(p: DVec3) -> DVec3 {
    let (sin, cos) = 0.3_f64.sin_cos();
    let (x, y) = (p.x * cos - p.y * sin, p.x * sin + p.y * cos);
    let (sin, cos) = 0.7_f64.sin_cos();
    let rounded = |c: f64| (c * 1e6).round() / 1e6;
    DVec3::new(rounded(x), rounded(y * cos - p.z * sin), rounded(y * sin + p.z * cos))
}

/// Its mesh, which keeps the bound everywhere, and its volume.
fn refined_without_rest(plc: &Plc) -> (Mesh, f64) {
    assert!(plc.check().errors().next().is_none());
    let mut mesh = Mesh::from_plc(plc, &Control::new()).unwrap();
    mesh.validate(3).unwrap();
    let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
    mesh.validate(3).unwrap();
    assert_eq!(report.bad, 0, "{report:?}");
    let view = mesh.view();
    let six = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| view.points[v as usize]);
        (b - a).cross(c - a).dot(d - a)
    };
    let volume = view.tetrahedra.iter().map(six).sum::<f64>() / 6.0;
    (mesh, volume)
}

/// With coordinates of six digits the triangles of a flat side differ by more than rounding of numbers does. They are one facet all the same: with each diagonal
/// a segment of its own, needles between them would ask for far more tetrahedra.
#[test]
fn triangles_with_rounded_coordinates_are_joined() {
    const N: u32 = 4;
    let mut plc = Plc::default();
    let mut ids = std::collections::BTreeMap::new();
    for (axis, side, i, j) in (0..3)
        .flat_map(|axis| [0, N].into_iter().flat_map(move |side| (0..N * N).map(move |k| (axis, side, k % N, k / N))))
    {
        let corner = |&[u, v]: &[u32; 2]| {
            let mut place = [side; 3];
            (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (i + u, j + v);
            let next = ids.len() as u32;
            let [x, y, z] = place.map(|c| f64::from(c) / f64::from(N));
            let id = *ids.entry(place).or_insert(next);
            if id == next {
                plc.points.push(turned(DVec3::new(x, y, z)));
            }
            id
        };
        let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].iter().map(corner).collect::<Vec<_>>()[..] else {
            unreachable!()
        };
        plc.facets.extend([facet([a, b, c], 0), facet([a, c, d], 0)]);
    }
    assert_eq!((plc.points.len(), plc.facets.len()), (98, 192));
    plc.join_coplanar(0.01);
    assert_eq!(plc.facets.len(), 6);
    let (mesh, volume) = refined_without_rest(&plc);
    assert!((volume - 1.0).abs() < 1e-5, "{volume}");
    assert_eq!(mesh.boundary().unwrap().facets().len(), 6);
}

/// The sides of a cylinder, long strips: where one is cut, all others leave the triangulation, and are cut too.
#[test]
fn strips_around_a_cylinder_are_cut_together() {
    let corner = |k: u32, z: f64| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 80.0).sin_cos();
        turned(DVec3::new(cos, sin, z))
    };
    let mut plc = Plc::default();
    plc.points.extend((0..80).map(|k| corner(k, 0.0)));
    plc.points.extend((0..80).map(|k| corner(k, 2.0)));
    plc.facets.extend([facet(0..80, 0), facet(80..160, 0)]);
    plc.facets.extend((0..80).map(|k| facet([k, (k + 1) % 80, 80 + (k + 1) % 80, 80 + k], 0)));
    let (_, volume) = refined_without_rest(&plc);
    let expected = 80.0 * (std::f64::consts::TAU / 80.0).sin();
    assert!((volume / expected - 1.0).abs() < 1e-5, "{volume}, not {expected}");
}

#[test]
fn what_is_encroached_is_split_only_for_samples() {
    let plate = thin_plate();
    let steiner = |sparsify: Sparsify| {
        let mut mesh = Mesh::from_plc(&plate, &Control::new()).unwrap();
        let options = RefineOptions { sparsify: Some(sparsify), ..RefineOptions::default() };
        let report = mesh.refine(&options, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
        mesh.validate_quality(2.0).unwrap();
        // Another rule finds what has been left, and goes on with it.
        let classical = RefineOptions { rule: Rule::Circumcenter, ..RefineOptions::default() };
        let then = mesh.refine(&classical, &Control::new()).unwrap();
        mesh.validate(3).unwrap();
        (report.steiner, then.segment_splits)
    };
    let (all, nothing) = steiner(Sparsify::Off);
    let (some, rest) = steiner(Sparsify::Moves);
    assert!(2 * some < all, "{some} of {all}");
    assert!(nothing == 0 && rest > 0, "{nothing}, {rest}");
}

/// The bottom is a U and what fills its notch, whose sides join corners of the U: from outside the U they were taken for its own, and it covered the
/// notch, too. Two large facets of fandisk_large.off overlapped so, and its recovery did not end.
#[test]
fn a_notch_that_other_facets_fill_stays_out() {
    let u = [[0., 0.], [3., 0.], [3., 3.], [2., 3.], [2., 1.], [1., 1.], [1., 3.], [0., 3.]];
    let outline: Vec<[f64; 2]> = u[..4].iter().chain(&u[6..]).copied().collect();
    let mut plc = Plc::default();
    add(&mut plc, &u.map(|[x, y]| [x, y, 0.0]));
    let top = add(&mut plc, &[0.0; 6].map(|_| [0.0; 3]));
    for (i, &[x, y]) in outline.iter().enumerate() {
        plc.points[top as usize + i] = DVec3::new(x, y, 2.0);
    }
    // Around the top: corners 0, 1, 2, 3, 6, 7 of the bottom.
    let below = [0, 1, 2, 3, 6, 7];
    plc.facets.push(facet(0..8, 1));
    plc.facets.push(facet([3, 6, 5], 2));
    plc.facets.push(facet([3, 5, 4], 3));
    plc.facets.push(facet(top..top + 6, 4));
    for i in 0..6 {
        let j = (i + 1) % 6;
        plc.facets.push(facet([below[i], below[j], top + j as u32, top + i as u32], 5));
    }
    meshed(&plc, 2.0, 18.0);
}
