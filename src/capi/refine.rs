//! The refinement as one call, and its report.

use std::ffi::c_void;

use super::args;
use super::control::{self, wsp_control};
use super::guard::{call, host_code, Failure};
use super::options::{rule, sparsify, switch, unused, wsp_refine_options, wsp_sparsify};
use super::sized::{self, Sized_};
use super::status::*;
use super::triangulation::wsp_triangulation;
use crate::{DVec3, RefineOptions, RefineReport, RefineStatus, Sizing};

/// What a refinement did, and the mesh's quality now. After WSP_CANCELLED the tetrahedra have not been looked at, for that takes a while:
/// `tetrahedra`, `bad`, `on_segments` and `on_facets` are 0 then, and the ratio and the angle NaN. Fill it with wsp_report_init before it is given
/// to wsp_refine.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_report {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// What wsp_refine returned.
    pub status: wsp_status,
    /// Vertices that are no Steiner points.
    pub input_vertices: usize,
    /// Vertices now.
    pub vertices: usize,
    /// Tetrahedra of the domain now.
    pub tetrahedra: usize,
    /// Vertices that are Steiner points: those of earlier calls and of the domain's recovery too.
    pub steiner: usize,
    /// Vertices that this call has added by the sampling rule.
    pub samples: usize,
    /// Vertices that this call has added to split segments.
    pub segment_splits: usize,
    /// Vertices that this call has added to split subfacets.
    pub facet_splits: usize,
    /// Tetrahedra of the domain that exceed the bound; 0 after WSP_DONE.
    pub bad: usize,
    /// The largest circumradius over shortest edge in the domain; 0 without tetrahedra.
    pub worst_radius_edge: f64,
    /// The smallest dihedral angle in the domain, in degrees; 180 without tetrahedra.
    pub min_dihedral_degrees: f64,
    /// Steiner points that this call has taken away again without putting another in their place.
    pub removed: usize,
    /// Steiner points that this call has put in the place of two each.
    pub replaced: usize,
    /// Of the bad tetrahedra, those whose shortest edge spans an input angle of less than 60 degrees.
    pub unrefined_small_angle: usize,
    /// Those whose Steiner points would encroach upon segments or facets that can't be split: at small input angles, or
    /// because of `keep_boundary`.
    pub unrefined_boundary: usize,
    /// Those that would need an edge below the minimum length.
    pub unrefined_min_edge: usize,
    /// Those that a limit of vertices, seconds or memory came before.
    pub unrefined_limit: usize,
    /// Those for which rounding left no place.
    pub unrefined_rounding: usize,
    /// Tetrahedra, bad or not, that are larger than was asked for. With WSP_UNREFINED these may be all that is left, with `bad` 0.
    pub too_large: usize,
    /// Steiner points that lie on segments now: those of the domain's recovery and of earlier calls too.
    pub on_segments: usize,
    /// Steiner points that lie on facets now, but on no segment.
    pub on_facets: usize,
}

// SAFETY: repr(C), numbers only, struct_size first.
unsafe impl Sized_ for wsp_report {
    const NAME: &'static str = "wsp_report";
    const SIZES: &'static [usize] = &[
        std::mem::offset_of!(Self, unrefined_small_angle),
        std::mem::offset_of!(Self, on_segments),
        size_of::<Self>(),
    ];

    fn defaults() -> Self {
        wsp_report {
            struct_size: 0,
            status: WSP_DONE,
            input_vertices: 0,
            vertices: 0,
            tetrahedra: 0,
            steiner: 0,
            samples: 0,
            segment_splits: 0,
            facet_splits: 0,
            bad: 0,
            worst_radius_edge: 0.0,
            min_dihedral_degrees: 180.0,
            removed: 0,
            replaced: 0,
            unrefined_small_angle: 0,
            unrefined_boundary: 0,
            unrefined_min_edge: 0,
            unrefined_limit: 0,
            unrefined_rounding: 0,
            too_large: 0,
            on_segments: 0,
            on_facets: 0,
        }
    }
}

fn status(status: RefineStatus) -> wsp_status {
    match status {
        RefineStatus::Done => WSP_DONE,
        RefineStatus::Cancelled => WSP_CANCELLED,
        RefineStatus::VertexLimit => WSP_VERTEX_LIMIT,
        RefineStatus::Unrefined => WSP_UNREFINED,
        RefineStatus::TimeLimit => WSP_TIME_LIMIT,
        RefineStatus::MemoryLimit => WSP_MEMORY_LIMIT,
    }
}

impl From<&RefineReport> for wsp_report {
    fn from(report: &RefineReport) -> Self {
        let [small_angle, boundary, min_edge, limit, rounding] = report.unrefined;
        wsp_report {
            struct_size: 0,
            status: status(report.status),
            input_vertices: report.input_vertices,
            vertices: report.vertices,
            tetrahedra: report.tetrahedra,
            steiner: report.steiner,
            samples: report.samples,
            segment_splits: report.segment_splits,
            facet_splits: report.facet_splits,
            bad: report.bad,
            worst_radius_edge: report.worst_radius_edge,
            min_dihedral_degrees: report.min_dihedral_degrees,
            removed: report.removed,
            replaced: report.replaced,
            unrefined_small_angle: small_angle,
            unrefined_boundary: boundary,
            unrefined_min_edge: min_edge,
            unrefined_limit: limit,
            unrefined_rounding: rounding,
            too_large: report.too_large,
            on_segments: report.on_segments,
            on_facets: report.on_facets,
        }
    }
}

