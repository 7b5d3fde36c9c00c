//! Step by step, and the sampler without a handle.

use super::*;

fn box_and_points() -> Owned {
    let (mut plc, mut t) = (null_mut(), null_mut());
    let points = scattered(40, 4);
    // SAFETY: `plc` and `t` may be written; arrays of the sizes given.
    unsafe {
        done(wsp_plc_new(&mut plc));
        done(wsp_plc_add_box(plc, [-1.0; 3].as_ptr(), [2.0; 3].as_ptr(), 1, null_mut()));
        done(wsp_plc_add_points(plc, points.as_ptr().cast(), points.len(), null(), null_mut()));
        done(wsp_triangulation_from_plc(plc, null(), null_mut(), &mut t));
        wsp_plc_free(plc);
    }
    Owned(t)
}

fn bad_edges(t: &Owned, bound: f64) -> Vec<wsp_edge> {
    let mut count = 0;
    let mut edges = Vec::new();
    // SAFETY: a live handle, room as said.
    unsafe {
        done(wsp_bad_short_edges(t.0, bound, null_mut(), 0, &mut count));
        edges.resize(count, wsp_edge { vertices: [WSP_NONE; 2] });
        done(wsp_bad_short_edges(t.0, bound, edges.as_mut_ptr(), count, &mut count));
    }
    assert_eq!(edges.len(), count);
    edges
}

fn link(t: &Owned, edge: wsp_edge) -> (Vec<u32>, bool) {
    let (mut count, mut closed) = (0, 9);
    let mut ids = vec![WSP_NONE; 200];
    // SAFETY: a live handle, room as said.
    done(unsafe { wsp_edge_link(t.0, edge, ids.as_mut_ptr(), ids.len(), &mut count, &mut closed) });
    ids.truncate(count);
    assert!(closed <= 1);
    (ids, closed == 1)
}

fn point(t: &Owned, vertex: u32) -> [f64; 3] {
    let mut p = [0.0; 3];
    // SAFETY: a live handle, room for three.
    done(unsafe { wsp_triangulation_point(t.0, vertex, p.as_mut_ptr()) });
    p
}

#[test]
fn until_no_bad_short_edge_is_left() {
    let t = box_and_points();
    let mut steps = 0;
    let mut kinds = [0; 3];
    let mut left_out = 0;
    while let Some(&edge) = bad_edges(&t, 2.0).first() {
        steps += 1;
        assert!(steps < 5000, "does not end");
        let before = t.counts().0;
        let mut batch = null_mut();
        // SAFETY: live handles, arrays of the sizes given.
        unsafe {
            done(wsp_steiner_batch(t.0, edge, null(), &mut batch));
            let n = wsp_batch_count(batch);
            assert!(n > 0, "a bad edge has a step");
            assert_eq!(wsp_batch_edge(batch), edge);
            assert_eq!(wsp_batch_rule(batch), WSP_RULE_SPARSE);
            let (span, theta) = (wsp_batch_span(batch), wsp_batch_theta(batch));
            assert!((0.0..=std::f64::consts::TAU).contains(&span) && (0.0..=span).contains(&theta));
            let points = array(wsp_batch_points(batch), 3 * n).to_vec();
            for origin in array(wsp_batch_origins(batch), n) {
                let named = origin.vertices.iter().filter(|&&v| v != WSP_NONE).count();
                assert_eq!(named, [0, 2, 3][origin.kind as usize]);
                kinds[origin.kind as usize] += 1;
            }
            let mut ids = vec![WSP_NONE; n];
            done(wsp_triangulation_insert_batch(t.0, batch, ids.as_mut_ptr()));
            let new = ids.iter().filter(|&&id| id != WSP_NONE).count();
            assert_eq!(t.counts().0, before + new);
            left_out += n - new;
            for (i, &id) in ids.iter().enumerate().filter(|(_, &id)| id != WSP_NONE) {
                assert!(id as usize >= before);
                assert_eq!(point(&t, id), points[3 * i..][..3]);
            }
            // The triangulation has changed, so the batch is out of date.
            expect(WSP_ERR_STALE, wsp_triangulation_insert_batch(t.0, batch, null_mut()));
            wsp_batch_free(batch);
        }
    }
    assert!(left_out < steps, "most points are inserted: {left_out} of {steps} batches' are not");
    assert!(kinds[0] > 0 && kinds[1] + kinds[2] > 0, "samples and boundary splits: {kinds:?}");
    // SAFETY: a live handle.
    done(unsafe { wsp_triangulation_validate(t.0, WSP_VALIDATE_QUALITY, 2.0) });
}

