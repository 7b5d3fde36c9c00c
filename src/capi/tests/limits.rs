//! Limits, each with its status and a usable mesh; the log; calls that a control follows.

use super::*;

fn options() -> wsp_refine_options {
    // SAFETY: a struct of numbers.
    unsafe {
        let mut options: wsp_refine_options = std::mem::zeroed();
        done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
        options
    }
}

fn report() -> wsp_report {
    // SAFETY: a struct of numbers.
    unsafe {
        let mut report: wsp_report = std::mem::zeroed();
        done(wsp_report_init(&mut report, size_of::<wsp_report>()));
        report
    }
}

fn refine(t: &Owned, options: &wsp_refine_options) -> (wsp_status, wsp_report) {
    let mut report = report();
    // SAFETY: live handles and structs.
    let status = unsafe { wsp_refine(t.0, options, null_mut(), &mut report) };
    assert_eq!(report.status, status);
    (status, report)
}

fn valid(t: &Owned) {
    // SAFETY: a live handle.
    done(unsafe { wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0) });
}

/// Sets a limit.
type Limit = fn(&mut wsp_refine_options);

#[test]
fn each_limit_ends_with_its_status_and_a_mesh_to_go_on_with() {
    let limits: [(wsp_status, Limit); 4] = [
        (WSP_VERTEX_LIMIT, |options| options.max_vertices = 520),
        (WSP_UNREFINED, |options| options.min_edge = 0.3),
        (WSP_TIME_LIMIT, |options| options.max_seconds = 1e-9),
        (WSP_MEMORY_LIMIT, |options| options.max_memory = 1),
    ];
    for (expected, limit) in limits {
        let t = Owned::of(&scattered(500, 3));
        let mut limited = options();
        limit(&mut limited);
        let (status, told) = refine(&t, &limited);
        expect(expected, status);
        assert!(told.bad > 0 && told.tetrahedra > 0, "{told:?}");
        valid(&t);
        // Nothing keeps the next call from finishing it.
        let (status, told) = refine(&t, &options());
        // The hull's own small angles are left.
        assert!(status == WSP_DONE || status == WSP_UNREFINED, "{told:?}");
        valid(&t);
    }
}

#[test]
fn more_memory_is_allowed_step_by_step() {
    let t = Owned::of(&scattered(2000, 3));
    let (mut vertices, mut steps, mut limited) = (0, 0, options());
    limited.max_memory = 1 << 20;
    // Nothing that one call has added may be taken away by the next.
    limited.sparsify = WSP_SPARSIFY_OFF;
    loop {
        let (status, told) = refine(&t, &limited);
        assert!(told.vertices >= vertices);
        vertices = told.vertices;
        if status != WSP_MEMORY_LIMIT {
            break;
        }
        valid(&t);
        limited.max_memory = limited.max_memory / 4 * 5;
        steps += 1;
    }
    assert!(steps > 2 && vertices > 2000, "{steps} {vertices}");
}

#[test]
fn limits_that_can_not_be_are_refused_and_older_structs_have_none() {
    let t = Owned::of(&scattered(50, 3));
    for seconds in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        let (status, text) = {
            let options = wsp_refine_options { max_seconds: seconds, ..options() };
            // SAFETY: live handles and structs.
            (unsafe { wsp_refine(t.0, &options, null_mut(), null_mut()) }, last_error())
        };
        expect(WSP_ERR_OPTION, status);
        assert!(text.contains("max_seconds"), "{text}");
    }
    // The first version's struct: what stands behind it is not looked at.
    let mut older = wsp_refine_options { max_seconds: f64::NAN, max_memory: 1, ..options() };
    older.struct_size = std::mem::offset_of!(wsp_refine_options, max_edge) as u32;
    let (status, _) = refine(&t, &older);
    assert!(status == WSP_DONE || status == WSP_UNREFINED);
    let (status, _) =
        refine(&t, &wsp_refine_options { max_seconds: f64::INFINITY, max_memory: usize::MAX, ..options() });
    assert!(status == WSP_DONE || status == WSP_UNREFINED);
}

