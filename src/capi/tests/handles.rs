//! Poisoned and busy handles, panics, threads, controls, copies.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::super::handle::injected;
use super::*;

#[test]
fn a_panic_poisons_its_handle_only() {
    let (t, other) = (Owned::of(&scattered(30, 1)), Owned::of(&scattered(30, 2)));
    injected::ask();
    let p = [0.5; 3];
    // SAFETY: live handles, writable results.
    unsafe {
        expect(WSP_ERR_INTERNAL, wsp_triangulation_insert(t.0, p.as_ptr(), 1, null_mut(), null_mut()));
        assert!(last_error().contains("injected by a test"), "{}", last_error());
        assert!(last_error().contains("handle.rs:"), "the panic's place is told: {}", last_error());
        // Nothing but its free, whatever the call.
        let (mut count, mut out, mut batch) = (5, t.0, null_mut());
        expect(WSP_ERR_INTERNAL, wsp_triangulation_insert(t.0, p.as_ptr(), 1, null_mut(), null_mut()));
        assert!(last_error().contains("free it"), "{}", last_error());
        expect(WSP_ERR_INTERNAL, wsp_triangulation_counts(t.0, &mut count, null_mut()));
        expect(WSP_ERR_INTERNAL, wsp_triangulation_clone(t.0, &mut out));
        expect(WSP_ERR_INTERNAL, wsp_triangulation_validate(t.0, 1, 2.0));
        expect(WSP_ERR_INTERNAL, wsp_refine(t.0, null(), null_mut(), null_mut()));
        expect(WSP_ERR_INTERNAL, wsp_steiner_batch(t.0, wsp_edge { vertices: [0, 1] }, null(), &mut batch));
        assert!(out.is_null() && batch.is_null() && count == 5);
    }
    assert_eq!(other.counts().0, 30, "the other handle answers");
}

#[test]
fn a_panic_while_reading_poisons_too() {
    let t = Owned::of(&scattered(30, 1));
    let mut dimension = 9;
    injected::ask();
    // SAFETY: a live handle, a writable result.
    unsafe {
        expect(WSP_ERR_INTERNAL, wsp_triangulation_dimension(t.0, &mut dimension));
        expect(WSP_ERR_INTERNAL, wsp_triangulation_dimension(t.0, &mut dimension));
    }
    assert_eq!(dimension, 9);
    let mut plc = null_mut();
    // SAFETY: as above.
    unsafe {
        done(wsp_plc_new(&mut plc));
        injected::ask();
        expect(WSP_ERR_INTERNAL, wsp_plc_add_hole(plc, [0.0; 3].as_ptr()));
        expect(WSP_ERR_INTERNAL, wsp_plc_counts(plc, null_mut(), null_mut(), null_mut()));
        wsp_plc_free(plc);
    }
}

#[test]
fn a_callback_cannot_use_the_handle_of_its_call() {
    let t = Owned::of(&scattered(30, 1));
    let other = Owned::of(&scattered(30, 2));
    let handle = t.0;
    let mut calls = 0;
    let points = scattered(20_000, 3);
    let control = OwnedControl::new(|progress| {
        calls += 1;
        assert!((0.0..=1.0).contains(&progress.fraction));
        assert_eq!(progress.struct_size as usize, size_of::<wsp_progress>());
        assert!(!text(progress.stage).is_empty());
        let mut count = 0;
        // SAFETY: a live handle, a writable result.
        unsafe {
            expect(WSP_ERR_BUSY, wsp_triangulation_counts(handle, &mut count, null_mut()));
            expect(WSP_ERR_BUSY, wsp_triangulation_insert(handle, [0.0; 3].as_ptr(), 1, null_mut(), null_mut()));
            wsp_triangulation_free(handle);
            assert!(last_error().contains("not freed"), "{}", last_error());
        }
        assert_eq!(other.counts().0, 30, "another handle is free");
        0
    });
    // SAFETY: live handles, an array of the size given.
    done(unsafe { wsp_triangulation_insert(t.0, points.as_ptr().cast(), points.len(), null_mut(), control.control) });
    drop(control);
    assert!(calls > 0, "progress is reported");
    assert_eq!(t.counts().0, 20_030);
}

