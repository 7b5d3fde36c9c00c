//! Null pointers, wrong sizes, wrong values: each has its answer, and changes nothing.

use super::*;
use crate::capi::check::{wsp_plc_check, wsp_plc_check_within, wsp_plc_join_coplanar, wsp_plc_join_coplanar_within};

/// Each call must answer WSP_ERR_NULL with a text that begins with the function's name.
macro_rules! null_is_refused {
    ($($function:ident($($argument:expr),*);)*) => {$(
        // SAFETY: the point of the test: NULL is checked, all else is valid.
        let status = unsafe { $function($($argument),*) };
        assert_eq!(status, WSP_ERR_NULL, "{}: {}", stringify!($function($($argument),*)), last_error());
        assert!(last_error().starts_with(concat!(stringify!($function), ": ")), "{}", last_error());
        assert!(last_error().ends_with(" is NULL"), "{}", last_error());
    )*};
}

#[test]
fn null_pointers_are_refused() {
    let owned = Owned::of(&scattered(20, 1));
    let t = owned.0;
    let mut plc = null_mut();
    // SAFETY: `plc` may be written.
    done(unsafe { wsp_plc_new(&mut plc) });
    let control: OwnedControl = OwnedControl::new(|_| 0);
    let p = [0.5f64; 3];
    let p = p.as_ptr();
    let link = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, -1.0, 0.0]];
    let xyz: *const f64 = link.as_ptr().cast();
    let edge = wsp_edge { vertices: [0, 1] };
    let (mut count, mut word, mut int, mut out_xyz) = (0usize, 0u32, 0i32, [0.0; 3]);
    let mut location = wsp_location { kind: 77, vertices: [0; 4] };
    let mut batch = null_mut();
    null_is_refused! {
        wsp_triangulation_options_init(null_mut(), 8);
        wsp_sampler_options_init(null_mut(), 16);
        wsp_refine_options_init(null_mut(), 32);
        wsp_report_init(null_mut(), size_of::<wsp_report>());
        wsp_mesh_view_init(null_mut(), size_of::<wsp_mesh_view>());
        wsp_control_new(None, null_mut(), null_mut());
        wsp_control_cancel(null_mut());
        wsp_control_reset(null_mut());
        wsp_plc_new(null_mut());
        wsp_plc_add_points(null_mut(), xyz, 3, null(), null_mut());
        wsp_plc_add_points(plc, null(), 3, null(), null_mut());
        wsp_plc_add_box(null_mut(), p, p, 1, null_mut());
        wsp_plc_add_box(plc, null(), p, 1, null_mut());
        wsp_plc_add_box(plc, p, null(), 1, null_mut());
        wsp_plc_add_segments(null_mut(), [0, 1].as_ptr(), 1, null());
        wsp_plc_add_segments(plc, null(), 1, null());
        wsp_plc_add_facets(null_mut(), [0, 1, 2].as_ptr(), [0, 3].as_ptr(), 1, null(), 1, null(), null_mut());
        wsp_plc_add_facets(plc, null(), [0, 3].as_ptr(), 1, null(), 1, null(), null_mut());
        wsp_plc_add_facets(plc, [0, 1, 2].as_ptr(), null(), 1, null(), 1, null(), null_mut());
        wsp_plc_add_facet_hole(null_mut(), 0, p);
        wsp_plc_add_facet_hole(plc, 0, null());
        wsp_plc_add_hole(null_mut(), p);
        wsp_plc_add_hole(plc, null());
        wsp_plc_add_region(null_mut(), p, 1.0, 0.0);
        wsp_plc_add_region(plc, null(), 1.0, 0.0);
        wsp_plc_counts(null(), &mut count, &mut count, &mut count);
        wsp_triangulation_new(null(), null_mut());
        wsp_triangulation_from_plc(plc, null(), control.control, null_mut());
        wsp_triangulation_use_hull_as_domain(null_mut());
        wsp_triangulation_clone(t, null_mut());
        wsp_triangulation_insert(null_mut(), xyz, 3, null_mut(), null_mut());
        wsp_triangulation_insert(t, null(), 3, null_mut(), null_mut());
        wsp_triangulation_remove(null_mut(), 0);
        wsp_triangulation_remove_within(null_mut(), 0, null_mut());
        wsp_triangulation_use_hull_as_domain_within(null_mut(), null_mut());
        wsp_triangulation_clone_within(t, null_mut(), null_mut());
        wsp_bad_short_edges_within(t, 2.0, null_mut(), null_mut(), 0, null_mut());
        wsp_plc_check(null(), null_mut());
        wsp_plc_check_within(plc, null_mut(), null_mut());
        wsp_plc_join_coplanar(null_mut(), 1.0, null_mut());
        wsp_plc_join_coplanar_within(null_mut(), 1.0, null_mut(), null_mut());
        wsp_triangulation_locate(null(), p, WSP_NONE, &mut location);
        wsp_triangulation_locate(t, null(), WSP_NONE, &mut location);
        wsp_triangulation_locate(t, p, WSP_NONE, null_mut());
        wsp_triangulation_dimension(null(), &mut int);
        wsp_triangulation_dimension(t, null_mut());
        wsp_triangulation_counts(null(), &mut count, &mut count);
        wsp_triangulation_has_domain(null(), &mut word);
        wsp_triangulation_has_domain(t, null_mut());
        wsp_triangulation_point(null(), 0, out_xyz.as_mut_ptr());
        wsp_triangulation_point(t, 0, null_mut());
        wsp_triangulation_validate(null(), 3, 2.0);
        wsp_triangulation_view(t, null_mut());
        wsp_bad_short_edges(null(), 2.0, null_mut(), 0, &mut count);
        wsp_bad_short_edges(t, 2.0, null_mut(), 1, &mut count);
        wsp_bad_short_edges(t, 2.0, null_mut(), 0, null_mut());
        wsp_edge_link(null(), edge, null_mut(), 0, &mut count, null_mut());
        wsp_edge_link(t, edge, null_mut(), 1, &mut count, null_mut());
        wsp_edge_link(t, edge, null_mut(), 0, null_mut(), null_mut());
        wsp_steiner_batch(null(), edge, null(), &mut batch);
        wsp_steiner_batch(t, edge, null(), null_mut());
        wsp_triangulation_insert_batch(t, null(), null_mut());
        wsp_refine(null_mut(), null(), null_mut(), null_mut());
        wsp_sample_edge(null(), p, xyz, 3, 1, null(), null_mut(), 0, &mut count);
        wsp_sample_edge(p, null(), xyz, 3, 1, null(), null_mut(), 0, &mut count);
        wsp_sample_edge(p, link[0].as_ptr(), null(), 3, 1, null(), null_mut(), 0, &mut count);
        wsp_sample_edge(p, link[0].as_ptr(), xyz, 3, 1, null(), null_mut(), 2, &mut count);
        wsp_sample_edge(p, link[0].as_ptr(), xyz, 3, 1, null(), null_mut(), 0, null_mut());
        wsp_is_bad_edge(null(), p, xyz, 3, 1, 2.0, &mut word);
        wsp_is_bad_edge(p, null(), xyz, 3, 1, 2.0, &mut word);
        wsp_is_bad_edge(p, link[0].as_ptr(), null(), 3, 1, 2.0, &mut word);
        wsp_is_bad_edge(p, link[0].as_ptr(), xyz, 3, 1, 2.0, null_mut());
    }
    let mut out = t;
    null_is_refused! {
        wsp_triangulation_from_plc(null(), null(), null_mut(), &mut out);
        wsp_triangulation_clone(null(), &mut out);
        wsp_triangulation_clone_within(null(), null_mut(), &mut out);
    }
    assert!(out.is_null(), "a failed call gives out no handle");
    assert_eq!((location.kind, count, word, int, out_xyz), (77, 0, 0, 0, [0.0; 3]), "nothing was written");
    assert!(batch.is_null());
    assert_eq!(owned.counts().0, 20);
    // SAFETY: made above.
    unsafe { wsp_plc_free(plc) };
}