#[test]
fn a_cancelled_refinement_has_not_measured_the_mesh_and_goes_on_later() {
    let t = Owned::of(&scattered(3000, 3));
    let mut calls = 0;
    let control = OwnedControl::new(|_| {
        calls += 1;
        i32::from(calls > 3)
    });
    let mut told = report();
    // SAFETY: live handles and structs.
    expect(WSP_CANCELLED, unsafe { wsp_refine(t.0, &options(), control.control, &mut told) });
    assert_eq!((told.bad, told.tetrahedra, told.status), (0, 0, WSP_CANCELLED));
    assert!(told.worst_radius_edge.is_nan() && told.min_dihedral_degrees.is_nan());
    assert!(told.vertices >= 3000 && told.input_vertices == 3000);
    drop(control);
    valid(&t);
    let (_, told) = refine(&t, &options());
    assert!(told.tetrahedra > 0 && told.worst_radius_edge > 0.6);
    // The gaps that the cancelled call may have left are closed.
    let view = t.view();
    assert_eq!(view.points_count, told.vertices);
    valid(&t);
}

unsafe extern "C" fn log(user: *mut c_void, level: u32, line: *const c_char) {
    // SAFETY: `user` is the list below, which outlives the call.
    let lines = unsafe { &mut *user.cast::<Vec<(u32, String)>>() };
    lines.push((level, text(line)));
}

#[test]
fn the_log_tells_what_calls_do() {
    let t = Owned::empty();
    let mut lines: Vec<(u32, String)> = Vec::new();
    let user = (&raw mut lines).cast();
    let mut control = null_mut();
    let points = scattered(2000, 3);
    let limited = wsp_refine_options { max_vertices: 2100, ..options() };
    // SAFETY: live handles and structs, arrays of the sizes given; the list outlives the control.
    unsafe {
        done(wsp_control_new(None, null_mut(), &mut control));
        expect(WSP_ERR_NULL, wsp_control_set_log(null_mut(), Some(log), user));
        done(wsp_control_set_log(control, Some(log), user));
        done(wsp_triangulation_insert(t.0, points.as_ptr().cast(), 2000, null_mut(), control));
        expect(WSP_VERTEX_LIMIT, wsp_refine(t.0, &limited, control, null_mut()));
    }
    assert!(lines.iter().any(|(level, line)| *level == WSP_LOG_INFO && line.starts_with("delaunay: ")), "{lines:?}");
    assert!(lines.iter().any(|(_, line)| line.starts_with("refine: 2000 vertices")), "{lines:?}");
    let last = lines.last().unwrap();
    assert_eq!((last.0, last.1.as_str()), (WSP_LOG_WARNING, "refine: stopped at the limit of vertices, 2100 vertices"));
    lines.clear();
    // SAFETY: as above.
    unsafe {
        done(wsp_control_set_log(control, None, null_mut()));
        wsp_refine(t.0, &limited, control, null_mut());
        wsp_control_free(control);
    }
    assert!(lines.is_empty());
}

#[test]
fn validation_and_views_can_be_followed_and_cancelled() {
    let t = Owned::of(&scattered(3000, 3));
    let mut stages = std::collections::BTreeSet::new();
    let go_on = std::cell::Cell::new(true);
    let control = OwnedControl::new(|progress| {
        stages.insert(text(progress.stage));
        i32::from(!go_on.get())
    });
    // SAFETY: live handles, a struct of numbers.
    unsafe {
        let mut view: wsp_mesh_view = std::mem::zeroed();
        done(wsp_mesh_view_init(&mut view, size_of::<wsp_mesh_view>()));
        go_on.set(false);
        expect(WSP_CANCELLED, wsp_triangulation_validate_within(t.0, WSP_VALIDATE_DELAUNAY, 0.0, control.control));
        expect(WSP_CANCELLED, wsp_triangulation_view_within(t.0, &mut view, control.control));
        assert!(view.points.is_null() && view.tetrahedra_count == 0, "the view is left as it was");
        go_on.set(true);
        done(wsp_control_reset(control.control));
        done(wsp_triangulation_validate_within(t.0, WSP_VALIDATE_DELAUNAY, 0.0, control.control));
        done(wsp_triangulation_view_within(t.0, &mut view, control.control));
        assert!(view.tetrahedra_count > 3000);
        done(wsp_triangulation_validate_within(t.0, WSP_VALIDATE_TOPOLOGY, 0.0, null_mut()));
        expect(WSP_ERR_NULL, wsp_triangulation_validate_within(null(), WSP_VALIDATE_TOPOLOGY, 0.0, null_mut()));
        expect(WSP_ERR_NULL, wsp_triangulation_view_within(null(), &mut view, null_mut()));
    }
    drop(control);
    assert_eq!(stages.into_iter().collect::<Vec<_>>(), ["validate", "view"]);
}

