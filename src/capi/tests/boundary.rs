//! The boundary as arrays, and boundaries that are kept as they were given.

use super::domain::{box_with, OwnedPlc};
use super::*;

fn boundary_of(t: &Owned) -> wsp_boundary_view {
    // SAFETY: a struct of numbers and pointers, a live handle.
    unsafe {
        let mut view: wsp_boundary_view = std::mem::zeroed();
        done(wsp_boundary_view_init(&mut view, size_of::<wsp_boundary_view>()));
        done(wsp_triangulation_boundary(t.0, null_mut(), &mut view));
        view
    }
}

fn options(keep: u32) -> wsp_triangulation_options {
    // SAFETY: a struct of numbers.
    let mut options: wsp_triangulation_options = unsafe { std::mem::zeroed() };
    // SAFETY: as many bytes.
    done(unsafe { wsp_triangulation_options_init(&mut options, size_of::<wsp_triangulation_options>()) });
    options.keep_boundary = keep;
    options
}

/// A box from −1 to 2 with a square of marker 77 within, from 0 to 1 at height 0.5, and these points.
fn with_sheet(points: &[[f64; 3]]) -> OwnedPlc {
    let plc = box_with(points);
    let corners = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 1.0, 0.5], [0.0, 1.0, 0.5]];
    let mut first = 0;
    // SAFETY: a live handle, arrays of the sizes given.
    unsafe {
        done(wsp_plc_add_points(plc.0, corners.as_ptr().cast(), 4, null(), &mut first));
        let ring = [first, first + 1, first + 2, first + 3];
        done(wsp_plc_add_facets(plc.0, ring.as_ptr(), [0usize, 4].as_ptr(), 1, null(), 1, [77].as_ptr(), null_mut()));
    }
    plc
}

/// The edge between them goes through the sheet, whose facet is missing then.
const ON_BOTH_SIDES: [[f64; 3]; 2] = [[0.5, 0.5, 0.45], [0.5, 0.5, 0.55]];

#[test]
fn markers_come_back() {
    let plc = with_sheet(&ON_BOTH_SIDES);
    let mut t = null_mut();
    // SAFETY: live handles, a writable result.
    done(unsafe { wsp_triangulation_from_plc(plc.0, null(), null_mut(), &mut t) });
    let t = Owned(t);
    let mut report: wsp_report;
    // SAFETY: a struct of numbers, live handles.
    unsafe {
        report = std::mem::zeroed();
        done(wsp_report_init(&mut report, size_of::<wsp_report>()));
        done(wsp_refine(t.0, null(), null_mut(), &mut report));
    }
    let (mesh, view) = (t.view(), boundary_of(&t));
    // SAFETY: the views' arrays, used up before the handle changes.
    unsafe {
        assert_eq!(view.vertices_count, mesh.points_count);
        let facets = array(view.face_facets, view.faces_count);
        let markers = array(view.face_markers, view.faces_count);
        let sides = array(view.face_tetrahedra, 2 * view.faces_count);
        for (i, (&facet, &marker)) in facets.iter().zip(markers).enumerate() {
            assert_eq!(marker, if facet == 6 { 77 } else { 1 + facet as i32 });
            let both = sides[2 * i..2 * i + 2].iter().filter(|&&side| side != WSP_NONE).count();
            assert_eq!(both, if facet == 6 { 2 } else { 1 });
        }
        assert!((0..7).all(|facet| facets.contains(&facet)));
        let faces = array(view.faces, 3 * view.faces_count);
        assert!(faces.iter().all(|&v| (v as usize) < mesh.points_count));
        let edges = array(view.edges, 2 * view.edges_count);
        let numbers = array(view.edge_segments, view.edges_count);
        let segments: std::collections::BTreeSet<u32> = numbers.iter().copied().collect();
        assert_eq!((segments.len(), edges.len()), (16, 2 * numbers.len()));
        assert_eq!(array(view.edge_markers, view.edges_count).iter().filter(|&&marker| marker == 77).count(), {
            let at_sheet = |edge: &&[u32]| {
                edge.iter().all(|&v| array(mesh.points, 3 * mesh.points_count)[3 * v as usize + 2] == 0.5)
            };
            edges.chunks(2).filter(at_sheet).count()
        });
        let kinds = array(view.vertex_kinds, view.vertices_count);
        let elements = array(view.vertex_elements, view.vertices_count);
        let count = |kind: u8| kinds.iter().filter(|&&other| other == kind).count();
        assert_eq!(count(WSP_ON_VERTEX), 12);
        assert_eq!([report.on_segments, report.on_facets], [count(WSP_ON_SEGMENT), count(WSP_ON_FACET)]);
        assert!(report.on_segments + report.on_facets > 0);
        for (&kind, &element) in kinds.iter().zip(elements) {
            match kind {
                WSP_ON_SEGMENT => assert!(segments.contains(&element)),
                WSP_ON_FACET => assert!(element < 7),
                _ => assert_eq!(element, WSP_NONE),
            }
        }
    }
}