#[test]
fn lists_that_do_not_fit() {
    let t = box_and_points();
    let all = bad_edges(&t, 2.0);
    assert!(all.len() > 3);
    let nobody = wsp_edge { vertices: [5, 5] };
    let mut some = [nobody; 4];
    let mut count = 0;
    // SAFETY: a live handle, room as said.
    unsafe {
        expect(WSP_INCOMPLETE, wsp_bad_short_edges(t.0, 2.0, some.as_mut_ptr(), 3, &mut count));
        assert_eq!((count, &some[..3], some[3]), (all.len(), &all[..3], nobody));
        // No capacity: the pointer does not matter, and is not written through.
        done(wsp_bad_short_edges(t.0, 2.0, &mut some[3], 0, &mut count));
        assert_eq!((count, some[3]), (all.len(), nobody));
        // More room than needed: the rest stays.
        let mut more = vec![nobody; all.len() + 2];
        done(wsp_bad_short_edges(t.0, 2.0, more.as_mut_ptr(), more.len(), &mut count));
        assert_eq!((&more[..count], &more[count..]), (&all[..], &[nobody; 2][..]));
    }
}

#[test]
fn a_batch_of_another_state_is_stale() {
    let t = box_and_points();
    let edge = bad_edges(&t, 2.0)[0];
    let (mut batch, mut copy) = (null_mut(), null_mut());
    // SAFETY: live handles.
    unsafe {
        done(wsp_steiner_batch(t.0, edge, null(), &mut batch));
        done(wsp_triangulation_clone(t.0, &mut copy));
        let copy = Owned(copy);
        let other = box_and_points();
        expect(WSP_ERR_STALE, wsp_triangulation_insert_batch(other.0, batch, null_mut()));
        done(wsp_triangulation_insert_batch(copy.0, batch, null_mut()));
        let mut second = null_mut();
        done(wsp_steiner_batch(t.0, bad_edges(&t, 2.0)[1], null(), &mut second));
        done(wsp_triangulation_insert_batch(t.0, second, null_mut()));
        wsp_batch_free(second);
        let before = t.counts();
        expect(WSP_ERR_STALE, wsp_triangulation_insert_batch(t.0, batch, null_mut()));
        assert_eq!(t.counts(), before);
        wsp_batch_free(batch);
    }
}

#[test]
fn an_edge_that_is_not_bad_has_an_empty_batch() {
    let t = Owned::of(&scattered(100, 4));
    let bad = bad_edges(&t, 8.0);
    let flat = t.tetrahedra();
    let good = flat.iter().map(|t| wsp_edge { vertices: [t[0], t[1]] }).find(|e| !bad.contains(e) && !is_bad(&t, *e));
    let edge = good.expect("some edge is good");
    // SAFETY: structs of numbers, live handles.
    unsafe {
        let mut options: wsp_sampler_options = std::mem::zeroed();
        done(wsp_sampler_options_init(&mut options, size_of::<wsp_sampler_options>()));
        options.radius_edge = 8.0;
        let mut batch = null_mut();
        done(wsp_steiner_batch(t.0, edge, &options, &mut batch));
        assert_eq!(wsp_batch_count(batch), 0);
        assert!(wsp_batch_points(batch).is_null() && wsp_batch_origins(batch).is_null());
        done(wsp_triangulation_insert_batch(t.0, batch, null_mut()));
        wsp_batch_free(batch);
    }
}

fn star(t: &Owned, edge: wsp_edge) -> ([f64; 3], [f64; 3], Vec<[f64; 3]>, u32) {
    let (ids, closed) = link(t, edge);
    let around = ids.iter().map(|&v| point(t, v)).collect();
    (point(t, edge.vertices[0]), point(t, edge.vertices[1]), around, closed.into())
}

fn is_bad(t: &Owned, edge: wsp_edge) -> bool {
    let (p, q, around, closed) = star(t, edge);
    let mut bad = 9;
    // SAFETY: arrays of the sizes given.
    done(unsafe {
        wsp_is_bad_edge(p.as_ptr(), q.as_ptr(), around.as_ptr().cast(), around.len(), closed, 8.0, &mut bad)
    });
    assert!(bad <= 1);
    bad == 1
}