#[test]
fn a_cancelled_insertion_inserts_nothing() {
    let t = Owned::of(&scattered(30, 1));
    let before = t.tetrahedra();
    let points = scattered(20_000, 3);
    let mut ids = vec![7; points.len()];
    let control = OwnedControl::new(|_| 1);
    let mut insert = || {
        // SAFETY: live handles, arrays of the size given.
        unsafe {
            wsp_triangulation_insert(t.0, points.as_ptr().cast(), points.len(), ids.as_mut_ptr(), control.control)
        }
    };
    expect(WSP_CANCELLED, insert());
    expect(WSP_CANCELLED, insert());
    assert!(ids.iter().all(|&id| id == 7));
    assert_eq!(t.tetrahedra(), before);
    // SAFETY: a live handle.
    done(unsafe { wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 2.0) });
}

#[test]
fn a_control_cancels_until_it_is_reset() {
    let mut control = null_mut();
    // SAFETY: live handles, arrays of the sizes given.
    unsafe {
        done(wsp_control_new(None, null_mut(), &mut control));
        let t = Owned::empty();
        let points = scattered(100, 3);
        let insert = || wsp_triangulation_insert(t.0, points.as_ptr().cast(), 100, null_mut(), control);
        done(wsp_control_cancel(control));
        expect(WSP_CANCELLED, insert());
        assert_eq!(t.counts(), (0, 0));
        done(wsp_control_reset(control));
        done(insert());
        assert_eq!(t.counts().0, 100);
        wsp_control_free(control);
    }
}

#[test]
fn another_thread_cancels() {
    let t = Owned::empty();
    let points = scattered(50_000, 3);
    // The call waits in its callback until the other thread has cancelled: no race, no clock.
    let (asked, answered) = (std::sync::Barrier::new(2), std::sync::Barrier::new(2));
    let mut first = true;
    let control = OwnedControl::new(|_| {
        if std::mem::take(&mut first) {
            asked.wait();
            answered.wait();
        }
        0
    });
    struct Shared(*mut wsp_control);
    // SAFETY: a control may be cancelled from any thread.
    unsafe impl Sync for Shared {}
    let shared = Shared(control.control);
    std::thread::scope(|scope| {
        let (shared, asked, answered) = (&shared, &asked, &answered);
        scope.spawn(move || {
            asked.wait();
            // SAFETY: live until the scope ends.
            done(unsafe { wsp_control_cancel(shared.0) });
            answered.wait();
        });
        // SAFETY: live handles, an array of the size given.
        expect(WSP_CANCELLED, unsafe {
            wsp_triangulation_insert(t.0, points.as_ptr().cast(), points.len(), null_mut(), control.control)
        });
    });
    assert_eq!(t.counts(), (0, 0));
}

#[test]
fn const_calls_run_at_once_on_one_handle() {
    struct Shared(*const wsp_triangulation);
    // SAFETY: only const calls are made through it.
    unsafe impl Sync for Shared {}
    let points = scattered(2000, 1);
    let t = Owned::of(&points);
    let shared = Shared(t.0);
    let found = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let (shared, points, found) = (&shared, &points, &found);
            scope.spawn(move || {
                for (i, p) in points.iter().enumerate().skip(thread) {
                    let mut location = wsp_location { kind: 77, vertices: [0; 4] };
                    // SAFETY: a live handle, a writable result.
                    done(unsafe { wsp_triangulation_locate(shared.0, p.as_ptr(), WSP_NONE, &mut location) });
                    assert_eq!((location.kind, location.vertices[0]), (WSP_AT_VERTEX, i as u32));
                    found.fetch_add(1, Ordering::Relaxed);
                }
            });
        }
        for seed in 5..7 {
            scope.spawn(move || assert_eq!(Owned::of(&scattered(500, seed)).counts().0, 500));
        }
    });
    assert_eq!(found.into_inner(), 2000 + 1999 + 1998 + 1997);
    assert_eq!(t.insert(&[[3.0, 3.0, 3.0]]), [2000], "and the handle is free again");
}

#[test]
fn copies_share_nothing() {
    let t = Owned::of(&scattered(100, 1));
    let mut copy = null_mut();
    // SAFETY: a live handle.
    done(unsafe { wsp_triangulation_clone(t.0, &mut copy) });
    let copy = Owned(copy);
    assert_eq!(copy.tetrahedra(), t.tetrahedra());
    t.insert(&[[0.5, 0.5, 0.5]]);
    assert_eq!((t.counts().0, copy.counts().0), (101, 100));
}