#[test]
fn without_a_domain_the_arrays_are_empty() {
    let t = Owned::of(&scattered(20, 4));
    let view = boundary_of(&t);
    assert!(view.faces.is_null() && view.edges.is_null() && view.vertex_kinds.is_null());
    assert_eq!([view.faces_count, view.edges_count, view.vertices_count], [0; 3]);
    // SAFETY: structs of numbers, live handles; NULL and the size are what is tested.
    unsafe {
        done(wsp_triangulation_use_hull_as_domain(t.0));
        let mut view: wsp_boundary_view = std::mem::zeroed();
        expect(WSP_ERR_STRUCT_SIZE, wsp_triangulation_boundary(t.0, null_mut(), &mut view));
        expect(WSP_ERR_STRUCT_SIZE, wsp_boundary_view_init(&mut view, size_of::<wsp_boundary_view>() - 8));
        expect(WSP_ERR_NULL, wsp_boundary_view_init(null_mut(), size_of::<wsp_boundary_view>()));
        done(wsp_boundary_view_init(&mut view, size_of::<wsp_boundary_view>()));
        expect(WSP_ERR_NULL, wsp_triangulation_boundary(null(), null_mut(), &mut view));
        expect(WSP_ERR_NULL, wsp_triangulation_boundary(t.0, null_mut(), null_mut()));
        let control = OwnedControl::new(|_| 1);
        wsp_control_cancel(control.control);
        expect(WSP_CANCELLED, wsp_triangulation_boundary(t.0, control.control, &mut view));
        assert_eq!(view.faces_count, 0);
    }
    assert!(boundary_of(&t).faces_count > 0);
}

#[test]
fn a_boundary_is_kept_or_the_domain_refused() {
    let refused = with_sheet(&ON_BOTH_SIDES);
    let kept = with_sheet(&[[0.5, 0.5, -0.5], [0.5, 0.52, -0.5]]);
    let mut t = null_mut();
    // SAFETY: structs of numbers, live handles.
    unsafe {
        let keeping = options(1);
        expect(WSP_ERR_INVALID_DOMAIN, wsp_triangulation_from_plc(refused.0, &keeping, null_mut(), &mut t));
        assert!(t.is_null() && last_error().contains("facet 6: would have to be split"), "{}", last_error());
        expect(WSP_ERR_OPTION, wsp_triangulation_from_plc(kept.0, &options(2), null_mut(), &mut t));
        done(wsp_triangulation_from_plc(kept.0, &keeping, null_mut(), &mut t));
        let t = Owned(t);
        let before = (boundary_of(&t).faces_count, boundary_of(&t).edges_count);
        let mut refine: wsp_refine_options = std::mem::zeroed();
        done(wsp_refine_options_init(&mut refine, size_of::<wsp_refine_options>()));
        refine.keep_boundary = 1;
        let mut report: wsp_report = std::mem::zeroed();
        done(wsp_report_init(&mut report, size_of::<wsp_report>()));
        expect(WSP_UNREFINED, wsp_refine(t.0, &refine, null_mut(), &mut report));
        assert!(report.samples > 0 && report.unrefined_boundary == report.bad, "{report:?}");
        assert_eq!([report.on_segments, report.on_facets], [0, 0]);
        assert_eq!((boundary_of(&t).faces_count, boundary_of(&t).edges_count), before);
        // What had to be split to have the sheet in the mesh at all is counted, though nothing more is put there.
        let mut t = null_mut();
        done(wsp_triangulation_from_plc(refused.0, null(), null_mut(), &mut t));
        let t = Owned(t);
        let status = wsp_refine(t.0, &refine, null_mut(), &mut report);
        assert!(status == WSP_DONE || status == WSP_UNREFINED);
        assert_eq!(report.segment_splits + report.facet_splits, 0);
        assert!(report.on_segments + report.on_facets > 0, "{report:?}");
    }
}