#[test]
fn the_sampler_without_a_handle_agrees() {
    let t = Owned::of(&scattered(200, 4));
    let mut compared = 0;
    for edge in bad_edges(&t, 2.0) {
        let (p, q, around, closed) = star(&t, edge);
        let (p, q, xyz, n) = (p.as_ptr(), q.as_ptr(), around.as_ptr().cast(), around.len());
        let (mut bad, mut count) = (9, 0);
        let mut samples = [[0.0f64; 3]; 16];
        // SAFETY: arrays of the sizes given.
        unsafe {
            done(wsp_is_bad_edge(p, q, xyz, n, closed, 2.0, &mut bad));
            assert_eq!(bad, 1);
            done(wsp_sample_edge(p, q, xyz, n, closed, null(), null_mut(), 0, &mut count));
            assert!(count > 0);
            let room = samples.len();
            done(wsp_sample_edge(p, q, xyz, n, closed, null(), samples.as_mut_ptr().cast(), room, &mut count));
            if count > 1 {
                let mut first = [[7.0f64; 3]; 2];
                let status = wsp_sample_edge(p, q, xyz, n, closed, null(), first.as_mut_ptr().cast(), 1, &mut count);
                expect(WSP_INCOMPLETE, status);
                assert_eq!(first, [samples[0], [7.0; 3]]);
            }
            // The output may lie over the input.
            let mut memory = around.clone();
            memory.resize(n.max(room), [0.0; 3]);
            let both = memory.as_mut_ptr();
            done(wsp_sample_edge(p, q, both.cast(), n, closed, null(), both.cast(), room, &mut count));
            assert_eq!(memory[..count], samples[..count]);
            let mut batch = null_mut();
            done(wsp_steiner_batch(t.0, edge, null(), &mut batch));
            let m = wsp_batch_count(batch);
            let origins = array(wsp_batch_origins(batch), m);
            if origins.iter().all(|o| o.kind == WSP_ORIGIN_SAMPLE) {
                assert_eq!(array(wsp_batch_points(batch), 3 * m), samples[..count].as_flattened());
                compared += 1;
            }
            wsp_batch_free(batch);
        }
    }
    assert!(compared > 5, "{compared}");
}

#[test]
fn the_sampler_refuses_what_is_no_star() {
    let (p, q) = ([0.0; 3], [0.0, 0.0, 1.0]);
    let around = [[1.0, 0.0, 0.5], [-1.0, 1.0, 0.5], [-1.0, -1.0, 0.5]];
    let xyz: *const f64 = around.as_ptr().cast();
    let (mut bad, mut count) = (9, 9);
    // SAFETY: arrays of the sizes given.
    unsafe {
        let (p, q) = (p.as_ptr(), q.as_ptr());
        done(wsp_is_bad_edge(p, q, xyz, 3, 1, 2.0, &mut bad));
        bad = 9;
        expect(WSP_ERR_ARGUMENT, wsp_is_bad_edge(p, p, xyz, 3, 1, 2.0, &mut bad));
        expect(WSP_ERR_ARGUMENT, wsp_is_bad_edge(p, q, xyz, 2, 1, 2.0, &mut bad));
        expect(WSP_ERR_ARGUMENT, wsp_is_bad_edge(p, q, xyz, 1, 0, 2.0, &mut bad));
        expect(WSP_ERR_ARGUMENT, wsp_is_bad_edge(p, q, null(), 0, 1, 2.0, &mut bad));
        expect(WSP_ERR_ARGUMENT, wsp_is_bad_edge(p, q, xyz, 3, 2, 2.0, &mut bad));
        expect(WSP_ERR_OPTION, wsp_is_bad_edge(p, q, xyz, 3, 1, 0.5, &mut bad));
        let broken = [around[0], [0.0, f64::NAN, 0.0], around[2]];
        expect(WSP_ERR_NOT_FINITE, wsp_is_bad_edge(p, q, broken.as_ptr().cast(), 3, 1, 2.0, &mut bad));
        assert!(last_error().contains("link point 1"), "{}", last_error());
        let sample = |n, closed| wsp_sample_edge(p, q, xyz, n, closed, null(), null_mut(), 0, &mut 0);
        expect(WSP_ERR_ARGUMENT, sample(2, 1));
        expect(WSP_ERR_ARGUMENT, sample(3, 7));
        let mut options: wsp_sampler_options = std::mem::zeroed();
        done(wsp_sampler_options_init(&mut options, size_of::<wsp_sampler_options>()));
        options.rule = 0;
        expect(WSP_ERR_OPTION, wsp_sample_edge(p, q, xyz, 3, 1, &options, null_mut(), 0, &mut count));
    }
    assert_eq!((bad, count), (9, 9));
}

