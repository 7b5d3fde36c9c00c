//! Complexes: what is put in arrives, what can't be is refused.

use super::*;
use crate::{Plc, PlcSegment};

pub(super) struct OwnedPlc(pub *mut wsp_plc);

impl OwnedPlc {
    pub fn new() -> OwnedPlc {
        let mut plc = null_mut();
        // SAFETY: `plc` may be written.
        done(unsafe { wsp_plc_new(&mut plc) });
        OwnedPlc(plc)
    }

    /// The core's complex behind the handle.
    fn core(&self) -> Plc {
        // SAFETY: a live handle that no call is using.
        unsafe { &*self.0 }.handle.read().expect("readable").clone()
    }
}

impl Drop for OwnedPlc {
    fn drop(&mut self) {
        // SAFETY: made by the library, freed once.
        unsafe { wsp_plc_free(self.0) };
    }
}

const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn with_corners() -> OwnedPlc {
    let plc = OwnedPlc::new();
    // SAFETY: a live handle, an array of the size given.
    done(unsafe { wsp_plc_add_points(plc.0, CORNERS.as_ptr().cast(), 4, null(), null_mut()) });
    plc
}

#[test]
fn points_and_their_markers() {
    let plc = with_corners();
    let mut first = 99;
    // SAFETY: a live handle, arrays of the sizes given.
    unsafe {
        done(wsp_plc_add_points(plc.0, CORNERS.as_ptr().cast(), 2, [5, -6].as_ptr(), &mut first));
        assert_eq!(first, 4);
        done(wsp_plc_add_points(plc.0, CORNERS.as_ptr().cast(), 1, null(), &mut first));
        assert_eq!(first, 6);
        let bad = [[0.0; 3], [f64::NAN; 3]];
        expect(WSP_ERR_NOT_FINITE, wsp_plc_add_points(plc.0, bad.as_ptr().cast(), 2, null(), &mut first));
        done(wsp_plc_add_points(plc.0, null(), 0, null(), null_mut()));
    }
    let core = plc.core();
    assert_eq!(core.points.len(), 7);
    assert_eq!(core.point_markers, [0, 0, 0, 0, 5, -6, 0]);
}

#[test]
fn a_box_is_the_cores_box() {
    let plc = with_corners();
    let (low, high) = ([-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]);
    let mut first = 99;
    // SAFETY: a live handle, three doubles each.
    unsafe {
        done(wsp_plc_add_box(plc.0, low.as_ptr(), high.as_ptr(), 10, &mut first));
        for (low, high) in [(high, low), (low, low), (low, [1.0, 2.0, -3.0])] {
            expect(WSP_ERR_ARGUMENT, wsp_plc_add_box(plc.0, low.as_ptr(), high.as_ptr(), 10, null_mut()));
        }
        expect(WSP_ERR_ARGUMENT, wsp_plc_add_box(plc.0, low.as_ptr(), high.as_ptr(), i32::MAX - 4, null_mut()));
    }
    let core = plc.core();
    assert_eq!((first, core.points.len(), core.facets.len()), (4, 12, 6));
    for (i, facet) in core.facets.iter().enumerate() {
        assert_eq!(facet.marker, 10 + i as i32);
        let ring: Vec<_> = facet.polygons[0].iter().map(|&v| core.points[v as usize]).collect();
        let (axis, side) = (i / 2, [&low, &high][i % 2]);
        assert!(ring.iter().all(|p| p[axis] == side[axis]), "facet {i}: {ring:?}");
        let sides = (0..4).map(|k| (ring[(k + 1) % 4] - ring[k]).to_array());
        assert!(sides.into_iter().all(|s| s.iter().filter(|&&x| x != 0.0).count() == 1), "a ring: {ring:?}");
    }
}

