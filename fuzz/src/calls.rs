//! The C interface in any order: handles that are there or NULL, ids and counts of any value, sizes that are not known, callbacks that
//! cancel and call back. Whatever comes, the answer is a status that the header names, never WSP_ERR_INTERNAL; an error has a text that
//! begins with the function's name; nothing is written beyond a buffer; and every handle is still valid in the end.
//!
//! What the header forbids is not done: a handle is not used after its `_free`, and arrays have the elements that their counts say.

use std::cell::Cell;
use std::ffi::{c_void, CStr};
use std::ptr::{null, null_mut};

use wellspaced::capi::batch::*;
use wellspaced::capi::boundary::*;
use wellspaced::capi::control::*;
use wellspaced::capi::mesh_batch::*;
use wellspaced::capi::options::*;
use wellspaced::capi::plc::*;
use wellspaced::capi::refine::*;
use wellspaced::capi::sampler::*;
use wellspaced::capi::status::*;
use wellspaced::capi::steps::*;
use wellspaced::capi::triangulation::*;
use wellspaced::capi::view::*;
use wellspaced::DVec3;

use crate::bytes::{Bytes, Grid};

const CALLS: usize = 60;
/// Triangulations larger than this are not inserted into.
const VERTICES: usize = 300;

/// Calls a function and looks at what it answers; the status.
macro_rules! ask {
    ($function:ident($($argument:expr),* $(,)?)) => {{
        // SAFETY: pointers are NULL or to what is alive and as large as the counts say.
        let status = unsafe { $function($($argument),*) };
        answered(stringify!($function), status);
        status
    }};
}

fn answered(name: &str, status: wsp_status) {
    if std::env::var_os("FUZZ_TRACE").is_some() {
        eprintln!("{name}: {status}");
    }
    // SAFETY: strings of the library.
    let (text, last) = unsafe { (CStr::from_ptr(wsp_status_string(status)), CStr::from_ptr(wsp_last_error())) };
    let last = last.to_string_lossy();
    assert_ne!(text, c"unknown status", "{name} answers {status}");
    assert_ne!(status, WSP_ERR_INTERNAL, "{name}: {last}");
    assert!(status >= 0 || last.strip_prefix(name).is_some_and(|rest| rest.starts_with(": ")), "{name}: {last}");
}

/// What callbacks do.
struct Script {
    /// Callbacks until one of them cancels.
    patience: Cell<u32>,
    /// The handle of the call under way, to be told that it is in use.
    busy: Cell<*mut wsp_triangulation>,
}

unsafe extern "C" fn callback(user: *mut c_void, progress: *const wsp_progress) -> i32 {
    // SAFETY: `user` is the script, which outlives the control; the progress is the library's.
    let (script, progress) = unsafe { (&*user.cast::<Script>(), &*progress) };
    assert!((0.0..=1.0).contains(&progress.fraction) && !progress.stage.is_null());
    if !script.busy.get().is_null() {
        let status = ask!(wsp_refine(script.busy.get(), null(), null_mut(), null_mut()));
        assert_eq!(status, WSP_ERR_BUSY);
    }
    let left = script.patience.get().saturating_sub(1);
    script.patience.set(left);
    i32::from(left == 0)
}

struct Pool {
    triangulations: [*mut wsp_triangulation; 3],
    plcs: [*mut wsp_plc; 2],
    batches: [*mut wsp_batch; 2],
    mesh_batches: [*mut wsp_mesh_batch; 2],
    control: *mut wsp_control,
    script: Box<Script>,
    grid: Grid,
}

/// A handle of a list, or NULL.
fn one_of<T, const N: usize>(all: &[*mut T; N], bytes: &mut Bytes) -> *mut T {
    match bytes.byte() {
        255 => null_mut(),
        byte => all[usize::from(byte) % N],
    }
}