/// Makes `report` that of an empty mesh. `size` is `sizeof *report`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_report_init(report: *mut wsp_report, size: usize) -> wsp_status {
    call("wsp_report_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(report, size, "report")? };
        Ok(WSP_DONE)
    })
}

/// Adds Steiner points until no tetrahedron of the domain exceeds the bound on circumradius over shortest edge.
/// Without a domain the convex hull becomes the domain first (see wsp_triangulation_use_hull_as_domain). Input vertices
/// keep their ids, Steiner points are numbered behind them. With `sparsify` on, as it is by default, Steiner points of earlier calls
/// may be taken away too, and those that remain get new ids without gaps; with WSP_SPARSIFY_OFF all keep their ids.
///
/// Always ends: after WSP_CANCELLED, WSP_VERTEX_LIMIT, WSP_TIME_LIMIT, WSP_MEMORY_LIMIT and WSP_UNREFINED the mesh is valid, Delaunay and
/// usable, and the call may be repeated to go on. A cancellation is answered within some milliseconds; ids of Steiner points may have
/// gaps then, until a later call closes them. A call with the same options but for seconds and bytes, no sizes, and nothing changed in
/// between, tries nothing again that one which was cancelled or whose seconds were over has tried in vain. So calls that are stopped each time come
/// to the end, too, if each may run until it has done something: it begins with a look at all tetrahedra, and the first report of progress may come
/// before anything is done. The second comes after that. `options` and `control` may be NULL. `report` may be NULL; it is
/// written for all statuses of 0 and above, and left as it was after an error.
///
/// After WSP_ERR_TOO_MANY and WSP_ERR_MEMORY it is valid too, with what had been added.
///
/// Cost: about linear in the mesh that comes out.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_refine(
    triangulation: *mut wsp_triangulation,
    options: *const wsp_refine_options,
    control: *mut wsp_control,
    report: *mut wsp_report,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_refine", || unsafe { refine(triangulation, options, None, control, report) })
}

/// How large tetrahedra may be at most. Fill it with wsp_sizing_init. Of several sources the smallest length counts at each
/// place; a length that is not positive and finite asks for nothing.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct wsp_sizing {
    /// Set by the `_init`.
    pub struct_size: u32,
    /// Must be 0.
    pub reserved: u32,
    /// The largest length of an edge in each region, in the order in which the regions were added; `region_count` of them.
    /// May be NULL.
    pub region_max_edge: *const f64,
    /// See `region_max_edge`; others ask for nothing.
    pub region_count: usize,
    /// The largest length at each vertex, by id, `vertex_count` of them. May be NULL. Between vertices lengths are interpolated, in the Delaunay
    /// triangulation of the input vertices and of those Steiner points that the list reaches: a call with the same list goes on where
    /// another one ended. Among vertices that ask for nothing a length grows with the distance from its own vertex.
    pub vertex_max_edge: *const f64,
    /// See `vertex_max_edge`; others ask for nothing.
    pub vertex_count: usize,
    /// Fills in the largest length at `n` points, three doubles each. It must give the same answer each time. May be NULL.
    pub callback: Option<unsafe extern "C" fn(user: *mut c_void, xyz: *const f64, n: usize, max_edge: *mut f64)>,
    /// Given to the callback as it is.
    pub user: *mut c_void,
}

// SAFETY: repr(C), integers, pointers and a nullable function pointer, which the caller vouches for; struct_size first.
unsafe impl Sized_ for wsp_sizing {
    const NAME: &'static str = "wsp_sizing";
    const SIZES: &'static [usize] = &[size_of::<Self>()];

    fn defaults() -> Self {
        wsp_sizing {
            struct_size: 0,
            reserved: 0,
            region_max_edge: std::ptr::null(),
            region_count: 0,
            vertex_max_edge: std::ptr::null(),
            vertex_count: 0,
            callback: None,
            user: std::ptr::null_mut(),
        }
    }
}

/// Makes `sizing` ask for nothing. `size` is `sizeof *sizing`.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE (nothing is written then).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sizing_init(sizing: *mut wsp_sizing, size: usize) -> wsp_status {
    call("wsp_sizing_init", || {
        // SAFETY: the caller gives `size` writable bytes, or NULL.
        unsafe { sized::init(sizing, size, "sizing")? };
        Ok(WSP_DONE)
    })
}