#[test]
fn segments() {
    let plc = with_corners();
    // SAFETY: a live handle, arrays of the sizes given.
    unsafe {
        done(wsp_plc_add_segments(plc.0, [0u32, 1, 2, 3].as_ptr(), 2, [8, 9].as_ptr()));
        expect(WSP_ERR_NO_SUCH_VERTEX, wsp_plc_add_segments(plc.0, [0u32, 1, 2, 4].as_ptr(), 2, null()));
        assert!(last_error().contains("point 4"), "{}", last_error());
        expect(WSP_ERR_ARGUMENT, wsp_plc_add_segments(plc.0, [0u32, 1, 2, 2].as_ptr(), 2, null()));
        assert!(last_error().contains("segment 1"), "{}", last_error());
        done(wsp_plc_add_segments(plc.0, [1u32, 3].as_ptr(), 1, null()));
    }
    let expected = [([0, 1], 8), ([2, 3], 9), ([1, 3], 0)].map(|(ends, marker)| PlcSegment { ends, marker });
    assert_eq!(plc.core().segments, expected);
}

#[test]
fn facets_as_lists_of_lists() {
    let plc = with_corners();
    let vertices = [0u32, 1, 2, 0, 1, 3, 0, 2, 3, 1];
    let mut first = 99;
    let add = |polygon_starts: &[usize], facet_starts: Option<&[usize]>, facets: usize, markers: Option<&[i32]>| {
        let markers = markers.map_or(null(), <[i32]>::as_ptr);
        let facet_starts = facet_starts.map_or(null(), <[usize]>::as_ptr);
        let polygons = polygon_starts.len() - 1;
        let starts = polygon_starts.as_ptr();
        // SAFETY: a live handle, arrays of the sizes given.
        unsafe {
            wsp_plc_add_facets(plc.0, vertices.as_ptr(), starts, polygons, facet_starts, facets, markers, null_mut())
        }
    };
    done(add(&[0, 3, 6], None, 2, Some(&[7, 8])));
    done(add(&[0, 3, 6, 9, 10], Some(&[0, 1, 4]), 2, None));
    done(add(&[0], None, 0, None));
    expect(WSP_ERR_ARGUMENT, add(&[0, 3, 6], None, 3, None));
    expect(WSP_ERR_ARGUMENT, add(&[1, 3, 6], None, 2, None));
    expect(WSP_ERR_ARGUMENT, add(&[0, 3, 2], None, 2, None));
    expect(WSP_ERR_ARGUMENT, add(&[0, 3, 3], None, 2, None));
    assert!(last_error().contains("polygon_starts[2]"), "{}", last_error());
    expect(WSP_ERR_ARGUMENT, add(&[0, 3, 6], Some(&[0, 1]), 1, None));
    expect(WSP_ERR_ARGUMENT, add(&[0, 3, 6], Some(&[0, 3]), 1, None));
    // SAFETY: a live handle, arrays of the sizes given.
    unsafe {
        let foreign = [0u32, 1, 4];
        let starts = [0usize, 3];
        let status = wsp_plc_add_facets(plc.0, foreign.as_ptr(), starts.as_ptr(), 1, null(), 1, null(), &mut first);
        expect(WSP_ERR_NO_SUCH_VERTEX, status);
        assert_eq!(first, 99);
        done(wsp_plc_add_facets(plc.0, vertices.as_ptr(), starts.as_ptr(), 1, null(), 1, null(), &mut first));
        assert_eq!(first, 4);
        done(wsp_plc_add_facet_hole(plc.0, 3, CORNERS[1].as_ptr()));
        expect(WSP_ERR_ARGUMENT, wsp_plc_add_facet_hole(plc.0, 5, CORNERS[1].as_ptr()));
        let (mut points, mut segments, mut facets) = (0, 9, 0);
        done(wsp_plc_counts(plc.0, &mut points, &mut segments, &mut facets));
        assert_eq!((points, segments, facets), (4, 0, 5));
        done(wsp_plc_counts(plc.0, null_mut(), null_mut(), null_mut()));
    }
    let facets = plc.core().facets;
    assert_eq!(facets.iter().map(|f| f.marker).collect::<Vec<_>>(), [7, 8, 0, 0, 0]);
    assert_eq!(facets[1].polygons, [[0, 1, 3]]);
    assert_eq!(facets[3].polygons, [vec![0, 1, 3], vec![0, 2, 3], vec![1]]);
    assert_eq!(facets[3].holes, [crate::DVec3::X]);
}