/// A size for a struct of `size` bytes: the right one, mostly.
fn size_of_struct(size: usize, bytes: &mut Bytes) -> usize {
    match bytes.byte() {
        250 => 0,
        251 => size - 8,
        252 => size + 8,
        253 => 8,
        254 => usize::MAX,
        _ => size,
    }
}

impl Pool {
    fn counts(&self, t: *mut wsp_triangulation) -> (usize, usize) {
        let mut counts = (0, 0);
        if !t.is_null() {
            assert_eq!(ask!(wsp_triangulation_counts(t, &mut counts.0, &mut counts.1)), WSP_DONE);
        }
        counts
    }

    /// An id that may be a vertex's.
    fn id(&self, t: *mut wsp_triangulation, bytes: &mut Bytes) -> u32 {
        match bytes.byte() {
            255 => WSP_NONE,
            254 => bytes.word(),
            byte => u32::from(byte) % (self.counts(t).0 as u32 + 2),
        }
    }

    fn edge(&self, t: *mut wsp_triangulation, bytes: &mut Bytes) -> wsp_edge {
        // A bad one, if there is one.
        let mut edge = wsp_edge { vertices: [WSP_NONE; 2] };
        let mut count = 0;
        if bytes.byte() % 2 == 0 && !t.is_null() {
            ask!(wsp_bad_short_edges(t, 1.5, &mut edge, 1, &mut count));
            if count > 0 {
                return edge;
            }
        }
        wsp_edge { vertices: [self.id(t, bytes), self.id(t, bytes)] }
    }

    fn point(&self, bytes: &mut Bytes) -> DVec3 {
        match bytes.byte() {
            255 => DVec3::new(bytes.any_real(), bytes.any_real(), bytes.any_real()),
            _ => self.grid.point(bytes),
        }
    }

    fn points(&self, most: usize, bytes: &mut Bytes) -> Vec<DVec3> {
        (0..bytes.below(most)).map(|_| self.point(bytes)).collect()
    }

    /// The control, with so much patience.
    fn control(&self, busy: *mut wsp_triangulation, bytes: &mut Bytes) -> *mut wsp_control {
        self.script.patience.set(u32::from(bytes.byte() % 24));
        self.script.busy.set(busy);
        ask!(wsp_control_reset(self.control));
        if bytes.byte() == 255 {
            ask!(wsp_control_cancel(self.control));
        }
        self.control
    }

    fn refine_options(&self, bytes: &mut Bytes) -> wsp_refine_options {
        // SAFETY: numbers.
        let mut options: wsp_refine_options = unsafe { std::mem::zeroed() };
        let size = size_of_struct(size_of::<wsp_refine_options>(), bytes);
        ask!(wsp_refine_options_init(&mut options, size));
        options.radius_edge = radius_edge(bytes);
        options.rule = if bytes.byte() == 255 { bytes.word() } else { 1 + u32::from(bytes.byte() % 3) };
        options.max_vertices = bytes.below(VERTICES);
        options.min_edge = if bytes.byte() == 255 { bytes.any_real() } else { options.min_edge };
        options.sparsify = u32::from(bytes.byte() % 5);
        if std::env::var_os("FUZZ_TRACE").is_some() {
            eprintln!("{options:?}");
        }
        options
    }