/// A cube as six tetrahedra around its diagonal, with a point near one corner that makes bad edges once it is in.
fn arrays() -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
    let corner = |i: u32| [0, 1, 2].map(|k| f64::from(i >> k & 1));
    let around = [1u32, 3, 2, 6, 4, 5, 1];
    ((0..8).map(corner).collect(), around.windows(2).map(|w| [0, w[0], w[1], 7]).collect())
}

fn view_of(points: &[[f64; 3]], tetrahedra: &[[u32; 4]]) -> wsp_mesh_view {
    let mut view = std::mem::MaybeUninit::uninit();
    // SAFETY: `_init` fills what it is given the size of.
    let mut view: wsp_mesh_view = unsafe {
        done(wsp_mesh_view_init(view.as_mut_ptr(), size_of::<wsp_mesh_view>()));
        view.assume_init()
    };
    (view.points, view.points_count) = (points.as_ptr().cast(), points.len());
    (view.tetrahedra, view.tetrahedra_count) = (tetrahedra.as_ptr().cast(), tetrahedra.len());
    view
}

#[test]
fn a_mesh_in_arrays_has_batches() {
    let (points, mut tetrahedra) = arrays();
    let mut view = view_of(&points, &tetrahedra);
    let mut batch = null_mut();
    let mut count = 9;
    // SAFETY: live arrays of the sizes given, and NULL where it is allowed or an error.
    unsafe {
        // The cube's tetrahedra have a ratio of 0.87.
        done(wsp_sample_mesh(&view, null(), null_mut(), &mut batch));
        assert_eq!((wsp_mesh_batch_count(batch), wsp_mesh_batch_refused(batch)), (0, 0));
        assert!(wsp_mesh_batch_points(batch).is_null());
        assert!(wsp_mesh_batch_bad_edges(batch, &mut count).is_null());
        assert_eq!(count, 0);
        wsp_mesh_batch_free(batch);

        let mut options = std::mem::MaybeUninit::uninit();
        done(wsp_sampler_options_init(options.as_mut_ptr(), size_of::<wsp_sampler_options>()));
        let mut options: wsp_sampler_options = options.assume_init();
        options.radius_edge = 0.8;
        // A program of before the fields for faces: they are not read.
        view.struct_size = std::mem::offset_of!(wsp_mesh_view, faces) as u32;
        view.faces_count = usize::MAX;
        done(wsp_sample_mesh(&view, &options, null_mut(), &mut batch));
        assert!(wsp_mesh_batch_count(batch) > 0);
        let point = *wsp_mesh_batch_points(batch);
        assert!(point.tetrahedron < 6 && point.rule == WSP_RULE_SPARSE);
        assert!(point.xyz.iter().all(|x| (0.0..=1.0).contains(x)));
        assert!(!wsp_mesh_batch_bad_edges(batch, &mut count).is_null());
        assert!(count > 0);
        wsp_mesh_batch_free(batch);
        view = view_of(&points, &tetrahedra);

        let refused = |view: *const wsp_mesh_view, status: wsp_status| {
            let mut batch = std::ptr::dangling_mut();
            assert_eq!(wsp_sample_mesh(view, null(), null_mut(), &mut batch), status);
            assert!(batch.is_null());
        };
        refused(null(), WSP_ERR_NULL);
        refused(&wsp_mesh_view { struct_size: 12, ..view }, WSP_ERR_STRUCT_SIZE);
        refused(&wsp_mesh_view { points: null(), ..view }, WSP_ERR_NULL);
        refused(&wsp_mesh_view { faces_count: 1, ..view }, WSP_ERR_NULL);
        refused(&wsp_mesh_view { points_count: 7, ..view }, WSP_ERR_NOT_VALID);
        assert_eq!(wsp_sample_mesh(&view, null(), null_mut(), null_mut()), WSP_ERR_NULL);
        tetrahedra[2].swap(0, 1);
        refused(&view_of(&points, &tetrahedra), WSP_ERR_NOT_VALID);
        wsp_mesh_batch_free(null_mut());
        assert_eq!((wsp_mesh_batch_count(null()), wsp_mesh_batch_refused(null())), (0, 0));
    }
}