#[test]
fn holes_and_regions() {
    let plc = OwnedPlc::new();
    // SAFETY: a live handle, three doubles each.
    unsafe {
        done(wsp_plc_add_hole(plc.0, CORNERS[2].as_ptr()));
        done(wsp_plc_add_region(plc.0, CORNERS[1].as_ptr(), -3.5, 0.25));
        done(wsp_plc_add_region(plc.0, CORNERS[1].as_ptr(), 1.0, 0.0));
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            expect(WSP_ERR_ARGUMENT, wsp_plc_add_region(plc.0, CORNERS[1].as_ptr(), 1.0, bad));
        }
        expect(WSP_ERR_ARGUMENT, wsp_plc_add_region(plc.0, CORNERS[1].as_ptr(), f64::NAN, 0.0));
        expect(WSP_ERR_NOT_FINITE, wsp_plc_add_hole(plc.0, [f64::NAN; 3].as_ptr()));
    }
    let core = plc.core();
    assert_eq!(core.holes, [crate::DVec3::Y]);
    assert_eq!(core.regions.iter().map(|r| r.max_volume).collect::<Vec<_>>(), [Some(0.25), None]);
    assert_eq!(core.regions[0].attribute, -3.5);
}

pub(super) fn box_with(points: &[[f64; 3]]) -> OwnedPlc {
    let plc = OwnedPlc::new();
    // SAFETY: a live handle, arrays of the sizes given.
    unsafe {
        done(wsp_plc_add_box(plc.0, [-1.0; 3].as_ptr(), [2.0; 3].as_ptr(), 1, null_mut()));
        done(wsp_plc_add_points(plc.0, points.as_ptr().cast(), points.len(), null(), null_mut()));
    }
    plc
}

#[test]
fn a_box_is_refined_to_the_bound() {
    for (rule, bound) in [(WSP_RULE_PAPER, 2.0), (WSP_RULE_CIRCUMCENTER, 2.0), (WSP_RULE_PAPER, 4.0)] {
        let plc = box_with(&scattered(60, 9));
        // SAFETY: structs of numbers, live handles.
        unsafe {
            let mut t = null_mut();
            done(wsp_triangulation_from_plc(plc.0, null(), null_mut(), &mut t));
            let t = Owned(t);
            drop(plc);
            let before = t.counts().0;
            assert!(before >= 68);
            done(wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0));
            let mut has_domain = 9;
            done(wsp_triangulation_has_domain(t.0, &mut has_domain));
            assert_eq!(has_domain, 1);
            expect(WSP_ERR_DOMAIN, wsp_triangulation_use_hull_as_domain(t.0));

            let mut options: wsp_refine_options = std::mem::zeroed();
            done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
            options.radius_edge = bound;
            options.rule = rule;
            let mut report: wsp_report = std::mem::zeroed();
            done(wsp_report_init(&mut report, size_of::<wsp_report>()));
            done(wsp_refine(t.0, &options, null_mut(), &mut report));
            assert_eq!((report.status, report.bad, report.input_vertices), (WSP_DONE, 0, 68));
            assert_eq!((report.vertices, report.tetrahedra), (t.view().points_count, t.view().tetrahedra_count));
            assert_eq!(report.steiner, report.vertices - 68);
            let added = report.samples + report.segment_splits + report.facet_splits;
            assert_eq!(added, report.vertices - before);
            assert!(report.steiner > 0 && report.worst_radius_edge <= bound * (1.0 + 1e-12));
            assert!(report.min_dihedral_degrees > 0.0 && report.min_dihedral_degrees < 70.6);
            done(wsp_triangulation_validate(t.0, WSP_VALIDATE_QUALITY, bound));
            expect(WSP_ERR_NOT_VALID, wsp_triangulation_validate(t.0, WSP_VALIDATE_QUALITY, 1.0));
            assert!(last_error().contains("over the radius-edge bound"), "{}", last_error());
        }
    }
}