#[test]
fn freeing_null_and_asking_a_null_batch_is_fine() {
    // SAFETY: NULL is allowed here.
    unsafe {
        wsp_triangulation_free(null_mut());
        wsp_plc_free(null_mut());
        wsp_control_free(null_mut());
        wsp_batch_free(null_mut());
        assert_eq!(wsp_batch_edge(null()).vertices, [WSP_NONE; 2]);
        assert_eq!((wsp_batch_count(null()), wsp_batch_rule(null())), (0, 0));
        assert_eq!((wsp_batch_span(null()), wsp_batch_theta(null())), (0.0, 0.0));
        assert!(wsp_batch_points(null()).is_null() && wsp_batch_origins(null()).is_null());
    }
}

#[test]
fn unknown_struct_sizes_are_refused() {
    let t = Owned::of(&scattered(20, 1));
    // SAFETY: structs of numbers, live handles; the sizes are what is tested.
    unsafe {
        let mut options: wsp_refine_options = std::mem::zeroed();
        let size = size_of::<wsp_refine_options>();
        for wrong in [0, 1, 4, size - 1, size + 1, size + 8, usize::MAX] {
            expect(WSP_ERR_STRUCT_SIZE, wsp_refine_options_init(&mut options, wrong));
            assert_eq!(options.radius_edge, 0.0, "nothing was written");
            assert!(last_error().contains("wsp_refine_options"), "{}", last_error());
        }
        // An `_init` forgotten, and a newer header.
        for wrong in [0, size as u32 + 8] {
            options.struct_size = wrong;
            expect(WSP_ERR_STRUCT_SIZE, wsp_refine(t.0, &options, null_mut(), null_mut()));
        }
        done(wsp_refine_options_init(&mut options, size));
        assert_eq!((options.struct_size as usize, options.rule), (size, WSP_RULE_SPARSE));
        assert_eq!((options.radius_edge, options.min_edge, options.max_vertices), (2.0, 0.0, 100_000_000));

        let mut report: wsp_report = std::mem::zeroed();
        expect(WSP_ERR_STRUCT_SIZE, wsp_refine(t.0, &options, null_mut(), &mut report));
        let mut view: wsp_mesh_view = std::mem::zeroed();
        expect(WSP_ERR_STRUCT_SIZE, wsp_triangulation_view(t.0, &mut view));
        let mut sampler: wsp_sampler_options = std::mem::zeroed();
        let mut batch = null_mut();
        let edge = wsp_edge { vertices: [0, 1] };
        expect(WSP_ERR_STRUCT_SIZE, wsp_steiner_batch(t.0, edge, &sampler, &mut batch));
        done(wsp_sampler_options_init(&mut sampler, size_of::<wsp_sampler_options>()));
        assert_eq!((sampler.rule, sampler.radius_edge), (WSP_RULE_SPARSE, 2.0));
        let mut options: wsp_triangulation_options = std::mem::zeroed();
        let mut out = t.0;
        expect(WSP_ERR_STRUCT_SIZE, wsp_triangulation_new(&options, &mut out));
        assert!(out.is_null());
        done(wsp_triangulation_options_init(&mut options, size_of::<wsp_triangulation_options>()));
        assert_eq!((options.flags, options.threads), (0, 1));
        options.flags = 4;
        expect(WSP_ERR_OPTION, wsp_triangulation_new(&options, &mut out));
        assert!(out.is_null());
        (options.flags, options.threads) = (0, 1025);
        expect(WSP_ERR_OPTION, wsp_triangulation_new(&options, &mut out));
        assert!(out.is_null());
        // The first version's struct has no threads: what stands there is not looked at.
        options.struct_size = 8;
        done(wsp_triangulation_new(&options, &mut out));
        wsp_triangulation_free(out);
    }
    assert_eq!(t.counts().0, 20);
}