    fn insert(&mut self, bytes: &mut Bytes) {
        let t = one_of(&self.triangulations, bytes);
        if self.counts(t).0 > VERTICES {
            return;
        }
        let points = self.points(40, bytes);
        let mut ids = vec![7; points.len() + 1];
        let control = if bytes.byte() % 4 == 0 { self.control(t, bytes) } else { null_mut() };
        let n = points.len();
        let before = self.counts(t);
        if std::env::var_os("FUZZ_TRACE").is_some() {
            eprintln!("{t:?}: {points:?}");
        }
        let status = match bytes.byte() {
            // NULL for what may be left out, and counts that no memory holds.
            255 => ask!(wsp_triangulation_insert(t, null(), n, ids.as_mut_ptr(), control)),
            254 => ask!(wsp_triangulation_insert(t, points.as_ptr().cast(), usize::MAX - n, ids.as_mut_ptr(), control)),
            byte if byte % 4 == 0 => ask!(wsp_triangulation_insert(t, points.as_ptr().cast(), n, null_mut(), control)),
            _ => ask!(wsp_triangulation_insert(t, points.as_ptr().cast(), n, ids.as_mut_ptr(), control)),
        };
        assert_eq!(ids[n], 7, "written beyond the ids");
        assert!(status == WSP_DONE || ids.iter().all(|&id| id == 7), "ids after {status}");
        assert!(status == WSP_DONE || self.counts(t) == before, "{before:?} has changed with {status}");
    }

    fn add_to_plc(&mut self, bytes: &mut Bytes) {
        let plc = one_of(&self.plcs, bytes);
        let mut first = 7;
        match bytes.byte() % 6 {
            0 => {
                let points = self.points(12, bytes);
                let markers = vec![1; points.len()];
                let markers = if bytes.byte() % 2 == 0 { markers.as_ptr() } else { null() };
                ask!(wsp_plc_add_points(plc, points.as_ptr().cast(), points.len(), markers, &mut first));
            }
            1 => {
                let (low, high) = (self.point(bytes), self.point(bytes));
                ask!(wsp_plc_add_box(plc, low.as_ref().as_ptr(), high.as_ref().as_ptr(), 3, &mut first));
            }
            2 => {
                let ends: Vec<u32> = (0..2 * bytes.below(4)).map(|_| u32::from(bytes.byte() % 12)).collect();
                ask!(wsp_plc_add_segments(plc, ends.as_ptr(), ends.len() / 2, null()));
            }
            3 => {
                let corners: Vec<u32> = (0..3 + bytes.below(6)).map(|_| u32::from(bytes.byte() % 12)).collect();
                // Starts that rise by themselves, mostly.
                let cut = bytes.below(corners.len() + 2);
                let (starts, last) = ([0, cut, corners.len()], corners.len());
                match bytes.byte() % 4 {
                    0 => ask!(wsp_plc_add_facets(
                        plc,
                        corners.as_ptr(),
                        starts.as_ptr(),
                        2,
                        null(),
                        2,
                        null(),
                        null_mut()
                    )),
                    1 => ask!(wsp_plc_add_facets(
                        plc,
                        corners.as_ptr(),
                        starts.as_ptr(),
                        2,
                        [0, 2].as_ptr(),
                        1,
                        null(),
                        &mut first
                    )),
                    _ => ask!(wsp_plc_add_facets(
                        plc,
                        corners.as_ptr(),
                        [0, last].as_ptr(),
                        1,
                        null(),
                        1,
                        null(),
                        &mut first
                    )),
                };
            }
            4 => {
                let p = self.point(bytes);
                ask!(wsp_plc_add_facet_hole(plc, u32::from(bytes.byte() % 8), p.as_ref().as_ptr()));
                ask!(wsp_plc_add_hole(plc, p.as_ref().as_ptr()));
            }
            _ => {
                let p = self.point(bytes);
                let volume = if bytes.byte() == 255 { bytes.any_real() } else { f64::from(bytes.byte()) };
                ask!(wsp_plc_add_region(plc, p.as_ref().as_ptr(), 1.0, volume));
            }
        }
        let mut counts = [0usize; 3];
        let [a, b, c] = &mut counts;
        ask!(wsp_plc_counts(plc, a, b, c));
    }