#[test]
fn the_last_point_off_a_plane_can_be_cancelled_and_comes_again() {
    // All points lie in a plane until the last comes: that one call triangulates them all.
    let flat: Vec<[f64; 3]> = scattered(3000, 3).into_iter().map(|[x, y, _]| [x, y, 0.0]).collect();
    let t = Owned::of(&flat);
    let cancel = std::cell::Cell::new(true);
    let control = OwnedControl::new(|_| i32::from(cancel.get()));
    // SAFETY: live handles, arrays of the sizes given.
    let insert = || unsafe { wsp_triangulation_insert(t.0, [0.5, 0.5, 1.0].as_ptr(), 1, null_mut(), control.control) };
    expect(WSP_CANCELLED, insert());
    assert_eq!(t.counts(), (3000, 0));
    expect(WSP_CANCELLED, insert());
    // SAFETY: a live handle.
    done(unsafe { wsp_control_reset(control.control) });
    cancel.set(false);
    done(insert());
    assert_eq!(t.counts().0, 3001);
    valid(&t);
    drop(control);
    let other = Owned::of(&[&flat[..], &[[0.5, 0.5, 1.0]]].concat());
    assert_eq!(t.tetrahedra(), other.tetrahedra());
}

#[test]
fn a_few_points_of_which_the_last_is_cancelled_are_all_taken_back() {
    // The first one stays in the plane; the second spans a volume, and to triangulate that is what the callback cancels.
    let flat = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    let more = [[0.5, 0.25, 0.0], [0.5, 0.5, 1.0], [0.25, 0.5, 0.0]];
    let t = Owned::of(&flat);
    let control = OwnedControl::new(|_| 1);
    // SAFETY: live handles, arrays of the sizes given.
    let insert =
        |control| unsafe { wsp_triangulation_insert(t.0, more.as_ptr().cast(), more.len(), null_mut(), control) };
    for _ in 0..2 {
        expect(WSP_CANCELLED, insert(control.control));
        assert_eq!(t.counts(), (4, 0));
        // SAFETY: a live handle.
        done(unsafe { wsp_control_reset(control.control) });
    }
    done(insert(null_mut()));
    valid(&t);
    assert_eq!(t.tetrahedra(), Owned::of(&[&flat[..], &more[..]].concat()).tetrahedra());
}

#[test]
fn what_takes_long_can_be_cancelled_and_changes_nothing_then() {
    let t = Owned::of(&scattered(3000, 5));
    let (mut control, mut out, mut count) = (null_mut(), null_mut(), 7);
    let before = t.tetrahedra();
    // SAFETY: live handles, a list of no room.
    unsafe {
        done(wsp_control_new(None, null_mut(), &mut control));
        done(wsp_control_cancel(control));
        expect(WSP_CANCELLED, wsp_triangulation_clone_within(t.0, control, &mut out));
        assert!(out.is_null());
        expect(WSP_CANCELLED, wsp_triangulation_remove_within(t.0, 17, control));
        expect(WSP_CANCELLED, wsp_triangulation_use_hull_as_domain_within(t.0, control));
        expect(WSP_CANCELLED, wsp_bad_short_edges_within(t.0, 2.0, control, null_mut(), 0, &mut count));
        expect(WSP_CANCELLED, wsp_refine(t.0, null(), control, null_mut()));
        let mut has_domain = 7;
        done(wsp_triangulation_has_domain(t.0, &mut has_domain));
        assert_eq!((has_domain, count), (0, 7));
        assert_eq!(t.tetrahedra(), before);

        done(wsp_control_reset(control));
        done(wsp_triangulation_remove_within(t.0, 17, control));
        done(wsp_triangulation_clone_within(t.0, control, &mut out));
        let copy = Owned(out);
        assert_eq!(copy.tetrahedra(), t.tetrahedra());
        done(wsp_triangulation_use_hull_as_domain_within(t.0, control));
        expect(WSP_ERR_DOMAIN, wsp_triangulation_use_hull_as_domain_within(t.0, null_mut()));
        done(wsp_bad_short_edges_within(t.0, 2.0, control, null_mut(), 0, &mut count));
        let mut alike = 0;
        done(wsp_bad_short_edges(t.0, 2.0, null_mut(), 0, &mut alike));
        assert!(count == alike && count > 0);
        wsp_control_free(control);
    }
    valid(&t);
}