#[test]
fn unknown_option_values_are_refused() {
    let t = Owned::of(&scattered(20, 1));
    // SAFETY: structs of numbers, live handles.
    unsafe {
        let mut options: wsp_refine_options = std::mem::zeroed();
        done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
        for rule in [0, 4, u32::MAX] {
            let options = wsp_refine_options { rule, ..options };
            expect(WSP_ERR_OPTION, wsp_refine(t.0, &options, null_mut(), null_mut()));
        }
        for bad in [0.0, 0.61, -2.0, f64::NAN, f64::INFINITY] {
            let options = wsp_refine_options { radius_edge: bad, ..options };
            expect(WSP_ERR_OPTION, wsp_refine(t.0, &options, null_mut(), null_mut()));
            assert!(last_error().contains("radius_edge"), "{}", last_error());
            expect(WSP_ERR_OPTION, wsp_bad_short_edges(t.0, bad, null_mut(), 0, &mut 0));
            expect(WSP_ERR_OPTION, wsp_triangulation_validate(t.0, WSP_VALIDATE_QUALITY, bad));
        }
        for bad in [-1.0, f64::NAN, f64::INFINITY] {
            let options = wsp_refine_options { min_edge: bad, ..options };
            expect(WSP_ERR_OPTION, wsp_refine(t.0, &options, null_mut(), null_mut()));
            assert!(last_error().contains("min_edge"), "{}", last_error());
        }
        for level in [0, 5, u32::MAX] {
            expect(WSP_ERR_ARGUMENT, wsp_triangulation_validate(t.0, level, 2.0));
        }
    }
    assert_eq!(t.counts().0, 20);
}