    fn look(&mut self, bytes: &mut Bytes) {
        let t = one_of(&self.triangulations, bytes);
        let (mut int, mut word, mut count) = (7, 7, 7);
        match bytes.byte() % 7 {
            0 => {
                let p = self.point(bytes);
                let mut location = wsp_location { kind: 7, vertices: [7; 4] };
                let hint = self.id(t, bytes);
                let status = ask!(wsp_triangulation_locate(t, p.as_ref().as_ptr(), hint, &mut location));
                assert_eq!(location.kind == 7, status < 0);
            }
            1 => {
                ask!(wsp_triangulation_dimension(t, &mut int));
                ask!(wsp_triangulation_has_domain(t, &mut word));
            }
            2 => {
                let mut xyz = [7.0; 4];
                ask!(wsp_triangulation_point(t, self.id(t, bytes), xyz.as_mut_ptr()));
                assert_eq!(xyz[3], 7.0);
            }
            3 => {
                let level = u32::from(bytes.byte() % 6);
                let status = ask!(wsp_triangulation_validate(t, level, radius_edge(bytes)));
                assert!(status != WSP_ERR_NOT_VALID || level == WSP_VALIDATE_QUALITY);
            }
            4 => {
                let capacity = bytes.below(8);
                let mut edges = vec![wsp_edge { vertices: [7; 2] }; capacity + 1];
                ask!(wsp_bad_short_edges(t, radius_edge(bytes), edges.as_mut_ptr(), capacity, &mut count));
                assert_eq!(edges[capacity].vertices, [7; 2]);
            }
            5 => {
                let capacity = bytes.below(8);
                let mut link = vec![7; capacity + 1];
                let edge = self.edge(t, bytes);
                ask!(wsp_edge_link(t, edge, link.as_mut_ptr(), capacity, &mut count, &mut word));
                assert_eq!(link[capacity], 7);
            }
            _ => {
                let points: [DVec3; 8] = std::array::from_fn(|_| self.point(bytes));
                let [a, b, c, d, e, ..] = points.each_ref().map(|p| p.as_ref().as_ptr());
                ask!(wsp_orientation(a, b, c, d, &mut int));
                ask!(wsp_side_of_sphere(a, b, c, d, e, &mut int));
                let mut bad = [7; 3];
                ask!(wsp_bad_tetrahedra(a, 2, radius_edge(bytes), bad.as_mut_ptr()));
                assert_eq!(bad[2], 7);
                let mut out = [7.0; 16];
                let (n, closed, capacity) = (bytes.below(6), u32::from(bytes.byte() % 3), bytes.below(5));
                ask!(wsp_sample_edge(a, b, c, n, closed, null(), out.as_mut_ptr(), capacity, &mut count));
                assert_eq!(out[15], 7.0);
                ask!(wsp_is_bad_edge(a, b, c, n, closed, radius_edge(bytes), &mut word));
            }
        }
    }

    /// The boundary of a triangulation, which names nothing that is not there.
    fn boundary(&mut self, bytes: &mut Bytes) {
        let t = one_of(&self.triangulations, bytes);
        // SAFETY: numbers and NULL.
        let (mut view, mut mesh): (wsp_boundary_view, wsp_mesh_view) = unsafe { std::mem::zeroed() };
        ask!(wsp_boundary_view_init(&mut view, size_of_struct(size_of::<wsp_boundary_view>(), bytes)));
        let control = self.control(t, bytes);
        if ask!(wsp_triangulation_boundary(t, control, &mut view)) != WSP_DONE {
            return;
        }
        ask!(wsp_mesh_view_init(&mut mesh, size_of::<wsp_mesh_view>()));
        ask!(wsp_triangulation_view(t, &mut mesh));
        // SAFETY: the views' arrays, which nothing changes meanwhile.
        let (vertices, tetrahedra) = unsafe {
            let faces = copy(view.faces, 3 * view.faces_count);
            let edges = copy(view.edges, 2 * view.edges_count);
            ([faces, edges].concat(), copy(view.face_tetrahedra, 2 * view.faces_count))
        };
        assert!(vertices.iter().all(|&v| (v as usize) < view.vertices_count));
        assert!(view.vertices_count == 0 || view.vertices_count == mesh.points_count);
        assert!(tetrahedra.iter().all(|&tet| tet == WSP_NONE || (tet as usize) < mesh.tetrahedra_count));
    }