#[test]
fn removed_vertices_leave_gaps_that_are_filled_again() {
    let points = scattered(60, 4);
    let t = Owned::of(&points);
    let (full, before) = (t.tetrahedra(), t.counts());
    for v in [17, 3, 59] {
        // SAFETY: live handles, writable results.
        unsafe {
            done(wsp_triangulation_remove(t.0, v));
            let mut p = [5.0; 3];
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_point(t.0, v, p.as_mut_ptr()));
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_remove(t.0, v));
            let mut location: wsp_location = std::mem::zeroed();
            let xyz = points[v as usize].as_ptr();
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_locate(t.0, xyz, v, &mut location));
            done(wsp_triangulation_locate(t.0, xyz, WSP_NONE, &mut location));
            assert_ne!(location.kind, WSP_AT_VERTEX);
            let edge = wsp_edge { vertices: [v, 0] };
            let mut count = 0;
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_edge_link(t.0, edge, null_mut(), 0, &mut count, null_mut()));
            done(wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0));
        }
    }
    assert_eq!(t.counts().0, 57);
    let view = t.view();
    assert_eq!(view.points_count, 60);
    // SAFETY: the view's arrays, before the handle changes.
    let (xyz, corners) = unsafe { (array(view.points, 180), array(view.tetrahedra, 4 * view.tetrahedra_count)) };
    for v in 0..60 {
        let removed = [3, 17, 59].contains(&v);
        assert_eq!(xyz[3 * v].is_nan(), removed);
        assert_eq!(corners.contains(&(v as u32)), !removed);
    }
    // One by one the ids freed last come first, more at once stand behind all.
    assert_eq!(t.insert(&[points[59]]), [59]);
    assert_eq!(t.insert(&[points[3]]), [3]);
    assert_eq!(t.insert(&[points[3]]), [3], "a duplicate takes no id");
    assert_eq!(t.insert(&[points[0], points[17]]), [0, 60]);
    // SAFETY: live handles.
    unsafe { done(wsp_triangulation_remove(t.0, 60)) };
    assert_eq!(t.insert(&[points[17]]), [60]);
    // SAFETY: live handles.
    unsafe { done(wsp_triangulation_remove(t.0, 60)) };
    assert_eq!(t.insert(&[[0.5; 3], points[17]]), [61, 62]);
    for v in [61, 62] {
        // SAFETY: live handles.
        unsafe { done(wsp_triangulation_remove(t.0, v)) };
    }
    assert_eq!(t.counts().0, 59);
    assert_eq!(t.insert(&[points[17]]), [62]);
    let renamed = |v: u32| if v == 62 { 17 } else { v };
    let mut again: Vec<[u32; 4]> = t.tetrahedra().into_iter().map(|tet| tet.map(renamed)).collect();
    again.iter_mut().for_each(|tet| tet.sort_unstable());
    again.sort_unstable();
    assert_eq!((again, t.counts()), (full, before));
}

#[test]
fn removal_ends_with_nothing_and_stops_at_a_domain() {
    let t = Owned::of(&scattered(12, 9));
    let mut dimension = 9;
    let mut batch = null_mut();
    // SAFETY: live handles, writable results.
    unsafe {
        done(wsp_steiner_batch(t.0, wsp_edge { vertices: edge_of(&t) }, null(), &mut batch));
        for v in 0..12 {
            done(wsp_triangulation_remove(t.0, v));
            done(wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0));
            done(wsp_triangulation_dimension(t.0, &mut dimension));
            assert_eq!(dimension, (10 - v as i32).min(3));
        }
        expect(WSP_ERR_STALE, wsp_triangulation_insert_batch(t.0, batch, null_mut()));
        wsp_batch_free(batch);
    }
    assert_eq!(t.counts(), (0, 0));
    t.insert(&scattered(30, 2));
    // SAFETY: a live handle.
    unsafe {
        done(wsp_triangulation_remove(t.0, 20));
        done(wsp_triangulation_use_hull_as_domain(t.0));
        expect(WSP_ERR_DOMAIN, wsp_triangulation_remove(t.0, 21));
        let mut report: wsp_report = std::mem::zeroed();
        done(wsp_report_init(&mut report, size_of::<wsp_report>()));
        let mut options: wsp_refine_options = std::mem::zeroed();
        done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
        options.max_vertices = 60;
        assert!(wsp_refine(t.0, &options, null_mut(), &mut report) >= 0);
        assert_eq!((report.input_vertices, report.vertices), (29, 29 + report.steiner));
        // An input vertex's id is no Steiner point's.
        let mut p = [0.0; 3];
        expect(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_point(t.0, 20, p.as_mut_ptr()));
        done(wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0));
    }
}

