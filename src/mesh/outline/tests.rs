use super::*;
use crate::domain::plc::{Plc, PlcFacet, PlcRegion, PlcSegment};
use crate::geometry::predicates::orient3d;
use crate::geometry::Sign;
use crate::{DVec3, RefineOptions};

/// Two boxes, one on the other, with a wall of marker −7 between them, a dangling segment of marker 50 in the lower one, and two points near each other in
/// the upper one.
fn two_storeys() -> Plc {
    let mut plc = Plc::default();
    for z in [0.0, 1.0, 2.0] {
        plc.points.extend([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, z)));
    }
    let facet =
        |polygon: [u32; 4], marker| PlcFacet { polygons: vec![polygon.to_vec()], marker, ..PlcFacet::default() };
    plc.facets = vec![facet([0, 1, 2, 3], 1), facet([4, 5, 6, 7], -7), facet([8, 9, 10, 11], 3)];
    for low in [0, 4] {
        for i in 0..4 {
            let j = (i + 1) % 4;
            plc.facets.push(facet([low + i, low + j, low + j + 4, low + i + 4], 10 + i as i32));
        }
    }
    plc.points.extend([[0.5, 0.5, 0.4], [0.5, 0.5, 0.6], [0.5, 0.5, 1.5], [0.5, 0.52, 1.5]].map(DVec3::from));
    plc.segments.push(PlcSegment { ends: [12, 13], marker: 50 });
    plc.segments.push(PlcSegment { ends: [0, 1], marker: 60 });
    let region = |z: f64| PlcRegion { point: DVec3::new(0.1, 0.2, z), ..PlcRegion::default() };
    plc.regions = vec![region(0.5), region(1.5)];
    plc
}

#[test]
fn faces_and_edges_have_their_markers_and_sides() {
    let mut mesh = Mesh::from_plc(&two_storeys(), &Control::new()).unwrap();
    for refined in [false, true] {
        if refined {
            let report = mesh.refine(&RefineOptions::default(), &Control::new()).unwrap();
            assert_eq!(report.bad, 0);
            assert!(report.on_segments + report.on_facets > 0, "{report:?}");
        }
        let (view, shown) = (mesh.view(), mesh.boundary_view());
        let at = |v: u32| view.points[v as usize];
        let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a).length();
        let mut areas = [0.0; 11];
        for (i, &face) in shown.faces.iter().enumerate() {
            let facet = shown.face_facets[i] as usize;
            areas[facet] += area(face.map(at));
            assert_eq!(shown.face_markers[i], two_storeys().facets[facet].marker);
            let [behind, before] = shown.face_tetrahedra[i];
            // The wall alone has tetrahedra on both sides, the first with the lower number.
            assert_eq!(before == u32::MAX, facet != 1);
            assert!(behind < before);
            let apex = |tet: u32| {
                let v = view.tetrahedra[tet as usize];
                assert!(face.iter().all(|corner| v.contains(corner)));
                at(*v.iter().find(|v| !face.contains(v)).unwrap())
            };
            let [a, b, c] = face.map(at);
            // Counterclockwise from outside: an apex inside sees it clockwise.
            assert_eq!(orient3d(a, b, c, apex(behind)), Sign::Negative);
            if before != u32::MAX {
                assert_eq!(orient3d(a, b, c, apex(before)), Sign::Positive);
                assert_ne!(view.regions[behind as usize], view.regions[before as usize]);
            }
        }
        assert!(areas.iter().all(|area| (area - 1.0).abs() < 1e-12), "{areas:?}");
        assert!(shown.face_facets.is_sorted() && shown.edge_segments.is_sorted());
        let mut lengths = std::collections::BTreeMap::<i32, f64>::new();
        for (&[a, b], &marker) in shown.edges.iter().zip(shown.edge_markers) {
            *lengths.entry(marker).or_default() += at(a).distance(at(b));
        }
        // Of the twenty sides one is a segment of its own, and others are their first facet's.
        assert!((lengths[&50] - 0.2).abs() < 1e-12 && (lengths[&60] - 1.0).abs() < 1e-12, "{lengths:?}");
        assert!((lengths.values().sum::<f64>() - 20.2).abs() < 1e-12);
        let mut counts = [0; 4];
        for (v, (&kind, &element)) in shown.vertex_kinds.iter().zip(shown.vertex_elements).enumerate() {
            counts[kind as usize] += 1;
            let on_facet = || {
                shown.faces.iter().zip(shown.face_facets).any(|(face, &f)| f == element && face.contains(&(v as u32)))
            };
            let on_segment = || {
                shown.edges.iter().zip(shown.edge_segments).any(|(edge, &s)| s == element && edge.contains(&(v as u32)))
            };
            match kind {
                On::Nothing | On::Vertex => assert_eq!(element, u32::MAX),
                On::Segment => assert!(on_segment()),
                On::Facet => assert!(on_facet()),
            }
        }
        assert_eq!((counts[1], shown.vertex_kinds.len()), (14, view.points.len()));
        let report = mesh.report(2.0, crate::RefineStatus::Done);
        assert_eq!([report.on_segments, report.on_facets], [counts[2], counts[3]]);
    }
}

#[test]
fn without_a_domain_there_is_no_boundary_and_a_hull_has_one() {
    let mut mesh = Mesh::new();
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(DVec3::from);
    mesh.insert(&corners, None, &Control::new()).unwrap();
    let shown = mesh.boundary_view();
    assert!(shown.faces.is_empty() && shown.edges.is_empty() && shown.vertex_kinds.is_empty());
    mesh.use_hull_as_domain().unwrap();
    let shown = mesh.boundary_view();
    assert_eq!((shown.faces.len(), shown.edges.len(), shown.face_markers), (4, 6, &[0; 4][..]));
    assert!(shown.face_tetrahedra.iter().all(|&sides| sides == [0, u32::MAX]));
    assert_eq!(shown.vertex_kinds, [On::Vertex; 4]);
}

#[test]
fn a_cancelled_view_can_be_had_again() {
    let mesh = Mesh::from_plc(&two_storeys(), &Control::new()).unwrap();
    let cancelled = Control::new();
    cancelled.cancel();
    assert_eq!(mesh.try_boundary_view(&cancelled).map(|shown| shown.faces.len()), Err(Error::Cancelled));
    assert_eq!(mesh.boundary_view().faces.len(), mesh.boundary().unwrap().subfacets().len());
}