    /// The arrays of a triangulation, perhaps with a fault, as a host's.
    fn sample_mesh(&mut self, bytes: &mut Bytes) {
        let t = one_of(&self.triangulations, bytes);
        // SAFETY: numbers and NULL.
        let mut view: wsp_mesh_view = unsafe { std::mem::zeroed() };
        ask!(wsp_mesh_view_init(&mut view, size_of_struct(size_of::<wsp_mesh_view>(), bytes)));
        ask!(wsp_triangulation_view(t, &mut view));
        // SAFETY: the view's arrays, which nothing changes meanwhile.
        let (mut points, mut tetrahedra, mut neighbours) = unsafe {
            (
                copy(view.points.cast::<DVec3>(), view.points_count),
                copy(view.tetrahedra, 4 * view.tetrahedra_count),
                copy(view.neighbours, 4 * view.tetrahedra_count),
            )
        };
        for _ in 0..bytes.below(4) {
            let value = if bytes.byte() % 4 == 0 { bytes.word() } else { u32::from(bytes.byte()) };
            match bytes.byte() % 4 {
                0 if !points.is_empty() => {
                    let place = bytes.below(points.len());
                    points[place] = self.point(bytes);
                }
                1 if !tetrahedra.is_empty() => {
                    let place = bytes.below(tetrahedra.len());
                    tetrahedra[place] = value;
                }
                2 if !neighbours.is_empty() => {
                    let place = bytes.below(neighbours.len());
                    neighbours[place] = value;
                }
                _ => {}
            }
        }
        let faces: Vec<u32> = (0..3 * bytes.below(3)).map(|_| u32::from(bytes.byte() % 12)).collect();
        let facets = vec![u32::from(bytes.byte()); faces.len() / 3];
        let host = wsp_mesh_view {
            points: points.as_ptr().cast(),
            tetrahedra: tetrahedra.as_ptr(),
            neighbours: if bytes.byte() % 2 == 0 { null() } else { neighbours.as_ptr() },
            faces: faces.as_ptr(),
            faces_count: faces.len() / 3,
            facets: if bytes.byte() % 2 == 0 { null() } else { facets.as_ptr() },
            ..view
        };
        let slot = bytes.below(2);
        ask_free(&mut self.mesh_batches[slot], wsp_mesh_batch_free);
        let control = self.control(null_mut(), bytes);
        // SAFETY: numbers.
        let mut options: wsp_sampler_options = unsafe { std::mem::zeroed() };
        ask!(wsp_sampler_options_init(&mut options, size_of::<wsp_sampler_options>()));
        options.keep_boundary = u32::from(bytes.byte() % 3 == 0);
        let status = ask!(wsp_sample_mesh(&host, &options, control, &mut self.mesh_batches[slot]));
        assert_eq!(self.mesh_batches[slot].is_null(), !(status == WSP_DONE || status == WSP_UNREFINED));
        let batch = self.mesh_batches[slot];
        let mut count = 0;
        // SAFETY: NULL or live.
        unsafe {
            let n = wsp_mesh_batch_count(batch);
            for point in copy(wsp_mesh_batch_points(batch), n) {
                assert!(point.xyz.iter().all(|x| x.is_finite()));
            }
            let edges = wsp_mesh_batch_bad_edges(batch, &mut count);
            copy(edges, count);
            wsp_mesh_batch_refused(batch);
        }
    }