#[test]
fn predicates_and_qualities_for_hosts() {
    let (points, tetrahedra) = arrays();
    let [a, b, c, d] = tetrahedra[0].map(|v| points[v as usize].as_ptr());
    let (mut sign, mut bad) = (7, [9u8; 6]);
    let corners: Vec<[f64; 3]> = tetrahedra.iter().flatten().map(|&v| points[v as usize]).collect();
    // SAFETY: three doubles a point, room as said, NULL is an error.
    unsafe {
        done(wsp_orientation(a, b, c, d, &mut sign));
        assert_eq!(sign, 1);
        done(wsp_orientation(b, a, c, d, &mut sign));
        assert_eq!(sign, -1);
        for (p, expected) in [([0.5; 3], 1), ([0.0, 1.0, 0.0], 0), ([2.0, 0.0, 0.0], -1)] {
            done(wsp_side_of_sphere(a, b, c, d, p.as_ptr(), &mut sign));
            assert_eq!(sign, expected);
        }
        assert_eq!(wsp_orientation(a, null(), c, d, &mut sign), WSP_ERR_NULL);
        assert_eq!(wsp_side_of_sphere(a, b, c, d, [f64::NAN; 3].as_ptr(), &mut sign), WSP_ERR_NOT_FINITE);
        done(wsp_bad_tetrahedra(corners.as_ptr().cast(), 6, 0.8, bad.as_mut_ptr()));
        assert_eq!(bad, [1; 6]);
        done(wsp_bad_tetrahedra(corners.as_ptr().cast(), 6, 0.9, bad.as_mut_ptr()));
        assert_eq!(bad, [0; 6]);
        done(wsp_bad_tetrahedra(null(), 0, 2.0, null_mut()));
        assert_eq!(wsp_bad_tetrahedra(corners.as_ptr().cast(), 6, 0.1, bad.as_mut_ptr()), WSP_ERR_OPTION);
    }
}

#[test]
fn the_boundary_of_a_mesh_in_arrays_can_be_kept() {
    let t = box_and_points();
    let view = t.view();
    // SAFETY: structs of numbers, live arrays of the sizes given.
    unsafe {
        let mut options: wsp_sampler_options = std::mem::zeroed();
        done(wsp_sampler_options_init(&mut options, size_of::<wsp_sampler_options>()));
        assert_eq!((options.keep_boundary, options.reserved), (0, 0));
        let round = |options: &wsp_sampler_options| {
            let mut batch = null_mut();
            let status = wsp_sample_mesh(&view, options, null_mut(), &mut batch);
            let all = array(wsp_mesh_batch_points(batch), wsp_mesh_batch_count(batch)).to_vec();
            let refused = wsp_mesh_batch_refused(batch);
            wsp_mesh_batch_free(batch);
            (status, all, refused)
        };
        let splits = |all: &[wsp_steiner_point]| all.iter().filter(|p| p.origin.kind != WSP_ORIGIN_SAMPLE).count();
        let (status, all, _) = round(&options);
        done(status);
        assert!(splits(&all) > 0, "{all:?}");
        options.keep_boundary = 1;
        let (status, kept, refused) = round(&options);
        assert!(status == WSP_DONE || status == WSP_UNREFINED && kept.is_empty());
        assert!(splits(&kept) == 0 && refused > 0, "{kept:?}");
        // A program of before the field: it is not read.
        let first = size_of::<wsp_sampler_options>();
        options.struct_size = std::mem::offset_of!(wsp_sampler_options, keep_boundary) as u32;
        assert!((options.struct_size as usize) < first);
        (options.keep_boundary, options.reserved) = (7, 7);
        assert_eq!(round(&options), (WSP_DONE, all, 0));
        options.struct_size = first as u32;
        let refuse = |options: &wsp_sampler_options, name: &str| {
            let mut batch = std::ptr::dangling_mut();
            assert_eq!(wsp_sample_mesh(&view, options, null_mut(), &mut batch), WSP_ERR_OPTION);
            assert!(batch.is_null() && last_error().contains(name), "{}", last_error());
        };
        refuse(&options, "reserved");
        options.reserved = 0;
        refuse(&options, "keep_boundary is 7");
        options.keep_boundary = 0;
        for nonsense in [-1.0, f64::NAN, f64::INFINITY] {
            options.min_edge = nonsense;
            refuse(&options, "min_edge");
        }
        // Nothing is as far from a vertex as that.
        options.min_edge = 100.0;
        let (status, all, refused) = round(&options);
        assert!(status == WSP_UNREFINED && all.is_empty() && refused > 0, "{all:?}");
        // Nothing is written beyond an older struct.
        done(wsp_sampler_options_init(&mut options, std::mem::offset_of!(wsp_sampler_options, keep_boundary)));
        assert_eq!((options.struct_size, options.min_edge), (16, 100.0));
    }
}