/// wsp_refine with sizes: a tetrahedron with an edge longer than asked for at its centroid is refined too, within the same boundary
/// rules. Where sizes are asked for, no Steiner point is taken away again, whatever `sparsify` says. The largest volumes of the complex's regions
/// count in both functions. `sizing` may be NULL: nothing more is asked for then. The callback runs on the calling thread.
/// Errors: as wsp_refine.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_refine_sized(
    triangulation: *mut wsp_triangulation,
    options: *const wsp_refine_options,
    sizing: *const wsp_sizing,
    control: *mut wsp_control,
    report: *mut wsp_report,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_refine_sized", || unsafe {
        let sizing = sized::read(sizing, "sizing")?;
        unused(sizing.reserved)?;
        refine(triangulation, options, Some(sizing), control, report)
    })
}

/// # Safety
/// As for wsp_refine and wsp_refine_sized.
unsafe fn refine(
    triangulation: *mut wsp_triangulation,
    options: *const wsp_refine_options,
    sizing: Option<wsp_sizing>,
    control: *mut wsp_control,
    report: *mut wsp_report,
) -> Result<wsp_status, Failure> {
    // SAFETY: as the caller promises.
    unsafe {
        if !report.is_null() {
            sized::check_out(report, "report")?;
        }
        let given = sized::read(options, "options")?;
        unused(given.reserved)?;
        if !(given.max_edge >= 0.0 && given.max_edge.is_finite()) {
            let text = format!("max_edge is {}, expected a length, or 0", given.max_edge);
            return Err(Failure::new(WSP_ERR_OPTION, text));
        }
        let keep_boundary = switch("keep_boundary", given.keep_boundary)?;
        let options = RefineOptions {
            radius_edge: given.radius_edge,
            rule: rule(given.rule)?,
            max_vertices: given.max_vertices,
            min_edge: given.min_edge,
            sparsify: sparsify(given.sparsify)?,
            keep_boundary,
            max_seconds: given.max_seconds,
            max_memory: given.max_memory,
        };
        let mut sizes = Sizing { uniform: given.max_edge, ..Sizing::default() };
        let asked = sizing.and_then(|s| s.callback.map(|callback| (callback, s.user)));
        let callback = |points: &[DVec3], answers: &mut [f64]| {
            if let Some((callback, user)) = asked {
                // SAFETY: as many points as answers; the caller vouches for the function and for `user`.
                host_code(|| {
                    callback(user, points.as_ptr().cast(), points.len(), answers.as_mut_ptr());
                });
            }
        };
        if let Some(sizing) = &sizing {
            sizes.regions = args::slice(sizing.region_max_edge, sizing.region_count, "region_max_edge")?;
            sizes.vertices = args::slice(sizing.vertex_max_edge, sizing.vertex_count, "vertex_max_edge")?;
            if sizing.callback.is_some() {
                sizes.callback = Some(&callback);
            }
        }
        let control = control::core(control)?;
        let mut state = args::reference(triangulation, "triangulation")?.handle.write()?;
        let done = state.change(|mesh| mesh.refine_sized(&options, &sizes, &control))?;
        if !report.is_null() {
            sized::write(&wsp_report::from(&done), report, "report")?;
        }
        Ok(status(done.status))
    }
}

/// Takes Steiner points away, or puts one in the place of two neighbours, wherever every tetrahedron that comes keeps the bound
/// `radius_edge` (0.62 to 1e6). Works on any triangulation: its Steiner points are the vertices added since it has a domain. Without a domain
/// the convex hull becomes the domain first, and there are none. Input vertices keep their places and ids; segments and facets stay
/// covered by edges and faces; nothing becomes bad. The Steiner points that remain get new ids without gaps, in their order.
///
/// `level` is a WSP_SPARSIFY_ constant; WSP_SPARSIFY_DEFAULT stands for WSP_SPARSIFY_QUICK. wsp_refine with its option `sparsify` leaves
/// fewer points than this call afterwards. WSP_UNREFINED tells that tetrahedra exceed the bound, as they did before.
/// `control` and `report` may be NULL; `report` is written for all statuses of 0 and above, and left as it was after an error.
///
/// Cost: some tens of microseconds a Steiner point.
/// Errors: WSP_ERR_NULL, WSP_ERR_STRUCT_SIZE, WSP_ERR_OPTION, WSP_ERR_TOO_MANY, WSP_ERR_MEMORY, WSP_ERR_BUSY.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn wsp_sparsify_mesh(
    triangulation: *mut wsp_triangulation,
    radius_edge: f64,
    level: wsp_sparsify,
    control: *mut wsp_control,
    report: *mut wsp_report,
) -> wsp_status {
    // SAFETY: each pointer is NULL or live, and checked by the function that takes it.
    call("wsp_sparsify_mesh", || unsafe {
        if !report.is_null() {
            sized::check_out(report, "report")?;
        }
        let level = sparsify(level)?.unwrap_or_default();
        let control = control::core(control)?;
        let mut state = args::reference(triangulation, "triangulation")?.handle.write()?;
        let done = state.change(|mesh| mesh.sparsify(radius_edge, level, &control))?;
        if !report.is_null() {
            sized::write(&wsp_report::from(&done), report, "report")?;
        }
        Ok(status(done.status))
    })
}