    fn batch(&mut self, bytes: &mut Bytes) {
        let t = one_of(&self.triangulations, bytes);
        let slot = bytes.below(2);
        if bytes.byte() % 2 == 0 {
            ask_free(&mut self.batches[slot], wsp_batch_free);
            // SAFETY: numbers.
            let mut options: wsp_sampler_options = unsafe { std::mem::zeroed() };
            ask!(wsp_sampler_options_init(&mut options, size_of_struct(size_of::<wsp_sampler_options>(), bytes)));
            options.radius_edge = radius_edge(bytes);
            let edge = self.edge(t, bytes);
            let status = ask!(wsp_steiner_batch(t, edge, &options, &mut self.batches[slot]));
            assert_eq!(self.batches[slot].is_null(), status != WSP_DONE);
        }
        let batch = self.batches[slot];
        // SAFETY: NULL or live.
        let count = unsafe {
            wsp_batch_edge(batch);
            wsp_batch_rule(batch);
            wsp_batch_span(batch);
            wsp_batch_theta(batch);
            copy(wsp_batch_origins(batch), wsp_batch_count(batch));
            copy(wsp_batch_points(batch), 3 * wsp_batch_count(batch));
            wsp_batch_count(batch)
        };
        let mut ids = vec![7; count + 1];
        ask!(wsp_triangulation_insert_batch(t, batch, ids.as_mut_ptr()));
        assert_eq!(ids[count], 7);
    }

    fn refine(&mut self, bytes: &mut Bytes) {
        let t = one_of(&self.triangulations, bytes);
        let options = self.refine_options(bytes);
        // SAFETY: numbers.
        let mut report: wsp_report = unsafe { std::mem::zeroed() };
        let size = size_of_struct(size_of::<wsp_report>(), bytes);
        ask!(wsp_report_init(&mut report, size));
        let to = if bytes.byte() % 4 == 0 { null_mut() } else { &raw mut report };
        let control = self.control(t, bytes);
        let status = if bytes.byte() % 4 == 0 {
            ask!(wsp_sparsify_mesh(t, radius_edge(bytes), u32::from(bytes.byte() % 5), control, to))
        } else {
            ask!(wsp_refine(t, &options, control, to))
        };
        if status >= 0 && !to.is_null() {
            assert_eq!((report.status, report.vertices), (status, self.counts(t).0));
            assert!(status != WSP_DONE || report.bad == 0);
        }
    }

    fn make(&mut self, bytes: &mut Bytes) {
        let slot = bytes.below(3);
        let other = one_of(&self.triangulations, bytes);
        match bytes.byte() % 6 {
            0 => ask_free(&mut self.triangulations[slot], wsp_triangulation_free),
            1 if self.triangulations[slot].is_null() => {
                // SAFETY: numbers.
                let mut options: wsp_triangulation_options = unsafe { std::mem::zeroed() };
                let size = size_of_struct(size_of::<wsp_triangulation_options>(), bytes);
                ask!(wsp_triangulation_options_init(&mut options, size));
                options.threads = u32::from(bytes.byte() % 4);
                ask!(wsp_triangulation_new(&options, &mut self.triangulations[slot]));
            }
            2 if self.triangulations[slot].is_null() => {
                let control = self.control(null_mut(), bytes);
                let status = ask!(wsp_triangulation_clone_within(other, control, &mut self.triangulations[slot]));
                assert_eq!(self.triangulations[slot].is_null(), status != WSP_DONE);
            }
            3 | 4 if self.triangulations[slot].is_null() => {
                let control = self.control(null_mut(), bytes);
                let plc = one_of(&self.plcs, bytes);
                // SAFETY: numbers.
                let mut options: wsp_triangulation_options = unsafe { std::mem::zeroed() };
                ask!(wsp_triangulation_options_init(&mut options, size_of::<wsp_triangulation_options>()));
                options.keep_boundary = u32::from(bytes.byte() % 4 == 0);
                let status = ask!(wsp_triangulation_from_plc(plc, &options, control, &mut self.triangulations[slot]));
                assert_eq!(self.triangulations[slot].is_null(), status != WSP_DONE);
            }
            5 => {
                let slot = bytes.below(2);
                ask_free(&mut self.plcs[slot], wsp_plc_free);
                ask!(wsp_plc_new(&mut self.plcs[slot]));
            }
            _ => {
                let control = self.control(null_mut(), bytes);
                let status = ask!(wsp_triangulation_use_hull_as_domain_within(other, control));
                let mut has_domain = 0;
                if status >= 0 {
                    ask!(wsp_triangulation_has_domain(other, &mut has_domain));
                    assert_eq!(has_domain, u32::from(status == WSP_DONE));
                }
            }
        }
    }
}

