//! The host's floating-point mode does not matter, and comes back as it was.

use super::super::float_env::testing::{as_host, host_modes};
use super::super::float_env::Mode;
use super::*;

#[test]
fn results_do_not_depend_on_the_hosts_mode() {
    // Cospherical points: the filters fail and the exact stages decide, which need round-to-nearest.
    let points = grid(6);
    let expected = Owned::of(&points).tetrahedra();
    for (name, mode) in host_modes() {
        let t = Owned::empty();
        // SAFETY: a live handle, an array of the size given.
        let (status, left) = as_host(mode, || unsafe {
            wsp_triangulation_insert(t.0, points.as_ptr().cast(), points.len(), null_mut(), null_mut())
        });
        done(status);
        assert_eq!(left, mode, "{name}");
        assert_eq!(t.tetrahedra(), expected, "{name}");
        // SAFETY: a live handle.
        let (status, left) = as_host(mode, || unsafe { wsp_triangulation_validate(t.0, 3, 2.0) });
        done(status);
        assert_eq!(left, mode, "{name}");
    }
}

#[test]
fn refinement_does_not_depend_on_the_hosts_mode() {
    let mut points = scattered(50, 2);
    points.extend((0..8).map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 2.0 })));
    let refined = |mode: Mode| {
        let t = Owned::of(&points);
        // SAFETY: a live handle.
        let (status, left) = as_host(mode, || unsafe { wsp_refine(t.0, null(), null_mut(), null_mut()) });
        done(status);
        assert_eq!(left, mode);
        let view = t.view();
        // SAFETY: the view's array.
        let xyz = unsafe { array(view.points, 3 * view.points_count) }.to_vec();
        (xyz, t.tetrahedra())
    };
    let expected = refined(Mode::DEFAULT);
    for (name, mode) in host_modes() {
        assert!(refined(mode) == expected, "{name}");
    }
}

#[test]
fn failures_and_frees_leave_the_hosts_mode() {
    for (name, mode) in host_modes() {
        let mut t = null_mut();
        // SAFETY: `t` may be written.
        done(unsafe { wsp_triangulation_new(null(), &mut t) });
        let ((), left) = as_host(mode, || {
            // SAFETY: NULL is checked; `t` is freed once.
            unsafe {
                wsp_triangulation_new(null(), null_mut());
                wsp_triangulation_insert(t, [f64::NAN; 3].as_ptr(), 1, null_mut(), null_mut());
                wsp_triangulation_free(t);
            }
        });
        assert_eq!(left, mode, "{name}");
    }
}

#[test]
fn callbacks_run_in_the_hosts_mode_and_may_leave_another() {
    let points = scattered(20_000, 2);
    let expected = Owned::of(&points).tetrahedra();
    for (name, mode) in host_modes() {
        let t = Owned::empty();
        let mut seen = Vec::new();
        let control = OwnedControl::new(|_| {
            seen.push(Mode::get());
            if let Some((_, other)) = host_modes().into_iter().find(|m| m.0 == "up, both flushed") {
                other.set();
            }
            0
        });
        // SAFETY: live handles, an array of the size given.
        let (status, left) = as_host(mode, || unsafe {
            wsp_triangulation_insert(t.0, points.as_ptr().cast(), points.len(), null_mut(), control.control)
        });
        done(status);
        drop(control);
        assert_eq!(left, mode, "{name}");
        assert!(!seen.is_empty() && seen.iter().all(|&s| s == mode), "{name}: {seen:?}");
        assert_eq!(t.tetrahedra(), expected, "{name}");
    }
}
