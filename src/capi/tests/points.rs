//! Points that no one would choose: what is not a number or out of range is refused by its position, all else is triangulated exactly. Large sets of
//! such points are in cpp_tests/hostile.cpp.

use super::*;

const MIN: f64 = crate::geometry::MIN_MAGNITUDE;
const MAX: f64 = crate::geometry::MAX_MAGNITUDE;

fn insert(t: &Owned, points: &[[f64; 3]]) -> wsp_status {
    // SAFETY: a live handle, an array of the size given.
    unsafe { wsp_triangulation_insert(t.0, points.as_ptr().cast(), points.len(), null_mut(), null_mut()) }
}

fn valid(t: &Owned) {
    // SAFETY: a live handle.
    done(unsafe { wsp_triangulation_validate(t.0, WSP_VALIDATE_DELAUNAY, 0.0) });
}

#[test]
fn what_the_predicates_can_not_hold_is_refused_wherever_it_stands() {
    let t = Owned::of(&scattered(20, 1));
    let before = t.tetrahedra();
    let cases = [
        (f64::NAN, WSP_ERR_NOT_FINITE),
        (-f64::NAN, WSP_ERR_NOT_FINITE),
        (f64::INFINITY, WSP_ERR_NOT_FINITE),
        (f64::NEG_INFINITY, WSP_ERR_NOT_FINITE),
        (f64::MAX, WSP_ERR_OUT_OF_RANGE),
        (MAX.next_up(), WSP_ERR_OUT_OF_RANGE),
        (-MAX.next_up(), WSP_ERR_OUT_OF_RANGE),
        (MIN.next_down(), WSP_ERR_OUT_OF_RANGE),
        (-f64::MIN_POSITIVE, WSP_ERR_OUT_OF_RANGE),
        // Denormals, the least among them.
        (f64::MIN_POSITIVE / 2.0, WSP_ERR_OUT_OF_RANGE),
        (f64::from_bits(1), WSP_ERR_OUT_OF_RANGE),
    ];
    for (value, expected) in cases {
        for axis in 0..3 {
            // Alone, among few, and among so many that they are inserted another way.
            for count in [1, 7, 3000] {
                let mut points = scattered(count, 9);
                points[count / 2][axis] = value;
                expect(expected, insert(&t, &points));
                assert!(last_error().contains(&format!("point {}", count / 2)), "{}", last_error());
            }
            let mut p = [0.5; 3];
            p[axis] = value;
            let mut location = wsp_location { kind: 77, vertices: [0; 4] };
            // SAFETY: live handles, three doubles each.
            unsafe {
                expect(expected, wsp_triangulation_locate(t.0, p.as_ptr(), WSP_NONE, &mut location));
                let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
                let mut sign = 7;
                expect(expected, wsp_orientation(p.as_ptr(), b.as_ptr(), c.as_ptr(), d.as_ptr(), &mut sign));
                let last = wsp_side_of_sphere(a.as_ptr(), b.as_ptr(), c.as_ptr(), d.as_ptr(), p.as_ptr(), &mut sign);
                expect(expected, last);
                assert_eq!((sign, location.kind), (7, 77));
                let mut plc = null_mut();
                done(wsp_plc_new(&mut plc));
                let complex = [wsp_plc_add_hole(plc, p.as_ptr()), wsp_plc_add_region(plc, p.as_ptr(), 1.0, 0.0)];
                assert_eq!(complex, [expected; 2]);
                wsp_plc_free(plc);
            }
        }
    }
    assert_eq!(t.tetrahedra(), before);
}