#[test]
fn limits_end_a_refinement_with_their_status() {
    let plc = box_with(&scattered(60, 9));
    // SAFETY: structs of numbers, live handles.
    unsafe {
        let mut t = null_mut();
        done(wsp_triangulation_from_plc(plc.0, null(), null_mut(), &mut t));
        let t = Owned(t);
        let mut options: wsp_refine_options = std::mem::zeroed();
        done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
        let mut report: wsp_report = std::mem::zeroed();
        done(wsp_report_init(&mut report, size_of::<wsp_report>()));
        let refine = |options: &wsp_refine_options, control: *mut wsp_control, report: *mut wsp_report| {
            wsp_refine(t.0, options, control, report)
        };
        let control = OwnedControl::new(|_| 1);
        expect(WSP_CANCELLED, refine(&options, control.control, &mut report));
        assert_eq!(report.status, WSP_CANCELLED);
        options.max_vertices = t.counts().0 + 10;
        expect(WSP_VERTEX_LIMIT, refine(&options, null_mut(), &mut report));
        assert!(t.counts().0 <= options.max_vertices && report.bad > 0);
        done(wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0));
        options.max_vertices = usize::MAX;
        options.min_edge = 0.5;
        expect(WSP_UNREFINED, refine(&options, null_mut(), &mut report));
        assert!(report.bad > 0);
        options.min_edge = 0.0;
        done(refine(&options, null_mut(), null_mut()));
        done(wsp_triangulation_validate(t.0, WSP_VALIDATE_QUALITY, 2.0));
    }
}

#[test]
fn an_unusable_complex_gives_out_nothing() {
    // A facet and no volume.
    let plc = OwnedPlc::new();
    let (vertices, starts) = ([0u32, 1, 2], [0usize, 3]);
    let mut t = null_mut();
    // SAFETY: a live handle, arrays of the size given.
    unsafe {
        done(wsp_plc_add_points(plc.0, CORNERS.as_ptr().cast(), 3, null(), null_mut()));
        done(wsp_plc_add_facets(plc.0, vertices.as_ptr(), starts.as_ptr(), 1, null(), 1, null(), null_mut()));
        expect(WSP_ERR_INVALID_DOMAIN, wsp_triangulation_from_plc(plc.0, null(), null_mut(), &mut t));
    }
    assert!(t.is_null());
}

#[test]
fn a_cancelled_complex_gives_out_nothing() {
    let plc = box_with(&scattered(20_000, 9));
    let control = OwnedControl::new(|_| 1);
    let mut t = null_mut();
    // SAFETY: live handles.
    expect(WSP_CANCELLED, unsafe { wsp_triangulation_from_plc(plc.0, null(), control.control, &mut t) });
    assert!(t.is_null());
}

#[test]
fn the_hull_can_be_the_domain() {
    let t = Owned::of(&scattered(60, 9));
    let mut has_domain = 9;
    // SAFETY: a live handle, a writable result.
    unsafe {
        done(wsp_triangulation_has_domain(t.0, &mut has_domain));
        assert_eq!(has_domain, 0);
        done(wsp_triangulation_use_hull_as_domain(t.0));
        done(wsp_triangulation_has_domain(t.0, &mut has_domain));
        assert_eq!(has_domain, 1);
        expect(WSP_ERR_DOMAIN, wsp_triangulation_use_hull_as_domain(t.0));
    }
}