/// # Safety
/// `ptr` is NULL or has `n` elements.
unsafe fn copy<T: Copy>(ptr: *const T, n: usize) -> Vec<T> {
    if ptr.is_null() {
        return Vec::new();
    }
    // SAFETY: as the caller promises.
    unsafe { std::slice::from_raw_parts(ptr, n) }.to_vec()
}

fn ask_free<T>(handle: &mut *mut T, free: unsafe extern "C" fn(*mut T)) {
    // SAFETY: NULL, or live and not used after this.
    unsafe { free(std::mem::replace(handle, null_mut())) };
}

fn radius_edge(bytes: &mut Bytes) -> f64 {
    match bytes.byte() {
        255 => bytes.any_real(),
        byte => [2.0, 1.5, 1.2, 4.0, 0.62, 1e6][usize::from(byte) % 6],
    }
}

pub fn run(data: &[u8]) {
    let mut bytes = Bytes(data);
    let mut pool = Pool {
        triangulations: [null_mut(); 3],
        plcs: [null_mut(); 2],
        batches: [null_mut(); 2],
        mesh_batches: [null_mut(); 2],
        control: null_mut(),
        script: Box::new(Script { patience: Cell::new(0), busy: Cell::new(null_mut()) }),
        grid: Grid::of(&mut bytes),
    };
    let user = std::ptr::from_ref(&*pool.script).cast_mut().cast();
    ask!(wsp_control_new(Some(callback), user, &mut pool.control));
    ask!(wsp_triangulation_new(null(), &mut pool.triangulations[0]));
    ask!(wsp_plc_new(&mut pool.plcs[0]));
    for _ in 0..CALLS {
        if bytes.is_empty() {
            break;
        }
        match bytes.byte() % 16 {
            0..=2 => pool.insert(&mut bytes),
            3 => {
                let t = one_of(&pool.triangulations, &mut bytes);
                let vertex = pool.id(t, &mut bytes);
                let control = if vertex % 4 == 0 { pool.control(null_mut(), &mut bytes) } else { null_mut() };
                ask!(wsp_triangulation_remove_within(t, vertex, control));
            }
            4..=6 => pool.add_to_plc(&mut bytes),
            7 | 8 => pool.look(&mut bytes),
            9 => pool.sample_mesh(&mut bytes),
            10 | 11 => pool.batch(&mut bytes),
            12 | 13 => pool.refine(&mut bytes),
            14 => pool.make(&mut bytes),
            _ => pool.boundary(&mut bytes),
        }
    }
    for t in &mut pool.triangulations {
        if !t.is_null() {
            let status = ask!(wsp_triangulation_validate(*t, WSP_VALIDATE_DELAUNAY, 0.0));
            // SAFETY: a string of the library.
            let text = unsafe { CStr::from_ptr(wsp_last_error()) }.to_string_lossy();
            assert!(status == WSP_DONE, "{text}");
        }
        ask_free(t, wsp_triangulation_free);
    }
    pool.plcs.iter_mut().for_each(|plc| ask_free(plc, wsp_plc_free));
    pool.batches.iter_mut().for_each(|batch| ask_free(batch, wsp_batch_free));
    pool.mesh_batches.iter_mut().for_each(|batch| ask_free(batch, wsp_mesh_batch_free));
    ask_free(&mut pool.control, wsp_control_free);
}