#[test]
fn counts_that_no_ids_can_number_are_refused_before_a_look_at_the_points() {
    let t = Owned::of(&scattered(20, 1));
    let memory = [0.0f64; 3];
    for n in [(1 << 30) + 1, 1 << 32, (1 << 33) + 5, usize::MAX / 24, usize::MAX] {
        // SAFETY: the count is refused before anything is read through the pointer.
        let status = unsafe { wsp_triangulation_insert(t.0, memory.as_ptr(), n, null_mut(), null_mut()) };
        expect(WSP_ERR_TOO_MANY, status);
        let mut plc = null_mut();
        // SAFETY: as above.
        unsafe {
            done(wsp_plc_new(&mut plc));
            expect(WSP_ERR_TOO_MANY, wsp_plc_add_points(plc, memory.as_ptr(), n, null(), null_mut()));
            expect(WSP_ERR_TOO_MANY, wsp_plc_add_segments(plc, [0, 1].as_ptr(), n, null()));
            wsp_plc_free(plc);
        }
    }
    assert_eq!(t.counts().0, 20);
}

#[test]
fn equal_points_are_one_and_zeros_have_no_sign() {
    for count in [2, 5000] {
        let t = Owned::empty();
        let ids = t.insert(&vec![[1.5, -0.0, 2.0]; count]);
        assert!(ids.iter().all(|&id| id == 0));
        assert_eq!(t.counts(), (1, 0));
        assert_eq!(t.insert(&[[1.5, 0.0, 2.0]]), [0]);
        // SAFETY: live handles.
        unsafe {
            done(wsp_refine(t.0, null(), null_mut(), null_mut()));
            done(wsp_triangulation_validate(t.0, WSP_VALIDATE_QUALITY, 2.0));
        }
    }
    let t = Owned::of(&[[0.0; 3], [1.0, -0.0, 0.0], [0.0, 1.0, -0.0], [-0.0, 0.0, 1.0], [-0.0; 3]]);
    assert_eq!(t.counts(), (4, 1));
    let mut xyz = [7.0; 3];
    // SAFETY: a live handle, three doubles.
    done(unsafe { wsp_triangulation_point(t.0, 1, xyz.as_mut_ptr()) });
    assert!(xyz.iter().all(|x| x.is_sign_positive()), "{xyz:?}");
}

#[test]
fn the_ends_of_the_range_are_in_it() {
    // A cube of the largest size, one of the smallest, and both at once.
    let cube =
        |size: f64| (0..8).map(move |i| [i & 1, i >> 1 & 1, i >> 2].map(|bit| if bit == 1 { size } else { -size }));
    for sizes in [&[MAX][..], &[MIN], &[MIN, MAX], &[MIN, 1.0, MAX]] {
        let points: Vec<[f64; 3]> = sizes.iter().flat_map(|&size| cube(size)).collect();
        let t = Owned::of(&points);
        assert_eq!(t.counts().0, points.len());
        valid(&t);
        // SAFETY: a struct of numbers.
        let mut options: wsp_refine_options = unsafe { std::mem::zeroed() };
        // SAFETY: live handles and structs.
        unsafe {
            done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
            options.max_vertices = 300;
            let status = wsp_refine(t.0, &options, null_mut(), null_mut());
            assert!(status >= 0, "{sizes:?}: {}", last_error());
        }
        valid(&t);
    }
}

#[test]
fn points_far_from_the_origin_are_meshed_as_well_as_their_coordinates_allow() {
    for shift in [1e12, -1e12] {
        let points: Vec<[f64; 3]> = scattered(300, 5).into_iter().map(|p| p.map(|x| x * 1000.0 + shift)).collect();
        let t = Owned::of(&points);
        valid(&t);
        // SAFETY: a struct of numbers.
        let mut options: wsp_refine_options = unsafe { std::mem::zeroed() };
        // SAFETY: live handles and structs.
        unsafe {
            done(wsp_refine_options_init(&mut options, size_of::<wsp_refine_options>()));
            options.max_vertices = 20_000;
            let status = wsp_refine(t.0, &options, null_mut(), null_mut());
            assert!(status == WSP_DONE || status == WSP_UNREFINED, "{status}: {}", last_error());
            done(wsp_triangulation_validate(t.0, WSP_VALIDATE_ORIENTATION, 0.0));
        }
    }
}
