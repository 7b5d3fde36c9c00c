//! Where memory is lacking, calls answer with an error and leave what they found. An allocator of the test's own refuses a large request, the first of
//! a call, then the second, and so on, until the call gets all that it asks for.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use wellspaced::{Control, DVec3, Error, Mesh, Plc, RefineOptions, Triangulation};

/// Requests below this are always granted: for lists that stay small Rust has no answer to a refusal. With the sizes of this test, points, tetrahedra and
/// the arrays of the bulk insertion are above it.
const LARGE: usize = 300_000;

struct Scarce;

/// Large requests that are granted before one is refused.
static LEFT: AtomicUsize = AtomicUsize::new(usize::MAX);

fn refuses(size: usize) -> bool {
    if size < LARGE || LEFT.load(Ordering::Relaxed) == usize::MAX {
        return false;
    }
    // The one at 0 is refused, and then all.
    LEFT.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
}

// SAFETY: the system's allocator, or null, which is an allocator's right.
unsafe impl GlobalAlloc for Scarce {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if refuses(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if refuses(layout.size()) {
            return std::ptr::null_mut();
        }
        // SAFETY: as the caller promises.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, ptr: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        if size > layout.size() && refuses(size) {
            return std::ptr::null_mut();
        }
        // SAFETY: as the caller promises.
        unsafe { System.realloc(ptr, layout, size) }
    }

    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(ptr, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Scarce = Scarce;

/// Runs `call` with one request granted more each time, until it succeeds; how often it failed. `check` sees what each failure left.
fn with_ever_more<T, R>(
    fresh: impl Fn() -> T,
    call: impl Fn(&mut T) -> Result<R, Error>,
    check: impl Fn(&T, usize),
) -> usize {
    for granted in 0.. {
        let mut subject = fresh();
        LEFT.store(granted, Ordering::Relaxed);
        let result = call(&mut subject);
        LEFT.store(usize::MAX, Ordering::Relaxed);
        match result {
            Ok(_) => return granted,
            Err(Error::OutOfMemory { .. }) => check(&subject, granted),
            Err(error) => panic!("{error}"),
        }
    }
    unreachable!()
}

fn scattered(count: usize, seed: u64) -> Vec<DVec3> {
    let mut state = seed;
    let mut next = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..count).map(|_| DVec3::new(next(), next(), next())).collect()
}

/// One test, for the allocator is everyone's.
#[test]
fn a_refused_request_is_an_error_and_nothing_is_lost() {
    let points = scattered(20_000, 1);
    let more = scattered(5_000, 2);
    let of = |points: &[DVec3]| {
        let mut t = Triangulation::new();
        t.insert_many(points, &Control::new()).unwrap();
        t
    };
    let same = |t: &Triangulation, other: &Triangulation| {
        t.validate(3).unwrap();
        assert!(t.tetrahedra().eq(other.tetrahedra()) && t.points() == other.points());
    };

    let nothing = Triangulation::new();
    let failures =
        with_ever_more(Triangulation::new, |t| t.insert_many(&points, &Control::new()), |t, _| same(t, &nothing));
    assert!(failures > 0, "{failures}");

    let before = of(&points);
    let failures = with_ever_more(|| of(&points), |t| t.insert_many(&more, &Control::new()), |t, _| same(t, &before));
    assert!(failures > 0, "{failures}");

    // One by one, until a list has to grow.
    let grow = |t: &mut Triangulation| more.iter().try_for_each(|&p| t.insert(p, None).map(|_| ()));
    let failures = with_ever_more(|| of(&points), grow, |t, _| t.validate(3).unwrap());
    assert!(failures > 0, "{failures}");

    // From a plane into space.
    let flat: Vec<DVec3> = points[..8000].iter().map(|p| p.with_z(0.0)).collect();
    let lift = |t: &mut Triangulation| t.insert(DVec3::ONE, None);
    let failures = with_ever_more(|| of(&flat), lift, |t, _| assert_eq!((t.dimension(), t.vertex_count()), (2, 8000)));
    assert!(failures > 0, "{failures}");

    let failures = with_ever_more(|| &before, |t| t.try_clone(&Control::new()), |_, _| {});
    assert!(failures > 0, "{failures}");

    let mesh = || {
        let mut mesh = Mesh::new();
        mesh.insert(&points[..3000], None, &Control::new()).unwrap();
        mesh.use_hull_as_domain().unwrap();
        mesh
    };
    let failures = with_ever_more(mesh, |m| m.try_view(&Control::new()).map(|_| ()), |m, _| m.validate(3).unwrap());
    assert!(failures > 0, "{failures}");
    let failures = with_ever_more(mesh, |m| m.try_clone(&Control::new()), |m, _| m.validate(3).unwrap());
    assert!(failures > 0, "{failures}");

    let domain = || {
        let plc = Plc::boxed(DVec3::splat(-1.0), DVec3::splat(2.0), points[..3000].iter().copied());
        Mesh::from_plc(&plc, &Control::new()).unwrap()
    };
    let options = RefineOptions { radius_edge: 1.3, max_vertices: 12_000, ..RefineOptions::default() };
    let failures = with_ever_more(
        domain,
        |m| m.refine(&options, &Control::new()),
        |m, _| {
            m.validate(3).unwrap();
            assert!(m.triangulation().vertex_count() >= 3008);
        },
    );
    assert!(failures > 0, "{failures}");
}
