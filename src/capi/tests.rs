//! Tests of the C face through its own functions, as a C program calls them.

mod abuse;
mod boundary;
mod domain;
mod float;
mod handles;
mod limits;
mod points;
mod stepwise;

use std::ffi::{c_char, c_void, CStr};
use std::ptr::{null, null_mut};

use super::batch::*;
use super::boundary::*;
use super::control::*;
use super::mesh_batch::*;
use super::options::*;
use super::plc::*;
use super::refine::*;
use super::sampler::*;
use super::status::*;
use super::steps::*;
use super::triangulation::*;
use super::view::*;

// What the header promises about threads, and all that `Handle` needs to be sound.
const _: () = {
    const fn shareable<T: Send + Sync>() {}
    shareable::<wsp_triangulation>();
    shareable::<wsp_plc>();
    shareable::<wsp_batch>();
    shareable::<wsp_control>();
};

fn text(string: *const c_char) -> String {
    assert!(!string.is_null());
    // SAFETY: a string that the library gave out, which is valid until the thread's next failure.
    unsafe { CStr::from_ptr(string) }.to_str().expect("UTF-8").to_owned()
}

fn last_error() -> String {
    text(wsp_last_error())
}

/// Fails with the last error's text unless the status is the expected one.
#[track_caller]
fn expect(expected: wsp_status, status: wsp_status) {
    assert_eq!(status, expected, "{}; last error: {}", text(wsp_status_string(status)), last_error());
}

#[track_caller]
fn done(status: wsp_status) {
    expect(WSP_DONE, status);
}

/// A triangulation that frees itself.
struct Owned(*mut wsp_triangulation);

impl Owned {
    fn empty() -> Owned {
        let mut t = null_mut();
        // SAFETY: `t` may be written.
        done(unsafe { wsp_triangulation_new(null(), &mut t) });
        Owned(t)
    }

    fn of(points: &[[f64; 3]]) -> Owned {
        let t = Owned::empty();
        t.insert(points);
        t
    }

    fn insert(&self, points: &[[f64; 3]]) -> Vec<u32> {
        let mut ids = vec![WSP_NONE; points.len()];
        // SAFETY: a live handle, and arrays of the sizes given.
        done(unsafe {
            wsp_triangulation_insert(self.0, points.as_ptr().cast(), points.len(), ids.as_mut_ptr(), null_mut())
        });
        ids
    }

    fn counts(&self) -> (usize, usize) {
        let mut counts = (usize::MAX, usize::MAX);
        // SAFETY: a live handle, and writable counts.
        done(unsafe { wsp_triangulation_counts(self.0, &mut counts.0, &mut counts.1) });
        counts
    }

    /// The tetrahedra, each with its ids in order, and all in order: two equal triangulations have equal lists.
    fn tetrahedra(&self) -> Vec<[u32; 4]> {
        let view = self.view();
        // SAFETY: the view's arrays, which are used up before the handle changes.
        let flat = unsafe { array(view.tetrahedra, 4 * view.tetrahedra_count) };
        let mut all: Vec<[u32; 4]> = flat.chunks(4).map(|c| [c[0], c[1], c[2], c[3]]).collect();
        all.iter_mut().for_each(|t| t.sort_unstable());
        all.sort_unstable();
        all
    }

    fn view(&self) -> wsp_mesh_view {
        // SAFETY: a struct of numbers and pointers, a live handle.
        unsafe {
            let mut view: wsp_mesh_view = std::mem::zeroed();
            done(wsp_mesh_view_init(&mut view, size_of::<wsp_mesh_view>()));
            done(wsp_triangulation_view(self.0, &mut view));
            view
        }
    }
}

impl Drop for Owned {
    fn drop(&mut self) {
        // SAFETY: made by the library, freed once.
        unsafe { wsp_triangulation_free(self.0) };
    }
}

/// # Safety
/// As `slice::from_raw_parts`, but NULL is fine without elements.
unsafe fn array<'a, T>(ptr: *const T, n: usize) -> &'a [T] {
    if n == 0 {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts(ptr, n) }
}

/// Points that look random, the same in every run.
fn scattered(n: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..n).map(|_| [next(), next(), next()]).collect()
}

fn grid(n: usize) -> Vec<[f64; 3]> {
    let at = |i: usize| [(i % n) as f64 * 0.1, (i / n % n) as f64 * 0.1, (i / n / n) as f64 * 0.1];
    (0..n * n * n).map(at).collect()
}

type Told<'a> = Box<dyn FnMut(&wsp_progress) -> i32 + 'a>;

/// A control with a Rust closure, for tests. The closure must outlive it.
struct OwnedControl<'a> {
    control: *mut wsp_control,
    _callback: Box<Told<'a>>,
}

impl<'a> OwnedControl<'a> {
    fn new(callback: impl FnMut(&wsp_progress) -> i32 + 'a) -> Self {
        unsafe extern "C" fn told(user: *mut c_void, progress: *const wsp_progress) -> i32 {
            // SAFETY: `user` is the box below, which outlives the control; the struct is valid during the call.
            unsafe { (*user.cast::<Told<'_>>())(&*progress) }
        }
        let mut callback: Box<Told<'a>> = Box::new(Box::new(callback));
        let mut control = null_mut();
        let user: *mut Told<'a> = &mut *callback;
        // SAFETY: `control` may be written.
        done(unsafe { wsp_control_new(Some(told), user.cast(), &mut control) });
        OwnedControl { control, _callback: callback }
    }
}

impl Drop for OwnedControl<'_> {
    fn drop(&mut self) {
        // SAFETY: made by the library, freed once.
        unsafe { wsp_control_free(self.control) };
    }
}

#[test]
fn versions_and_texts() {
    assert_eq!(text(wsp_version()), env!("CARGO_PKG_VERSION"));
    assert_eq!(wsp_abi_version(), WSP_ABI_VERSION);
    let known: Vec<wsp_status> = (WSP_ERR_NOT_VALID..=WSP_MEMORY_LIMIT).collect();
    let texts: std::collections::BTreeSet<String> = known.iter().map(|&s| text(wsp_status_string(s))).collect();
    assert_eq!(texts.len(), known.len(), "each status has a text of its own");
    for unknown in [WSP_ERR_NOT_VALID - 1, WSP_MEMORY_LIMIT + 1, i32::MIN, i32::MAX] {
        assert_eq!(text(wsp_status_string(unknown)), "unknown status");
        assert!(!texts.contains("unknown status"));
    }
}