/// An edge of a triangulation.
fn edge_of(t: &Owned) -> [u32; 2] {
    let [a, b, ..] = t.tetrahedra()[0];
    [a, b]
}

#[test]
fn points_ids_and_duplicates() {
    let t = Owned::empty();
    let mut dimension = 9;
    let dimension_is = |dimension: &mut i32, expected| {
        // SAFETY: a live handle, a writable result.
        done(unsafe { wsp_triangulation_dimension(t.0, dimension) });
        assert_eq!(*dimension, expected);
    };
    dimension_is(&mut dimension, -1);
    assert_eq!(t.insert(&[[0.0; 3]]), [0]);
    dimension_is(&mut dimension, 0);
    assert_eq!(t.insert(&[[1.0, 0.0, 0.0], [0.0; 3]]), [1, 0]);
    dimension_is(&mut dimension, 1);
    assert_eq!(t.insert(&[[0.0, 1.0, 0.0]]), [2]);
    dimension_is(&mut dimension, 2);
    assert_eq!(t.counts(), (3, 0));
    assert!(t.view().tetrahedra.is_null());
    assert_eq!(t.insert(&[[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]), [2, 3, 3]);
    dimension_is(&mut dimension, 3);
    assert_eq!(t.counts(), (4, 1));
    let view = t.view();
    assert_eq!((view.points_count, view.tetrahedra_count), (4, 1));
    // SAFETY: the view's arrays; a live handle.
    unsafe {
        assert_eq!(array(view.neighbours, 4), [WSP_NONE; 4]);
        let xyz = array(view.points, 12);
        for vertex in 0..4 {
            let mut p = [0.0; 3];
            done(wsp_triangulation_point(t.0, vertex, p.as_mut_ptr()));
            assert_eq!(p, xyz[3 * vertex as usize..][..3]);
        }
        let ids = array(view.tetrahedra, 4);
        let p = |i: usize| glam::DVec3::from_slice(&xyz[3 * ids[i] as usize..]);
        let (a, b, c, d) = (p(0), p(1), p(2), p(3));
        assert!((b - a).cross(c - a).dot(d - a) > 0.0, "positively oriented");
    }
}

#[test]
fn locations() {
    let t = Owned::of(&[[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]]);
    let locate = |p: [f64; 3], hint| {
        let mut location = wsp_location { kind: 77, vertices: [0; 4] };
        // SAFETY: a live handle, a writable result.
        done(unsafe { wsp_triangulation_locate(t.0, p.as_ptr(), hint, &mut location) });
        location.vertices.sort_unstable();
        (location.kind, location.vertices)
    };
    for hint in [WSP_NONE, 0, 3] {
        assert_eq!(locate([2.0, 0.0, 0.0], hint), (WSP_AT_VERTEX, [1, WSP_NONE, WSP_NONE, WSP_NONE]));
        assert_eq!(locate([0.0, 1.0, 0.0], hint), (WSP_IN_EDGE, [0, 2, WSP_NONE, WSP_NONE]));
        assert_eq!(locate([0.5, 0.5, 0.0], hint), (WSP_IN_FACE, [0, 1, 2, WSP_NONE]));
        assert_eq!(locate([0.25, 0.25, 0.25], hint), (WSP_IN_TETRAHEDRON, [0, 1, 2, 3]));
        assert_eq!(locate([-0.25, 0.25, 0.25], hint), (WSP_OUTSIDE, [WSP_NONE; 4]));
    }
}

#[test]
fn ids_may_overlap_the_points() {
    let points = scattered(50, 1);
    let expected = Owned::of(&points).tetrahedra();
    let mut memory = points.clone();
    let t = Owned::empty();
    let xyz: *mut [f64; 3] = memory.as_mut_ptr();
    // SAFETY: a live handle; 50 ids fit where 50 points are.
    done(unsafe { wsp_triangulation_insert(t.0, xyz.cast(), 50, xyz.cast(), null_mut()) });
    // SAFETY: the ids that were just written there.
    let ids = unsafe { array(xyz.cast::<u32>(), 50) };
    assert!(ids.iter().copied().eq(0..50));
    assert_eq!(t.tetrahedra(), expected);
}