#[test]
fn a_cancelled_control_stops_what_would_be_done_at_once() {
    let t = Owned::of(&scattered(20, 5));
    let mut control = null_mut();
    // SAFETY: live handles, structs of numbers and pointers, a list of no room.
    unsafe {
        let (mut view, mut boundary): (wsp_mesh_view, wsp_boundary_view) = (std::mem::zeroed(), std::mem::zeroed());
        done(wsp_mesh_view_init(&mut view, size_of::<wsp_mesh_view>()));
        done(wsp_boundary_view_init(&mut boundary, size_of::<wsp_boundary_view>()));
        done(wsp_triangulation_use_hull_as_domain(t.0));
        done(wsp_control_new(None, null_mut(), &mut control));
        // The arrays are there already at the second call.
        done(wsp_triangulation_view_within(t.0, &mut view, control));
        done(wsp_triangulation_boundary(t.0, control, &mut boundary));
        let (tetrahedra, faces, mut count) = (view.tetrahedra_count, boundary.faces_count, 7);
        (view.tetrahedra_count, boundary.faces_count) = (7777, 7777);
        done(wsp_control_cancel(control));
        expect(WSP_CANCELLED, wsp_bad_short_edges_within(t.0, 2.0, control, null_mut(), 0, &mut count));
        expect(WSP_CANCELLED, wsp_triangulation_view_within(t.0, &mut view, control));
        expect(WSP_CANCELLED, wsp_triangulation_boundary(t.0, control, &mut boundary));
        assert_eq!((count, view.tetrahedra_count, boundary.faces_count), (7, 7777, 7777));
        done(wsp_control_reset(control));
        done(wsp_triangulation_view_within(t.0, &mut view, control));
        done(wsp_triangulation_boundary(t.0, control, &mut boundary));
        assert_eq!((view.tetrahedra_count, boundary.faces_count), (tetrahedra, faces));
        wsp_control_free(control);
    }
}

#[test]
fn joining_facets_can_be_cancelled_and_changes_nothing_then() {
    use crate::capi::check::wsp_plc_join_coplanar_within;
    let mut plc = null_mut();
    let mut control = null_mut();
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let (vertices, starts) = ([0, 1, 2, 0, 2, 3], [0, 3, 6]);
    let mut facets = 0;
    // SAFETY: live handles, and arrays as long as the counts say.
    unsafe {
        done(wsp_plc_new(&mut plc));
        done(wsp_control_new(None, null_mut(), &mut control));
        done(wsp_plc_add_points(plc, points.as_ptr().cast(), 4, null(), null_mut()));
        done(wsp_plc_add_facets(plc, vertices.as_ptr(), starts.as_ptr(), 2, null(), 2, null(), null_mut()));
        assert_eq!(wsp_plc_join_coplanar_within(plc, 91.0, control, &mut facets), WSP_ERR_ARGUMENT);
        done(wsp_control_cancel(control));
        assert_eq!(wsp_plc_join_coplanar_within(plc, 1.0, control, &mut facets), WSP_CANCELLED);
        let (mut points, mut segments) = (0, 0);
        done(wsp_plc_counts(plc, &mut points, &mut segments, &mut facets));
        assert_eq!(facets, 2);
        done(wsp_control_reset(control));
        done(wsp_plc_join_coplanar_within(plc, 1.0, control, &mut facets));
        assert_eq!(facets, 1);
        wsp_plc_free(plc);
        wsp_control_free(control);
    }
}