#[test]
fn bad_points_are_named_and_nothing_is_inserted() {
    let t = Owned::of(&scattered(20, 1));
    let mut ids = [7u32; 3];
    let mut insert = |points: &[[f64; 3]; 3]| {
        // SAFETY: a live handle, arrays of three.
        let status = unsafe { wsp_triangulation_insert(t.0, points.as_ptr().cast(), 3, ids.as_mut_ptr(), null_mut()) };
        assert_eq!(ids, [7; 3]);
        status
    };
    let good = [2.0, 3.0, 4.0];
    expect(WSP_ERR_NOT_FINITE, insert(&[good, good, [0.0, f64::NAN, 0.0]]));
    assert!(last_error().contains("point 2"), "{}", last_error());
    expect(WSP_ERR_NOT_FINITE, insert(&[good, [f64::NEG_INFINITY, 0.0, 0.0], good]));
    assert!(last_error().contains("point 1"), "{}", last_error());
    expect(WSP_ERR_OUT_OF_RANGE, insert(&[[0.0, 0.0, 1e200], good, good]));
    expect(WSP_ERR_OUT_OF_RANGE, insert(&[[0.0, 1e-300, 0.0], good, good]));
    assert_eq!(t.counts().0, 20);

    let mut location = wsp_location { kind: 77, vertices: [0; 4] };
    let nan = [f64::NAN, 0.0, 0.0];
    // SAFETY: a live handle, three doubles.
    expect(WSP_ERR_NOT_FINITE, unsafe { wsp_triangulation_locate(t.0, nan.as_ptr(), WSP_NONE, &mut location) });
    assert!(last_error().starts_with("wsp_triangulation_locate: p ("), "{}", last_error());
    assert_eq!(location.kind, 77);
}

#[test]
fn foreign_ids_are_refused() {
    let t = Owned::of(&scattered(20, 1));
    let (mut xyz, mut count, mut batch) = ([0.0; 3], 0, null_mut());
    let mut location = wsp_location { kind: 77, vertices: [0; 4] };
    for id in [20, 21, WSP_NONE - 1, WSP_NONE] {
        // SAFETY: a live handle, writable results.
        unsafe {
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_point(t.0, id, xyz.as_mut_ptr()));
            let edge = wsp_edge { vertices: [0, id] };
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_edge_link(t.0, edge, null_mut(), 0, &mut count, null_mut()));
            expect(WSP_ERR_NO_SUCH_VERTEX, wsp_steiner_batch(t.0, edge, null(), &mut batch));
            if id != WSP_NONE {
                expect(WSP_ERR_NO_SUCH_VERTEX, wsp_triangulation_locate(t.0, xyz.as_ptr(), id, &mut location));
                assert!(last_error().contains(&id.to_string()), "{}", last_error());
            }
        }
    }
    // SAFETY: as above.
    unsafe {
        let edge = wsp_edge { vertices: [3, 3] };
        expect(WSP_ERR_NO_SUCH_EDGE, wsp_edge_link(t.0, edge, null_mut(), 0, &mut count, null_mut()));
        expect(WSP_ERR_NO_SUCH_EDGE, wsp_steiner_batch(t.0, edge, null(), &mut batch));
    }
    assert!(batch.is_null());
    assert_eq!((location.kind, count), (77, 0));
}

#[test]
fn misaligned_and_oversized_arrays_are_refused() {
    let t = Owned::empty();
    let memory = [0.0f64; 10];
    // SAFETY: the pointers are checked before anything is read through them.
    unsafe {
        let odd = memory.as_ptr().byte_add(4);
        expect(WSP_ERR_ARGUMENT, wsp_triangulation_insert(t.0, odd, 2, null_mut(), null_mut()));
        let huge = usize::MAX / 2;
        expect(WSP_ERR_TOO_MANY, wsp_triangulation_insert(t.0, memory.as_ptr(), huge, null_mut(), null_mut()));
        done(wsp_triangulation_insert(t.0, null(), 0, null_mut(), null_mut()));
    }
    assert_eq!(t.counts(), (0, 0));
}

#[test]
fn texts_belong_to_their_thread() {
    // SAFETY: NULL is what is tested.
    expect(WSP_ERR_NULL, unsafe { wsp_triangulation_new(null(), null_mut()) });
    let here = last_error();
    std::thread::spawn(|| {
        assert_eq!(last_error(), "", "nothing has failed on this thread");
        // SAFETY: as above.
        expect(WSP_ERR_NULL, unsafe { wsp_plc_new(null_mut()) });
        assert!(last_error().starts_with("wsp_plc_new"));
    })
    .join()
    .expect("the other thread");
    assert_eq!(last_error(), here);
    drop(Owned::empty());
    assert_eq!(last_error(), here, "calls that succeed leave it");
}
